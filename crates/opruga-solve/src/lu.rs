//! The sparse factors of a matrix that may be indefinite or unsymmetric, by faer.

use crate::Indefinite;
use crate::matrix::BlockMatrix;
use crate::scalars::Scalars;
use crate::turned_factor::TurnedFactor;
use crate::woodbury::Woodbury;
use faer::MatMut;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};

/// A factored matrix S + Σ c u uᵀ that may be indefinite, with partial pivoting.
#[derive(Default)]
pub struct Factors {
    scalars: Scalars,
    symbolic: Option<SymbolicLu<usize>>,
    factors: Option<Lu<usize, f64>>,
    /// Whether the matrix is symmetric.
    is_symmetric: bool,
    parts: Woodbury,
    /// The factor of a matrix with dense parts, if there are any.
    turned: Option<TurnedFactor>,
}

impl core::fmt::Debug for Factors {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Factors").field("size", &self.scalars.size()).finish_non_exhaustive()
    }
}

/// The rows of the matrix were passed as columns, so the factors of an unsymmetric matrix are the factors of its transpose.
fn solve(factors: &Lu<usize, f64>, is_symmetric: bool, x: &mut [f64]) {
    let rows = x.len();
    let x = MatMut::from_column_major_slice_mut(x, rows, 1);
    if is_symmetric { factors.solve_in_place(x) } else { factors.solve_transpose_in_place(x) }
}

impl Factors {
    /// Factors a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] if it is singular.
    pub fn update<const D: usize>(&mut self, matrix: &BlockMatrix<D>) -> Result<(), Indefinite> {
        self.update_any(matrix, true)
    }

    /// Factors a matrix that may differ from its transpose; its rank-one terms are symmetric.
    ///
    /// # Errors
    /// [`Indefinite`] if it is singular.
    pub fn update_any<const D: usize>(
        &mut self,
        matrix: &BlockMatrix<D>,
        is_symmetric: bool,
    ) -> Result<(), Indefinite> {
        self.is_symmetric = is_symmetric;
        self.factors = None;
        self.turned = None;
        if matrix.has_dense() {
            let mut turned = TurnedFactor::default();
            turned.update(matrix, false)?;
            turned.update_parts(&mut self.parts, matrix, false, None)?;
            self.turned = Some(turned);
            return Ok(());
        }
        let anew = self.scalars.take(matrix, false);
        let factors = self.factored(anew)?;
        self.parts.update(matrix.rows() * D, matrix.rank_one().iter(), false, None, |sides| {
            sides.for_each(|x| solve(&factors, is_symmetric, x));
        })?;
        self.factors = Some(factors);
        Ok(())
    }

    /// Computes the factors of the scalars. The code does not depend on the dimension, so it is compiled only once, with this crate.
    fn factored(&mut self, anew: bool) -> Result<Lu<usize, f64>, Indefinite> {
        let size = self.scalars.size();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &self.scalars.start, None, &self.scalars.row);
        let symbolic = match &self.symbolic {
            Some(symbolic) if !anew => symbolic.clone(),
            _ => SymbolicLu::try_new(pattern).map_err(|_| Indefinite)?,
        };
        self.symbolic = Some(symbolic.clone());
        let values = SparseColMatRef::new(pattern, &self.scalars.values);
        Lu::try_new_with_symbolic(symbolic, values).map_err(|_| Indefinite)
    }

    /// Solves A x = b in place; returns whether the whole solution is finite.
    pub fn solve(&self, x: &mut [f64]) -> bool {
        if let Some(turned) = &self.turned {
            turned.solve(x);
            self.parts.correct(x);
            return x.iter().all(|x| x.is_finite());
        }
        let Some(factors) = &self.factors else { return false };
        solve(factors, self.is_symmetric, x);
        self.parts.correct(x);
        x.iter().all(|x| x.is_finite())
    }
}
