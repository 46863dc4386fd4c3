//! The folder that a run writes to. The folder is locked, and several of its files can be replaced together.

use crate::aside::{aside_name, is_the_file, remove_the_dead};
use crate::safe_write::{
    Aside, Fill, TRIAL, WriteError, folder_of, make_folders, safe_write_through, sync_folder, try_write,
};
use crate::write_faults::{Doing, WriteFault};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What happens if the folder contains the output of an earlier run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// Such output is an error.
    Refuse,
    /// The earlier output is replaced, file by file.
    Replace,
}

/// A folder for the output of one run, locked against other processes while this value exists.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    force: bool,
    // Kept for its lock, which ends with the process at the latest.
    lock: Option<File>,
}

/// A prepared change of the folder.
#[derive(Debug)]
enum Change {
    /// Gives a file its final name. If there is a second name, the file that had the name before is kept under it.
    Name { file: Aside, second: Option<PathBuf> },
    /// Removes a file.
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
    /// Makes the folder with its parents, locks it, and checks that it can be written, before the run begins.
    ///
    /// # Errors
    /// `write.folder` if it cannot be made or written, `write.locked` if another process writes to it, `write.exists` if it contains other files and
    /// `existing` refuses them.
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
            // The previous owner has just removed the file of the lock. A lock on a removed file keeps no other process out.
            lock = open().map_err(|e| cannot(Doing::Written, &e))?;
            locked = lock.try_lock();
        }
        match locked {
            Ok(()) => {}
            Err(fs::TryLockError::WouldBlock) => {
                return Err(WriteError::of(path, WriteFault::FolderLocked {}));
            }
            // On a file system without locks, the folder can still be used.
            Err(fs::TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => {}
            Err(fs::TryLockError::Error(e)) => return Err(cannot(Doing::Locked, &e)),
        }
        // Removes the files that were being written when an earlier owner of the lock was killed.
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
                // A folder that is refused must not keep the lock file, whether this process made it or a killed process left it.
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

    /// Writes a file of the folder by [`safe_write`]. A file that this run has already written may be written again.
    ///
    /// # Errors
    /// The errors of [`safe_write`].
    pub fn write(
        &self,
        name: &str,
        force: bool,
        fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<u64, WriteError> {
        // Files of killed processes were removed when the folder was opened.
        safe_write_through(&self.path(name), force || self.force, |file| file, fill)
    }

    /// Begins a group of files that get their names, or are removed, together.
    pub fn together(&self) -> Together<'_> {
        Together { folder: self, waiting: Vec::new() }
    }

    /// Removes a file of the folder if it exists.
    ///
    /// # Errors
    /// `write.failed`; the file then still exists.
    pub fn remove(&self, name: &str) -> Result<(), WriteError> {
        remove(&self.path(name))
    }
}

/// Changes to a folder. The changes are made right after one another, but only once all of them are ready. If the disk fills up before that,
/// everything stays as it was.
#[derive(Debug)]
#[must_use = "nothing changes before the end"]
pub struct Together<'a> {
    folder: &'a OutputFolder,
    waiting: Vec<Change>,
}

impl Together<'_> {
    /// Writes a file that will replace the present file of the same name.
    ///
    /// # Errors
    /// `write.failed`.
    pub fn write(&mut self, name: &str, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), WriteError> {
        self.ready(name, None, Box::new(fill))
    }

    /// Does the same as [`Together::write`], but keeps the replaced file, if there is one, under a second name, where it replaces an older file. At
    /// every moment, even after a crash, both names refer to complete files.
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
        // An earlier change prepared for this name is dropped.
        let of_name = |other: &Change| matches!(other, Change::Name { file: old, .. } if old.path == file.path);
        let (old, others): (Vec<Change>, Vec<Change>) =
            std::mem::take(&mut self.waiting).into_iter().partition(of_name);
        old.into_iter().for_each(Change::forget);
        self.waiting = others;
        self.waiting.push(Change::Name { file, second });
        Ok(())
    }

    /// Removes a file if it exists.
    pub fn remove(&mut self, name: &str) {
        self.waiting.push(Change::Remove(self.folder.path(name)));
    }

    /// Makes the changes in their order.
    ///
    /// # Errors
    /// `write.failed` for a name that could not be given; later changes are not made, and their files stay as they were.
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

/// Gives a file a second name in its folder; does nothing if the file does not exist.
fn keep(from: &Path, to: &Path) -> Result<(), WriteError> {
    if !from.exists() {
        return Ok(());
    }
    let aside = to.with_file_name(aside_name(to.file_name().unwrap_or_default()));
    let _ = fs::remove_file(&aside);
    // Some file systems do not support two names for one file; there the file is copied.
    let copied = || fs::copy(from, &aside).and_then(|_| File::open(&aside)?.sync_all());
    let kept = fs::hard_link(from, &aside).or_else(|_| copied()).and_then(|()| fs::rename(&aside, to));
    kept.and_then(|()| sync_folder(folder_of(to))).map_err(|e| {
        let _ = fs::remove_file(&aside);
        WriteError::failed(to, 0, &e)
    })
}

/// Removes a file if it exists.
fn remove(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(WriteError::failed(path, 0, &e)),
        _ => Ok(()),
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        // It is removed while still locked, so that no other program can lock it in the meantime. Some systems do not remove open files.
        let gone = cfg!(unix) && fs::remove_file(self.path(LOCK)).is_ok();
        drop(self.lock.take());
        if !gone {
            let _ = fs::remove_file(self.path(LOCK));
        }
    }
}
