//! The matrix that the real-time setting keeps from step to step.
//!
//! The matrix is computed in one shape of the body, the *reference*. It is reused until iterations with it no longer find the
//! end of a step. The reference is part of the state, so a resumed run makes the same matrix from it.

use super::linear::{Filter, Linear, Mixture};
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_solve::blocks::Block;
use opruga_solve::{Cholesky, Indefinite, Packed};

/// The data from which a matrix was made.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Origin<const D: usize> {
    sigma: f64,
    beta: f64,
    reference: Columns<D>,
}

/// The present matrix, and its solvers.
#[derive(Debug)]
pub(crate) struct ReusedMatrix<const D: usize> {
    /// The data from which the matrix was made, or `None` if there is no matrix.
    pub(crate) origin: Option<Origin<D>>,
    /// Whether the matrix is prepared for solving, and the free directions for which it was prepared.
    ready: bool,
    free: Vec<bool>,
    projectors: Vec<Block<D>>,
    packed: Packed<D>,
    cholesky: Cholesky,
    /// Whether the matrix was computed at the positions of this iteration and has not been used yet. In this case, the pass
    /// that makes a dense factor also solves for the right-hand side. A matrix that is made again because a run is resumed
    /// counts as used, so that its solutions have the same bits as in the original run.
    is_new: bool,
    /// The solution for the present right-hand side, and whether it is known.
    solution: Vec<f64>,
    is_solved: bool,
}

impl<const D: usize> Default for ReusedMatrix<D> {
    fn default() -> Self {
        ReusedMatrix {
            origin: None,
            ready: false,
            free: Vec::new(),
            projectors: Vec::new(),
            packed: Packed::default(),
            cholesky: Cholesky::default(),
            is_new: false,
            solution: Vec::new(),
            is_solved: false,
        }
    }
}

impl<const D: usize> ReusedMatrix<D> {
    /// Whether the matrix was made in this shape and with these factors.
    pub(crate) fn is_of(&self, reference: &Columns<D>, mixture: &Mixture<D>) -> bool {
        let nodes = mixture.mass.len();
        self.origin.as_ref().is_some_and(|own| {
            (own.sigma, own.beta) == (mixture.sigma, mixture.beta)
                && own.reference.0.iter().zip(&reference.0).all(|(a, b)| a.get(..nodes) == b.get(..nodes))
        })
    }

    /// Makes the matrix for `reference`, the shape that was evaluated last. `is_new` is true if the iteration is at the shape
    /// `reference`.
    pub(crate) fn make(&mut self, linear: &mut Linear<D>, mixture: &Mixture<D>, reference: &Columns<D>, is_new: bool) {
        linear.assemble(mixture);
        self.packed.take(linear.full(), mixture.system.threads);
        (self.ready, self.is_new) = (false, is_new);
        let none = || Origin { sigma: 0.0, beta: 0.0, reference: Columns::zeros(0) };
        let origin = self.origin.get_or_insert_with(none);
        (origin.sigma, origin.beta) = (mixture.sigma, mixture.beta);
        for (own, column) in origin.reference.0.iter_mut().zip(&reference.0) {
            own.grow(column.len());
            own[..column.len()].copy_from_slice(column);
        }
    }

    /// Prepares the matrix for solving in the free directions. The first right-hand side will be `right`.
    pub(crate) fn hold(
        &mut self,
        threads: usize,
        linear: &mut Linear<D>,
        filter: &Filter<D>,
        direct: bool,
        right: &[f64],
    ) -> Result<(), Indefinite> {
        self.is_solved = false;
        let same = self.ready && self.free == filter.free;
        let unchanged = |node: usize| filter.free[node] || self.projectors[node] == filter.projectors[node];
        if same && (0..filter.free.len()).all(unchanged) {
            return Ok(());
        }
        self.ready = false;
        self.packed.hold(threads, linear.full(), filter.free, filter.projectors)?;
        if direct {
            linear.constrain(filter);
            if core::mem::take(&mut self.is_new) {
                refill(&mut self.solution, right);
                self.cholesky.update_and_solve(linear.constrained(), &mut self.solution)?;
                self.is_solved = true;
            } else {
                self.cholesky.update(linear.constrained())?;
            }
        }
        refill(&mut self.free, filter.free);
        refill(&mut self.projectors, filter.projectors);
        self.ready = true;
        Ok(())
    }

    /// The sum over the nodes of the mean diagonal of their blocks [N/m].
    pub(crate) fn stiffness(&self) -> f64 {
        self.packed.stiffness()
    }
    /// Records that there is no right-hand side to solve for.
    pub(crate) fn forget_right_hand_side(&mut self) {
        self.ready = false;
    }

    /// Begins with a new right-hand side, and returns its size in the norm of the inverse diagonal blocks.
    pub(crate) fn begin(&mut self, system: &System<D>, right: &[f64]) -> f64 {
        self.packed.begin(system.simd, system.threads, right)
    }

    /// Solves for the present right-hand side. Returns the number of products and whether the matrix was indefinite.
    pub(crate) fn solve(
        &mut self,
        system: &System<D>,
        right: &[f64],
        direct: bool,
        goal: f64,
        most: u32,
        out: &mut [f64],
    ) -> Result<(u32, bool), Indefinite> {
        if !self.ready {
            return Err(Indefinite);
        }
        let outcome = if direct {
            if core::mem::take(&mut self.is_solved) {
                out.copy_from_slice(&self.solution);
            } else {
                out.copy_from_slice(right);
                self.cholesky.solve(out);
            }
            (1, false)
        } else {
            let reached = self.packed.solve(system.simd, system.threads, goal, most, out)?;
            (reached.iterations, reached.indefinite)
        };
        if out.iter().all(|x| x.is_finite()) { Ok(outcome) } else { Err(Indefinite) }
    }
}

/// Copies a slice into a vector, reusing its memory.
fn refill<T: Copy>(own: &mut Vec<T>, from: &[T]) {
    own.clear();
    own.extend_from_slice(from);
}
