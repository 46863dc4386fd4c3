//! Points that are inside another body at the start of a frame, because their bodies began inside one another and have not come out yet.

use crate::gap::Gap;
use crate::touching::Touching;
use opruga_math::Lane;
use opruga_mesh::winding_number;

impl<const D: usize> Touching<D> {
    /// Finds the points inside the closed boundary of another body. The pairs of a step do not include them, because a point deep inside touches
    /// nothing. A point is examined if it is behind the nearest of the facets with which it forms candidates. Candidates extend only to a margin, so
    /// deeper points are not found. The candidates may lack a nearer facet. Therefore, the whole boundary decides whether the point is inside.
    pub(crate) fn find_began_inside(&mut self) {
        self.began_inside.clear();
        self.entangled.clear();
        let x = &self.before[0];
        let mut boxes = vec![[[f64::INFINITY; D], [f64::NEG_INFINITY; D]]; self.surface.bodies()];
        for (number, [low, high]) in boxes.iter_mut().enumerate() {
            for p in self.surface.vertices_of(number) {
                for d in 0..D {
                    low[d] = x[p][d].smaller(low[d]);
                    high[d] = x[p][d].larger(high[d]);
                }
            }
        }
        // Bodies are numbered in the order of their facets.
        let mut body_of = Vec::with_capacity(self.surface.facets.len());
        for number in 0..self.surface.bodies() {
            body_of.resize(self.surface.facets_of(number).end, number as u32);
        }
        for pairs in self.candidates.vertex_facet.chunk_by(|a, b| a[0] == b[0]) {
            let vertex = pairs[0][0];
            let at = &x[vertex as usize];
            let mut nearest: Vec<(u32, f64)> = Vec::new();
            for [_, facet] in pairs {
                let corners = &self.surface.facets[*facet as usize];
                let other = body_of[*facet as usize];
                let [low, high] = &boxes[other as usize];
                let within = (0..D).all(|d| low[d] <= at[d] && at[d] <= high[d]);
                let of_other = self.surface.body[corners[0] as usize] != self.surface.body[vertex as usize];
                if !within || !of_other || !self.surface.closed[*facet as usize] {
                    continue;
                }
                let gap = Gap::of_vertex_and_facet(&self.surface, x, vertex, *facet).gap;
                match nearest.iter_mut().find(|(body, _)| *body == other) {
                    Some((_, known)) if gap.abs() < known.abs() => *known = gap,
                    Some(_) => {}
                    None => nearest.push((other, gap)),
                }
            }
            let is_inside = |other: u32| {
                // Facets of closed boundaries come first.
                let all = self.surface.facets_of(other as usize);
                let closed = self.surface.closed[all.clone()].partition_point(|closed| *closed);
                let boundary = &self.surface.facets[all.start..all.start + closed];
                winding_number(boundary, x, at).abs() > 0.5
            };
            let mut inside = nearest.iter().filter(|(other, gap)| *gap < 0.0 && is_inside(*other)).peekable();
            if inside.peek().is_some() {
                self.began_inside.push(vertex);
            }
            let body = self.surface.body[vertex as usize];
            self.entangled.extend(inside.map(|(other, _)| {
                let other = self.surface.body[self.surface.vertices_of(*other as usize).start];
                if body < other { [body, other] } else { [other, body] }
            }));
        }
        self.entangled.sort_unstable();
        self.entangled.dedup();
    }

    /// Whether points of one of two bodies were inside the other one at the start of the frame. Edges of two such bodies do not
    /// form pairs: they cross already, and contact between them would lock the bodies together.
    pub(crate) fn are_entangled(&self, [a, b]: [u32; 2]) -> bool {
        let pair = if a < b { [a, b] } else { [b, a] };
        self.entangled.binary_search(&pair).is_ok()
    }
}
