//! Points that are inside another body at the start of a frame: those of bodies that began inside one another and have not come
//! out yet.

use crate::closest::facet_normal;
use crate::gap::Gap;
use crate::touching::Touching;
use crate::vector::{add, dot, scaled};
use core::ops::Range;
use opruga_math::Lane;
use opruga_mesh::winding_number;

/// The cosine of the angle between the normals of a surface and of a facet below which they face each other. The corner of a cube
/// and a facet that it meets have −0.58, a side that begins next to a flat face has 0, and deformation changes both. Without this
/// limit, points near an edge of the other body leave sideways while others do not: `cubes_that_begin_inside_one_another_part`
/// ends with interlocked cubes.
const FACING: f64 = -0.3;

impl<const D: usize> Touching<D> {
    /// Finds the points inside the closed boundary of another body. The pairs of a step are those that may touch in it, and a
    /// point deep inside touches nothing. Only points behind the nearest of their candidates are examined; candidates extend only
    /// to a margin, so deeper points are not found. A nearer facet may not be a candidate, so the whole boundary decides.
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

    /// Whether points of one of two bodies were inside the other one at the start of the frame. Edges of such bodies do not form
    /// pairs: they cross already, and contact between them would lock the bodies together.
    pub(crate) fn are_entangled(&self, [a, b]: [u32; 2]) -> bool {
        let pair = if a < b { [a, b] } else { [b, a] };
        self.entangled.binary_search(&pair).is_ok()
    }

    /// Takes the gap through which a vertex leaves each body in which it began: that of the nearest facet, among some candidates
    /// of the vertex, that faces the surface at the vertex. If none does, the nearest facet counts.
    pub(crate) fn take_exit(&mut self, candidates: Range<usize>, h: f64) {
        let x = &self.before[0];
        let normal = |facet: u32| {
            let normal = facet_normal(&self.surface.facets[facet as usize].map(|p| x[p as usize]));
            scaled(&normal, 1.0 / dot(&normal, &normal).sqrt())
        };
        let vertex = self.candidates.vertex_facet[candidates.start][0];
        let around = self.surface.facets_around(vertex).iter();
        let outward = around.fold([0.0; D], |sum, facet| add(&sum, &normal(*facet)));
        let size = dot(&outward, &outward).sqrt();
        let mut nearest: Vec<(u32, bool, [u32; 2], Gap<D>)> = Vec::new();
        for k in candidates {
            let pair @ [_, facet] = self.candidates.vertex_facet[k];
            let [own, other] = self.clearance.bodies(0, k);
            if own == other || !self.surface.closed[facet as usize] {
                continue;
            }
            let faces = size > 0.0 && dot(&outward, &normal(facet)) < FACING * size;
            let gap = Gap::of_vertex_and_facet(&self.surface, x, vertex, facet);
            let is_better = |known: bool, least: f64| (faces, -gap.gap.abs()) > (known, -least.abs());
            match nearest.iter_mut().find(|(body, ..)| *body == other) {
                Some(best) if is_better(best.1, best.3.gap) => *best = (other, faces, pair, gap),
                Some(_) => {}
                None => nearest.push((other, faces, pair, gap)),
            }
        }
        for (other, _, pair, gap) in nearest.into_iter().filter(|(.., gap)| gap.gap < 0.0) {
            let law = *self.laws.of(self.surface.body[pair[0] as usize], other);
            let surface = &self.surface;
            self.around.retain(|(row, _)| surface.body[row.points[1] as usize] != other);
            self.push(gap, &law, h, pair, true, f64::INFINITY);
        }
    }
}
