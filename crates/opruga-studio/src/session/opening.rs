//! Opens another scene, returns to the previous one, and adds shapes from files to the scene.

use super::offers::with_a_margin;
use super::{Edit, Session};
use crate::document::Document;
use crate::handing::named_files;
use crate::report::{Report, Step};
use crate::setting::Setting;
use crate::shape_file::Shape;
use crate::shown::Severity;
use opruga::WorldError;
use opruga::core::spec::Value;
use opruga::io::Files;
use std::path::Path;
use std::sync::Arc;

impl Session {
    /// Opens another scene. If the previous scene contains work, the user can return to it.
    pub(super) fn open_another(&mut self, name: &str, text: &str, files: Files) -> Result<(), Report> {
        let next = Session::open(name, text, files, self.setting.clone())?;
        self.go_over_to(next, true);
        Ok(())
    }

    /// Replaces this session by another session.
    fn go_over_to(&mut self, mut next: Session, playing: bool) {
        self.release();
        (next.show, next.speed, next.playing) = (self.show, self.speed, playing);
        (next.opened, next.messages, next.patience) = (self.opened + 1, self.messages, self.patience.anew());
        next.resets = self.resets;
        let before = std::mem::replace(self, next);
        // Only one previous session is kept, because the states of every session need memory.
        let worked_on = before.document.commands() > before.own_commands || !before.undo.is_empty();
        self.before = worked_on.then(|| Box::new(Session { before: None, ..before }));
        self.pacing.rest();
    }

    /// Returns the opening of this scene as a step, if it can be undone. An undo reverts the opening if nothing was done in this scene.
    pub(super) fn opening(&self) -> Option<Step> {
        self.before.as_ref().map(|before| Step::Open(before.document.name.clone()))
    }

    /// Returns to the scene that was open before this one, if there is one, as the user left it.
    pub(super) fn open_before(&mut self) {
        let (Some(step), Some(before)) = (self.opening(), self.before.take()) else { return };
        self.go_over_to(*before, false);
        let time = self.engine.time();
        self.report(Severity::Done, Report::Undone(step, time), None);
    }

    /// Adds a shape from a file as another body. If its dimension differs from that of the scene, opens a new scene around it.
    pub(super) fn take_shape(&mut self, shape: &Shape, middle: [f64; 3], size: f64) -> Result<(), Report> {
        let fits = (self.dimension() == 3) == shape.space;
        let files: Vec<(String, Arc<[u8]>)> = match fits {
            true => named_files(&shape.name, &shape.text, &shape.files, &self.setting.registries).into_iter().collect(),
            false => Vec::new(),
        };
        // If the file cannot be read, or if the shape consists of several files, a new scene around the shape is opened. It reports the error or
        // shows the shape.
        let [(_, bytes)] = &files[..] else { return self.open_around(shape) };
        let file = self.free_file(&shape.file, bytes);
        let Some(body) = shape.body(&file, size) else { return Err(Report::NameOfFile(shape.file.clone())) };
        let before = self.files.clone();
        self.files = before.clone().with([(file, Arc::clone(bytes))]);
        let outcome = self.edit(&Edit::Drop(body, middle));
        outcome.map_err(|report| {
            self.files = before;
            match report {
                // Errors that name no file are errors in this file.
                Report::Scene(mut errors) => {
                    errors.iter_mut().filter(|e| e.file.is_empty()).for_each(|e| e.file.clone_from(&shape.file));
                    Report::Scene(errors)
                }
                report => report,
            }
        })
    }

    /// Returns a name under which the scene can store a file with these bytes: the name of the file, or this name with a number.
    fn free_file(&self, file: &str, bytes: &Arc<[u8]>) -> String {
        let (stem, ending) = file.rsplit_once('.').unwrap_or((file, ""));
        let numbered = |number: u32| if number == 1 { file.to_string() } else { format!("{stem}-{number}.{ending}") };
        let free = |name: &String| match self.files.file_in_memory(name) {
            Some(other) => other == bytes,
            // A name is also free if the file with this name next to the scene has the same bytes.
            None => self.files.path_of(name).is_none_or(|path| !path.exists() || holds(&path, bytes)),
        };
        (1..=u32::MAX).map(numbered).find(free).unwrap_or_else(|| file.to_string())
    }

    /// Makes a session of a scene around a shape, with as many substeps as the scene needs.
    ///
    /// # Errors
    /// The errors of the file.
    pub fn around(shape: &Shape, setting: &Setting) -> Result<Session, Report> {
        let document =
            Document::unread(&shape.name, &shape.text, &shape.files, &setting.registries, Some(&shape.file))?;
        match Session::begin(document.clone(), shape.files.clone(), setting.clone()) {
            Err(Report::World(WorldError::UnstableStep { substeps, .. })) => {
                let mut finer = document;
                finer.set("time.substeps", &Value::Integer(i64::from(with_a_margin(substeps))));
                Session::begin(finer, shape.files.clone(), setting.clone())
            }
            outcome => outcome,
        }
    }

    /// Opens the scene around a shape.
    fn open_around(&mut self, shape: &Shape) -> Result<(), Report> {
        let next = Session::around(shape, &self.setting)?;
        self.go_over_to(next, true);
        Ok(())
    }

    /// Opens a scene with this number of substeps.
    pub(super) fn open_with(&mut self, name: &str, text: &str, files: Files, substeps: u32) -> Result<(), Report> {
        let mut document = Document::new(name, text)?;
        document.set("time.substeps", &Value::Integer(i64::from(substeps)));
        self.open_another(name, &document.text(), files)
    }
}

/// Whether a file has exactly these bytes.
fn holds(path: &Path, bytes: &[u8]) -> bool {
    let long = std::fs::metadata(path).is_ok_and(|about| about.is_file() && about.len() == bytes.len() as u64);
    long && std::fs::read(path).is_ok_and(|content| content == bytes)
}
