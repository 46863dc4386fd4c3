//! Adds matrices of stencils to a matrix.
//!
//! Stencils are side by side in the lanes, while a block of the matrix is D² consecutive numbers. Transposing eight blocks at a
//! time in registers would take a quarter longer than reading them number by number.

use crate::blocks::Block;
use opruga_core::potential::StencilPack;
use opruga_math::{Pack, Simd, WIDTH, Work};

/// Whether packs of stencils with this many nodes are supported here.
pub(crate) fn is_known(nodes: usize) -> bool {
    matches!(nodes, 3 | 4 | 6 | 8 | 10)
}

/// The blocks of some rows. Blocks of other rows are skipped.
pub(crate) struct Landing<'a, const D: usize> {
    pub(crate) values: &'a mut [Block<D>],
    /// The index of the first block in the matrix.
    pub(crate) first: usize,
    pub(crate) factor: f64,
}

impl<const D: usize> Landing<'_, D> {
    /// Adds the blocks of a pack of stencils at the given indices, `[lane][a][b]`.
    pub(crate) fn add(&mut self, simd: Simd, pack: &StencilPack<'_>, slots: &[u32]) {
        let Landing { values, first, factor } = self;
        let landing = Landing { values, first: *first, factor: *factor };
        match pack.nodes {
            3 => simd.run(Add::<D, 3> { landing, pack, slots }),
            4 => simd.run(Add::<D, 4> { landing, pack, slots }),
            6 => simd.run(Add::<D, 6> { landing, pack, slots }),
            8 => simd.run(Add::<D, 8> { landing, pack, slots }),
            10 => simd.run(Add::<D, 10> { landing, pack, slots }),
            _ => unreachable!("`is_known` has told"),
        }
    }
}

struct Add<'a, 'b, const D: usize, const N: usize> {
    landing: Landing<'a, D>,
    pack: &'b StencilPack<'b>,
    slots: &'b [u32],
}

impl<const D: usize, const N: usize> Work for Add<'_, '_, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Add { landing: Landing { values, first, factor }, pack, slots } = self;
        let blocks = &pack.blocks[..N * N * D * D * WIDTH];
        // Adds one stencil after the other, in the same way as separate blocks.
        for (lane, slots) in slots.as_chunks::<N>().0.chunks_exact(N).enumerate() {
            for a in 0..N {
                for b in a..N {
                    let stored = &blocks[(a * N + b) * D * D * WIDTH..][..D * D * WIDTH];
                    let mut block = [[0.0; D]; D];
                    for i in 0..D {
                        for j in 0..D {
                            block[i][j] = factor * stored[(i * D + j) * WIDTH + lane % WIDTH];
                        }
                    }
                    if let Some(upper) = values.get_mut((slots[a][b] as usize).wrapping_sub(first)) {
                        for i in 0..D {
                            for j in 0..D {
                                upper[i][j] += block[i][j];
                            }
                        }
                    }
                    if a != b
                        && let Some(lower) = values.get_mut((slots[b][a] as usize).wrapping_sub(first))
                    {
                        for i in 0..D {
                            for j in 0..D {
                                lower[i][j] += block[j][i];
                            }
                        }
                    }
                }
            }
        }
    }
}
