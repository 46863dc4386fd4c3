//! Boxes of two lists that overlap, compared eight at a time in vector instructions.

use crate::vector::Bounds;
use opruga_math::{Pack, WIDTH, Work, lanes};

/// Boxes by coordinates: the lowest ones along every axis, then the highest ones, padded to whole packs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Columns {
    coordinates: Vec<f64>,
    /// The number of boxes with their padding.
    padded: usize,
}

impl Columns {
    /// Replaces the present boxes by new ones.
    pub(crate) fn fill<const D: usize>(&mut self, boxes: &[(u32, Bounds<D>)]) {
        self.padded = boxes.len().next_multiple_of(WIDTH);
        // Nothing overlaps a box from infinity to minus infinity.
        self.coordinates.clear();
        self.coordinates.resize(D * self.padded, f64::INFINITY);
        self.coordinates.resize(2 * D * self.padded, f64::NEG_INFINITY);
        for (k, (_, [low, high])) in boxes.iter().enumerate() {
            for d in 0..D {
                self.coordinates[d * self.padded + k] = low[d];
                self.coordinates[(D + d) * self.padded + k] = high[d];
            }
        }
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.coordinates.capacity()
    }
}

/// Calls `visit` with all pairs of a feature of the first list and a feature of the second list whose boxes overlap; `columns`
/// holds the boxes of the second list.
pub(crate) struct Overlaps<'a, F, const D: usize> {
    pub(crate) first: &'a [(u32, Bounds<D>)],
    pub(crate) second: &'a [(u32, Bounds<D>)],
    pub(crate) columns: &'a Columns,
    pub(crate) visit: F,
}

impl<F: FnMut(u32, u32), const D: usize> Work for Overlaps<'_, F, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        let Columns { coordinates, padded } = self.columns;
        for (a, [low, high]) in self.first {
            let (low, high): ([P; D], [P; D]) = (lanes!(P, d => P::splat(low[d])), lanes!(P, d => P::splat(high[d])));
            for k in (0..*padded).step_by(WIDTH) {
                let load = |d: usize| P::load(&coordinates[d * padded + k..]);
                let mut meets = P::both(load(0).less_or_equal(high[0]), low[0].less_or_equal(load(D)));
                for d in 1..D {
                    meets = P::both(meets, load(d).less_or_equal(high[d]));
                    meets = P::both(meets, low[d].less_or_equal(load(D + d)));
                }
                if P::any(meets) {
                    let found = P::select(meets, P::one(), P::zero()).to_array();
                    for (l, _) in found.iter().enumerate().filter(|(_, found)| **found > 0.0) {
                        (self.visit)(*a, self.second[k + l].0);
                    }
                }
            }
        }
    }
}
