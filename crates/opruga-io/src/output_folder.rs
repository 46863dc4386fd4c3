//! The folder that a run writes into: its lock, and files that get their names together.

use crate::aside::{aside_name, is_the_file, remove_the_dead};
use crate::safe_write::{
    Aside, Fill, TRIAL, WriteError, folder_of, make_folders, safe_write_through, sync_folder, try_write,
};
use crate::write_faults::{Doing, WriteFault};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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

/// A change of the folder that is ready to be made.
#[derive(Debug)]
enum Change {
    /// A file gets its name; the one that has the name now is first given the second one.
    Name { file: Aside, second: Option<PathBuf> },
    /// A file goes.
    Remove(PathBuf),
}

impl Change {
    fn make(self) -> Result<(), WriteError> {
        match self {
            Change::Name { file, second } => {
                if let Some(second) = second
                    && let Err(error) = keep(&file.path, &second)
                {
                    file.forget();
                    return Err(error);
                }
                file.name(true).map(|_| ())
            }
            Change::Remove(path) => remove(&path),
        }
    }

    fn forget(self) {
        if let Change::Name { file, .. } = self {
            file.forget();
        }
    }
}

/// The file that carries the lock.
pub(crate) const LOCK: &str = ".opruga-lock";

impl OutputFolder {
    /// Makes the folder and those around it, locks it, and tries whether it can be written: before the run, not after.
    ///
    /// # Errors
    /// `write.folder` where it cannot be made or written, `write.locked` where another process writes into it,
    /// `write.exists` where it holds other files and `existing` refuses them.
    pub fn open(path: &Path, existing: Existing) -> Result<OutputFolder, WriteError> {
        let cannot = |doing: Doing, e: &io::Error| {
            WriteError::of(path, WriteFault::Folder { doing, reason: crate::regular_file::reason(e) })
        };
        if path.exists() && !path.is_dir() {
            return Err(WriteError::of(path, WriteFault::IsFile {}));
        }
        if !path.exists() {
            make_folders(path).map_err(|e| cannot(Doing::Made, &e))?;
        }
        let open = || OpenOptions::new().create(true).truncate(false).write(true).open(path.join(LOCK));
        let mut lock = open().map_err(|e| cannot(Doing::Written, &e))?;
        let mut locked = lock.try_lock();
        while locked.is_ok() && !is_the_file(&lock, &path.join(LOCK)) {
            // Its last owner took it away in the moment before: what is locked here nobody else would find.
            lock = open().map_err(|e| cannot(Doing::Written, &e))?;
            locked = lock.try_lock();
        }
        match locked {
            Ok(()) => {}
            Err(fs::TryLockError::WouldBlock) => {
                return Err(WriteError::of(path, WriteFault::FolderLocked {}));
            }
            // A file system without locks: the folder can still be used.
            Err(fs::TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => {}
            Err(fs::TryLockError::Error(e)) => return Err(cannot(Doing::Locked, &e)),
        }
        // What was being written when an earlier owner of the lock was killed.
        remove_the_dead(path, None);
        for entry in fs::read_dir(path).map_err(|e| cannot(Doing::Read, &e))?.flatten() {
            if entry.file_name().to_str().is_some_and(|name| name.ends_with(TRIAL)) {
                let _ = fs::remove_file(entry.path());
            }
        }
        if existing == Existing::Refuse {
            let mut names: Vec<String> = fs::read_dir(path)
                .map_err(|e| cannot(Doing::Read, &e))?
                .filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()))
                .filter(|name| name != LOCK)
                .collect();
            names.sort();
            if let Some(first) = names.first() {
                // Nothing of ours is left in a folder that is somebody else's, nor the lock of a process that was killed here.
                let _ = fs::remove_file(path.join(LOCK));
                let file = crate::problem::visible(first);
                return Err(WriteError::of(
                    path,
                    match names.len() {
                        1 => WriteFault::HoldsFile { file },
                        count => WriteFault::HoldsFiles { count, file },
                    },
                ));
            }
        }
        let folder = OutputFolder { path: path.to_path_buf(), force: existing != Existing::Refuse, lock: Some(lock) };
        try_write(&folder.path("trial"), true).map_err(|e| WriteError {
            about: WriteFault::Unwritable { problem: e.about.clone() }.into(),
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
        // What killed processes have left went when the folder was opened.
        safe_write_through(&self.path(name), force || self.force, |file| file, fill)
    }

    /// Files that get their names and go together.
    pub fn together(&self) -> Together<'_> {
        Together { folder: self, waiting: Vec::new() }
    }

    /// Removes a file of the folder if it is there.
    ///
    /// # Errors
    /// `write.failed`; then it is still there.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        remove(&self.path(name))
    }
}

/// Changes of a folder that are made one right after the other once all of them are ready: a disk that fills up on the way
/// leaves everything as it was.
#[derive(Debug)]
#[must_use = "nothing changes before the end"]
pub struct Together<'a> {
    folder: &'a OutputFolder,
    waiting: Vec<Change>,
}

impl Together<'_> {
    /// Writes a file that shall replace the one of its name.
    ///
    /// # Errors
    /// `write.failed`.
    pub fn write(&mut self, name: &str, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
        self.ready(name, None, Box::new(fill))
    }

    /// As [`Together::write`]; the file that is replaced, if there is one, is kept under a second name, in place of the file
    /// that had it. At every moment, a crash included, both names are whole files.
    ///
    /// # Errors
    /// `write.failed`.
    pub fn write_keeping(
        &mut self,
        name: &str,
        second: &str,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), WriteError> {
        self.ready(name, Some(self.folder.path(second)), Box::new(fill))
    }

    fn ready(&mut self, name: &str, second: Option<PathBuf>, fill: Fill<'_>) -> Result<(), WriteError> {
        let file = Aside::write(&self.folder.path(name), true, Box::new(|file| Box::new(file)), fill)?;
        // What was ready under this name counts no more.
        let of_name = |other: &Change| matches!(other, Change::Name { file: old, .. } if old.path == file.path);
        let (old, others): (Vec<Change>, Vec<Change>) =
            std::mem::take(&mut self.waiting).into_iter().partition(of_name);
        old.into_iter().for_each(Change::forget);
        self.waiting = others;
        self.waiting.push(Change::Name { file, second });
        Ok(())
    }

    /// Lets a file go if it is there.
    pub fn remove(&mut self, name: &str) {
        self.waiting.push(Change::Remove(self.folder.path(name)));
    }

    /// Makes the changes in their order.
    ///
    /// # Errors
    /// `write.failed` for a name that could not be given; those behind it are not, and their files are as they were.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let mut changes = std::mem::take(&mut self.waiting).into_iter();
        let made = changes.try_for_each(Change::make);
        self.waiting.extend(changes);
        made
    }
}

impl Drop for Together<'_> {
    fn drop(&mut self) {
        self.waiting.drain(..).for_each(Change::forget);
    }
}

/// Gives a file a second name in its folder; does nothing where there is no such file.
fn keep(from: &Path, to: &Path) -> Result<(), WriteError> {
    if !from.exists() {
        return Ok(());
    }
    let aside = to.with_file_name(aside_name(to.file_name().unwrap_or_default()));
    let _ = fs::remove_file(&aside);
    // Some file systems know no second names: there it is a copy.
    let copied = || fs::copy(from, &aside).and_then(|_| File::open(&aside)?.sync_all());
    let kept = fs::hard_link(from, &aside).or_else(|_| copied()).and_then(|()| fs::rename(&aside, to));
    kept.and_then(|()| sync_folder(folder_of(to))).map_err(|e| {
        let _ = fs::remove_file(&aside);
        WriteError::failed(to, 0, &e)
    })
}

/// Removes a file if it is there.
fn remove(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(WriteError::failed(path, 0, &e)),
        _ => Ok(()),
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
