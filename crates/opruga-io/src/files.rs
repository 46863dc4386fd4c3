//! The files that a scene names, which are next to the scene or in memory.

use crate::problem::{SceneError, visible};
use crate::text_errors::{FileError, Measured};
use opruga_core::spec::nearest;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// The source of the files of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Files {
    /// Files by the name that the scene uses, such as those that come with the program.
    in_memory: BTreeMap<String, Arc<[u8]>>,
    /// The folder of the scene.
    folder: Option<PathBuf>,
    /// Whether files may be outside that folder.
    outside: bool,
}

impl Files {
    /// Files in the folder of the scene.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Files {
        Files { folder: Some(folder.into()), ..Files::default() }
    }

    /// Files in the folder of a scene file.
    pub fn beside(scene: &Path) -> Files {
        let folder = scene.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Files::in_folder(folder)
    }

    /// Files in memory, by the name that the scene uses.
    pub fn in_memory(files: impl IntoIterator<Item = (String, Arc<[u8]>)>) -> Files {
        Files { in_memory: files.into_iter().collect(), ..Files::default() }
    }

    /// Adds files in memory; a file replaces an earlier file of the same name.
    #[must_use]
    pub fn with(mut self, files: impl IntoIterator<Item = (String, Arc<[u8]>)>) -> Files {
        self.in_memory.extend(files);
        self
    }

    /// The files in memory, in the order of their names.
    pub fn files_in_memory(&self) -> impl Iterator<Item = (&str, &Arc<[u8]>)> {
        self.in_memory.iter().map(|(name, bytes)| (name.as_str(), bytes))
    }

    /// Returns a file in memory.
    pub fn file_in_memory(&self, name: &str) -> Option<&Arc<[u8]>> {
        self.in_memory.get(name)
    }

    /// Sets whether files may be outside the folder of the scene.
    #[must_use]
    pub fn allow_outside(mut self, allow: bool) -> Files {
        self.outside = allow;
        self
    }

    /// The path of a file that a scene names; none if it is in memory or may not be read.
    pub fn path_of(&self, name: &str) -> Option<PathBuf> {
        let path = self.folder.as_ref().filter(|_| !self.in_memory.contains_key(name))?.join(name);
        self.check_location(self.folder.as_ref()?, &path, name).is_ok().then_some(path)
    }

    /// Returns the bytes of a file that a scene names.
    ///
    /// # Errors
    /// `shape.outside` for a name that leads out of the folder of the scene; `read.failed` with the nearest name; `read.not_regular_file`;
    /// `shape.too_large`, before anything is read.
    pub(crate) fn read(&self, name: &str, most_bytes: u64) -> Result<Arc<[u8]>, SceneError> {
        if let Some(bytes) = self.in_memory.get(name) {
            return Ok(Arc::clone(bytes));
        }
        let Some(folder) = &self.folder else {
            let (name_shown, suggestion) = (visible(name), nearest(name, self.in_memory.keys().map(String::as_str)));
            let about = match self.in_memory.len() {
                0 => FileError::NoFolder { name: name_shown },
                _ => {
                    let known = self.in_memory.keys().cloned().collect::<Vec<_>>().join(", ");
                    FileError::NotHeld { name: name_shown, known }
                }
            };
            return Err(SceneError::of(about).nearest(suggestion));
        };
        let path = folder.join(name);
        self.check_location(folder, &path, name)?;
        crate::regular_file::regular_file(&path, most_bytes, "shape.too_large", Measured::File)
            .map_err(|error| if path.exists() { error.value(visible(name)) } else { self.missing(folder, name) })
    }

    /// Refuses names that lead out of the folder, by `..` or by links.
    fn check_location(&self, folder: &Path, path: &Path, name: &str) -> Result<(), SceneError> {
        if self.outside {
            return Ok(());
        }
        let plain = Path::new(name).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
        let foreign = name.contains('\\') || name.contains('\0') || name.as_bytes().get(1) == Some(&b':');
        // A link is followed before its target is compared.
        let inside = match (folder.canonicalize(), path.canonicalize()) {
            (Ok(folder), Ok(path)) => path.starts_with(folder),
            _ => true,
        };
        if plain && !foreign && !name.is_empty() && inside {
            return Ok(());
        }
        Err(SceneError::of(FileError::Outside { name: visible(name) }))
    }

    /// The error for a missing file, with the nearest name in the same folder.
    fn missing(&self, folder: &Path, name: &str) -> SceneError {
        let (before, last) = name.rsplit_once('/').map_or(("", name), |(before, last)| (before, last));
        let entries = std::fs::read_dir(folder.join(before)).into_iter().flatten().flatten();
        let mut names: Vec<String> = entries.take(10_000).filter_map(|e| e.file_name().into_string().ok()).collect();
        names.sort();
        let suggestion = nearest(last, names.iter().map(String::as_str));
        let whole = suggestion.map(|n| if before.is_empty() { n } else { format!("{before}/{n}") });
        let folder = visible(&folder.display().to_string());
        SceneError::of(FileError::NotThere { name: visible(name), folder }).nearest(whole)
    }
}
