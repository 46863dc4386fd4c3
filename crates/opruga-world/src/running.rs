//! Commands and their progress.

use crate::blueprint::{Action, CommandBlueprint};
use std::sync::{Arc, RwLock};

/// The progress of a command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Progress<const D: usize> {
    /// The time of the command is yet to come.
    Waiting,
    /// The command is active. A drag grabs these nodes with these weights; a pin holds nodes at these positions.
    Acting { targets: Vec<(u32, f64)>, anchors: Vec<[f64; D]> },
    /// The command is over.
    Done,
}

/// A command and its progress.
#[derive(Clone, Debug)]
pub(crate) struct Running<const D: usize> {
    pub(crate) command: CommandBlueprint<D>,
    pub(crate) progress: Progress<D>,
    /// The path of a drag, shared with its pull; empty for all other commands.
    pub(crate) path: Arc<RwLock<Vec<Vec<f64>>>>,
    /// Whether the command was given by [`World::act`] and belongs to the commands of the scene.
    pub(crate) acted: bool,
    /// Whether the command was given by [`World::command`]. Such a command comes after the commands of the scene, and the world keeps nothing of it
    /// once it is over.
    pub(crate) given: bool,
    /// The generation of the body that it adds, if it belongs to the scene.
    pub(crate) generation: u64,
}

impl<const D: usize> Running<D> {
    /// A command that has not begun.
    pub(crate) fn waiting(command: CommandBlueprint<D>) -> Running<D> {
        let path = match &command.action {
            Action::Drag { path, .. } => path.clone(),
            _ => Vec::new(),
        };
        let path = Arc::new(RwLock::new(path));
        Running { command, progress: Progress::Waiting, path, acted: false, given: false, generation: 0 }
    }
    /// A command of the program.
    pub(crate) fn given(command: CommandBlueprint<D>, progress: Progress<D>) -> Running<D> {
        Running { given: true, progress, ..Running::waiting(command) }
    }
    /// The same command before it begins.
    pub(crate) fn anew(&self) -> Running<D> {
        let Running { acted, given, generation, .. } = *self;
        Running { acted, given, generation, ..Running::waiting(self.command.clone()) }
    }
}
