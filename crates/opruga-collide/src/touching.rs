//! Deformable bodies that touch: what a substep makes of their surfaces.

use crate::candidates::Candidates;
use crate::clearance::Clearance;
use crate::coupled::{Coupled, Respond};
use crate::gap::Gap;
use crate::impulses::{Problem, Turns};
use crate::law::Laws;
use crate::reach::Reach;
use crate::reports::{self, Report};
use crate::row::{OBSTACLE_BIT, Row};
use crate::spread::Spread;
use crate::surface::Surface;
use crate::vector::{dot, length, subtract};
use crate::zones::Zones;
use opruga_core::contacts::Touch;
use opruga_math::{Lane, Simd};

/// The surfaces of bodies that may touch, and what is known of their contacts.
///
/// ```text
/// gap       g(x₀) − thickness, normal and weights at the start of the step, or where a fast pair meets
/// bound     u_n ≥ −g/h where they are apart (so they come to touch and no further), u_n ≥ 0 where they overlap,
///           u_n ≥ e s at an impact with speed s above `rest_speed`
/// friction  |λ_t| ≤ µ λ_n, and λ_t stops the sliding where that is enough
/// position  x = x₀ + h v of every point that got an impulse; overlap is taken apart at `recovery_speed`, by positions alone
/// ```
///
/// Impulses start from those of the substep before; those of the last substep of a frame are for the caller to keep
/// ([`Touching::visit_kept`], [`Touching::keep`]). Nothing depends on when candidates were looked for.
#[derive(Debug, Default)]
pub struct Touching<const D: usize> {
    /// What touches.
    pub surface: Surface<D>,
    /// How.
    pub laws: Laws,
    /// One over the mass of every point along every axis [1/kg]; 0 where it is pinned, and of points that nodes carry.
    pub inverse_mass: Vec<[f64; D]>,
    /// Bodies whose points follow one another. Their velocities after the motion are the mean ones of the step.
    pub coupled: Coupled<D>,
    /// Positions [m] and velocities [m/s] of the points at the start of the step.
    pub before: [Vec<[f64; D]>; 2],
    /// Those after the free motion; where points touch, what contact makes of them.
    pub after: [Vec<[f64; D]>; 2],
    /// The points that got an impulse or were moved, ascending.
    pub changed: Vec<u32>,
    /// What contact and friction took from every point that changed, what obstacles and pins gave by their motion, and what moving the
    /// point gave [J].
    pub losses: Vec<[f64; 4]>,
    /// Whether overlap is taken apart by impulses, within the step, and not by positions: where bodies are at rest and have no speed.
    pub(crate) at_once: bool,
    /// Whether bodies that follow as a whole have a budget: impulses are then found as roughly as those of bodies that do not.
    pub has_budget: bool,
    /// How far points of bodies at rest may go at most [m]: impulses that lead them farther do not hold.
    pub farthest: f64,
    /// The impulses on points of bodies that follow as a whole which the free motion contains [N s]: those that are found are all the same the
    /// whole ones, and [`Coupled::impulses_on`] what they add.
    pub given: Vec<(u32, [f64; D])>,
    /// Whether the steps report what contact did.
    pub report: bool,
    /// What contact did since the beginning of the frame, ascending by bodies.
    pub reports: Vec<Report<D>>,
    /// The vector instructions to use; the bits of the results do not depend on them.
    pub simd: Simd,
    /// The margin of the search [m].
    pub margin: f64,
    /// The most candidates.
    pub most: usize,
    pub(crate) candidates: Candidates<D>,
    pub(crate) reach: Reach<D>,
    pub(crate) clearance: Clearance<D>,
    /// Candidates of a vertex and a facet, and of two edges, whose boxes do not meet in the step although their bound allows it; their features, and
    /// their distances [m].
    pub(crate) apart: [Vec<u32>; 2],
    pub(crate) apart_features: Vec<[u32; 2]>,
    pub(crate) distances: Vec<f64>,
    /// The laws for which candidates were looked for.
    found_for: Laws,
    /// The contacts that are solved for: once solved, in the order of that.
    pub(crate) rows: Vec<Row<D>>,
    /// What they act on where nodes carry their points.
    pub(crate) spread: Spread,
    /// Pairs that do not meet by themselves, and their points; those that came into play leave nobody behind.
    pub(crate) watched: Vec<Row<D>>,
    pub(crate) heads: Vec<[u32; 4]>,
    /// Pairs that meet by themselves, but are not solved for unless those that are leave them too fast.
    pub(crate) inactive: Vec<Row<D>>,
    /// The pairs of one vertex, or of two edges, and whether they meet by themselves.
    pub(crate) around: Vec<(Row<D>, bool)>,
    /// Features and impulses of the last substep, ascending.
    pub(crate) last: Vec<(u64, f64, [f64; D])>,
    pub(crate) keep: Vec<bool>,
    /// Whether the obstacles of a point are among the rows; and points whose obstacles are asked for.
    known: Vec<bool>,
    asked: Vec<u32>,
    pub(crate) v: Vec<[f64; D]>,
    pub(crate) moved: Vec<[f64; D]>,
    /// Positions at an impact within a step.
    pub(crate) impact: Vec<[f64; D]>,
    /// Where the points are at the end of the step [m].
    pub(crate) end: Vec<[f64; D]>,
    /// Pairs that would pass through one another, ascending, and the gap by which each is solved for.
    pub(crate) passing: Vec<(u64, Gap<D>)>,
    /// Those of them that the last look has found.
    pub(crate) fresh: Vec<u64>,
    /// The pairs of a vertex and a facet, and of two edges, that may meet in the step.
    pub(crate) close: [Vec<[u32; 2]>; 2],
    pub(crate) zones: Zones<D>,
    /// Whether the frame has begun without a look at which points lie inside other bodies; and these points, ascending.
    pub(crate) looks_inside: bool,
    pub(crate) began_inside: Vec<u32>,
    /// The bodies of these points and of what they lie inside, ascending.
    pub(crate) entangled: Vec<[u32; 2]>,
    /// The largest distance that surfaces keep in contact [m]: of bodies, and with obstacles.
    pub(crate) thickest: [f64; 2],
    pub(crate) wanted: Vec<f64>,
    pub(crate) masses: Vec<f64>,
    pub(crate) multipliers: Vec<f64>,
    pub(crate) touched: Vec<bool>,
    /// Where a point stands among those that changed.
    pub(crate) number: Vec<u32>,
    pub(crate) turns: Turns<D>,
    /// What was done since the counts were last taken.
    pub counts: Counts,
}

/// What contact has cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Substeps.
    pub steps: u64,
    /// Searches for candidates.
    pub searches: u64,
    /// Candidates, summed over the substeps.
    pub candidates: u64,
    /// Pairs whose gap was taken.
    pub pairs: u64,
    /// Pairs that were solved for.
    pub contacts: u64,
    /// How often one of these was solved for.
    pub turns: u64,
    /// How often gaps were taken and solved for: once in each substep, and anew where contact pushes points beyond their boxes.
    pub rounds: u64,
}

impl Counts {
    /// The sums of these and others.
    pub fn and(&self, other: &Counts) -> Counts {
        Counts {
            steps: self.steps + other.steps,
            searches: self.searches + other.searches,
            candidates: self.candidates + other.candidates,
            pairs: self.pairs + other.pairs,
            contacts: self.contacts + other.contacts,
            turns: self.turns + other.turns,
            rounds: self.rounds + other.rounds,
        }
    }
}

/// Why a step cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// There are more pairs than the limit.
    TooMany {
        /// How many were found before the search ended.
        found: usize,
    },
    /// Surfaces that a barrier keeps apart meet already.
    Meet {
        /// The bodies.
        bodies: [u32; 2],
    },
    /// Pins and obstacles lead two bodies, or one and itself, through one another.
    LedThrough {
        /// The bodies.
        bodies: [u32; 2],
    },
}

/// What obstacles say of a point: callback with the number of the point, its position at the start and the end of the step, and how far to look [m].
pub type Obstacles<'a, const D: usize> = &'a dyn Fn(u32, &[f64; D], &[f64; D], f64, &mut dyn FnMut(Touch<D>));

impl<const D: usize> Touching<D> {
    /// Forgets impulses and reports, at the beginning of a frame; candidates too, if the laws have changed.
    pub fn begin(&mut self) {
        self.last.clear();
        self.reports.clear();
        self.looks_inside = true;
        if self.found_for != self.laws {
            self.found_for.clone_from(&self.laws);
            self.reach.forget();
            self.clearance.forget_own();
        }
    }

    /// Forgets the impulses of the last step, where the state is no longer the one that they led to.
    pub fn forget_impulses(&mut self) {
        self.rows.clear();
    }

    /// Calls back with the nodes, as points, and the impulses of the last step [N s], but for those of obstacles on points.
    pub fn visit_impulses(&self, mut visit: impl FnMut(usize, [f64; D])) {
        for row in self.rows.iter().filter(|row| row.normal_impulse > 0.0 && !row.of_obstacle) {
            let impulse = row.impulse();
            for (p, weight) in acting(&self.spread, row) {
                visit(p as usize, impulse.map(|c| weight * c));
            }
        }
    }

    /// Calls back with the bodies of every contact of the last step that presses, but for those with obstacles.
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

    /// Takes overlap apart at once and lets nothing bounce, as bodies need it that look for their balance at rest.
    pub fn come_to_rest(&mut self) {
        self.at_once = true;
        self.laws.recovery_speed = 0.0;
        self.laws.table.iter_mut().for_each(|law| law.restitution = 0.0);
    }

    /// Lets the points touch after a free substep of h [s]: `after` becomes what contact makes of it.
    ///
    /// # Errors
    /// [`Trouble`] where there are more candidates than [`Touching::most`], or pins and obstacles force a passage.
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
        self.counts.steps += 1;
    }

    /// Finds the impulses of a substep of h [s] and the motion that they lead to; bodies that answer as a whole do so by `respond`. Says
    /// whether that motion holds: not where they do not answer, or points of them would have to move in another way.
    ///
    /// # Errors
    /// [`Trouble`] as of [`Touching::step`].
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
        self.impact.resize(points, [0.0; D]);
        self.number.resize(points, 0);
        for p in (0..self.coupled.count()).flat_map(|body| self.coupled.points_of(body)) {
            self.moved[p] = [0.0; D];
        }
        self.thickest = self.laws.largest_thickness();
        self.begin_search(h);
        let mut rounds = 0;
        loop {
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
                if self.at_once && !self.is_within_limit() {
                    return Ok(false);
                }
            } else {
                self.rest();
            }
            if self.grow() {
                // The next round begins with what this one has found.
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

    /// Whether no point of a body goes farther than it may.
    fn is_within_limit(&self) -> bool {
        let within = |p: usize| length(&subtract(&self.end[p], &self.before[0][p])) <= self.farthest;
        (0..self.coupled.count()).all(|body| self.coupled.points_of(body).all(within))
    }

    /// Ends a substep: books what contact did, and moves the points.
    pub fn end_step(&mut self, h: f64) {
        if self.report {
            reports::add(&mut self.reports, &self.rows, &self.surface, &self.end);
        }
        self.book(h);
        self.counts.candidates += self.candidates.len() as u64;
        self.counts.pairs += (self.rows.len() + self.watched.len()) as u64;
    }

    /// Lets all points answer by themselves for the rest of the substep: contact and the balance of forces do not agree.
    pub fn part_coupled(&mut self) {
        self.coupled.apart = true;
        self.passing.clear();
        self.last.clear();
    }

    /// How far the points of a body end from where the impulses were to lead them, at most [m].
    pub fn missed_by(&self, body: usize, actual: impl Iterator<Item = [f64; D]>) -> f64 {
        let points = self.coupled.points_of(body);
        let mut most: f64 = 0.0;
        for (p, x) in points.zip(actual) {
            let end = subtract(&self.end[p], &self.moved_of(p));
            most = length(&subtract(&x, &end)).larger(most);
        }
        most
    }

    /// The velocity of a point that impulses lead to [m/s].
    pub fn velocity_found(&self, point: usize) -> [f64; D] {
        self.v[point]
    }

    /// Whether a point follows others of its body in this substep.
    pub fn follows(&self, point: u32) -> bool {
        self.coupled.body_of(point).is_some()
    }

    /// Looks whether pairs pass through one another where bodies that solve for the end of a step go to where they are now; those pairs are
    /// solved for next.
    pub fn passes(&mut self, h: f64) -> bool {
        for p in (0..self.coupled.count()).flat_map(|body| self.coupled.points_of(body)) {
            self.end[p] = self.after[0][p];
        }
        self.surface.follow(&mut self.end);
        self.find_passages(h)
    }

    /// How far overlap is taken apart at a point of a body that follows others [m].
    pub fn moved_of(&self, point: usize) -> [f64; D] {
        if self.coupled.body_of(point as u32).is_some() { self.moved[point] } else { [0.0; D] }
    }

    /// Nothing touches: everything goes where it goes by itself.
    fn rest(&mut self) {
        self.touched.clear();
        self.touched.resize(self.surface.points(), false);
        self.v.clone_from(&self.after[1]);
        self.end.clone_from(&self.after[0]);
    }

    /// Solves for the velocities after contact; says whether all bodies that follow as a whole have answered.
    fn solve(&mut self, h: f64, obstacles: Option<Obstacles<'_, D>>, mut respond: Option<&mut dyn Respond<D>>) -> bool {
        self.v.clone_from(&self.after[1]);
        self.known.clear();
        self.known.resize(self.surface.points(), false);
        self.hold_points(h, obstacles);
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
            let Touching { rows, spread, inverse_mass, coupled, v, turns, surface, laws, after, has_budget, .. } =
                &mut *self;
            let [_, free] = &*after;
            turns.find_approach(rows, spread, (&surface.body, laws.class.len()), inverse_mass, free);
            let body = &surface.body;
            let problem =
                Problem { rows, spread, inverse_mass, coupled, v, turns, at_rest, has_budget: *has_budget, body };
            self.counts.turns += problem.solve() as u64;
            self.touched.clear();
            self.touched.resize(self.surface.points(), false);
            self.coupled.finish(&self.after[1], &mut self.v, &mut self.touched);
            let known = self.rows.len();
            if !self.activate() {
                break;
            }
            self.hold_points(h, obstacles);
            if !self.weigh_coupled(known, &mut respond) {
                return false;
            }
        }
        self.counts.contacts += self.rows.len() as u64;
        true
    }

    /// Takes the impulses out of the motion that it contains already; says whether all bodies have answered.
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

    /// Works out what rows from a number on weigh where their points follow one another; says whether these answer.
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

    /// Takes in what meets because one of its points was pushed, which it would not have done by itself, and inactive pairs that still approach too
    /// fast; says whether there is any.
    fn activate(&mut self) -> bool {
        let before = self.rows.len();
        for (head, row) in self.heads.iter_mut().zip(&self.watched) {
            let [v, free] = [&self.v, &self.after[1]];
            let points = self.spread.points_of::<D>(head);
            let pushed = points.iter().any(|p| v[*p as usize] != free[*p as usize]);
            if pushed && dot(&subtract(&row.mean(&self.spread, v), &row.carry), &row.normal) < row.target {
                self.rows.push(*row);
                *head = Spread::NOBODY;
            }
        }
        let Touching { rows, inactive, turns, spread, inverse_mass, surface, v, coupled, has_budget, .. } = self;
        let exact = coupled.count() > 0 && !coupled.apart && !*has_budget;
        inactive.retain(|row| {
            let enough = turns.enough(row, spread, inverse_mass, &surface.body, exact);
            let holds = dot(&subtract(&row.mean(spread, v), &row.carry), &row.normal) >= row.target - enough;
            if !holds {
                rows.push(*row);
            }
            holds
        });
        self.rows.len() > before
    }

    /// Keeps the impulses for the next substep.
    fn keep_impulses(&mut self) {
        self.last.clear();
        self.last.resize(self.rows.len(), (0, 0.0, [0.0; D]));
        for (row, k) in self.rows.iter().zip(self.turns.order()) {
            self.last[*k as usize] = (row.id, row.normal_impulse, row.friction_impulse);
        }
        self.last.retain(|(_, along, _)| *along > 0.0);
    }

    /// Adds what obstacles hold of the points of all contacts: what bodies push against them must not go through.
    fn hold_points(&mut self, h: f64, obstacles: Option<Obstacles<'_, D>>) {
        let Some(obstacles) = obstacles else { return };
        self.asked.clear();
        let surface = &self.surface;
        for row in &self.rows {
            let coupled = &self.coupled;
            // What answers as a whole looks for its end between the obstacles.
            let asks = |p: u32| !surface.is_of_obstacle(p) && coupled.body_of(p).is_none();
            for (p, _) in acting(&self.spread, row).filter(|(p, _)| asks(*p)) {
                let known = &mut self.known[p as usize];
                if !*known {
                    *known = true;
                    self.asked.push(p);
                }
            }
        }
        self.asked.sort_unstable();
        for p in &self.asked {
            let p = *p;
            let (x0, x1) = (self.before[0][p as usize], self.after[0][p as usize]);
            let travel = length(&subtract(&x1, &x0));
            let reach = travel + h * length(&self.v[p as usize]) + self.margin;
            let (rows, spread, inverse_mass) = (&mut self.rows, &self.spread, &self.inverse_mass);
            obstacles(p, &x0, &x1, reach, &mut |touch: Touch<D>| {
                let mut gap = Gap { points: [p; 4], weights: [0.0; 4], gap: touch.gap_before, normal: touch.normal };
                gap.weights[0] = 1.0;
                let id = OBSTACLE_BIT | u64::from(p) << 31 | touch.surface as u64;
                let mut row = Row::new(id, &gap, 0.0, touch.friction);
                row.weigh(spread, inverse_mass);
                row.carry = touch.velocity;
                row.target = if row.gap > 0.0 { -row.gap / h } else { 0.0 };
                row.of_obstacle = true;
                if row.mass[0] > 0.0 {
                    rows.push(row);
                }
            });
        }
    }

    /// Begins with the impulses of the last substep.
    fn start_warm(&mut self) {
        let mut k = 0;
        for row in &mut self.rows {
            while self.last.get(k).is_some_and(|(id, ..)| *id < row.id) {
                k += 1;
            }
            if let Some((_, along, across)) = self.last.get(k).filter(|(id, ..)| *id == row.id) {
                (row.normal_impulse, row.friction_impulse) = (*along, *across);
                let impulse = row.impulse();
                if row.coupled {
                    self.coupled.give(row.on(&self.spread), &impulse, &self.inverse_mass, &mut self.v);
                } else {
                    row.give(&self.spread, &impulse, &self.inverse_mass, &mut self.v);
                }
            }
        }
    }

    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let vectors = [&self.inverse_mass, &self.v, &self.moved, &self.impact, &self.end];
        let vectors = vectors.map(Vec::capacity).iter().sum::<usize>() + 6 * self.reach.points();
        let states: usize = self.before.iter().chain(&self.after).map(Vec::capacity).sum();
        8 * D * (vectors + states)
            + self.surface.heap_bytes()
            + self.coupled.heap_bytes()
            + self.spread.heap_bytes()
            + self.candidates.heap_bytes()
            + self.clearance.heap_bytes()
            + core::mem::size_of::<Row<D>>() * (self.rows.capacity() + self.watched.capacity())
    }
}

/// The points that a row acts on, and their weights.
pub(crate) fn acting<'a, const D: usize>(spread: &'a Spread, row: &'a Row<D>) -> impl Iterator<Item = (u32, f64)> + 'a {
    let (points, weights) = row.on(spread);
    points.iter().copied().zip(weights.iter().copied()).filter(|(_, weight)| *weight != 0.0)
}

/// How often pairs that would pass through one another are solved for along their normals, before what still passes moves as one: four, as an impulse
/// along one pair may send another one through, but each round leaves fewer.
const ROUNDS: usize = 4;
