//! The complete Cholesky factor with a fixed order of arithmetic, for matrices on which conjugate gradients converge slowly.

use crate::Indefinite;
use crate::matrix::BlockMatrix;
use crate::preconditioner::{IncompleteCholesky, Preconditioner};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// A factor L Lᵀ = A with all its blocks, with nodes in minimum-degree order.
///
/// This factor takes several times as long as [`crate::Cholesky`]. It gives the same bits on every processor, because the order is computed with
/// whole numbers and sums have a fixed order. Rank-one terms are omitted. For a nearly incompressible solid, conjugate gradients with an incomplete
/// factor need as many products as the matrix has rows; with this factor they need a few.
#[derive(Clone, Debug, Default)]
pub struct FilledCholesky<const D: usize> {
    generation: Option<u64>,
    /// The k-th node in the order; empty if there would be too many blocks.
    order: Vec<usize>,
    factor: IncompleteCholesky<D>,
}

/// The largest number of values in a factor: a hundred megabytes.
const MOST_NUMBERS: usize = 12_000_000;

/// No node.
const NONE: usize = usize::MAX;

impl<const D: usize> FilledCholesky<D> {
    /// Factors a matrix without its rank-one terms.
    ///
    /// # Errors
    /// [`Indefinite`] if it is not positive definite, or if the factor would have too many blocks.
    pub fn update(&mut self, matrix: &BlockMatrix<D>) -> Result<(), Indefinite> {
        if self.generation != Some(matrix.generation) || self.factor.rows() != matrix.rows() {
            *self = FilledCholesky { generation: Some(matrix.generation), ..FilledCholesky::default() };
            self.order = order(matrix).unwrap_or_default();
            if let Some(rows) = pattern(matrix, &self.order, MOST_NUMBERS / (D * D)) {
                self.factor.take(matrix, &self.order, &rows);
            } else {
                self.order.clear();
            }
        }
        if self.order.is_empty() {
            return Err(Indefinite);
        }
        self.factor.factor(matrix, 0.0)
    }
}

impl<const D: usize> Preconditioner for FilledCholesky<D> {
    fn apply(&self, r: &[f64], z: &mut [f64]) {
        let moved: Vec<f64> = self.order.iter().flat_map(|node| r[node * D..][..D].iter().copied()).collect();
        let mut found = vec![0.0; moved.len()];
        self.factor.apply(&moved, &mut found);
        for (node, found) in self.order.iter().zip(found.chunks_exact(D)) {
            z[node * D..][..D].copy_from_slice(found);
        }
    }
}

/// The approximate minimum-degree order of nodes; `None` if it cannot be found.
fn order<const D: usize>(matrix: &BlockMatrix<D>) -> Option<Vec<usize>> {
    let nodes = matrix.rows();
    let (mut start, mut above) = (vec![0], Vec::new());
    for node in 0..nodes {
        above.extend(matrix.row(node).map(|at| matrix.column[at] as usize).filter(|other| *other < node));
        start.push(above.len());
    }
    let mut stack = MemBuffer::try_new(amd::order_scratch::<usize>(nodes, above.len())).ok()?;
    let pattern = SymbolicSparseColMatRef::new_checked(nodes, nodes, &start, None, &above);
    let (mut order, mut inverse) = (vec![0; nodes], vec![0; nodes]);
    amd::order(&mut order, &mut inverse, pattern, amd::Control::default(), MemStack::new(&mut stack)).ok()?;
    Some(order)
}

/// The columns of each row of the factor below the diagonal, ascending, by the elimination tree (Liu 1990); `None` if there are
/// more than `most` in total, or if there is no order.
fn pattern<const D: usize>(matrix: &BlockMatrix<D>, order: &[usize], most: usize) -> Option<Vec<Vec<u32>>> {
    if order.len() != matrix.rows() {
        return None;
    }
    let mut rank = vec![0; order.len()];
    for (k, node) in order.iter().enumerate() {
        rank[*node] = k;
    }
    let (mut parent, mut seen) = (vec![NONE; order.len()], vec![NONE; order.len()]);
    let (mut rows, mut blocks) = (Vec::with_capacity(order.len()), 0);
    for (row, node) in order.iter().enumerate() {
        seen[row] = row;
        let mut columns = Vec::new();
        for at in matrix.row(*node) {
            let mut k = rank[matrix.column[at] as usize];
            while k < row && seen[k] != row {
                columns.push(k as u32);
                seen[k] = row;
                if parent[k] == NONE {
                    parent[k] = row;
                }
                k = parent[k];
            }
        }
        columns.sort_unstable();
        blocks += columns.len();
        if blocks > most {
            return None;
        }
        rows.push(columns);
    }
    Some(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Directions, conjugate_gradients};
    use opruga_core::potential::Sink;

    /// A lattice of springs in the plane, pinned at a corner, soft in one direction.
    fn lattice(count: usize, soft: f64) -> BlockMatrix<2> {
        let mut matrix = BlockMatrix::<2>::default();
        matrix.assemble(count * count, 0, |matrix| {
            matrix.add_diagonal(0, 1.0);
            for node in 0..count * count {
                for (other, block) in [
                    ((node % count + 1 < count).then_some(node + 1), [[1.0, 0.1], [0.1, soft]]),
                    ((node + count < count * count).then_some(node + count), [[soft, 0.0], [0.0, 1.0]]),
                ] {
                    let Some(other) = other else { continue };
                    matrix.block(node, node, block);
                    matrix.block(other, other, block);
                    matrix.block(node, other, block.map(|row| row.map(|x| -x)));
                    matrix.block(other, node, block.map(|row| row.map(|x| -x)));
                }
            }
        });
        matrix
    }

    /// The complete factor solves a system at once, although an incomplete factor needs many products for the same result.
    #[test]
    fn the_complete_factor_solves_at_once() {
        let matrix = lattice(20, 0.05);
        let wanted: Vec<f64> = (0..800).map(|k| f64::from(k * k % 17) - 8.0).collect();
        let mut right = vec![0.0; 800];
        matrix.multiply(&wanted, &mut right);
        let (mut incomplete, mut filled) = (IncompleteCholesky::<2>::default(), FilledCholesky::<2>::default());
        incomplete.update(&matrix).expect("positive definite");
        filled.update(&matrix).expect("positive definite");
        let solve = |by: &dyn Preconditioner| {
            let mut found = vec![0.0; 800];
            let multiply = |x: &[f64], y: &mut [f64]| matrix.multiply(x, y);
            let ended =
                conjugate_gradients(multiply, by, &right, &mut found, 1e-10, 10_000, &mut Directions::default());
            let error = found
                .iter()
                .zip(&wanted)
                .fold(0.0f64, |most, (a, b)| if (a - b).abs() > most { (a - b).abs() } else { most });
            (ended.expect("positive definite").iterations, error)
        };
        let ((many, rough), (few, fine)) = (solve(&incomplete), solve(&filled));
        assert!(few <= 2 && fine < 1e-7, "{few} products, {fine}");
        assert!(many > 20 && rough < 1e-5, "{many} products, {rough}");
        // A negative diagonal is refused.
        let mut indefinite = lattice(20, 0.05);
        indefinite.add_diagonal(210, -10.0);
        assert_eq!(FilledCholesky::<2>::default().update(&indefinite), Err(Indefinite));
    }
}
