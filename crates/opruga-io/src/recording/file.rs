//! The file of a recording, written by the run itself: what has been given to the system outlives the process.

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

/// What a loss of power may cost.
const SYNCED: Duration = Duration::from_secs(5);

/// A recording that is being written. Chunks go to the system one by one, each before the next is begun: a frame whose state is kept, something that a
/// program did, or frames without their states up to the moment when their owner says so. A process that is killed loses the last chunk at most, which was
/// not whole yet or was just going. A loss of power costs the last five seconds.
pub struct RecordingFile {
    path: PathBuf,
    folder: PathBuf,
    writer: Writer<Box<dyn Target + Send>>,
    /// Room for the bytes of a state.
    state: Vec<u8>,
    syncing: Option<Syncing>,
    /// Whether there is no more to be written: all is, or nothing can be.
    ended: bool,
}

impl core::fmt::Debug for RecordingFile {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("RecordingFile").field("path", &self.path).finish_non_exhaustive()
    }
}

impl RecordingFile {
    /// Makes the file with its header, and the folders around it. With `force` an earlier file is replaced as soon as the
    /// header is written.
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
        let failed = |e: io::Error| WriteError::failed(path, 0, &e);
        // Held until the new file has the name.
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
            // Only what takes the place of another file must be on the disk before it does.
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

    /// Adds the next frame, whose state is not kept, with its hash; it goes to the system with [`RecordingFile::flush`], or
    /// with the next frame whose state is kept.
    ///
    /// # Errors
    /// [`WriteError`] once the file could not be written, or if a frame is out of its order; the frames before are whole.
    pub fn push(&mut self, frame: u64, hash: u64) -> Result<(), WriteError> {
        self.write(|file| file.writer.push(frame, hash))
    }

    /// Gives all frames so far to the system: from then on they outlive the process.
    ///
    /// # Errors
    /// [`WriteError`] once the file could not be written.
    pub fn flush(&mut self) -> Result<(), WriteError> {
        self.write(|file| file.writer.flush())
    }

    /// Adds the next frame with its hash and its state, whose bytes `state` appends; or the state of the last frame, which
    /// ends the recording.
    ///
    /// # Errors
    /// As [`RecordingFile::push`].
    pub fn keep(&mut self, frame: u64, hash: u64, state: impl FnOnce(&mut Vec<u8>)) -> Result<(), WriteError> {
        self.write(|file| {
            // The chunk before it goes first.
            file.writer.flush()?;
            file.state.clear();
            state(&mut file.state);
            file.writer.keep(frame, hash, &mut file.state)?;
            file.writer.flush()
        })
    }

    /// Adds something that a program did before the step that leads to the next frame.
    ///
    /// # Errors
    /// As [`RecordingFile::push`].
    pub fn input(&mut self, frame: u64, bytes: &[u8]) -> Result<(), WriteError> {
        self.write(|file| {
            file.writer.flush()?;
            file.writer.input(frame, bytes)?;
            file.writer.flush()
        })
    }

    /// Writes what is left, the index and the end; returns the bytes of the file.
    ///
    /// # Errors
    /// [`WriteError`] where the file could not be written; the frames before that are whole.
    pub fn finish(mut self) -> Result<u64, WriteError> {
        self.end()
    }

    /// Does a piece of work unless one before has failed: what stands behind a gap would be damage.
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
        // Whoever leaves early has said why; the file is closed with what it has.
        if !self.ended {
            let _ = self.end();
        }
    }
}

/// Makes a file last every five seconds, beside the run: disks may take long for it.
struct Syncing {
    stop: Sender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Syncing {
    /// The file is held, with its lock, until the end.
    fn begin(file: File, folder: &Path) -> io::Result<Syncing> {
        let (stop, stopped) = channel::<()>();
        let mut folder = Some(folder.to_path_buf());
        let run = move || {
            while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(SYNCED) {
                file.sync_data()?;
                // Its name too, once.
                folder.take().map_or(Ok(()), |folder| sync_folder(&folder))?;
            }
            Ok(())
        };
        let thread = std::thread::Builder::new().name("recording".into()).spawn(run)?;
        Ok(Syncing { stop, thread })
    }

    /// Whether it has ended by itself: the file cannot be made to last.
    fn has_ended(&self) -> bool {
        self.thread.is_finished()
    }

    fn end(self) -> io::Result<()> {
        drop(self.stop);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the file could not be made to last")))
    }
}

/// Looks at what has the name now, and locks it.
fn earlier(path: &Path, force: bool) -> Result<Option<File>, WriteError> {
    let refuse = |fault: WriteFault| Err(WriteError::of(path, fault));
    match fs::metadata(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(WriteError::failed(path, 0, &e)),
        Ok(about) if about.is_dir() => return refuse(WriteFault::IsFolder {}),
        // Above all no device, which would be replaced by a file.
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

/// Locks a file against other processes; where the file system knows no locks, does nothing.
fn lock(file: &File) -> std::io::Result<()> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(fs::TryLockError::WouldBlock) => Err(std::io::ErrorKind::WouldBlock.into()),
        Err(fs::TryLockError::Error(e)) if e.kind() == std::io::ErrorKind::Unsupported => Ok(()),
        Err(fs::TryLockError::Error(e)) => Err(e),
    }
}
