//! St. Venant–Kirchhoff: Hooke's law of Green's strain.

use super::material::{Material, Parameters, Principal, Tangent, add_strain_tangent, no_tangent};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};

/// ψ = μ E:E + λ/2 tr² E with E = ½(FᵀF − 1); P = F S, S = 2μE + λ tr E 1.
///
/// The law is exact for large rotation, but it softens under compression: below a stretch of 1/√3 a bar collapses and may
/// invert, and the inverted state has the same energy. Use another law for large strain.
#[derive(Clone, Copy, Debug)]
pub struct StVenantKirchhoff;

/// Green's strain and S = 2μE + λ tr E 1.
#[inline(always)]
fn strain_and_stress<S: Lane, const D: usize>(p: &Parameters<S>, f: &Matrix<S, D>) -> (Matrix<S, D>, Matrix<S, D>) {
    let mut strain = matrix::transposed_product(f, f);
    for i in 0..D {
        strain[i][i] -= S::one();
    }
    let strain = matrix::scaled(&strain, S::splat(0.5));
    let stress = matrix::scaled(&strain, p.mu + p.mu);
    (strain, matrix::plus(&stress, p.lambda * matrix::trace(&strain), &matrix::identity()))
}

impl<const D: usize> Material<D> for StVenantKirchhoff {
    const NAME: &'static str = "st_venant_kirchhoff";
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let (strain, stress) = strain_and_stress(p, f);
        (S::splat(0.5) * matrix::inner(&strain, &stress), matrix::product(f, &stress))
    }
    #[inline(always)]
    fn tangent<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> Tangent<S, D> {
        let (_, stress) = strain_and_stress(p, f);
        let mut out = no_tangent();
        add_strain_tangent(&mut out, p.mu, p.lambda, f);
        for i in 0..D {
            for j in 0..D {
                for l in 0..D {
                    out[i][j][i][l] += stress[j][l];
                }
            }
        }
        out
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, _f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let mut squares = S::zero();
        for i in 0..D {
            squares += sigma[i] * sigma[i] - S::one();
        }
        // ψᵢ = μ σᵢ(σᵢ² − 1) + λ/2 (I − D) σᵢ.
        let common = S::splat(0.5) * p.lambda * squares - p.mu;
        let mut principal = Principal::zeros();
        for i in 0..D {
            for j in 0..D {
                let (a, b) = (sigma[i], sigma[j]);
                principal.second[i][j] = p.lambda * a * b;
                if i == j {
                    principal.second[i][i] += common + S::splat(3.0) * p.mu * a * a;
                }
                let ends = a * a + b * b;
                principal.difference[i][j] = common + p.mu * (ends + a * b);
                principal.sum[i][j] = common + p.mu * (ends - a * b);
            }
        }
        principal
    }
}
