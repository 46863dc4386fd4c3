//! Points that are inside another body at the start of a frame, because their bodies began inside one another and have not come out yet.

use crate::closest::{closest_on_facet, mean};
use crate::gap::Gap;
use crate::reach::{NOWHERE, joined};
use crate::touching::Touching;
use crate::vector::{Bounds, apart, dot, subtract};
use core::ops::Range;
use opruga_mesh::winding_number;

impl<const D: usize> Touching<D> {
    /// Finds the points inside the closed boundary of another body. The pairs of a step do not include them, because a point deep inside touches
    /// nothing. A point is examined if it is behind the nearest of the facets with which it forms candidates. Candidates extend only to a margin, so
    /// deeper points are not found. The candidates may lack a nearer facet. Therefore, the whole boundary decides whether the point is inside.
    pub(crate) fn find_began_inside(&mut self) {
        self.began_inside.clear();
        self.entangled.clear();
        let x = &self.before[0];
        let around =
            |body| self.surface.feature_points_of(body).fold(NOWHERE.map(|c| [c; D]), |all, p| joined(all, [x[p]; 2]));
        let boxes: Vec<Bounds<D>> = (0..self.surface.bodies()).map(around).collect();
        for pair in 0..self.pairs.all.len() {
            let (bodies @ [a, b], candidates) = (self.pairs.all[pair].bodies, self.pairs.all[pair].range(0));
            if a != b && apart(&boxes[a as usize], &boxes[b as usize]) <= 0.0 {
                self.find_inside(bodies, candidates, &boxes);
            }
        }
        self.began_inside.sort_unstable();
        self.began_inside.dedup();
        self.entangled.sort_unstable();
        self.entangled.dedup();
    }

    /// Finds the vertices among the candidates of two bodies that are inside the other body, given the boxes around all bodies [m].
    fn find_inside(&mut self, [a, b]: [u32; 2], candidates: Range<usize>, boxes: &[Bounds<D>]) {
        let Touching { surface, before: [x, _], pairs, began_inside, entangled, .. } = self;
        for of_vertex in pairs.features[0][candidates].chunk_by(|a, b| a[0] == b[0]) {
            let vertex = of_vertex[0][0];
            let other = if surface.body[vertex as usize] == a { b } else { a };
            let (at, [low, high]) = (&x[vertex as usize], &boxes[other as usize]);
            if !(0..D).all(|d| low[d] <= at[d] && at[d] <= high[d]) {
                continue;
            }
            let closed = of_vertex.iter().map(|[_, facet]| *facet).filter(|facet| surface.closed[*facet as usize]);
            let square = |facet: u32| {
                let corners = surface.facets[facet as usize].map(|p| x[p as usize]);
                let between = subtract(at, &mean(&closest_on_facet(at, &corners), &corners));
                dot(&between, &between)
            };
            let nearest = closed
                .map(|facet| (square(facet), facet))
                .reduce(|known, one| if one.0 < known.0 { one } else { known });
            if !nearest.is_some_and(|(_, facet)| Gap::of_vertex_and_facet(surface, &x[..], vertex, facet).gap < 0.0) {
                continue;
            }
            // Facets of closed boundaries come first.
            let all = surface.facets_of(other as usize);
            let closed = surface.closed[all.clone()].partition_point(|closed| *closed);
            let boundary = &surface.facets[all.start..all.start + closed];
            if winding_number(boundary, x, at).abs() > 0.5 {
                began_inside.push(vertex);
                entangled.push([a, b]);
            }
        }
    }

    /// Whether points of one of two bodies were inside the other one at the start of the frame. Edges of two such bodies do not
    /// form pairs: they cross already, and contact between them would lock the bodies together.
    pub(crate) fn are_entangled(&self, [a, b]: [u32; 2]) -> bool {
        let pair = if a < b { [a, b] } else { [b, a] };
        self.entangled.binary_search(&pair).is_ok()
    }
}
