//! A matrix of blocks as the columns of numbers that faer takes.

use crate::matrix::BlockMatrix;

/// Compressed columns of numbers. The matrix is symmetric: its rows of blocks are its columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scalars {
    pub(crate) start: Vec<usize>,
    pub(crate) row: Vec<usize>,
    pub(crate) values: Vec<f64>,
    /// What identifies the pattern: the number of its changes in the matrix, and the number of rows.
    pattern: (u64, usize),
}

impl Scalars {
    /// Takes a matrix, the whole or its lower triangle; returns whether the pattern is new.
    pub(crate) fn take<const D: usize>(&mut self, matrix: &BlockMatrix<D>, lower: bool) -> bool {
        let pattern = (matrix.generation, matrix.rows());
        let anew = self.pattern != pattern || self.start.is_empty();
        if anew {
            self.pattern = pattern;
            (self.start, self.row) = (vec![0], Vec::new());
        }
        self.values.clear();
        for node in 0..matrix.rows() {
            for i in 0..D {
                let column = node * D + i;
                for at in matrix.row(node) {
                    for j in 0..D {
                        let row = matrix.column[at] as usize * D + j;
                        if lower && row < column {
                            continue;
                        }
                        if anew {
                            self.row.push(row);
                        }
                        self.values.push(matrix.values[at][i][j]);
                    }
                }
                if anew {
                    self.start.push(self.row.len());
                }
            }
        }
        anew
    }
    pub(crate) fn size(&self) -> usize {
        self.start.len().saturating_sub(1)
    }
}
