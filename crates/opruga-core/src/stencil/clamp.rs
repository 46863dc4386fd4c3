//! Removes negative eigenvalues from matrices of stencils, eight at a time.

use super::kernel::Blocks;
use opruga_math::{Lane, Pack, Register, Simd, WIDTH, Work, symmetric};

/// The number of rows of the Hessians of most stencils, and that of a hexahedron, which is the largest.
const ROWS: [usize; 2] = [12, 24];

/// Removes the negative eigenvalues of symmetric block matrices, eight side by side.
pub fn clamp<const D: usize, const N: usize>(matrices: &mut [Blocks<D, N>]) {
    const { assert!(N * D <= ROWS[1], "a stencil has at most as many rows as the largest square") }
    if N * D <= ROWS[0] { clamp_in::<D, N, { ROWS[0] }>(matrices) } else { clamp_in::<D, N, { ROWS[1] }>(matrices) }
}

/// Does the same with square matrices of M rows; unused rows are zero and remain zero.
fn clamp_in<const D: usize, const N: usize, const M: usize>(matrices: &mut [Blocks<D, N>]) {
    let mut square = [[[0.0; WIDTH]; M]; M];
    for some in matrices.chunks_mut(WIDTH) {
        for p in 0..N * D {
            for q in 0..N * D {
                for (l, blocks) in some.iter().enumerate() {
                    let (one, other) = (blocks[p / D][q / D][p % D][q % D], blocks[q / D][p / D][q % D][p % D]);
                    square[p][q][l] = 0.5 * (one + other);
                }
            }
        }
        Simd::best().run(PositivePart { square: &mut square });
        for p in 0..N * D {
            for q in 0..N * D {
                for (l, blocks) in some.iter_mut().enumerate() {
                    blocks[p / D][q / D][p % D][q % D] = square[p][q][l];
                }
            }
        }
    }
}

/// The positive parts of eight matrices.
struct PositivePart<'a, const M: usize> {
    square: &'a mut [[[f64; WIDTH]; M]; M],
}
impl<const M: usize> Work for PositivePart<'_, M> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for part in 0..P::PARTS {
            let offset = part * P::Part::NUMBERS;
            let mut matrix = [[P::Part::zero(); M]; M];
            for p in 0..M {
                for q in 0..M {
                    matrix[p][q] = P::Part::load(&self.square[p][q][offset..]);
                }
            }
            let kept = symmetric::positive_part(&matrix);
            for p in 0..M {
                for q in 0..M {
                    kept[p][q].store(&mut self.square[p][q][offset..]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The clamped matrix of diag(2, −3) rotated by 30° is 2 n nᵀ.
    #[test]
    fn clamp_drops_the_negative_eigenvalue() {
        let (c, s) = (0.75f64.sqrt(), 0.5);
        let n = [c, s];
        let m = [-s, c];
        let entry = |i: usize, j: usize| 2.0 * n[i] * n[j] - 3.0 * m[i] * m[j];
        let mut blocks: Blocks<2, 1> = [[[[entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]]]];
        clamp(core::slice::from_mut(&mut blocks));
        for i in 0..2 {
            for j in 0..2 {
                assert!((blocks[0][0][i][j] - 2.0 * n[i] * n[j]).abs() < 1e-14);
            }
        }
    }
}
