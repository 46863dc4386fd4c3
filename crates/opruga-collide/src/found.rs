//! The pairs that come close in a step.

use crate::close_pair::ClosePair;
use crate::row::Row;
use crate::spread::Spread;
use crate::unclear::Unclear;
use core::ops::Range;

/// The pairs of one part of the candidates that come close in a step.
#[derive(Debug, Default)]
pub(crate) struct Found<const D: usize> {
    /// The pieces of the lists of candidates.
    pub(crate) part: Range<usize>,
    pub(crate) rows: Vec<Row<D>>,
    pub(crate) watched: Vec<ClosePair<D>>,
    pub(crate) heads: Vec<[u32; 4]>,
    pub(crate) inactive: Vec<Row<D>>,
    pub(crate) spread: Spread,
    pub(crate) close: [Vec<([u32; 2], f64)>; 2],
    /// The candidates that may touch in the step according to the bounds on their distances.
    pub(crate) unclear: [Vec<Unclear>; 2],
    /// Candidates of a vertex and a facet that were examined again, with their pairs of bodies, and lower bounds on their distances at the start of
    /// the step [m].
    pub(crate) notes: Vec<(u32, usize, f64)>,
    /// The smallest bound of every piece [m].
    pub(crate) least: Vec<f64>,
    /// The pairs of one vertex, or of two edges, and whether each meets in the free motion. Also which of these pairs are kept.
    pub(crate) around: Vec<(ClosePair<D>, bool)>,
    pub(crate) keep: Vec<bool>,
    pub(crate) keys: Vec<[u32; 3]>,
    /// The impulses of the present pair of bodies in the previous substep, as a range of all of them.
    pub(crate) last: Range<usize>,
}

impl<const D: usize> Found<D> {
    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let lists = |list: usize| {
            size_of::<([u32; 2], f64)>() * self.close[list].capacity()
                + size_of::<Unclear>() * self.unclear[list].capacity()
        };
        size_of::<Row<D>>() * (self.rows.capacity() + self.inactive.capacity())
            + size_of::<ClosePair<D>>() * self.watched.capacity()
            + 16 * self.heads.capacity()
            + self.spread.heap_bytes()
            + lists(0)
            + lists(1)
            + 24 * self.notes.capacity()
            + 8 * self.least.capacity()
    }
}
