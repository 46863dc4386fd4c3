//! Any bytes are a shape that is sound, or an error that names the file. The first byte says which format.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::shape_files(bytes));
