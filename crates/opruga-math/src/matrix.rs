//! Small square matrices over lanes, for the mechanics at a point.
//!
//! `[i][j]` is row i, column j. Everything is written for D = 2 and D = 3 and inlined into vector code.

use crate::lane::Lane;

/// A square matrix, `[row][column]`.
pub type Matrix<S, const D: usize> = [[S; D]; D];

/// Zeros in every entry.
#[inline(always)]
pub fn zeros<S: Lane, const D: usize>() -> Matrix<S, D> {
    [[S::zero(); D]; D]
}

/// The unit matrix.
#[inline(always)]
pub fn identity<S: Lane, const D: usize>() -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        out[i][i] = S::one();
    }
    out
}

/// The product s A of a number and a matrix.
#[inline(always)]
pub fn scaled<S: Lane, const D: usize>(a: &Matrix<S, D>, s: S) -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        for j in 0..D {
            out[i][j] = a[i][j] * s;
        }
    }
    out
}

/// The sum A + s B.
#[inline(always)]
pub fn plus<S: Lane, const D: usize>(a: &Matrix<S, D>, s: S, b: &Matrix<S, D>) -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        for j in 0..D {
            out[i][j] = a[i][j] + s * b[i][j];
        }
    }
    out
}

/// The product A B.
#[inline(always)]
pub fn product<S: Lane, const D: usize>(a: &Matrix<S, D>, b: &Matrix<S, D>) -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        for j in 0..D {
            let mut sum = a[i][0] * b[0][j];
            for k in 1..D {
                sum += a[i][k] * b[k][j];
            }
            out[i][j] = sum;
        }
    }
    out
}

/// The product A Bᵀ.
#[inline(always)]
pub fn product_transposed<S: Lane, const D: usize>(a: &Matrix<S, D>, b: &Matrix<S, D>) -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        for j in 0..D {
            let mut sum = a[i][0] * b[j][0];
            for k in 1..D {
                sum += a[i][k] * b[j][k];
            }
            out[i][j] = sum;
        }
    }
    out
}

/// The product Aᵀ B.
#[inline(always)]
pub fn transposed_product<S: Lane, const D: usize>(a: &Matrix<S, D>, b: &Matrix<S, D>) -> Matrix<S, D> {
    let mut out = zeros();
    for i in 0..D {
        for j in 0..D {
            let mut sum = a[0][i] * b[0][j];
            for k in 1..D {
                sum += a[k][i] * b[k][j];
            }
            out[i][j] = sum;
        }
    }
    out
}

/// The inner product A : B = Σ aᵢⱼ bᵢⱼ.
#[inline(always)]
pub fn inner<S: Lane, const D: usize>(a: &Matrix<S, D>, b: &Matrix<S, D>) -> S {
    let mut sum = S::zero();
    for i in 0..D {
        for j in 0..D {
            sum += a[i][j] * b[i][j];
        }
    }
    sum
}

/// The trace tr A.
#[inline(always)]
pub fn trace<S: Lane, const D: usize>(a: &Matrix<S, D>) -> S {
    let mut sum = a[0][0];
    for i in 1..D {
        sum += a[i][i];
    }
    sum
}

/// The cofactors of A: ∂(det A)/∂A, which is det A · A⁻ᵀ if that exists.
#[inline(always)]
pub fn cofactor<S: Lane, const D: usize>(a: &Matrix<S, D>) -> Matrix<S, D> {
    const { assert!(D == 2 || D == 3) }
    let mut out = zeros();
    if D == 2 {
        out[0][0] = a[1][1];
        out[0][1] = -a[1][0];
        out[1][0] = -a[0][1];
        out[1][1] = a[0][0];
    } else {
        for i in 0..D {
            let (p, q) = ((i + 1) % D, (i + 2) % D);
            for j in 0..D {
                let (r, s) = ((j + 1) % D, (j + 2) % D);
                out[i][j] = a[p][r] * a[q][s] - a[p][s] * a[q][r];
            }
        }
    }
    out
}

/// The determinant det A, from A and its cofactors.
#[inline(always)]
pub fn determinant_by<S: Lane, const D: usize>(a: &Matrix<S, D>, cofactors: &Matrix<S, D>) -> S {
    let mut sum = a[0][0] * cofactors[0][0];
    for j in 1..D {
        sum += a[0][j] * cofactors[0][j];
    }
    sum
}

/// The determinant det A.
#[inline(always)]
pub fn determinant<S: Lane, const D: usize>(a: &Matrix<S, D>) -> S {
    determinant_by(a, &cofactor(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cofactors_are_the_inverse_times_the_determinant() {
        let a = [[2.0, -1.0, 0.5], [0.25, 1.5, 3.0], [-0.75, 0.125, 1.0]];
        let c = cofactor(&a);
        let d = determinant(&a);
        assert!((d - 5.328125).abs() < 1e-15, "{d}");
        let p = product_transposed(&a, &c);
        for i in 0..3 {
            for j in 0..3 {
                assert!((p[i][j] - if i == j { d } else { 0.0 }).abs() < 1e-14);
            }
        }
        let b = [[2.0, -1.0], [0.25, 1.5]];
        assert_eq!(determinant(&b), 3.25);
        assert_eq!(cofactor(&b), [[1.5, -0.25], [1.0, 2.0]]);
    }
}
