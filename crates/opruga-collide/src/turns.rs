//! Sets of contacts that points connect.

use crate::blocks::Blocks;
use crate::coupled::Coupled;
use crate::least_parts;
use crate::lists;
use crate::row::Row;
use crate::spread::Spread;
use crate::sweeps::Sweeps;
use crate::vector::{dot, length, subtract};
use core::ops::Range;
use core::sync::atomic::{AtomicU64, Ordering};
use opruga_core::threads;
use opruga_math::Lane;

/// The sweeps end when the remaining contact velocities are below this fraction of the mean approach velocity of the connected
/// bodies. At rest, where that velocity is h g, a contact then creeps by less than a hundredth of one step of free fall. The
/// next step starts from these impulses and processes every contact, so the remainders do not accumulate. The world also passes
/// impulses on from frame to frame ([`crate::Touching::keep`]). A tolerance of a thousandth needs two to three times as many
/// turns and changes the kinetic energy of a heap by less than a thousandth.
pub(crate) const TOLERANCE: f64 = 1e-2;

/// The corresponding fraction (see [`TOLERANCE`]) for contacts of bodies with implicit integrators. The forces of these bodies
/// balance the remaining velocities and therefore contain an error. With a fraction of 1e-5, the pressure on a patch is wrong
/// by 2e-4 (the cases `contact-patch-…` of the verification require 1e-6).
pub(crate) const COUPLED_TOLERANCE: f64 = 1e-9;

/// The first sweep that solves blocks of two contacts together. Most sets converge before it, and need no blocks.
const FIRST_WITH_BLOCKS: usize = 3;

/// The sets of rows that points connect. The structure also stores the times at which rows were last solved and at which their velocities last
/// changed, counted in turns of rows. The times are stored separately from the rows, which are large.
#[derive(Clone, Debug, Default)]
pub(crate) struct Turns<const D: usize> {
    /// The turn in which the velocity of each point last changed.
    stamps: Vec<u32>,
    /// The points of each row, and the number of its last turn; 0 before the first turn. In a set whose points respond independently, a point is
    /// given by its index in this set.
    heads: Vec<([u32; 4], u32)>,
    now: u32,
    /// The points of all sets whose points respond independently, and the first point of every set.
    alone: Alone<D>,
    first_alone: Vec<u32>,
    /// For each point, another one to which rows connect it, or the point itself.
    parent: Vec<u32>,
    /// For the root of each set of points, the number of this set. Also the start of the rows of each set. Sets are numbered in the order in which
    /// they are found.
    number: Vec<u32>,
    starts: Vec<u32>,
    joined: Vec<u32>,
    /// The position of every sorted row in the order of features.
    order: Vec<u32>,
    /// The points of every row that can move, in the order of features. Also whether a set has points that do not respond independently.
    movers: Vec<[u32; 4]>,
    mixed: Vec<bool>,
    approach: Approach,
}

/// Points that respond independently, one set after the other. Threads can solve for different sets at the same time because every set has its own
/// copies of what its rows read and write.
#[derive(Clone, Debug, Default)]
struct Alone<const D: usize> {
    /// The point of every copy, and whether the rows of the set move it. Points that they do not move may have several copies.
    points: Vec<(u32, bool)>,
    v: Vec<[f64; D]>,
    inverse_mass: Vec<[f64; D]>,
    stamps: Vec<u32>,
}

/// The mean approach velocity of the contacts of connected bodies [m/s]. Each set of connected bodies has its own mean, because
/// some bodies may crash while others are at rest.
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

    /// The mean approach velocity of all bodies that are connected to the given one [m/s].
    fn of(&self, body: u32) -> f64 {
        self.mean[self.root(body) as usize].0
    }
}

/// Whether a point of a row can move.
#[inline(always)]
fn moves<const D: usize>(row: &Row<D>, k: usize, inverse_mass: &[[f64; D]]) -> bool {
    let p = row.points[k] as usize;
    let mut any = false;
    for d in 0..D {
        any |= inverse_mass[p][d] != 0.0;
    }
    any & (row.weights[k] != 0.0)
}

/// The points of a row that can move. A row with fewer points repeats its first one.
fn moving_head<const D: usize>(row: &Row<D>, inverse_mass: &[[f64; D]]) -> [u32; 4] {
    if row.spread[1] > 0 {
        return row.head();
    }
    // Without branches, because the processor cannot predict which points have a weight.
    let (mut head, mut count) = ([0; 4], 0);
    for k in 0..=D {
        head[count] = row.points[k];
        count += usize::from(moves(row, k, inverse_mass));
    }
    let first = head[0];
    head.iter_mut().enumerate().for_each(|(k, p)| *p = if k < count { *p } else { first });
    if count == 0 { Spread::NOBODY } else { head }
}

/// The points of a head in the list of points that can move. A point may occur more than once.
fn movers_of<'a, const D: usize>(
    head: &'a [u32; 4],
    spread: &'a Spread,
    inverse_mass: &'a [[f64; D]],
) -> impl Iterator<Item = u32> + 'a {
    // A head that contains points contains only those that can move.
    let all = !Spread::is_elsewhere(head);
    let own = spread.points_of::<D>(head).iter().zip(spread.weights_of::<D>(head));
    own.filter(move |(p, w)| all || **w != 0.0 && inverse_mass[**p as usize] != [0.0; D]).map(|(p, _)| *p)
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
            // Path halving makes later searches shorter.
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
        let head = moving_head(row, inverse_mass);
        let first = movers_of(&head, spread, inverse_mass).next();
        let tolerance = if exact { COUPLED_TOLERANCE } else { TOLERANCE };
        first.map_or(0.0, |p| tolerance * self.approach.of(body[p as usize]))
    }

    /// Lists the points of every row that can move. A row with fewer points repeats its first one.
    fn find_movers(&mut self, rows: &[Row<D>], inverse_mass: &[[f64; D]]) {
        self.movers.clear();
        lists::reserve(&mut self.movers, rows.len());
        self.movers.extend(rows.iter().map(|row| moving_head(row, inverse_mass)));
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
        self.find_movers(rows, inverse_mass);
        let Turns { approach, movers, .. } = self;
        approach.parent.clear();
        approach.parent.extend(0..bodies as u32);
        approach.mean.clear();
        approach.mean.resize(bodies, (0.0, 0));
        for head in &*movers {
            let mut own = movers_of(head, spread, inverse_mass).map(|p| body[p as usize]);
            let Some(first) = own.next() else { continue };
            own.filter(|other| *other != first).for_each(|other| approach.join(first, other));
        }
        for (row, head) in rows.iter().zip(&*movers) {
            let Some(first) = movers_of(head, spread, inverse_mass).next() else { continue };
            let u = subtract(&row.mean(spread, v), &row.carry);
            let speed = (row.target - dot(&u, &row.normal)).larger(0.0);
            let root = approach.root(body[first as usize]) as usize;
            let (sum, count) = &mut approach.mean[root];
            *sum += if row.friction > 0.0 { length(&u).larger(speed) } else { speed };
            *count += 1;
        }
        for (sum, count) in approach.mean.iter_mut().filter(|(_, count)| *count > 0) {
            *sum /= f64::from(*count);
        }
    }

    /// Sorts rows into connected sets, each in the order of features, so that rows that are solved together are stored together. The approach
    /// velocities of the rows must be known.
    pub(crate) fn join(
        &mut self,
        rows: &mut [Row<D>],
        spread: &Spread,
        inverse_mass: &[[f64; D]],
        coupled: &Coupled<D>,
    ) {
        if !rows.is_sorted_by_key(Row::sort_key) {
            rows.sort_by_key(Row::sort_key);
            self.find_movers(rows, inverse_mass);
        }
        let movers = std::mem::take(&mut self.movers);
        let any_coupled = coupled.count() > 0;
        let coupled_row = |k: usize| Some(&rows[k]).filter(|row| any_coupled && row.coupled);
        // Points that cannot move do not connect rows.
        for (k, head) in movers.iter().enumerate() {
            let mut begin = |p: u32| {
                self.parent[p as usize] = p;
                self.number[p as usize] = u32::MAX;
            };
            movers_of(head, spread, inverse_mass).for_each(&mut begin);
            if let Some(row) = coupled_row(k) {
                coupled.followers(row.on(spread), begin);
            }
        }
        for (k, head) in movers.iter().enumerate() {
            let mut own = movers_of(head, spread, inverse_mass);
            let Some(first) = own.next() else { continue };
            for p in own.filter(|p| *p != first) {
                self.join_points(first, p);
            }
            if let Some(row) = coupled_row(k) {
                coupled.followers(row.on(spread), |p| self.join_points(first, p));
            }
        }
        self.stamps.fill(0);
        self.now = 0;
        // Counting sort from the back.
        self.starts.clear();
        self.joined.clear();
        self.mixed.clear();
        for (k, head) in movers.iter().enumerate() {
            let root = movers_of(head, spread, inverse_mass).next().map_or(0, |p| self.root(p)) as usize;
            if self.number[root] == u32::MAX {
                self.number[root] = self.starts.len() as u32;
                self.starts.push(0);
                self.mixed.push(false);
            }
            let number = self.number[root];
            self.starts[number as usize] += 1;
            self.mixed[number as usize] |= Spread::is_elsewhere(head) || coupled_row(k).is_some();
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
        self.sort(rows, &movers, inverse_mass);
        self.movers = movers;
    }

    /// Puts the rows into the new order, and copies the points that respond independently.
    fn sort(&mut self, rows: &mut [Row<D>], movers: &[[u32; 4]], inverse_mass: &[[f64; D]]) {
        let Turns { heads, alone, first_alone, starts, number, order, mixed, joined, .. } = self;
        heads.clear();
        lists::reserve(heads, rows.len());
        alone.points.clear();
        first_alone.clear();
        for (ends, mixed) in starts.windows(2).zip(mixed) {
            let own = &order[ends[0] as usize..ends[1] as usize];
            let first = alone.points.len() as u32;
            first_alone.push(first);
            if *mixed {
                heads.extend(own.iter().map(|k| (movers[*k as usize], 0)));
                continue;
            }
            own.iter().flat_map(|k| &movers[*k as usize]).for_each(|p| number[*p as usize] = u32::MAX);
            for k in own {
                let row = &rows[*k as usize];
                let (mut head, mut end) = ([0; 4], alone.points.len());
                lists::resize(&mut alone.points, end + D + 1, (0, false));
                for k in 0..=D {
                    let (p, moves) = (row.points[k], moves(row, k, inverse_mass));
                    let known = number[p as usize];
                    let is_new = !moves | (known == u32::MAX);
                    head[k] = if is_new { end as u32 - first } else { known };
                    number[p as usize] = if moves { head[k] } else { known };
                    alone.points[end] = (p, moves);
                    end += usize::from(is_new);
                }
                alone.points.truncate(end);
                heads.push((head, 0));
            }
        }
        lists::bring_into_order(rows, order, joined);
        first_alone.push(alone.points.len() as u32);
        alone.stamps.clear();
        lists::resize(&mut alone.stamps, alone.points.len(), 0);
        alone.inverse_mass.clear();
        lists::reserve(&mut alone.inverse_mass, alone.points.len());
        alone.inverse_mass.extend(alone.points.iter().map(|(p, _)| inverse_mass[*p as usize]));
    }

    /// A set with points that respond together with others, and the mean approach velocity of its bodies [m/s]; `None` for other sets. `body` gives
    /// the body of every point.
    pub(crate) fn coupled_set<'a>(
        &'a mut self,
        set: usize,
        rows: &'a mut [Row<D>],
        (inverse_mass, v): (&'a [[f64; D]], &'a mut [[f64; D]]),
        (spread, body): (&Spread, &[u32]),
    ) -> Option<(Sweeps<'a, D>, f64)> {
        if self.first_alone[set] < self.first_alone[set + 1] {
            return None;
        }
        let range = self.starts[set] as usize..self.starts[set + 1] as usize;
        let (rows, heads) = (&mut rows[range.clone()], &mut self.heads[range]);
        let first = spread.points_of::<D>(&heads[0].0).first();
        let approach = first.map_or(0.0, |p| self.approach.of(body[*p as usize]));
        let (stamps, now) = (&mut self.stamps[..], &mut self.now);
        Some((Sweeps { rows, heads, inverse_mass, v, stamps, now }, approach))
    }

    /// Solves the sets whose points respond independently, with at most `most` sweeps, on the threads of the pool if there are several. Sweeps may
    /// leave velocities of `tolerance` times the mean approach velocity. `body` gives the body of every point. Returns the number of turns.
    pub(crate) fn solve_alone(
        &mut self,
        rows: &mut [Row<D>],
        (v, body): (&mut [[f64; D]], &[u32]),
        (most, tolerance): (usize, f64),
        threads: usize,
    ) -> usize {
        let Turns { heads, alone, first_alone, starts, approach, .. } = self;
        let Alone { points, v: own, inverse_mass, stamps } = alone;
        own.clear();
        lists::reserve(own, points.len());
        own.extend(points.iter().map(|(p, _)| v[*p as usize]));
        let least = threads::part_size(rows.len(), threads, least_parts::CONTACTS);
        let (mut rows, mut heads) = (rows, &mut heads[..]);
        let (mut copies, mut stamps) = (&mut own[..], &mut stamps[..]);
        let mut first = 0;
        let sets = first_alone.len() - 1;
        let parts = core::iter::from_fn(|| {
            let is_enough = |end: &usize| (starts[*end] - starts[first]) as usize >= least;
            let end = (first < sets).then(|| (first + 1..sets).find(is_enough).unwrap_or(sets))?;
            let range = [&*starts, &*first_alone].map(|starts| (starts[end] - starts[first]) as usize);
            let part = Part {
                sets: first..end,
                rows: rows.split_off_mut(..range[0])?,
                heads: heads.split_off_mut(..range[0])?,
                v: copies.split_off_mut(..range[1])?,
                stamps: stamps.split_off_mut(..range[1])?,
            };
            first = end;
            Some(part)
        });
        let turns = AtomicU64::new(0);
        threads::each_in_pool(parts, |part| {
            let (mut now, mut blocks) = (0, Blocks::default());
            let [first_row, first_copy] = [&*starts, &*first_alone].map(|starts| starts[part.sets.start]);
            for set in part.sets.clone() {
                let of =
                    |starts: &[u32], first: u32| (starts[set] - first) as usize..(starts[set + 1] - first) as usize;
                let (rows, own) = (of(starts, first_row), of(first_alone, first_copy));
                if own.is_empty() {
                    continue;
                }
                let copies = first_alone[set] as usize..first_alone[set + 1] as usize;
                let enough = tolerance * approach.of(body[points[copies.start].0 as usize]);
                let mut sweeps = Sweeps {
                    rows: &mut part.rows[rows.clone()],
                    heads: &mut part.heads[rows],
                    inverse_mass: &inverse_mass[copies],
                    v: &mut part.v[own.clone()],
                    stamps: &mut part.stamps[own],
                    now: &mut now,
                };
                blocks.clear(sweeps.rows.len());
                for sweep in 0..most {
                    if sweep == FIRST_WITH_BLOCKS {
                        sweeps.find_blocks(&mut blocks);
                    }
                    if !sweeps.sweep_alone(sweep % 2 == 1, enough, &mut blocks) {
                        break;
                    }
                }
            }
            turns.fetch_add(u64::from(now), Ordering::Relaxed);
        });
        for ((p, moves), own) in points.iter().zip(&*own) {
            if *moves {
                v[*p as usize] = *own;
            }
        }
        turns.into_inner() as usize
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        4 * (self.stamps.capacity() + self.alone.stamps.capacity())
            + 8 * self.alone.points.capacity()
            + 20 * self.heads.capacity()
            + 16 * self.movers.capacity()
            + self.mixed.capacity()
            + 8 * D * (self.alone.v.capacity() + self.alone.inverse_mass.capacity())
            + 4 * (self.parent.capacity()
                + self.number.capacity()
                + self.starts.capacity()
                + self.first_alone.capacity())
            + 4 * (self.joined.capacity() + self.order.capacity())
    }
}

/// Some sets whose points respond independently.
struct Part<'a, const D: usize> {
    sets: Range<usize>,
    rows: &'a mut [Row<D>],
    heads: &'a mut [([u32; 4], u32)],
    v: &'a mut [[f64; D]],
    stamps: &'a mut [u32],
}
