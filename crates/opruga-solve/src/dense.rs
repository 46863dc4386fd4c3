//! Small dense matrices, row by row.

/// Eigenvalues, ascending, and the eigenvectors as rows, of a symmetric matrix with n rows (cyclic Jacobi rotations).
pub fn symmetric_eigen(matrix: &[f64], n: usize) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut a = matrix.to_vec();
    let mut vectors = vec![0.0; n * n];
    for k in 0..n {
        vectors[k * n + k] = 1.0;
    }
    for _ in 0..60 {
        let (mut off, mut all) = (0.0, 0.0);
        for i in 0..n {
            for j in 0..n {
                all += a[i * n + j] * a[i * n + j];
                off += if i == j { 0.0 } else { a[i * n + j] * a[i * n + j] };
            }
        }
        if off <= 1e-32 * all {
            break;
        }
        for p in 0..n {
            for q in p + 1..n {
                rotate(&mut a, &mut vectors, n, p, q);
            }
        }
    }
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|i, j| a[i * n + i].total_cmp(&a[j * n + j]));
    let values = order.iter().map(|k| a[k * n + k]).collect();
    let rows = order.iter().map(|k| vectors[k * n..(k + 1) * n].to_vec()).collect();
    (values, rows)
}

/// The rotation that makes the entry (p, q) zero; eigenvectors are rows.
fn rotate(a: &mut [f64], vectors: &mut [f64], n: usize, p: usize, q: usize) {
    let entry = a[p * n + q];
    if entry == 0.0 {
        return;
    }
    let theta = (a[q * n + q] - a[p * n + p]) / (2.0 * entry);
    let t = if theta < 0.0 { -1.0 } else { 1.0 } / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        (a[k * n + p], a[k * n + q]) = (c * x - s * y, s * x + c * y);
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        (a[p * n + k], a[q * n + k]) = (c * x - s * y, s * x + c * y);
        let (x, y) = (vectors[p * n + k], vectors[q * n + k]);
        (vectors[p * n + k], vectors[q * n + k]) = (c * x - s * y, s * x + c * y);
    }
}

/// Whether a symmetric matrix has this many positive eigenvalues and all others are negative.
pub fn has_positive(matrix: &[f64], n: usize, positive: usize) -> bool {
    let (values, _) = symmetric_eigen(matrix, n);
    values.iter().filter(|value| **value > 0.0).count() == positive && values.iter().all(|value| *value != 0.0)
}

/// The inverse by elimination with pivots; `None` for a singular matrix.
pub fn inverse(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut a = matrix.to_vec();
    let mut out = vec![0.0; n * n];
    for k in 0..n {
        out[k * n + k] = 1.0;
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|i, j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs()))?;
        let value = a[pivot * n + k];
        if value == 0.0 || !value.is_finite() {
            return None;
        }
        for j in 0..n {
            a.swap(k * n + j, pivot * n + j);
            out.swap(k * n + j, pivot * n + j);
        }
        for j in 0..n {
            a[k * n + j] /= value;
            out[k * n + j] /= value;
        }
        for i in (0..n).filter(|i| *i != k) {
            let factor = a[i * n + k];
            for j in 0..n {
                a[i * n + j] -= factor * a[k * n + j];
                out[i * n + j] -= factor * out[k * n + j];
            }
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_of_a_chain_are_those_of_its_closed_form() {
        let n = 12;
        let mut matrix = vec![0.0; n * n];
        for k in 0..n {
            matrix[k * n + k] = 2.0;
            if k + 1 < n {
                matrix[k * n + k + 1] = -1.0;
                matrix[(k + 1) * n + k] = -1.0;
            }
        }
        let (values, vectors) = symmetric_eigen(&matrix, n);
        for (k, value) in values.iter().enumerate() {
            let sine = libm::sin(core::f64::consts::PI * (k + 1) as f64 / (2 * (n + 1)) as f64);
            assert!((value - 4.0 * sine * sine).abs() < 1e-14);
            let product: Vec<f64> =
                (0..n).map(|i| (0..n).map(|j| matrix[i * n + j] * vectors[k][j]).sum::<f64>()).collect();
            assert!(product.iter().zip(&vectors[k]).all(|(p, v)| (p - value * v).abs() < 1e-13));
        }
        let unit = inverse(&matrix, n).unwrap();
        assert!((unit[0] - n as f64 / (n + 1) as f64).abs() < 1e-14);
        assert!(has_positive(&matrix, n, n) && !has_positive(&matrix, n, n - 1));
        assert_eq!(inverse(&[1.0, 2.0, 2.0, 4.0], 2), None);
    }
}
