//! Commands and how far they have come.

use crate::blueprint::{Action, CommandBlueprint};
use std::sync::{Arc, RwLock};

/// How far a command has come.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Progress<const D: usize> {
    /// Its time has not come.
    Waiting,
    /// It acts; a drag holds these nodes with these shares, a pin holds nodes at these positions.
    Acting { targets: Vec<(u32, f64)>, anchors: Vec<[f64; D]> },
    /// It is over.
    Done,
}

/// A command and how far it has come.
#[derive(Clone, Debug)]
pub(crate) struct Running<const D: usize> {
    pub(crate) command: CommandBlueprint<D>,
    pub(crate) progress: Progress<D>,
    /// The path of a drag, shared with the pull that it becomes; empty for all others.
    pub(crate) path: Arc<RwLock<Vec<Vec<f64>>>>,
    /// Whether it was given by [`World::act`], and stands among those of the scene.
    pub(crate) acted: bool,
    /// Whether it was given by [`World::command`]: it stands behind those of the scene, and nothing is kept of it once it is over.
    pub(crate) given: bool,
    /// The generation of the body that it adds, if it belongs to the scene.
    pub(crate) generation: u64,
}

impl<const D: usize> Running<D> {
    /// A command whose time has not come.
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
    /// The same command before its time has come.
    pub(crate) fn anew(&self) -> Running<D> {
        let Running { acted, given, generation, .. } = *self;
        Running { acted, given, generation, ..Running::waiting(self.command.clone()) }
    }
}
