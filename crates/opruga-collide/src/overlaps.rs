//! Boxes of two lists that overlap, compared eight at a time in vector instructions.

use crate::reach::{NOWHERE, joined};
use crate::vector::Bounds;
use opruga_math::{Lane, Pack, WIDTH, Work, lanes};

/// A hierarchy of bounding boxes. The boxes of a list are grouped into packs of eight in the order of the list. The boxes around these packs are
/// grouped in the same way, and so on up to a level of one pack. The order of the list must keep neighbours together ([`crate::order`]).
#[derive(Clone, Debug, Default)]
pub(crate) struct Hierarchy {
    /// The coordinates of the boxes of all levels, level by level, padded to whole packs: first the lowest along every axis, then the highest.
    coordinates: Vec<f64>,
    /// For every level, the start of its coordinates, and the number of its boxes with their padding. The first level holds the boxes of the list.
    levels: Vec<(usize, usize)>,
    /// The packs of one level that overlap a box, and those of the next one.
    packs: Vec<u32>,
    next: Vec<u32>,
}

impl Hierarchy {
    /// Replaces the present boxes by new ones.
    pub(crate) fn fill<const D: usize>(&mut self, boxes: &[(u32, Bounds<D>)]) {
        self.levels.clear();
        self.coordinates.clear();
        let start = self.begin_level::<D>(boxes.len());
        for (k, (_, own)) in boxes.iter().enumerate() {
            self.set(start, k, own);
        }
        while let Some((below, padded)) = self.levels.last().copied().filter(|(_, padded)| *padded > WIDTH) {
            let packs = padded / WIDTH;
            let start = self.begin_level::<D>(packs);
            for pack in 0..packs {
                let mut whole = NOWHERE.map(|c| [c; D]);
                for d in 0..D {
                    let column = |k: usize| below + k * padded + pack * WIDTH..below + k * padded + (pack + 1) * WIDTH;
                    whole[0][d] = self.coordinates[column(d)].iter().fold(f64::INFINITY, |least, c| c.smaller(least));
                    whole[1][d] =
                        self.coordinates[column(D + d)].iter().fold(f64::NEG_INFINITY, |most, c| c.larger(most));
                }
                self.set(start, pack, &whole);
            }
        }
    }

    /// Adds a level for a number of boxes; returns where its coordinates start.
    fn begin_level<const D: usize>(&mut self, boxes: usize) -> usize {
        let (start, padded) = (self.coordinates.len(), boxes.next_multiple_of(WIDTH));
        // Nothing overlaps a box from infinity to minus infinity.
        self.coordinates.resize(start + D * padded, f64::INFINITY);
        self.coordinates.resize(start + 2 * D * padded, f64::NEG_INFINITY);
        self.levels.push((start, padded));
        start
    }

    /// Sets a box of the last level.
    fn set<const D: usize>(&mut self, start: usize, k: usize, [low, high]: &Bounds<D>) {
        let padded = self.levels.last().map_or(0, |(_, padded)| *padded);
        for d in 0..D {
            self.coordinates[start + d * padded + k] = low[d];
            self.coordinates[start + (D + d) * padded + k] = high[d];
        }
    }

    /// Collects the packs of the first level that may hold a box that overlaps a given one, ascending.
    #[inline(always)]
    fn find_packs<P: Pack, const D: usize>(&mut self, bounds: &Bounds<D>) {
        let (mut packs, mut next) = (core::mem::take(&mut self.packs), core::mem::take(&mut self.next));
        packs.clear();
        packs.push(0);
        let wanted = splat::<P, D>(bounds);
        for level in (1..self.levels.len()).rev() {
            next.clear();
            let lanes = &mut next;
            for pack in &packs {
                let found = self.overlapping(level, *pack as usize, &wanted);
                visit_lanes::<P>(found, |lane| lanes.push(*pack * WIDTH as u32 + lane as u32));
            }
            core::mem::swap(&mut packs, &mut next);
        }
        (self.packs, self.next) = (packs, next);
    }

    /// The boxes of a pack that overlap a given one.
    #[inline(always)]
    fn overlapping<P: Pack, const D: usize>(&self, level: usize, pack: usize, [low, high]: &[[P; D]; 2]) -> P::Mask {
        let (start, padded) = self.levels[level];
        let load = |k: usize| P::load(&self.coordinates[start + k * padded + pack * WIDTH..]);
        let mut meets = P::both(load(0).less_or_equal(high[0]), low[0].less_or_equal(load(D)));
        for d in 1..D {
            meets = P::both(meets, load(d).less_or_equal(high[d]));
            meets = P::both(meets, low[d].less_or_equal(load(D + d)));
        }
        meets
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.coordinates.capacity()
            + 16 * self.levels.capacity()
            + 4 * (self.packs.capacity() + self.next.capacity())
    }
}

#[inline(always)]
fn splat<P: Pack, const D: usize>([low, high]: &Bounds<D>) -> [[P; D]; 2] {
    [lanes!(P, d => P::splat(low[d])), lanes!(P, d => P::splat(high[d]))]
}

/// Calls `visit` with every lane of a mask that is set, ascending.
#[inline(always)]
fn visit_lanes<P: Pack>(mask: P::Mask, mut visit: impl FnMut(usize)) {
    if P::any(mask) {
        let found = P::select(mask, P::one(), P::zero()).to_array();
        found.iter().enumerate().filter(|(_, found)| **found > 0.0).for_each(|(lane, _)| visit(lane));
    }
}

/// Calls `visit` with all pairs of a feature of the first list and a feature of the second list, if their boxes overlap. The hierarchy holds the boxes
/// of the second list.
pub(crate) struct Overlaps<'a, F, const D: usize> {
    pub(crate) first: &'a [(u32, Bounds<D>)],
    pub(crate) second: &'a [(u32, Bounds<D>)],
    pub(crate) hierarchy: &'a mut Hierarchy,
    pub(crate) visit: F,
}

impl<F: FnMut(u32, u32), const D: usize> Work for Overlaps<'_, F, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(mut self) {
        for group in self.first.chunks(WIDTH) {
            let whole = group.iter().fold(NOWHERE.map(|c| [c; D]), |whole, (_, own)| joined(whole, *own));
            self.hierarchy.find_packs::<P, D>(&whole);
            for (a, bounds) in group {
                let wanted = splat::<P, D>(bounds);
                for pack in &self.hierarchy.packs {
                    let found = self.hierarchy.overlapping(0, *pack as usize, &wanted);
                    visit_lanes::<P>(found, |lane| {
                        let (b, _) = self.second[*pack as usize * WIDTH + lane];
                        (self.visit)(*a, b);
                    });
                }
            }
        }
    }
}
