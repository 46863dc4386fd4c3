//! Recordings on a disk: a full one, one with another file of the same name, and one with offsets beyond 4 GiB.

use super::*;
use opruga_io::recording::RecordingFile;
use opruga_io::safe_write::Failing;
use std::fs::{File, OpenOptions};
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("opruga-recordings-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir(&path).expect("a folder for the test");
    path
}

/// Row 83: the disk fails at any byte, or only when it is synced. The result is an error with the number of bytes, and a file whose frames are right.
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
        assert_eq!((error.code(), error.exit_code(), &error.path), ("write.failed", 4, &path), "{k}");
        match File::open(&path) {
            // The file does not get its name before its header is complete.
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
    // A disk that cannot be synced: a recording that would replace another file is refused at once, a new one at its end.
    let fails = |force| RecordingFile::create_through(&path, force, &header(), |file| Failing::at_sync(5, file));
    let error = fails(false).and_then(RecordingFile::finish).expect_err("it does not last");
    assert!(error.code() == "write.failed" && path.exists(), "{error}");
    std::fs::write(&path, b"earlier").expect("a file");
    let error = fails(true).expect_err("it does not last");
    assert!(error.code() == "write.failed" && std::fs::read(&path).is_ok_and(|there| there == b"earlier"), "{error}");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Rows 84 to 86: an existing file stays unless it is to be replaced; a recording that another process writes, or a device, is not replaced.
#[test]
fn an_earlier_file_stays_until_the_new_one_has_begun() {
    let folder = folder("earlier");
    let path = folder.join("r");
    std::fs::write(&path, b"old").expect("a file");
    let create = |path: &std::path::Path, force| RecordingFile::create(path, force, &header());
    assert_eq!(create(&path, false).expect_err("it is there").code(), "write.exists");
    for k in 0..100 {
        RecordingFile::create_through(&path, true, &header(), |file| Failing::after(k, file)).expect_err("no space");
        assert_eq!(std::fs::read(&path).expect("still there"), b"old");
    }
    let first = create(&path, true).expect("it is replaced");
    let error = create(&path, true).expect_err("it is being written");
    assert_eq!((error.code(), error.about.hint().is_some()), ("write.locked", true));
    drop(first);
    create(&path, true).and_then(RecordingFile::finish).expect("it is free again");
    for (path, text) in [(folder.as_path(), "a folder"), (path.join("no/r").as_path(), "error[write.failed]")] {
        let error = create(path, true).expect_err("no place for a file");
        assert!(error.code() == "write.failed" && error.to_string().contains(text), "{error}");
    }
    let nested = folder.join("some/where/r");
    create(&nested, false).and_then(RecordingFile::finish).expect("the folders around it are made");
    std::fs::remove_dir_all(folder.join("some")).expect("they are there");
    #[cfg(target_os = "linux")]
    {
        let full = std::path::Path::new("/dev/full");
        let error = create(full, true).expect_err("a device");
        assert!(error.about.to_string().contains("not a regular file") && full.exists(), "{error}");
    }
    assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left aside");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// A file whose bytes from some offset on are moved by 6 GiB: a hole that takes no space on the disk.
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

/// Row 89: offsets beyond 4 GiB and frames beyond 2³² are found. One chunk is 6 GiB long, most of it a hole.
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
    // The head of the first chunk, changed so that its payload is longer by the hole.
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
    // With its end, the same file is read by its index.
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
