//! Pairs of features that may meet.

use crate::grid::Grid;
use crate::reach::around;
use crate::surface::Surface;

/// Pairs of a vertex and a facet, and in 3D of two edges, whose swept boxes come closer than a margin; ascending, each once.
///
/// What is found depends on the positions alone, not on how the boxes are sorted.
#[derive(Clone, Debug, Default)]
pub struct Candidates<const D: usize> {
    /// Vertex and facet.
    pub vertex_facet: Vec<[u32; 2]>,
    /// Two edges, the lower number first; empty in 2D.
    pub edge_edge: Vec<[u32; 2]>,
    grid: Grid<D>,
    found: Vec<u32>,
}

/// A box, larger by a distance [m] on all sides.
fn wider<const D: usize>([mut low, mut high]: [[f64; D]; 2], distance: f64) -> [[f64; D]; 2] {
    for d in 0..D {
        low[d] -= distance;
        high[d] += distance;
    }
    [low, high]
}

impl<const D: usize> Candidates<D> {
    /// Looks for all pairs of features with boxes closer than `distance` [m] along every axis, given the boxes of the points [m].
    ///
    /// `meet` says of two bodies whether they may touch, of a body with itself whether it may touch itself. Features that share a point
    /// are no pair. False where there are more than `most` pairs: then the search ends.
    pub fn find(
        &mut self,
        surface: &Surface<D>,
        boxes: &[[[f64; D]; 2]],
        distance: f64,
        most: usize,
        meet: impl Fn(u32, u32) -> bool,
    ) -> bool {
        self.vertex_facet.clear();
        self.edge_edge.clear();
        self.grid.fill(surface.facets.iter().map(|facet| wider(around(boxes, facet), distance)));
        for p in 0..surface.points() as u32 {
            self.grid.touching(&boxes[p as usize], &mut self.found);
            let apart = |facet: &[u32; D]| !facet.contains(&p);
            for number in &self.found {
                let facet = &surface.facets[*number as usize];
                let (own, other) = (surface.body[p as usize], surface.body[facet[0] as usize]);
                if meet(own, other) && (own != other || apart(facet)) {
                    self.vertex_facet.push([p, *number]);
                }
            }
            if self.vertex_facet.len() > most {
                return false;
            }
        }
        if D == 2 {
            return true;
        }
        self.grid.fill(surface.edges.iter().map(|edge| wider(around(boxes, edge), distance)));
        for (number, edge) in surface.edges.iter().enumerate() {
            self.grid.touching(&around(boxes, edge), &mut self.found);
            let apart = |other: &[u32; 2]| !edge.iter().any(|p| other.contains(p));
            let number = number as u32;
            for other in self.found.iter().filter(|other| **other > number) {
                let second = &surface.edges[*other as usize];
                let bodies = [edge[0], second[0]].map(|p| surface.body[p as usize]);
                if meet(bodies[0], bodies[1]) && (bodies[0] != bodies[1] || apart(second)) {
                    self.edge_edge.push([number, *other]);
                }
            }
            if self.vertex_facet.len() + self.edge_edge.len() > most {
                return false;
            }
        }
        true
    }

    /// The number of pairs.
    pub fn len(&self) -> usize {
        self.vertex_facet.len() + self.edge_edge.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        8 * (self.vertex_facet.capacity() + self.edge_edge.capacity())
            + 4 * self.found.capacity()
            + self.grid.heap_bytes()
    }
}
