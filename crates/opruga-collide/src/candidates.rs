//! Pairs of features that may meet.

use crate::grid::Grid;
use crate::overlaps::{Columns, Overlaps};
use crate::reach::around;
use crate::surface::Surface;
use crate::vector::Bounds;
use opruga_math::{Lane, Simd, WIDTH};

/// Pairs of a vertex and a facet, and in 3D of two edges, whose boxes are closer than a distance, in ascending order, each
/// once.
///
/// The result depends only on the boxes, not on how they are sorted.
#[derive(Clone, Debug, Default)]
pub struct Candidates<const D: usize> {
    /// Vertex and facet.
    pub vertex_facet: Vec<[u32; 2]>,
    /// Two edges, the one with the lower number first; empty in 2D.
    pub edge_edge: Vec<[u32; 2]>,
    /// The vector instructions. The pairs that a search finds do not depend on them.
    pub simd: Simd,
    /// Pairs that a search adds, and the merged list.
    fresh: Vec<[u32; 2]>,
    merged: Vec<[u32; 2]>,
    grid: Grid<D>,
    found: Vec<u32>,
    /// The boxes around the points of every body.
    bodies: Vec<Bounds<D>>,
    close_bodies: Vec<[u32; 2]>,
    first: Vec<(u32, Bounds<D>)>,
    second: Vec<(u32, Bounds<D>)>,
    columns: Columns,
}

/// A box, enlarged by a distance [m] on all sides.
fn wider<const D: usize>([mut low, mut high]: Bounds<D>, distance: f64) -> Bounds<D> {
    for d in 0..D {
        low[d] -= distance;
        high[d] += distance;
    }
    [low, high]
}

fn meet_boxes<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> bool {
    (0..D).all(|d| a[0][d] <= b[1][d] && b[0][d] <= a[1][d])
}

/// Merges new pairs into an ascending list.
fn merge(pairs: &mut Vec<[u32; 2]>, fresh: &mut [[u32; 2]], merged: &mut Vec<[u32; 2]>) {
    // One number per pair, which is compared faster than two.
    let key = |[a, b]: &[u32; 2]| u64::from(*a) << 32 | u64::from(*b);
    fresh.sort_unstable_by_key(key);
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

/// Up to this number of features, or of packs of pairs, the features of two bodies are compared with one another, eight at a time. Larger sets are
/// sorted into cells: finding the cells of a feature takes as long as a thousand comparisons.
const FEW: usize = 1024;

impl<const D: usize> Candidates<D> {
    /// Finds all pairs of features with boxes closer than a distance [m] along every axis, given the boxes of the points [m]. The
    /// first distance is for pairs of bodies, the second for pairs with obstacles.
    ///
    /// `meet` returns whether two bodies, or a body and itself, may touch. Two features do not form a pair if they share a
    /// point, or if a node carries points of both. A facet of an obstacle does not form a pair with a vertex of a body whose
    /// nodes are held by obstacles. Returns false if there are more than `most` pairs; the search then ends.
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

    /// Searches as [`Self::find`] does, but only between those bodies (and within those) whose present pairs are incomplete
    /// according to `stale`. All other pairs are kept. `own` gives the boxes of points for pairs within one body.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn refresh(
        &mut self,
        surface: &Surface<D>,
        boxes: &[Bounds<D>],
        own: impl Fn(u32) -> Bounds<D>,
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
        let mut pairs = std::mem::take(&mut self.fresh);
        let close = std::mem::take(&mut self.close_bodies);
        let mut complete = true;
        let of_obstacle = |body: u32| surface.is_obstacle(body);
        let distance_of = |pair: &[u32; 2]| distances[usize::from(pair.iter().any(|body| of_obstacle(*body)))];
        pairs.clear();
        for pair @ [a, b] in close.iter().filter(|[a, b]| !of_obstacle(*b) || surface.touches_faces(*a)) {
            let distance = distance_of(pair);
            let [a, b] = [*a as usize, *b as usize];
            let at = |p: u32| if a == b { own(p) } else { boxes[p as usize] };
            self.choose(surface.vertices_of(a), b, distance, |p| at(p as u32));
            std::mem::swap(&mut self.first, &mut self.second);
            self.choose(surface.facets_of(b), a, 0.0, |f| wider(around(at, &surface.facets[f]), distance));
            std::mem::swap(&mut self.first, &mut self.second);
            let apart = |p: u32, facet: u32| a != b || !surface.share(&[p], &surface.facets[facet as usize]);
            self.join(|p, facet| {
                if apart(p, facet) {
                    pairs.push([p, facet]);
                }
            });
            complete = self.len() + pairs.len() <= most;
            if !complete {
                break;
            }
        }
        merge(&mut self.vertex_facet, &mut pairs, &mut self.merged);
        pairs.clear();
        for pair @ [a, b] in close.iter().filter(|[a, b]| D == 3 && a <= b) {
            let distance = distance_of(pair);
            let [a, b] = [*a as usize, *b as usize];
            let at = |p: u32| if a == b { own(p) } else { boxes[p as usize] };
            let of = |edge: usize| around(at, &surface.edges[edge]);
            self.choose(surface.edges_of(a), b, distance, of);
            std::mem::swap(&mut self.first, &mut self.second);
            self.choose(surface.edges_of(b), a, 0.0, |edge| wider(of(edge), distance));
            std::mem::swap(&mut self.first, &mut self.second);
            let apart = |i: u32, j: u32| {
                let [first, second] = [i, j].map(|edge| &surface.edges[edge as usize]);
                a != b || i < j && !surface.share(first, second)
            };
            self.join(|i, j| {
                if apart(i, j) {
                    pairs.push(if i < j { [i, j] } else { [j, i] });
                }
            });
            complete &= self.len() + pairs.len() <= most;
            if !complete {
                break;
            }
        }
        merge(&mut self.edge_edge, &mut pairs, &mut self.merged);
        (self.fresh, self.close_bodies) = (pairs, close);
        complete
    }

    /// Lists the pairs of bodies whose boxes are closer than the distance for such a pair [m], each in both orders. Also lists
    /// bodies that touch themselves, as pairs of a body with itself.
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

    /// Collects, in the first list, the features of a body whose boxes are closer than a distance [m] to another body.
    fn choose(
        &mut self,
        features: core::ops::Range<usize>,
        other: usize,
        distance: f64,
        bounds: impl Fn(usize) -> Bounds<D>,
    ) {
        let region = wider(self.bodies[other], distance);
        self.first.clear();
        let own = features.map(|feature| (feature as u32, bounds(feature)));
        self.first.extend(own.filter(|(_, own)| meet_boxes(own, &region)));
    }

    /// Calls `visit` with all pairs of a feature of the first list and a feature of the second list whose boxes overlap.
    fn join(&mut self, mut visit: impl FnMut(u32, u32)) {
        if self.second.len() <= FEW || self.first.len() * self.second.len() <= FEW * WIDTH {
            let Candidates { first, second, columns, simd, .. } = self;
            columns.fill(second);
            return simd.run(Overlaps { first, second, columns, visit });
        }
        self.grid.fill(self.second.iter().map(|(_, bounds)| *bounds));
        for (a, bounds) in &self.first {
            self.grid.touching(bounds, &mut self.found);
            self.found.iter().for_each(|k| visit(*a, self.second[*k as usize].0));
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
            + 16 * D * (self.bodies.capacity() + self.first.capacity() + self.second.capacity())
            + self.grid.heap_bytes()
            + self.columns.heap_bytes()
    }
}
