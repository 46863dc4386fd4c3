//! Some packs of elements that are worked on together, and where their numbers lie.

use super::boxes::Boxes;
use opruga_core::state::Layout;
use opruga_math::WIDTH;

/// What every step of the work on some packs of elements needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    pub(super) layout: Layout,
    /// The first pack, and how many.
    pub(super) first: usize,
    pub(super) packs: usize,
    /// Elements in all.
    pub(super) count: usize,
    /// Points of an element.
    pub(super) points: usize,
    /// Whether the law knows of rotations.
    pub(super) turns: bool,
    pub(super) node_indices: &'a [u32],
    pub(super) targets: &'a [u32],
    pub(super) geometry: &'a [f64],
    pub(super) boxes: &'a Boxes,
    pub(super) parameters: &'a [f64],
    /// Distance of the parameters of two packs.
    pub(super) step: usize,
}

impl Group<'_> {
    /// How many elements of a pack of one body are there; the last pack is filled up.
    #[inline(always)]
    pub(super) fn present(&self, pack: usize) -> usize {
        match self.layout {
            Layout::Single => (self.count - pack * WIDTH).min(WIDTH),
            Layout::Batch => WIDTH,
        }
    }
    /// Where the numbers of a pack lie, or those that hold for all packs: a whole one and the last one.
    #[inline(always)]
    pub(super) fn one_or(&self, one: bool, pack: usize) -> usize {
        if one { usize::from(self.present(pack) < WIDTH) } else { pack }
    }
}
