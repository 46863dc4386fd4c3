//! Points that begin a frame inside another body: those of bodies that begin inside one another, and have not come out yet.

use crate::gap::Gap;
use crate::touching::Touching;
use opruga_math::Lane;

impl<const D: usize> Touching<D> {
    /// Finds the points that lie inside the closed boundary of another body: behind the nearest of its facets. Pairs of a step are those that may
    /// come to touch in it, and a point deep inside touches nothing. Candidates reach as far as a margin: deeper points are not found.
    pub(crate) fn find_began_inside(&mut self) {
        self.began_inside.clear();
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
            if nearest.iter().any(|(_, gap)| *gap < 0.0) {
                self.began_inside.push(vertex);
            }
        }
    }
}
