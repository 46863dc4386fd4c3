//! The candidates that may touch in a step according to the bounds on their distances.

use crate::body_pairs::{BodyPairs, Piece};
use crate::lists;
use opruga_math::{Pack, Work};

/// A candidate that may touch in a step according to the bound on its distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Unclear {
    /// The index of the candidate in its list, and that of its pair of bodies.
    pub(crate) candidate: u32,
    pub(crate) pair: u32,
    /// The distance at the start of the step, or a lower bound on it [m].
    pub(crate) distance: f64,
}

impl Unclear {
    /// The features of the candidate, given those of its list.
    pub(crate) fn features(&self, list: &[[u32; 2]]) -> [u32; 2] {
        list[self.candidate as usize]
    }
}

/// Lists the candidates that may come closer than a distance beyond any contact, according to the bounds on their distances.
pub(crate) struct FindUnclear<'a, const D: usize> {
    pub(crate) known: &'a BodyPairs<D>,
    pub(crate) pieces: &'a [Piece],
    /// Whether the candidates of a vertex and a facet are examined, and those of two edges.
    pub(crate) lists: [bool; 2],
    /// The distance [m].
    pub(crate) beyond: f64,
    /// The candidates found, of both kinds.
    pub(crate) unclear: &'a mut [Vec<Unclear>; 2],
    /// The smallest bound of every piece [m].
    pub(crate) least: &'a mut Vec<f64>,
}

impl<const D: usize> Work for FindUnclear<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for (pair, list, range) in self.pieces {
            let own = &mut self.unclear[*list];
            if !self.lists[*list] {
                self.least.push(f64::NEG_INFINITY);
                continue;
            }
            let part = (*pair as usize, *list, range.clone());
            self.least.push(self.known.visit_unclear::<P>(part, self.beyond, |candidate| {
                lists::push(own, Unclear { candidate: candidate as u32, pair: *pair, distance: 0.0 });
            }));
        }
    }
}
