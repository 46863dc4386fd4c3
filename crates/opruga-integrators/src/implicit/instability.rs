//! Corrections that fall off a balance that does not hold.
//!
//! A straight bar that is pressed too much is in balance, and a matrix without negative eigenvalues leads there as surely as to any
//! other. From there on corrections grow, by a few parts in a hundred each: the matrix is too stiff just where the body gives way.
//! Once they have grown for a while, such a correction is gone on with as far as it leads downhill.

use super::line_search::{LONGEST_STRETCH, Stretches};
use opruga_math::Lane;

/// Corrections above this part of the extent are far from the solution.
const ROUGH: f64 = 1e-3;

/// How often in a row corrections have grown that fall off a balance.
const OFTEN: u32 = 4;

/// How far such a correction may be gone on with, in extents of the body.
const REACH: f64 = 1e-2;

/// How the corrections of a matrix without negative eigenvalues change from one to the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instability {
    /// The last correction [m].
    last: f64,
    /// How often in a row they have grown.
    grown: u32,
}

impl Instability {
    /// Before the first correction.
    pub(super) fn new() -> Instability {
        Instability { last: f64::INFINITY, grown: 0 }
    }

    /// Notes a correction [m], and whether it is one of those that may fall off: of a matrix that is too stiff, and of that alone.
    pub(super) fn note(&mut self, correction: f64, stiff: bool) {
        self.grown = if stiff && correction > self.last { self.grown + 1 } else { 0 };
        self.last = correction;
    }

    /// How far the correction noted last may be gone on with, of a body of this extent [m].
    pub(super) fn stretches(&self, extent: f64) -> Stretches {
        if self.grown >= OFTEN {
            Stretches::UpTo(LONGEST_STRETCH.larger(REACH * extent / self.last))
        } else if self.last > ROUGH * extent {
            Stretches::WhereEnergyFalls
        } else {
            Stretches::No
        }
    }

    /// Notes that it was gone on with. That leads astray what was nearly in balance before, which is put right first.
    pub(super) fn stretched(&mut self) {
        self.grown = 0;
    }
}
