//! Any bytes are the question of a sweep and its table, or typed errors. A zero byte separates the two.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::sweep_folder(bytes));
