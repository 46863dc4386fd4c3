//! The comparison of the features of pairs of bodies.

use crate::order::Kind;
use crate::overlaps::{Hierarchy, Overlaps};
use crate::reach::around;
use crate::surface::Surface;
use crate::vector::{Bounds, shifted, subtract, wider};
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

    fn compare_vertices_with_facets(
        &self,
        part: &mut Comparison<D>,
        pair @ [(a, _), (b, _)]: [Shifted<D>; 2],
        distance: f64,
        found: &mut Vec<[u32; 2]>,
    ) {
        let surface = self.surface;
        if surface.is_obstacle(b) && !surface.touches_faces(a) {
            return;
        }
        self.compare_features(part, pair, distance, [Kind::Vertices, Kind::Facets], |p, facet| {
            if a != b || !surface.share(&[p], &surface.facets[facet as usize]) {
                found.push([p, facet]);
            }
        });
    }

    fn compare_edges(
        &self,
        part: &mut Comparison<D>,
        pair @ [(a, _), (b, _)]: [Shifted<D>; 2],
        distance: f64,
        found: &mut Vec<[u32; 2]>,
    ) {
        self.compare_features(part, pair, distance, [Kind::Edges; 2], |i, j| {
            let [first, second] = [i, j].map(|edge| &self.surface.edges[edge as usize]);
            if a != b || i < j && !self.surface.share(first, second) {
                found.push([i, j]);
            }
        });
    }

    /// Calls `visit` with all pairs of a feature of the first body and a feature of the second body, each of a given kind, whose boxes are closer than a
    /// distance [m].
    fn compare_features(
        &self,
        part: &mut Comparison<D>,
        [first, second]: [Shifted<D>; 2],
        distance: f64,
        kinds: [Kind; 2],
        visit: impl FnMut(u32, u32),
    ) {
        let is_one_body = first.0 == second.0;
        let boxes = if is_one_body { self.own } else { self.boxes };
        let Comparison { first: of_first, second: of_second, hierarchy, .. } = part;
        let sides = [(of_first, first, second, 0.0), (of_second, second, first, distance)];
        for ((list, (body, shift), (other, other_shift), extension), kind) in sides.into_iter().zip(kinds) {
            list.clear();
            // Where features can meet the other body, relative to their own body. Features of one body can be anywhere.
            let region = if is_one_body {
                [[f64::NEG_INFINITY; D], [f64::INFINITY; D]]
            } else {
                wider(shifted(self.bodies[other as usize], &subtract(&other_shift, &shift)), distance)
            };
            self.surface.ordered(body as usize, kind).visit(|feature| {
                let own = self.bounds_of(kind, feature, boxes);
                if meet_boxes(&own, &region) {
                    list.push((feature, wider(shifted(own, &shift), extension)));
                }
            });
            if list.is_empty() {
                return;
            }
        }
        hierarchy.fill(&part.second);
        self.simd.run(Overlaps { first: &part.first, second: &part.second, hierarchy, visit });
    }

    /// The box around the boxes of the points of a feature [m].
    #[inline]
    fn bounds_of(&self, kind: Kind, feature: u32, boxes: &[Bounds<D>]) -> Bounds<D> {
        let of = |p: u32| boxes[p as usize];
        match kind {
            Kind::Vertices => of(feature),
            Kind::Facets => around(of, &self.surface.facets[feature as usize]),
            Kind::Edges => around(of, &self.surface.edges[feature as usize]),
        }
    }
}

impl<const D: usize> Comparison<D> {
    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.pairs.iter().map(Vec::capacity).sum::<usize>()
            + 16 * self.ends.capacity()
            + (16 * D + 8) * (self.first.capacity() + self.second.capacity())
            + self.hierarchy.heap_bytes()
    }
}
