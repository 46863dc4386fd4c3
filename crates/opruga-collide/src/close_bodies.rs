//! Pairs of bodies that are close to one another.

use crate::grid::Grid;
use crate::surface::Surface;
use crate::vector::{Bounds, wider};

/// A search for pairs of bodies whose boxes are close to one another.
#[derive(Clone, Debug, Default)]
pub(crate) struct CloseBodies<const D: usize> {
    grid: Grid<D>,
    found: Vec<u32>,
    /// The pairs found by the last search, ascending. The first number of a pair is not larger than the second. A body may form a pair with itself.
    pub(crate) pairs: Vec<[u32; 2]>,
}

impl<const D: usize> CloseBodies<D> {
    /// Finds all pairs of bodies that may touch according to `meet`, and whose boxes [m] are closer than a distance [m] along every axis. The first
    /// distance is for pairs of bodies, the second one for pairs with obstacles.
    pub(crate) fn find(
        &mut self,
        surface: &Surface<D>,
        boxes: &[Bounds<D>],
        distances: [f64; 2],
        meet: impl Fn(u32, u32) -> bool,
    ) {
        let distance = |body: u32| distances[usize::from(surface.is_obstacle(body))];
        let own = |body: usize| wider(boxes[body], distance(body as u32));
        self.pairs.clear();
        self.grid.fill((0..boxes.len()).map(own));
        // A body without points has no box.
        for a in (0..boxes.len()).filter(|body| boxes[*body][0][0] <= boxes[*body][1][0]) {
            self.grid.touching(&own(a), &mut self.found);
            let others = self.found.iter().filter(|b| **b as usize >= a && meet(a as u32, **b));
            self.pairs.extend(others.map(|b| [a as u32, *b]));
        }
        self.pairs.sort_unstable();
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.pairs.capacity() + 4 * self.found.capacity() + self.grid.heap_bytes()
    }
}
