//! Recordings: every frame comes back, a cut costs its chunk at most, and no damage goes unnoticed. The numbers are rows of
//! a list of torments.

use opruga_io::recording::{Asset, Ending, Header, Recording, RecordingError, RecordingFile, Writer};
use opruga_io::safe_write::{Failing, Target};
use proptest::prelude::*;
use std::fs::{File, OpenOptions};
use std::io::{Cursor, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("opruga-recordings-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir(&path).expect("a folder for the test");
    path
}

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

/// The state of a frame: numbers that move; a body comes at frame 70, and a text of five bytes at frame 90.
fn state(frame: u64) -> Vec<u8> {
    let nodes = if frame < 70 { 6 } else { 9 };
    let mut out: Vec<u8> = frame.to_le_bytes().to_vec();
    out.extend((0..nodes).flat_map(|k| (f64::from(k) + 0.01 * frame as f64).to_le_bytes()));
    if frame >= 90 {
        out.extend(b"pulls");
    }
    out
}

/// The hash that a program gives a frame.
fn hash(frame: u64) -> u64 {
    (frame + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15)
}

/// Adds a frame with its state, or without.
fn add(writer: &mut Writer<impl Target>, frame: u64, kept: bool) -> std::io::Result<()> {
    if kept { writer.keep(frame, hash(frame), &mut state(frame)) } else { writer.push(frame, hash(frame)) }
}

/// What a program did before a frame: nothing, mostly.
fn inputs(frame: u64) -> Vec<Vec<u8>> {
    match frame {
        66 => vec![b"drag".to_vec(), Vec::new()],
        71 => vec![b"set the gravity".to_vec()],
        _ => Vec::new(),
    }
}

/// The bytes of a recording of some frames, with its end or without.
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
            assert_eq!(error, RecordingError::NoFrame { frame: frames.end, frames: frames.clone() });
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

/// One state in five, and the last; every frame has its hash. What lies between is told from what is not there; inputs keep
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
            // The run ends: the state of its last frame comes behind that.
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
    // Cut off anywhere it ends with a frame whose hash is there, though its state may not be: it follows from the one before.
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

/// Row 79: cut off at any byte, as by a kill, a recording loses the chunk that was cut and nothing else.
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

/// Row 82: one flipped bit anywhere, of any byte, is an error, or (where the end is gone) said; no frame is ever wrong.
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

/// A chunk of another recording, whole in itself, does not fit.
#[test]
fn chunks_of_another_recording_are_refused() {
    let mine = recorded(0..4, false);
    let mut memory = Memory::default();
    let foreign = Header { name: "cubes".into(), ..header() };
    let mut writer = Writer::new(&mut memory, &foreign).expect("memory does not fail");
    (0..8).for_each(|frame| add(&mut writer, frame, true).expect("in order"));
    writer.flush().expect("memory does not fail");
    // Names of the same length: the chunks lie at the same places.
    let joined = [&mine[..], &memory.0[mine.len()..]].concat();
    let recording = open(&joined).expect("the head is whole");
    assert_eq!(recording.frames(), 0..4);
    assert!(matches!(recording.ending(), Ending::Damaged(_)), "{:?}", recording.ending());
}

#[test]
fn other_files_and_other_versions_are_refused() {
    for bytes in [&b""[..], b"PK\x03\x04 this is an archive", b"OPRUGA\x1a\n and so on", &[0; 300]] {
        assert_eq!(open(bytes).err(), Some(RecordingError::NotOne));
    }
    // Older ones lack the hashes of frames.
    for version in [1, 2, 3, 99] {
        let mut other = recorded(0..2, true);
        other[8] = version;
        let sum = crc32fast::hash(&other[..20]);
        other[20..24].copy_from_slice(&sum.to_le_bytes());
        assert_eq!(open(&other).err(), Some(RecordingError::Version { found: version.into() }));
    }
}

/// Row 83: the disk fails at any byte, or only when the bytes shall last: an error with the number of bytes, and a file
/// whose frames are right.
#[test]
fn a_disk_that_fails_at_any_byte_leaves_whole_frames() {
    let folder = folder("failing");
    let whole = recorded(68..72, true);
    let path = folder.join("r");
    for k in 0..=whole.len() as u64 {
        let _ = std::fs::remove_file(&path);
        let outcome = RecordingFile::create_through(&path, false, &header(), |file| Failing::after(k, file)).and_then(
            |mut file| {
                for frame in 68..72 {
                    inputs(frame).iter().try_for_each(|input| file.input(frame, input))?;
                    file.keep(frame, hash(frame), |out| out.extend(state(frame)))?;
                }
                file.finish()
            },
        );
        if k == whole.len() as u64 {
            assert_eq!(outcome, Ok(k));
            assert_eq!(std::fs::read(&path).expect("a file"), whole, "the same frames are the same bytes");
            continue;
        }
        let error = outcome.expect_err("the disk is full");
        assert_eq!((error.code, error.exit_code(), &error.path), ("write.failed", 4, &path), "{k}");
        match File::open(&path) {
            // It does not get its name before its head is whole.
            Err(_) => assert!(k < 300 && std::fs::read_dir(&folder).expect("a folder").count() == 0, "{k}"),
            Ok(file) => {
                assert_eq!(error.bytes, k);
                let mut recording = Recording::open(file).expect("a whole head");
                assert!(matches!(recording.ending(), Ending::Open { .. }), "{k}: {:?}", recording.ending());
                for frame in recording.frames() {
                    assert_eq!(recording.read(frame), Ok(&state(frame)[..]));
                }
            }
        }
    }
    std::fs::remove_file(&path).expect("the last one");
    let error = RecordingFile::create_through(&path, false, &header(), |file| Failing::at_sync(5, file))
        .expect_err("it does not last");
    assert!(error.code == "write.failed" && !path.exists(), "{error}");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Rows 84 to 86: what is there stays, unless it shall be replaced; nobody else's recording is taken over; no device.
#[test]
fn an_earlier_file_stays_until_the_new_one_has_begun() {
    let folder = folder("earlier");
    let path = folder.join("r");
    std::fs::write(&path, b"old").expect("a file");
    let create = |path: &std::path::Path, force| RecordingFile::create(path, force, &header());
    assert_eq!(create(&path, false).expect_err("it is there").code, "write.exists");
    for k in 0..100 {
        RecordingFile::create_through(&path, true, &header(), |file| Failing::after(k, file)).expect_err("no space");
        assert_eq!(std::fs::read(&path).expect("still there"), b"old");
    }
    let first = create(&path, true).expect("it is replaced");
    let error = create(&path, true).expect_err("it is being written");
    assert_eq!((error.code, error.hint.is_some()), ("write.locked", true));
    drop(first);
    create(&path, true).and_then(RecordingFile::finish).expect("it is free again");
    for (path, text) in [(folder.as_path(), "a folder"), (path.join("no/r").as_path(), "error[write.failed]")] {
        let error = create(path, true).expect_err("no place for a file");
        assert!(error.code == "write.failed" && error.to_string().contains(text), "{error}");
    }
    let nested = folder.join("some/where/r");
    create(&nested, false).and_then(RecordingFile::finish).expect("the folders around it are made");
    std::fs::remove_dir_all(folder.join("some")).expect("they are there");
    #[cfg(target_os = "linux")]
    {
        let full = std::path::Path::new("/dev/full");
        let error = create(full, true).expect_err("a device");
        assert!(error.message.contains("no regular file") && full.exists(), "{error}");
    }
    assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left aside");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// A file whose bytes from a place on lie 6 GiB farther: a hole that takes no room on the disk.
struct Sparse {
    file: File,
    at: u64,
    hole: u64,
}

const GAP: u64 = 6 << 30;

impl Write for Sparse {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        if self.at == self.hole {
            self.file.seek(SeekFrom::Current(GAP as i64))?;
        }
        let n = self.file.write(buffer)?;
        self.at += n as u64;
        Ok(n)
    }
    fn flush(&mut self) -> std::io::Result<()> {
        self.file.flush()
    }
}

impl Target for &mut Sparse {
    fn sync(&self) -> std::io::Result<()> {
        Ok(())
    }
}

/// Row 89: places beyond 4 GiB and frames beyond 2³² are found. One chunk is 6 GiB long, most of it a hole.
#[test]
fn places_and_frames_beyond_32_bits_are_found() {
    let folder = folder("sparse");
    let path = folder.join("r");
    let first = (1u64 << 32) + 3;
    let mut plain = Memory::default();
    let mut writer = Writer::new(&mut plain, &header()).expect("memory does not fail");
    let start = writer.bytes();
    writer.keep(first, 7, &mut state(80)).expect("the first");
    writer.flush().expect("memory does not fail");
    let second = writer.bytes();
    drop(writer);
    // The head of the first chunk, made to say that its payload is longer by the hole.
    let identity = crc32fast::hash(&plain.0[24..start as usize - 4]);
    let head = &mut plain.0[start as usize..];
    let payload = second - start - 48 + GAP;
    head[24..32].copy_from_slice(&payload.to_le_bytes());
    let sum = crc32fast::hash(&[&identity.to_le_bytes()[..], &head[..44]].concat());
    head[44..48].copy_from_slice(&sum.to_le_bytes());

    let file = OpenOptions::new().read(true).write(true).create_new(true).open(&path).expect("a file");
    let mut sparse = Sparse { file, at: 0, hole: second };
    let mut writer = Writer::new(&mut sparse, &header()).expect("a file");
    writer.keep(first, 7, &mut state(80)).expect("the first");
    writer.flush().expect("a file");
    for k in 1..130 {
        writer.keep(first + k, hash(k), &mut state(60 + k)).expect("in order");
    }
    writer.flush().expect("a file");
    drop(writer);
    let mut file = sparse.file;
    file.seek(SeekFrom::Start(start)).expect("a place");
    file.write_all(&plain.0[start as usize..start as usize + 48]).expect("a head");
    assert!(file.metadata().expect("a file").len() > GAP);

    let mut recording = Recording::open(&file).expect("a recording");
    assert_eq!(recording.frames(), first..first + 130);
    assert_eq!(recording.ending(), &Ending::Open { lost: 0 });
    for k in [129, 64, 100, 65] {
        assert_eq!(recording.read(first + k), Ok(&state(60 + k)[..]), "frame {k} behind the first");
    }
    // With its end the same file is read by its index.
    let mut pairs = Vec::new();
    let end = file.seek(SeekFrom::End(0)).expect("a place");
    let mut place = start;
    while place < end {
        let mut head = [0; 48];
        file.seek(SeekFrom::Start(place)).and_then(|_| file.read_exact(&mut head)).expect("a head");
        if head[4] == 0 {
            pairs.extend([&head[8..16], &place.to_le_bytes()].concat());
        }
        place += 48 + u64::from_le_bytes(head[24..32].try_into().expect("eight bytes"));
    }
    let sealed = |bytes: &[u8]| {
        let sum = crc32fast::hash(&[&identity.to_le_bytes()[..], bytes].concat());
        [bytes, &sum.to_le_bytes()].concat()
    };
    let pairs = [&(first + 129).to_le_bytes()[..], &(pairs.len() as u64 / 16).to_le_bytes(), &pairs].concat();
    let length = (pairs.len() as u64).to_le_bytes();
    let head = [b"INDX\x02\0\0\0", &(first + 130).to_le_bytes()[..], &length, &length];
    let head = [&head.concat()[..], &[0; 8], &crc32fast::hash(&pairs).to_le_bytes()].concat();
    let tail = [&sealed(&head)[..], &pairs, &sealed(&end.to_le_bytes()), b"OPREND\x1a\n"].concat();
    file.seek(SeekFrom::End(0)).and_then(|_| file.write_all(&tail)).expect("the end");
    let mut recording = Recording::open(&file).expect("a recording");
    assert_eq!((recording.frames(), recording.ending()), (first..first + 130, &Ending::Closed));
    for k in [129, 64, 100, 65] {
        assert_eq!(recording.read(first + k), Ok(&state(60 + k)[..]), "frame {k} behind the first");
    }
    drop(file);
    std::fs::remove_dir_all(folder).expect("the folder is there");
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
