//! Any bytes are a valid shape, or an error that names the file. The first byte selects the format.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::shape_files(bytes));
