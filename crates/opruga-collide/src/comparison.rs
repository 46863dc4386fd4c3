//! The comparison of the features of pairs of bodies.

use crate::grid::Grid;
use crate::overlaps::{Columns, Overlaps};
use crate::reach::around;
use crate::surface::Surface;
use crate::vector::{Bounds, wider};
use core::ops::Range;
use core::sync::atomic::{AtomicUsize, Ordering};
use opruga_math::{Simd, WIDTH};

/// The features of two bodies are compared directly, eight at a time, if the second body has at most this many features or if there are at most this
/// many packs of pairs. Otherwise, features are sorted into cells. Finding the cells of a feature takes as long as a thousand comparisons.
const FEW: usize = 1024;

/// One part of the pairs of bodies, and the pairs of features found in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Comparison<const D: usize> {
    /// The pairs of bodies.
    pub(crate) range: Range<usize>,
    /// The pairs of a vertex and a facet, and of two edges, each list in ascending order.
    pub(crate) pairs: [Vec<[u32; 2]>; 2],
    first: Vec<(u32, Bounds<D>)>,
    second: Vec<(u32, Bounds<D>)>,
    columns: Columns,
    grid: Grid<D>,
    found: Vec<u32>,
}

/// Pairs of bodies whose features are compared.
pub(crate) struct Comparisons<'a, O, const D: usize> {
    pub(crate) surface: &'a Surface<D>,
    /// The boxes of points for pairs of two bodies [m], and those for pairs within one body.
    pub(crate) boxes: &'a [Bounds<D>],
    pub(crate) own: O,
    /// The boxes around the points of every body [m].
    pub(crate) bodies: &'a [Bounds<D>],
    /// The pairs of bodies, each in both orders.
    pub(crate) pairs: &'a [[u32; 2]],
    /// The largest distances of features that form a pair [m]: between bodies, and with obstacles.
    pub(crate) distances: [f64; 2],
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

impl<O: Fn(u32) -> Bounds<D>, const D: usize> Comparisons<'_, O, D> {
    /// Compares the features of the bodies in a part. Ends early if all parts together have found too many pairs.
    pub(crate) fn compare(&self, part: &mut Comparison<D>) {
        let [mut with_facets, mut of_edges] = core::mem::take(&mut part.pairs);
        with_facets.clear();
        of_edges.clear();
        for pair @ [a, b] in &self.pairs[part.range.clone()] {
            let before = with_facets.len() + of_edges.len();
            if !self.surface.is_obstacle(*b) || self.surface.touches_faces(*a) {
                self.compare_vertices_with_facets(part, *pair, &mut with_facets);
            }
            if D == 3 && a <= b {
                self.compare_edges(part, *pair, &mut of_edges);
            }
            let fresh = with_facets.len() + of_edges.len() - before;
            if self.counted.fetch_add(fresh, Ordering::Relaxed) + fresh > self.most {
                break;
            }
        }
        with_facets.sort_unstable_by_key(key);
        of_edges.sort_unstable_by_key(key);
        part.pairs = [with_facets, of_edges];
    }

    /// The box of a point for pairs of two bodies, or of one body with itself.
    fn at(&self, [a, b]: [u32; 2], point: u32) -> Bounds<D> {
        if a == b { (self.own)(point) } else { self.boxes[point as usize] }
    }

    fn distance(&self, pair: [u32; 2]) -> f64 {
        self.distances[usize::from(pair.iter().any(|body| self.surface.is_obstacle(*body)))]
    }

    fn compare_vertices_with_facets(&self, part: &mut Comparison<D>, pair: [u32; 2], found: &mut Vec<[u32; 2]>) {
        let (surface, distance) = (self.surface, self.distance(pair));
        let ([a, b], at) = (pair.map(|body| body as usize), |p: u32| self.at(pair, p));
        let facet = |f: usize| wider(around(at, &surface.facets[f]), distance);
        choose(&mut part.first, surface.vertices_of(a), &wider(self.bodies[b], distance), |p| at(p as u32));
        choose(&mut part.second, surface.facets_of(b), &self.bodies[a], facet);
        part.join(self.simd, |p, facet| {
            if a != b || !surface.share(&[p], &surface.facets[facet as usize]) {
                found.push([p, facet]);
            }
        });
    }

    fn compare_edges(&self, part: &mut Comparison<D>, pair: [u32; 2], found: &mut Vec<[u32; 2]>) {
        let (surface, distance) = (self.surface, self.distance(pair));
        let [a, b] = pair.map(|body| body as usize);
        let of = |edge: usize| around(|p| self.at(pair, p), &surface.edges[edge]);
        choose(&mut part.first, surface.edges_of(a), &wider(self.bodies[b], distance), of);
        choose(&mut part.second, surface.edges_of(b), &self.bodies[a], |edge| wider(of(edge), distance));
        part.join(self.simd, |i, j| {
            let [first, second] = [i, j].map(|edge| &surface.edges[edge as usize]);
            if a != b || i < j && !surface.share(first, second) {
                found.push(if i < j { [i, j] } else { [j, i] });
            }
        });
    }
}

/// Collects the features whose boxes meet a region.
fn choose<const D: usize>(
    list: &mut Vec<(u32, Bounds<D>)>,
    features: Range<usize>,
    region: &Bounds<D>,
    bounds: impl Fn(usize) -> Bounds<D>,
) {
    list.clear();
    let all = features.map(|feature| (feature as u32, bounds(feature)));
    list.extend(all.filter(|(_, own)| meet_boxes(own, region)));
}

impl<const D: usize> Comparison<D> {
    /// Calls `visit` with all pairs of a feature of the first list and a feature of the second list whose boxes overlap.
    fn join(&mut self, simd: Simd, mut visit: impl FnMut(u32, u32)) {
        let Comparison { first, second, columns, grid, found, .. } = self;
        if second.len() <= FEW || first.len() * second.len() <= FEW * WIDTH {
            columns.fill(second);
            return simd.run(Overlaps { first, second, columns, visit });
        }
        grid.fill(second.iter().map(|(_, bounds)| *bounds));
        for (a, bounds) in first.iter() {
            grid.touching(bounds, found);
            found.iter().for_each(|k| visit(*a, second[*k as usize].0));
        }
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        8 * self.pairs.iter().map(Vec::capacity).sum::<usize>()
            + 4 * self.found.capacity()
            + (16 * D + 8) * (self.first.capacity() + self.second.capacity())
            + self.grid.heap_bytes()
            + self.columns.heap_bytes()
    }
}
