//! Recordings: every frame can be read again, a truncation costs at most its chunk, and no damage goes unnoticed. The numbers are rows of the torture
//! list.

mod files;
mod together;

use opruga_io::recording::{Asset, Ending, Header, Recording, RecordingError, Writer};
use opruga_io::safe_write::Target;
use proptest::prelude::*;
use std::io::{Cursor, Write};

/// A target in memory.
#[derive(Debug, Default)]
struct Memory(Vec<u8>);

impl Write for Memory {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        self.0.write(buffer)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl Target for &mut Memory {
    fn sync(&self) -> std::io::Result<()> {
        Ok(())
    }
}

fn header() -> Header {
    Header {
        program: "opruga 0.1.0".into(),
        name: "balls".into(),
        file: "scenes/balls.toml".into(),
        scene: b"format = \"opruga-1\"\n".to_vec(),
        frame: 1.0 / 60.0,
        every: 1,
        overrides: vec![("time.substeps".into(), "64".into()), ("world.gravity".into(), "[0, 0]".into())],
        lenient: true,
        allow_unstable: false,
        assets: vec![Asset { name: "beam.msh".into(), bytes: vec![0, 255, 10] }],
    }
}

/// The state of a frame: numbers that change; a body is added at frame 70, and a text of five bytes at frame 90.
fn state(frame: u64) -> Vec<u8> {
    let nodes = if frame < 70 { 6 } else { 9 };
    let mut out: Vec<u8> = frame.to_le_bytes().to_vec();
    out.extend((0..nodes).flat_map(|k| (f64::from(k) + 0.01 * frame as f64).to_le_bytes()));
    if frame >= 90 {
        out.extend(b"pulls");
    }
    out
}

/// The hash that a program computes for a frame.
fn hash(frame: u64) -> u64 {
    (frame + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Adds a frame with or without its state.
fn add(writer: &mut Writer<impl Target>, frame: u64, kept: bool) -> std::io::Result<()> {
    if kept { writer.keep(frame, hash(frame), &mut state(frame)) } else { writer.push(frame, hash(frame)) }
}

/// The actions of a program before a frame: usually none.
fn inputs(frame: u64) -> Vec<Vec<u8>> {
    match frame {
        66 => vec![b"drag".to_vec(), Vec::new()],
        71 => vec![b"set the gravity".to_vec()],
        _ => Vec::new(),
    }
}

/// The bytes of a recording of some frames, with or without its end.
fn recorded(frames: core::ops::Range<u64>, closed: bool) -> Vec<u8> {
    let mut memory = Memory::default();
    let mut writer = Writer::new(&mut memory, &header()).expect("memory does not fail");
    for frame in frames {
        for input in inputs(frame) {
            writer.input(frame, &input).expect("before its frame");
        }
        add(&mut writer, frame, true).expect("frames in order");
    }
    writer.flush().expect("memory does not fail");
    if closed {
        writer.finish().expect("memory does not fail");
    }
    memory.0
}

fn open(bytes: &[u8]) -> Result<Recording<Cursor<&[u8]>>, RecordingError> {
    Recording::open(Cursor::new(bytes))
}

#[test]
fn every_frame_comes_back_in_any_order() {
    for closed in [true, false] {
        for frames in [0..200u64, 7..8, 5..5] {
            let bytes = recorded(frames.clone(), closed);
            let mut recording = open(&bytes).expect("a recording");
            assert_eq!(recording.header(), &header());
            let ending = if closed { Ending::Closed } else { Ending::Open { lost: 0 } };
            assert_eq!(recording.ending(), &ending);
            if frames.is_empty() {
                assert!(recording.frames().is_empty());
                continue;
            }
            assert_eq!(recording.frames(), frames);
            let scattered = frames.clone().map(|k| frames.start + (k * 61 + 17) % (frames.end - frames.start));
            for frame in frames.clone().chain(scattered) {
                assert_eq!(recording.read(frame), Ok(&state(frame)[..]), "frame {frame}");
                assert_eq!(recording.hash(frame), Ok(hash(frame)), "frame {frame}");
            }
            let wanted: Vec<(u64, Vec<u8>)> =
                frames.clone().flat_map(|frame| inputs(frame).into_iter().map(move |input| (frame, input))).collect();
            assert_eq!(recording.inputs().collect::<Vec<_>>(), wanted.iter().map(|w| w.0).collect::<Vec<_>>());
            for (number, (_, bytes)) in wanted.iter().enumerate() {
                assert_eq!(recording.input(number), Ok(bytes.clone()), "input {number}");
            }
            assert!(recording.input(wanted.len()).is_err());
            let error = recording.read(frames.end).expect_err("no such frame");
            assert_eq!(error, RecordingError::no_frame(frames.end, &frames));
        }
    }
}

#[test]
fn frames_out_of_order_are_refused_and_left_out() {
    let mut memory = Memory::default();
    let mut writer = Writer::new(&mut memory, &header()).expect("memory does not fail");
    assert!(writer.push(3, hash(3)).is_err() && writer.input(3, b"early").is_err(), "the first has its state");
    add(&mut writer, 3, true).expect("the first may have any number");
    for wrong in [0, 3, 5] {
        assert!(add(&mut writer, wrong, true).is_err(), "frame {wrong}");
        assert!(writer.input(wrong, b"late").is_err(), "before frame {wrong}");
    }
    assert!(add(&mut writer, 4, false).is_err(), "its state is due");
    add(&mut writer, 4, true).expect("the next one");
    writer.finish().expect("memory does not fail");
    assert_eq!(open(&memory.0).expect("a recording").frames(), 3..5);
}

/// One state in five, and the last; every frame has its hash. States that are not kept are distinguished from frames that do not exist; inputs keep
/// their frames.
#[test]
fn states_are_kept_as_far_apart_as_the_header_says() {
    let written = |frames: core::ops::Range<u64>, closed: bool| {
        let mut memory = Memory::default();
        let header = Header { every: 5, ..header() };
        let mut writer = Writer::new(&mut memory, &header).expect("memory does not fail");
        for frame in frames.clone() {
            inputs(frame).iter().for_each(|input| writer.input(frame, input).expect("before its frame"));
            let kept = (frame - frames.start).is_multiple_of(5);
            add(&mut writer, frame, kept).expect("in order");
            // The run ends: the state of its last frame follows that frame.
            if frame + 1 == frames.end && !kept {
                add(&mut writer, frame, true).expect("the last state");
                assert!(writer.push(frames.end, 0).is_err(), "it was the last");
            }
        }
        assert!(add(&mut writer, frames.end + 5, true).is_err(), "it lies too far behind");
        writer.flush().expect("memory does not fail");
        if closed {
            writer.finish().expect("memory does not fail");
        }
        memory.0
    };
    for (frames, closed) in [(60..93, true), (60..93, false), (60..91, true), (3..700, true), (3..700, false)] {
        let bytes = written(frames.clone(), closed);
        let mut recording = open(&bytes).expect("a recording");
        assert_eq!((recording.frames(), recording.header().every), (frames.clone(), 5));
        assert!(!matches!(recording.ending(), Ending::Damaged(_)), "{:?}", recording.ending());
        for frame in frames.clone().rev().chain(frames.clone()) {
            let wanted = if frame + 1 == frames.end { frame } else { frame - (frame - frames.start) % 5 };
            assert_eq!((recording.kept(frame), recording.hash(frame)), (Ok(wanted), Ok(hash(frame))));
            match recording.read(frame) {
                Ok(read) => assert!(wanted == frame && read == state(frame), "{frame}"),
                Err(error) => assert_eq!((wanted == frame, error.code()), (false, "recording.not_kept")),
            }
        }
        assert!(recording.kept(frames.end).is_err());
        let wanted: Vec<u64> = frames.flat_map(|frame| inputs(frame).into_iter().map(move |_| frame)).collect();
        assert_eq!(recording.inputs().collect::<Vec<_>>(), wanted);
        for (number, frame) in wanted.into_iter().enumerate() {
            assert!(inputs(frame).contains(&recording.input(number).expect("an input")));
        }
    }
    // Truncated anywhere, it ends with a frame whose hash exists, though its state may not: it can be computed from the previous one.
    let whole = written(60..93, false);
    let (mut reached, mut without) = (0, 0);
    for length in 400..whole.len() {
        let Ok(mut recording) = open(&whole[..length]) else { continue };
        assert!(matches!(recording.ending(), Ending::Open { .. }), "{length}");
        if let Some(last) = recording.frames().last() {
            let kept = recording.kept(last).expect("a state before");
            assert_eq!(recording.hash(last), Ok(hash(last)), "{length}");
            assert_eq!(recording.read(kept), Ok(&state(kept)[..]), "{length}");
            (reached, without) = (last, without + u32::from(kept < last));
        }
    }
    assert!(reached == 92 && without > 100, "{reached}, {without}");
}

/// Row 79: truncated at any byte, as by a kill, a recording loses the truncated chunk and nothing else.
#[test]
fn a_recording_that_is_cut_anywhere_keeps_all_frames_before() {
    for closed in [true, false] {
        let whole = recorded(60..75, closed);
        let mut kept = 0;
        let mut heads = 0;
        for length in 0..whole.len() {
            match open(&whole[..length]) {
                Err(error) => {
                    assert!(kept == 0 && length < 400, "{length}: {error}");
                    let code = error.code();
                    assert!(code == "recording.cut_off" || length == 0 && code == "recording.not_one", "{error}");
                    heads += 1;
                }
                Ok(mut recording) => {
                    let Ending::Open { lost } = *recording.ending() else { panic!("{:?}", recording.ending()) };
                    let frames = recording.frames();
                    assert!((lost as usize) < 200 && frames.end.saturating_sub(60) >= kept, "{length}: lost {lost}");
                    kept = frames.end.saturating_sub(60);
                    for frame in frames {
                        assert_eq!(recording.read(frame), Ok(&state(frame)[..]), "frame {frame} of {length} bytes");
                        assert_eq!(recording.hash(frame), Ok(hash(frame)), "frame {frame} of {length} bytes");
                    }
                }
            }
        }
        assert!(heads > 24 && kept == if closed { 15 } else { 14 }, "{kept} frames");
    }
}

/// Row 82: any single flipped bit is an error or, if the end is gone, is reported; no frame is ever wrong.
#[test]
fn a_flipped_bit_anywhere_is_found() {
    let good = recorded(60..75, true);
    for place in 0..good.len() {
        for bit in [1, 16, 128] {
            let mut bad = good.clone();
            bad[place] ^= bit;
            let mut recording = match open(&bad) {
                Err(error) => {
                    assert!(place < 300, "{place}: {error}");
                    continue;
                }
                Ok(recording) => recording,
            };
            assert_eq!(recording.header(), &header(), "byte {place}");
            let mut errors = u32::from(matches!(recording.ending(), Ending::Damaged(_)));
            assert!(!matches!(recording.ending(), Ending::Open { .. }), "byte {place} is taken for a kill");
            for frame in recording.frames() {
                if let Ok(read) = recording.hash(frame) {
                    assert_eq!(read, hash(frame), "byte {place}, frame {frame}");
                }
                match recording.read(frame) {
                    Ok(read) => assert_eq!(read, state(frame), "byte {place}, frame {frame}"),
                    Err(error) => {
                        let RecordingError::Damaged { from, to } = error else { panic!("{error}") };
                        assert!((from..to).contains(&(place as u64)), "byte {place}: {error}");
                        errors += 1;
                    }
                }
            }
            for (number, frame) in recording.inputs().collect::<Vec<_>>().into_iter().enumerate() {
                let wanted = inputs(frame).into_iter().nth(usize::from(number == 1)).expect("an input");
                match recording.input(number) {
                    Ok(bytes) => assert_eq!(bytes, wanted, "byte {place}, input {number}"),
                    Err(_) => errors += 1,
                }
            }
            assert!(errors > 0, "byte {place} was flipped unnoticed");
        }
    }
    let other = [&good[..], b"x"].concat();
    assert!(matches!(open(&other).expect("whole frames").ending(), Ending::Damaged(_)), "something follows the end");
}

/// A chunk of another recording is refused although it is intact.
#[test]
fn chunks_of_another_recording_are_refused() {
    let mine = recorded(0..4, false);
    let mut memory = Memory::default();
    let foreign = Header { name: "cubes".into(), ..header() };
    let mut writer = Writer::new(&mut memory, &foreign).expect("memory does not fail");
    (0..8).for_each(|frame| add(&mut writer, frame, true).expect("in order"));
    writer.flush().expect("memory does not fail");
    // The names have the same length, so the chunks have the same offsets.
    let joined = [&mine[..], &memory.0[mine.len()..]].concat();
    let recording = open(&joined).expect("the head is whole");
    assert_eq!(recording.frames(), 0..4);
    assert!(matches!(recording.ending(), Ending::Damaged(_)), "{:?}", recording.ending());
}

#[test]
fn other_files_and_other_versions_are_refused() {
    for bytes in [&b""[..], b"PK\x03\x04 this is an archive", b"OPRUGA\x1a\n and so on", &[0; 300]] {
        assert_eq!(open(bytes).err(), Some(RecordingError::NotOne {}));
    }
    // Older versions lack the hashes of frames.
    for version in [1, 2, 3, 4, 7, 99] {
        let mut other = recorded(0..2, true);
        other[8] = version;
        let sum = crc32fast::hash(&other[..20]);
        other[20..24].copy_from_slice(&sum.to_le_bytes());
        assert_eq!(open(&other).err(), Some(RecordingError::Version { found: version.into() }));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(open(&bytes).is_err());
    }

    #[test]
    fn mutated_recordings_give_right_frames_or_errors(changes in proptest::collection::vec((any::<u16>(), 0..3u8, any::<u8>(), 0..80usize), 1..5)) {
        let mut bytes = recorded(60..75, true);
        for (at, how, byte, length) in changes {
            let at = usize::from(at) % bytes.len();
            let end = (at + length).min(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => drop(bytes.drain(at..end)),
                _ => { let piece = bytes[at..end].to_vec(); bytes.splice(at..at, piece); }
            }
            if bytes.is_empty() {
                break;
            }
        }
        if let Ok(mut recording) = open(&bytes) {
            for frame in recording.frames() {
                if let Ok(read) = recording.read(frame) {
                    prop_assert_eq!(read, &state(frame)[..]);
                }
                if let Ok(read) = recording.hash(frame) {
                    prop_assert_eq!(read, hash(frame));
                }
            }
            for (number, frame) in recording.inputs().collect::<Vec<_>>().into_iter().enumerate() {
                if let Ok(read) = recording.input(number) {
                    prop_assert!(inputs(frame).contains(&read));
                }
            }
        }
    }
}
