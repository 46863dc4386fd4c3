//! The list in which names of bodies in a scene are looked up.

use super::Cost;
use opruga_world::blueprint::BodyBlueprint;
use std::collections::{BTreeMap, BTreeSet};

/// The bodies of a scene with all copies, followed by those that commands add, in the order of time.
pub(crate) struct Bodies<const D: usize> {
    pub(crate) list: Vec<BodyBlueprint<D>>,
    /// The number of bodies at the start.
    pub(crate) initial: usize,
    /// For the number of each `add` command: the index of its body in the list, and the time at which the body is added.
    pub(crate) later: BTreeMap<usize, (usize, f64)>,
    /// Name → index in the list.
    pub(super) names: BTreeMap<String, usize>,
    /// Name of a body with copies → index of the first copy, and the offset of each copy from the position that the body would have.
    pub(super) copied: BTreeMap<String, (usize, Vec<[f64; D]>)>,
    /// The cost of all bodies.
    pub(super) cost: Cost,
    /// Names of bodies that could not be made: a reference to one of them is not a further error.
    pub(super) broken: Vec<String>,
    /// Indices of bodies that were made, but have errors in their fields.
    pub(crate) unsound: BTreeSet<usize>,
}
