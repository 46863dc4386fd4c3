//! Touching deformable bodies: the contact of their surfaces in a substep.

use crate::body_pairs::{BodyPairs, Piece};
use crate::close_pair::ClosePair;
use crate::counts::Counts;
use crate::coupled::{Coupled, Respond};
use crate::found::Found;
use crate::gap::Gap;
use crate::impulses::Problem;
use crate::last_impulse::LastImpulse;
use crate::law::Laws;
use crate::lists;
use crate::reach::Reach;
use crate::reports::{self, Report};
use crate::row::Row;
use crate::spread::Spread;
use crate::surface::Surface;
use crate::turns::Turns;
use crate::vector::{dot, length, subtract};
use crate::zones::Zones;
use opruga_core::break_off::BreakOff;
use opruga_core::contacts::Touch;
use opruga_math::{Lane, Simd};
use std::sync::Arc;

/// The surfaces of bodies that may touch, and the state of their contacts.
///
/// ```text
/// gap       g(x₀) − thickness, normal and weights at the start of the step, or where a fast pair meets
/// bound     u_n ≥ −g/h where they are apart (so they come to touch and no further), u_n ≥ 0 where they overlap,
///           u_n ≥ e s at an impact with speed s above `rest_speed`
/// friction  |λ_t| ≤ µ λ_n, and λ_t stops the sliding where that is enough
/// position  x = x₀ + h v of every point that got an impulse; overlap is taken apart at `recovery_speed`, by positions alone
/// ```
///
/// Impulses start from the impulses of the previous substep. The caller has to keep the impulses of the last substep of a frame
/// ([`Touching::visit_kept`], [`Touching::keep`]). Results do not depend on the steps in which candidates are searched.
#[derive(Debug, Default)]
pub struct Touching<const D: usize> {
    /// The surfaces.
    pub surface: Surface<D>,
    /// The contact laws of the surfaces.
    pub laws: Laws,
    /// The inverse mass of every point along every axis [1/kg]; 0 for pinned points and for points that nodes carry.
    pub inverse_mass: Vec<[f64; D]>,
    /// Bodies whose points respond together. Their velocities after the motion are the mean velocities of the step.
    pub coupled: Coupled<D>,
    /// For every body, whether its integrator changes velocities by the force at the start of the step alone. A missing entry means no.
    pub kicked_by_first_force: Vec<bool>,
    /// Positions [m] and velocities [m/s] of the points at the start of the step.
    pub before: [Vec<[f64; D]>; 2],
    /// Positions and velocities of the points after the free motion. Contact replaces the values of touching points by its result.
    pub after: [Vec<[f64; D]>; 2],
    /// The points that got an impulse or were moved, ascending.
    pub changed: Vec<u32>,
    /// For every changed point, four energies [J]: what contact took, what friction took, what obstacles and pins gave by their motion, and what the
    /// displacement of the point gave.
    pub losses: Vec<[f64; 4]>,
    /// Whether overlaps are removed by impulses within the step, and not by changes of positions. This is so for bodies at rest, which have no
    /// velocity.
    pub(crate) at_once: bool,
    /// Whether the steps of coupled bodies have a fixed budget. Impulses are then found only as accurately as for uncoupled bodies.
    pub has_budget: bool,
    /// The largest allowed displacement of points of bodies at rest [m]; impulses that exceed it are rejected.
    pub farthest: f64,
    /// The impulses on points of coupled bodies that the free motion already contains [N s]. The solution still gives the total
    /// impulses, and [`Coupled::impulses_on`] gives the difference.
    pub given: Vec<(u32, [f64; D])>,
    /// Whether the steps report the effects of contact.
    pub report: bool,
    /// The effects of contact since the beginning of the frame, sorted by bodies.
    pub reports: Vec<Report<D>>,
    /// The margin of the search [m].
    pub margin: f64,
    /// The largest number of candidates.
    pub most: usize,
    pub(crate) pairs: BodyPairs<D>,
    pub(crate) reach: Reach<D>,
    /// Whether the motion of the present substep was examined before.
    pub(crate) is_begun: bool,
    /// Pieces of the lists of candidates, pair of bodies by pair of bodies. All candidates of one vertex and two bodies are in the same piece.
    pub(crate) pieces: Vec<Piece>,
    /// The threads that may look for pairs; the bits of the results do not depend on them.
    pub threads: usize,
    /// A request to end a long substep, which then ends with [`Trouble::BrokenOff`].
    pub break_off: Arc<BreakOff>,
    pub(crate) found: Vec<Found<D>>,
    /// The laws that applied at the last search for candidates.
    found_for: Laws,
    /// The contacts of the solution; after the solution, they are in its order.
    pub(crate) rows: Vec<Row<D>>,
    /// The nodes on which contacts act if nodes carry their points.
    pub(crate) spread: Spread,
    /// Pairs that would not meet in the free motion, and their points; pairs that were activated leave an empty entry.
    pub(crate) watched: Vec<ClosePair<D>>,
    pub(crate) heads: Vec<[u32; 4]>,
    /// Pairs that would meet in the free motion but are left out at first. They join the rows only if they still approach too fast after the other
    /// rows have been solved.
    pub(crate) inactive: Vec<Row<D>>,
    /// Features and impulses of the previous substep, ascending.
    pub(crate) last: Vec<LastImpulse<D>>,
    /// Whether the obstacles of a point are among the rows (`known`), whether they are requested (`asks`), and the points whose obstacles are
    /// requested, ascending (`asked`).
    pub(crate) known: Vec<bool>,
    pub(crate) asks: Vec<bool>,
    pub(crate) asked: Vec<u32>,
    /// The contacts with obstacles, by parts of these points.
    pub(crate) obstacle_rows: Vec<Vec<Row<D>>>,
    pub(crate) v: Vec<[f64; D]>,
    pub(crate) moved: Vec<[f64; D]>,
    /// The positions of the points at the end of the step [m].
    pub(crate) end: Vec<[f64; D]>,
    /// Pairs that would pass through one another, ascending, each with the gap that the solution uses.
    pub(crate) passing: Vec<(u64, Gap<D>)>,
    /// The passing pairs that the last check has found.
    pub(crate) fresh: Vec<u64>,
    /// Pairs that meet within the step, and the fraction of the step at which they do, by parts of the close pairs.
    pub(crate) meeting: Vec<Vec<([u32; 2], f64)>>,
    /// The pairs of a vertex and a facet, and of two edges, that may meet in the step, and their distances at its start [m].
    pub(crate) close: [Vec<([u32; 2], f64)>; 2],
    pub(crate) zones: Zones<D>,
    /// Whether the points inside other bodies still have to be found in this frame, and the points found, ascending.
    pub(crate) looks_inside: bool,
    pub(crate) began_inside: Vec<u32>,
    /// Pairs of bodies, one of which has points inside the other; ascending.
    pub(crate) entangled: Vec<[u32; 2]>,
    /// The largest distance that surfaces keep in contact [m]: between bodies, and with obstacles.
    pub(crate) thickest: [f64; 2],
    pub(crate) wanted: Vec<f64>,
    pub(crate) masses: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    pub(crate) touched: Vec<bool>,
    /// For every changed point, whether an obstacle holds it at the end of the free motion.
    pub(crate) stopped: Vec<bool>,
    /// The index of every changed point in the list of changed points.
    pub(crate) number: Vec<u32>,
    pub(crate) turns: Turns<D>,
    /// The counts that have accumulated since they were last taken.
    pub counts: Counts,
}

/// Why a step cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// There are more pairs than the limit.
    TooMany,
    /// Surfaces that a barrier has to keep apart already meet.
    Meet {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Pins and obstacles move two bodies through one another, or a body through itself.
    LedThrough {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Somebody has asked the substep to end.
    BrokenOff,
}

/// The contacts of a point with obstacles: a callback with the number of the point, its position at the start and the end of the
/// step, and the search distance [m].
pub type Obstacles<'a, const D: usize> = &'a (dyn Fn(u32, &[f64; D], &[f64; D], f64, &mut dyn FnMut(Touch<D>)) + Sync);

impl<const D: usize> Touching<D> {
    /// Discards impulses and reports at the beginning of a frame. Also discards candidates if the laws have changed.
    pub fn begin(&mut self) {
        self.last.clear();
        self.reports.clear();
        self.looks_inside = true;
        if self.found_for != self.laws {
            self.found_for.clone_from(&self.laws);
            self.reach.forget();
            self.pairs.clear();
        }
    }

    /// Chooses the vector instructions. The bits of the results do not depend on them.
    pub fn use_simd(&mut self, simd: Simd) {
        self.pairs.simd = simd;
    }

    /// The caller needs this if the state is no longer the result of these impulses.
    pub fn forget_impulses(&mut self) {
        self.rows.clear();
    }

    /// Calls `visit` with the nodes (by their indices among the points) and the impulses of the previous step [N s], except
    /// impulses of obstacles on points.
    pub fn visit_impulses(&self, mut visit: impl FnMut(usize, [f64; D])) {
        for row in self.rows.iter().filter(|row| row.normal_impulse > 0.0 && !row.of_obstacle) {
            let impulse = row.impulse();
            for (p, weight) in acting(&self.spread, row) {
                visit(p as usize, impulse.map(|c| weight * c));
            }
        }
    }

    /// Calls `visit` with the two bodies of every pressing contact of the previous step, except contacts with obstacles.
    pub fn visit_pairs(&self, mut visit: impl FnMut(u32, u32)) {
        for row in self.rows.iter().filter(|row| row.normal_impulse > 0.0 && !row.of_obstacle) {
            let [a, b] = [1.0, -1.0].map(|sign| {
                let point = (0..=D).find(|k| row.weights[*k] * sign > 0.0);
                point.map(|k| self.surface.body[row.points[k] as usize]).filter(|body| !self.surface.is_obstacle(*body))
            });
            if let (Some(a), Some(b)) = (a, b) {
                visit(a, b);
            }
        }
    }

    /// Removes overlaps at once and without bounces, for bodies in search of their equilibrium.
    pub fn come_to_rest(&mut self) {
        self.at_once = true;
        self.laws.recovery_speed = 0.0;
        self.laws.table.iter_mut().for_each(|law| law.restitution = 0.0);
    }

    /// Applies contact to the points after a free substep of h [s]: `after` is replaced by the result.
    ///
    /// # Errors
    /// [`Trouble`] if there are more candidates than [`Touching::most`], or if pins and obstacles force a passage.
    pub fn step(&mut self, h: f64, obstacles: Option<Obstacles<'_, D>>) -> Result<(), Trouble> {
        self.begin_step();
        self.coupled.apart = true;
        self.find_impulses(h, obstacles, None)?;
        self.end_step(h);
        Ok(())
    }

    /// Begins a substep.
    pub fn begin_step(&mut self) {
        self.passing.clear();
        self.coupled.apart = false;
        self.is_begun = false;
        self.counts.steps += 1;
    }

    /// Finds the impulses of a substep of h [s] and the resulting motion; coupled bodies respond through `respond`. Returns whether that motion is
    /// valid. The motion is invalid if coupled bodies do not respond, if their points would move too far, or if pairs would still pass through one
    /// another and would have to move rigidly.
    ///
    /// # Errors
    /// [`Trouble`] as for [`Touching::step`].
    pub fn find_impulses(
        &mut self,
        h: f64,
        obstacles: Option<Obstacles<'_, D>>,
        mut respond: Option<&mut dyn Respond<D>>,
    ) -> Result<bool, Trouble> {
        self.changed.clear();
        self.zones.clear();
        self.coupled.begin();
        for vectors in self.before.iter_mut().chain(&mut self.after) {
            self.surface.follow(vectors);
        }
        let points = self.surface.points();
        self.moved.resize(points, [0.0; D]);
        self.number.resize(points, 0);
        for p in (0..self.coupled.count()).flat_map(|body| self.coupled.points_of(body)) {
            self.moved[p] = [0.0; D];
        }
        self.thickest = self.laws.largest_thickness();
        self.begin_search(h);
        let mut rounds = 0;
        loop {
            if self.break_off.is_wanted() {
                return Err(Trouble::BrokenOff);
            }
            self.search()?;
            if std::mem::take(&mut self.looks_inside) {
                self.find_began_inside();
            }
            self.counts.rounds += 1;
            self.take_gaps(h);
            if !self.rows.is_empty() || !self.inactive.is_empty() || !self.given.is_empty() {
                if !self.solve(h, obstacles, respond.as_mut().map(|respond| &mut **respond as _)) {
                    return Ok(false);
                }
                self.settle(h);
                if !self.is_within_limit() {
                    return Ok(false);
                }
            } else {
                self.rest();
            }
            if self.is_pushed_into_others()? {
                // The next round starts from the result of this one.
                if !self.at_once {
                    self.keep_impulses();
                }
                continue;
            }
            if !self.find_passages(h) {
                break;
            }
            rounds += 1;
            if rounds > ROUNDS {
                if !self.coupled.apart && self.coupled.count() > 0 {
                    return Ok(false);
                }
                self.hold_together(h)?;
                break;
            }
        }
        self.keep_impulses();
        Ok(true)
    }

    /// Whether no coupled point moves farther than allowed. Contact pushes points of moving bodies at most by the largest extent of a body and its free
    /// motion. Impulses that have not converged can exceed this, and the search for pairs along such paths would take forever.
    fn is_within_limit(&self) -> bool {
        if self.coupled.apart && !self.at_once {
            return true;
        }
        let (from, farthest) = if self.at_once {
            (&self.before[0], self.farthest)
        } else {
            let extents = self.reach.bodies.iter().map(|body| length(&subtract(&body.hull[1], &body.hull[0])));
            (&self.after[0], extents.fold(0.0, f64::larger))
        };
        let within = |p: usize| length(&subtract(&self.end[p], &from[p])) <= farthest;
        (0..self.coupled.count()).all(|body| self.coupled.points_of(body).all(within))
    }

    /// Ends a substep: records the effects of contact, and moves the points.
    pub fn end_step(&mut self, h: f64) {
        if self.report {
            reports::add(&mut self.reports, &self.rows, &self.surface, &self.end);
        }
        self.book(h);
        self.counts.candidates += self.pairs.len() as u64;
        self.counts.pairs += (self.rows.len() + self.watched.len()) as u64;
    }

    /// Makes all points respond independently for the rest of the substep, because contact and the balance of forces disagree.
    pub fn part_coupled(&mut self) {
        self.coupled.apart = true;
        self.start_without_impulses();
    }

    /// Discards the impulses found so far, because bodies repeat their steps without them.
    pub fn start_without_impulses(&mut self) {
        self.passing.clear();
        self.last.clear();
    }

    /// The largest distance between the end positions of the points of a body and those that the impulses should have given
    /// [m].
    pub fn missed_by(&self, body: usize, actual: impl Iterator<Item = [f64; D]>) -> f64 {
        let points = self.coupled.points_of(body);
        let mut most: f64 = 0.0;
        for (p, x) in points.zip(actual) {
            let end = subtract(&self.end[p], &self.moved_of(p));
            most = length(&subtract(&x, &end)).larger(most);
        }
        most
    }

    /// The velocity of a point that results from the impulses [m/s].
    pub fn velocity_found(&self, point: usize) -> [f64; D] {
        self.v[point]
    }

    /// Whether a point is coupled to others of its body in this substep.
    pub fn follows(&self, point: u32) -> bool {
        self.coupled.body_of(point).is_some()
    }

    /// Checks whether pairs pass through one another when bodies with implicit integrators move to their present positions. The next solution
    /// includes the passing pairs.
    pub fn passes(&mut self, h: f64) -> bool {
        for p in (0..self.coupled.count()).flat_map(|body| self.coupled.points_of(body)) {
            self.end[p] = self.after[0][p];
        }
        self.surface.follow(&mut self.end);
        self.find_passages(h)
    }

    /// The displacement of a point of a coupled body that removes overlaps [m].
    pub fn moved_of(&self, point: usize) -> [f64; D] {
        if self.coupled.body_of(point as u32).is_some() { self.moved[point] } else { [0.0; D] }
    }

    /// Gives all points their free motion, because nothing touches.
    fn rest(&mut self) {
        self.touched.clear();
        self.touched.resize(self.surface.points(), false);
        self.v.clone_from(&self.after[1]);
        self.end.clone_from(&self.after[0]);
    }

    /// Solves for the velocities after contact; returns whether all coupled bodies have responded.
    fn solve(&mut self, h: f64, obstacles: Option<Obstacles<'_, D>>, mut respond: Option<&mut dyn Respond<D>>) -> bool {
        self.v.clone_from(&self.after[1]);
        self.known.clear();
        self.known.resize(self.surface.points(), false);
        self.hold_points(0, h, obstacles);
        self.coupled.begin();
        if !self.weigh_coupled(0, &mut respond) {
            return false;
        }
        if !self.take_back_given(&mut respond) {
            return false;
        }
        self.start_warm();
        let at_rest = self.at_once.then_some(self.thickest[0] / h);
        self.turns.begin(self.surface.points());
        loop {
            let threads = self.threads;
            let Touching { rows, spread, inverse_mass, coupled, v, turns, surface, laws, after, has_budget, .. } =
                &mut *self;
            let [_, free] = &*after;
            turns.find_approach(rows, spread, (&surface.body, laws.class.len()), inverse_mass, free);
            let body = &surface.body;
            let problem = Problem {
                rows,
                spread,
                inverse_mass,
                coupled,
                v,
                turns,
                at_rest,
                has_budget: *has_budget,
                body,
                threads,
            };
            self.counts.turns += problem.solve() as u64;
            self.touched.clear();
            self.touched.resize(self.surface.points(), false);
            self.coupled.finish(&self.after[1], &mut self.v, &mut self.touched);
            let known = self.rows.len();
            if !self.activate() {
                break;
            }
            self.hold_points(known, h, obstacles);
            if !self.weigh_coupled(known, &mut respond) {
                return false;
            }
        }
        self.counts.contacts += self.rows.len() as u64;
        true
    }

    /// Subtracts the impulses that the motion already contains; returns whether all bodies have responded.
    fn take_back_given(&mut self, respond: &mut Option<&mut dyn Respond<D>>) -> bool {
        for (point, impulse) in &self.given {
            let own = (&[*point][..], &[1.0][..]);
            if !respond.as_mut().is_some_and(|respond| self.coupled.need(own, &mut **respond)) {
                return false;
            }
            self.coupled.give(own, &impulse.map(|c| -c), &self.inverse_mass, &mut self.v);
        }
        true
    }

    /// Computes the masses of coupled rows, beginning with the row `first`; returns whether all points of these rows respond.
    fn weigh_coupled(&mut self, first: usize, respond: &mut Option<&mut dyn Respond<D>>) -> bool {
        if self.coupled.count() == 0 || self.coupled.apart {
            return true;
        }
        for row in &mut self.rows[first..] {
            if self.coupled.holds(row.on(&self.spread)) {
                if !respond.as_mut().is_some_and(|respond| self.coupled.need(row.on(&self.spread), &mut **respond)) {
                    return false;
                }
                row.weigh_coupled(&self.spread, &self.coupled, &self.inverse_mass);
            }
        }
        true
    }

    /// Activates pairs that meet because one of their points was pushed, and inactive pairs that still approach too fast; returns
    /// whether there are any.
    fn activate(&mut self) -> bool {
        let before = self.rows.len();
        for (head, close) in self.heads.iter_mut().zip(&self.watched) {
            let [v, free] = [&self.v, &self.after[1]];
            let points = self.spread.points_of::<D>(head);
            let pushed = points.iter().any(|p| v[*p as usize] != free[*p as usize]);
            if !pushed {
                continue;
            }
            let mut row = close.into_row_on(Spread::range_of(head));
            if dot(&row.mean(&self.spread, v), &row.normal) < row.target {
                if row.can_move(&self.spread, &self.inverse_mass) {
                    lists::push(&mut self.rows, row);
                }
                *head = Spread::NOBODY;
            }
        }
        let Touching { rows, inactive, turns, spread, inverse_mass, surface, v, coupled, has_budget, .. } = self;
        let exact = coupled.count() > 0 && !coupled.apart && !*has_budget;
        inactive.retain(|row| {
            let enough = turns.enough(row, spread, inverse_mass, &surface.body, exact);
            let holds = dot(&subtract(&row.mean(spread, v), &row.carry), &row.normal) >= row.target - enough;
            if !holds {
                let mut row = *row;
                if row.can_move(spread, inverse_mass) {
                    lists::push(rows, row);
                }
            }
            holds
        });
        self.rows.len() > before
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let vectors = [&self.inverse_mass, &self.v, &self.moved, &self.end];
        let vectors = vectors.map(Vec::capacity).iter().sum::<usize>();
        let states: usize = self.before.iter().chain(&self.after).map(Vec::capacity).sum();
        8 * D * (vectors + states)
            + self.surface.heap_bytes()
            + self.coupled.heap_bytes()
            + self.spread.heap_bytes()
            + self.pairs.heap_bytes()
            + size_of::<Row<D>>() * (self.rows.capacity() + self.inactive.capacity())
            + size_of::<ClosePair<D>>() * self.watched.capacity()
            + self.found.iter().map(Found::heap_bytes).sum::<usize>()
            + self.turns.heap_bytes()
            + self.reach.heap_bytes()
            + size_of::<([u32; 2], f64)>() * self.meeting.iter().chain(&self.close).map(Vec::capacity).sum::<usize>()
            + size_of::<Row<D>>() * self.obstacle_rows.iter().map(Vec::capacity).sum::<usize>()
            + size_of::<LastImpulse<D>>() * self.last.capacity()
            + self.known.capacity()
            + self.asks.capacity()
            + self.touched.capacity()
            + self.stopped.capacity()
            + 4 * (self.asked.capacity() + self.number.capacity() + self.changed.capacity())
            + 16 * self.heads.capacity()
            + 32 * self.losses.capacity()
            + 8 * (self.wanted.capacity() + self.masses.capacity() + self.multipliers.capacity())
    }
}

/// The points on which a row acts, and their weights.
pub(crate) fn acting<'a, const D: usize>(spread: &'a Spread, row: &'a Row<D>) -> impl Iterator<Item = (u32, f64)> + 'a {
    let (points, weights) = row.on(spread);
    points.iter().copied().zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0)
}

/// The number of rounds that solve the contact of passing pairs along their normals. Pairs that still pass after these rounds move rigidly together.
/// An impulse along one pair may make another one pass, but each round leaves fewer pairs.
const ROUNDS: usize = 4;
