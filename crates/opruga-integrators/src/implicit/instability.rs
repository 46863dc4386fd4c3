//! Corrections that leave an unstable equilibrium.
//!
//! A straight bar under too much compression is in an unstable equilibrium. A matrix without negative eigenvalues leads to this
//! equilibrium as surely as to any other. Each further correction is then a few per cent larger than the previous one, because
//! the matrix is too stiff in the direction in which the body buckles. After several such corrections, the next one is extended
//! as far as it leads downhill.

use super::line_search::{LONGEST_STRETCH, Stretches};
use opruga_math::Lane;

/// If a correction is above this fraction of the extent, the solution is still far away.
const ROUGH: f64 = 1e-3;

/// The number of consecutive growing corrections that indicates an unstable equilibrium.
const OFTEN: u32 = 4;

/// How far such a correction may be extended, as a fraction of the extent of the body.
const REACH: f64 = 1e-2;

/// Detects an unstable equilibrium by the growth of corrections from one to the next while the matrix has no negative
/// eigenvalues.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instability {
    /// The last correction [m].
    last: f64,
    /// How many times in a row corrections have grown.
    grown: u32,
}

impl Instability {
    /// Starts before the first correction.
    pub(super) fn new() -> Instability {
        Instability { last: f64::INFINITY, grown: 0 }
    }

    /// Records a correction [m]. `stiff` is true if the matrix that gave the correction is too stiff, and if nothing else has
    /// changed the correction.
    pub(super) fn note(&mut self, correction: f64, stiff: bool) {
        self.grown = if stiff && correction > self.last { self.grown + 1 } else { 0 };
        self.last = correction;
    }

    /// How far the last recorded correction may be extended, for a body of this extent [m].
    pub(super) fn stretches(&self, extent: f64) -> Stretches {
        if self.grown >= OFTEN {
            Stretches::UpTo(LONGEST_STRETCH.larger(REACH * extent / self.last))
        } else if self.last > ROUGH * extent {
            Stretches::WhereEnergyFalls
        } else {
            Stretches::No
        }
    }

    /// Records that the correction was extended. The extension disturbs directions that were nearly in equilibrium. The next
    /// corrections first bring these directions back to equilibrium.
    pub(super) fn stretched(&mut self) {
        self.grown = 0;
    }
}
