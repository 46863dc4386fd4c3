//! The destination of files: a desktop window writes them to the folder `out/studio`, and a web page offers them as downloads. A scene is written
//! together with the files that it names, so that it can be run from that folder.

use crate::report::Report;
use opruga::io::{Files, scene};
use opruga::{Registries, catalogue_of};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The files that a scene names, by name.
pub fn named_files(name: &str, text: &str, files: &Files, registries: &Registries) -> BTreeMap<String, Arc<[u8]>> {
    let options = scene::Options { files: files.clone(), ..scene::Options::default() };
    scene::survey(text.as_bytes(), &format!("{name}.toml"), &catalogue_of(registries), &options).files
}

#[cfg(target_arch = "wasm32")]
pub(crate) use page::{file, scene_with_files};
#[cfg(not(target_arch = "wasm32"))]
pub use window::{Folder, file, scene_with_files};

#[cfg(not(target_arch = "wasm32"))]
mod window {
    use super::*;
    use opruga::io::safe_write::safe_write;
    use std::path::{Path, PathBuf};

    /// The largest number of names that are tried: `ball`, `ball-2` and so on.
    const MOST_NAMES: u32 = 10_000;

    /// A folder in which no file replaces another.
    #[derive(Clone, Debug)]
    pub struct Folder(PathBuf);

    impl Default for Folder {
        fn default() -> Folder {
            Folder(PathBuf::from("out").join("studio"))
        }
    }

    impl Folder {
        /// A folder at this path; it is made when the first file is written.
        pub fn at(path: impl Into<PathBuf>) -> Folder {
            Folder(path.into())
        }

        fn made(&self) -> Result<(), Report> {
            let refused = |e: std::io::Error| Report::NoFolder(self.0.display().to_string(), e.to_string());
            std::fs::create_dir_all(&self.0).map_err(refused)
        }

        fn free(&self, name: impl Fn(String) -> String, of: &str) -> Result<PathBuf, Report> {
            let numbered = |number: u32| if number == 1 { of.to_string() } else { format!("{of}-{number}") };
            let free = (1..MOST_NAMES).map(|number| self.0.join(name(numbered(number)))).find(|path| !path.exists());
            free.ok_or_else(|| Report::FolderFull(self.0.display().to_string()))
        }

        /// Writes a file under a name that does not exist yet; returns its path.
        ///
        /// # Errors
        /// The errors of the system.
        pub fn file(&self, name: &str, ending: &str, bytes: &[u8]) -> Result<PathBuf, Report> {
            self.made()?;
            let path = self.free(|name| format!("{name}.{ending}"), name)?;
            write(&path, bytes)?;
            Ok(path)
        }

        /// Writes a scene. If the scene names files, it is written to its own folder together with these files. The path of the scene comes first.
        ///
        /// # Errors
        /// The errors of the system; in this case no file is left behind.
        pub fn scene(
            &self,
            name: &str,
            text: &str,
            files: &Files,
            registries: &Registries,
        ) -> Result<Vec<PathBuf>, Report> {
            let named = named_files(name, text, files, registries);
            if named.is_empty() {
                return self.file(name, "toml", text.as_bytes()).map(|path| vec![path]);
            }
            self.made()?;
            let own = Folder(self.free(|name| name, name)?);
            let outcome = own.fill(name, text, &named);
            if outcome.is_err() {
                // The folder was made only for this scene.
                let _ = std::fs::remove_dir_all(&own.0);
            }
            outcome
        }

        fn fill(&self, name: &str, text: &str, named: &BTreeMap<String, Arc<[u8]>>) -> Result<Vec<PathBuf>, Report> {
            self.made()?;
            let mut written = vec![self.0.join(format!("{name}.toml"))];
            for (name, bytes) in named {
                let path = self.0.join(name);
                // The folder of a file is inside the folder of the scene, because a scene cannot name files outside its folder.
                Folder(path.parent().unwrap_or(&self.0).to_path_buf()).made()?;
                write(&path, bytes)?;
                written.push(path);
            }
            write(&written[0], text.as_bytes())?;
            Ok(written)
        }
    }

    fn write(path: &Path, bytes: &[u8]) -> Result<(), Report> {
        safe_write(path, false, |file| file.write_all(bytes))?;
        Ok(())
    }

    /// Writes a file to `out/studio`; returns its path.
    ///
    /// # Errors
    /// The errors of the system.
    pub fn file(name: &str, ending: &str, bytes: &[u8]) -> Result<String, Report> {
        Folder::default().file(name, ending, bytes).map(|path| path.display().to_string())
    }

    /// Writes a scene and the files that it names to `out/studio`; returns their paths.
    ///
    /// # Errors
    /// The errors of the system.
    pub fn scene_with_files(
        name: &str,
        text: &str,
        files: &Files,
        registries: &Registries,
    ) -> Result<Vec<String>, Report> {
        let written = Folder::default().scene(name, text, files, registries)?;
        Ok(written.iter().map(|path| path.display().to_string()).collect())
    }
}

#[cfg(target_arch = "wasm32")]
mod page {
    use super::*;

    /// Starts a download; returns its name.
    pub(crate) fn file(name: &str, ending: &str, bytes: &[u8]) -> Result<String, Report> {
        let name = format!("{name}.{ending}");
        crate::browser::download(&name, bytes).map(|()| name)
    }

    /// Downloads a scene and the files that it names as separate files. A browser puts all of them into one folder, so the scene finds its files.
    pub(crate) fn scene_with_files(
        name: &str,
        text: &str,
        files: &Files,
        registries: &Registries,
    ) -> Result<Vec<String>, Report> {
        let (mut text, mut written) = (text.to_string(), vec![format!("{name}.toml")]);
        for (named, bytes) in named_files(name, &text, files, registries) {
            let last = named.rsplit('/').next().unwrap_or(&named).to_string();
            text = text.replace(&format!("\"{named}\""), &format!("\"{last}\""));
            crate::browser::download(&last, &bytes)?;
            written.push(last);
        }
        file(name, "toml", text.as_bytes())?;
        Ok(written)
    }
}
