//! Any bytes are a scene or a list of errors with places that can be printed: with all models, integrators and obstacles that
//! the library has, and the files that its scenes name.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::scene_reader(bytes));
