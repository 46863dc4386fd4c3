//! The nodes of a tile at which a contact is active, and the choice of surfaces that hold a node.

use crate::entries::numbers;
use opruga_core::tile::TILE;
use opruga_math::{Register, WIDTH};

/// Which surfaces hold a node when a collider is processed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meets {
    /// Only surfaces that the node was on at the start of the step.
    WhatItLiesOn,
    /// All surfaces that the node is behind.
    Everything,
}

/// The nodes of a tile at which a contact has been active in this step, one bit each.
pub(crate) struct ActiveNodes(pub(crate) [u8; TILE / WIDTH]);

impl ActiveNodes {
    /// Returns 1 for every active node and 0 for every other one, from index `k + offset` to the end of the pack at `k`.
    #[inline(always)]
    pub(crate) fn numbers(&self, k: usize, offset: usize) -> [f64; WIDTH] {
        let bits = self.0.get(k / WIDTH).copied().unwrap_or(0) >> offset;
        let mut out = [0.0; WIDTH];
        for l in 0..WIDTH {
            out[l] = f64::from(bits >> l & 1);
        }
        out
    }
    /// Marks as active all nodes from index `k + offset` on whose number in `hit` is above 0.
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
