//! The rotation nearest to a matrix.
//!
//! In space, no singular values are needed. Let f = σ₁ + σ₂ + σ₃ be the sum of the singular values of F (the last with the sign
//! of det F), and let C = FᵀF, I = tr C and J = det F. Then f is the largest root of
//!
//! f⁴ − 2 I f² − 8 J f + 2 tr C² − I² = 0.
//!
//! Since R is the derivative of f with respect to F, R = ((f² + I) F − 2 F C + 2 f cof F)/(f³ − I f − 2 J). The denominator is
//! 2 (σ₁ + σ₂)(σ₂ + σ₃)(σ₃ + σ₁). The denominator is small if the rotation is badly determined. Singular vectors are used in this
//! case.
//!
//! Source: Davenport 1968 for the quartic (of the quaternion of R); Lin, Chitalu, Komura, "Isotropic ARAP energy using
//! Cauchy–Green invariants" (2022) for its derivative.

use crate::lane::Lane;
use crate::matrix::{self, Matrix};
use crate::singular::{direction, singular};

/// The smallest denominator, in units of f³, for which the formula is used. At rest the denominator is 16/27, and for a
/// degenerate matrix with two equal stretches it is ½. Rounding errors grow as the inverse of this denominator.
const WELL_DETERMINED: f64 = 0.02;

/// The formula has converged if the relative change of f is below this number, because the next change would be the square of
/// this one.
const FOUND: f64 = 1e-9;

/// The largest number of iterations. If the rotation is well determined, ten iterations are enough. For strains of a few per
/// cent, three iterations are enough.
const MOST_ITERATIONS: usize = 12;

/// The rotation nearest to a matrix F: the R in F = R S for which det R = 1, S is symmetric and tr S is as large as possible.
///
/// F may be degenerate or inverted. If R is not unique (the two smallest stretches of S add up to zero), the result is the
/// rotation of the singular vectors in space, and the unit matrix in the plane.
#[inline(always)]
pub fn nearest_rotation<S: Lane, const D: usize>(f: &Matrix<S, D>) -> Matrix<S, D> {
    const { assert!(D == 2 || D == 3) }
    if D == 2 { in_the_plane(f) } else { in_space(f) }
}

/// In the plane, the vector (F₀₀ + F₁₁, F₁₀ − F₀₁) has the direction of the first column of R.
#[inline(always)]
fn in_the_plane<S: Lane, const D: usize>(f: &Matrix<S, D>) -> Matrix<S, D> {
    let mut along = [S::zero(); D];
    along[0] = f[0][0] + f[1][1];
    along[1] = f[1][0] - f[0][1];
    let mut axis = [S::zero(); D];
    axis[0] = S::one();
    let (a, _) = direction(&along, &axis);
    let mut out = matrix::zeros();
    out[0][0] = a[0];
    out[0][1] = -a[1];
    out[1][0] = a[1];
    out[1][1] = a[0];
    out
}

#[inline(always)]
fn in_space<S: Lane, const D: usize>(f: &Matrix<S, D>) -> Matrix<S, D> {
    let right = matrix::transposed_product(f, f);
    let cofactors = matrix::cofactor(f);
    let two = S::splat(2.0);
    let first = matrix::trace(&right);
    let twice_volume = two * matrix::determinant_by(f, &cofactors);
    let last = two * matrix::inner(&right, &right) - first * first;

    // The largest root by Newton's method from above, f ≤ √(3 I): f decreases monotonically. A converged number does not change
    // in any bit, so it does not depend on its neighbours in the lanes.
    let mut sum = (S::splat(3.0) * first).sqrt();
    let mut change = sum;
    let mut open = S::zero().less(S::one());
    for _ in 0..MOST_ITERATIONS {
        let square = sum * sum;
        let slope = (square - first) * sum - twice_volume;
        let value = ((square - two * first) * sum - S::splat(4.0) * twice_volume) * sum + last;
        change = S::select(open, S::splat(0.25) * value / slope, change);
        sum = S::select(open, sum - change, sum);
        open = S::both(open, (S::splat(FOUND) * sum).less(change.abs()));
        if !S::any(open) {
            break;
        }
    }
    let square = sum * sum;
    let denominator = (square - first) * sum - twice_volume;
    let found = change.abs().less_or_equal(S::splat(FOUND) * sum);
    let sound = S::both(found, (S::splat(WELL_DETERMINED) * (square * sum)).less(denominator));

    let mut inner = matrix::scaled(&right, -two);
    for i in 0..D {
        inner[i][i] += square + first;
    }
    let inverse = S::one() / denominator;
    let rough = matrix::scaled(&matrix::plus(&matrix::product(f, &inner), two * sum, &cofactors), inverse);
    // The result with rounding errors has the singular vectors of F and singular values near 1; R (3 − RᵀR)/2 corrects them.
    let mut rest = matrix::scaled(&matrix::transposed_product(&rough, &rough), -S::splat(0.5));
    for i in 0..D {
        rest[i][i] += S::splat(1.5);
    }
    let mut out = matrix::product(&rough, &rest);
    // Comparisons with NaN are false, so the mask is built from the opposite of `sound`.
    if S::any(S::zero().less(S::select(sound, S::zero(), S::one()))) {
        let singular = singular(f).rotation();
        for i in 0..D {
            for j in 0..D {
                out[i][j] = S::select(sound, out[i][j], singular[i][j]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);
    impl Random {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
        fn matrix<const D: usize>(&mut self) -> Matrix<f64, D> {
            core::array::from_fn(|_| core::array::from_fn(|_| self.next()))
        }
    }

    /// |RᵀR − 1|, |det R − 1| and the asymmetry of RᵀF, relative to |F|.
    fn errors<const D: usize>(f: &Matrix<f64, D>, r: &Matrix<f64, D>) -> [f64; 3] {
        let (unit, stretch) = (matrix::transposed_product(r, r), matrix::transposed_product(r, f));
        let size = matrix::inner(f, f).sqrt() + 1e-300;
        let (mut orthogonal, mut symmetric): (f64, f64) = (0.0, 0.0);
        for i in 0..D {
            for j in 0..D {
                orthogonal = (unit[i][j] - if i == j { 1.0 } else { 0.0 }).abs().larger(orthogonal);
                symmetric = ((stretch[i][j] - stretch[j][i]) / size).abs().larger(symmetric);
            }
        }
        [orthogonal, (matrix::determinant(r) - 1.0).abs(), symmetric]
    }

    /// Tests the formula, the singular vectors that replace it if it is not accurate, and the transition between them, for
    /// stretches of every kind.
    #[test]
    fn rotations_of_any_matrix_are_proper_and_leave_a_symmetric_stretch() {
        let mut random = Random(3);
        let mut worst = [0.0; 3];
        for k in 0..40_000 {
            let size = [1.0, 1e-6, 1e6, 1e-40][k % 4];
            let f: Matrix<f64, 3> = match k % 3 {
                0 => random.matrix(),
                _ => {
                    // A stretch between two rotations: degenerate, long, or inverted.
                    let (u, v) = (nearest_rotation(&random.matrix::<3>()), nearest_rotation(&random.matrix::<3>()));
                    let strain = [1e-12, 1e-6, 1e-2, 0.3, 0.9, 1.0][k % 6];
                    let mut us = u;
                    let sigma: [f64; 3] = core::array::from_fn(|i| {
                        let one = 1.0 + strain * random.next();
                        if i == 2 && k % 5 == 0 { random.next() } else { one }
                    });
                    for row in &mut us {
                        for (x, s) in row.iter_mut().zip(&sigma) {
                            *x *= s;
                        }
                    }
                    matrix::product_transposed(&us, &v)
                }
            };
            let f = matrix::scaled(&f, size);
            for (worst, error) in worst.iter_mut().zip(errors(&f, &nearest_rotation(&f))) {
                *worst = error.larger(*worst);
            }
            let plane = [[f[0][0], f[0][1]], [f[1][0], f[1][1]]];
            for (worst, error) in worst.iter_mut().zip(errors(&plane, &nearest_rotation(&plane))) {
                *worst = error.larger(*worst);
            }
        }
        assert!(worst[0] < 8e-15 && worst[1] < 8e-15 && worst[2] < 8e-15, "{worst:?}");
    }

    /// The rotation is the derivative of the sum of the stretches, and no other rotation gives a larger tr RᵀF.
    #[test]
    fn it_is_the_nearest_rotation_of_matrices_turned_inside_out_too() {
        let mut random = Random(11);
        for _ in 0..3000 {
            let f: Matrix<f64, 3> = random.matrix();
            let nearest = matrix::inner(&nearest_rotation(&f), &f);
            let sigma = singular(&f).sigma;
            assert!((nearest - sigma.iter().sum::<f64>()).abs() < 1e-14, "{f:?}");
            for _ in 0..20 {
                let other = nearest_rotation(&random.matrix::<3>());
                assert!(matrix::inner(&other, &f) <= nearest + 1e-14, "{f:?}");
            }
        }
    }

    #[test]
    fn what_has_no_nearest_rotation_gets_the_one_of_the_singular_vectors() {
        for f in [
            matrix::zeros::<f64, 3>(),
            [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            [[0.0, 0.0, 0.0], [0.0, -3.0, 0.0], [0.0, 0.0, 0.0]],
            [[1e-200, 0.0, 0.0], [0.0, 2e-200, 0.0], [0.0, 0.0, 1e-200]],
        ] {
            assert_eq!(nearest_rotation(&f), singular(&f).rotation());
            assert!(errors(&f, &nearest_rotation(&f))[0] < 4e-15);
        }
    }

    /// Each of eight matrices side by side gives the same bits as it gives alone.
    #[test]
    fn neighbours_in_the_lanes_change_no_bits() {
        use crate::lane::{Pack, Register, WIDTH};
        use crate::simd::{Simd, Work};
        struct All<'a>(&'a [Matrix<f64, 3>]);
        impl Work for All<'_> {
            type Output = Vec<Matrix<f64, 3>>;
            #[inline(always)]
            fn run<P: Pack>(self) -> Vec<Matrix<f64, 3>> {
                let mut out = vec![[[0.0; 3]; 3]; self.0.len()];
                for (from, to) in self.0.chunks_exact(WIDTH).zip(out.chunks_exact_mut(WIDTH)) {
                    for part in 0..P::PARTS {
                        let first = part * P::Part::NUMBERS;
                        let mut f = [[P::Part::zero(); 3]; 3];
                        for i in 0..3 {
                            for j in 0..3 {
                                let mut numbers = [0.0; WIDTH];
                                for l in 0..P::Part::NUMBERS {
                                    numbers[l] = from[first + l][i][j];
                                }
                                f[i][j] = P::Part::load(&numbers);
                            }
                        }
                        let r = nearest_rotation(&f);
                        for i in 0..3 {
                            for j in 0..3 {
                                let mut numbers = [0.0; WIDTH];
                                r[i][j].store(&mut numbers);
                                for l in 0..P::Part::NUMBERS {
                                    to[first + l][i][j] = numbers[l];
                                }
                            }
                        }
                    }
                }
                out
            }
        }
        let mut random = Random(5);
        let matrices: Vec<Matrix<f64, 3>> = (0..800)
            .map(|k| {
                let scale = [1e-9, 0.1, 1.0, 3.0][k % 4];
                let f = matrix::scaled(&random.matrix::<3>(), scale);
                matrix::plus(&f, if k % 3 == 0 { 0.0 } else { 1.0 }, &matrix::identity())
            })
            .collect();
        let alone: Vec<_> = matrices.iter().map(nearest_rotation).collect();
        for simd in Simd::available() {
            assert_eq!(simd.run(All(&matrices)), alone, "{simd:?}");
        }
    }
}
