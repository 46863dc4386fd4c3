//! Any bytes are a recording whose frames and inputs can be asked for, or a typed error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga_io::recording::Recording;
use opruga_world::Input;
use std::io::Cursor;

fuzz_target!(|bytes: &[u8]| {
    // What a program did stands in chunks of its own.
    let _ = Input::<2>::from_bytes(bytes);
    let _ = Input::<3>::from_bytes(bytes);
    let Ok(mut recording) = Recording::open(Cursor::new(bytes)) else { return };
    for frame in recording.frames().take(100) {
        let _ = recording.read(frame);
    }
    for number in 0..recording.inputs().count().min(100) {
        let _ = recording.input(number);
    }
});
