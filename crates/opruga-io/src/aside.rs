//! Files that are first written under a temporary name. This module distinguishes files that a process is still writing from abandoned files.
//!
//! A file is locked while its bytes are written. The system frees the lock when the process ends, however it ends. A file of this kind that can be
//! locked was therefore left by a killed process, and is removed. Process numbers would not identify such a file: they are reused, and several
//! machines may share a folder.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// The ending of a file's name while the file is being written.
const WRITING: &str = ".writing";

/// The temporary name of a file while the writer with this number writes it.
fn name_of(name: &OsStr, writer: u64) -> OsString {
    let mut aside = OsString::from(".");
    aside.push(name);
    aside.push(format!(".{writer}{WRITING}"));
    aside
}

/// The temporary name under which this process writes a file.
pub(crate) fn aside_name(name: &OsStr) -> OsString {
    name_of(name, std::process::id().into())
}

/// The final name of a file whose temporary name has the form of [`aside_name`]; none for other names.
fn name_within(aside: &str) -> Option<&str> {
    let (name, process) = aside.strip_prefix('.')?.strip_suffix(WRITING)?.rsplit_once('.')?;
    (!process.is_empty() && process.bytes().all(|b| b.is_ascii_digit())).then_some(name)
}

/// Whether a name has the form of [`aside_name`].
pub(crate) fn is_aside(name: &str) -> bool {
    name_within(name).is_some()
}

/// Creates a temporary file in a folder for a file with this name. The file is locked while it is open.
pub(crate) fn make_aside(folder: &Path, name: &OsStr) -> io::Result<(PathBuf, File)> {
    let mut writer = u64::from(std::process::id());
    loop {
        let aside = folder.join(name_of(name, writer));
        match OpenOptions::new().write(true).create_new(true).open(&aside) {
            Ok(file) => {
                match file.lock() {
                    Err(e) if e.kind() != io::ErrorKind::Unsupported => {
                        let _ = fs::remove_file(&aside);
                        return Err(e);
                    }
                    _ => {}
                }
                // Before the file was locked, another process may have considered it abandoned and removed it.
                if is_the_file(&file, &aside) {
                    return Ok((aside, file));
                }
            }
            // Another writer, such as another thread or a process in another container, has the same number.
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists && !remove_if_dead(&aside) => writer += 1,
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
        }
    }
}

/// Removes the temporary files that killed processes left in a folder for a file with this name. If there is no name, removes the temporary files for
/// all files.
pub(crate) fn remove_the_dead(folder: &Path, name: Option<&OsStr>) {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    for found in entries.filter_map(|entry| entry.file_name().into_string().ok()) {
        let own = name_within(&found).is_some_and(|of| name.is_none_or(|name| name == of));
        if own {
            remove_if_dead(&folder.join(found));
        }
    }
}

/// Removes a file that no process has locked, and returns whether it is gone. The file is kept if the file system has no locks, because a process may
/// still be writing it.
fn remove_if_dead(aside: &Path) -> bool {
    match File::open(aside) {
        Ok(file) => match file.try_lock() {
            // The file is removed while it is still locked: once it is unlocked, its name may belong to another file.
            Ok(()) => is_the_file(&file, aside) && fs::remove_file(aside).is_ok(),
            Err(TryLockError::WouldBlock | TryLockError::Error(_)) => false,
        },
        Err(e) => e.kind() == io::ErrorKind::NotFound,
    }
}

/// Whether an open file still has its name.
#[cfg(unix)]
pub(crate) fn is_the_file(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let same = |a: fs::Metadata, b: fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    file.metadata().is_ok_and(|own| fs::metadata(path).is_ok_and(|named| same(own, named)))
}
#[cfg(not(unix))]
pub(crate) fn is_the_file(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_dead_process_left_goes_and_what_a_living_one_holds_stays() {
        let folder = std::env::temp_dir().join(format!("opruga-aside-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        let name = OsStr::new("q.msh");
        let (living, held) = make_aside(&folder, name).expect("a file");
        let (other, _held) = make_aside(&folder, name).expect("another writer of the same name");
        assert_ne!(living, other);
        for dead in [".q.msh.1.writing", ".other.2.writing"] {
            fs::write(folder.join(dead), "half").expect("a file");
        }
        for alien in [".q.msh.x.writing", "q.msh", ".q.msh.writing"] {
            fs::write(folder.join(alien), "not ours").expect("a file");
        }
        remove_the_dead(&folder, Some(name));
        let there = |name: &str| folder.join(name).exists();
        assert!(living.exists() && other.exists() && there(".other.2.writing") && !there(".q.msh.1.writing"));
        remove_the_dead(&folder, None);
        assert!(living.exists() && other.exists() && !there(".other.2.writing"));
        assert!(there(".q.msh.x.writing") && there("q.msh") && there(".q.msh.writing"));
        drop(held);
        remove_the_dead(&folder, None);
        assert!(!living.exists() && other.exists());
        fs::remove_dir_all(&folder).expect("it goes");
    }
}
