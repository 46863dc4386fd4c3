//! Dense symmetric matrices, of which one half is kept.
//!
//! A matrix of 6000 rows does not fit into any cache, so a product takes as long as its numbers take to come from memory. Of two entries
//! that are equal one is kept, and each that comes is used twice. The order of sums is the same for every set of instructions.

use core::fmt;
use opruga_math::{Column, Pack, Simd, WIDTH, Work};

/// Rows and columns of a tile.
pub const SIDE: usize = 32;

/// Packs in a row of a tile.
const PACKS: usize = SIDE / WIDTH;

/// A symmetric matrix, or a triangular one, in tiles of 32 rows and columns: those below and on the diagonal, row by row of tiles.
///
/// Rows are filled up to whole tiles, with zeros.
#[derive(Clone, PartialEq)]
pub struct Dense {
    size: usize,
    numbers: Column,
}

impl fmt::Debug for Dense {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Dense").field("size", &self.size).finish_non_exhaustive()
    }
}

impl Dense {
    /// Takes the entries on and below the diagonal.
    pub fn of_lower(size: usize, entry: impl Fn(usize, usize) -> f64) -> Dense {
        let tiles = size.div_ceil(SIDE);
        let mut numbers = Column::zeros(tiles * (tiles + 1) / 2 * SIDE * SIDE);
        for row in 0..size {
            for column in 0..=row {
                let value = entry(row, column);
                numbers[at(row, column)] = value;
                if row / SIDE == column / SIDE {
                    numbers[at(column, row)] = value;
                }
            }
        }
        Dense { size, numbers }
    }
    /// Rows.
    pub fn size(&self) -> usize {
        self.size
    }
    /// Rows filled up to whole tiles: the length of vectors that it is multiplied with.
    pub fn padded(&self) -> usize {
        self.size.next_multiple_of(SIDE)
    }
    /// An entry, on either side of the diagonal.
    #[inline(always)]
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.numbers[if row >= column { at(row, column) } else { at(column, row) }]
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        self.numbers.heap_bytes()
    }
    /// y = A x of a symmetric matrix, for vectors one after the other of [`Dense::padded`] numbers each.
    pub fn multiply(&self, simd: Simd, x: &[f64], y: &mut [f64]) {
        let length = self.padded();
        let (mut x, mut y) = (x, y);
        if x.len() == 3 * length && length > 0 {
            return simd.run(Product::<3> { matrix: self, x, y });
        }
        while x.len() >= 2 * length && length > 0 {
            simd.run(Product::<2> { matrix: self, x: &x[..2 * length], y: &mut y[..2 * length] });
            (x, y) = (&x[2 * length..], &mut y[2 * length..]);
        }
        if x.len() >= length && length > 0 {
            simd.run(Product::<1> { matrix: self, x: &x[..length], y: &mut y[..length] });
        }
    }
    /// Replaces b by x with L Lᵀ x = b, where the matrix is L, the lower triangle with its diagonal; for vectors one after the other.
    pub fn solve_as_factor(&self, simd: Simd, b: &mut [f64]) {
        simd.run(Forward { matrix: self, b });
        simd.run(Backward { matrix: self, b });
    }
    fn tile(&self, row: usize, column: usize) -> &[f64] {
        let first = (row * (row + 1) / 2 + column) * SIDE * SIDE;
        &self.numbers[first..first + SIDE * SIDE]
    }
}

/// Where an entry on or below the diagonal of tiles lies.
#[inline(always)]
fn at(row: usize, column: usize) -> usize {
    let (i, j) = (row / SIDE, column / SIDE);
    (i * (i + 1) / 2 + j) * SIDE * SIDE + (row % SIDE) * SIDE + column % SIDE
}

/// The product with N vectors: every number is read once.
struct Product<'a, const N: usize> {
    matrix: &'a Dense,
    x: &'a [f64],
    y: &'a mut [f64],
}

impl<const N: usize> Work for Product<'_, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Product { matrix, x, y } = self;
        let length = matrix.padded();
        y.fill(0.0);
        for i in 0..length / SIDE {
            // A part of each row's sum stays in each lane until the row of tiles is done.
            let mut sums = [[P::zero(); SIDE]; N];
            for j in 0..=i {
                let tile = matrix.tile(i, j);
                for n in 0..N {
                    let (own, out) = (&x[n * length..][..length], &mut y[n * length..][..length]);
                    along_rows(tile, &own[j * SIDE..], &mut sums[n]);
                    if i != j {
                        along_columns(tile, &own[i * SIDE..], &mut out[j * SIDE..], P::one());
                    }
                }
            }
            for n in 0..N {
                for (out, sum) in y[n * length + i * SIDE..][..SIDE].iter_mut().zip(&sums[n]) {
                    *out += sum.sum();
                }
            }
        }
    }
}

/// Adds T x to sums that are still spread over lanes.
#[inline(always)]
fn along_rows<P: Pack>(tile: &[f64], x: &[f64], sums: &mut [P; SIDE]) {
    let mut packs = [P::zero(); PACKS];
    for (k, pack) in packs.iter_mut().enumerate() {
        *pack = P::load(&x[k * WIDTH..]);
    }
    for (row, sum) in tile.chunks_exact(SIDE).zip(sums) {
        let mut own = *sum;
        for k in 0..PACKS {
            own += P::load(&row[k * WIDTH..]) * packs[k];
        }
        *sum = own;
    }
}

/// Adds s Tᵀ x to y.
#[inline(always)]
fn along_columns<P: Pack>(tile: &[f64], x: &[f64], y: &mut [f64], s: P) {
    let mut packs = [P::zero(); PACKS];
    for (row, x) in tile.chunks_exact(SIDE).zip(x) {
        let x = P::splat(*x);
        for k in 0..PACKS {
            packs[k] += P::load(&row[k * WIDTH..]) * x;
        }
    }
    for (k, pack) in packs.iter().enumerate() {
        (P::load(&y[k * WIDTH..]) + s * *pack).store(&mut y[k * WIDTH..]);
    }
}

struct Forward<'a> {
    matrix: &'a Dense,
    b: &'a mut [f64],
}

impl Work for Forward<'_> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Forward { matrix, b } = self;
        let length = matrix.padded();
        for i in 0..length / SIDE {
            // A row of tiles serves all vectors while it is near.
            for b in b.chunks_exact_mut(length) {
                let mut sums = [P::zero(); SIDE];
                for j in 0..i {
                    along_rows(matrix.tile(i, j), &b[j * SIDE..], &mut sums);
                }
                let tile = matrix.tile(i, i);
                for row in 0..SIDE {
                    let mut value = b[i * SIDE + row] - sums[row].sum();
                    for column in 0..row {
                        value -= tile[row * SIDE + column] * b[i * SIDE + column];
                    }
                    let pivot = tile[row * SIDE + row];
                    // Rows that fill up the last tile have none.
                    b[i * SIDE + row] = if pivot == 0.0 { 0.0 } else { value / pivot };
                }
            }
        }
    }
}

struct Backward<'a> {
    matrix: &'a Dense,
    b: &'a mut [f64],
}

impl Work for Backward<'_> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Backward { matrix, b } = self;
        let length = matrix.padded();
        for i in (0..length / SIDE).rev() {
            for b in b.chunks_exact_mut(length) {
                let tile = matrix.tile(i, i);
                for row in (0..SIDE).rev() {
                    let mut value = b[i * SIDE + row];
                    for other in row + 1..SIDE {
                        value -= tile[other * SIDE + row] * b[i * SIDE + other];
                    }
                    let pivot = tile[row * SIDE + row];
                    b[i * SIDE + row] = if pivot == 0.0 { 0.0 } else { value / pivot };
                }
                let (before, own) = b.split_at_mut(i * SIDE);
                for j in 0..i {
                    along_columns(matrix.tile(i, j), &own[..SIDE], &mut before[j * SIDE..], -P::one());
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(row: usize, column: usize) -> f64 {
        let (i, j) = if row >= column { (row, column) } else { (column, row) };
        ((i * 37 + j * 11) % 23) as f64 - 11.0 + if i == j { 400.0 } else { 0.0 }
    }

    #[test]
    fn products_are_those_of_all_entries_for_every_set_of_instructions() {
        for size in [1, 31, 32, 70, 129] {
            let matrix = Dense::of_lower(size, entry);
            let length = matrix.padded();
            let mut x = vec![0.0; 3 * length];
            for n in 0..3 {
                for k in 0..size {
                    x[n * length + k] = ((k * 7 + n * 5) % 13) as f64 - 6.0;
                }
            }
            let mut first = Vec::new();
            for simd in Simd::available() {
                let mut y = vec![1.0; 3 * length];
                matrix.multiply(simd, &x, &mut y);
                for n in 0..3 {
                    for row in 0..size {
                        let expected: f64 = (0..size).map(|k| entry(row, k) * x[n * length + k]).sum();
                        assert!((y[n * length + row] - expected).abs() < 1e-9);
                    }
                }
                let bits: Vec<u64> = y.iter().map(|y| y.to_bits()).collect();
                if first.is_empty() {
                    first.clone_from(&bits);
                }
                assert_eq!(bits, first);
            }
        }
    }

    #[test]
    fn a_factor_solves() {
        for size in [1, 5, 33, 100] {
            // Of the matrix L Lᵀ with a known L.
            let lower = |i: usize, j: usize| if j > i { 0.0 } else { entry(i, j) / 400.0 };
            let factor = Dense::of_lower(size, lower);
            let x: Vec<f64> = (0..size).map(|k| (k % 7) as f64 - 3.0).collect();
            let mut b = vec![0.0; factor.padded()];
            for i in 0..size {
                let along = |k: usize| (0..size).map(|j| lower(j, k) * x[j]).sum::<f64>();
                b[i] = (0..size).map(|k| lower(i, k) * along(k)).sum();
            }
            for simd in Simd::available() {
                let mut solved = b.clone();
                factor.solve_as_factor(simd, &mut solved);
                assert!(x.iter().zip(&solved).all(|(x, s)| (x - s).abs() < 1e-9));
            }
        }
    }
}
