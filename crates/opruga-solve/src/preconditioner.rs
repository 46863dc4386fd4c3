//! Preconditioners, which make conjugate gradients fast: approximate inverses.

use crate::Indefinite;
use crate::blocks::{
    Block, inverse_of_lower, inverse_of_positive, lower, nodes, nodes_mut, product, subtract_product_transposed, times,
    transposed_times,
};
use crate::matrix::BlockMatrix;

/// A symmetric positive definite approximation of the inverse of a matrix.
pub trait Preconditioner {
    /// Computes z = B r.
    fn apply(&self, r: &[f64], z: &mut [f64]);
}

/// The inverse of the diagonal block of every node.
#[derive(Clone, Debug, Default)]
pub struct BlockJacobi<const D: usize> {
    inverse: Vec<Block<D>>,
}

impl<const D: usize> BlockJacobi<D> {
    /// Takes the diagonal blocks of a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] if a block is not positive definite.
    pub fn update<'a>(&mut self, blocks: impl ExactSizeIterator<Item = &'a Block<D>>) -> Result<(), Indefinite> {
        self.inverse.resize(blocks.len(), [[0.0; D]; D]);
        for (inverse, block) in self.inverse.iter_mut().zip(blocks) {
            *inverse = inverse_of_positive(block).ok_or(Indefinite)?;
        }
        Ok(())
    }
}

impl<const D: usize> Preconditioner for BlockJacobi<D> {
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        for ((z, r), inverse) in nodes_mut::<D>(z).iter_mut().zip(nodes::<D>(r)).zip(&self.inverse) {
            *z = times(inverse, r);
        }
    }
}

/// The incomplete Cholesky factor: L Lᵀ ≈ A, with blocks of L only where A has some.
///
/// Chains are factored exactly. If the factorisation breaks down, the diagonal is raised by a thousandth, and then by ten times
/// as much each time, until it succeeds (Manteuffel 1980).
///
/// # Source
/// Meijerink and van der Vorst 1977.
#[derive(Clone, Debug, Default)]
pub struct IncompleteCholesky<const D: usize> {
    generation: u64,
    start: Vec<u32>,
    column: Vec<u32>,
    /// The index in the matrix of each block below the diagonal, or [`FILL`]. Also the index of each block on the diagonal.
    source: Vec<u32>,
    diagonal: Vec<u32>,
    below: Vec<Block<D>>,
    /// The inverses of the diagonal blocks of L.
    inverse: Vec<Block<D>>,
}

/// No index in the matrix: a block that exists only in the factor.
const FILL: u32 = u32::MAX;

impl<const D: usize> IncompleteCholesky<D> {
    /// The number of rows of blocks.
    pub(crate) fn rows(&self) -> usize {
        self.diagonal.len()
    }
    /// Takes the pattern of a factor. Its k-th row belongs to the node `order[k]`, and has these columns below the diagonal.
    pub(crate) fn take(&mut self, matrix: &BlockMatrix<D>, order: &[usize], rows: &[Vec<u32>]) {
        (self.start, self.column, self.source) = (vec![0], Vec::new(), Vec::new());
        for (node, columns) in order.iter().zip(rows) {
            let there = matrix.row(*node);
            for k in columns {
                let other = order[*k as usize] as u32;
                let found = matrix.column[there.clone()].binary_search(&other);
                self.column.push(*k);
                self.source.push(found.map_or(FILL, |at| (there.start + at) as u32));
            }
            self.start.push(self.column.len() as u32);
        }
        self.diagonal = order.iter().map(|node| matrix.diagonal[*node]).collect();
        self.allocate();
    }
    fn allocate(&mut self) {
        self.below = vec![[[0.0; D]; D]; self.column.len()];
        self.inverse = vec![[[0.0; D]; D]; self.diagonal.len()];
    }

    /// Factors a matrix.
    ///
    /// # Errors
    /// [`Indefinite`] if the diagonal would have to be raised by more than itself.
    pub fn update(&mut self, matrix: &BlockMatrix<D>) -> Result<(), Indefinite> {
        if self.generation != matrix.generation || self.start.len() != matrix.rows() + 1 {
            self.take_pattern(matrix);
        }
        let mut raised = 0.0;
        while self.factor(matrix, raised).is_err() {
            raised = if raised == 0.0 { 1e-3 } else { 10.0 * raised };
            if raised > 1.0 {
                return Err(Indefinite);
            }
        }
        Ok(())
    }
    fn take_pattern(&mut self, matrix: &BlockMatrix<D>) {
        self.generation = matrix.generation;
        (self.start, self.column, self.source) = (vec![0], Vec::new(), Vec::new());
        for row in 0..matrix.rows() {
            for at in matrix.row(row) {
                if (matrix.column[at] as usize) < row {
                    self.column.push(matrix.column[at]);
                    self.source.push(at as u32);
                }
            }
            self.start.push(self.column.len() as u32);
        }
        self.diagonal.clone_from(&matrix.diagonal);
        self.allocate();
    }
    pub(crate) fn factor(&mut self, matrix: &BlockMatrix<D>, raised: f64) -> Result<(), Indefinite> {
        for row in 0..matrix.rows() {
            let (from, until) = (self.start[row] as usize, self.start[row + 1] as usize);
            let mut diagonal = matrix.values[self.diagonal[row] as usize];
            for d in 0..D {
                diagonal[d][d] += raised * diagonal[d][d];
            }
            for at in from..until {
                // L_rk = (A_rk − Σ L_rj L_kjᵀ) L_kk⁻ᵀ, summed over those j that both rows have.
                let k = self.column[at] as usize;
                let mut block = match self.source[at] {
                    FILL => [[0.0; D]; D],
                    source => matrix.values[source as usize],
                };
                let (mut p, mut q) = (from, self.start[k] as usize);
                let end = self.start[k + 1] as usize;
                while p < at && q < end {
                    match self.column[p].cmp(&self.column[q]) {
                        core::cmp::Ordering::Less => p += 1,
                        core::cmp::Ordering::Greater => q += 1,
                        core::cmp::Ordering::Equal => {
                            subtract_product_transposed(&mut block, &self.below[p], &self.below[q]);
                            p += 1;
                            q += 1;
                        }
                    }
                }
                let inverse = &self.inverse[k];
                let mut transposed = [[0.0; D]; D];
                for i in 0..D {
                    for j in 0..D {
                        transposed[i][j] = inverse[j][i];
                    }
                }
                let done = product(&block, &transposed);
                self.below[at] = done;
                subtract_product_transposed(&mut diagonal, &done, &done);
            }
            self.inverse[row] = inverse_of_lower(&lower(&diagonal).ok_or(Indefinite)?);
        }
        Ok(())
    }
}

impl<const D: usize> Preconditioner for IncompleteCholesky<D> {
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        let (r, z) = (nodes::<D>(r), nodes_mut::<D>(z));
        for row in 0..z.len() {
            let mut sum = r[row];
            for at in self.start[row] as usize..self.start[row + 1] as usize {
                let part = times(&self.below[at], &z[self.column[at] as usize]);
                for d in 0..D {
                    sum[d] -= part[d];
                }
            }
            z[row] = times(&self.inverse[row], &sum);
        }
        for row in (0..z.len()).rev() {
            z[row] = transposed_times(&self.inverse[row], &z[row]);
            let own = z[row];
            for at in self.start[row] as usize..self.start[row + 1] as usize {
                let part = transposed_times(&self.below[at], &own);
                let other = &mut z[self.column[at] as usize];
                for d in 0..D {
                    other[d] -= part[d];
                }
            }
        }
    }
}
