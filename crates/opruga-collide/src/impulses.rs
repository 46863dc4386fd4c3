//! Impulses on pairs in contact: projected Gauss–Seidel.

use crate::coupled::Coupled;
use crate::gap::Gap;
use crate::vector::{dot, length, scaled, subtract};
use core::any::Any;
use opruga_math::Lane;

/// One contact: a lower bound of its normal velocity, and Coulomb friction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<const D: usize> {
    /// Its features: rows ascend by it, and impulses of the last substep are found by it.
    pub(crate) id: u64,
    pub(crate) points: [u32; 4],
    pub(crate) weights: [f64; 4],
    pub(crate) normal: [f64; D],
    /// The gap at the beginning of the step, less the thickness [m].
    pub(crate) gap: f64,
    /// The normal velocity that it must have at least at the end [m/s].
    pub(crate) target: f64,
    /// The velocity of an obstacle [m/s]; zero between bodies.
    pub(crate) carry: [f64; D],
    pub(crate) friction: f64,
    /// Inverse of the inverse mass along the normal, and the least across it [kg]; 0 where nothing can move.
    pub(crate) mass: [f64; 2],
    /// Multipliers: the impulse along the normal and that across it [N s].
    pub(crate) normal_impulse: f64,
    pub(crate) friction_impulse: [f64; D],
    /// Whether the second feature is an obstacle.
    pub(crate) of_obstacle: bool,
    /// Whether points of a body follow one another ([`Coupled`]).
    pub(crate) coupled: bool,
}

impl<const D: usize> Row<D> {
    pub(crate) fn new(id: u64, gap: &Gap<D>, thickness: f64, friction: f64, inverse_mass: &[[f64; D]]) -> Row<D> {
        let mut row = Row {
            id,
            points: gap.points,
            weights: gap.weights,
            normal: gap.normal,
            gap: gap.gap - thickness,
            target: 0.0,
            carry: [0.0; D],
            friction,
            mass: [0.0; 2],
            normal_impulse: 0.0,
            friction_impulse: [0.0; D],
            of_obstacle: false,
            coupled: false,
        };
        row.weigh(inverse_mass);
        row
    }

    /// Works out what it weighs.
    pub(crate) fn weigh(&mut self, inverse_mass: &[[f64; D]]) {
        let (mut along, mut across) = (0.0, 0.0);
        for k in 0..=D {
            let (w, m) = (self.weights[k] * self.weights[k], &inverse_mass[self.points[k] as usize]);
            let mut most: f64 = 0.0;
            for d in 0..D {
                along += w * self.normal[d] * self.normal[d] * m[d];
                most = m[d].larger(most);
            }
            across += w * most;
        }
        let inverse = |k: f64| if k > 0.0 { 1.0 / k } else { 0.0 };
        self.mass = [inverse(along), inverse(across)];
    }

    /// Works out what it weighs where points follow one another.
    pub(crate) fn weigh_coupled(&mut self, coupled: &Coupled<D>, inverse_mass: &[[f64; D]]) {
        let mobility = coupled.mobility((&self.points, &self.weights), inverse_mass);
        // Across the normal the largest row sum is at least what any direction has.
        let (mut along, mut across) = (0.0, 0.0);
        for (d, row) in mobility.iter().enumerate() {
            along += self.normal[d] * dot(row, &self.normal);
            across = row.iter().map(|c| c.abs()).sum::<f64>().larger(across);
        }
        let inverse = |k: f64| if k > 0.0 { 1.0 / k } else { 0.0 };
        (self.mass, self.coupled) = ([inverse(along), inverse(across)], true);
    }

    /// The friction impulse that stops the sliding of velocity u, as far as the normal impulse allows [N s].
    #[inline(always)]
    fn friction_after(&self, u: &[f64; D], un: f64, normal_impulse: f64) -> [f64; D] {
        let mut after = self.friction_impulse;
        for d in 0..D {
            after[d] -= (u[d] - un * self.normal[d]) * self.mass[1];
        }
        // Impulses of the last substep may have been along another normal.
        let along = dot(&after, &self.normal);
        for d in 0..D {
            after[d] -= along * self.normal[d];
        }
        let (size, most) = (length(&after), self.friction * normal_impulse);
        if size > most { scaled(&after, most / size) } else { after }
    }

    /// One turn where points follow one another: as [`Row::solve`].
    fn solve_coupled(&mut self, inverse_mass: &[[f64; D]], coupled: &mut Coupled<D>, v: &mut [[f64; D]]) -> f64 {
        if self.mass[0] == 0.0 {
            return 0.0;
        }
        let un = dot(&subtract(&self.mean(v), &self.carry), &self.normal);
        let old = self.normal_impulse;
        let new = (old + (self.target - un) * self.mass[0]).larger(0.0);
        let mut changed = ((new - old) / self.mass[0]).abs();
        if new != old {
            coupled.give((&self.points, &self.weights), &scaled(&self.normal, new - old), inverse_mass, v);
            self.normal_impulse = new;
        }
        if self.friction > 0.0 && (new > 0.0 || old > 0.0) {
            let u = subtract(&self.mean(v), &self.carry);
            let un = dot(&u, &self.normal);
            let after = self.friction_after(&u, un, new);
            let change = subtract(&after, &self.friction_impulse);
            let largest = length(&change);
            if largest > 0.0 {
                coupled.give((&self.points, &self.weights), &change, inverse_mass, v);
                self.friction_impulse = after;
                changed = (largest / self.mass[1]).larger(changed);
            }
        }
        changed
    }

    /// Σ wᵢ aᵢ.
    #[inline]
    pub(crate) fn mean(&self, of: &[[f64; D]]) -> [f64; D] {
        let mut sum = [0.0; D];
        for k in 0..=D {
            let a = &of[self.points[k] as usize];
            for d in 0..D {
                sum[d] += self.weights[k] * a[d];
            }
        }
        sum
    }

    /// Gives its points an impulse [N s].
    #[inline]
    pub(crate) fn give(&self, impulse: &[f64; D], inverse_mass: &[[f64; D]], v: &mut [[f64; D]]) {
        for k in 0..=D {
            let p = self.points[k] as usize;
            for d in 0..D {
                v[p][d] += self.weights[k] * impulse[d] * inverse_mass[p][d];
            }
        }
    }

    /// The whole impulse [N s].
    pub(crate) fn impulse(&self) -> [f64; D] {
        let mut out = self.friction_impulse;
        for d in 0..D {
            out[d] += self.normal_impulse * self.normal[d];
        }
        out
    }

    /// One turn: the normal impulse that its bound needs, then the friction that this allows. Gives by how much its velocity changed [m/s].
    #[inline(always)]
    fn solve(&mut self, inverse_mass: &[[f64; D]], v: &mut [[f64; D]]) -> f64 {
        // Velocities and inverse masses of its points, which are at most D + 1, come from memory once.
        let (mut own, mut inverse) = ([[0.0; D]; 4], [[0.0; D]; 4]);
        for k in 0..=D {
            let p = self.points[k] as usize;
            (own[k], inverse[k]) = (v[p], inverse_mass[p]);
        }
        let mean = |own: &[[f64; D]; 4]| {
            let mut sum = [0.0; D];
            for k in 0..=D {
                for d in 0..D {
                    sum[d] += self.weights[k] * own[k][d];
                }
            }
            subtract(&sum, &self.carry)
        };
        let give = |own: &mut [[f64; D]; 4], impulse: &[f64; D]| {
            for k in 0..=D {
                for d in 0..D {
                    own[k][d] += self.weights[k] * impulse[d] * inverse[k][d];
                }
            }
        };
        let mut u = mean(&own);
        let mut un = dot(&u, &self.normal);
        let old = self.normal_impulse;
        let new = (old + (self.target - un) * self.mass[0]).larger(0.0);
        let mut changed = 0.0;
        if new != old {
            give(&mut own, &scaled(&self.normal, new - old));
            changed = ((new - old) / self.mass[0]).abs();
        }
        let mut after = self.friction_impulse;
        if self.friction > 0.0 && (new > 0.0 || old > 0.0) {
            if new != old {
                u = mean(&own);
                un = dot(&u, &self.normal);
            }
            after = self.friction_after(&u, un, new);
            let change = subtract(&after, &self.friction_impulse);
            let largest = dot(&change, &change);
            if largest > 0.0 {
                give(&mut own, &change);
                changed = (largest.sqrt() / self.mass[1]).larger(changed);
            }
        }
        if changed > 0.0 {
            (self.normal_impulse, self.friction_impulse) = (new, after);
            // The first point last: an obstacle has no points, and repeats it.
            for k in (0..=D).rev() {
                v[self.points[k] as usize] = own[k];
            }
        }
        changed
    }
}

/// What is left of the velocities of contacts, relative to the mean approach of the step, where the sweeps end: at rest, where that is
/// h g, a contact then creeps by less than a hundredth of what one step of free fall would make. Impulses of the next step start from there and
/// every contact gets a turn in it, so what is left of a step does not add up; at the beginning of a frame alone all starts anew. A
/// thousandth needs two to three times the turns, for kinetic energies of a heap that differ by less than a thousandth.
const TOLERANCE: f64 = 1e-2;

/// The most sweeps of a step. A sweep carries an impulse through all contacts in its direction, so a column of bodies converges with the
/// number of its contacts that hang together within one step of the elastic wave: a few.
const MOST_SWEEPS: usize = 60;

/// The same of contacts of bodies that solve for the end of a step: forces balance what sweeps leave, so it shows in the force. With 1e-3 a block at
/// rest presses by 1 % less than its weight (`blocks_come_to_rest…`), with 60 sweeps by 1e-5 (the row `weight-on-body` asks for 1e-6).
const COUPLED_TOLERANCE: f64 = 1e-5;
const MOST_COUPLED_SWEEPS: usize = 300;

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
    sorted: Vec<Row<D>>,
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

    /// Sorts rows into those that points join, each in the order of features: what is solved together lies together.
    fn join(&mut self, rows: &mut Vec<Row<D>>, coupled: &Coupled<D>) {
        if !rows.is_sorted_by_key(|row| row.id) {
            rows.sort_by_key(|row| row.id);
        }
        let points = |row: &Row<D>| {
            let (points, weights) = (row.points, row.weights);
            (0..=D).filter(move |k| weights[*k] != 0.0).map(move |k| points[k])
        };
        for row in rows.iter() {
            let mut begin = |p: u32| {
                self.parent[p as usize] = p;
                self.number[p as usize] = u32::MAX;
            };
            points(row).for_each(&mut begin);
            if row.coupled {
                coupled.followers((&row.points, &row.weights), begin);
            }
        }
        for row in rows.iter() {
            let mut own = points(row);
            let Some(first) = own.next() else { continue };
            for p in own {
                self.join_points(first, p);
            }
            if row.coupled {
                coupled.followers((&row.points, &row.weights), |p| self.join_points(first, p));
            }
        }
        // Counted, summed up, and entered from behind.
        self.starts.clear();
        self.joined.clear();
        for row in rows.iter() {
            let root = points(row).next().map_or(0, |p| self.root(p)) as usize;
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
        self.sorted.clone_from(rows);
        self.heads.resize(rows.len(), ([0; 4], 0));
        for (row, number) in rows.iter().zip(&self.joined).rev() {
            let start = &mut self.starts[*number as usize];
            *start -= 1;
            (self.sorted[*start as usize], self.heads[*start as usize]) = (*row, (row.points, 0));
        }
        self.starts.push(sum);
        std::mem::swap(rows, &mut self.sorted);
    }
}

/// What is solved for.
pub(crate) struct Problem<'a, const D: usize> {
    pub(crate) rows: &'a mut Vec<Row<D>>,
    pub(crate) inverse_mass: &'a Vec<[f64; D]>,
    pub(crate) coupled: &'a mut Coupled<D>,
    pub(crate) v: &'a mut Vec<[f64; D]>,
    pub(crate) turns: &'a mut Turns<D>,
    /// The mean approach [m/s].
    pub(crate) approach: f64,
}

impl<const D: usize> Problem<'_, D> {
    /// The same problem where it is one of so many dimensions.
    fn of<const E: usize>(&mut self) -> Option<Problem<'_, E>> {
        fn cast<A: Any, B: Any>(one: &mut A) -> Option<&mut B> {
            (one as &mut dyn Any).downcast_mut()
        }
        Some(Problem {
            rows: cast(self.rows)?,
            inverse_mass: (self.inverse_mass as &dyn Any).downcast_ref()?,
            coupled: cast(self.coupled)?,
            v: cast(self.v)?,
            turns: cast(self.turns)?,
            approach: self.approach,
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
    let Problem { rows, inverse_mass, coupled, v, turns, approach } = problem;
    turns.join(rows, coupled);
    let Turns { stamps, heads, now, starts, .. } = turns;
    let begin = *now;
    for ends in starts.windows(2) {
        let range = ends[0] as usize..ends[1] as usize;
        let (rows, heads) = (&mut rows[range.clone()], &mut heads[range]);
        let together = rows.iter().any(|row| row.coupled);
        let (most, tolerance) =
            if together { (MOST_COUPLED_SWEEPS, COUPLED_TOLERANCE) } else { (MOST_SWEEPS, TOLERANCE) };
        for sweep in 0..most {
            let mut changed = false;
            for k in 0..rows.len() {
                let k = if sweep % 2 == 0 { k } else { rows.len() - 1 - k };
                let (points, last) = &mut heads[k];
                if *last > 0 && points[..=D].iter().all(|p| stamps[*p as usize] <= *last) {
                    continue;
                }
                *now += 1;
                let change = if rows[k].coupled {
                    rows[k].solve_coupled(inverse_mass, coupled, v)
                } else {
                    rows[k].solve(inverse_mass, v)
                };
                if change > tolerance * approach {
                    changed = true;
                    points[..=D].iter().for_each(|p| stamps[*p as usize] = *now);
                    if rows[k].coupled {
                        coupled.followers((&rows[k].points, &rows[k].weights), |p| stamps[p as usize] = *now);
                    }
                }
                *last = *now;
            }
            if !changed {
                break;
            }
        }
    }
    (*now - begin) as usize
}

/// Displacements that take overlapping pairs apart by at most `most` [m], without bringing others into overlap: the same sweeps, on positions.
pub(crate) fn part<const D: usize>(
    rows: &[Row<D>],
    inverse_mass: &[[f64; D]],
    wanted: &[f64],
    multipliers: &mut Vec<f64>,
    moved: &mut [[f64; D]],
    most: f64,
) {
    multipliers.clear();
    multipliers.resize(rows.len(), 0.0);
    for _ in 0..MOST_SWEEPS {
        let mut largest: f64 = 0.0;
        for (k, row) in rows.iter().enumerate() {
            let now = dot(&row.mean(moved), &row.normal);
            let old = multipliers[k];
            let new = (old + (wanted[k] - now) * row.mass[0]).larger(0.0);
            if new != old {
                multipliers[k] = new;
                row.give(&scaled(&row.normal, new - old), inverse_mass, moved);
                largest = ((new - old) / row.mass[0]).abs().larger(largest);
            }
        }
        if largest <= TOLERANCE * most {
            return;
        }
    }
}
