//! Any bytes are a scene or a list of errors with places that can be printed: with all models, integrators and obstacles that
//! the library has, and the files that its scenes name.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga::io::scene::{Limits, Options, read};

fuzz_target!(|bytes: &[u8]| {
    let limits = Limits { nodes: 20_000, bodies: 2_000, memory_bytes: 64 << 20, ..Limits::default() };
    let options = Options { limits, files: opruga::scenes::files(), ..Options::default() };
    if let Err(errors) = read(bytes, "fuzz.toml", &opruga::catalogue(), &options) {
        assert!(!errors.is_empty());
        for error in errors {
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
});
