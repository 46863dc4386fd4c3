//! Impulses on pairs in contact: projected Gauss–Seidel.

use crate::coupled::Coupled;
use crate::newton::Aim;
use crate::row::Row;
use crate::spread::Spread;
use crate::subspace;
use crate::vector::{dot, length, scaled, subtract};
use crate::working_set;
use core::any::Any;
use opruga_math::Lane;

/// The sweeps end when the remaining contact velocities are below this fraction of the mean approach velocity of the connected
/// bodies. At rest, where that velocity is h g, a contact then creeps by less than a hundredth of one step of free fall. The
/// next step starts from these impulses and processes every contact, so the remainders do not accumulate. Only the first step of
/// a frame starts without impulses. A tolerance of a thousandth needs two to three times as many turns and changes the kinetic
/// energy of a heap by less than a thousandth.
const TOLERANCE: f64 = 1e-2;

/// The largest number of sweeps in a step. A sweep passes an impulse through all contacts in its direction. A column of bodies
/// therefore needs about as many sweeps as it has contacts that the elastic wave connects within one step: a few.
const MOST_SWEEPS: usize = 60;

/// The same fraction for contacts of bodies with implicit integrators. Forces balance the remainder, so it changes these forces:
/// with 1e-5 the pressure on a patch is wrong by 2e-4 (the rows `contact-patch-…` require 1e-6).
const COUPLED_TOLERANCE: f64 = 1e-9;

/// The same fraction for bodies at rest, relative to the approach in the present correction. The next correction solves for the
/// remainder, whose approach is smaller. With a tenth, one and a half times as many corrections are needed.
const TOLERANCE_AT_REST: f64 = 1e-3;

/// The largest number of sweeps for bodies with implicit integrators and bodies at rest. Contacts without friction take up to 30.
/// Contacts that alternate between sticking and sliding never converge, and with 300 sweeps no test or row becomes more accurate.
const MOST_COUPLED_SWEEPS: usize = 100;

/// The number of sweeps before each step in the subspace of the active contacts: one forward, one backward.
const SWEEPS_BETWEEN: usize = 2;

/// After this many steps that did not halve the change of a sweep, only sweeps continue: with friction, contacts may alternate
/// between sticking and sliding.
const MOST_FAILURES: usize = 16;

/// After this many such steps, the sweeps of bodies at rest end. The next correction continues from their result.
const MOST_FAILURES_AT_REST: usize = 2;

/// The times at which rows were last solved and at which their velocities last changed, counted in turns of rows. They are
/// stored separately from the rows, which are large.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turns<const D: usize> {
    /// The turn in which the velocity of each point last changed.
    stamps: Vec<u64>,
    /// The points of the rows, and their last turns; 0 before the first.
    heads: Vec<([u32; 4], u64)>,
    now: u64,
    /// For each point, another one to which rows connect it, or the point itself.
    parent: Vec<u32>,
    /// The number of the set to which a point is connected, by its root; and the start of the rows of each set, in the order in
    /// which they are found.
    number: Vec<u32>,
    starts: Vec<u32>,
    joined: Vec<u32>,
    /// The position of every sorted row in the order of features.
    order: Vec<u32>,
    sorted: Vec<Row<D>>,
    approach: Approach,
}

/// The mean approach velocity of the contacts of connected bodies [m/s]: where one pair crashes, others may be at rest. Bodies
/// that are not connected have no influence.
#[derive(Clone, Debug, Default)]
struct Approach {
    /// For each body, another one to which it is connected, or the body itself.
    parent: Vec<u32>,
    /// For each root of connected bodies: first the sum of the approach velocities and the number of contacts, then the mean.
    mean: Vec<(f64, u32)>,
}

impl Approach {
    fn root(&self, mut body: u32) -> u32 {
        while self.parent[body as usize] != body {
            body = self.parent[body as usize];
        }
        body
    }
    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
    }
}

/// The points of a row that can move.
fn movable<'a, const D: usize>(
    spread: &'a Spread,
    row: &'a Row<D>,
    inverse_mass: &'a [[f64; D]],
) -> impl Iterator<Item = u32> + 'a {
    let (points, weights) = row.on(spread);
    let moves = |(p, w): &(&u32, &f64)| **w != 0.0 && inverse_mass[**p as usize] != [0.0; D];
    points.iter().zip(weights).filter(moves).map(|(p, _)| *p)
}

impl<const D: usize> Turns<D> {
    /// Begins a step.
    pub(crate) fn begin(&mut self, points: usize) {
        if self.parent.len() != points {
            self.stamps.resize(points, 0);
            self.parent = (0..points as u32).collect();
            self.number.resize(points, 0);
        }
    }

    fn root(&mut self, mut point: u32) -> u32 {
        while self.parent[point as usize] != point {
            // Path halving, for later searches.
            self.parent[point as usize] = self.parent[self.parent[point as usize] as usize];
            point = self.parent[point as usize];
        }
        point
    }

    fn join_points(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        let (low, high) = if a < b { (a, b) } else { (b, a) };
        self.parent[high as usize] = low;
    }

    /// The start of the rows of each connected set, and the end of the last.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The position of every row in the order of features.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The largest velocity that sweeps may leave in a row [m/s].
    pub(crate) fn enough(
        &self,
        row: &Row<D>,
        spread: &Spread,
        inverse_mass: &[[f64; D]],
        body: &[u32],
        exact: bool,
    ) -> f64 {
        let first = movable(spread, row, inverse_mass).next();
        let tolerance = if exact { COUPLED_TOLERANCE } else { TOLERANCE };
        first.map_or(0.0, |p| tolerance * self.approach.mean[self.approach.root(body[p as usize]) as usize].0)
    }

    /// Computes the mean approach velocities of rows, given the body of every point, the number of bodies, and the velocities
    /// before contact [m/s].
    pub(crate) fn find_approach(
        &mut self,
        rows: &[Row<D>],
        spread: &Spread,
        (body, bodies): (&[u32], usize),
        inverse_mass: &[[f64; D]],
        v: &[[f64; D]],
    ) {
        self.approach.parent.clear();
        self.approach.parent.extend(0..bodies as u32);
        self.approach.mean.clear();
        self.approach.mean.resize(bodies, (0.0, 0));
        for row in rows {
            let mut own = movable(spread, row, inverse_mass).map(|p| body[p as usize]);
            let Some(first) = own.next() else { continue };
            own.for_each(|other| self.approach.join(first, other));
        }
        for row in rows {
            let Some(first) = movable(spread, row, inverse_mass).next() else { continue };
            let u = subtract(&row.mean(spread, v), &row.carry);
            let speed = (row.target - dot(&u, &row.normal)).larger(0.0);
            let root = self.approach.root(body[first as usize]) as usize;
            let (sum, count) = &mut self.approach.mean[root];
            *sum += if row.friction > 0.0 { length(&u).larger(speed) } else { speed };
            *count += 1;
        }
        for (sum, count) in self.approach.mean.iter_mut().filter(|(_, count)| *count > 0) {
            *sum /= f64::from(*count);
        }
    }

    /// Sorts rows into connected sets, each in the order of features, so that rows that are solved together are stored together.
    fn join(&mut self, rows: &mut Vec<Row<D>>, spread: &Spread, inverse_mass: &[[f64; D]], coupled: &Coupled<D>) {
        if !rows.is_sorted_by_key(|row| row.id) {
            rows.sort_by_key(|row| row.id);
        }
        // Points that cannot move do not connect rows.
        for row in rows.iter() {
            let mut begin = |p: u32| {
                self.parent[p as usize] = p;
                self.number[p as usize] = u32::MAX;
            };
            movable(spread, row, inverse_mass).for_each(&mut begin);
            if row.coupled {
                coupled.followers(row.on(spread), begin);
            }
        }
        for row in rows.iter() {
            let mut own = movable(spread, row, inverse_mass);
            let Some(first) = own.next() else { continue };
            for p in own {
                self.join_points(first, p);
            }
            if row.coupled {
                coupled.followers(row.on(spread), |p| self.join_points(first, p));
            }
        }
        // Counting sort from the back.
        self.starts.clear();
        self.joined.clear();
        for row in rows.iter() {
            let root = movable(spread, row, inverse_mass).next().map_or(0, |p| self.root(p)) as usize;
            if self.number[root] == u32::MAX {
                self.number[root] = self.starts.len() as u32;
                self.starts.push(0);
            }
            let number = self.number[root];
            self.starts[number as usize] += 1;
            self.joined.push(number);
        }
        let mut sum = 0;
        for start in &mut self.starts {
            sum += *start;
            *start = sum;
        }
        self.order.resize(rows.len(), 0);
        for (k, number) in self.joined.iter().enumerate().rev() {
            let start = &mut self.starts[*number as usize];
            *start -= 1;
            self.order[*start as usize] = k as u32;
        }
        self.starts.push(sum);
        self.sorted.clear();
        self.sorted.extend(self.order.iter().map(|k| rows[*k as usize]));
        std::mem::swap(rows, &mut self.sorted);
        self.heads.clear();
        self.heads.extend(rows.iter().map(|row| {
            if row.spread[1] > 0 {
                return (row.head(), 0);
            }
            let mut own = movable(spread, row, inverse_mass);
            let first = own.next().unwrap_or(row.points[0]);
            let mut head = [first; 4];
            head.iter_mut().skip(1).zip(own).for_each(|(head, p)| *head = p);
            (head, 0)
        }));
    }
}

/// The problem to solve.
pub(crate) struct Problem<'a, const D: usize> {
    pub(crate) rows: &'a mut Vec<Row<D>>,
    pub(crate) spread: &'a Spread,
    pub(crate) inverse_mass: &'a Vec<[f64; D]>,
    pub(crate) coupled: &'a mut Coupled<D>,
    pub(crate) v: &'a mut Vec<[f64; D]>,
    pub(crate) turns: &'a mut Turns<D>,
    /// For bodies at rest, the velocity of an approach by a whole thickness [m/s]. Their sweeps also end at the tolerance
    /// relative to this velocity.
    pub(crate) at_rest: Option<f64>,
    /// Whether coupled bodies have a budget.
    pub(crate) has_budget: bool,
    /// The body of every point.
    pub(crate) body: &'a [u32],
}

impl<const D: usize> Problem<'_, D> {
    /// The same problem, if it has this many dimensions.
    fn of<const E: usize>(&mut self) -> Option<Problem<'_, E>> {
        fn cast<A: Any, B: Any>(one: &mut A) -> Option<&mut B> {
            (one as &mut dyn Any).downcast_mut()
        }
        Some(Problem {
            rows: cast(self.rows)?,
            spread: self.spread,
            inverse_mass: (self.inverse_mass as &dyn Any).downcast_ref()?,
            coupled: cast(self.coupled)?,
            v: cast(self.v)?,
            turns: cast(self.turns)?,
            at_rest: self.at_rest,
            has_budget: self.has_budget,
            body: self.body,
        })
    }

    /// Sweeps over the rows, forward and backward, until the velocities no longer change, separately for rows that no point
    /// connects. Returns the number of turns.
    ///
    /// The code behind this call is not generic, so that the sweeps are compiled once, with this crate.
    pub(crate) fn solve(mut self) -> usize {
        if let Some(plane) = self.of::<2>() {
            return solve_in_plane(plane);
        }
        self.of::<3>().map_or(0, solve_in_space)
    }
}

#[inline(never)]
fn solve_in_plane(problem: Problem<'_, 2>) -> usize {
    solve(problem)
}

#[inline(never)]
fn solve_in_space(problem: Problem<'_, 3>) -> usize {
    solve(problem)
}

/// A row is skipped as long as none of its velocities has changed by more than the tolerance since its last turn, so the cost of
/// a sweep depends on the number of rows that still change.
fn solve<const D: usize>(problem: Problem<'_, D>) -> usize {
    let Problem { rows, spread, inverse_mass, coupled, v, turns, at_rest, has_budget, body } = problem;
    turns.join(rows, spread, inverse_mass, coupled);
    let Turns { stamps, heads, now, starts, approach, .. } = turns;
    let begin = *now;
    for ends in starts.windows(2) {
        let range = ends[0] as usize..ends[1] as usize;
        let (rows, heads) = (&mut rows[range.clone()], &mut heads[range]);
        let approach = approach.mean[approach.root(body[spread.points_of::<D>(&heads[0].0)[0] as usize]) as usize].0;
        let together = rows.iter().any(|row| row.coupled);
        let (most, enough) = match (together, at_rest) {
            (true, None) if has_budget => (MOST_SWEEPS, TOLERANCE * approach),
            (true, None) => (MOST_COUPLED_SWEEPS, COUPLED_TOLERANCE * approach),
            (true, Some(whole)) => {
                (MOST_COUPLED_SWEEPS, (TOLERANCE_AT_REST * approach).larger(COUPLED_TOLERANCE * whole))
            }
            (false, _) => (MOST_SWEEPS, TOLERANCE * approach),
        };
        let aim = Aim { enough, sweeps: has_budget.then_some(most) };
        if together && let Some(turns) = working_set::solve(rows, spread, inverse_mass, coupled, v, aim) {
            *now += turns as u64;
            continue;
        }
        let (mut failures, mut smallest) = (0, f64::INFINITY);
        for sweep in 0..most {
            let steps = together && sweep > 0 && sweep % SWEEPS_BETWEEN == 0 && failures < MOST_FAILURES;
            if steps {
                subspace::step(rows, spread, inverse_mass, coupled, v);
                // All velocities may have changed.
                heads.iter_mut().for_each(|(_, last)| *last = 0);
            }
            let mut largest: f64 = 0.0;
            let mut changed = false;
            for k in 0..rows.len() {
                let k = if sweep % 2 == 0 { k } else { rows.len() - 1 - k };
                let (points, last) = &mut heads[k];
                let points = spread.points_of::<D>(points);
                if *last > 0 && points.iter().all(|p| stamps[*p as usize] <= *last) {
                    continue;
                }
                *now += 1;
                let change = if rows[k].coupled || rows[k].spread[1] > 0 {
                    rows[k].solve_coupled(spread, inverse_mass, coupled, v)
                } else {
                    rows[k].solve(inverse_mass, v)
                };
                largest = change.larger(largest);
                if change > enough {
                    changed = true;
                    points.iter().for_each(|p| stamps[*p as usize] = *now);
                    if rows[k].coupled {
                        coupled.followers(rows[k].on(spread), |p| stamps[p as usize] = *now);
                    }
                }
                *last = *now;
            }
            if steps {
                failures += usize::from(largest > 0.5 * smallest);
                smallest = largest.smaller(smallest);
            }
            if !changed || at_rest.is_some() && failures >= MOST_FAILURES_AT_REST {
                break;
            }
        }
    }
    (*now - begin) as usize
}

/// Finds displacements that separate overlapping pairs by at most `most` [m] without causing other overlaps, with the same
/// sweeps applied to positions. `wanted` is the required increase of the gap of every row [m], and `masses` is the mass of its
/// points if each moves by itself [kg].
pub(crate) fn part<const D: usize>(
    rows: &[Row<D>],
    spread: &Spread,
    inverse_mass: &[[f64; D]],
    (wanted, masses): (&[f64], &[f64]),
    multipliers: &mut Vec<f64>,
    moved: &mut [[f64; D]],
    most: f64,
) {
    multipliers.clear();
    multipliers.resize(rows.len(), 0.0);
    for _ in 0..MOST_SWEEPS {
        let mut largest: f64 = 0.0;
        for (k, row) in rows.iter().enumerate() {
            let now = dot(&row.mean(spread, moved), &row.normal);
            let old = multipliers[k];
            let new = (old + (wanted[k] - now) * masses[k]).larger(0.0);
            if new != old {
                multipliers[k] = new;
                row.give(spread, &scaled(&row.normal, new - old), inverse_mass, moved);
                largest = ((new - old) / masses[k]).abs().larger(largest);
            }
        }
        if largest <= TOLERANCE * most {
            return;
        }
    }
}
