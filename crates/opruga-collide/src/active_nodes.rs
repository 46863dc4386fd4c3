//! The nodes of a tile at which a contact is active, and what a node meets.

use crate::entries::numbers;
use opruga_core::tile::TILE;
use opruga_math::{Register, WIDTH};

/// What a node meets when a collider is processed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meets {
    /// A surface on which it was at the start of the step.
    WhatItLiesOn,
    /// Everything that it is in.
    Everything,
}

/// The nodes of a tile at which a contact has been active in this step, one bit each.
pub(crate) struct ActiveNodes(pub(crate) [u8; TILE / WIDTH]);

impl ActiveNodes {
    /// The nodes from index `k + offset` to the end of the pack at `k`: 1 if active, otherwise 0.
    #[inline(always)]
    pub(crate) fn numbers(&self, k: usize, offset: usize) -> [f64; WIDTH] {
        let bits = self.0.get(k / WIDTH).copied().unwrap_or(0) >> offset;
        let mut out = [0.0; WIDTH];
        for l in 0..WIDTH {
            out[l] = f64::from(bits >> l & 1);
        }
        out
    }
    /// Records the nodes from index `k + offset` on for which `hit` is above 0.
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
