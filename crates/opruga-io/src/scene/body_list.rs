//! The bodies of a scene, as all that names them finds them.

use super::Cost;
use opruga_world::blueprint::BodyBlueprint;
use std::collections::{BTreeMap, BTreeSet};

/// The bodies of a scene, copies written out; behind them those that commands add, in the order of time.
pub(crate) struct Bodies<const D: usize> {
    pub(crate) list: Vec<BodyBlueprint<D>>,
    /// How many are there at the start.
    pub(crate) initial: usize,
    /// Number of an `add` command → place of its body in the list, and when it is added.
    pub(crate) later: BTreeMap<usize, (usize, f64)>,
    /// Name → place in the list.
    pub(super) names: BTreeMap<String, usize>,
    /// Name of a body with copies → the place of the first, and how far each is from where the body would lie.
    pub(super) copied: BTreeMap<String, (usize, Vec<[f64; D]>)>,
    /// What all of them would cost.
    pub(super) cost: Cost,
    /// Names of bodies that could not be made: a reference to them is no further error.
    pub(super) broken: Vec<String>,
    /// Places of bodies that were made, but have errors in their fields.
    pub(crate) unsound: BTreeSet<usize>,
}
