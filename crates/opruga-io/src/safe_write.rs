//! Files that are never half written: written aside, synced, then renamed; and the lock of an output folder.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// A file that could not be written. What was there before is unchanged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteError {
    /// `write.failed`, `write.exists`, `write.locked` or `write.folder`.
    pub code: &'static str,
    /// What happened, in one sentence without a full stop.
    pub message: String,
    /// The file or folder.
    pub path: PathBuf,
    /// How many bytes had been written.
    pub bytes: u64,
    /// What would help.
    pub hint: Option<String>,
}

impl WriteError {
    pub(crate) fn new(code: &'static str, path: &Path, message: impl Into<String>) -> WriteError {
        WriteError { code, message: message.into(), path: path.to_path_buf(), bytes: 0, hint: None }
    }
    fn exists(path: &Path) -> WriteError {
        let error = WriteError::new("write.exists", path, "the file is already there");
        WriteError { hint: Some("--force replaces it".into()), ..error }
    }
    pub(crate) fn failed(path: &Path, bytes: u64, error: &io::Error) -> WriteError {
        WriteError {
            bytes,
            ..WriteError::new(
                "write.failed",
                path,
                format!("writing stopped after {bytes} bytes: {}", crate::scene::reason(error)),
            )
        }
    }
    /// The exit code of a program that stops because of this error.
    pub fn exit_code(&self) -> i32 {
        4
    }
    /// The error object of the command line.
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "code": self.code, "message": self.message, "file": self.path.display().to_string(), "line": null, "column": null,
            "path": null, "value": self.bytes, "allowed": null, "hint": self.hint,
        })
    }
}

impl core::fmt::Display for WriteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let path = self.path.display().to_string();
        write!(f, "{}: error[{}]: {}", crate::problem::visible(&path), self.code, self.message)?;
        match &self.hint {
            Some(hint) => write!(f, "\n  = hint: {hint}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for WriteError {}

/// Writes a file so that its name always means a whole file: aside in the same folder, synced, renamed, folder synced.
/// Returns how many bytes it has.
///
/// # Errors
/// `write.exists` where the file is there and `force` is not given; `write.failed` with the number of bytes written so
/// far. In both cases the old file is whole and nothing is left behind.
pub fn safe_write(
    path: &Path,
    force: bool,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<u64, WriteError> {
    safe_write_through(path, force, |file| file, fill)
}

/// The ending of files that are written to see whether they can be.
const TRIAL: &str = ".opruga-trial";

/// Tries whether a file could be written by [`safe_write`]; leaves what is there as it is.
///
/// # Errors
/// `write.exists` where the file is there and `force` is not given; `write.failed`.
pub fn try_write(path: &Path, force: bool) -> Result<(), WriteError> {
    if !force && path.exists() && !path.is_dir() {
        return Err(WriteError::exists(path));
    }
    let mut trial = path.as_os_str().to_owned();
    trial.push(TRIAL);
    let trial = PathBuf::from(trial);
    let of_path = |e| WriteError { path: path.to_path_buf(), ..e };
    if path.is_dir() {
        return Err(of_path(WriteError::new("write.failed", path, "this is a folder")));
    }
    safe_write(&trial, true, |w| w.write_all(b"opruga\n"))
        .and_then(|_| fs::remove_file(&trial).map_err(|e| WriteError::failed(path, 7, &e)))
        .map_err(of_path)
}

/// Where the bytes of a file go, and how they are made to last.
pub trait Target: Write {
    /// Returns when everything written so far would survive a loss of power.
    ///
    /// # Errors
    /// Those of the system: drives in a network often report only here that they are gone.
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

/// [`safe_write`] through a writer of the caller's making: for tests that let the disk fail.
///
/// # Errors
/// As [`safe_write`].
pub fn safe_write_through<'a, W: Target + 'a>(
    path: &Path,
    force: bool,
    wrap: impl FnOnce(File) -> W + 'a,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()> + 'a,
) -> Result<u64, WriteError> {
    write_aside(path, force, Box::new(|file| Box::new(wrap(file))), Box::new(fill), Box::new(|| Ok(())))
}

/// Makes a file into what its bytes go through.
type Wrap<'a> = Box<dyn FnOnce(File) -> Box<dyn Target + 'a> + 'a>;
/// Writes what a file shall hold.
type Fill<'a> = Box<dyn FnOnce(&mut dyn Write) -> io::Result<()> + 'a>;
/// What is done before the renaming.
type Last<'a> = Box<dyn FnOnce() -> Result<(), WriteError> + 'a>;

/// Writes and syncs aside, then does what must come last, then renames.
fn write_aside<'a>(
    path: &Path,
    force: bool,
    wrap: Wrap<'a>,
    fill: Fill<'a>,
    last: Last<'a>,
) -> Result<u64, WriteError> {
    if path.is_dir() {
        return Err(WriteError::new("write.failed", path, "this is a folder"));
    }
    if !force && path.exists() {
        return Err(WriteError::exists(path));
    }
    let Some(name) = path.file_name() else {
        return Err(WriteError::new("write.failed", path, "this is no name of a file"));
    };
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let aside = folder.join(aside_name(name));

    // What a killed process of the same number left behind is in nobody's use.
    let _ = fs::remove_file(&aside);
    let file = OpenOptions::new().write(true).create_new(true).open(&aside).map_err(|e| {
        let message = format!("the file cannot be made: {}", crate::scene::reason(&e));
        let hint = (e.kind() == io::ErrorKind::NotFound).then(|| "the folder around it is missing".into());
        WriteError { hint, ..WriteError::new("write.failed", path, message) }
    })?;
    let result = fill_and_sync(&file, wrap, fill).map_err(|(bytes, e)| WriteError::failed(path, bytes, &e));
    drop(file);
    let result = result.and_then(|bytes| {
        if !force && path.exists() {
            return Err(WriteError::exists(path));
        }
        last()?;
        fs::rename(&aside, path).map_err(|e| WriteError::failed(path, bytes, &e))?;
        sync_folder(folder).map_err(|e| WriteError::failed(path, bytes, &e))?;
        Ok(bytes)
    });
    if result.is_err() {
        let _ = fs::remove_file(&aside);
    }
    result
}

/// Everything up to the renaming; an error comes with the number of bytes that reached the file.
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

/// The ending of files that are being written.
const WRITING: &str = ".writing";

/// The name under which this process writes a file before it gets its own.
pub(crate) fn aside_name(name: &std::ffi::OsStr) -> std::ffi::OsString {
    let mut aside = std::ffi::OsString::from(".");
    aside.push(name);
    aside.push(format!(".{}{WRITING}", std::process::id()));
    aside
}

/// Whether a name is one of [`aside_name`].
fn is_aside(name: &str) -> bool {
    let stem = name.strip_prefix('.').and_then(|n| n.strip_suffix(WRITING)).and_then(|n| n.rsplit_once('.'));
    stem.is_some_and(|(_, process)| !process.is_empty() && process.bytes().all(|b| b.is_ascii_digit()))
}

/// Makes a folder, and those around it that are missing; where the last cannot be made, none is left behind.
pub(crate) fn make_folders(path: &Path) -> io::Result<()> {
    let missing: Vec<&Path> =
        path.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists()).collect();
    fs::create_dir_all(path).inspect_err(|_| {
        // Only those that are empty go.
        missing.iter().for_each(|folder| drop(fs::remove_dir(folder)));
    })
}

/// Makes a renaming last; only where folders can be opened.
pub(crate) fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(unix) { File::open(folder)?.sync_all() } else { Ok(()) }
}

/// Counts the bytes that went through.
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

/// A writer that fails at a byte, as a full disk does: everything before it is written, short writes included.
#[derive(Debug)]
pub struct Failing<W> {
    inner: W,
    left: u64,
    /// The error of the system; none: no space is left.
    system: Option<i32>,
    /// Whether it fails when the bytes shall last.
    at_sync: bool,
}

impl<W: Write> Failing<W> {
    /// Lets `bytes` bytes through; then the disk is full.
    pub fn after(bytes: u64, inner: W) -> Failing<W> {
        Failing { inner, left: bytes, system: None, at_sync: false }
    }
    /// Lets `bytes` bytes through; then the system reports the error of this number, such as 5 for a drive that is gone.
    pub fn with(bytes: u64, system: i32, inner: W) -> Failing<W> {
        Failing { system: Some(system), ..Failing::after(bytes, inner) }
    }
    /// Takes every byte, and fails when they shall last.
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

/// What happens where the output of an earlier run is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// It is an error.
    Refuse,
    /// It is replaced, file by file.
    Replace,
}

/// A folder for the output of one run, locked against other processes as long as this value lives.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    force: bool,
    // Held for its lock, which ends with the process at the latest.
    lock: Option<File>,
}

/// The file that carries the lock.
const LOCK: &str = ".opruga-lock";

impl OutputFolder {
    /// Makes the folder and those around it, locks it, and tries whether it can be written: before the run, not after.
    ///
    /// # Errors
    /// `write.folder` where it cannot be made or written, `write.locked` where another process writes into it,
    /// `write.exists` where it holds other files and `existing` refuses them.
    pub fn open(path: &Path, existing: Existing) -> Result<OutputFolder, WriteError> {
        let cannot = |what: &str, e: &io::Error| {
            WriteError::new("write.folder", path, format!("the folder cannot be {what}: {}", crate::scene::reason(e)))
        };
        if path.exists() && !path.is_dir() {
            return Err(WriteError::new("write.folder", path, "this is a file, no folder"));
        }
        if !path.exists() {
            make_folders(path).map_err(|e| cannot("made", &e))?;
        }
        let locked_before = path.join(LOCK).exists();
        let open = || OpenOptions::new().create(true).truncate(false).write(true).open(path.join(LOCK));
        let mut lock = open().map_err(|e| cannot("written", &e))?;
        let mut locked = lock.try_lock();
        while locked.is_ok() && !is_the_file(&lock, &path.join(LOCK)) {
            // Its last owner took it away in the moment before: what is locked here nobody else would find.
            lock = open().map_err(|e| cannot("written", &e))?;
            locked = lock.try_lock();
        }
        match locked {
            Ok(()) => {}
            Err(fs::TryLockError::WouldBlock) => {
                let error = WriteError::new("write.locked", path, "another process writes into this folder");
                return Err(WriteError {
                    hint: Some("wait for it, or choose another folder with --out".into()),
                    ..error
                });
            }
            // A file system without locks: the folder can still be used.
            Err(fs::TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => {}
            Err(fs::TryLockError::Error(e)) => return Err(cannot("locked", &e)),
        }
        // Only the owner of the lock writes here: what was being written when an earlier one was killed is nobody's.
        for entry in fs::read_dir(path).map_err(|e| cannot("read", &e))?.flatten() {
            if entry.file_name().to_str().is_some_and(|name| is_aside(name) || name.ends_with(TRIAL)) {
                let _ = fs::remove_file(entry.path());
            }
        }
        if existing == Existing::Refuse {
            let mut names: Vec<String> = fs::read_dir(path)
                .map_err(|e| cannot("read", &e))?
                .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
                .filter(|name| name != LOCK)
                .collect();
            names.sort();
            if let Some(first) = names.first() {
                if !locked_before {
                    // Nothing of ours is left in a folder that is somebody else's.
                    let _ = fs::remove_file(path.join(LOCK));
                }
                let message = format!(
                    "the folder already holds {} files, among them {}",
                    names.len(),
                    crate::problem::visible(first)
                );
                let message = if names.len() == 1 {
                    format!("the folder already holds {}", crate::problem::visible(first))
                } else {
                    message
                };
                return Err(WriteError {
                    hint: Some("--force replaces them, --out chooses another folder".into()),
                    ..WriteError::new("write.exists", path, message)
                });
            }
        }
        let folder = OutputFolder { path: path.to_path_buf(), force: existing != Existing::Refuse, lock: Some(lock) };
        try_write(&folder.path("trial"), true).map_err(|e| WriteError {
            code: "write.folder",
            path: path.to_path_buf(),
            ..e
        })?;
        Ok(folder)
    }

    /// The path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes a file of the folder by [`safe_write`]. A file that this run has written before may be written again.
    ///
    /// # Errors
    /// As [`safe_write`].
    pub fn write(
        &self,
        name: &str,
        force: bool,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<u64, WriteError> {
        safe_write(&self.path(name), force || self.force, fill)
    }

    /// Writes a file of the folder as [`OutputFolder::write`] with `force`, and keeps the one that it replaces, if there is
    /// one, under a second name, in place of the file that had it. At every moment, a crash included, both names are whole
    /// files.
    ///
    /// # Errors
    /// `write.failed`; then the first name is as it was, and the second is as it was or the same file as the first.
    pub fn write_keeping(
        &self,
        name: &str,
        second: &str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<u64, WriteError> {
        let last = Box::new(|| self.keep(name, second));
        write_aside(&self.path(name), true, Box::new(|file| Box::new(file)), Box::new(fill), last)
    }

    /// Gives a file of the folder a second name; does nothing where there is no such file.
    fn keep(&self, name: &str, second: &str) -> Result<(), WriteError> {
        let (from, to) = (self.path(name), self.path(second));
        if !from.exists() {
            return Ok(());
        }
        let aside = self.path.join(aside_name(second.as_ref()));
        let _ = fs::remove_file(&aside);
        // Some file systems know no second names: there it is a copy.
        let copied = || fs::copy(&from, &aside).and_then(|_| File::open(&aside)?.sync_all());
        let kept = fs::hard_link(&from, &aside).or_else(|_| copied()).and_then(|()| fs::rename(&aside, &to));
        kept.and_then(|()| sync_folder(&self.path)).map_err(|e| {
            let _ = fs::remove_file(&aside);
            WriteError::failed(&to, 0, &e)
        })
    }

    /// Removes a file of the folder if it is there.
    ///
    /// # Errors
    /// `write.failed`; then it is still there.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        let path = self.path(name);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != io::ErrorKind::NotFound => Err(WriteError::failed(&path, 0, &e)),
            _ => Ok(()),
        }
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // While it is still locked, so that nobody can have locked it meanwhile; some systems keep files that are open.
        let gone = cfg!(unix) && fs::remove_file(self.path(LOCK)).is_ok();
        drop(self.lock.take());
        if !gone {
            let _ = fs::remove_file(self.path(LOCK));
        }
    }
}

/// Whether an open file still has its name.
#[cfg(unix)]
fn is_the_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let same = |a: fs::Metadata, b: fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    file.metadata().is_ok_and(|own| fs::metadata(path).is_ok_and(|named| same(own, named)))
}
#[cfg(not(unix))]
fn is_the_file(_: &File, path: &Path) -> bool {
    path.exists()
}
