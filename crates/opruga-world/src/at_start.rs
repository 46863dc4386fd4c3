//! The parts of a scene that have changed since the start, with their values at the start.

use crate::blueprint::{Surroundings, Time};
use opruga_core::spec::Values;
use std::collections::BTreeMap;

/// The changed parts of the scene as they were at the start. Their present values are in the blueprint.
#[derive(Clone, Debug, Default)]
pub(crate) struct AtStart<const D: usize> {
    pub(crate) integrator: Option<Values>,
    pub(crate) surroundings: Option<Surroundings<D>>,
    pub(crate) time: Option<Time>,
    pub(crate) colliders: BTreeMap<usize, Values>,
    pub(crate) contact: Option<Values>,
    /// Models and integrators of the bodies of the scene. A body that a command of the scene adds starts with the values of that command.
    pub(crate) bodies: BTreeMap<usize, (Vec<Values>, Option<Values>)>,
}
