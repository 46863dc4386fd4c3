//! Linear elasticity: small strain, small rotation.

use super::material::{Material, Parameters, Principal, Tangent, add_identity, no_tangent};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};

/// Hooke's law of the small strain ε = ½(F + Fᵀ) − 1: ψ = μ ε:ε + λ/2 tr² ε, P = 2με + λ tr ε 1.
///
/// A rotation counts as strain, so a rotated body grows. The law is meant for small motion and for comparison.
#[derive(Clone, Copy, Debug)]
pub struct Linear;

impl<const D: usize> Material<D> for Linear {
    const NAME: &'static str = "linear";
    const TURNS: bool = false;
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let half = S::splat(0.5);
        let mut strain = matrix::zeros::<S, D>();
        for i in 0..D {
            for j in 0..D {
                strain[i][j] = half * (f[i][j] + f[j][i]);
            }
            strain[i][i] -= S::one();
        }
        let trace = matrix::trace(&strain);
        let energy = p.mu * matrix::inner(&strain, &strain) + half * p.lambda * trace * trace;
        let stress = matrix::scaled(&strain, p.mu + p.mu);
        (energy, matrix::plus(&stress, p.lambda * trace, &matrix::identity()))
    }
    #[inline(always)]
    fn tangent<S: Lane>(p: &Parameters<S>, _f: &Matrix<S, D>) -> Tangent<S, D> {
        let mut out = no_tangent();
        add_identity(&mut out, p.mu);
        for i in 0..D {
            for j in 0..D {
                out[i][j][j][i] += p.mu;
                out[i][i][j][j] += p.lambda;
            }
        }
        out
    }
    /// The second derivatives are the same for every F and in every frame.
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, _f: &Matrix<S, D>, _sigma: &[S; D]) -> Principal<S, D> {
        let mut principal = Principal::zeros();
        for i in 0..D {
            for j in 0..D {
                principal.second[i][j] = p.lambda;
                principal.difference[i][j] = p.mu + p.mu;
            }
            principal.second[i][i] += p.mu + p.mu;
        }
        principal
    }
}
