//! Impulses that pass from one substep to the next. Callers keep them while the clusters of bodies change, identified by the numbers of features
//! within their bodies.

use crate::impact::{features_in, key};
use crate::last_impulse::{LastImpulse, NO_BODIES, number_of};
use crate::lists;
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

    /// The bodies of a contact in one number, given the key of its features.
    fn bodies_in(&self, id: u64) -> u64 {
        if id & OBSTACLE_BIT != 0 {
            return NO_BODIES;
        }
        let (features, with_facet) = features_in(id);
        number_of(
            self.surface.points_of_features(&features, with_facet).map(|points| self.surface.body[points[0] as usize]),
        )
    }

    /// The impulse of a contact between two bodies in the previous substep; `None` if it did not press.
    pub(crate) fn last_of(&self, bodies: [u32; 2], id: u64) -> Option<&LastImpulse<D>> {
        let key = (number_of(bodies), id);
        self.last.binary_search_by_key(&key, |last| (last.bodies, last.id)).ok().map(|k| &self.last[k])
    }

    /// Keeps the impulses for the next substep.
    pub(crate) fn keep_impulses(&mut self) {
        let nothing = LastImpulse { bodies: 0, id: 0, along: 0.0, across: [0.0; D] };
        self.last.clear();
        lists::resize(&mut self.last, self.rows.len(), nothing);
        for (row, k) in self.rows.iter().zip(self.turns.order()) {
            // The list of pairs of bodies may have changed since the rows were made, so their indices in it do not count.
            let bodies = self.bodies_in(row.id);
            let (id, along, across) = (row.id, row.normal_impulse, row.friction_impulse);
            self.last[*k as usize] = LastImpulse { bodies, id, along, across };
        }
        self.last.retain(|last| last.along > 0.0);
    }

    /// Applies the impulses of the previous substep. Contacts between bodies contain these impulses already; those with obstacles that hold points
    /// get them here.
    pub(crate) fn start_warm(&mut self) {
        let mut k = self.last.partition_point(|last| last.bodies < NO_BODIES);
        for row in &mut self.rows {
            if row.of_obstacle {
                while self.last.get(k).is_some_and(|last| last.id < row.id) {
                    k += 1;
                }
                if let Some(last) = self.last.get(k).filter(|last| last.id == row.id) {
                    (row.normal_impulse, row.friction_impulse) = (last.along, last.across);
                }
            }
            if row.normal_impulse > 0.0 {
                let impulse = row.impulse();
                if row.coupled {
                    self.coupled.give(row.on(&self.spread), &impulse, &self.inverse_mass, &mut self.v);
                } else {
                    row.give(&self.spread, &impulse, &self.inverse_mass, &mut self.v);
                }
            }
        }
    }

    /// Calls `visit` with the pressing pairs, in the form of [`Touching::features_of`], and their impulses of the previous step
    /// along and across their normals [N s].
    pub fn visit_kept(&self, mut visit: impl FnMut([u32; 5], f64, [f64; D])) {
        for LastImpulse { id, along, across, .. } in &self.last {
            visit(self.features_of(*id), *along, *across);
        }
    }

    /// Lets the next step start from these impulses.
    pub fn keep(&mut self, pairs: impl Iterator<Item = (u64, f64, [f64; D])>) {
        let mut last = std::mem::take(&mut self.last);
        last.clear();
        last.extend(pairs.map(|(id, along, across)| {
            let bodies = self.bodies_in(id);
            LastImpulse { bodies, id, along, across }
        }));
        last.sort_by_key(|last| (last.bodies, last.id));
        self.last = last;
    }
}
