//! The sparse Cholesky factor, by faer; parts of rank one by Woodbury's formula.

use crate::Indefinite;
use crate::matrix::BlockMatrix;
use crate::scalars::Scalars;
use crate::woodbury::Woodbury;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{MatMut, Side};

/// A factored matrix S + Σ c u uᵀ, whose symbolic part is kept while the pattern stays.
///
/// Results are the same bits on processors of one class only.
#[derive(Default)]
pub struct Cholesky {
    scalars: Scalars,
    symbolic: Option<SymbolicLlt<usize>>,
    factor: Option<Llt<usize, f64>>,
    parts: Woodbury,
}

impl core::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Cholesky").field("size", &self.scalars.size()).finish_non_exhaustive()
    }
}

fn solve(factor: &Llt<usize, f64>, x: &mut [f64]) {
    let rows = x.len();
    factor.solve_in_place(MatMut::from_column_major_slice_mut(x, rows, 1));
}

impl Cholesky {
    /// Factors a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] where it is not positive definite, or not without its parts of rank one.
    pub fn update<const D: usize>(&mut self, matrix: &BlockMatrix<D>) -> Result<(), Indefinite> {
        self.factor = None;
        let anew = self.scalars.take(matrix, true);
        let factor = self.factored(anew)?;
        self.parts.update(matrix, true, |x| solve(&factor, x))?;
        self.factor = Some(factor);
        Ok(())
    }

    /// The factor of the scalars, of no dimension of its own: compiled here, once.
    fn factored(&mut self, anew: bool) -> Result<Llt<usize, f64>, Indefinite> {
        let size = self.scalars.size();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &self.scalars.start, None, &self.scalars.row);
        let symbolic = match &self.symbolic {
            Some(symbolic) if !anew => symbolic.clone(),
            _ => SymbolicLlt::try_new(pattern, Side::Lower).map_err(|_| Indefinite)?,
        };
        self.symbolic = Some(symbolic.clone());
        let values = SparseColMatRef::new(pattern, &self.scalars.values);
        Llt::try_new_with_symbolic(symbolic, values, Side::Lower).map_err(|_| Indefinite)
    }

    /// Solves A x = b in place.
    pub fn solve(&self, x: &mut [f64]) {
        let Some(factor) = &self.factor else { return };
        solve(factor, x);
        self.parts.correct(x);
    }
}
