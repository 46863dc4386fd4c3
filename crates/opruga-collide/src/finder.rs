//! The selection of contacts among the candidates, according to their gaps.

use crate::close_pair::ClosePair;
use crate::closest::facet_normal;
use crate::distances::{Distances, Unclear};
use crate::found::Found;
use crate::gap::Gap;
use crate::impact::{impact, meeting_time};
use crate::law::PairLaw;
use crate::reach::SPARE;
use crate::settle::OVERLAP;
use crate::touching::Touching;
use crate::vector::{add, dot, scaled, subtract};
use core::ops::Range;
use opruga_math::Lane;

/// A surface and a facet face each other if the cosine of the angle between their normals is below this number. The cosine is
/// −0.58 for the corner of a cube and a facet that it meets, and 0 for a point of a flat face and a side of the other body that
/// is perpendicular to this face. Deformation changes both values. Without this limit, points near an edge of the other body
/// leave sideways while others do not, and the cubes of `cubes_that_begin_inside_one_another_part` end up interlocked.
const FACING: f64 = -0.3;

/// Finds, in one part of the candidates, the pairs that come close in a step of h [s].
pub(crate) struct Finder<'a, const D: usize> {
    pub(crate) touching: &'a Touching<D>,
    pub(crate) found: &'a mut Found<D>,
    pub(crate) h: f64,
}

impl<const D: usize> Finder<'_, D> {
    /// Computes the gaps of all candidates that may touch, in the order of their features.
    pub(crate) fn find(&mut self) {
        self.find_unclear();
        let mut unclear = std::mem::take(&mut self.found.unclear);
        self.found.notes.clear();
        for own in unclear[0].chunk_by_mut(|a, b| a.features[0] == b.features[0]) {
            self.take_gaps_of_vertex(own);
        }
        unclear[1].iter().for_each(|unclear| self.take_gap_of_edges(unclear));
        self.found.unclear = unclear;
    }

    /// Lists the candidates that may touch according to the bounds on their distances, and computes the distances of these candidates. The
    /// list includes all candidates of points that began inside other bodies, and all candidates of bodies at rest.
    fn find_unclear(&mut self) {
        let Touching { surface, before: [x, _], candidates, clearance, began_inside, at_once, .. } = self.touching;
        let Found { part, unclear, .. } = &mut *self.found;
        unclear.iter_mut().for_each(Vec::clear);
        let mut inside = began_inside.iter().peekable();
        for k in part[0].clone() {
            let features @ [vertex, _] = candidates.vertex_facet[k];
            while inside.next_if(|other| **other < vertex).is_some() {}
            let all = *at_once || inside.peek() == Some(&&vertex);
            if all || !clearance.is_clear(0, k, 0.0) {
                unclear[0].push(Unclear { candidate: k, features, distance: 0.0 });
            }
        }
        for k in part[1].clone() {
            if !clearance.is_clear(1, k, 0.0) {
                unclear[1].push(Unclear { candidate: k, features: candidates.edge_edge[k], distance: 0.0 });
            }
        }
        for (list, pairs) in unclear.iter_mut().enumerate() {
            candidates.simd.run(Distances { surface, x, pairs, with_facet: list == 0 });
        }
    }

    /// Computes the gaps of the candidates of one vertex that may touch.
    fn take_gaps_of_vertex(&mut self, unclear: &mut [Unclear]) {
        let vertex = unclear[0].features[0];
        self.found.around.clear();
        let close = self.found.close[0].len();
        let mut inside = false;
        for Unclear { candidate, distance, .. } in unclear.iter_mut() {
            *distance = self.take_gap_of_vertex(*candidate, 0.0, *distance);
            inside |= *distance == f64::NEG_INFINITY;
        }
        if inside {
            // For a vertex inside a body, the nearest facet is needed, so all candidates are examined, whatever their bounds
            // are.
            self.found.around.clear();
            self.found.close[0].truncate(close);
            self.take_gaps_of(self.candidates_of(unclear), 0.0, true);
        }
        // A vertex that seems to be deep inside may be in front of a nearer facet, which was left out because the vertex cannot
        // reach it in this step.
        let known = -self.touching.reach.push_of(vertex) - self.thickest_at(vertex);
        // Bodies at rest may begin deep inside one another.
        if self.touching.at_once || self.found.around.iter().any(|(row, _)| row.gap < known) {
            inside |= self.touching.at_once;
            self.found.around.clear();
            self.take_gaps_of(self.candidates_of(unclear), SPARE * self.touching.margin, inside);
        }
        if self.touching.began_inside.binary_search(&vertex).is_ok() {
            self.take_exit(self.candidates_of(unclear));
        }
        self.keep_the_nearest();
        self.take_around(false);
    }

    /// The range of all candidates that have the same vertex as some given ones.
    fn candidates_of(&self, some: &[Unclear]) -> Range<usize> {
        let (all, vertex) = (&self.touching.candidates.vertex_facet, some[0].features[0]);
        let (mut first, mut end) = (some[0].candidate, some[some.len() - 1].candidate + 1);
        while first > 0 && all[first - 1][0] == vertex {
            first -= 1;
        }
        while all.get(end).is_some_and(|pair| pair[0] == vertex) {
            end += 1;
        }
        first..end
    }

    /// Whether features at a given distance stay farther apart than another distance [m]. The free motion of a point is no longer than the
    /// distance by which contact may push it, so no point moves by more than twice this distance.
    fn stay_apart(&self, distance: f64, other: f64, first: &[u32], second: &[u32]) -> bool {
        let reach =
            |points: &[u32]| points.iter().fold(0.0, |most: f64, p| self.touching.reach.push_of(*p).larger(most));
        distance > other + 2.0 * (reach(first) + reach(second))
    }

    /// Computes the gap of a candidate of two edges.
    fn take_gap_of_edges(&mut self, unclear: &Unclear) {
        let Unclear { candidate, features: pair @ [a, b], distance } = *unclear;
        let edges = pair.map(|e| self.touching.surface.edges[e as usize]);
        let bodies = self.touching.clearance.bodies(1, candidate);
        let law = *self.touching.laws.of(bodies[0], bodies[1]);
        if self.stay_apart(distance, law.thickness, &edges[0], &edges[1])
            || self.touching.reach.apart(&edges[0], &edges[1]) > law.thickness
        {
            return;
        }
        if self.touching.are_entangled(bodies) {
            return;
        }
        self.found.close[1].push((pair, distance));
        let Some(mut gap) = Gap::of_edges(&self.touching.surface, &self.touching.before[0], a, b) else { return };
        if bodies[0] == bodies[1] && gap.gap < 0.0 {
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        // Edges that are deep inside one another often belong to opposite sides of the bodies. Vertices and facets then
        // determine the direction out.
        if gap.gap < -law.thickness {
            return;
        }
        self.push(gap, &law, pair, false, 0.0);
        self.take_around(true);
    }

    /// Activates the pairs around a vertex or of two edges. Pairs that would not meet in the free motion are only watched.
    /// Pairs that cannot move are dropped when they are activated.
    ///
    /// Pairs of edges are inactive at first unless they pressed in the previous step. The same is true of all pairs if there are
    /// coupled bodies. Where contacts of vertices and facets already keep surfaces apart, few edges press. Near coupled bodies,
    /// only a quarter of the pairs press. Overlapping pairs are active, because they must be separated.
    fn take_around(&mut self, of_edges: bool) {
        let starts_inactive =
            !self.touching.at_once && (of_edges || self.touching.coupled.count() > 0 && !self.touching.coupled.apart);
        let overlap = -OVERLAP * self.touching.thickest[0];
        let Touching { surface, inverse_mass, last, .. } = self.touching;
        let Found { around, rows, heads, watched, inactive, spread, .. } = &mut *self.found;
        for (close, meets) in around.drain(..) {
            let mut row = close.into_row(spread, surface);
            if !meets {
                heads.push(row.head());
                watched.push(row);
            } else if starts_inactive
                && row.gap >= overlap
                && last.binary_search_by_key(&row.id, |(id, ..)| *id).is_err()
            {
                inactive.push(row);
            } else if row.can_move(spread, inverse_mass) {
                rows.push(row);
            }
        }
    }

    /// The largest distance that the surface of a point keeps from the surface of another body [m].
    fn thickest_at(&self, point: u32) -> f64 {
        self.touching.thickest[usize::from(self.touching.surface.is_of_obstacle(point))]
    }

    /// Computes the gaps of those among some candidates of one vertex that may come closer than a distance [m]. Unless `all` is
    /// set, candidates that are known to be farther apart are skipped. Returns whether the vertex seems to be inside another
    /// body.
    fn take_gaps_of(&mut self, candidates: Range<usize>, distance: f64, all: bool) -> bool {
        let mut inside = false;
        for k in candidates {
            if !all && self.touching.clearance.is_clear(0, k, distance) {
                continue;
            }
            let known = self.take_gap_of_vertex(k, distance, f64::NEG_INFINITY);
            self.found.notes.push((k, known));
            inside |= known == f64::NEG_INFINITY;
        }
        inside
    }

    /// Computes the gap of a candidate of a vertex if it may come closer than a distance [m], given its present distance (negative behind the plane
    /// of the facet). Returns a lower bound on the distance, for later steps: −∞ if the vertex seems to be inside another body and has to come out,
    /// however deep it is.
    fn take_gap_of_vertex(&mut self, candidate: usize, distance: f64, mut separation: f64) -> f64 {
        let pair @ [vertex, facet] = self.touching.candidates.vertex_facet[candidate];
        let corners = &self.touching.surface.facets[facet as usize];
        let [own, other] = self.touching.clearance.bodies(0, candidate);
        let law = *self.touching.laws.of(own, other);
        if separation.is_finite() && (own == other || !self.touching.surface.closed[facet as usize]) {
            // Such a facet has no inner side.
            separation = separation.abs();
        }
        if self.stay_apart(separation, law.thickness + distance, &[vertex], corners) {
            return separation;
        }
        let apart = self.touching.reach.apart(&[vertex], corners);
        if apart > law.thickness + distance {
            return apart.larger(separation);
        }
        let mut gap = Gap::of_vertex_and_facet(&self.touching.surface, &self.touching.before[0], vertex, facet);
        if distance == 0.0 {
            self.found.close[0].push((pair, gap.gap.abs()));
        }
        if own == other && gap.gap < 0.0 {
            // Contact of a body with itself acts on both sides.
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        self.push(gap, &law, pair, true, distance);
        if gap.gap < 0.0 { f64::NEG_INFINITY } else { gap.gap }
    }

    /// Adds a row for the gap of a vertex and a facet, or of two edges, unless they stay farther apart than a distance [m].
    fn push(&mut self, mut gap: Gap<D>, law: &PairLaw, pair: [u32; 2], with_facet: bool, distance: f64) {
        let (first, second) = gap.points.split_at(if with_facet { 1 } else { 2 });
        if self.stay_apart(gap.gap, law.thickness + distance, first, second) {
            return;
        }
        let mut meets = true;
        if gap.gap > law.thickness && !self.touching.at_once && self.goes_far(&gap, with_facet) {
            // The closest points at the start of the step are not those at the impact.
            self.found.impact.resize(self.touching.surface.points(), [0.0; D]);
            let ends = [&self.touching.before[0][..], &self.touching.after[0]];
            let time = meeting_time(&self.touching.surface, ends, law.thickness, pair, with_facet);
            match time
                .and_then(|time| impact(&self.touching.surface, ends, &mut self.found.impact, time, pair, with_facet))
            {
                Some(then) => gap = then,
                None => meets = false,
            }
        }
        let mut close = self.touching.close_pair(&gap, law, self.h, pair, with_facet);
        let ([x0, v0], [x1, v1]) = (&self.touching.before, &self.touching.after);
        let (came, comes) = (-gap.along(v0), -gap.along(v1));
        let end = close.gap + gap.along(x1) - gap.along(x0);
        // For bodies at rest, a pair that pressed in the previous correction is assumed to press again; the solution may show
        // that it does not.
        let presses =
            self.touching.at_once && self.touching.last.binary_search_by_key(&close.id, |(id, ..)| *id).is_ok();
        let meets = meets && (end < 0.0 || close.gap < 0.0 || self.h * comes > close.gap || presses);
        if law.restitution > 0.0 && meets && close.gap > 0.0 {
            // The pair meets within the step, but the force acts until the end of the step. The speed s of the impact therefore
            // follows from s² = u² + 2 a g, with the approach u and the gap g at the start of the step and the acceleration a.
            // It is limited to the range between the approaches at both ends of the step.
            let square = came * came + 2.0 * (comes - came) / self.h * close.gap;
            let speed = square.larger(0.0).sqrt().smaller(came.larger(comes)).larger(came.smaller(comes));
            if speed > self.touching.laws.rest_speed {
                close.target = law.restitution * speed;
            }
        }
        self.found.around.push((close, meets));
    }

    /// Whether the relative displacement of a pair within the step exceeds a quarter of the length of an edge of its features.
    fn goes_far(&self, gap: &Gap<D>, with_facet: bool) -> bool {
        let ([x0, _], [x1, _]) = (&self.touching.before, &self.touching.after);
        let first = usize::from(with_facet);
        let edge = subtract(&x0[gap.points[first + 1] as usize], &x0[gap.points[first] as usize]);
        let mut travel = [0.0; D];
        for (p, w) in gap.points.iter().zip(&gap.weights) {
            for d in 0..D {
                travel[d] += w * (x1[*p as usize][d] - x0[*p as usize][d]);
            }
        }
        16.0 * dot(&travel, &travel) > dot(&edge, &edge)
    }

    /// Keeps the relevant rows of one vertex. If the vertex is outside a body, these are the rows of all facets that have the vertex in front of
    /// them, one row for each closest point. If the vertex is inside, it is the row of the nearest facet, through which the vertex leaves.
    fn keep_the_nearest(&mut self) {
        if self.found.around.len() < 2 {
            return;
        }
        let surface = &self.touching.surface;
        let Found { around, keep, .. } = &mut *self.found;
        let body = |row: &ClosePair<D>| surface.body[row.points[1] as usize];
        let is_closed = |row: &ClosePair<D>| row.points[1..=D].iter().all(|p| surface.is_closed(*p));
        let depth = |row: &ClosePair<D>| row.gap + row.thickness;
        let rows = &*around;
        keep.clear();
        keep.resize(rows.len(), true);
        for (j, (row, _)) in rows.iter().enumerate() {
            let own = surface.body[row.points[0] as usize];
            let key = features(row);
            for (k, (other, _)) in rows.iter().enumerate() {
                if j == k || body(row) != body(other) {
                    continue;
                }
                let others = features(other);
                let [a, b] = [row, other].map(depth);
                // Both rows have the same closest point, or the closest point of this row is on the rim of the other facet,
                // which has a nearer point.
                let within = key.iter().all(|p| *p == u32::MAX || others.contains(p));
                if within && (key != others || k < j) {
                    keep[j] = false;
                }
                let other_is_nearer = b.abs() < a.abs() || b.abs() == a.abs() && k < j;
                if other_is_nearer && (a < 0.0 || b < 0.0) && own != body(row) && is_closed(row) && is_closed(other) {
                    keep[j] = false;
                }
            }
        }
        let mut keep = keep.iter();
        around.retain(|_| keep.next() == Some(&true));
    }

    /// For each body in which a vertex began, takes the gap through which the vertex leaves. Among the given candidates of the vertex, it is the gap
    /// of the nearest facet that faces the surface at the vertex. If no facet faces it, the nearest facet counts.
    fn take_exit(&mut self, candidates: Range<usize>) {
        let x = &self.touching.before[0];
        let normal = |facet: u32| {
            let normal = facet_normal(&self.touching.surface.facets[facet as usize].map(|p| x[p as usize]));
            scaled(&normal, 1.0 / dot(&normal, &normal).sqrt())
        };
        let vertex = self.touching.candidates.vertex_facet[candidates.start][0];
        let around = self.touching.surface.facets_around(vertex).iter();
        let outward = around.fold([0.0; D], |sum, facet| add(&sum, &normal(*facet)));
        let size = dot(&outward, &outward).sqrt();
        let mut nearest: Vec<(u32, bool, [u32; 2], Gap<D>)> = Vec::new();
        for k in candidates {
            let pair @ [_, facet] = self.touching.candidates.vertex_facet[k];
            let [own, other] = self.touching.clearance.bodies(0, k);
            if own == other || !self.touching.surface.closed[facet as usize] {
                continue;
            }
            let faces = size > 0.0 && dot(&outward, &normal(facet)) < FACING * size;
            let gap = Gap::of_vertex_and_facet(&self.touching.surface, x, vertex, facet);
            let is_better = |known: bool, least: f64| (faces, -gap.gap.abs()) > (known, -least.abs());
            match nearest.iter_mut().find(|(body, ..)| *body == other) {
                Some(best) if is_better(best.1, best.3.gap) => *best = (other, faces, pair, gap),
                Some(_) => {}
                None => nearest.push((other, faces, pair, gap)),
            }
        }
        for (other, _, pair, gap) in nearest.into_iter().filter(|(.., gap)| gap.gap < 0.0) {
            let law = *self.touching.laws.of(self.touching.surface.body[pair[0] as usize], other);
            let surface = &self.touching.surface;
            self.found.around.retain(|(row, _)| surface.body[row.points[1] as usize] != other);
            self.push(gap, &law, pair, true, f64::INFINITY);
        }
    }
}

/// The corners of a facet with nonzero weights at the closest point; the others are `u32::MAX`.
fn features<const D: usize>(row: &ClosePair<D>) -> [u32; 3] {
    let mut out = [u32::MAX; 3];
    for k in (1..=D).filter(|k| row.weights[*k] != 0.0) {
        out[k - 1] = row.points[k];
    }
    out.sort_unstable();
    out
}
