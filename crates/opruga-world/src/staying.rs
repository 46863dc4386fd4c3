//! The term that keeps bodies at rest near their present positions during a correction towards their common equilibrium.
//!
//! ```text
//! (K + σM) d = F,   σ = part · ω²    ω the highest frequency of the body
//! ```
//!
//! Far from equilibrium σ M keeps corrections short. Near it σ falls, and the equilibrium depends on forces alone (pseudo-transient continuation).
//!
//! Source: C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation (1998).

use crate::island::Island;
use opruga_core::stability::estimate;
use opruga_math::Lane;
use opruga_solve::dot;

/// The initial σ, relative to the square of the highest frequency of a body. The slowest vibrations of a body of ten cells have about this ratio.
const FIRST: f64 = 1e-2;

/// The factor by which σ falls, and the smallest σ: below it, the rigid motion of a body hides its bending from the solution of contact.
const SOFTER: f64 = 0.1;
const LEAST: f64 = 1e-6;

/// The factor by which σ grows if corrections lead too far. Without this factor, contacts could alternate for ever
/// (`high_stacks_come_to_their_balance` without friction).
const FIRMER: f64 = 4.0;

/// The final residual, relative to the forces on a body.
pub(crate) const BALANCED: f64 = 1e-8;

/// σ of all bodies that come to rest together.
pub(crate) struct Staying {
    /// σ divided by the square of the highest frequency.
    pub(crate) part: f64,
    /// The squares of the highest frequencies [1/s²].
    squares: Vec<f64>,
}

impl Staying {
    /// The initial values for a search. A body without a frequency of its own gets the highest one of the others.
    pub(crate) fn new<'a, const D: usize>(bodies: impl Iterator<Item = &'a Island<D>>) -> Self {
        let square = |island: &Island<D>| {
            let omega = estimate(&island.system, &*island.integrator).map_or(0.0, |found| found.spectrum.omega);
            if omega.is_finite() { omega * omega } else { 0.0 }
        };
        let mut squares: Vec<f64> = bodies.map(square).collect();
        let most = squares.iter().fold(0.0, |most: f64, square| square.larger(most));
        squares.iter_mut().filter(|square| **square == 0.0).for_each(|square| *square = most);
        Staying { part: FIRST, squares }
    }

    /// σ of a body [1/s²].
    pub(crate) fn sigma(&self, body: usize) -> f64 {
        self.part * self.squares[body]
    }

    /// Increases σ.
    pub(crate) fn firm_up(&mut self) {
        self.part *= FIRMER;
    }

    /// Decreases σ.
    pub(crate) fn loosen(&mut self) {
        self.part = (self.part * SOFTER).larger(LEAST);
    }
}

pub(crate) fn norm(of: &[f64]) -> f64 {
    dot(of, of).sqrt()
}
