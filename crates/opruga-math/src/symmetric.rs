//! Symmetric matrices over lanes: their eigenvalues by Jacobi rotations, and the removal of negative eigenvalues.

use crate::lane::Lane;

/// The largest number of sweeps. Seven make a 4×4 matrix as accurate as rounding permits.
const MOST_SWEEPS: usize = 12;

/// An off-diagonal entry counts as zero if it is below this fraction of the diagonal entries of its row and
/// column.
const ZERO: f64 = 1e-17;

/// Eigenvalues, and eigenvectors in columns, of a symmetric matrix (cyclic Jacobi rotations).
#[inline(always)]
pub fn eigen<S: Lane, const N: usize>(matrix: &[[S; N]; N]) -> ([S; N], [[S; N]; N]) {
    let mut a = *matrix;
    let mut vectors = [[S::zero(); N]; N];
    for i in 0..N {
        vectors[i][i] = S::one();
    }
    for _ in 0..MOST_SWEEPS {
        let mut turned = false;
        for p in 0..N {
            for q in p + 1..N {
                turned |= rotate(&mut a, &mut vectors, p, q);
            }
        }
        if !turned {
            break;
        }
    }
    let mut values = [S::zero(); N];
    for i in 0..N {
        values[i] = a[i][i];
    }
    (values, vectors)
}

/// The matrix without its negative eigenvalues: Σ max(λ, 0) v vᵀ. If there are none, this is the matrix itself.
#[inline(always)]
pub fn positive_part<S: Lane, const N: usize>(matrix: &[[S; N]; N]) -> [[S; N]; N] {
    // A matrix is positive definite if all pivots of Gaussian elimination are positive.
    let mut left = *matrix;
    let mut open = S::zero();
    for k in 0..N {
        let positive = S::zero().less(left[k][k]);
        open = S::select(positive, open, S::one());
        let inverse = S::one() / S::select(positive, left[k][k], S::one());
        for i in k + 1..N {
            let factor = left[i][k] * inverse;
            for j in k + 1..N {
                left[i][j] -= factor * left[k][j];
            }
        }
    }
    let open = S::zero().less(open);
    if !S::any(open) {
        return *matrix;
    }
    let (values, vectors) = eigen(matrix);
    let mut out = [[S::zero(); N]; N];
    for k in 0..N {
        let value = values[k].larger(S::zero());
        for i in 0..N {
            for j in 0..N {
                out[i][j] += value * vectors[i][k] * vectors[j][k];
            }
        }
    }
    for i in 0..N {
        for j in 0..N {
            out[i][j] = S::select(open, out[i][j], matrix[i][j]);
        }
    }
    out
}

/// Makes the entry (p, q) zero by one rotation. Returns whether any matrix needed it.
#[inline(always)]
fn rotate<S: Lane, const N: usize>(a: &mut [[S; N]; N], vectors: &mut [[S; N]; N], p: usize, q: usize) -> bool {
    let off = a[p][q];
    let size = a[p][p].abs() + a[q][q].abs();
    let open = (S::splat(ZERO) * size).less(off.abs());
    if !S::any(open) {
        return false;
    }
    let theta = (a[q][q] - a[p][p]) / S::select(open, off + off, S::one());
    let magnitude = S::one() / (theta.abs() + (theta * theta + S::one()).sqrt());
    let t = S::select(open, S::select(theta.less(S::zero()), -magnitude, magnitude), S::zero());
    let c = S::one() / (t * t + S::one()).sqrt();
    let s = t * c;
    for k in 0..N {
        let (x, y) = (a[k][p], a[k][q]);
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for k in 0..N {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
        let (x, y) = (vectors[k][p], vectors[k][q]);
        vectors[k][p] = c * x - s * y;
        vectors[k][q] = s * x + c * y;
    }
    // Set to exact zero, because rounding errors would otherwise be rotated for ever.
    a[p][q] = S::select(open, S::zero(), a[p][q]);
    a[q][p] = S::select(open, S::zero(), a[q][p]);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_a_known_matrix() {
        // The matrix of second differences, whose eigenvalues are 2 − 2 cos(kπ/5).
        let mut a = [[0.0; 4]; 4];
        for i in 0..4 {
            a[i][i] = 2.0;
            if i > 0 {
                (a[i][i - 1], a[i - 1][i]) = (-1.0, -1.0);
            }
        }
        let (mut values, _) = eigen(&a);
        values.sort_by(f64::total_cmp);
        for (k, value) in values.iter().enumerate() {
            let expected = 2.0 - 2.0 * libm::cos((k + 1) as f64 * core::f64::consts::PI / 5.0);
            assert!((value - expected).abs() < 1e-14, "{values:?}");
        }
    }

    #[test]
    fn the_positive_part_keeps_positive_eigenvalues_alone() {
        let (c, s) = (0.6, 0.8);
        let entry = |i: usize, j: usize, a: f64, b: f64| {
            let (n, m) = ([c, s], [-s, c]);
            a * n[i] * n[j] + b * m[i] * m[j]
        };
        let matrix =
            [[entry(0, 0, 2.0, -3.0), entry(0, 1, 2.0, -3.0)], [entry(1, 0, 2.0, -3.0), entry(1, 1, 2.0, -3.0)]];
        let kept = positive_part(&matrix);
        for i in 0..2 {
            for j in 0..2 {
                assert!((kept[i][j] - entry(i, j, 2.0, 0.0)).abs() < 1e-15);
            }
        }
    }
}
