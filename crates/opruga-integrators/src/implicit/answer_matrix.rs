//! The matrix that determines how the end of a step responds to forces of other bodies.

use super::balance::Balance;
use super::linear::Linear;
use super::reused_matrix::Origin;
use opruga_solve::blocks::Block;

/// The matrix of the last step, kept for further right-hand sides.
#[derive(Debug, Default)]
pub(crate) struct AnswerMatrix<const D: usize> {
    /// The balance of the last step and the time at its start [s], or `None` if the step was made in parts.
    pub(crate) last: Option<(Balance, f64)>,
    pub(crate) linear: Linear<D>,
    /// The directions that are free in the matrix, and the position of its stage as a fraction of the step.
    pub(crate) free: Vec<bool>,
    pub(crate) projectors: Vec<Block<D>>,
    pub(crate) theta: f64,
    /// The unique number of the matrix, and its origin if later steps share it.
    pub(crate) number: u64,
    pub(crate) origin: Option<Origin<D>>,
    /// Whether the matrix is solved with factors that allow eigenvalues of any sign.
    pub(crate) by_factors: bool,
}
