//! Dense linear equations by elimination, eight columns at a time.

use opruga_math::{Pack, WIDTH, Work};

/// The number of rows from which a block is subtracted in one pass. Each number of the block is loaded once for all of these
/// rows. A pack fills two registers of AVX2, so four rows, the block and a factor fit into the sixteen registers of AVX2. Results
/// do not depend on this number (`solutions_satisfy_their_equations_at_every_size` covers remaining rows).
const LINES: usize = 4;

/// Adds `factor` times `from` to `to`, for whole packs.
pub(crate) struct Add<'a> {
    pub(crate) from: &'a [f64],
    pub(crate) factor: f64,
    pub(crate) to: &'a mut [f64],
}

impl Work for Add<'_> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        add_rows::<P>(self.from, self.factor, self.to);
    }
}

/// Adds `factor` times `from` to `to`. The loop runs over indices, because iterator adapters are compiled without the vector
/// instructions of their caller.
#[inline(always)]
fn add_rows<P: Pack>(from: &[f64], factor: f64, to: &mut [f64]) {
    let (factor, from, to) = (P::splat(factor), from.as_chunks::<WIDTH>().0, to.as_chunks_mut::<WIDTH>().0);
    let count = if from.len() < to.len() { from.len() } else { to.len() };
    let mut k = 0;
    while k < count {
        (P::load(&to[k]) + factor * P::load(&from[k])).store(&mut to[k]);
        k += 1;
    }
}

/// Solves the equations by elimination with the largest pivot of each column, and replaces the last column by the solution.
/// Returns whether there is a solution.
///
/// The products are subtracted from every entry in the order of columns, as if columns were eliminated one by one.
pub(crate) struct Eliminate<'a> {
    /// The rows of the equations. Each has `size` coefficients and the right-hand side, and takes `stride` numbers, a multiple of eight.
    pub(crate) matrix: &'a mut [f64],
    pub(crate) size: usize,
    pub(crate) stride: usize,
}

impl Work for Eliminate<'_> {
    type Output = bool;
    #[inline(always)]
    fn run<P: Pack>(self) -> bool {
        let Eliminate { matrix, size, stride } = self;
        let mut first = 0;
        while first < size {
            let end = if first + WIDTH < size { first + WIDTH } else { size };
            if !factor_columns(matrix, first..end, size, stride) {
                return false;
            }
            let (upper, lower) = matrix.split_at_mut(end * stride);
            let block = &mut upper[first * stride..];
            let next = first + WIDTH;
            if next < stride {
                finish_block::<P>(block, first, next, stride);
                take_away::<P>(block, lower, first, next, stride);
            }
            first = end;
        }
        let mut solution = vec![0.0; size];
        for k in (0..size).rev() {
            let line = &matrix[k * stride..][..=size];
            let mut x = line[size];
            for l in k + 1..size {
                x -= line[l] * solution[l];
            }
            solution[k] = x / line[k];
        }
        solution.iter().zip(matrix.chunks_exact_mut(stride)).for_each(|(x, line)| line[size] = *x);
        true
    }
}

/// Eliminates some columns in all rows below, within the pack of these columns; the factors of rows replace the entries that they
/// eliminate. Returns whether every column has a pivot.
#[inline(always)]
fn factor_columns(matrix: &mut [f64], columns: core::ops::Range<usize>, size: usize, stride: usize) -> bool {
    let first = columns.start;
    for k in columns {
        let mut pivot = k;
        for i in k + 1..size {
            if matrix[i * stride + k].abs() > matrix[pivot * stride + k].abs() {
                pivot = i;
            }
        }
        let largest = matrix[pivot * stride + k].abs();
        if largest == 0.0 || largest.is_nan() {
            return false;
        }
        let (upper, lower) = matrix.split_at_mut((k + 1) * stride);
        let row = &mut upper[k * stride..];
        if pivot > k {
            row.swap_with_slice(&mut lower[(pivot - k - 1) * stride..][..stride]);
        }
        let own: [f64; WIDTH] = core::array::from_fn(|c| row[first + c]);
        let k = k - first;
        for line in lower.chunks_exact_mut(stride).take(size) {
            let line = &mut line[first..first + WIDTH];
            let factor = line[k] / own[k];
            line[k] = factor;
            for c in k + 1..WIDTH {
                line[c] += -factor * own[c];
            }
        }
    }
    true
}

/// Subtracts the rows of a block from one another, right of the block.
#[inline(always)]
fn finish_block<P: Pack>(block: &mut [f64], first: usize, next: usize, stride: usize) {
    let rows = block.len() / stride;
    for k in 1..rows {
        let (above, own) = block.split_at_mut(k * stride);
        for l in 0..k {
            let factor = own[first + l];
            add_rows::<P>(&above[l * stride + next..(l + 1) * stride], -factor, &mut own[next..stride]);
        }
    }
}

/// Subtracts the rows of a block from all rows below, right of the block.
#[inline(always)]
fn take_away<P: Pack>(block: &[f64], lower: &mut [f64], first: usize, next: usize, stride: usize) {
    let (count, packs) = (lower.len() / stride, (stride - next) / WIDTH);
    let (block, lower) = (block.as_chunks::<WIDTH>().0, lower.as_chunks_mut::<WIDTH>().0);
    let (width, own, right) = (stride / WIDTH, first / WIDTH, next / WIDTH);
    let rows = block.len() / width;
    let mut i = 0;
    while i + LINES <= count {
        let lines = &mut lower[i * width..(i + LINES) * width];
        let mut factors = [[0.0; WIDTH]; LINES];
        let mut r = 0;
        while r < LINES {
            factors[r] = lines[r * width + own];
            r += 1;
        }
        let mut c = 0;
        while c < packs {
            let at = right + c;
            let mut sums = [P::splat(0.0); LINES];
            let mut r = 0;
            while r < LINES {
                sums[r] = P::load(&lines[r * width + at]);
                r += 1;
            }
            let mut l = 0;
            while l < rows {
                let row = P::load(&block[l * width + at]);
                let mut r = 0;
                while r < LINES {
                    sums[r] += P::splat(-factors[r][l]) * row;
                    r += 1;
                }
                l += 1;
            }
            let mut r = 0;
            while r < LINES {
                sums[r].store(&mut lines[r * width + at]);
                r += 1;
            }
            c += 1;
        }
        i += LINES;
    }
    while i < count {
        let line = &mut lower[i * width..(i + 1) * width];
        let factors = line[own];
        let mut l = 0;
        while l < rows {
            let from = block[l * width + right..(l + 1) * width].as_flattened();
            add_rows::<P>(from, -factors[l], line[right..].as_flattened_mut());
            l += 1;
        }
        i += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_math::{Lane, Simd};

    /// Random numbers between −1 and 1.
    fn numbers(count: usize) -> Vec<f64> {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    #[test]
    fn solutions_satisfy_their_equations_at_every_size() {
        for size in 1..70_usize {
            let stride = (size + 1).next_multiple_of(WIDTH);
            let of = numbers(size * stride);
            let mut matrix = of.clone();
            assert!(Simd::best().run(Eliminate { matrix: &mut matrix, size, stride }));
            for line in of.chunks_exact(stride) {
                let sum: f64 = line[..size].iter().zip(matrix.chunks_exact(stride)).map(|(a, x)| a * x[size]).sum();
                let largest = matrix.chunks_exact(stride).map(|x| x[size].abs()).fold(1.0, Lane::larger);
                assert!((sum - line[size]).abs() < 1e-11 * largest, "{size}: {sum} {}", line[size]);
            }
        }
    }

    #[test]
    fn columns_without_a_pivot_have_no_solution() {
        let (size, stride) = (12, 16);
        // All columns are equal.
        let mut matrix = vec![1.0; size * stride];
        assert!(!Simd::best().run(Eliminate { matrix: &mut matrix, size, stride }));
    }
}
