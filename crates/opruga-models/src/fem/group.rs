//! A group of packs of elements that are processed together, and the location of their data.

use super::boxes::Boxes;
use opruga_core::state::Layout;
use opruga_math::WIDTH;

/// The data that every step of the work on a group of packs needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group<'a> {
    pub(super) layout: Layout,
    /// The first pack, and the number of packs.
    pub(super) first: usize,
    pub(super) packs: usize,
    /// The total number of elements.
    pub(super) count: usize,
    /// The number of points of an element.
    pub(super) points: usize,
    /// Whether the law accounts for rotations.
    pub(super) turns: bool,
    pub(super) node_indices: &'a [u32],
    pub(super) targets: &'a [u32],
    pub(super) geometry: &'a [f64],
    pub(super) boxes: &'a Boxes,
    pub(super) parameters: &'a [f64],
    /// The distance between the parameters of two packs.
    pub(super) step: usize,
}

impl Group<'_> {
    /// The number of elements in a pack of one body. The last pack may not be full.
    #[inline(always)]
    pub(super) fn present(&self, pack: usize) -> usize {
        match self.layout {
            Layout::Single => (self.count - pack * WIDTH).min(WIDTH),
            Layout::Batch => WIDTH,
        }
    }
    /// The location of the numbers of a pack. If all packs have the same numbers, only the numbers of a full pack and of the
    /// last pack are stored.
    #[inline(always)]
    pub(super) fn one_or(&self, one: bool, pack: usize) -> usize {
        if one { usize::from(self.present(pack) < WIDTH) } else { pack }
    }
}
