//! The parts of a scene that have changed since the start, as they were then.

use crate::blueprint::{Surroundings, Time};
use opruga_core::spec::Values;
use std::collections::BTreeMap;

/// What of the scene has changed since the start, as it was then. What it has become stands in the blueprint.
#[derive(Clone, Debug, Default)]
pub(crate) struct AtStart<const D: usize> {
    pub(crate) integrator: Option<Values>,
    pub(crate) surroundings: Option<Surroundings<D>>,
    pub(crate) time: Option<Time>,
    pub(crate) colliders: BTreeMap<usize, Values>,
    pub(crate) contact: Option<Values>,
    /// Models and integrators of bodies of the scene; a body that a command of it adds begins as the command says.
    pub(crate) bodies: BTreeMap<usize, (Vec<Values>, Option<Values>)>,
}
