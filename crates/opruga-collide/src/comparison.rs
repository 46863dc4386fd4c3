//! The comparison of the features of pairs of bodies.

use crate::order::{Kind, Ordered};
use crate::overlaps::{Hierarchy, Overlaps};
use crate::reach::around;
use crate::surface::Surface;
use crate::vector::{Bounds, shifted, wider};
use core::ops::Range;
use core::sync::atomic::{AtomicUsize, Ordering};
use opruga_math::Simd;

/// Two bodies, or a body and itself, whose features are compared.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Compared<const D: usize> {
    /// The bodies; the first number is not larger than the second.
    pub(crate) bodies: [u32; 2],
    /// The displacement of the boxes of the first body relative to those of the second body [m].
    pub(crate) shift: [f64; D],
    /// The largest distance of features that form a pair [m].
    pub(crate) distance: f64,
}

/// One part of the pairs of bodies, and the pairs of features found in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Comparison<const D: usize> {
    /// The pairs of bodies.
    pub(crate) range: Range<usize>,
    /// The pairs of a vertex and a facet, and of two edges. The pairs of features of two bodies are ascending.
    pub(crate) pairs: [Vec<[u32; 2]>; 2],
    /// For every pair of bodies, the end of its pairs of features in both lists.
    pub(crate) ends: Vec<[usize; 2]>,
    first: Vec<(u32, Bounds<D>)>,
    second: Vec<(u32, Bounds<D>)>,
    hierarchy: Hierarchy,
}

/// Pairs of bodies whose features are compared.
pub(crate) struct Comparisons<'a, const D: usize> {
    pub(crate) surface: &'a Surface<D>,
    /// The boxes of points for pairs of two bodies [m], and those for pairs within one body.
    pub(crate) boxes: &'a [Bounds<D>],
    pub(crate) own: &'a [Bounds<D>],
    /// The boxes around the boxes of the vertices of every body for pairs of two bodies [m].
    pub(crate) bodies: &'a [Bounds<D>],
    pub(crate) pairs: &'a [Compared<D>],
    pub(crate) simd: Simd,
    /// The largest allowed number of pairs of features, and the number that all parts together have found so far.
    pub(crate) most: usize,
    pub(crate) counted: &'a AtomicUsize,
}

/// Combines the two numbers of a pair into one number, because one comparison is faster than two.
pub(crate) fn key([a, b]: &[u32; 2]) -> u64 {
    u64::from(*a) << 32 | u64::from(*b)
}

fn meet_boxes<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> bool {
    (0..D).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

/// A body and the displacement of its boxes [m].
type Shifted<const D: usize> = (u32, [f64; D]);

impl<const D: usize> Comparisons<'_, D> {
    /// Compares the features of the bodies in a part. Ends early if all parts together have found too many pairs.
    pub(crate) fn compare(&self, part: &mut Comparison<D>) {
        let [mut with_facets, mut of_edges] = core::mem::take(&mut part.pairs);
        with_facets.clear();
        of_edges.clear();
        part.ends.clear();
        for Compared { bodies: [a, b], shift, distance } in &self.pairs[part.range.clone()] {
            let starts = [with_facets.len(), of_edges.len()];
            let both @ [first, second] = [(*a, *shift), (*b, [0.0; D])];
            self.compare_vertices_with_facets(part, both, *distance, &mut with_facets);
            if a != b {
                self.compare_vertices_with_facets(part, [second, first], *distance, &mut with_facets);
            }
            if D == 3 {
                self.compare_edges(part, both, *distance, &mut of_edges);
            }
            with_facets[starts[0]..].sort_unstable_by_key(key);
            of_edges[starts[1]..].sort_unstable_by_key(key);
            part.ends.push([with_facets.len(), of_edges.len()]);
            let fresh = with_facets.len() - starts[0] + of_edges.len() - starts[1];
            if self.counted.fetch_add(fresh, Ordering::Relaxed) + fresh > self.most {
                break;
            }
        }
        part.pairs = [with_facets, of_edges];
    }

    /// The boxes of points for a pair of bodies, and the regions in which features of the first body can meet the second body, and the other way
    /// around. Features of one body can be anywhere.
    fn boxes_for(&self, [first, second]: &[Shifted<D>; 2], distance: f64) -> (&[Bounds<D>], [Bounds<D>; 2]) {
        if first.0 == second.0 {
            return (self.own, [[[f64::NEG_INFINITY; D], [f64::INFINITY; D]]; 2]);
        }
        let region =
            |(body, shift): &Shifted<D>, distance: f64| wider(shifted(self.bodies[*body as usize], shift), distance);
        (self.boxes, [region(second, distance), region(first, 0.0)])
    }

    fn compare_vertices_with_facets(
        &self,
        part: &mut Comparison<D>,
        [first, second]: [Shifted<D>; 2],
        distance: f64,
        found: &mut Vec<[u32; 2]>,
    ) {
        let surface = self.surface;
        if surface.is_obstacle(second.0) && !surface.touches_faces(first.0) {
            return;
        }
        let [a, b] = [first.0 as usize, second.0 as usize];
        let (boxes, regions) = self.boxes_for(&[first, second], distance);
        let vertex = |p: usize| shifted(boxes[p], &first.1);
        let facet = |f: usize| {
            let around = around(|p| boxes[p as usize], &surface.facets[f]);
            wider(shifted(around, &second.1), distance)
        };
        choose(&mut part.first, surface.ordered(a, Kind::Vertices), &regions[0], vertex);
        choose(&mut part.second, surface.ordered(b, Kind::Facets), &regions[1], facet);
        part.join(self.simd, |p, facet| {
            if a != b || !surface.share(&[p], &surface.facets[facet as usize]) {
                found.push([p, facet]);
            }
        });
    }

    fn compare_edges(
        &self,
        part: &mut Comparison<D>,
        [first, second]: [Shifted<D>; 2],
        distance: f64,
        found: &mut Vec<[u32; 2]>,
    ) {
        let surface = self.surface;
        let [a, b] = [first.0 as usize, second.0 as usize];
        let (boxes, regions) = self.boxes_for(&[first, second], distance);
        let of = |edge: usize, shift: &[f64; D]| shifted(around(|p| boxes[p as usize], &surface.edges[edge]), shift);
        let edges = |body: usize| surface.ordered(body, Kind::Edges);
        choose(&mut part.first, edges(a), &regions[0], |edge| of(edge, &first.1));
        choose(&mut part.second, edges(b), &regions[1], |edge| wider(of(edge, &second.1), distance));
        part.join(self.simd, |i, j| {
            let [first, second] = [i, j].map(|edge| &surface.edges[edge as usize]);
            if a != b || i < j && !surface.share(first, second) {
                found.push([i, j]);
            }
        });
    }
}

/// Collects the features whose boxes meet a region.
fn choose<const D: usize>(
    list: &mut Vec<(u32, Bounds<D>)>,
    features: Ordered<'_>,
    region: &Bounds<D>,
    bounds: impl Fn(usize) -> Bounds<D>,
) {
    list.clear();
    features.visit(|feature| {
        let own = bounds(feature as usize);
        if meet_boxes(&own, region) {
            list.push((feature, own));
        }
    });
}

impl<const D: usize> Comparison<D> {
    /// Calls `visit` with all pairs of a feature of the first list and a feature of the second list whose boxes overlap.
    fn join(&mut self, simd: Simd, visit: impl FnMut(u32, u32)) {
        let Comparison { first, second, hierarchy, .. } = self;
        if first.is_empty() || second.is_empty() {
            return;
        }
        hierarchy.fill(second);
        simd.run(Overlaps { first, second, hierarchy, visit });
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.pairs.iter().map(Vec::capacity).sum::<usize>()
            + 16 * self.ends.capacity()
            + (16 * D + 8) * (self.first.capacity() + self.second.capacity())
            + self.hierarchy.heap_bytes()
    }
}
