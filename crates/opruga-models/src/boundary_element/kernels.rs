//! Kelvin's solution: displacement and traction in an infinite body under a force at one point.
//!
//! With r = y − ξ, ρ = |r|, e = r/ρ, the unit normal n in y and the shear modulus μ = 1,
//!
//! space  U = (1/16π(1 − ν)ρ) [(3 − 4ν) 1 + e eᵀ],
//!        T = (−1/8π(1 − ν)ρ²) {e·n [(1 − 2ν) 1 + 3 e eᵀ] − (1 − 2ν)(e nᵀ − n eᵀ)},
//! plane  U = (1/8π(1 − ν)) [−(3 − 4ν) ln ρ 1 + e eᵀ],
//!        T = (−1/4π(1 − ν)ρ) {e·n [(1 − 2ν) 1 + 2 e eᵀ] − (1 − 2ν)(e nᵀ − n eᵀ)}.
//!
//! Rows correspond to directions of the force. The plane formulas are those of plane strain.
//!
//! Source: Brebbia, Telles, Wrobel 1984, *Boundary element techniques*, equations 5.1.6 to 5.1.9.

use core::f64::consts::PI;
use opruga_math::elementary::natural_logarithm;

/// A block with D rows and columns.
pub(super) type Block<const D: usize> = [[f64; D]; D];

/// Kelvin's solution for one Poisson's ratio.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kelvin {
    pub(super) poisson: f64,
}

impl Kelvin {
    /// The factor of U, and the factors of 1 and of e eᵀ in it. In the plane, the factor of 1 multiplies −ln ρ.
    pub(super) fn displacement_factors<const D: usize>(self) -> [f64; 2] {
        let whole = 1.0 / (if D == 2 { 8.0 } else { 16.0 } * PI * (1.0 - self.poisson));
        [whole * (3.0 - 4.0 * self.poisson), whole]
    }
    /// U for r = y − ξ, which is not zero.
    #[inline(always)]
    pub(super) fn displacement<const D: usize>(self, r: &[f64; D]) -> Block<D> {
        let [unit, along] = self.displacement_factors::<D>();
        let square = r.iter().map(|x| x * x).sum::<f64>();
        let inverse = 1.0 / square;
        let (unit, along) = if D == 2 {
            (-0.5 * unit * natural_logarithm(square), along * inverse)
        } else {
            let over = inverse.sqrt();
            (unit * over, along * over * inverse)
        };
        let mut out = [[0.0; D]; D];
        for i in 0..D {
            for j in 0..D {
                out[i][j] = along * r[i] * r[j];
            }
            out[i][i] += unit;
        }
        out
    }
    /// T for r = y − ξ, which is not zero, and the unit normal at y.
    #[inline(always)]
    pub(super) fn traction<const D: usize>(self, r: &[f64; D], n: &[f64; D]) -> Block<D> {
        let square = r.iter().map(|x| x * x).sum::<f64>();
        let inverse = 1.0 / square;
        // 1/ρᴰ: one power of ρ comes from e.
        let power = if D == 2 { inverse } else { inverse * inverse.sqrt() };
        let factor = -power / (if D == 2 { 4.0 } else { 8.0 } * PI * (1.0 - self.poisson));
        let skew = factor * (1.0 - 2.0 * self.poisson);
        let along = factor * (0..D).map(|d| r[d] * n[d]).sum::<f64>();
        let unit = along * (1.0 - 2.0 * self.poisson);
        let pair = along * D as f64 * inverse;
        let mut out = [[0.0; D]; D];
        for i in 0..D {
            for j in 0..D {
                out[i][j] = pair * r[i] * r[j] - skew * (r[i] * n[j] - n[i] * r[j]);
            }
            out[i][i] += unit;
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_math::Lane;

    /// The traction of U by finite differences: σ = λ tr ε 1 + 2 μ ε.
    fn by_differences<const D: usize>(kelvin: Kelvin, r: [f64; D], n: [f64; D]) -> Block<D> {
        let h = 1e-5;
        let mut slope = [[[0.0; D]; D]; D];
        for d in 0..D {
            let (mut up, mut down) = (r, r);
            up[d] += h;
            down[d] -= h;
            let (up, down) = (kelvin.displacement(&up), kelvin.displacement(&down));
            for i in 0..D {
                for j in 0..D {
                    slope[i][j][d] = (up[i][j] - down[i][j]) / (2.0 * h);
                }
            }
        }
        let lambda = 2.0 * kelvin.poisson / (1.0 - 2.0 * kelvin.poisson);
        let mut out = [[0.0; D]; D];
        for i in 0..D {
            let trace: f64 = (0..D).map(|d| slope[i][d][d]).sum();
            for j in 0..D {
                out[i][j] = lambda * trace * n[j];
                for d in 0..D {
                    out[i][j] += (slope[i][j][d] + slope[i][d][j]) * n[d];
                }
            }
        }
        out
    }

    fn check<const D: usize>(r: [f64; D], n: [f64; D]) {
        for poisson in [0.0, 0.3, 0.45] {
            let kelvin = Kelvin { poisson };
            let (found, expected) = (kelvin.traction(&r, &n), by_differences(kelvin, r, n));
            let error = found
                .iter()
                .flatten()
                .zip(expected.iter().flatten())
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, |most: f64, x| most.larger(x));
            assert!(error < 1e-8, "{error}");
        }
    }

    #[test]
    fn tractions_are_those_of_the_displacements() {
        check([0.7, -0.4], [0.6, 0.8]);
        check([0.3, -0.5, 0.6], [0.48, 0.6, 0.64]);
    }
}
