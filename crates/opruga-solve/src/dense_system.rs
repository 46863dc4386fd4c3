//! Large dense systems, solved by the library faer. Results have the same bits only on processors of one class.

use crate::Indefinite;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt;
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{Conj, MatMut, MatRef, Par, Side};
use opruga_core::dense::Dense;

/// The factors of a square matrix, with pivots, stored in the memory of the matrix.
pub struct DenseFactors {
    size: usize,
    numbers: Vec<f64>,
    rows: Vec<usize>,
    inverse: Vec<usize>,
}

impl core::fmt::Debug for DenseFactors {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("DenseFactors").field("size", &self.size).finish_non_exhaustive()
    }
}

impl DenseFactors {
    /// Factors a matrix of `size` rows, given column by column.
    ///
    /// # Errors
    /// [`Indefinite`] if it is singular or has an entry that is not finite.
    pub fn new(size: usize, mut numbers: Vec<f64>) -> Result<DenseFactors, Indefinite> {
        let (mut rows, mut inverse) = (vec![0; size], vec![0; size]);
        let mut memory =
            MemBuffer::new(factor::lu_in_place_scratch::<usize, f64>(size, size, Par::Seq, Default::default()));
        let matrix = MatMut::from_column_major_slice_mut(&mut numbers, size, size);
        factor::lu_in_place(matrix, &mut rows, &mut inverse, Par::Seq, MemStack::new(&mut memory), Default::default());
        let regular = (0..size).all(|k| numbers[k * size + k] != 0.0 && numbers[k * size + k].is_finite());
        if regular { Ok(DenseFactors { size, numbers, rows, inverse }) } else { Err(Indefinite) }
    }
    /// Replaces consecutive right-hand sides by the solutions.
    pub fn solve(&self, sides: &mut [f64]) {
        self.solve_any(sides, false);
    }
    /// Does the same with the transposed matrix.
    pub fn solve_transposed(&self, sides: &mut [f64]) {
        self.solve_any(sides, true);
    }
    fn solve_any(&self, sides: &mut [f64], transposed: bool) {
        let size = self.size;
        if size == 0 {
            return;
        }
        let count = sides.len() / size;
        let mut memory = MemBuffer::new(solve::solve_in_place_scratch::<usize, f64>(size, count, Par::Seq));
        let factors = MatRef::from_column_major_slice(&self.numbers, size, size);
        let rows = PermRef::new_checked(&self.rows, &self.inverse, size);
        let sides = MatMut::from_column_major_slice_mut(sides, size, count);
        let stack = MemStack::new(&mut memory);
        if transposed {
            solve::solve_transpose_in_place_with_conj(factors, factors, rows, Conj::No, sides, Par::Seq, stack);
        } else {
            solve::solve_in_place_with_conj(factors, factors, rows, Conj::No, sides, Par::Seq, stack);
        }
    }
}

/// The lower factor L of a symmetric positive definite matrix L Lᵀ.
pub struct DenseCholesky {
    size: usize,
    numbers: Vec<f64>,
}

impl core::fmt::Debug for DenseCholesky {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("DenseCholesky").field("size", &self.size).finish_non_exhaustive()
    }
}

impl DenseCholesky {
    /// Factors a matrix of `size` rows, whose lower half is given column by column.
    ///
    /// # Errors
    /// [`Indefinite`] if it is not positive definite.
    pub fn new(size: usize, mut numbers: Vec<f64>) -> Result<DenseCholesky, Indefinite> {
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(size, Par::Seq, Default::default());
        let mut memory = MemBuffer::new(scratch);
        let matrix = MatMut::from_column_major_slice_mut(&mut numbers, size, size);
        let stack = MemStack::new(&mut memory);
        llt::factor::cholesky_in_place(matrix, Default::default(), Par::Seq, stack, Default::default())
            .map_err(|_| Indefinite)?;
        let regular = (0..size).all(|k| numbers[k * size + k].is_finite());
        if regular { Ok(DenseCholesky { size, numbers }) } else { Err(Indefinite) }
    }
    /// Replaces consecutive right-hand sides by the solutions.
    pub fn solve(&self, sides: &mut [f64]) {
        let size = self.size;
        if size == 0 {
            return;
        }
        let count = sides.len() / size;
        let mut memory = MemBuffer::new(llt::solve::solve_in_place_scratch::<f64>(size, count, Par::Seq));
        let factor = MatRef::from_column_major_slice(&self.numbers, size, size);
        let sides = MatMut::from_column_major_slice_mut(sides, size, count);
        llt::solve::solve_in_place_with_conj(factor, Conj::No, sides, Par::Seq, MemStack::new(&mut memory));
    }
    /// The inverse of the matrix. A product with it reads half as many numbers as a solution with the factor.
    pub fn inverse(&self) -> Dense {
        let size = self.size;
        let mut memory = MemBuffer::new(llt::inverse::inverse_scratch::<f64>(size, Par::Seq));
        let mut out = vec![0.0; size * size];
        let factor = MatRef::from_column_major_slice(&self.numbers, size, size);
        let inverse = MatMut::from_column_major_slice_mut(&mut out, size, size);
        llt::inverse::inverse(inverse, factor, Par::Seq, MemStack::new(&mut memory));
        Dense::of_lower(size, |row, column| out[column * size + row])
    }
}

/// Removes the negative eigenvalues from a symmetric matrix of `size` rows, given column by column. Returns the norm of the removed part divided by
/// the norm of the matrix. Eigenvalues below 1e-12 of the largest count as rounding errors and are kept.
///
/// # Errors
/// [`Indefinite`] if an entry is not finite.
pub fn clamp(size: usize, numbers: &mut [f64]) -> Result<f64, Indefinite> {
    let matrix = MatRef::from_column_major_slice(numbers, size, size);
    let found = matrix.self_adjoint_eigen(Side::Lower).map_err(|_| Indefinite)?;
    let values: Vec<f64> = found.S().column_vector().iter().copied().collect();
    let largest = values.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most });
    let all: f64 = values.iter().map(|x| x * x).sum();
    let mut taken = 0.0;
    for (k, value) in values.iter().enumerate().filter(|(_, value)| **value < -1e-12 * largest) {
        taken += value * value;
        let vector: Vec<f64> = found.U().col(k).iter().copied().collect();
        for (column, weight) in numbers.chunks_exact_mut(size).zip(&vector) {
            column.iter_mut().zip(&vector).for_each(|(entry, x)| *entry -= value * weight * x);
        }
    }
    Ok((taken / all).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_math::Simd;

    #[test]
    fn factors_solve_and_singular_matrices_are_told() {
        let size = 40;
        let entry = |i: usize, j: usize| ((i * 13 + j * 7) % 17) as f64 + if i == j { 30.0 } else { 0.0 };
        let x: Vec<f64> = (0..size).map(|k| (k % 5) as f64 - 2.0).collect();
        let numbers: Vec<f64> = (0..size * size).map(|k| entry(k % size, k / size)).collect();
        let factors = DenseFactors::new(size, numbers).unwrap();
        let mut b: Vec<f64> = (0..size).map(|i| (0..size).map(|j| entry(i, j) * x[j]).sum()).collect();
        factors.solve(&mut b);
        assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-11));
        let mut b: Vec<f64> = (0..size).map(|i| (0..size).map(|j| entry(j, i) * x[j]).sum()).collect();
        factors.solve_transposed(&mut b);
        assert!(x.iter().zip(&b).all(|(x, b)| (x - b).abs() < 1e-11));
        assert!(DenseFactors::new(3, vec![0.0; 9]).is_err());

        let symmetric = |i: usize, j: usize| entry(i, j) + entry(j, i) + if i == j { 300.0 } else { 0.0 };
        let numbers: Vec<f64> = (0..size * size).map(|k| symmetric(k % size, k / size)).collect();
        let factor = DenseCholesky::new(size, numbers).unwrap();
        let b: Vec<f64> = (0..size).map(|i| (0..size).map(|j| symmetric(i, j) * x[j]).sum()).collect();
        let mut solved = b.clone();
        factor.solve(&mut solved);
        assert!(x.iter().zip(&solved).all(|(x, b)| (x - b).abs() < 1e-11));
        let inverse = factor.inverse();
        let (mut padded, mut out) = (vec![0.0; inverse.padded()], vec![0.0; inverse.padded()]);
        padded[..size].copy_from_slice(&b);
        inverse.multiply(Simd::best(), &padded, &mut out);
        assert!(x.iter().zip(&out).all(|(x, b)| (x - b).abs() < 1e-11));
        assert!(DenseCholesky::new(2, vec![1.0, 2.0, 2.0, 1.0]).is_err());
        // Eigenvalues 3 and −1.
        let mut clamped = vec![1.0, 2.0, 2.0, 1.0];
        let taken = clamp(2, &mut clamped).unwrap();
        assert!((taken - 0.1_f64.sqrt()).abs() < 1e-14 && clamped.iter().all(|x| (x - 1.5).abs() < 1e-14));
    }
}
