//! Where matrices of stencils land in a matrix.
//!
//! Stencils come side by side in the lanes, and a block of the matrix is D² numbers in a row: eight blocks at a time are
//! turned from the one order into the other in registers, and added as a whole.

use crate::blocks::Block;
use opruga_core::potential::StencilPack;
use opruga_math::{Column, Lane, Pack, ROW, Register, Simd, WIDTH, Work};

/// Whether packs of stencils of so many nodes are known here.
pub(crate) fn is_known(nodes: usize) -> bool {
    matches!(nodes, 3 | 4 | 6 | 8 | 10)
}

/// The blocks of some rows; what belongs to other rows is left to others.
pub(crate) struct Landing<'a, const D: usize> {
    pub(crate) values: &'a mut [Block<D>],
    /// The place of the first of them in the matrix.
    pub(crate) first: usize,
    pub(crate) factor: f64,
    /// Room for the blocks of eight stencils.
    pub(crate) turned: &'a mut Column,
}

impl<const D: usize> Landing<'_, D> {
    /// Adds the blocks of a pack of stencils at the places that are known, `[lane][a][b]`.
    pub(crate) fn add(&mut self, simd: Simd, pack: &StencilPack<'_>, slots: &[u32]) {
        self.turned.grow(pack.nodes * pack.nodes * LONG * WIDTH * ROW);
        let Landing { values, first, factor, turned } = self;
        let landing = Landing { values, first: *first, factor: *factor, turned };
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

/// Rows of numbers that hold a block of up to nine.
const LONG: usize = 3;

impl<const D: usize, const N: usize> Add<'_, '_, D, N> {
    /// Turns K_ab, or as K_ba its transpose: [`LONG`] rows of [`ROW`] numbers for each of the eight stencils.
    #[inline(always)]
    fn turn<P: Pack>(&mut self, a: usize, b: usize, transposed: bool) {
        let (factor, size) = (P::Part::splat(self.landing.factor), D * D * WIDTH);
        let stored = &self.pack.blocks[(a * N + b) * size..(a * N + b) * size + size];
        let at = if transposed { b * N + a } else { a * N + b } * LONG * WIDTH * ROW;
        let turned = &mut self.landing.turned[at..at + LONG * WIDTH * ROW];
        for (row, turned) in turned.chunks_exact_mut(WIDTH * ROW).enumerate().take((D * D).div_ceil(ROW)) {
            for part in 0..P::PARTS {
                let mut columns = [P::Part::zero(); ROW];
                for k in 0..ROW {
                    let entry = row * ROW + k;
                    if entry < D * D {
                        let from = if transposed { entry % D * D + entry / D } else { entry };
                        columns[k] = factor * P::Part::load(&stored[from * WIDTH + part * P::Part::NUMBERS..]);
                    }
                }
                P::Part::store_rows(columns, &mut turned[part * P::Part::NUMBERS * ROW..]);
            }
        }
    }
}

impl<const D: usize, const N: usize> Work for Add<'_, '_, D, N> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        for a in 0..N {
            for b in a..N {
                self.turn::<P>(a, b, false);
                if a != b {
                    self.turn::<P>(a, b, true);
                }
            }
        }
        let Landing { values, first, turned, .. } = self.landing;
        // Stencil by stencil, as blocks that come by themselves.
        for (lane, slots) in self.slots.chunks_exact(N * N).enumerate() {
            for (at, slot) in slots.iter().enumerate() {
                if let Some(block) = values.get_mut((*slot as usize).wrapping_sub(first)) {
                    for (row, numbers) in block.as_flattened_mut().chunks_mut(ROW).enumerate() {
                        let own = &turned[((at * LONG + row) * WIDTH + lane % WIDTH) * ROW..][..ROW];
                        for (number, own) in numbers.iter_mut().zip(own) {
                            *number += own;
                        }
                    }
                }
            }
        }
    }
}
