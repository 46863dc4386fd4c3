//! Reads regular files completely, up to a limit.

use crate::problem::SceneError;
use crate::text_errors::{FileError, Measured, TextError};
use std::path::Path;
use std::sync::Arc;

/// Returns the bytes of a regular file that is not larger than a limit.
pub(crate) fn regular_file(
    path: &Path,
    most: u64,
    code: &'static str,
    what: Measured,
) -> Result<Arc<[u8]>, SceneError> {
    use std::io::Read as _;
    let failed = |e: std::io::Error| SceneError::of(FileError::Failed { reason: reason(&e) });
    let about = std::fs::metadata(path).map_err(failed)?;
    if !about.is_file() {
        return Err(SceneError::of(if about.is_dir() { FileError::Folder {} } else { FileError::NotRegular {} }));
    }
    let too_large = |size: u64| SceneError { code, ..SceneError::of(TextError::Size { what, size, most }) };
    if about.len() > most {
        return Err(too_large(about.len()));
    }
    let mut file = std::fs::File::open(path).map_err(failed)?;
    let before = Stamp::of(&file).map_err(failed)?;
    // One byte more than allowed, in case the file grows while it is read.
    let mut bytes = Vec::new();
    (&mut file).take(most + 1).read_to_end(&mut bytes).map_err(failed)?;
    before.unchanged(&file, bytes.len() as u64)?;
    if bytes.len() as u64 > most {
        return Err(too_large(bytes.len() as u64));
    }
    Ok(bytes.into())
}

/// Size and modification time of a file, which show whether it was changed while it was read.
#[derive(Debug, PartialEq)]
struct Stamp {
    bytes: u64,
    changed: Option<std::time::SystemTime>,
}

impl Stamp {
    fn of(file: &std::fs::File) -> std::io::Result<Stamp> {
        let about = file.metadata()?;
        Ok(Stamp { bytes: about.len(), changed: about.modified().ok() })
    }

    /// Refuses bytes that may be partly old and partly new.
    fn unchanged(&self, file: &std::fs::File, read: u64) -> Result<(), SceneError> {
        match Stamp::of(file) {
            Ok(now) if now == *self && read == self.bytes => Ok(()),
            _ => Err(SceneError::of(FileError::Changed {})),
        }
    }
}

/// The reason of a system error, without its number.
pub(crate) fn reason(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or(&text).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    /// A file that grows or is overwritten between the first and the last byte that is read is refused.
    #[test]
    fn a_file_that_changes_while_it_is_read_is_refused() {
        let path = std::env::temp_dir().join(format!("opruga-changed-{}", std::process::id()));
        std::fs::write(&path, b"old text").expect("a file");
        let file = std::fs::File::open(&path).expect("a file");
        let stamp = Stamp::of(&file).expect("a stamp");
        assert_eq!(stamp.unchanged(&file, 8), Ok(()));
        assert_eq!(stamp.unchanged(&file, 7).map_err(|e| e.code), Err("read.changed"), "cut off meanwhile");
        std::fs::OpenOptions::new().append(true).open(&path).and_then(|mut f| f.write_all(b"!")).expect("it grows");
        assert_eq!(stamp.unchanged(&file, 8).map_err(|e| (e.code, e.exit_code())), Err(("read.changed", 4)));
        let stamp = Stamp::of(&file).expect("a stamp");
        let later = stamp.changed.expect("a time") + std::time::Duration::from_secs(1);
        let writer = std::fs::OpenOptions::new().write(true).open(&path).expect("a file");
        writer.set_modified(later).expect("a time");
        assert_eq!(stamp.unchanged(&file, 9).map_err(|e| e.code), Err("read.changed"), "written over meanwhile");
        std::fs::remove_file(&path).expect("the file is there");
    }
}
