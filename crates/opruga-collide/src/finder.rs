//! The selection of contacts among the candidates, according to their gaps.

use crate::body_pairs::BodyPair;
use crate::close_pair::ClosePair;
use crate::closest::facet_normal;
use crate::distances::Distances;
use crate::found::Found;
use crate::gap::Gap;
use crate::impact::{impact, meeting_time};
use crate::last_impulse::number_of;
use crate::law::PairLaw;
use crate::lists;
use crate::reach::SPARE;
use crate::settle::OVERLAP;
use crate::touching::Touching;
use crate::unclear::{FindUnclear, Unclear};
use crate::vector::{add, dot, scaled, subtract};
use core::ops::Range;
use opruga_math::Lane;

/// A surface and a facet face each other if the cosine of the angle between their normals is below this number. The cosine is
/// −0.58 for the corner of a cube and a facet that it meets, and 0 for a point of a flat face and a side of the other body that
/// is perpendicular to this face. Deformation changes both values. Without this limit, points near an edge of the other body
/// leave sideways while others do not, and the cubes of `cubes_that_begin_inside_one_another_part` end up interlocked.
const FACING: f64 = -0.3;

/// The range of impulses before the first search for those of a pair.
const NOT_SOUGHT: Range<usize> = usize::MAX..usize::MAX;

/// Finds, in one part of the candidates, the pairs that come close in a step of h [s].
pub(crate) struct Finder<'a, const D: usize> {
    pub(crate) touching: &'a Touching<D>,
    pub(crate) found: &'a mut Found<D>,
    pub(crate) h: f64,
}

/// What all candidates of one vertex and two bodies have in common.
struct Kind {
    /// The index of the pair of bodies.
    pair: u32,
    /// The body of the vertex and that of the facet.
    own: u32,
    other: u32,
    /// The displacement of the bodies relative to one another in the free motion [m].
    relative: f64,
    law: PairLaw,
}

impl<const D: usize> Finder<'_, D> {
    /// Computes the gaps of all candidates that may touch, in the order of their bodies and features.
    pub(crate) fn find(&mut self) {
        self.find_unclear();
        let [mut with_facets, of_edges] = std::mem::take(&mut self.found.unclear);
        self.found.notes.clear();
        self.found.last = NOT_SOUGHT;
        let mut edges = of_edges.iter().peekable();
        let vertices = &self.touching.pairs.features[0];
        let vertex = |unclear: &Unclear| unclear.features(vertices)[0];
        for own in with_facets.chunk_by_mut(|a, b| a.pair == b.pair && vertex(a) == vertex(b)) {
            while let Some(earlier) = edges.next_if(|edges| edges.pair < own[0].pair) {
                self.take_gap_of_edges(earlier);
            }
            self.take_gaps_of_vertex(own);
        }
        edges.for_each(|unclear| self.take_gap_of_edges(unclear));
        self.found.unclear = [with_facets, of_edges];
    }

    /// Lists the candidates that may touch according to the bounds on their distances, and computes the distances of these candidates. The
    /// list includes all candidates of points that began inside other bodies, and all candidates of bodies at rest.
    fn find_unclear(&mut self) {
        let Touching { surface, before: [x, _], pairs: known, pieces, began_inside, at_once, .. } = self.touching;
        let Found { part, unclear, least, .. } = &mut *self.found;
        unclear.iter_mut().for_each(Vec::clear);
        least.clear();
        let pieces = &pieces[part.clone()];
        let everywhere = *at_once || !began_inside.is_empty();
        known.simd.run(FindUnclear { known, pieces, lists: [!everywhere, true], beyond: 0.0, unclear, least });
        if everywhere {
            let vertices = &mut unclear[0];
            for (pair, _, range) in pieces.iter().filter(|(_, list, _)| *list == 0) {
                for (k, features) in range.clone().zip(&known.features[0][range.clone()]) {
                    let all = *at_once || began_inside.binary_search(&features[0]).is_ok();
                    if all || !known.is_clear(*pair as usize, 0, k, 0.0) {
                        lists::push(vertices, Unclear { candidate: k as u32, pair: *pair, distance: 0.0 });
                    }
                }
            }
        }
        for (list, pairs) in unclear.iter_mut().enumerate() {
            known.simd.run(Distances { surface, x, pairs, features: &known.features[list], with_facet: list == 0 });
        }
    }

    /// Computes the gaps of the candidates of one vertex that may touch.
    fn take_gaps_of_vertex(&mut self, unclear: &mut [Unclear]) {
        let features = &self.touching.pairs.features[0];
        let vertex = unclear[0].features(features)[0];
        self.found.around.clear();
        let close = self.found.close[0].len();
        let mut inside = false;
        let pair = unclear[0].pair;
        let kind = self.kind_of(pair, vertex);
        for unclear in unclear.iter_mut() {
            unclear.distance = self.take_gap_of_vertex(&kind, &unclear.features(features), 0.0, unclear.distance);
            inside |= unclear.distance == f64::NEG_INFINITY;
        }
        if inside {
            // For a vertex inside a body, the nearest facet is needed, so all candidates are examined, whatever their bounds
            // are.
            self.found.around.clear();
            self.found.close[0].truncate(close);
            self.take_gaps_of(&kind, self.candidates_of(unclear), 0.0, true);
        }
        // A vertex that seems to be deep inside may be in front of a nearer facet, which was left out because the vertex cannot
        // reach it in this step.
        let known = -self.touching.reach.push_of(vertex) - self.thickest_at(vertex);
        // Bodies at rest may begin deep inside one another.
        if self.touching.at_once || self.found.around.iter().any(|(row, _)| row.gap < known) {
            inside |= self.touching.at_once;
            self.found.around.clear();
            self.take_gaps_of(&kind, self.candidates_of(unclear), SPARE * self.touching.margin, inside);
        }
        let began_inside = &self.touching.began_inside;
        if !began_inside.is_empty() && began_inside.binary_search(&vertex).is_ok() {
            self.take_exit(pair, self.candidates_of(unclear));
        }
        self.keep_the_nearest();
        self.take_around(pair, false);
    }

    fn kind_of(&self, pair: u32, vertex: u32) -> Kind {
        let Touching { pairs, laws, .. } = self.touching;
        let BodyPair { bodies: [a, b], relative, .. } = pairs.all[pair as usize];
        let own = self.body_of(vertex);
        let other = if own == a { b } else { a };
        Kind { pair, own, other, relative, law: *laws.of(own, other) }
    }

    fn body_of(&self, point: u32) -> u32 {
        self.touching.surface.body[point as usize]
    }

    /// The range of all candidates of the same bodies that have the same vertex as some given ones.
    fn candidates_of(&self, some: &[Unclear]) -> Range<usize> {
        let all = self.touching.pairs.all[some[0].pair as usize].range(0);
        let vertices = &self.touching.pairs.features[0];
        let [vertex, _] = some[0].features(vertices);
        let (mut first, mut end) = (some[0].candidate as usize, some[some.len() - 1].candidate as usize + 1);
        while first > all.start && vertices[first - 1][0] == vertex {
            first -= 1;
        }
        while end < all.end && vertices[end][0] == vertex {
            end += 1;
        }
        first..end
    }

    /// Computes the gap of a candidate of two edges.
    fn take_gap_of_edges(&mut self, unclear: &Unclear) {
        let Unclear { pair: number, distance, .. } = *unclear;
        let pair @ [a, b] = unclear.features(&self.touching.pairs.features[1]);
        let edges = pair.map(|e| self.touching.surface.edges[e as usize]);
        let BodyPair { bodies, relative, .. } = self.touching.pairs.all[number as usize];
        let law = *self.touching.laws.of(bodies[0], bodies[1]);
        let farthest = law.thickness + self.touching.reach.moves_of(&edges[0], &edges[1]) + relative;
        if distance > farthest || self.touching.reach.apart(bodies, &edges[0], &edges[1]) > law.thickness {
            return;
        }
        if self.touching.are_entangled(bodies) {
            return;
        }
        lists::push(&mut self.found.close[1], (pair, distance));
        let Some(mut gap) = Gap::of_edges(&self.touching.surface, &self.touching.before[0][..], a, b) else { return };
        if bodies[0] == bodies[1] && gap.gap < 0.0 {
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        // Edges that are deep inside one another often belong to opposite sides of the bodies. Vertices and facets then
        // determine the direction out.
        if gap.gap < -law.thickness {
            return;
        }
        if gap.gap > farthest {
            return;
        }
        self.push(gap, &law, (pair, number), false);
        self.take_around(number, true);
    }

    /// Activates the pairs around a vertex or of two edges. Pairs that would not meet in the free motion are only watched.
    /// Pairs that cannot move are dropped when they are activated.
    ///
    /// Pairs of edges are inactive at first unless they pressed in the previous step. The same is true of all pairs if there are
    /// coupled bodies. Where contacts of vertices and facets already keep surfaces apart, few edges press. Near coupled bodies,
    /// only a quarter of the pairs press. Overlapping pairs are active, because they must be separated.
    fn take_around(&mut self, pair: u32, of_edges: bool) {
        if self.found.around.is_empty() {
            return;
        }
        self.seek_last(pair);
        let starts_inactive =
            !self.touching.at_once && (of_edges || self.touching.coupled.count() > 0 && !self.touching.coupled.apart);
        let overlap = -OVERLAP * self.touching.thickest[0];
        let Touching { surface, inverse_mass, last, .. } = self.touching;
        let Found { around, rows, heads, watched, inactive, spread, last: of_pair, .. } = &mut *self.found;
        let last = &last[of_pair.clone()];
        for (close, meets) in around.drain(..) {
            let mut row = close.into_row(spread, surface);
            if !meets {
                lists::push(heads, row.head());
                lists::push(watched, close);
                continue;
            }
            let pressed = last.binary_search_by_key(&row.id, |last| last.id);
            if starts_inactive && row.gap >= overlap && pressed.is_err() {
                lists::push(inactive, row);
            } else if row.can_move(spread, inverse_mass) {
                if let Ok(k) = pressed {
                    (row.normal_impulse, row.friction_impulse) = (last[k].along, last[k].across);
                }
                lists::push(rows, row);
            }
        }
    }

    /// Finds the impulses of a pair of bodies in the previous substep. Pairs come in ascending order.
    fn seek_last(&mut self, pair: u32) {
        let last = &self.touching.last;
        let bodies = number_of(self.touching.pairs.all[pair as usize].bodies);
        let range = &mut self.found.last;
        if *range == NOT_SOUGHT {
            range.start = last.partition_point(|last| last.bodies < bodies);
            range.end = range.start;
        }
        if last.get(range.start).is_some_and(|last| last.bodies < bodies) {
            range.start = range.end;
            while last.get(range.start).is_some_and(|last| last.bodies < bodies) {
                range.start += 1;
            }
            range.end = range.start;
        }
        while last.get(range.end).is_some_and(|last| last.bodies == bodies) {
            range.end += 1;
        }
    }

    /// The largest distance that the surface of a point keeps from the surface of another body [m].
    fn thickest_at(&self, point: u32) -> f64 {
        self.touching.thickest[usize::from(self.touching.surface.is_of_obstacle(point))]
    }

    /// Computes the gaps of those among some candidates of one vertex that may come closer than a distance [m]. Unless `all` is
    /// set, candidates that are known to be farther apart are skipped. Returns whether the vertex seems to be inside another
    /// body.
    fn take_gaps_of(&mut self, kind: &Kind, candidates: Range<usize>, distance: f64, all: bool) -> bool {
        let mut inside = false;
        let pairs = &self.touching.pairs;
        for k in candidates {
            if !all && pairs.is_clear(kind.pair as usize, 0, k, distance) {
                continue;
            }
            let known = self.take_gap_of_vertex(kind, &pairs.features[0][k], distance, f64::NEG_INFINITY);
            self.found.notes.push((kind.pair, k, known));
            inside |= known == f64::NEG_INFINITY;
        }
        inside
    }

    /// Computes the gap of a candidate of a vertex if it may come closer than a distance [m], given its present distance (negative behind the plane
    /// of the facet). Returns a lower bound on the distance, for later steps: −∞ if the vertex seems to be inside another body and has to come out,
    /// however deep it is.
    fn take_gap_of_vertex(
        &mut self,
        kind: &Kind,
        features @ [vertex, facet]: &[u32; 2],
        distance: f64,
        mut separation: f64,
    ) -> f64 {
        let Touching { surface, reach, before: [x, _], .. } = self.touching;
        let corners = &surface.facets[*facet as usize];
        let Kind { pair, own, other, relative, law } = kind;
        if separation.is_finite() && (own == other || !surface.closed[*facet as usize]) {
            // Such a facet has no inner side.
            separation = separation.abs();
        }
        let farthest = law.thickness + distance + reach.moves_of(&[*vertex], corners) + relative;
        if separation > farthest {
            return separation;
        }
        let apart = reach.apart([*own, *other], &[*vertex], corners);
        if apart > law.thickness + distance {
            return apart.larger(separation);
        }
        let mut gap = Gap::of_vertex_and_facet(surface, &x[..], *vertex, *facet);
        if distance == 0.0 {
            lists::push(&mut self.found.close[0], (*features, gap.gap.abs()));
        }
        if own == other && gap.gap < 0.0 {
            // Contact of a body with itself acts on both sides.
            (gap.gap, gap.normal) = (-gap.gap, gap.normal.map(|n| -n));
        }
        // A gap that is not a number counts as close.
        let is_far = gap.gap > farthest;
        if !is_far {
            self.push(gap, law, (*features, *pair), true);
        }
        if gap.gap < 0.0 { f64::NEG_INFINITY } else { gap.gap }
    }

    /// Adds a row for the gap of a vertex and a facet, or of two edges.
    fn push(&mut self, mut gap: Gap<D>, law: &PairLaw, (pair, number): ([u32; 2], u32), with_facet: bool) {
        let ([x0, v0], [x1, v1]) = (&self.touching.before, &self.touching.after);
        let mut meets = true;
        let mut travel = gap.mean_change([x0, x1]);
        if gap.gap > law.thickness && !self.touching.at_once && self.goes_far(&gap, &travel, with_facet) {
            // The closest points at the start of the step are not those at the impact.
            let ends = [&x0[..], x1];
            let time = meeting_time(&self.touching.surface, ends, law.thickness, pair, with_facet);
            match time.and_then(|time| impact(&self.touching.surface, ends, time, pair, with_facet)) {
                Some(then) => {
                    gap = then;
                    travel = gap.mean_change(ends);
                }
                None => meets = false,
            }
        }
        let mut close = self.touching.close_pair(&gap, law, self.h, (pair, number), with_facet);
        let end = close.gap + dot(&travel, &gap.normal);
        let comes = || -gap.along(v1);
        // For bodies at rest, a pair that pressed in the previous correction is assumed to press again; the solution may show
        // that it does not.
        let presses = || {
            let bodies = self.touching.pairs.all[number as usize].bodies;
            self.touching.at_once && self.touching.last_of(bodies, close.id).is_some()
        };
        let meets = meets && (end < 0.0 || close.gap < 0.0 || self.h * comes() > close.gap || presses());
        if law.restitution > 0.0 && meets && close.gap > 0.0 {
            // The pair meets within the step, but the force acts until the end of the step. The speed s of the impact therefore
            // follows from s² = u² + 2 a g, with the approach u and the gap g at the start of the step and the acceleration a.
            // It is limited to the range between the approaches at both ends of the step.
            let (came, comes) = (-gap.along(v0), comes());
            let square = came * came + 2.0 * (comes - came) / self.h * close.gap;
            let speed = square.larger(0.0).sqrt().smaller(came.larger(comes)).larger(came.smaller(comes));
            if speed > self.touching.laws.rest_speed {
                close.target = law.restitution * speed;
            }
        }
        self.found.around.push((close, meets));
    }

    /// Whether the relative displacement of a pair within the step [m] exceeds a quarter of the length of an edge of its features.
    fn goes_far(&self, gap: &Gap<D>, travel: &[f64; D], with_facet: bool) -> bool {
        let x0 = &self.touching.before[0];
        let first = usize::from(with_facet);
        let edge = subtract(&x0[gap.points[first + 1] as usize], &x0[gap.points[first] as usize]);
        16.0 * dot(travel, travel) > dot(&edge, &edge)
    }

    /// Keeps the relevant rows of one vertex. If the vertex is outside a body, these are the rows of all facets that have the vertex in front of
    /// them, one row for each closest point. If the vertex is inside, it is the row of the nearest facet, through which the vertex leaves.
    fn keep_the_nearest(&mut self) {
        if self.found.around.len() < 2 {
            return;
        }
        let surface = &self.touching.surface;
        let Found { around, keep, keys, .. } = &mut *self.found;
        // All rows have the same vertex and the same two bodies.
        let [own, other] = [0, 1].map(|k| surface.body[around[0].0.points[k] as usize]);
        let is_closed = |row: &ClosePair<D>| row.points[1..=D].iter().all(|p| surface.is_closed(*p));
        let depth = |row: &ClosePair<D>| row.gap + row.thickness;
        let rows = &*around;
        keep.clear();
        keep.resize(rows.len(), true);
        keys.clear();
        keys.extend(rows.iter().map(|(row, _)| features(row)));
        for (j, (row, _)) in rows.iter().enumerate() {
            for (k, (nearer, _)) in rows.iter().enumerate() {
                if j == k {
                    continue;
                }
                let (key, others) = (&keys[j], &keys[k]);
                let [a, b] = [row, nearer].map(depth);
                // Both rows have the same closest point, or the closest point of this row is on the rim of the other facet,
                // which has a nearer point.
                let within = key.iter().all(|p| *p == u32::MAX || others.contains(p));
                if within && (key != others || k < j) {
                    keep[j] = false;
                }
                let is_nearer = b.abs() < a.abs() || b.abs() == a.abs() && k < j;
                if is_nearer && (a < 0.0 || b < 0.0) && own != other && is_closed(row) && is_closed(nearer) {
                    keep[j] = false;
                }
            }
        }
        let mut keep = keep.iter();
        around.retain(|_| keep.next() == Some(&true));
    }

    /// For each body in which a vertex began, takes the gap through which the vertex leaves. Among the given candidates of the vertex, it is the gap
    /// of the nearest facet that faces the surface at the vertex. If no facet faces it, the nearest facet counts.
    fn take_exit(&mut self, number: u32, candidates: Range<usize>) {
        let x = &self.touching.before[0];
        let normal = |facet: u32| {
            let normal = facet_normal(&self.touching.surface.facets[facet as usize].map(|p| x[p as usize]));
            scaled(&normal, 1.0 / dot(&normal, &normal).sqrt())
        };
        let features = &self.touching.pairs.features[0];
        let vertex = features[candidates.start][0];
        let around = self.touching.surface.facets_around(vertex).iter();
        let outward = around.fold([0.0; D], |sum, facet| add(&sum, &normal(*facet)));
        let size = dot(&outward, &outward).sqrt();
        let mut nearest: Vec<(u32, bool, [u32; 2], Gap<D>)> = Vec::new();
        for k in candidates {
            let pair @ [_, facet] = features[k];
            let [own, other] = [vertex, self.touching.surface.facets[facet as usize][0]].map(|p| self.body_of(p));
            if own == other || !self.touching.surface.closed[facet as usize] {
                continue;
            }
            let faces = size > 0.0 && dot(&outward, &normal(facet)) < FACING * size;
            let gap = Gap::of_vertex_and_facet(&self.touching.surface, &x[..], vertex, facet);
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
            self.push(gap, &law, (pair, number), true);
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
