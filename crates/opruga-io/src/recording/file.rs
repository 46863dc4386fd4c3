//! The file of a recording, which the run itself writes. Data that were given to the system survive the end of the process.

use super::format::Header;
use super::writer::Writer;
use crate::aside::{make_aside, remove_the_dead};
use crate::safe_write::{Target, WriteError, make_folders, sync_folder};
use crate::write_faults::WriteFault;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;

/// The time between two syncs. A power failure loses at most this much of a run.
const SYNCED: Duration = Duration::from_secs(5);

/// A recording that is being written. Each chunk goes to the system before the next one begins. A chunk is a frame whose state is kept, an action of
/// a program, or a sequence of frames without states. Such a sequence ends at a call of [`RecordingFile::flush`] or before the next chunk of another
/// kind. A process that is killed loses at most the last chunk, which was incomplete or was just being written. A power failure loses at most the
/// last five seconds.
pub struct RecordingFile {
    path: PathBuf,
    folder: PathBuf,
    writer: Writer<Box<dyn Target + Send>>,
    /// Buffer for the bytes of a state.
    state: Vec<u8>,
    syncing: Option<Syncing>,
    /// Whether nothing more will be written, because everything has been written or because writing failed.
    ended: bool,
}

impl core::fmt::Debug for RecordingFile {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("RecordingFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl RecordingFile {
    /// Creates the parent folders, and the file with its header. With `force`, an earlier file is replaced as soon as the header is written.
    ///
    /// # Errors
    /// `write.exists` if the file exists and `force` is not given, `write.locked` if another process writes it, `write.failed` if it cannot be
    /// written or is not a regular file. In all cases the earlier file stays intact.
    pub fn create(path: &Path, force: bool, header: &Header) -> Result<RecordingFile, WriteError> {
        RecordingFile::create_through(path, force, header, |file| file)
    }

    /// Does the same as [`RecordingFile::create`] with a target made by the caller, for tests in which the disk fails.
    ///
    /// # Errors
    /// The errors of [`RecordingFile::create`].
    pub fn create_through<W: Target + Send + 'static>(
        path: &Path,
        force: bool,
        header: &Header,
        wrap: impl FnOnce(File) -> W,
    ) -> Result<RecordingFile, WriteError> {
        let failed = |e: io::Error| WriteError::failed(path, 0, &e);
        // The lock on the earlier file is held until the new file has its name.
        let earlier = earlier(path, force)?;
        let replaces = earlier.is_some();
        let name = path.file_name().ok_or_else(|| WriteError::of(path, WriteFault::NoFileName {}))?;
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        make_folders(folder).map_err(|e| {
            WriteError::of(path, WriteFault::FolderAroundNotMade { reason: crate::regular_file::reason(&e) })
        })?;
        remove_the_dead(folder, Some(name));
        let (aside, file) = make_aside(folder, name)
            .map_err(|e| WriteError::of(path, WriteFault::FileNotMade { reason: crate::regular_file::reason(&e) }))?;
        let begin = || -> io::Result<(File, Writer<Box<dyn Target + Send>>)> {
            let locked = file.try_clone()?;
            lock(&locked)?;
            let target: Box<dyn Target + Send> = Box::new(wrap(file));
            let writer = Writer::new(target, header)?;
            // A file that replaces another one must be on the disk before the replacement; others need not be.
            if replaces {
                writer.sync()?;
            }
            fs::rename(&aside, path)?;
            Ok((locked, writer))
        };
        let begun = begin().and_then(|(locked, writer)| Ok((Syncing::begin(locked, folder)?, writer)));
        let (syncing, writer) = begun.map_err(|e| {
            let _ = fs::remove_file(&aside);
            failed(e)
        })?;
        drop(earlier);
        Ok(RecordingFile {
            path: path.to_path_buf(),
            folder: folder.to_path_buf(),
            writer,
            state: Vec::new(),
            syncing: Some(syncing),
            ended: false,
        })
    }

    /// Adds the next frame, whose state is not kept, with its hash. The frame goes to the system with [`RecordingFile::flush`], or before the next
    /// action or the next frame whose state is kept.
    ///
    /// # Errors
    /// [`WriteError`] if the file could not be written, now or earlier, or if a frame is out of order; the earlier frames are intact.
    pub fn push(&mut self, frame: u64, hash: u64) -> Result<(), WriteError> {
        self.write(|file| file.writer.push(frame, hash))
    }

    /// Gives all frames so far to the system, so that they survive the end of the process.
    ///
    /// # Errors
    /// [`WriteError`] if the file could not be written, now or earlier.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.write(|file| file.writer.flush())
    }

    /// Adds the next frame with its hash and its state, whose bytes `state` appends. If the frame is the one that was added last, its state ends the
    /// recording.
    ///
    /// # Errors
    /// The errors of [`RecordingFile::push`].
    pub fn keep(&mut self, frame: u64, hash: u64, state: impl FnOnce(&mut Vec<u8>)) -> Result<(), WriteError> {
        self.write(|file| {
            // The previous chunk is written first.
            file.writer.flush()?;
            file.state.clear();
            state(&mut file.state);
            file.writer.keep(frame, hash, &mut file.state)?;
            file.writer.flush()
        })
    }

    /// Adds an action of a program that precedes the step to the next frame.
    ///
    /// # Errors
    /// The errors of [`RecordingFile::push`].
    pub fn input(&mut self, frame: u64, bytes: &[u8]) -> Result<(), WriteError> {
        self.write(|file| {
            file.writer.flush()?;
            file.writer.input(frame, bytes)?;
            file.writer.flush()
        })
    }

    /// Writes the remaining data, the index and the end; returns the size of the file [bytes].
    ///
    /// # Errors
    /// [`WriteError`] if the file could not be written; the earlier frames are intact.
    pub fn finish(mut self) -> Result<u64, WriteError> {
        self.end()
    }

    /// Does a piece of work unless an earlier one has failed, because anything after a gap would be read as damage.
    fn write(&mut self, work: impl FnOnce(&mut RecordingFile) -> io::Result<()>) -> Result<(), WriteError> {
        if self.ended {
            return Err(WriteError::of(&self.path, WriteFault::RecordingEnded {}));
        }
        let lost = match &mut self.syncing {
            Some(syncing) if syncing.has_ended() => self.syncing.take().map_or(Ok(()), Syncing::end),
            _ => Ok(()),
        };
        let outcome = lost.and_then(|()| work(self));
        self.ended = outcome.is_err();
        outcome.map_err(|e| WriteError::failed(&self.path, self.writer.bytes(), &e))
    }

    fn end(&mut self) -> Result<u64, WriteError> {
        let synced = |file: &mut RecordingFile| file.syncing.take().map_or(Ok(()), Syncing::end);
        let outcome = self.write(|file| {
            synced(file)?;
            file.writer.finish()?;
            sync_folder(&file.folder)
        });
        self.ended = true;
        outcome.map(|()| self.writer.bytes())
    }
}

impl Drop for RecordingFile {
    fn drop(&mut self) {
        // If the run ended early, its error says why; the file is closed with the data that it has.
        if !self.ended {
            let _ = self.end();
        }
    }
}

/// Syncs a file to the disk every five seconds, on its own thread, because this may take long.
struct Syncing {
    stop: Sender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Syncing {
    /// Starts the thread, which keeps the file and its lock until the end.
    fn begin(file: File, folder: &Path) -> io::Result<Syncing> {
        let (stop, stopped) = channel::<()>();
        let mut folder = Some(folder.to_path_buf());
        let run = move || {
            while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(SYNCED) {
                file.sync_data()?;
                // Once, the folder is synced as well, so that it contains the name of the file.
                folder.take().map_or(Ok(()), |folder| sync_folder(&folder))?;
            }
            Ok(())
        };
        let thread = std::thread::Builder::new().name("recording".into()).spawn(run)?;
        Ok(Syncing { stop, thread })
    }

    /// Whether the thread has ended by itself, because the file cannot be synced.
    fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    fn end(self) -> io::Result<()> {
        drop(self.stop);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the file could not be made to last")))
    }
}

/// Inspects the file that has this name at present, and locks it.
fn earlier(path: &Path, force: bool) -> Result<Option<File>, WriteError> {
    let refuse = |fault: WriteFault| Err(WriteError::of(path, fault));
    match fs::metadata(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(WriteError::failed(path, 0, &e)),
        Ok(about) if about.is_dir() => return refuse(WriteFault::IsFolder {}),
        // A device in particular must not be replaced by a file.
        Ok(about) if !about.is_file() => return refuse(WriteFault::NoRegularFile {}),
        Ok(_) if !force => return refuse(WriteFault::FileExists {}),
        Ok(_) => {}
    }
    let file = File::open(path).map_err(|e| WriteError::failed(path, 0, &e))?;
    match lock(&file) {
        Ok(()) => Ok(Some(file)),
        Err(e) if e.kind() == std::io::ErrorKind::WouldBlock => refuse(WriteFault::FileLocked {}),
        Err(e) => Err(WriteError::failed(path, 0, &e)),
    }
}

/// Locks a file against other processes; does nothing if the file system has no locks.
fn lock(file: &File) -> std::io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(fs::TryLockError::WouldBlock) => Err(std::io::ErrorKind::WouldBlock.into()),
        Err(fs::TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => Ok(()),
        Err(fs::TryLockError::Error(e)) => Err(e),
    }
}
