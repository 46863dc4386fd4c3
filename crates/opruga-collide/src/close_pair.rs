//! A pair that comes close in a step. A later step decides whether to solve for the impulse of the pair.

use crate::row::Row;
use crate::spread::Spread;
use crate::surface::Surface;

/// Two features that come close in the step: the content of a [`Row`] without masses and impulses.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosePair<const D: usize> {
    pub(crate) id: u64,
    /// The index of its pair of bodies.
    pub(crate) pair: u32,
    pub(crate) points: [u32; 4],
    pub(crate) weights: [f64; 4],
    pub(crate) normal: [f64; D],
    /// The gap at the start of the step minus the thickness, followed by the thickness [m].
    pub(crate) gap: f64,
    pub(crate) thickness: f64,
    pub(crate) friction: f64,
    /// The least normal velocity at the end of the step [m/s].
    pub(crate) target: f64,
}

impl<const D: usize> ClosePair<D> {
    /// Returns its row, without masses. Its nodes are added to `spread` if nodes carry its points.
    pub(crate) fn into_row(self, spread: &mut Spread, surface: &Surface<D>) -> Row<D> {
        let nodes = spread.put(surface, (&self.points[..=D], &self.weights[..=D]));
        self.into_row_on(nodes)
    }

    /// Returns its row, without masses, given the range of its nodes in [`Spread`].
    pub(crate) fn into_row_on(self, nodes: [u32; 2]) -> Row<D> {
        let mut row = Row::new(self.id, (self.points, self.weights), self.normal, self.friction);
        (row.gap, row.target, row.pair, row.spread) = (self.gap, self.target, self.pair, nodes);
        row
    }
}
