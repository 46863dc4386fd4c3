//! Frames without states that go to the system together form one chunk, so that a kill costs at most one chunk.

use super::*;
use opruga_io::recording::RecordingFile;
use std::sync::{Arc, Mutex};

/// The number of frames after which a state is kept and the others are given to the system.
const EVERY: u64 = 7;
const TOGETHER: u64 = 3;

/// A recording with the two inputs before frame 66 and the one before 71, as the program writes it.
fn written<T>(
    out: T,
    frames: core::ops::Range<u64>,
    mut each: impl FnMut(&T, u64),
    add: impl Fn(&mut T, u64, bool),
) -> T {
    let mut out = out;
    for frame in frames.clone() {
        add(&mut out, frame, (frame - frames.start).is_multiple_of(EVERY));
        each(&out, frame);
    }
    out
}

fn in_memory(frames: core::ops::Range<u64>) -> Vec<u8> {
    let mut memory = Memory::default();
    let begun = Writer::new(&mut memory, &Header { every: EVERY, ..header() }).expect("memory does not fail");
    let first = frames.start;
    let mut writer = written(
        begun,
        frames.clone(),
        |_, _| {},
        |writer, frame, kept| {
            inputs(frame).iter().for_each(|input| writer.input(frame, input).expect("before its frame"));
            add(writer, frame, kept).expect("in order");
            if (frame - first).is_multiple_of(TOGETHER) {
                writer.flush().expect("memory does not fail");
            }
        },
    );
    let last = frames.end - 1;
    writer.keep(last, hash(last), &mut state(last)).expect("the last state");
    writer.finish().expect("memory does not fail");
    drop(writer);
    memory.0
}

#[test]
fn hashes_come_back_in_any_order() {
    for frames in [60..94u64, 60..62, 3..400] {
        let bytes = in_memory(frames.clone());
        let count = frames.end - frames.start;
        let scattered: Vec<u64> = (0..count).map(|k| frames.start + (k * 61 + 17) % count).collect();
        for order in [frames.clone().collect::<Vec<_>>(), frames.clone().rev().collect(), scattered] {
            let mut recording = open(&bytes).expect("a recording");
            assert_eq!((recording.frames(), recording.ending()), (frames.clone(), &Ending::Closed));
            for frame in order {
                assert_eq!(recording.hash(frame), Ok(hash(frame)), "frame {frame}");
                let kept = recording.kept(frame).expect("a state before");
                assert_eq!(recording.read(kept), Ok(&state(kept)[..]), "frame {frame}");
            }
        }
        // Truncated at any byte, it ends with a complete chunk, and every frame up to there has its hash.
        let whole = open(&bytes).expect("a recording");
        for length in (300..bytes.len()).rev().filter(|length| bytes.len() - length < 3000) {
            let Ok(mut cut) = open(&bytes[..length]) else { continue };
            assert!(matches!(cut.ending(), Ending::Open { .. }), "{length}: {:?}", cut.ending());
            assert!(cut.frames().end <= whole.frames().end);
            for frame in cut.frames() {
                assert_eq!(cut.hash(frame), Ok(hash(frame)), "frame {frame} of {length} bytes");
            }
        }
    }
}

/// Row 82: a flipped bit in chunks of hashes is an error or is reported, and no hash or state is ever wrong.
#[test]
fn a_flipped_bit_among_hashes_is_found() {
    let good = in_memory(60..77);
    for place in 250..good.len() {
        let mut bad = good.clone();
        bad[place] ^= 4;
        let Ok(mut recording) = open(&bad) else { continue };
        let mut errors = u32::from(matches!(recording.ending(), Ending::Damaged(_)));
        for frame in recording.frames() {
            match recording.hash(frame) {
                Ok(read) => assert_eq!(read, hash(frame), "byte {place}, frame {frame}"),
                Err(_) => errors += 1,
            }
            let kept = recording.kept(frame).expect("a state before");
            match recording.read(kept) {
                Ok(read) => assert_eq!(read, state(kept), "byte {place}, frame {frame}"),
                Err(_) => errors += 1,
            }
        }
        let count = recording.inputs().count();
        errors += (0..count).filter(|number| recording.input(*number).is_err()).count() as u32;
        assert!(errors > 0, "byte {place} was flipped unnoticed");
    }
}

/// The data that the system was given, piece by piece.
#[derive(Clone, Default)]
struct Given(Arc<Mutex<Vec<Vec<u8>>>>);

impl Write for Given {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("nobody has failed").push(buffer.to_vec());
        Ok(buffer.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Target for Given {
    fn sync(&self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Row 79, the cost of a kill: every chunk is given to the system separately, in one piece, before the next one begins. At any moment at most one
/// chunk is therefore missing: the one to which frames are still being added, or that is being written.
#[test]
fn every_chunk_is_given_to_the_system_before_the_next_is_begun() {
    let folder = std::env::temp_dir().join(format!("opruga-recordings-together-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the test");
    let given = Given::default();
    let wrap = given.clone();
    let head = Header { every: EVERY, ..header() };
    let begun = RecordingFile::create_through(&folder.join("r"), true, &head, move |_| wrap).expect("a file");
    let there = || given.0.lock().expect("nobody has failed").concat();
    let missing = |_: &RecordingFile, frame: u64| {
        // The missing frames belong to one chunk.
        let bytes = there();
        let last = open(&bytes).expect("a recording").frames().end - 1;
        assert!(frame - last < TOGETHER, "frame {frame} was added, {last} are there");
    };
    let mut file = written(begun, 60..94, missing, |file, frame, kept| {
        for input in inputs(frame) {
            file.input(frame, &input).expect("before its frame");
            assert!(there().ends_with(&input), "it is there at once");
        }
        match kept {
            true => file.keep(frame, hash(frame), |out| out.extend(state(frame))).expect("in order"),
            false => file.push(frame, hash(frame)).expect("in order"),
        }
        if (frame - 60).is_multiple_of(TOGETHER) {
            file.flush().expect("written");
        }
    });
    file.keep(93, hash(93), |out| out.extend(state(93))).expect("the last state");
    let pieces = given.0.lock().expect("nobody has failed").clone();
    let mut together = 0;
    // After the beginning of the file.
    for piece in &pieces[1..] {
        let payload = piece[24..32].iter().rev().fold(0, |all, byte| all << 8 | usize::from(*byte));
        assert_eq!(piece.len(), 48 + payload, "one chunk, and all of it");
        together += usize::from(piece[4] == 4 && payload > 0);
    }
    assert!(together > 3 && pieces.len() > 20, "{together} of {}", pieces.len());
    drop(file);
    std::fs::remove_dir_all(folder).expect("the folder is there");
}
