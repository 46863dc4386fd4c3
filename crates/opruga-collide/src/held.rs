//! Which nodes of a tile are held back, and by what.

use crate::entries::numbers;
use opruga_core::tile::TILE;
use opruga_math::{Register, WIDTH};

/// What a node meets in a look at a collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meets {
    /// A surface on which it lay at the beginning of the step.
    WhatItLiesOn,
    /// Whatever it is in.
    Everything,
}

/// Which nodes of a tile have been held back in this step: a bit each.
pub(crate) struct Held(pub(crate) [u8; TILE / WIDTH]);

impl Held {
    /// The nodes from `k` and so many more on, until the end of the pack at `k`: 1 if held, else 0.
    #[inline(always)]
    pub(crate) fn numbers(&self, k: usize, offset: usize) -> [f64; WIDTH] {
        let bits = self.0.get(k / WIDTH).copied().unwrap_or(0) >> offset;
        let mut out = [0.0; WIDTH];
        for l in 0..WIDTH {
            out[l] = f64::from(bits >> l & 1);
        }
        out
    }
    /// Notes the nodes, from `k` and so many more on, for which `hit` is above 0.
    #[inline(always)]
    pub(crate) fn note<R: Register>(&mut self, k: usize, offset: usize, hit: R) {
        let hit = numbers(hit);
        if let Some(bits) = self.0.get_mut(k / WIDTH) {
            for l in 0..R::NUMBERS {
                *bits |= u8::from(hit[l] > 0.0) << (offset + l);
            }
        }
    }
}
