//! The method of conjugate gradients.

use crate::{Indefinite, Preconditioner, dot};

/// Memory for the vectors of the method.
#[derive(Clone, Debug, Default)]
pub struct Directions {
    residual: Vec<f64>,
    improved: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// The number of products with the matrix.
    pub iterations: u32,
    /// |b − A x| relative to |b|, in the norm of the preconditioner.
    pub residual: f64,
}

/// Solves A x = b for a symmetric positive definite A, starting from x = 0. Only the product with A is needed.
///
/// The method ends when the norm of the residual is `tolerance` times the norm of b, both in the norm of the preconditioner. It also ends after
/// `most` products, or when rounding prevents further progress. Sums have a fixed order, so the bits are the same everywhere.
///
/// # Errors
/// [`Indefinite`] if a direction has zero or negative curvature; x is then the solution so far.
///
/// # Source
/// Hestenes and Stiefel 1952; Shewchuk, *An introduction to the conjugate gradient method without the agonizing pain*,
/// 1994, B3.
pub fn conjugate_gradients(
    multiply: impl Fn(&[f64], &mut [f64]),
    preconditioner: &dyn Preconditioner,
    b: &[f64],
    x: &mut [f64],
    tolerance: f64,
    most: u32,
    workspace: &mut Directions,
) -> Result<Ended, Indefinite> {
    let Directions { residual, improved, direction, product } = workspace;
    for vector in [&mut *residual, improved, direction, product] {
        vector.resize(b.len(), 0.0);
    }
    x.fill(0.0);
    residual.copy_from_slice(b);
    preconditioner.apply(residual, improved);
    direction.copy_from_slice(improved);
    let mut rho = dot(residual, improved);
    let first = rho;
    if !rho.is_finite() || rho < 0.0 {
        return Err(Indefinite);
    }
    let goal = tolerance * tolerance * first;
    let mut iterations = 0;
    while rho > goal && iterations < most {
        multiply(direction, product);
        iterations += 1;
        let curvature = dot(direction, product);
        if !(curvature > 0.0 && curvature.is_finite()) {
            return Err(Indefinite);
        }
        let step = rho / curvature;
        for k in 0..x.len() {
            x[k] += step * direction[k];
            residual[k] -= step * product[k];
        }
        preconditioner.apply(residual, improved);
        let next = dot(residual, improved);
        if !next.is_finite() || next < 0.0 {
            return Err(Indefinite);
        }
        let turn = next / rho;
        rho = next;
        for k in 0..x.len() {
            direction[k] = improved[k] + turn * direction[k];
        }
    }
    let residual = if first > 0.0 { (rho / first).sqrt() } else { 0.0 };
    Ok(Ended { iterations, residual })
}
