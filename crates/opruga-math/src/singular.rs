//! Singular values with proper rotations.
//!
//! F = U diag(σ) Vᵀ with det U = det V = 1 and decreasing |σ|. The last σ is therefore negative if F is inverted, and R = U Vᵀ
//! is always a rotation (Irving, Teran, Fedkiw 2004).
//!
//! One-sided Jacobi rotations (Hestenes 1958) make the columns of B = F V orthogonal: small singular values are as accurate as
//! large ones. A matrix whose columns are already orthogonal does not change in any bit, so its result does not depend on its
//! neighbours in the lanes.

use crate::lane::Lane;
use crate::matrix::{self, Matrix};

/// Rotations U, V and singular values σ of a matrix.
#[derive(Clone, Copy, Debug)]
pub struct Singular<S, const D: usize> {
    /// The rotation U on the left.
    pub u: Matrix<S, D>,
    /// The singular values, in decreasing size. The last one has the sign of the determinant.
    pub sigma: [S; D],
    /// The rotation V on the right.
    pub v: Matrix<S, D>,
}

impl<S: Lane, const D: usize> Singular<S, D> {
    /// R = U Vᵀ, the nearest rotation.
    #[inline(always)]
    pub fn rotation(&self) -> Matrix<S, D> {
        matrix::product_transposed(&self.u, &self.v)
    }
}

/// The largest number of sweeps over all pairs of columns. Six make any 3×3 matrix as accurate as rounding permits.
const MOST_SWEEPS: usize = 12;

/// Columns count as orthogonal if their cosine is less than this.
const ORTHOGONAL: f64 = 1e-16;

/// Vectors shorter than this have no direction.
const NO_LENGTH: f64 = 1e-100;

/// Decomposes a matrix.
#[inline(always)]
pub fn singular<S: Lane, const D: usize>(f: &Matrix<S, D>) -> Singular<S, D> {
    const { assert!(D == 2 || D == 3) }
    let mut b = *f;
    let mut v = matrix::identity::<S, D>();
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for p in 0..D {
            for q in p + 1..D {
                turned |= make_orthogonal(&mut b, &mut v, p, q);
            }
        }
        if !turned {
            break;
        }
    }
    // The shortest column is moved to the end.
    let mut squares = [S::zero(); D];
    for j in 0..D {
        for i in 0..D {
            squares[j] += b[i][j] * b[i][j];
        }
    }
    let order: &[(usize, usize)] = if D == 2 { &[(0, 1)] } else { &[(0, 1), (1, 2), (0, 1)] };
    for &(p, q) in order {
        let swap = squares[p].less(squares[q]);
        let (sp, sq) = (squares[p], squares[q]);
        squares[p] = S::select(swap, sq, sp);
        squares[q] = S::select(swap, sp, sq);
        for i in 0..D {
            for m in [&mut b, &mut v] {
                let (x, y) = (m[i][p], m[i][q]);
                m[i][p] = S::select(swap, y, x);
                m[i][q] = S::select(swap, -x, y);
            }
        }
    }
    let mut u = matrix::zeros::<S, D>();
    let mut sigma = [S::zero(); D];
    let column = |m: &Matrix<S, D>, j: usize| {
        let mut out = [S::zero(); D];
        for i in 0..D {
            out[i] = m[i][j];
        }
        out
    };
    // The first axis: that of the longest column; x if no column has a length.
    let mut axis = [S::zero(); D];
    axis[0] = S::one();
    let (first, length) = direction(&column(&b, 0), &axis);
    sigma[0] = length;
    if D == 2 {
        let second = [-first[1], first[0]];
        for i in 0..D {
            u[i][0] = first[i];
            u[i][1] = second[i];
            sigma[1] += second[i] * b[i][1];
        }
    } else {
        // The second axis, made exactly orthogonal to the first; any orthogonal axis if the column has no length.
        let mut second = column(&b, 1);
        let mut along = S::zero();
        for i in 0..D {
            along += second[i] * first[i];
        }
        for i in 0..D {
            second[i] -= along * first[i];
        }
        let (x, y, z) = (first[0].abs(), first[1].abs(), first[D - 1].abs());
        let x_least = S::both(x.less_or_equal(y), x.less_or_equal(z));
        let y_least = y.less_or_equal(z);
        let [a, c, d] = [first[0], first[1], first[D - 1]];
        let zero = S::zero();
        // The cross product of `first` and the axis along which it has the smallest component.
        let mut other = [zero; D];
        other[0] = S::select(x_least, zero, S::select(y_least, -d, c));
        other[1] = S::select(x_least, d, S::select(y_least, zero, -a));
        other[D - 1] = S::select(x_least, -c, S::select(y_least, a, zero));
        let (other, _) = direction(&other, &axis);
        let (second, length) = direction(&second, &other);
        sigma[1] = length;
        for i in 0..D {
            let (p, q) = ((i + 1) % D, (i + 2) % D);
            let third = first[p] * second[q] - first[q] * second[p];
            u[i][0] = first[i];
            u[i][1] = second[i];
            u[i][D - 1] = third;
            sigma[D - 1] += third * b[i][D - 1];
        }
    }
    Singular { u, sigma, v }
}

/// A vector divided by its length, and its length. If the length is zero, returns the substitute and zero.
#[inline(always)]
pub(crate) fn direction<S: Lane, const D: usize>(a: &[S; D], substitute: &[S; D]) -> ([S; D], S) {
    let mut square = S::zero();
    for i in 0..D {
        square += a[i] * a[i];
    }
    let length = square.sqrt();
    let real = S::splat(NO_LENGTH).less(length);
    let inverse = S::one() / S::select(real, length, S::one());
    let mut out = [S::zero(); D];
    for i in 0..D {
        out[i] = S::select(real, a[i] * inverse, substitute[i]);
    }
    (out, S::select(real, length, S::zero()))
}

/// Makes one rotation of two columns. Returns whether any matrix was rotated.
#[inline(always)]
fn make_orthogonal<S: Lane, const D: usize>(b: &mut Matrix<S, D>, v: &mut Matrix<S, D>, p: usize, q: usize) -> bool {
    let (mut alpha, mut beta, mut gamma) = (S::zero(), S::zero(), S::zero());
    for i in 0..D {
        alpha += b[i][p] * b[i][p];
        beta += b[i][q] * b[i][q];
        gamma += b[i][p] * b[i][q];
    }
    let open = (S::splat(ORTHOGONAL * ORTHOGONAL) * (alpha * beta)).less(gamma * gamma);
    if !S::any(open) {
        return false;
    }
    // t² + 2 ζ t − 1 = 0, the smaller root; zero, and so no rotation, if the columns are orthogonal.
    let zeta = (beta - alpha) / S::select(open, gamma + gamma, S::one());
    let magnitude = S::one() / (zeta.abs() + (S::one() + zeta * zeta).sqrt());
    let t = S::select(open, S::select(zeta.less(S::zero()), -magnitude, magnitude), S::zero());
    let c = S::one() / (S::one() + t * t).sqrt();
    let s = c * t;
    for m in [b, v] {
        for i in 0..D {
            let (x, y) = (m[i][p], m[i][q]);
            m[i][p] = c * x - s * y;
            m[i][q] = s * x + c * y;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rotation::nearest_rotation;

    fn check<const D: usize>(f: &Matrix<f64, D>) {
        let s = singular(f);
        let scale = matrix::inner(f, f).sqrt() + 1e-300;
        let mut us = s.u;
        for row in &mut us {
            for (x, sigma) in row.iter_mut().zip(&s.sigma) {
                *x *= sigma;
            }
        }
        let back = matrix::product_transposed(&us, &s.v);
        for i in 0..D {
            for j in 0..D {
                assert!((back[i][j] - f[i][j]).abs() <= 4e-15 * scale, "{f:?} {back:?}");
            }
        }
        for m in [&s.u, &s.v, &s.rotation()] {
            let unit = matrix::transposed_product(m, m);
            for i in 0..D {
                for j in 0..D {
                    assert!((unit[i][j] - if i == j { 1.0 } else { 0.0 }).abs() < 4e-15, "{f:?} {m:?}");
                }
            }
            assert!((matrix::determinant(m) - 1.0).abs() < 1e-14, "{f:?}");
        }
        for k in 1..D {
            assert!(s.sigma[k].abs() <= s.sigma[k - 1] * (1.0 + 1e-14), "{:?}", s.sigma);
        }
        assert!(s.sigma[D - 1] * matrix::determinant(f) >= -1e-15 * scale * scale * scale, "{f:?} {:?}", s.sigma);
    }

    #[test]
    fn matrices_of_every_rank_and_both_hands_are_decomposed() {
        let mut random = 7u64;
        let mut next = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        for k in 0..3000 {
            let size = [1.0, 1e-6, 1e6][k % 3];
            let mut a: Matrix<f64, 3> = core::array::from_fn(|_| core::array::from_fn(|_| size * next()));
            if k % 5 == 1 {
                // A plane, or a line.
                a[2] = core::array::from_fn(|j| a[0][j] + 2.0 * a[1][j]);
            }
            if k % 10 == 1 {
                a[1] = a[0].map(|x| 0.5 * x);
                a[2] = a[0].map(|x| -x);
            }
            if k % 7 == 2 {
                // Nearly a rotation.
                for i in 0..3 {
                    for j in 0..3 {
                        a[i][j] = 1e-9 * a[i][j] + if i == j { size } else { 0.0 };
                    }
                }
            }
            check(&a);
            check(&[[a[0][0], a[0][1]], [a[1][0], a[1][1]]]);
        }
        check(&matrix::zeros::<f64, 3>());
        check(&matrix::zeros::<f64, 2>());
        check(&[[0.0, 0.0, 0.0], [0.0, -3.0, 0.0], [0.0, 0.0, 0.0]]);
        check(&[[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        check(&[[-1.0, 0.0], [0.0, 1.0]]);
    }

    #[test]
    fn a_turned_stretch_gives_back_turn_and_stretch() {
        let (c, s) = (0.6, 0.8);
        let f = [[2.0 * c, -0.5 * s], [2.0 * s, 0.5 * c]];
        let r = nearest_rotation(&f);
        assert!((r[0][0] - c).abs() < 1e-15 && (r[1][0] - s).abs() < 1e-15);
        let sigma = singular(&f).sigma;
        assert!((sigma[0] - 2.0).abs() < 1e-15 && (sigma[1] - 0.5).abs() < 1e-15);
    }
}
