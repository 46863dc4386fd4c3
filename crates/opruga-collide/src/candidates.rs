//! Pairs of features that may meet.

use crate::close_bodies::CloseBodies;
use crate::comparison::{Compared, Comparison, Comparisons, key};
use crate::reach::{NOWHERE, joined};
use crate::surface::Surface;
use crate::vector::Bounds;
use core::sync::atomic::AtomicUsize;
use opruga_math::Simd;

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
    /// The boxes around the points of every body.
    bodies: Vec<Bounds<D>>,
    close_bodies: CloseBodies<D>,
    compared: Vec<Compared<D>>,
    comparison: Comparison<D>,
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
        let around =
            |body| surface.feature_points_of(body).fold(NOWHERE.map(|c| [c; D]), |whole, p| joined(whole, boxes[p]));
        self.bodies.clear();
        self.bodies.extend((0..surface.bodies()).map(around));
        self.close_bodies.find(surface, &self.bodies, distances, meet);
        let of_obstacle = |bodies: &[u32; 2]| bodies.iter().any(|body| surface.is_obstacle(*body));
        self.compared.clear();
        self.compared.extend(self.close_bodies.pairs.iter().map(|bodies| Compared {
            bodies: *bodies,
            shift: [0.0; D],
            distance: distances[usize::from(of_obstacle(bodies))],
        }));
        let counted = AtomicUsize::new(0);
        let (bodies, pairs, simd) = (&self.bodies[..], &self.compared[..], self.simd);
        let comparisons = Comparisons { surface, boxes, own: boxes, bodies, pairs, simd, most, counted: &counted };
        self.comparison.range = 0..pairs.len();
        comparisons.compare(&mut self.comparison);
        for (list, found) in [&mut self.vertex_facet, &mut self.edge_edge].into_iter().zip(&mut self.comparison.pairs) {
            std::mem::swap(list, found);
            list.sort_unstable_by_key(key);
        }
        counted.into_inner() <= most
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
        8 * (self.vertex_facet.capacity() + self.edge_edge.capacity())
            + 16 * D * self.bodies.capacity()
            + self.close_bodies.heap_bytes()
            + size_of::<Compared<D>>() * self.compared.capacity()
            + self.comparison.heap_bytes()
    }
}
