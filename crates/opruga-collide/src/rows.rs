//! From candidates to contacts: the relevant gaps.

use crate::ccd::{edge_meets_edge, vertex_meets_facet};
use crate::distances::{Distances, Unclear};
use crate::gap::Gap;
use crate::law::PairLaw;
use crate::near::Near;
use crate::settle::OVERLAP;
use crate::surface::Surface;
use crate::touching::Touching;
use crate::vector::{dot, subtract};
use core::ops::Range;
use opruga_math::Lane;

impl<const D: usize> Touching<D> {
    /// Computes the gaps of all candidates that may touch; rows are in the order of their features.
    pub(crate) fn take_gaps(&mut self, h: f64) {
        self.rows.clear();
        self.watched.clear();
        self.inactive.clear();
        self.heads.clear();
        self.spread.clear();
        self.close.iter_mut().for_each(Vec::clear);
        self.find_unclear();
        let unclear = std::mem::take(&mut self.unclear);
        for own in unclear[0].chunk_by(|a, b| a.features[0] == b.features[0]) {
            self.take_gaps_of_vertex(own, h);
        }
        unclear[1].iter().for_each(|unclear| self.take_gap_of_edges(unclear, h));
        self.unclear = unclear;
        self.put_passing(h);
    }

    /// Lists the candidates that may touch by the bounds of their distances, and computes these distances. All candidates of points that began
    /// inside other bodies are among them, and all of bodies at rest.
    fn find_unclear(&mut self) {
        let Touching { surface, before: [x, _], candidates, clearance, unclear, distances, thickest, .. } = self;
        let of_obstacle = |point: u32| usize::from(surface.is_of_obstacle(point));
        let mut inside = self.began_inside.iter().peekable();
        unclear.iter_mut().for_each(Vec::clear);
        for (k, features @ [vertex, facet]) in candidates.vertex_facet.iter().enumerate() {
            while inside.next_if(|other| *other < vertex).is_some() {}
            let all = self.at_once || inside.peek() == Some(&vertex);
            let farthest = thickest[of_obstacle(*vertex) | of_obstacle(surface.facets[*facet as usize][0])];
            if all || !clearance.is_clear(0, k, farthest) {
                unclear[0].push(Unclear { candidate: k, features: *features, distance: 0.0 });
            }
        }
        let farthest = thickest[0].larger(thickest[1]);
        for (k, features) in candidates.edge_edge.iter().enumerate() {
            if !clearance.is_clear(1, k, farthest) {
                unclear[1].push(Unclear { candidate: k, features: *features, distance: 0.0 });
            }
        }
        for (list, pairs) in unclear.iter_mut().enumerate() {
            candidates.simd.run(Distances { surface, x, pairs, with_facet: list == 0, distances });
            for (pair, distance) in pairs.iter_mut().zip(distances.iter()) {
                pair.distance = *distance;
            }
        }
    }

    /// Computes the gaps of the candidates of one vertex that may touch.
    fn take_gaps_of_vertex(&mut self, unclear: &[Unclear], h: f64) {
        let vertex = unclear[0].features[0];
        self.around.clear();
        let close = self.close[0].len();
        let mut inside = false;
        for Unclear { candidate, distance, .. } in unclear {
            inside |= self.take_gap_of_vertex(*candidate, h, 0.0, *distance);
        }
        let candidates = self.candidates_of(unclear);
        if inside {
            // The nearest facet is needed there, whatever was known before.
            self.around.clear();
            self.close[0].truncate(close);
            self.take_gaps_of(candidates.clone(), h, 0.0, true);
        }
        // A vertex that seems to be deep inside may be outside, in front of a facet that is nearer but beyond the reach.
        let known = -self.reach.push_of(vertex) - self.thickest_at(vertex);
        // Bodies at rest may begin deep inside one another.
        if self.at_once || self.around.iter().any(|(row, _)| row.gap < known) {
            inside |= self.at_once;
            self.around.clear();
            self.take_gaps_of(candidates.clone(), h, 0.25 * self.margin, inside);
        }
        if self.began_inside.binary_search(&vertex).is_ok() {
            self.take_exit(candidates, h);
        }
        self.keep_the_nearest();
        self.take_around(false);
    }

    /// All candidates of the vertex of some of them.
    fn candidates_of(&self, some: &[Unclear]) -> Range<usize> {
        let (all, vertex) = (&self.candidates.vertex_facet, some[0].features[0]);
        let (mut first, mut end) = (some[0].candidate, some[some.len() - 1].candidate + 1);
        while first > 0 && all[first - 1][0] == vertex {
            first -= 1;
        }
        while all.get(end).is_some_and(|pair| pair[0] == vertex) {
            end += 1;
        }
        first..end
    }

    /// Whether features at a distance stay farther apart than another one [m]. The displacement of a point is at most what contact may push it.
    fn stay_apart(&self, distance: f64, other: f64, first: &[u32], second: &[u32]) -> bool {
        let reach = |points: &[u32]| points.iter().fold(0.0, |most: f64, p| self.reach.push_of(*p).larger(most));
        distance > other + 2.0 * (reach(first) + reach(second))
    }

    /// Computes the gap of a candidate of two edges.
    fn take_gap_of_edges(&mut self, unclear: &Unclear, h: f64) {
        let Unclear { candidate, features: pair @ [a, b], distance } = *unclear;
        let edges = pair.map(|e| self.surface.edges[e as usize]);
        let bodies = self.clearance.bodies(1, candidate);
        let law = *self.laws.of(bodies[0], bodies[1]);
        self.clearance.note(1, candidate, distance);
        if self.stay_apart(distance, law.thickness, &edges[0], &edges[1])
            || self.reach.apart(&edges[0], &edges[1]) > law.thickness
        {
            return;
        }
        if self.are_entangled(bodies) {
            return;
        }
        self.close[1].push((pair, distance));
        let Some(mut gap) = Gap::of_edges(&self.surface, &self.before[0], a, b) else { return };
        if bodies[0] == bodies[1] && gap.gap < 0.0 {
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        // Edges deep inside one another are often those of opposite sides: vertices and facets determine the direction out.
        if gap.gap < -law.thickness {
            return;
        }
        self.push(gap, &law, h, pair, false, 0.0);
        self.take_around(true);
    }

    /// Activates pairs, or puts them under watch if they do not meet by themselves. Pairs that cannot move are dropped when they are activated.
    ///
    /// Pairs of edges are inactive at first unless they pressed in the previous step, and so are all pairs of coupled bodies: if
    /// vertices and facets hold surfaces, few edges press, and only a quarter of the pairs near coupled bodies do. Overlapping
    /// pairs are active, because they must be separated.
    fn take_around(&mut self, of_edges: bool) {
        let starts_inactive = !self.at_once && (of_edges || self.coupled.count() > 0 && !self.coupled.apart);
        let overlap = -OVERLAP * self.thickest[0];
        let Touching { around, rows, heads, watched, inactive, last, spread, surface, inverse_mass, .. } = self;
        for (near, meets) in around.drain(..) {
            let mut row = near.into_row(spread, surface);
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

    /// The largest distance that the surface of a point keeps from that of a body [m]. Obstacles come after bodies.
    fn thickest_at(&self, point: u32) -> f64 {
        self.thickest[usize::from(self.surface.is_of_obstacle(point))]
    }

    /// Computes the gaps of some candidates of one vertex that may come closer than a distance [m]: of `all`, or without those
    /// that are known to be farther apart. Returns whether the vertex seems to be inside another body.
    fn take_gaps_of(&mut self, candidates: Range<usize>, h: f64, distance: f64, all: bool) -> bool {
        let mut inside = false;
        for k in candidates {
            let [vertex, facet] = self.candidates.vertex_facet[k];
            let farthest =
                self.thickest_at(vertex).larger(self.thickest_at(self.surface.facets[facet as usize][0])) + distance;
            if !all && self.clearance.is_clear(0, k, farthest) {
                continue;
            }
            inside |= self.take_gap_of_vertex(k, h, distance, f64::NEG_INFINITY);
        }
        inside
    }

    /// Computes the gap of a candidate of a vertex if it may come closer than a distance [m], given its present one (negative behind the plane of the
    /// facet). Returns whether the vertex seems to be inside another body.
    fn take_gap_of_vertex(&mut self, candidate: usize, h: f64, distance: f64, mut separation: f64) -> bool {
        let pair @ [vertex, facet] = self.candidates.vertex_facet[candidate];
        let corners = &self.surface.facets[facet as usize];
        let [own, other] = self.clearance.bodies(0, candidate);
        let law = *self.laws.of(own, other);
        if separation.is_finite() && (own == other || !self.surface.closed[facet as usize]) {
            // There is no inside.
            separation = separation.abs();
        }
        if self.stay_apart(separation, law.thickness + distance, &[vertex], corners) {
            self.clearance.note(0, candidate, separation);
            return false;
        }
        let apart = self.reach.apart(&[vertex], corners);
        if apart > law.thickness + distance {
            self.clearance.note(0, candidate, apart.larger(separation));
            return false;
        }
        let mut gap = Gap::of_vertex_and_facet(&self.surface, &self.before[0], vertex, facet);
        if distance == 0.0 {
            self.close[0].push((pair, gap.gap.abs()));
        }
        if own == other && gap.gap < 0.0 {
            // Contact of a body with itself acts on both sides.
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        // A vertex inside has to come out, however deep it is.
        let inside = gap.gap < 0.0;
        self.clearance.note(0, candidate, if inside { f64::NEG_INFINITY } else { gap.gap });
        self.push(gap, &law, h, pair, true, distance);
        inside
    }

    /// Adds a row for the gap of a vertex and a facet, or of two edges, unless they stay farther apart than a distance [m].
    pub(crate) fn push(
        &mut self,
        mut gap: Gap<D>,
        law: &PairLaw,
        h: f64,
        pair: [u32; 2],
        with_facet: bool,
        distance: f64,
    ) {
        let (first, second) = gap.points.split_at(if with_facet { 1 } else { 2 });
        if self.stay_apart(gap.gap, law.thickness + distance, first, second) {
            return;
        }
        let mut meets = true;
        if gap.gap > law.thickness && !self.at_once && self.goes_far(&gap, with_facet) {
            // The present closest points are not those of the impact.
            let ends = [&self.before[0][..], &self.after[0]];
            let time = meeting_time(&self.surface, ends, law.thickness, pair, with_facet);
            match time.and_then(|time| impact(&self.surface, ends, &mut self.impact, time, pair, with_facet)) {
                Some(then) => gap = then,
                None => meets = false,
            }
        }
        let mut near = self.near(&gap, law, h, pair, with_facet);
        let ([x0, v0], [x1, v1]) = (&self.before, &self.after);
        let (came, comes) = (-gap.along(v0), -gap.along(v1));
        let end = near.gap + gap.along(x1) - gap.along(x0);
        // A pair that pressed bodies at rest in their last correction does so again, unless it turns out that it need not.
        let presses = self.at_once && self.last.binary_search_by_key(&near.id, |(id, ..)| *id).is_ok();
        let meets = meets && (end < 0.0 || near.gap < 0.0 || h * comes > near.gap || presses);
        if law.restitution > 0.0 && meets && near.gap > 0.0 {
            // The pair meets within the step, while the force acts to its end: s² = u² + 2 a g, between the speeds at both ends.
            let square = came * came + 2.0 * (comes - came) / h * near.gap;
            let speed = square.larger(0.0).sqrt().smaller(came.larger(comes)).larger(came.smaller(comes));
            if speed > self.laws.rest_speed {
                near.target = law.restitution * speed;
            }
        }
        self.around.push((near, meets));
    }

    /// A pair whose gap must not become negative within the step.
    pub(crate) fn near(&self, gap: &Gap<D>, law: &PairLaw, h: f64, pair: [u32; 2], with_facet: bool) -> Near<D> {
        let own = gap.gap - law.thickness;
        let target = if own > 0.0 || self.at_once { -own / h } else { 0.0 };
        let Gap { points, weights, normal, .. } = *gap;
        let (thickness, friction) = (law.thickness, law.friction);
        Near { id: key(pair, with_facet), points, weights, normal, gap: own, thickness, friction, target }
    }

    /// Whether the relative motion of a pair within the step exceeds a quarter of a feature.
    fn goes_far(&self, gap: &Gap<D>, with_facet: bool) -> bool {
        let ([x0, _], [x1, _]) = (&self.before, &self.after);
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

    /// Keeps the relevant rows of one vertex: outside of a body, all facets in front of it, each closest point once; inside, the
    /// nearest one, through which it leaves.
    fn keep_the_nearest(&mut self) {
        if self.around.len() < 2 {
            return;
        }
        let body = |row: &Near<D>| self.surface.body[row.points[1] as usize];
        let is_closed = |row: &Near<D>| row.points[1..=D].iter().all(|p| self.surface.is_closed(*p));
        let depth = |row: &Near<D>| row.gap + row.thickness;
        let rows = &self.around;
        self.keep.clear();
        self.keep.resize(rows.len(), true);
        for (j, (row, _)) in rows.iter().enumerate() {
            let own = self.surface.body[row.points[0] as usize];
            let key = features(row);
            for (k, (other, _)) in rows.iter().enumerate() {
                if j == k || body(row) != body(other) {
                    continue;
                }
                let others = features(other);
                let [a, b] = [row, other].map(depth);
                // The same closest point, or one on the rim of a facet over which the vertex is.
                let within = key.iter().all(|p| *p == u32::MAX || others.contains(p));
                if within && (key != others || k < j) {
                    self.keep[j] = false;
                }
                let other_is_nearer = b.abs() < a.abs() || b.abs() == a.abs() && k < j;
                if other_is_nearer && (a < 0.0 || b < 0.0) && own != body(row) && is_closed(row) && is_closed(other) {
                    self.keep[j] = false;
                }
            }
        }
        let mut keep = self.keep.iter();
        self.around.retain(|_| keep.next() == Some(&true));
    }
}

/// The key of a pair of a vertex and a facet, or of two edges.
pub(crate) fn key([a, b]: [u32; 2], with_facet: bool) -> u64 {
    u64::from(!with_facet) << 62 | u64::from(a) << 31 | u64::from(b)
}

/// The fraction of the step at which a vertex comes closer to a facet than a distance [m], or an edge to another one; none if
/// they stay apart.
#[inline]
pub(crate) fn meeting_time<const D: usize>(
    surface: &Surface<D>,
    [x0, x1]: [&[[f64; D]]; 2],
    distance: f64,
    [a, b]: [u32; 2],
    with_facet: bool,
) -> Option<f64> {
    let ends = |p: u32| [x0[p as usize], x1[p as usize]];
    if with_facet {
        let corners = surface.facets[b as usize].map(ends);
        let facet = core::array::from_fn(|end| corners.map(|corner| corner[end]));
        vertex_meets_facet(&ends(a), &facet, distance)
    } else {
        let [a, b] = [a, b].map(|e| surface.edges[e as usize].map(ends));
        let swept = |e: [[[f64; D]; 2]; 2]| [[e[0][0], e[1][0]], [e[0][1], e[1][1]]];
        edge_meets_edge(&swept(a), &swept(b), distance)
    }
}

/// The gap of a pair at the start of the step, with the normal and the weights at a time within it; none for edges that then meet
/// at an end.
pub(crate) fn impact<const D: usize>(
    surface: &Surface<D>,
    [x0, x1]: [&[[f64; D]]; 2],
    moved: &mut [[f64; D]],
    time: f64,
    [a, b]: [u32; 2],
    with_facet: bool,
) -> Option<Gap<D>> {
    // Normals of corners and edges need the facets around.
    let mut go = |p: u32| {
        let (from, to) = (&x0[p as usize], &x1[p as usize]);
        moved[p as usize] = core::array::from_fn(|d| from[d] + time * (to[d] - from[d]));
    };
    let mut go_around = |p: u32| {
        go(p);
        let around = surface.facets_around(p).iter();
        around.flat_map(|facet| surface.facets[*facet as usize]).for_each(&mut go);
    };
    let mut then = if with_facet {
        go_around(a);
        surface.facets[b as usize].into_iter().for_each(go_around);
        Gap::of_vertex_and_facet(surface, moved, a, b)
    } else {
        [a, b].into_iter().flat_map(|edge| surface.edges[edge as usize]).for_each(go_around);
        // For edges that meet at an end, a vertex meets a facet too.
        Gap::of_edges(surface, moved, a, b)?
    };
    // They are apart at the start, so what is in front now stays in front.
    then.gap = then.along(x0);
    if then.gap < 0.0 {
        (then.gap, then.normal) = (-then.gap, then.normal.map(|n| -n));
    }
    Some(then)
}

/// The corners of a facet with nonzero weights at the closest point; the others are `u32::MAX`.
fn features<const D: usize>(row: &Near<D>) -> [u32; 3] {
    let mut out = [u32::MAX; 3];
    for k in (1..=D).filter(|k| row.weights[*k] != 0.0) {
        out[k - 1] = row.points[k];
    }
    out.sort_unstable();
    out
}
