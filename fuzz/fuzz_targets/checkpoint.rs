//! Any bytes are a checkpoint or a typed error.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::checkpoint(bytes));
