//! A matrix of blocks in a layout for vector instructions and threads.
//!
//! ```text
//! rows of about the same length ─→ packs of eight ─→ pieces of 32 packs, one thread each
//!                     k-th blocks of the eight rows side by side: D² packs of numbers
//! ```
//!
//! Rows are sorted by length within windows, so that there is little padding. The number of a node in this order is its *seat*.
//! Pieces and the order of their sums depend only on the matrix, so every number of threads gives the same bits.

mod gradients;

use crate::Indefinite;
use crate::blocks::{Block, constrained_block, inverse_of_positive, product};
use crate::matrix::BlockMatrix;
use opruga_core::threads::{each, each_block};
use opruga_math::{Column, ROW, Simd, WIDTH};

pub use gradients::Reached;

/// The number of packs of rows in a piece.
const PACKS: usize = 32;

/// The number of rows in a window that is sorted by length.
const WINDOW: usize = 512;

/// Marks lanes of a pack without a block.
const NONE: u32 = u32::MAX;

/// A matrix in packs, and conjugate gradients on it with the inverses of the diagonal blocks.
///
/// Its entries are rounded to single precision (rank-one terms and sums are not), because it is used to compute corrections,
/// after which the balance of forces is checked.
#[derive(Debug, Default)]
pub struct Packed<const D: usize> {
    generation: u64,
    /// The node of each seat; seats after the last node fill up a pack.
    node: Vec<u32>,
    /// The seat of each node.
    seat: Vec<u32>,
    pieces: Vec<Piece<D>>,
    /// The direction vectors by seat, [`ROW`] numbers each, in the layout from which products gather them.
    rows: Column,
    rank_one: Vec<Part<D>>,
    ranks: usize,
    /// The sum over the nodes of the mean diagonal of their blocks.
    stiffness: f64,
    /// The squared size of the right-hand side in the norm of the preconditioner.
    size: f64,
}

/// The rank-one term c·u uᵀ, by seat.
#[derive(Debug, Default)]
struct Part<const D: usize> {
    factor: f64,
    entries: Vec<(u32, [f64; D])>,
}

/// Some packs of rows: the matrix and the vectors of conjugate gradients, in packs as well.
#[derive(Debug, Default)]
struct Piece<const D: usize> {
    /// The start of the blocks of each pack, and the end of the last.
    start: Vec<u32>,
    /// Eight seats of columns for every eight blocks.
    column: Vec<u32>,
    /// The indices of the blocks in the matrix.
    source: Vec<u32>,
    /// The values of the blocks in single precision, so that only half as much memory has to be read. This precision is enough
    /// because [`Packed`] solves for corrections.
    values: Vec<f32>,
    /// The approximate inverse of the diagonal blocks: D² packs each, without the constrained directions.
    inverse: Column,
    residual: Column,
    improved: Column,
    direction: Column,
    product: Column,
    solution: Column,
    /// The part of a scalar product that comes from this piece.
    sum: f64,
    /// The number of its first pack.
    first: usize,
    /// The part of the stiffness that comes from this piece.
    stiffness: f64,
    /// Whether all of its diagonal blocks have an inverse.
    definite: bool,
}

impl<const D: usize> Packed<D> {
    /// Takes the values of a matrix, and its pattern if that is new.
    pub fn take(&mut self, matrix: &BlockMatrix<D>, threads: usize) {
        if self.generation != matrix.generation || self.seat.len() != matrix.rows() || self.pieces.is_empty() {
            self.take_pattern(matrix);
        }
        let values = &matrix.values;
        each(threads, &mut self.pieces, |piece| {
            for (sources, packs) in piece.source.chunks_exact(WIDTH).zip(piece.values.chunks_exact_mut(D * D * WIDTH)) {
                for (l, source) in sources.iter().enumerate().filter(|(_, source)| **source != NONE) {
                    let block = &values[*source as usize];
                    for i in 0..D {
                        for j in 0..D {
                            packs[(i * D + j) * WIDTH + l] = block[i][j] as f32;
                        }
                    }
                }
            }
        });
        let parts = matrix.rank_one();
        self.ranks = parts.len();
        if self.rank_one.len() < self.ranks {
            self.rank_one.resize_with(self.ranks, Part::default);
        }
        for (own, part) in self.rank_one.iter_mut().zip(parts) {
            own.factor = part.factor;
            own.entries.clear();
            own.entries.extend(part.entries.iter().map(|(node, u)| (self.seat[*node as usize], *u)));
        }
    }

    fn take_pattern(&mut self, matrix: &BlockMatrix<D>) {
        let nodes = matrix.rows();
        self.generation = matrix.generation;
        self.node = (0..nodes as u32).collect();
        for window in self.node.chunks_mut(WINDOW) {
            window.sort_by_key(|node| core::cmp::Reverse(matrix.row(*node as usize).len()));
        }
        self.seat = vec![0; nodes];
        for (seat, node) in self.node.iter().enumerate() {
            self.seat[*node as usize] = seat as u32;
        }
        let packs = nodes.div_ceil(WIDTH);
        self.rows = Column::zeros(packs * WIDTH * ROW);
        self.pieces.clear();
        for first in (0..packs).step_by(PACKS) {
            let count = PACKS.min(packs - first);
            let zeros = |times: usize| Column::zeros(count * times * WIDTH);
            let mut piece = Piece {
                first,
                start: vec![0],
                inverse: zeros(D * D),
                residual: zeros(D),
                improved: zeros(D),
                direction: zeros(D),
                product: zeros(D),
                solution: zeros(D),
                ..Piece::default()
            };
            for pack in first..first + count {
                let row = |lane: usize| self.node.get(pack * WIDTH + lane).map_or(0..0, |n| matrix.row(*n as usize));
                let longest = (0..WIDTH).map(|lane| row(lane).len()).max().unwrap_or(0);
                for k in 0..longest {
                    for lane in 0..WIDTH {
                        let at = row(lane).nth(k);
                        piece.source.push(at.map_or(NONE, |at| at as u32));
                        piece.column.push(at.map_or(0, |at| self.seat[matrix.column[at] as usize]));
                    }
                }
                piece.start.push((piece.source.len() / WIDTH) as u32);
            }
            piece.values = vec![0.0; piece.source.len() * D * D];
            self.pieces.push(piece);
        }
    }

    /// Removes the directions that are not free, and inverts the remaining diagonal blocks; `matrix` is the matrix whose values
    /// were taken.
    ///
    /// # Errors
    /// [`Indefinite`] if a block is not positive definite.
    pub fn hold(
        &mut self,
        threads: usize,
        matrix: &BlockMatrix<D>,
        free: &[bool],
        projectors: &[Block<D>],
    ) -> Result<(), Indefinite> {
        let nodes = &self.node;
        each(threads, &mut self.pieces, |piece| {
            (piece.stiffness, piece.definite) = (0.0, true);
            let seats = piece.first * WIDTH..((piece.first + piece.start.len() - 1) * WIDTH).min(nodes.len());
            for (k, node) in nodes[seats].iter().map(|node| *node as usize).enumerate() {
                let own = matrix.diagonal_block(node);
                for d in 0..D {
                    piece.stiffness += own[d][d].abs() / D as f64;
                }
                let projector = &projectors[node];
                let inverse = if free[node] {
                    inverse_of_positive(own)
                } else {
                    let inverse = inverse_of_positive(&constrained_block(own, projector));
                    inverse.map(|inverse| product(projector, &product(&inverse, projector)))
                };
                let Some(inverse) = inverse else {
                    piece.definite = false;
                    return;
                };
                let to = &mut piece.inverse[(k / WIDTH) * D * D * WIDTH..];
                for i in 0..D {
                    for j in 0..D {
                        to[(i * D + j) * WIDTH + k % WIDTH] = inverse[i][j];
                    }
                }
            }
        });
        self.stiffness = self.pieces.iter().map(|piece| piece.stiffness).sum();
        if self.pieces.iter().all(|piece| piece.definite) { Ok(()) } else { Err(Indefinite) }
    }

    /// The sum over the nodes of the mean diagonal of their blocks, including constrained directions.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Computes y = A x with the rounded entries of the whole matrix.
    pub fn multiply(&mut self, simd: Simd, threads: usize, x: &[f64], y: &mut [f64]) {
        let nodes = &self.node;
        each(threads, &mut self.pieces, |piece| load::<D>(nodes, piece.first, x, &mut piece.direction));
        self.spread(threads);
        self.multiply_direction(simd, threads);
        self.unload(threads, y, |piece| &piece.product);
    }

    /// Copies packs into a vector of the nodes.
    fn unload(&self, threads: usize, to: &mut [f64], from: impl Fn(&Piece<D>) -> &Column + Sync) {
        each_block(threads, D, [to], |first, [to]| {
            for (seat, to) in self.seat[first / D..].iter().zip(to.as_chunks_mut::<D>().0) {
                let (pack, lane) = (*seat as usize / WIDTH, *seat as usize % WIDTH);
                let column = from(&self.pieces[pack / PACKS]);
                for d in 0..D {
                    to[d] = column[((pack % PACKS) * D + d) * WIDTH + lane];
                }
            }
        });
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let of_piece = |p: &Piece<D>| {
            let vectors = [&p.residual, &p.improved, &p.direction, &p.product, &p.solution, &p.inverse];
            4 * (p.column.capacity() + p.source.capacity() + p.start.capacity() + p.values.capacity())
                + vectors.into_iter().map(Column::heap_bytes).sum::<usize>()
        };
        self.pieces.iter().map(of_piece).sum::<usize>() + self.rows.heap_bytes() + 8 * self.seat.capacity()
    }
}

/// Copies a vector of the nodes into the packs of the piece that begins with `first`.
fn load<const D: usize>(nodes: &[u32], first: usize, from: &[f64], to: &mut Column) {
    for (nodes, to) in nodes[first * WIDTH..].chunks(WIDTH).zip(to.chunks_exact_mut(D * WIDTH)) {
        for (lane, node) in nodes.iter().enumerate() {
            for d in 0..D {
                to[d * WIDTH + lane] = from[*node as usize * D + d];
            }
        }
    }
}
