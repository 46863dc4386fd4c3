//! Sparse linear systems and eigenvalues of Opruga, for implicit integrators, equilibria and natural frequencies.
//!
//! A [`BlockMatrix`] collects the second derivatives that models deliver. The matrix can be solved by [`conjugate_gradients`], which gives the same
//! bits on every processor because its sums have a fixed order ([`Packed`] does the same with vector instructions and threads). [`Cholesky`] and
//! [`Factors`] (from the library faer) can also solve it; they choose their instructions by the class of the processor. [`eigen`] finds the lowest
//! natural frequencies.

mod beside;
pub mod blocks;
mod cholesky;
mod conjugate_gradients;
pub mod dense;
pub mod dense_system;
pub mod eigen;
mod filled;
mod following;
mod landing;
mod lu;
mod matrix;
mod one_model;
pub mod packed;
mod preconditioner;
mod rank_one;
mod scalars;
mod turned_factor;
mod woodbury;

pub use cholesky::Cholesky;
pub use conjugate_gradients::{Directions, Ended, conjugate_gradients};
pub use filled::FilledCholesky;
pub use lu::Factors;
pub use matrix::BlockMatrix;
pub use packed::Packed;
pub use preconditioner::{BlockJacobi, IncompleteCholesky, Preconditioner};

use opruga_math::{WIDTH, sum_in_fixed_order};

/// The matrix is not positive definite, or singular, so the requested result does not exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indefinite;

/// The scalar product, in eight partial sums, with the same bits everywhere.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; WIDTH];
    let (packs, rest) = a.as_chunks::<WIDTH>();
    let (others, other_rest) = b.as_chunks::<WIDTH>();
    for (a, b) in packs.iter().zip(others) {
        for l in 0..WIDTH {
            sums[l] += a[l] * b[l];
        }
    }
    for (l, (a, b)) in rest.iter().zip(other_rest).enumerate() {
        sums[l] += a * b;
    }
    sum_in_fixed_order(&sums)
}
