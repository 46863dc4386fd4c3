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

/// What is left of the velocities of contacts, relative to the mean approach of bodies that hang together, where the sweeps end: at rest, where that is
/// h g, a contact then creeps by less than a hundredth of what one step of free fall would make. Impulses of the next step start from there and
/// every contact gets a turn in it, so what is left of a step does not add up; at the beginning of a frame alone all starts anew. A
/// thousandth needs two to three times the turns, for kinetic energies of a heap that differ by less than a thousandth.
const TOLERANCE: f64 = 1e-2;

/// The most sweeps of a step. A sweep carries an impulse through all contacts in its direction, so a column of bodies converges with the
/// number of its contacts that hang together within one step of the elastic wave: a few.
const MOST_SWEEPS: usize = 60;

/// The same of contacts of bodies that solve for the end of a step. Forces balance what is left, so it shows in the force: with 1e-5 the pressure
/// on a patch is wrong by 2e-4 (the rows `contact-patch-…` ask for 1e-6).
const COUPLED_TOLERANCE: f64 = 1e-9;

/// The same of bodies at rest, relative to the approach of the correction at hand: the next one solves for what is left, whose approach is smaller. A tenth
/// takes half as many corrections again.
const TOLERANCE_AT_REST: f64 = 1e-3;

/// The most sweeps of them. Contacts without friction take up to 30; those that stick and slide in turn have no end, and with 300 sweeps no test
/// or row comes nearer.
const MOST_COUPLED_SWEEPS: usize = 100;

/// Sweeps before each step in the subspace of the contacts that act: one to, one fro.
const SWEEPS_BETWEEN: usize = 2;

/// After so many of these steps that did not halve what a sweep changes, sweeps go on alone: with friction, contacts may stick and slide in turn.
const MOST_FAILURES: usize = 16;

/// After so many of them sweeps of bodies at rest end: the next correction goes on from there.
const MOST_FAILURES_AT_REST: usize = 2;

/// When rows were solved for, and when what they hold has changed, counted in turns of rows: beside the rows, which are large.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turns<const D: usize> {
    /// When the velocity of a point changed last.
    stamps: Vec<u64>,
    /// The points of the rows, and their last turns; 0 before the first.
    heads: Vec<([u32; 4], u64)>,
    now: u64,
    /// Another point that is joined by rows, or the point itself.
    parent: Vec<u32>,
    /// The number of those that a point is joined to, by its root; and where their rows begin, in the order in which they are met.
    number: Vec<u32>,
    starts: Vec<u32>,
    joined: Vec<u32>,
    /// Where every row of the sorted ones stood in the order of features.
    order: Vec<u32>,
    sorted: Vec<Row<D>>,
    approach: Approach,
}

/// The mean approach of the contacts of bodies that hang together by contacts [m/s]: where one pair crashes, others may lie at rest. What bodies
/// do that these do not touch changes nothing.
#[derive(Clone, Debug, Default)]
struct Approach {
    /// Another body that hangs together with each, or the body itself.
    parent: Vec<u32>,
    /// By the root of the bodies: the sum and the number of contacts, then the mean.
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
            // Half of the way is cut off for whoever comes next.
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

    /// Where the rows of those that points join begin, and where the last ones end.
    pub(crate) fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Where every row stood in the order of features.
    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    /// The velocity that sweeps leave of a row, at most [m/s].
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

    /// Finds the mean approaches of rows, given the bodies of all points, how many there are, and the velocities before contact [m/s].
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

    /// Sorts rows into those that points join, each in the order of features: what is solved together lies together.
    fn join(&mut self, rows: &mut Vec<Row<D>>, spread: &Spread, inverse_mass: &[[f64; D]], coupled: &Coupled<D>) {
        if !rows.is_sorted_by_key(|row| row.id) {
            rows.sort_by_key(|row| row.id);
        }
        // What cannot move passes nothing on.
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
        // Counted, summed up, and entered from behind.
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

/// What is solved for.
pub(crate) struct Problem<'a, const D: usize> {
    pub(crate) rows: &'a mut Vec<Row<D>>,
    pub(crate) spread: &'a Spread,
    pub(crate) inverse_mass: &'a Vec<[f64; D]>,
    pub(crate) coupled: &'a mut Coupled<D>,
    pub(crate) v: &'a mut Vec<[f64; D]>,
    pub(crate) turns: &'a mut Turns<D>,
    /// Of bodies at rest the approach in a whole thickness [m/s]: their sweeps end with the tolerance of it, too.
    pub(crate) at_rest: Option<f64>,
    /// Whether bodies that follow as a whole have a budget.
    pub(crate) has_budget: bool,
    /// The body of every point.
    pub(crate) body: &'a [u32],
}

impl<const D: usize> Problem<'_, D> {
    /// The same problem where it is one of so many dimensions.
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

    /// Sweeps over the rows, to and fro, until the velocities stay: separately over rows that no point joins. Gives how many turns rows had.
    ///
    /// Not generic behind this call: the sweeps are compiled once, with this crate.
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

/// A row is passed over while nothing that it holds has changed since its last turn by more than the tolerance: so sweeps cost what is still
/// on the move.
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

/// Displacements that take overlapping pairs apart by at most `most` [m], without bringing others into overlap: the same sweeps, on positions.
/// `wanted` is what every row is to gain [m], and `masses` what its points weigh where each moves by itself [kg].
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
