//! Any bytes are a checkpoint or a typed error.
#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = opruga_io::checkpoint::Checkpoint::read(bytes);
});
