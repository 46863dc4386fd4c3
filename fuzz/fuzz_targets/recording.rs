//! Any bytes are a recording whose frames and inputs can be read, or a typed error.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::recording(bytes));
