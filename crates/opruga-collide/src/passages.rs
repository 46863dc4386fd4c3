//! Pairs that would pass through one another within a step in spite of the impulses. A check of the resulting motion finds
//! them.

use crate::gap::Gap;
use crate::impact::{features_in, impact, key, meeting_time};
use crate::least_parts;
use crate::row::Row;
use crate::touching::{Touching, Trouble};
use crate::vector::{dot, subtract};
use crate::zones::{Led, PointsOfPair, ROUNDING, Zone};
use opruga_core::threads;
use opruga_math::Lane;

impl<const D: usize> Touching<D> {
    /// Checks the motion to the end of the step of h [s]. Adds the pairs that pass through one another to those found before;
    /// returns whether any pair passes.
    ///
    /// A vertex that starts inside a body may leave it. Pairs that move rigidly together do not pass.
    pub(crate) fn find_passages(&mut self, h: f64) -> bool {
        self.fresh.clear();
        let mut found = false;
        for with_facet in [true, false] {
            let close = &self.close[usize::from(!with_facet)];
            let parts = threads::parts(close.len(), self.threads, least_parts::CANDIDATES);
            let mut lists = std::mem::take(&mut self.meeting);
            let of_parts = threads::empty_lists(&mut lists, parts.len());
            threads::each_in_pool(parts.zip(of_parts.iter_mut()), |(range, meeting)| {
                let time = |(pair, distance): &_| self.passage(*pair, with_facet, *distance).map(|time| (*pair, time));
                meeting.extend(close[range].iter().filter_map(time));
            });
            for (pair, time) in of_parts.iter().flatten() {
                found |= self.look(*pair, with_facet, *time, h);
            }
            self.meeting = lists;
        }
        found
    }

    /// Returns the fraction of the step at which the features of a pair meet, given their distance at the start of the step [m];
    /// none if they cannot pass through one another.
    fn passage(&self, pair @ [a, b]: [u32; 2], with_facet: bool, distance: f64) -> Option<f64> {
        if self.is_out_of_reach(pair, with_facet, distance) {
            return None;
        }
        let [first, second] = if with_facet {
            [self.path(&[a]), self.path(&self.surface.facets[b as usize])]
        } else {
            [a, b].map(|edge| self.path(&self.surface.edges[edge as usize]))
        };
        if (0..D).any(|d| first[0][d] > second[1][d] || second[0][d] > first[1][d]) {
            return None;
        }
        let x0 = &self.before[0];
        let time = meeting_time(&self.surface, [x0, &self.end], 0.0, pair, with_facet)?;
        let bodies = self.bodies_of(pair, with_facet);
        let start = if bodies[0] == bodies[1] {
            None
        } else if with_facet {
            Some(Gap::of_vertex_and_facet(&self.surface, &x0[..], a, b))
        } else {
            Gap::of_edges(&self.surface, &x0[..], a, b)
        };
        // A pair that starts inside may leave.
        (!start.is_some_and(|start| start.gap < 0.0)).then_some(time)
    }

    /// Whether a pair cannot meet in the step because each of its points travels less than half of the distance between its features at
    /// the start [m], with a margin for rounding.
    fn is_out_of_reach(&self, [a, b]: [u32; 2], with_facet: bool, distance: f64) -> bool {
        let mut most: f64 = 0.0;
        let mut travel = |p: u32| {
            let displacement = subtract(&self.end[p as usize], &self.before[0][p as usize]);
            most = dot(&displacement, &displacement).larger(most);
        };
        if with_facet {
            travel(a);
            self.surface.facets[b as usize].into_iter().for_each(travel);
        } else {
            [a, b].into_iter().flat_map(|e| self.surface.edges[e as usize]).for_each(travel);
        }
        distance * distance > 4.01 * most
    }

    /// The box around the motion of a feature to the end of the step [m].
    fn path<const N: usize>(&self, points: &[u32; N]) -> [[f64; D]; 2] {
        let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
        for x in points.iter().flat_map(|p| [&self.before[0][*p as usize], &self.end[*p as usize]]) {
            for d in 0..D {
                (low[d], high[d]) = (x[d].smaller(low[d]), x[d].larger(high[d]));
            }
        }
        [low, high]
    }

    /// Checks one pair that meets at a fraction of the step; returns whether it passes.
    fn look(&mut self, pair: [u32; 2], with_facet: bool, time: f64, h: f64) -> bool {
        let ends = [&self.before[0][..], &self.end];
        if self.zones.hold(&self.points_of_pair(pair, with_facet)) {
            return false;
        }
        let Some(gap) = impact(&self.surface, ends, time, pair, with_facet) else { return false };
        // A pair that touches at the start passes only if its gap at the end is negative.
        if time == 0.0 && gap.along(&self.end) >= -ROUNDING * h * (1.0 + gap.gap.abs()) {
            return false;
        }
        let id = key(pair, with_facet);
        match self.passing.binary_search_by_key(&id, |(other, _)| *other) {
            Ok(k) => self.passing[k].1 = gap,
            Err(k) => self.passing.insert(k, (id, gap)),
        }
        self.fresh.push(id);
        true
    }

    /// The points of a pair, or the nodes that carry them.
    fn points_of_pair(&self, pair: [u32; 2], with_facet: bool) -> PointsOfPair {
        let mut out = ([0; 16], 0);
        let mut add = |p: u32| {
            self.surface.visit_nodes(p, |node, _| {
                out.0[out.1] = node;
                out.1 += 1;
            });
        };
        self.surface.points_of_features(&pair, with_facet).into_iter().flatten().for_each(|p| add(*p));
        out
    }

    fn bodies_of(&self, pair: [u32; 2], with_facet: bool) -> [u32; 2] {
        self.surface.points_of_features(&pair, with_facet).map(|points| self.surface.body[points[0] as usize])
    }

    /// Replaces the rows of passing pairs by rows with the gaps that the check has found for them.
    pub(crate) fn put_passing(&mut self, h: f64) {
        if self.passing.is_empty() {
            return;
        }
        let passing = &self.passing;
        let passes = |id: u64| passing.binary_search_by_key(&id, |(id, _)| *id).is_ok();
        self.rows.retain(|row| !passes(row.id));
        let mut stay = self.watched.iter().map(|close| !passes(close.id));
        self.heads.retain(|_| stay.next() == Some(true));
        self.watched.retain(|close| !passes(close.id));
        self.inactive.retain(|row| !passes(row.id));
        for k in 0..self.passing.len() {
            let (id, gap) = self.passing[k];
            let (pair, with_facet) = features_in(id);
            let bodies = self.bodies_of(pair, with_facet);
            let law = *self.laws.of(bodies[0], bodies[1]);
            let number = self.pairs.index_of(bodies).map_or(u32::MAX, |number| number as u32);
            let close_pair = self.close_pair(&gap, &law, h, (pair, number), with_facet);
            let mut row = close_pair.into_row(&mut self.spread, &self.surface);
            if let Some(last) = self.last_of(bodies, id) {
                (row.normal_impulse, row.friction_impulse) = (last.along, last.across);
            }
            if row.can_move(&self.spread, &self.inverse_mass) {
                self.rows.push(row);
            }
        }
        self.rows.sort_by_key(Row::sort_key);
    }

    /// Makes the points of pairs that still pass move rigidly together: x = x₀ + h (c + ω × r), with the velocity c of their centre, the angular
    /// velocity ω and the position r relative to the centre. In this motion no two features pass. The rigid motion keeps the momentum and the angular
    /// momentum of the points.
    ///
    /// # Errors
    /// [`Trouble::LedThrough`] if pins and obstacles prevent such a motion.
    ///
    /// # Source
    /// X. Provot, Collision and self-collision handling in cloth model dedicated to design garments (1997);
    /// R. Bridson, R. Fedkiw, J. Anderson, Robust treatment of collisions, contact and friction for cloth animation (2002), section 7.4.
    pub(crate) fn hold_together(&mut self, h: f64) -> Result<(), Trouble> {
        loop {
            let Some(first) = self.fresh.first().map(|id| features_in(*id)) else { return Ok(()) };
            let trouble = Trouble::LedThrough { bodies: self.bodies_of(first.0, first.1) };
            self.zones.resize(self.surface.points());
            for id in std::mem::take(&mut self.fresh) {
                let (pair, with_facet) = features_in(id);
                let (points, count) = self.points_of_pair(pair, with_facet);
                self.zones.join(&points[..count], &self.v);
            }
            for zone in self.zones.list() {
                let Some(motion) = self.motion_of(&zone, h) else { return Err(trouble) };
                for number in zone {
                    let p = number as usize;
                    self.v[p] = motion.velocity(&self.before[0][p]);
                    self.end[p] = core::array::from_fn(|d| self.before[0][p][d] + h * self.v[p][d]);
                    self.touched[p] = true;
                    self.zones.set_led(number, motion.led);
                }
            }
            self.lead_carried();
            self.find_passages(h);
        }
    }

    /// The rigid motion of the points of a zone. Pins and obstacles prescribe it; otherwise it has the momentum and angular
    /// momentum of the points.
    fn motion_of(&self, points: &[u32], h: f64) -> Option<Zone<D>> {
        let mut led = Led::default();
        for p in points {
            let p = *p as usize;
            for d in (0..D).filter(|d| self.inverse_mass[p][*d] == 0.0) {
                led.lead(d, (self.end[p][d] - self.before[0][p][d]) / h)?;
            }
        }
        let mut motion = Zone::of(points, &self.before[0], &self.v, &self.inverse_mass, &led);
        let against = |motion: &Zone<D>| {
            self.rows.iter().filter(|row| row.of_obstacle && points.binary_search(&row.points[0]).is_ok()).find(|row| {
                let v = motion.velocity(&self.before[0][row.points[0] as usize]);
                let relative: [f64; D] = core::array::from_fn(|d| v[d] - row.carry[d]);
                dot(&relative, &row.normal) < row.target - ROUNDING * (1.0 + row.target.abs())
            })
        };
        // An obstacle in the way determines the motion.
        if let Some(row) = against(&motion) {
            for d in 0..D {
                led.lead(d, row.carry[d])?;
            }
            motion = Zone::of(points, &self.before[0], &self.v, &self.inverse_mass, &led);
            if against(&motion).is_some() {
                return None;
            }
        }
        Some(motion)
    }
}
