//! The compressible Mooney–Rivlin solid of Ciarlet and Geymonat.

use super::material::{
    Material, Parameters, Principal, Tangent, add_cofactor_derivative, add_identity, add_square, logarithm_of_volume,
    no_tangent,
};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};

/// ψ = C₁ (I₁ − 3) + C₂ (I₂ − 3) + a (J² − 1) − b ln J with C₁ + C₂ = μ/2, a = λ/4 − C₂, b = 2(C₁ + C₂) + λ/2; I₁ = tr C,
/// I₂ = ½(I₁² − tr C²), C = FᵀF (in plane strain with the stretch 1 along z), J = det F.
///
/// The law is meant for rubber at larger stretch. `own` is the share C₂/(C₁ + C₂). The law is polyconvex for a ≥ 0, that is, for
/// a share up to ν/(1 − 2ν). Below J = 0.01 the logarithm is continued as a parabola.
///
/// # Source
/// Ciarlet, Geymonat, "Sur les lois de comportement en élasticité non linéaire compressible" (1982); Ciarlet, *Mathematical
/// elasticity I*, theorem 4.10-2.
#[derive(Clone, Copy, Debug)]
pub struct MooneyRivlin;

/// C₁, C₂, a, b. In the plane C₂ I₂ = C₂ (I + J² + …) is distributed to C₁ and a.
#[inline(always)]
fn constants<S: Lane, const D: usize>(p: &Parameters<S>) -> [S; 4] {
    let half = S::splat(0.5);
    let second = half * p.mu * p.own;
    let first = half * p.mu - second;
    let a = S::splat(0.25) * p.lambda - second;
    let b = p.mu + half * p.lambda;
    if D == 2 { [first + second, S::zero(), a + second, b] } else { [first, second, a, b] }
}

/// The first and second derivatives of a J² − b ln J.
#[inline(always)]
fn volumetric<S: Lane>(a: S, b: S, j: S) -> (S, S) {
    let [_, first, second] = logarithm_of_volume(j);
    (S::splat(2.0) * a * j - b * first, S::splat(2.0) * a - b * second)
}

impl<const D: usize> Material<D> for MooneyRivlin {
    const NAME: &'static str = "mooney_rivlin";
    const CANCELS: bool = true;
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let [c1, c2, a, b] = constants::<S, D>(p);
        let two = S::splat(2.0);
        let cofactors = matrix::cofactor(f);
        let j = matrix::determinant_by(f, &cofactors);
        let [log, first, _] = logarithm_of_volume(j);
        let right = matrix::transposed_product(f, f);
        let i1 = matrix::trace(&right);
        let rest = S::splat(D as f64);
        let mut energy = c1 * (i1 - rest) + a * (j * j - S::one()) - b * log;
        let mut stress = matrix::scaled(f, two * c1);
        if D == 3 {
            let i2 = S::splat(0.5) * (i1 * i1 - matrix::inner(&right, &right));
            energy += c2 * (i2 - rest);
            stress = matrix::plus(&stress, two * c2 * i1, f);
            stress = matrix::plus(&stress, -(two * c2), &matrix::product(f, &right));
        }
        (energy, matrix::plus(&stress, two * a * j - b * first, &cofactors))
    }
    #[inline(always)]
    fn tangent<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> Tangent<S, D> {
        let [c1, c2, a, b] = constants::<S, D>(p);
        let two = S::splat(2.0);
        let cofactors = matrix::cofactor(f);
        let (first, second) = volumetric(a, b, matrix::determinant_by(f, &cofactors));
        let mut out = no_tangent();
        add_identity(&mut out, two * c1);
        if D == 3 {
            let (right, left) = (matrix::transposed_product(f, f), matrix::product_transposed(f, f));
            let factor = two * c2;
            add_identity(&mut out, factor * matrix::trace(&right));
            add_square(&mut out, two * factor, f);
            for i in 0..D {
                for j in 0..D {
                    for k in 0..D {
                        out[i][j][i][k] += -(factor * right[k][j]);
                        out[i][j][k][j] += -(factor * left[i][k]);
                        for l in 0..D {
                            out[i][j][k][l] += -(factor * f[i][l] * f[k][j]);
                        }
                    }
                }
            }
        }
        add_square(&mut out, second, &cofactors);
        add_cofactor_derivative(&mut out, first, f);
        out
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let [c1, c2, a, b] = constants::<S, D>(p);
        let two = S::splat(2.0);
        let mut principal = Principal::zeros();
        principal.add_stretch(sigma, c1, S::zero());
        if D == 3 {
            let i1 = matrix::inner(f, f);
            for i in 0..D {
                for j in 0..D {
                    let (x, y) = (sigma[i], sigma[j]);
                    let ends = x * x + y * y;
                    principal.second[i][j] += if i == j { two * c2 * (i1 - x * x) } else { S::splat(4.0) * c2 * x * y };
                    principal.difference[i][j] += two * c2 * (i1 - ends - x * y);
                    principal.sum[i][j] += two * c2 * (i1 - ends + x * y);
                }
            }
        }
        let (first, second) = volumetric(a, b, matrix::determinant(f));
        principal.add_volumetric(sigma, first, second);
        principal
    }
}
