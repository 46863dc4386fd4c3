//! Files that are never left half written: they are written under a temporary name, synced, then renamed.

use crate::aside::{make_aside, remove_the_dead};
use crate::problem::SceneError;
use crate::write_faults::WriteFault;
use opruga_math::message::AnyMessage;
use opruga_words::Translation;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written. An earlier file is unchanged.
#[derive(Clone, Debug, PartialEq)]
pub struct WriteError {
    /// What happened.
    pub about: AnyMessage,
    /// The file or folder.
    pub path: PathBuf,
    /// The number of bytes that had been written.
    pub bytes: u64,
    /// What would help, if the message does not say it.
    pub advice: Option<AnyMessage>,
}

impl WriteError {
    /// Makes an error from a message.
    pub fn of(path: &Path, about: impl Into<AnyMessage>) -> WriteError {
        WriteError { about: about.into(), path: path.to_path_buf(), bytes: 0, advice: None }
    }
    pub(crate) fn failed(path: &Path, bytes: u64, error: &io::Error) -> WriteError {
        let reason = crate::regular_file::reason(error);
        WriteError { bytes, ..WriteError::of(path, WriteFault::Stopped { bytes, reason }) }
    }
    /// Adds what would help.
    #[must_use]
    pub fn advice(self, advice: impl Into<AnyMessage>) -> WriteError {
        WriteError { advice: Some(advice.into()), ..self }
    }
    /// `write.failed`, `write.exists`, `write.locked`, `write.folder`, `write.input` or `write.twice`.
    pub fn code(&self) -> &'static str {
        self.about.code()
    }
    /// The exit code of a program that stops because of this error.
    pub fn exit_code(&self) -> i32 {
        4
    }
    /// The error object of the command line.
    pub fn to_json(&self) -> serde_json::Value {
        let hint = self.advice.as_ref().map(AnyMessage::to_string).or_else(|| self.about.hint());
        serde_json::json!({
            "code": self.code(), "message": self.about.to_string(), "file": self.path.display().to_string(), "line": null,
            "column": null, "path": null, "value": self.bytes, "allowed": null, "hint": hint,
        })
    }
    /// The text that [`core::fmt::Display`] writes, in the language of a translation.
    pub fn text(&self, translation: Option<&Translation>) -> String {
        let mut error = SceneError::of(self.about.clone());
        error.file = self.path.display().to_string();
        self.advice.iter().fold(error, |error, advice| error.advice(advice.clone())).text(translation)
    }
}

impl core::fmt::Display for WriteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.text(None))
    }
}

impl std::error::Error for WriteError {}

/// Writes a file so that its name always means a complete file: it is written under a temporary name in the same folder, synced and renamed, and the
/// folder is synced. Returns the size of the file [bytes].
///
/// # Errors
/// `write.exists` if the file exists and `force` is not given; `write.failed` with the number of bytes written so far. In both cases the old file
/// stays intact and no temporary file remains. Temporary files that a killed process left for this name are removed.
pub fn safe_write(
    path: &Path,
    force: bool,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<u64, WriteError> {
    if let Some(name) = path.file_name() {
        remove_the_dead(folder_of(path), Some(name));
    }
    safe_write_through(path, force, |file| file, fill)
}

/// The ending of files that are written to test whether writing is possible.
pub(crate) const TRIAL: &str = ".opruga-trial";

/// Tests whether [`safe_write`] could write a file; an existing file stays as it is.
///
/// # Errors
/// `write.exists` if the file exists and `force` is not given; `write.failed`.
pub fn try_write(path: &Path, force: bool) -> Result<(), WriteError> {
    if !force && path.exists() && !path.is_dir() {
        return Err(WriteError::of(path, WriteFault::FileExists {}));
    }
    let mut trial = path.as_os_str().to_owned();
    trial.push(TRIAL);
    let trial = PathBuf::from(trial);
    let of_path = |e| WriteError { path: path.to_path_buf(), ..e };
    if path.is_dir() {
        return Err(of_path(WriteError::of(path, WriteFault::IsFolder {})));
    }
    safe_write(&trial, true, |w| w.write_all(b"opruga\n"))
        .and_then(|_| match fs::remove_file(&trial) {
            // If the file no longer exists, a process that started in this folder in the meantime has removed it.
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(WriteError::failed(path, 7, &e)),
            _ => Ok(()),
        })
        .map_err(of_path)
}

/// The destination of the bytes of a file, which can also be synced.
pub trait Target: Write {
    /// Returns when everything written so far would survive a power failure.
    ///
    /// # Errors
    /// The errors of the system: network drives often report only here that they are gone.
    fn sync(&self) -> io::Result<()>;
}

impl<T: Target + ?Sized> Target for Box<T> {
    fn sync(&self) -> io::Result<()> {
        (**self).sync()
    }
}

impl Target for File {
    fn sync(&self) -> io::Result<()> {
        self.sync_all()
    }
}

/// Does the same as [`safe_write`] with a writer made by the caller, for tests in which the disk fails.
///
/// # Errors
/// The errors of [`safe_write`].
pub fn safe_write_through<'a, W: Target + 'a>(
    path: &Path,
    force: bool,
    wrap: impl FnOnce(File) -> W + 'a,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()> + 'a,
) -> Result<u64, WriteError> {
    Aside::write(path, force, Box::new(|file| Box::new(wrap(file))), Box::new(fill))?.name(force)
}

/// Wraps a file in the writer that its bytes go through.
type Wrap<'a> = Box<dyn FnOnce(File) -> Box<dyn Target + 'a> + 'a>;
/// Writes the contents of a file.
pub(crate) type Fill<'a> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'a>;
/// A complete file that does not have its own name yet.
#[derive(Debug)]
pub(crate) struct Aside {
    pub(crate) path: PathBuf,
    aside: PathBuf,
    bytes: u64,
    /// The open file, which stays locked until the file has its final name.
    _lock: File,
}

impl Aside {
    /// Writes and syncs a file next to its final path.
    ///
    /// # Errors
    /// The errors of [`safe_write`]; in this case no file is left behind.
    pub(crate) fn write<'a>(path: &Path, force: bool, wrap: Wrap<'a>, fill: Fill<'a>) -> Result<Aside, WriteError> {
        if path.is_dir() {
            return Err(WriteError::of(path, WriteFault::IsFolder {}));
        }
        if !force && path.exists() {
            return Err(WriteError::of(path, WriteFault::FileExists {}));
        }
        let Some(name) = path.file_name() else {
            return Err(WriteError::of(path, WriteFault::NoFileName {}));
        };
        let (aside, file) = make_aside(folder_of(path), name).map_err(|e| {
            let reason = crate::regular_file::reason(&e);
            let no_folder = e.kind() == io::ErrorKind::NotFound;
            let fault =
                if no_folder { WriteFault::NoFolderAround { reason } } else { WriteFault::FileNotMade { reason } };
            WriteError::of(path, fault)
        })?;
        match fill_and_sync(&file, wrap, fill) {
            Ok(bytes) => Ok(Aside { path: path.to_path_buf(), aside, bytes, _lock: file }),
            Err((bytes, error)) => {
                drop(file);
                let _ = fs::remove_file(&aside);
                Err(WriteError::failed(path, bytes, &error))
            }
        }
    }

    /// Gives the file its name, replacing the file that had it; returns its size [bytes].
    ///
    /// # Errors
    /// The errors of [`safe_write`]; in this case no file is left behind.
    pub(crate) fn name(self, force: bool) -> Result<u64, WriteError> {
        let Aside { path, bytes, .. } = &self;
        if !force && path.exists() {
            let error = WriteError::of(path, WriteFault::FileExists {});
            self.forget();
            return Err(error);
        }
        match fs::rename(&self.aside, path).and_then(|()| sync_folder(folder_of(path))) {
            Ok(()) => Ok(*bytes),
            Err(error) => {
                let error = WriteError::failed(path, *bytes, &error);
                self.forget();
                Err(error)
            }
        }
    }

    /// Removes the file.
    pub(crate) fn forget(self) {
        let _ = fs::remove_file(self.aside);
    }
}

/// The folder that contains a file.
pub(crate) fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Does everything before the renaming; an error comes with the number of bytes that reached the file.
fn fill_and_sync<'a>(file: &File, wrap: Wrap<'a>, fill: Fill<'a>) -> Result<u64, (u64, io::Error)> {
    let inner = wrap(file.try_clone().map_err(|e| (0, e))?);
    let mut writer = BufWriter::with_capacity(1 << 16, Counted { inner, bytes: 0 });
    let filled = fill(&mut writer).and_then(|()| writer.flush());
    let (counted, _) = writer.into_parts();
    match filled.and_then(|()| counted.inner.sync()) {
        Ok(()) => Ok(counted.bytes),
        Err(e) => Err((counted.bytes, e)),
    }
}

/// Makes a folder and its missing parents. If the last folder cannot be made, the folders made before are removed.
pub(crate) fn make_folders(path: &Path) -> io::Result<()> {
    let missing: Vec<&Path> =
        path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).collect();
    fs::create_dir_all(path).inspect_err(|_| {
        // This removes empty folders only.
        missing.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    })
}

/// Syncs a renaming to the disk, if the system can open folders.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Counts the bytes that pass through.
#[derive(Debug)]
pub(crate) struct Counted<W> {
    pub(crate) inner: W,
    pub(crate) bytes: u64,
}

impl<W: Write> Write for Counted<W> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(buffer)?;
        self.bytes += n as u64;
        Ok(n)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// A writer that fails after a number of bytes, like a full disk. Everything before is written, and writes may be short.
#[derive(Debug)]
pub struct Failing<W> {
    inner: W,
    left: u64,
    /// The error number of the system; none means that no space is left.
    system: Option<i32>,
    /// Whether the writer fails only when it is synced.
    at_sync: bool,
}

impl<W: Write> Failing<W> {
    /// Makes a writer that lets `bytes` bytes through and then reports that no space is left.
    pub fn after(bytes: u64, inner: W) -> Failing<W> {
        Failing { inner, left: bytes, system: None, at_sync: false }
    }
    /// Makes a writer that lets `bytes` bytes through and then reports the system error with this number, such as 5 for a drive that is gone.
    pub fn with(bytes: u64, system: i32, inner: W) -> Failing<W> {
        Failing { system: Some(system), ..Failing::after(bytes, inner) }
    }
    /// Makes a writer that takes every byte, and fails when it is synced.
    pub fn at_sync(system: i32, inner: W) -> Failing<W> {
        Failing { at_sync: true, ..Failing::with(u64::MAX, system, inner) }
    }
    fn error(&self) -> io::Error {
        match self.system {
            Some(number) => io::Error::from_raw_os_error(number),
            None => io::Error::new(io::ErrorKind::StorageFull, "no space left on device"),
        }
    }
}

impl<W: Write> Write for Failing<W> {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        if self.left == 0 && !buffer.is_empty() {
            return Err(self.error());
        }
        let n = self.inner.write(&buffer[..buffer.len().min(usize::try_from(self.left).unwrap_or(usize::MAX))])?;
        self.left -= n as u64;
        Ok(n)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Target> Target for Failing<W> {
    fn sync(&self) -> io::Result<()> {
        if self.at_sync { Err(self.error()) } else { self.inner.sync() }
    }
}
