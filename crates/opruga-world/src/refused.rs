//! Information for a scene about a command that could not begin.

use crate::blueprint::{Action, Blueprint, CommandBlueprint};

/// A command that could not begin, with the parts from which the scene can find out what to change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedCommand<'w> {
    /// When it begins [s].
    pub at: f64,
    /// The word for its action in scene files.
    pub word: &'static str,
    /// The parameter that it sets.
    pub sets: Option<&'w str>,
    /// The name of the body that it adds or removes.
    pub body: Option<&'w str>,
    /// Whether a command of the scene had already set the number of substeps.
    pub substeps_were_set: bool,
}

/// The path of the number of substeps.
const SUBSTEPS: &str = "time.substeps";

impl<'w> RefusedCommand<'w> {
    pub(crate) fn of<const D: usize>(command: &'w CommandBlueprint<D>, scene: &Blueprint<D>) -> Self {
        let (sets, body) = match &command.action {
            Action::Set { path, .. } => (Some(path.as_str()), None),
            Action::Remove { name } => (None, Some(name.as_str())),
            Action::Add(body) => (None, Some(body.name.as_str())),
            _ => (None, None),
        };
        let sets_substeps = |action: &Action<D>| matches!(action, Action::Set { path, .. } if path == SUBSTEPS);
        let mut before = scene.commands.iter().filter(|before| before.at <= command.at);
        let substeps_were_set = before.any(|before| sets_substeps(&before.action));
        RefusedCommand { at: command.at, word: command.action.word(), sets, body, substeps_were_set }
    }

    /// Whether it sets the number of substeps.
    pub fn sets_substeps(&self) -> bool {
        self.sets == Some(SUBSTEPS)
    }
}
