//! What of a body is carried over when its island is built anew.

use opruga_core::state::Columns;
use opruga_core::system::System;

/// What is carried over when islands are built anew.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyState<const D: usize> {
    pub(crate) x: Vec<[f64; D]>,
    pub(crate) v: Vec<[f64; D]>,
    /// Memory of each model of the blueprint: every eighth number belongs to this body.
    pub(crate) memory: Vec<Vec<f64>>,
    pub(crate) history: BodyHistory<D>,
}

/// What an integrator remembers of one body.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct BodyHistory<const D: usize> {
    /// The integrator.
    pub(crate) owner: String,
    pub(crate) columns: Vec<Vec<[f64; D]>>,
    pub(crate) numbers: Vec<f64>,
}

impl<const D: usize> BodyHistory<D> {
    /// That of a body in a lane.
    pub(crate) fn of(system: &System<D>, lane: usize) -> BodyHistory<D> {
        let place = |node| system.layout.place(node, lane);
        let column = |c: &Columns<D>| (0..system.nodes).map(|n| c.at(place(n))).collect();
        BodyHistory {
            owner: system.history.owner.into(),
            columns: system.history.columns.iter().map(column).collect(),
            numbers: system.history.numbers.clone(),
        }
    }
    /// Whether the integrator of a system remembers as much.
    pub(crate) fn fits(&self, system: &System<D>) -> bool {
        let own = &system.history;
        self.owner == own.owner && self.columns.len() == own.columns.len() && self.numbers.len() == own.numbers.len()
    }
    /// Gives it back to the system of a body, if that has the same integrator.
    pub(crate) fn restore(&self, system: &mut System<D>, lane: usize) {
        if !self.fits(system) {
            return;
        }
        let own = &mut system.history;
        own.numbers.clone_from(&self.numbers);
        for (column, kept) in own.columns.iter_mut().zip(&self.columns) {
            for (node, value) in kept.iter().enumerate().take(system.nodes) {
                column.set(system.layout.place(node, lane), *value);
            }
        }
    }
}
