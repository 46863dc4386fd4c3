//! Corotated linear elasticity: Hooke's law relative to the nearest rotation.

use super::material::{Material, Parameters, Principal};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};
use opruga_math::rotation::nearest_rotation;

/// ψ = μ |F − R|² + λ/2 tr²(RᵀF − 1) with the rotation R nearest to F; P = 2μ(F − R) + λ tr(RᵀF − 1) R.
///
/// R is proper (det R = 1), so an inverted point is pushed back. The law resists changes of volume only through the linear
/// strain: a finite force can compress a bar to zero length.
///
/// # Source
/// Müller, Gross, "Interactive virtual materials" (2004); R is differentiated exactly, as in McAdams et al. (2011).
#[derive(Clone, Copy, Debug)]
pub struct Corotated;

/// The smallest σᵢ + σⱼ that is used as a divisor. If this sum is zero, the rotation is undefined.
const LEAST_SUM: f64 = 1e-9;

/// The second derivatives of μ Σ(σᵢ − 1)² in principal stretches.
#[inline(always)]
pub(super) fn distance_from_rotation<S: Lane, const D: usize>(mu: S, sigma: &[S; D]) -> Principal<S, D> {
    let mut out = Principal::zeros();
    let two = mu + mu;
    for i in 0..D {
        out.second[i][i] = two;
        for j in i + 1..D {
            let sum = (sigma[i] + sigma[j]).larger(S::splat(LEAST_SUM));
            out.difference[i][j] = two;
            out.sum[i][j] = two - (two + two) / sum;
        }
    }
    out
}

impl<const D: usize> Material<D> for Corotated {
    const NAME: &'static str = "corotated";
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let r = nearest_rotation(f);
        let difference = matrix::plus(f, -S::one(), &r);
        let trace = matrix::inner(&r, &difference);
        let energy = p.mu * matrix::inner(&difference, &difference) + S::splat(0.5) * p.lambda * trace * trace;
        (energy, matrix::plus(&matrix::scaled(&difference, p.mu + p.mu), p.lambda * trace, &r))
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, _f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let mut principal = distance_from_rotation(p.mu, sigma);
        let mut strain = S::zero();
        for i in 0..D {
            strain += sigma[i] - S::one();
        }
        for i in 0..D {
            for j in 0..D {
                principal.second[i][j] += p.lambda;
                if i < j {
                    let sum = (sigma[i] + sigma[j]).larger(S::splat(LEAST_SUM));
                    principal.sum[i][j] += S::splat(2.0) * p.lambda * strain / sum;
                }
            }
        }
        principal
    }
}
