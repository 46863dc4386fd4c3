//! Saves the work of the user while the user works. If the window is lost, because the graphics device, the driver or the whole screen is lost, the
//! supervising program finds the saved work ([`crate::watch`]).

use crate::handing::named_files;
use crate::report::Report;
use crate::runner::{Copied, Link};
use crate::session::Session;
use crate::setting::Setting;
use crate::share::{self, Shared};
use crate::work;
use opruga::io::{Files, SceneError, safe_write::safe_write, scene};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

/// The interval at which new work is saved.
const EVERY: Duration = Duration::from_secs(2);

/// The saving of work to a file.
#[derive(Debug)]
pub struct Rescue {
    path: PathBuf,
    asked: Option<Receiver<Copied>>,
    writing: Option<Receiver<()>>,
    /// When the work was last requested.
    last: Option<Instant>,
    /// The text that was last saved, and whether it contains anything that the user has not saved.
    kept: (Arc<str>, bool),
    /// The files of a scene: the scene, the location of the files, and their contents, which are read only once.
    files: Option<(String, Files, Files)>,
}

impl Rescue {
    /// Saves the work in this file.
    pub fn at(path: impl Into<PathBuf>) -> Rescue {
        Rescue { path: path.into(), asked: None, writing: None, last: None, kept: ("".into(), false), files: None }
    }

    /// Saves new work if it is due. Must be called with every picture.
    pub fn poll(&mut self, link: &Link) {
        if self.writing.as_ref().is_some_and(|writing| writing.try_recv() == Err(std::sync::mpsc::TryRecvError::Empty))
        {
            return;
        }
        self.writing = None;
        if let Some(copied) = self.asked.as_ref().and_then(work::done) {
            self.asked = None;
            self.keep(copied);
        } else if self.asked.is_none() && self.last.is_none_or(|last| last.elapsed() >= EVERY) {
            (self.asked, self.last) = (Some(link.copy()), Some(Instant::now()));
        }
    }

    fn keep(&mut self, copied: Copied) {
        if *copied.text == *self.kept.0 && copied.edited == self.kept.1 {
            return;
        }
        let edited = copied.edited;
        self.kept = (copied.text.as_str().into(), edited);
        let known = self.files.take().filter(|(name, files, _)| *name == copied.name && *files == copied.files);
        let files = known.unwrap_or_else(|| {
            let copied_files =
                Files::in_memory(named_files(&copied.name, &copied.text, &copied.files, &copied.registries));
            (copied.name.clone(), copied.files.clone(), copied_files)
        });
        let shared = Shared { name: copied.name, text: copied.text, files: files.2.clone() };
        self.files = Some(files);
        let path = self.path.clone();
        self.writing = Some(work::spawn(async move {
            // If the work cannot be saved, the window continues anyway, because the saved work matters only if the window is lost.
            let _ = write(&path, &shared);
            let _ = if edited { std::fs::write(mark_of(&path), []) } else { std::fs::remove_file(mark_of(&path)) };
        }));
    }
}

/// The path of a second file, which exists if the saved work contains anything that the user has not saved.
pub fn mark_of(path: &Path) -> PathBuf {
    path.with_extension("edited")
}

/// Writes a scene so that a reader always finds it complete.
///
/// # Errors
/// The errors of the system.
pub fn write(path: &Path, shared: &Shared) -> Result<(), Report> {
    let packed = share::pack(shared)?;
    safe_write(path, true, |file| file.write_all(&packed))?;
    Ok(())
}

/// Reads the saved scene.
///
/// # Errors
/// [`Report`] with the reason why the scene cannot be read.
pub fn read(path: &Path) -> Result<Shared, Report> {
    let refused = |error| Report::Scene(vec![SceneError { file: path.display().to_string(), ..error }]);
    share::unpack(&scene::bytes_of(path, &scene::Limits::default()).map_err(refused)?)
}

/// Reopens the session that was lost. The session goes to the moment at which it was lost, and stops there.
///
/// # Errors
/// [`Report`] with the reason why the scene cannot be opened.
pub fn resume(shared: &Shared, setting: impl Into<Setting>) -> Result<Session, Report> {
    let mut session = Session::open(&shared.name, &shared.text, shared.files.clone(), setting)?;
    session.go_to_the_end();
    Ok(session)
}
