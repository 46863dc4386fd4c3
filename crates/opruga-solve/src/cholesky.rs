//! The sparse Cholesky factor, computed by faer. The Woodbury formula includes the rank-one terms.

use crate::Indefinite;
use crate::matrix::BlockMatrix;
use crate::scalars::Scalars;
use crate::turned_factor::TurnedFactor;
use crate::woodbury::Woodbury;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use std::sync::{Mutex, PoisonError};

/// A factored matrix S + Σ c u uᵀ, whose symbolic factorisation and memory are kept as long as the pattern does not change.
///
/// Results have the same bits only on processors of one class.
#[derive(Default)]
pub struct Cholesky {
    scalars: Scalars,
    symbolic: Option<SymbolicCholesky<usize>>,
    values: Vec<f64>,
    factored: bool,
    /// The working memory of the library.
    stack: Mutex<Option<MemBuffer>>,
    parts: Woodbury,
    /// The factor of a matrix with dense parts, if there are any.
    turned: TurnedFactor,
    is_turned: bool,
}

impl core::fmt::Debug for Cholesky {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Cholesky").field("size", &self.scalars.size()).finish_non_exhaustive()
    }
}

impl Cholesky {
    /// Factors a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] if it is not positive definite, with or without its rank-one terms.
    pub fn update<const D: usize>(&mut self, matrix: &BlockMatrix<D>) -> Result<(), Indefinite> {
        self.take(matrix, None)
    }

    /// Factors a matrix and solves A x = b in place. One pass through a large factor serves both b and the rank-one terms.
    ///
    /// # Errors
    /// The errors of [`Cholesky::update`].
    pub fn update_and_solve<const D: usize>(
        &mut self,
        matrix: &BlockMatrix<D>,
        x: &mut [f64],
    ) -> Result<(), Indefinite> {
        self.take(matrix, Some(&mut *x))?;
        self.parts.correct(x);
        Ok(())
    }

    fn take<const D: usize>(
        &mut self,
        matrix: &BlockMatrix<D>,
        mut right: Option<&mut [f64]>,
    ) -> Result<(), Indefinite> {
        self.factored = false;
        self.is_turned = matrix.has_dense();
        if self.is_turned {
            self.turned.update(matrix, true)?;
            self.parts = Woodbury::default();
            if !self.turned.follow(matrix, right.as_deref_mut())? {
                self.turned.update_parts(&mut self.parts, matrix, true, right)?;
            }
            self.factored = true;
            return Ok(());
        }
        let anew = self.scalars.take(matrix, true);
        self.factor(anew)?;
        let Some(symbolic) = &self.symbolic else { return Err(Indefinite) };
        let (values, stack) = (&self.values, &self.stack);
        self.parts.update(matrix.rows() * D, matrix.rank_one().iter(), true, right, |sides| {
            sides.for_each(|x| solve(symbolic, values, stack, x, 1));
        })?;
        self.factored = true;
        Ok(())
    }

    /// Computes the factor of the scalars. The code does not depend on the dimension, so it is compiled only once, with this crate.
    fn factor(&mut self, anew: bool) -> Result<(), Indefinite> {
        let size = self.scalars.size();
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &self.scalars.start, None, &self.scalars.row);
        if anew {
            self.symbolic = None;
        }
        if self.symbolic.is_none() {
            let (ordering, parameters) = (SymmetricOrdering::Amd, CholeskySymbolicParams::default());
            let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, ordering, parameters);
            let symbolic = symbolic.map_err(|_| Indefinite)?;
            let need = StackReq::or(
                symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default()),
                symbolic.solve_in_place_scratch::<f64>(AT_ONCE, Par::Seq),
            );
            self.stack = Mutex::new(Some(MemBuffer::new(need)));
            self.values = vec![0.0; symbolic.len_val()];
            self.symbolic = Some(symbolic);
        }
        let Some(symbolic) = &self.symbolic else { return Err(Indefinite) };
        if let Some(stack) = self.stack.get_mut().unwrap_or_else(PoisonError::into_inner) {
            symbolic
                .factorize_numeric_llt(
                    &mut self.values,
                    SparseColMatRef::new(pattern, &self.scalars.values),
                    Side::Lower,
                    Default::default(),
                    Par::Seq,
                    MemStack::new(stack),
                    Default::default(),
                )
                .map_err(|_| Indefinite)?;
        }
        Ok(())
    }

    /// Solves A x = b in place.
    pub fn solve(&self, x: &mut [f64]) {
        self.solve_all(x, 1);
    }

    /// Solves A x = b in place for `count` consecutive right-hand sides.
    pub fn solve_all(&self, x: &mut [f64], count: usize) {
        if !self.factored || x.is_empty() {
            return;
        }
        let size = x.len() / count;
        if self.is_turned {
            x.chunks_exact_mut(size).for_each(|x| self.turned.solve(x));
        } else if let Some(symbolic) = &self.symbolic {
            x.chunks_mut(AT_ONCE * size).for_each(|x| solve(symbolic, &self.values, &self.stack, x, x.len() / size));
        }
        x.chunks_exact_mut(size).for_each(|x| self.parts.correct(x));
    }
}

/// The number of right-hand sides per pass through the factor: one for each axis of a point.
const AT_ONCE: usize = 3;

fn solve(
    symbolic: &SymbolicCholesky<usize>,
    values: &[f64],
    stack: &Mutex<Option<MemBuffer>>,
    x: &mut [f64],
    count: usize,
) {
    let mut stack = stack.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(stack) = &mut *stack else { return };
    let rows = x.len() / count;
    let right = MatMut::from_column_major_slice_mut(x, rows, count);
    LltRef::new(symbolic, values).solve_in_place_with_conj(Conj::No, right, Par::Seq, MemStack::new(stack));
}
