//! The file of a recording, written beside the run: the run hands frames over, a thread codes and writes them.

use super::format::Header;
use super::writer::Writer;
use crate::safe_write::{Target, WriteError, aside_name, sync_folder};
use std::fs::{self, File, OpenOptions};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Frames are handed over when so many bytes have come together …
const BATCH: usize = 1 << 18;
/// … or when so much time has passed: what a kill may cost.
const HANDED_OVER: Duration = Duration::from_millis(50);
/// Batches that may wait for the disk before the run waits too.
const WAITING: usize = 4;
/// What a loss of power may cost.
const SYNCED: Duration = Duration::from_secs(5);

/// States of frames and inputs, one behind the other.
#[derive(Debug, Default)]
struct Batch {
    bytes: Vec<u8>,
    parts: Vec<Part>,
}

/// A part of a batch.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// Whether it is what a program did, and no state.
    input: bool,
    /// The frame; of an input, the one that comes after it.
    frame: u64,
    /// Where it ends.
    end: usize,
}

/// A recording that is being written. A process that is killed leaves all frames but those of its last twentieth of a
/// second, a loss of power those of the last five seconds.
#[derive(Debug)]
pub struct RecordingFile {
    path: PathBuf,
    batch: Batch,
    handed_over: Instant,
    full: Option<SyncSender<Batch>>,
    empty: Receiver<Batch>,
    thread: Option<JoinHandle<Result<u64, WriteError>>>,
}

impl RecordingFile {
    /// Makes the file with its header. With `force` an earlier file is replaced as soon as the header is written.
    ///
    /// # Errors
    /// `write.exists` where the file is there and `force` is not given, `write.locked` where another process writes it,
    /// `write.failed` where it cannot be written or is no regular file. In all cases the earlier file is whole.
    pub fn create(path: &Path, force: bool, header: &Header) -> Result<RecordingFile, WriteError> {
        RecordingFile::create_through(path, force, header, |file| file)
    }

    /// [`RecordingFile::create`] through a target of the caller's making: for tests that let the disk fail.
    ///
    /// # Errors
    /// As [`RecordingFile::create`].
    pub fn create_through<W: Target + Send + 'static>(
        path: &Path,
        force: bool,
        header: &Header,
        wrap: impl FnOnce(File) -> W,
    ) -> Result<RecordingFile, WriteError> {
        let failed = |e: std::io::Error| WriteError::failed(path, 0, &e);
        // Held until the new file has the name.
        let _earlier = earlier(path, force)?;
        let name =
            path.file_name().ok_or_else(|| WriteError::new("write.failed", path, "this is no name of a file"))?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let aside = folder.join(aside_name(name));
        let _ = fs::remove_file(&aside);
        let file = OpenOptions::new().write(true).create_new(true).open(&aside).map_err(|e| {
            let message = format!("the file cannot be made: {}", crate::scene::reason(&e));
            let hint = (e.kind() == std::io::ErrorKind::NotFound).then(|| "the folder around it is missing".into());
            WriteError { hint, ..WriteError::new("write.failed", path, message) }
        })?;
        let begun = file
            .try_clone()
            .and_then(|held| lock(&held).map(|()| held))
            .and_then(|held| Ok((held, Writer::new(wrap(file), header)?)))
            .and_then(|begun| fs::rename(&aside, path).map(|()| begun))
            .and_then(|begun| sync_folder(folder).map(|()| begun));
        let (held, writer) = begun.map_err(|e| {
            let _ = fs::remove_file(&aside);
            failed(e)
        })?;
        let (full, batches) = sync_channel(WAITING);
        let (used, empty) = channel();
        let of = path.to_path_buf();
        let run = move || {
            let _held = held;
            write_all(writer, &batches, &used, &of)
        };
        let thread = std::thread::Builder::new().name("recording".into()).spawn(run).map_err(failed)?;
        Ok(RecordingFile {
            path: path.to_path_buf(),
            batch: Batch::default(),
            handed_over: Instant::now(),
            full: Some(full),
            empty,
            thread: Some(thread),
        })
    }

    /// Adds a frame: `state` appends its bytes.
    ///
    /// # Errors
    /// [`WriteError`] once the file could not be written, or if a frame is out of its order; the frames before are whole.
    pub fn push(&mut self, frame: u64, state: impl FnOnce(&mut Vec<u8>)) -> Result<(), WriteError> {
        state(&mut self.batch.bytes);
        self.batch.parts.push(Part { input: false, frame, end: self.batch.bytes.len() });
        if self.batch.bytes.len() < BATCH && self.handed_over.elapsed() < HANDED_OVER {
            return Ok(());
        }
        self.hand_over()
    }

    /// Adds something that a program did before the step that leads to a frame; it is written with that.
    pub fn input(&mut self, frame: u64, bytes: &[u8]) {
        self.batch.bytes.extend_from_slice(bytes);
        self.batch.parts.push(Part { input: true, frame, end: self.batch.bytes.len() });
    }

    /// Gives what has come together to the thread.
    fn hand_over(&mut self) -> Result<(), WriteError> {
        self.handed_over = Instant::now();
        let batch = std::mem::replace(&mut self.batch, self.empty.try_recv().unwrap_or_default());
        match self.full.as_ref().map(|full| full.send(batch)) {
            Some(Ok(())) => Ok(()),
            // It ends early only by an error.
            _ => self.end().map(|_| ()),
        }
    }

    /// Writes what is left, the index and the end; returns the bytes of the file.
    ///
    /// # Errors
    /// [`WriteError`] where the file could not be written; the frames before that are whole.
    pub fn finish(mut self) -> Result<u64, WriteError> {
        if !self.batch.parts.is_empty() {
            self.hand_over()?;
        }
        self.end()
    }

    fn end(&mut self) -> Result<u64, WriteError> {
        drop(self.full.take());
        let broken = || WriteError::new("write.failed", &self.path, "the recording has ended before");
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(outcome)) => outcome,
            Some(Err(_)) | None => Err(broken()),
        }
    }
}

impl Drop for RecordingFile {
    fn drop(&mut self) {
        // Whoever leaves early has said why; the file is closed with what it has.
        if self.thread.is_some() {
            let _ = self.hand_over();
            let _ = self.end();
        }
    }
}

/// The work of the thread: codes and writes batches until there are no more.
fn write_all<W: Target>(
    mut writer: Writer<W>,
    batches: &Receiver<Batch>,
    used: &Sender<Batch>,
    path: &Path,
) -> Result<u64, WriteError> {
    let mut synced = Instant::now();
    let mut work = || {
        for mut batch in batches {
            let mut from = 0;
            if let [Part { input: false, frame, .. }] = batch.parts[..] {
                writer.take(frame, &mut batch.bytes)?;
            } else {
                for part in &batch.parts {
                    let bytes = &batch.bytes[from..part.end];
                    if part.input {
                        writer.input(part.frame, bytes)?
                    } else {
                        writer.push(part.frame, bytes)?
                    };
                    from = part.end;
                }
            }
            writer.flush()?;
            batch.bytes.clear();
            batch.parts.clear();
            // Nobody may be left to use it again.
            let _ = used.send(batch);
            if synced.elapsed() >= SYNCED {
                writer.sync()?;
                synced = Instant::now();
            }
        }
        writer.finish()
    };
    let outcome = work();
    outcome.map(|()| writer.bytes()).map_err(|e| WriteError::failed(path, writer.bytes(), &e))
}

/// Looks at what has the name now, and locks it.
fn earlier(path: &Path, force: bool) -> Result<Option<File>, WriteError> {
    let refuse = |code, message: &str, hint: Option<&str>| {
        Err(WriteError { hint: hint.map(String::from), ..WriteError::new(code, path, message) })
    };
    match fs::metadata(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(WriteError::failed(path, 0, &e)),
        Ok(about) if about.is_dir() => return refuse("write.failed", "this is a folder", None),
        // Above all no device, which would be replaced by a file.
        Ok(about) if !about.is_file() => return refuse("write.failed", "this is no regular file", None),
        Ok(_) if !force => return refuse("write.exists", "the file is already there", Some("--force replaces it")),
        Ok(_) => {}
    }
    let file = File::open(path).map_err(|e| WriteError::failed(path, 0, &e))?;
    match lock(&file) {
        Ok(()) => Ok(Some(file)),
        Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => {
            refuse("write.locked", "another process writes this file", Some("wait for it, or choose another name"))
        }
        Err(e) => Err(WriteError::failed(path, 0, &e)),
    }
}

/// Locks a file against other processes; where the file system knows no locks, does nothing.
fn lock(file: &File) -> std::io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(fs::TryLockError::WouldBlock) => Err(std::io::ErrorKind::WouldBlock.into()),
        Err(fs::TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => Ok(()),
        Err(fs::TryLockError::Error(e)) => Err(e),
    }
}
