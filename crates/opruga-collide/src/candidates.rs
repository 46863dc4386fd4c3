//! Pairs of features that may meet.

use crate::comparison::{Comparison, Comparisons, key};
use crate::grid::Grid;
use crate::least_parts;
use crate::surface::Surface;
use crate::vector::{Bounds, wider};
use core::sync::atomic::AtomicUsize;
use opruga_core::threads;
use opruga_math::{Lane, Simd};

/// Pairs of a vertex and a facet, and in 3D of two edges, whose boxes are closer than a distance, in ascending order, each
/// once.
///
/// The result depends only on the boxes, not on how they are sorted.
#[derive(Clone, Debug, Default)]
pub struct Candidates<const D: usize> {
    /// Vertex and facet.
    pub vertex_facet: Vec<[u32; 2]>,
    /// Two edges, of which the edge with the lower number comes first; empty in 2D.
    pub edge_edge: Vec<[u32; 2]>,
    /// The vector instructions. The pairs that a search finds do not depend on them.
    pub simd: Simd,
    /// The threads that may compare features. The pairs that a search finds do not depend on them.
    pub(crate) threads: usize,
    /// Pairs that a search adds, and the merged list.
    fresh: Vec<[u32; 2]>,
    merged: Vec<[u32; 2]>,
    grid: Grid<D>,
    found: Vec<u32>,
    /// The boxes around the points of every body.
    bodies: Vec<Bounds<D>>,
    close_bodies: Vec<[u32; 2]>,
    parts: Vec<Comparison<D>>,
}

/// Merges new pairs into an ascending list.
fn merge(pairs: &mut Vec<[u32; 2]>, fresh: &[[u32; 2]], merged: &mut Vec<[u32; 2]>) {
    merged.clear();
    let mut known = pairs.iter().peekable();
    for one in fresh.iter() {
        while let Some(other) = known.next_if(|other| key(other) < key(one)) {
            merged.push(*other);
        }
        merged.push(*one);
    }
    merged.extend(known);
    std::mem::swap(pairs, merged);
}

impl<const D: usize> Candidates<D> {
    /// Finds all pairs of features with boxes closer than a distance [m] along every axis, given the boxes of the points [m]. The
    /// first distance is for pairs of bodies, the second for pairs with obstacles.
    ///
    /// `meet` returns whether two bodies, or a body and itself, may touch. Two features do not form a pair if they share a point, or if a node
    /// carries points of both. A facet of an obstacle does not form a pair with a vertex of a body whose nodes are held by obstacles. The search ends
    /// and returns false if it finds more than `most` pairs.
    pub fn find(
        &mut self,
        surface: &Surface<D>,
        boxes: &[Bounds<D>],
        distances: [f64; 2],
        most: usize,
        meet: impl Fn(u32, u32) -> bool,
    ) -> bool {
        let own = |p: u32| boxes[p as usize];
        self.refresh(surface, boxes, own, distances, most, meet, |_, _| true)
    }

    /// Searches as [`Self::find`] does, but only for the pairs of bodies (or of a body with itself) whose features must be
    /// compared again according to `stale`. The features of all other pairs of bodies are kept. `own` gives the boxes of points
    /// for pairs within one body.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn refresh(
        &mut self,
        surface: &Surface<D>,
        boxes: &[Bounds<D>],
        own: impl Fn(u32) -> Bounds<D> + Sync,
        distances: [f64; 2],
        most: usize,
        meet: impl Fn(u32, u32) -> bool,
        stale: impl Fn(u32, u32) -> bool,
    ) -> bool {
        let body = |point: u32| surface.body[point as usize];
        self.vertex_facet.retain(|[p, facet]| !stale(body(*p), body(surface.facets[*facet as usize][0])));
        self.edge_edge.retain(|pair| {
            let [a, b] = pair.map(|edge| body(surface.edges[edge as usize][0]));
            !stale(a, b)
        });
        self.find_close_bodies(surface, boxes, distances, |a, b| meet(a, b) && stale(a, b));
        self.parts.resize_with(1, Comparison::default);
        for (k, range) in
            threads::parts(self.close_bodies.len(), self.threads, least_parts::PAIRS_OF_BODIES).enumerate()
        {
            if self.parts.len() <= k {
                self.parts.push(Comparison::default());
            }
            self.parts[k].range = range;
        }
        let counted = AtomicUsize::new(self.len());
        let comparisons = Comparisons {
            surface,
            boxes,
            own,
            bodies: &self.bodies,
            pairs: &self.close_bodies,
            distances,
            simd: self.simd,
            most,
            counted: &counted,
        };
        threads::each_in_pool(self.parts.iter_mut(), |part| comparisons.compare(part));
        for (list, known) in [&mut self.vertex_facet, &mut self.edge_edge].into_iter().enumerate() {
            self.fresh.clear();
            self.parts.iter().for_each(|part| self.fresh.extend(&part.pairs[list]));
            // Every part is sorted already.
            self.fresh.sort_by_key(key);
            merge(known, &self.fresh, &mut self.merged);
        }
        counted.into_inner() <= most
    }

    /// Lists the pairs of bodies whose boxes overlap after each was enlarged by a distance [m], in both orders. Bodies that
    /// touch themselves are listed as pairs of a body with itself.
    fn find_close_bodies(
        &mut self,
        surface: &Surface<D>,
        boxes: &[Bounds<D>],
        distances: [f64; 2],
        meet: impl Fn(u32, u32) -> bool,
    ) {
        self.bodies.clear();
        for number in 0..surface.bodies() {
            let mut whole = [[f64::INFINITY; D], [f64::NEG_INFINITY; D]];
            for [low, high] in &boxes[surface.vertices_of(number)] {
                for d in 0..D {
                    whole[0][d] = low[d].smaller(whole[0][d]);
                    whole[1][d] = high[d].larger(whole[1][d]);
                }
            }
            self.bodies.push(whole);
        }
        self.close_bodies.clear();
        // A body without points has no box.
        let body = |number: usize| surface.body.get(surface.vertices_of(number).start).copied();
        let own = |number: usize| {
            let of_obstacle = body(number).is_some_and(|body| surface.is_obstacle(body));
            wider(self.bodies[number], distances[usize::from(of_obstacle)])
        };
        self.grid.fill((0..surface.bodies()).map(own));
        for a in 0..surface.bodies() {
            self.grid.touching(&own(a), &mut self.found);
            for b in &self.found {
                if let (Some(own), Some(other)) = (body(a), body(*b as usize))
                    && meet(own, other)
                {
                    self.close_bodies.push([a as u32, *b]);
                }
            }
        }
    }

    /// The number of pairs.
    pub fn len(&self) -> usize {
        self.vertex_facet.len() + self.edge_edge.len()
    }

    /// Whether there are no pairs.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let pairs = [&self.vertex_facet, &self.edge_edge, &self.fresh, &self.merged];
        8 * pairs.map(Vec::capacity).iter().sum::<usize>()
            + 4 * self.found.capacity()
            + 16 * D * self.bodies.capacity()
            + self.grid.heap_bytes()
            + self.parts.iter().map(Comparison::heap_bytes).sum::<usize>()
    }
}
