//! Impulses of pairs, identified by the numbers of features within their bodies. Callers keep them in this form while the
//! clusters of bodies change.

use crate::impact::key;
use crate::row::OBSTACLE_BIT;
use crate::touching::Touching;

/// The kinds of pairs: a vertex and a facet, two edges, a point and a surface of an obstacle that holds nodes.
const VERTEX_FACET: u32 = 0;
const EDGES: u32 = 1;
const OF_OBSTACLE: u32 = 2;

impl<const D: usize> Touching<D> {
    /// Returns what the number of a pair stands for: its kind, the body and the number of its first feature, and the body and the number of its
    /// second feature. An obstacle that holds nodes is not a body, and has the number of a surface.
    pub fn features_of(&self, id: u64) -> [u32; 5] {
        let part = |shift: u32| ((id >> shift) & ((1 << 31) - 1)) as u32;
        let (a, b) = (part(31), part(0));
        let body = |point: u32| self.surface.body[point as usize];
        let vertex = |point: u32| [body(point), point - self.surface.points_of(body(point) as usize).start as u32];
        let edge = |edge: u32| {
            let own = body(self.surface.edges[edge as usize][0]);
            [own, edge - self.surface.edges_of(own as usize).start as u32]
        };
        let facet = |facet: u32| {
            let own = body(self.surface.facets[facet as usize][0]);
            [own, facet - self.surface.facets_of(own as usize).start as u32]
        };
        let (kind, first, second) = match id >> 62 {
            0 => (VERTEX_FACET, vertex(a), facet(b)),
            1 => (EDGES, edge(a), edge(b)),
            _ => (OF_OBSTACLE, vertex(a), [0, b]),
        };
        [kind, first[0], first[1], second[0], second[1]]
    }

    /// The number of a pair; `None` if a body has no such feature.
    pub fn id_of(&self, [kind, first, own, second, other]: [u32; 5]) -> Option<u64> {
        let at = |range: core::ops::Range<usize>, local: u32| {
            let number = range.start + local as usize;
            (number < range.end).then_some(number as u32)
        };
        let surface = &self.surface;
        if first as usize >= surface.bodies() || kind != OF_OBSTACLE && second as usize >= surface.bodies() {
            return None;
        }
        let (first, second) = (first as usize, second as usize);
        match kind {
            VERTEX_FACET => {
                Some(key([at(surface.points_of(first), own)?, at(surface.facets_of(second), other)?], true))
            }
            EDGES => Some(key([at(surface.edges_of(first), own)?, at(surface.edges_of(second), other)?], false)),
            _ => Some(OBSTACLE_BIT | u64::from(at(surface.points_of(first), own)?) << 31 | u64::from(other)),
        }
    }
}
