//! Read-only access to a session.

use super::{Session, mark};
use crate::differences::Difference;
use opruga::Registries;
use opruga::io::Files;

impl Session {
    /// The scene with everything that was done so far. On the command line, the scene ends at the present frame with the same hash.
    pub fn saved(&self) -> String {
        let mut document = self.let_go_of_all();
        document.set_seconds(self.engine.time().max(self.time_of(self.latest)));
        document.text()
    }

    /// How the scene on the right differs from the scene on the left; `None` if only one scene is shown.
    pub fn differences(&self) -> Option<&[Difference]> {
        self.differences.as_deref()
    }

    /// Whether anything was edited or recorded after the scene was opened or saved.
    pub fn is_edited(&self) -> bool {
        self.mark() != self.clean
    }

    /// A fingerprint of the text of the scene and of the differences of the scene beside it.
    pub fn mark(&self) -> u64 {
        let differences = self.differences.iter().flatten().map(|difference| format!("\n{difference:?}"));
        mark(&std::iter::once(self.document.text()).chain(differences).collect::<String>())
    }

    /// The present text of the scene.
    pub fn text(&self) -> String {
        self.document.text()
    }

    /// The location of the files that the scene names.
    pub fn files(&self) -> &Files {
        &self.files
    }

    /// The models and integrators that the scene can name.
    pub fn registries(&self) -> &Registries {
        &self.setting.registries
    }

    /// The hash of the state.
    pub fn hash(&self) -> u64 {
        self.engine.hash()
    }

    /// The number of frames since the start.
    pub fn frames(&self) -> u64 {
        self.engine.frames()
    }

    /// The columns and the row of a table for the present state.
    pub fn row(&mut self) -> Vec<(String, f64)> {
        self.engine.row()
    }

    /// The name of the scene.
    pub fn name(&self) -> &str {
        &self.document.name
    }

    /// The last computed frame of this run.
    pub fn latest(&self) -> u64 {
        self.latest
    }

    /// The number of messages so far.
    pub fn message_count(&self) -> u64 {
        self.messages
    }

    /// Whether the session is on the way to another moment.
    pub fn is_seeking(&self) -> bool {
        self.goal.is_some()
    }

    /// Whether frames are being computed: time passes, or the session is on the way to another moment.
    pub fn is_moving(&self) -> bool {
        self.playing || self.goal.is_some()
    }
}
