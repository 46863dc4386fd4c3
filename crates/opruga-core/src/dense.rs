//! Dense symmetric matrices, of which one half is stored.
//!
//! A matrix of 6000 rows does not fit into any cache, so a product takes as long as reading its numbers from memory. Only one of two equal entries is
//! stored; a product reads it once and uses it twice. The order of sums is the same for every set of instructions.

use core::fmt;
use opruga_math::{Column, Pack, Simd, WIDTH, Work};

/// The number of rows and columns of a tile.
pub const SIDE: usize = 32;

/// The number of packs in a row of a tile.
const PACKS: usize = SIDE / WIDTH;

/// A symmetric matrix in tiles of 32 rows and columns. Only the tiles below and on the diagonal are stored, one row of tiles
/// after the other.
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
    /// Makes a matrix from the entries on and below the diagonal.
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
    /// The number of rows.
    pub fn size(&self) -> usize {
        self.size
    }
    /// The number of rows filled up to whole tiles: the length of the vectors in products.
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
    /// y = A x for consecutive vectors of [`Dense::padded`] numbers each. Every number of the matrix is read from memory once for
    /// eight vectors.
    pub fn multiply(&self, simd: Simd, x: &[f64], y: &mut [f64]) {
        let length = self.padded();
        if length == 0 {
            return;
        }
        // With up to four vectors, half of the eight lanes would be empty.
        match x.len() / length {
            1 => return simd.run(Product::<1> { matrix: self, x, y }),
            2 => return simd.run(Product::<2> { matrix: self, x, y }),
            3 => return simd.run(Product::<3> { matrix: self, x, y }),
            4 => return simd.run(Product::<4> { matrix: self, x, y }),
            _ => {}
        }
        let (mut side_by_side, mut products) = (Column::zeros(WIDTH * length), Column::zeros(WIDTH * length));
        for (x, y) in x.chunks(WIDTH * length).zip(y.chunks_mut(WIDTH * length)) {
            side_by_side.fill(0.0);
            products.fill(0.0);
            for (n, x) in x.chunks_exact(length).enumerate() {
                side_by_side.chunks_exact_mut(WIDTH).zip(x).for_each(|(to, x)| to[n] = *x);
            }
            simd.run(Products { matrix: self, x: &side_by_side, y: &mut products });
            for (n, y) in y.chunks_exact_mut(length).enumerate() {
                products.chunks_exact(WIDTH).zip(y).for_each(|(from, y)| *y = from[n]);
            }
        }
    }
    fn tile(&self, row: usize, column: usize) -> &[f64] {
        let first = (row * (row + 1) / 2 + column) * SIDE * SIDE;
        &self.numbers[first..first + SIDE * SIDE]
    }
}

/// The offset of an entry on or below the diagonal of tiles.
#[inline(always)]
fn at(row: usize, column: usize) -> usize {
    let (i, j) = (row / SIDE, column / SIDE);
    (i * (i + 1) / 2 + j) * SIDE * SIDE + (row % SIDE) * SIDE + column % SIDE
}

/// The product with few vectors. The lanes hold neighbouring columns of the matrix.
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
            // Every lane keeps its part of each row sum until the row of tiles is done.
            let mut sums = [[P::zero(); N]; SIDE];
            for j in 0..=i {
                let tile = matrix.tile(i, j);
                along_rows(tile, core::array::from_fn(|n| &x[n * length + j * SIDE..][..SIDE]), &mut sums);
                if i != j {
                    let own: [&[f64]; N] = core::array::from_fn(|n| &x[n * length + i * SIDE..][..SIDE]);
                    let columns = along_columns(tile, own);
                    for n in 0..N {
                        let out = &mut y[n * length + j * SIDE..][..SIDE];
                        for k in 0..PACKS {
                            (P::load(&out[k * WIDTH..]) + columns[n][k]).store(&mut out[k * WIDTH..]);
                        }
                    }
                }
            }
            for n in 0..N {
                for (out, sum) in y[n * length + i * SIDE..][..SIDE].iter_mut().zip(&sums) {
                    *out += sum[n].sum();
                }
            }
        }
    }
}

/// The packs of a row of a tile. This is a loop, because a closure is compiled without the vector instructions of its caller.
/// The loads of a closure would therefore be function calls.
#[inline(always)]
fn packs_of<P: Pack>(row: &[f64]) -> [P; PACKS] {
    let mut out = [P::zero(); PACKS];
    for (k, out) in out.iter_mut().enumerate() {
        *out = P::load(&row[k * WIDTH..]);
    }
    out
}

/// Adds T x, for a tile T, to sums that are still distributed over lanes.
#[inline(always)]
fn along_rows<P: Pack, const N: usize>(tile: &[f64], x: [&[f64]; N], sums: &mut [[P; N]; SIDE]) {
    let mut packs = [[P::zero(); PACKS]; N];
    for n in 0..N {
        packs[n] = packs_of(x[n]);
    }
    for (row, sums) in tile.chunks_exact(SIDE).zip(sums) {
        let row = packs_of::<P>(row);
        for n in 0..N {
            let mut own = sums[n];
            for k in 0..PACKS {
                own += row[k] * packs[n][k];
            }
            sums[n] = own;
        }
    }
}

/// Returns Tᵀ x for a tile T.
#[inline(always)]
fn along_columns<P: Pack, const N: usize>(tile: &[f64], x: [&[f64]; N]) -> [[P; PACKS]; N] {
    let mut packs = [[P::zero(); PACKS]; N];
    for (number, row) in tile.chunks_exact(SIDE).enumerate() {
        let row = packs_of::<P>(row);
        for n in 0..N {
            let x = P::splat(x[n][number]);
            for k in 0..PACKS {
                packs[n][k] += row[k] * x;
            }
        }
    }
    packs
}

/// The product with up to eight vectors. Each lane belongs to one vector, and the numbers of the vectors are side by side.
struct Products<'a> {
    matrix: &'a Dense,
    x: &'a [f64],
    y: &'a mut [f64],
}

/// A product sums this many rows of a tile together, so that their x and their sums stay in registers. With AVX2, a product with two rows at a time
/// takes the same time, and one with eight takes a third longer.
const ROWS: usize = 4;

impl Work for Products<'_> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        const EIGHT_SIDES: usize = SIDE * WIDTH;
        let Products { matrix, x, y } = self;
        for i in 0..matrix.padded() / SIDE {
            let own = &x[i * EIGHT_SIDES..][..EIGHT_SIDES];
            for j in 0..=i {
                let (before, rest) = y.split_at_mut(i * EIGHT_SIDES);
                let rows = &mut rest[..EIGHT_SIDES];
                let other = &x[j * EIGHT_SIDES..][..EIGHT_SIDES];
                let tile = matrix.tile(i, j);
                if i == j {
                    once::<P>(tile, other, rows);
                } else {
                    twice::<P>(tile, own, other, rows, &mut before[j * EIGHT_SIDES..][..EIGHT_SIDES]);
                }
            }
        }
    }
}

/// Adds T x for a tile on the diagonal.
#[inline(always)]
fn once<P: Pack>(tile: &[f64], x: &[f64], y: &mut [f64]) {
    for (row, y) in tile.chunks_exact(SIDE).zip(y.chunks_exact_mut(WIDTH)) {
        let mut sum = P::load(y);
        for (entry, x) in row.iter().zip(x.chunks_exact(WIDTH)) {
            sum += P::splat(*entry) * P::load(x);
        }
        sum.store(y);
    }
}

/// Adds T x to the rows, where x belongs to the columns. Adds Tᵀ x to the columns, where x belongs to the rows.
#[inline(always)]
fn twice<P: Pack>(tile: &[f64], of_rows: &[f64], of_columns: &[f64], rows: &mut [f64], columns: &mut [f64]) {
    const BLOCK: usize = ROWS * WIDTH;
    for (entries, (x, y)) in
        tile.chunks_exact(ROWS * SIDE).zip(of_rows.chunks_exact(BLOCK).zip(rows.chunks_exact_mut(BLOCK)))
    {
        let (mut own, mut sums) = ([P::zero(); ROWS], [P::zero(); ROWS]);
        for r in 0..ROWS {
            (own[r], sums[r]) = (P::load(&x[r * WIDTH..]), P::load(&y[r * WIDTH..]));
        }
        for (k, (x, y)) in of_columns.chunks_exact(WIDTH).zip(columns.chunks_exact_mut(WIDTH)).enumerate() {
            let other = P::load(x);
            let mut column = P::load(y);
            for r in 0..ROWS {
                let entry = P::splat(entries[r * SIDE + k]);
                sums[r] += entry * other;
                column += entry * own[r];
            }
            column.store(y);
        }
        for r in 0..ROWS {
            sums[r].store(&mut y[r * WIDTH..]);
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
            let mut x = vec![0.0; 7 * length];
            for n in 0..7 {
                for k in 0..size {
                    x[n * length + k] = ((k * 7 + n * 5) % 13) as f64 - 6.0;
                }
            }
            let mut first = Vec::new();
            for simd in Simd::available() {
                let mut y = vec![1.0; 7 * length];
                matrix.multiply(simd, &x, &mut y);
                for n in 0..7 {
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
}
