//! Any bytes are a scene or a list of errors with locations that can be printed: with all models, integrators and obstacles of the library, and the
//! files that its scenes name.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::scene_reader(bytes));
