//! How firmly bodies at rest stay where they are within a correction towards their common balance.
//!
//! ```text
//! (K + σM) d = F,   σ = part · ω²    ω the highest frequency of the body
//! ```
//!
//! Far from the balance σ M keeps corrections short; near it σ falls, and the balance is one of forces alone (pseudo-transient continuation).
//!
//! Source: C. T. Kelley, D. E. Keyes, Convergence analysis of pseudo-transient continuation (1998).

use crate::island::Island;
use opruga_core::stability::estimate;
use opruga_math::Lane;
use opruga_solve::dot;

/// σ at first, relative to the square of the highest frequency of a body: the slowest vibrations of a body of ten cells are as slow.
const FIRST: f64 = 1e-2;

/// By how much σ falls, and down to where: with less, the motion of a body as a whole hides its bending from the solution of contact.
const SOFTER: f64 = 0.1;
const LEAST: f64 = 1e-6;

/// By how much σ grows where corrections lead too far: contacts that come and go in turn would do so for ever (`high_stacks_come_to_their_balance` without
/// friction).
const FIRMER: f64 = 4.0;

/// What is out of balance in the end, relative to the forces on a body.
pub(crate) const BALANCED: f64 = 1e-8;

/// σ of all bodies that come to rest together.
pub(crate) struct Staying {
    /// σ over the square of the highest frequency.
    pub(crate) part: f64,
    /// The squares of the highest frequencies [1/s²].
    squares: Vec<f64>,
}

impl Staying {
    /// That of a search which begins. A body without a frequency of its own has the highest one of the others.
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

    /// Lets σ grow.
    pub(crate) fn firm_up(&mut self) {
        self.part *= FIRMER;
    }

    /// Lets σ fall.
    pub(crate) fn loosen(&mut self) {
        self.part = (self.part * SOFTER).larger(LEAST);
    }
}

pub(crate) fn norm(of: &[f64]) -> f64 {
    dot(of, of).sqrt()
}
