//! How far points may move within a step.

use crate::least_parts;
use crate::surface::Surface;
use crate::vector::{Bounds, add, apart, dot, length, scaled, subtract, wider};
use core::ops::Range;
use opruga_core::threads;
use opruga_math::Lane;

/// For every point, the displacement that contact may add to its motion in the step, and the box of the last search for candidates.
///
/// All of this is relative to the motion of the bodies, so bodies that move together have the candidates of bodies at rest. Every point has its own
/// displacement and its own box, so one fast point does not turn all the others into candidates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reach<const D: usize> {
    pub(crate) bodies: Vec<BodyReach<D>>,
    /// Two displacements of every point [m]. The first one is what contact may add to its free motion. The second one is the largest displacement of
    /// the point relative to its body. Before the approaches of bodies are known, these are the lengths of the free displacement, and of that
    /// relative to the body.
    moves: Vec<[f64; 2]>,
    /// The box around the possible positions of every point within the step if its body does not move [m].
    pub(crate) swept: Vec<Bounds<D>>,
    /// The positions at the start of the step, and those at the last search for pairs of the body with itself, relative to the origin of the
    /// body [m].
    x: Vec<[f64; D]>,
    home: Vec<[f64; D]>,
    /// The box of every point for which the present candidates are complete, relative to the origin of its body [m].
    pub(crate) found_in: Vec<Bounds<D>>,
    /// The points that contact pushed farther than expected in the last call of [`Reach::grow`], ascending, and how much farther [m].
    grown: Vec<(u32, f64)>,
    /// For every point, whether it is among them.
    has_grown: Vec<bool>,
    blocks: Vec<Block<D>>,
}

/// The motion of a body. The displacement of a body in the free motion is the middle of the smallest and the largest displacement of its vertices along
/// every axis. The displacement in the previous step is that in the free motion before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BodyReach<const D: usize> {
    /// The box around the vertices at both ends of the free motion [m].
    pub(crate) hull: Bounds<D>,
    /// The displacement in the free motion, and in the previous step [m].
    pub(crate) free: [f64; D],
    pub(crate) moved: [f64; D],
    /// The largest displacement that contact may add to the motion of one of its points, and the largest displacement of a point relative to the
    /// body, with and without contact [m].
    pub(crate) most: [f64; 2],
    pub(crate) spread: f64,
    /// The largest displacement of a neighbour relative to the body in the free motion [m].
    pub(crate) approach: f64,
    /// The sum of the displacements of the body, and of the largest displacements of its vertices relative to it [m].
    pub(crate) origin: [f64; D],
    pub(crate) path: f64,
    /// The largest distance of a vertex from its position at the last search for pairs of the body with itself, relative to the origin [m].
    pub(crate) strayed: f64,
    /// The box around the boxes of the last search for candidates, relative to the origin [m].
    pub(crate) region: Bounds<D>,
    /// The path at the time of that search, and the shortest and the longest distance by which its boxes extended beyond the points [m].
    found_path: f64,
    found_within: [f64; 2],
    /// Whether a new search must find the candidates of the body. A new search is necessary if the boxes of the last search do not contain the
    /// possible positions of the points, with an eighth of a margin to spare. It is also necessary if these boxes are far too large because they were
    /// made for a faster motion.
    pub(crate) is_stale: bool,
    /// Whether it will soon be stale. The next search covers all such bodies at once.
    pub(crate) is_due: bool,
}

/// Vertices of one body, and the boxes around their positions and displacements.
#[derive(Clone, Debug)]
struct Block<const D: usize> {
    body: u32,
    vertices: Range<usize>,
    /// Whether these are all vertices of the body.
    is_whole: bool,
    hull: Bounds<D>,
    free: Bounds<D>,
    /// The squares of the largest displacement of a vertex relative to the body in the previous step, and of [`BodyReach::strayed`] [m²].
    squares: [f64; 2],
    most: [f64; 2],
}

/// The step of [`Reach::begin`].
#[derive(Clone, Copy)]
pub(crate) struct FreeMotion<'a, const D: usize> {
    /// The positions of the points before and after the free motion [m].
    pub(crate) ends: [&'a [[f64; D]]; 2],
    /// The distance by which contact separates overlapping bodies [m].
    pub(crate) recovery: f64,
    /// How far points may move in addition to the given free motion, apart from contact [m].
    pub(crate) unknown: f64,
    /// Whether the previous call began the same step.
    pub(crate) is_repeated: bool,
}

/// A search finds all pairs within the boxes of its points. The boxes of the two features of a pair together extend at least this many margins beyond
/// the possible positions in every step that uses its pairs. In bodies at rest, and around vertices that seem to be deep inside a body, gaps are computed up to this distance beyond the
/// boxes of the step. If the distance in one of these places were larger than in the other, results would depend on when a search was made.
pub(crate) const SPARE: f64 = 0.25;

/// If the boxes of the last search extend this many times as far beyond the points as they would now, they are computed anew. Otherwise bodies that
/// come to rest after an impact would keep the candidates of their flight (`candidates_of_a_flight_are_dropped_at_rest`).
pub(crate) const MOST_WIDTHS: f64 = 4.0;

/// Vertices in a block. The number changes no result.
const BLOCK: usize = 4096;

/// Returns how far beyond the boxes of a step the search for candidates extends [m], for a point or body that moves by `moves` in the step. This
/// distance is what the point or body covers in `steps` more steps, but at least half a margin and at most a whole one. Without the upper limit, long
/// steps of fast bodies would make everything around them a candidate (ten times as many candidates for eight falling cubes).
pub(crate) fn beyond(moves: f64, steps: f64, margin: f64) -> f64 {
    (0.5 * margin).larger((steps * moves).smaller(margin))
}

/// An empty box.
pub(crate) const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl<const D: usize> BodyReach<D> {
    fn new() -> Self {
        BodyReach {
            hull: NOWHERE.map(|c| [c; D]),
            free: [0.0; D],
            moved: [0.0; D],
            most: [0.0; 2],
            spread: 0.0,
            approach: 0.0,
            origin: [0.0; D],
            path: 0.0,
            strayed: 0.0,
            region: NOWHERE.map(|c| [c; D]),
            found_path: 0.0,
            found_within: [f64::NEG_INFINITY, 0.0],
            is_stale: true,
            is_due: true,
        }
    }
}

impl<const D: usize> Block<D> {
    /// Measures the free motion and the previous step. Replaces the positions `x` at the start of the previous step by those at the start of this
    /// step [m].
    fn measure(&mut self, [from, to]: [&[[f64; D]]; 2], body: &BodyReach<D>, home: &[[f64; D]], x: &mut [[f64; D]]) {
        let ([mut hull, mut free], mut squares) = ([NOWHERE.map(|c| [c; D]); 2], [0.0; 2]);
        let own = self.vertices.clone();
        for (((from, to), home), x) in from[own.clone()].iter().zip(&to[own.clone()]).zip(&home[own]).zip(x) {
            let relative = subtract(&subtract(from, x), &body.moved);
            let strayed = subtract(&subtract(from, &body.origin), home);
            squares = [dot(&relative, &relative).larger(squares[0]), dot(&strayed, &strayed).larger(squares[1])];
            for d in 0..D {
                let displacement = to[d] - from[d];
                hull[0][d] = from[d].smaller(to[d]).smaller(hull[0][d]);
                hull[1][d] = from[d].larger(to[d]).larger(hull[1][d]);
                free[0][d] = displacement.smaller(free[0][d]);
                free[1][d] = displacement.larger(free[1][d]);
            }
            *x = *from;
        }
        (self.hull, self.free, self.squares) = (hull, free, squares);
    }

    /// Computes the displacements of points, given the free displacement of their body [m].
    fn set_moves(&mut self, motion: &FreeMotion<'_, D>, of_body: &[f64; D], moves: &mut [[f64; 2]]) {
        let [from, to] = motion.ends;
        let own = self.vertices.clone();
        let mut most = [0.0; 2];
        for ((from, to), moves) in from[own.clone()].iter().zip(&to[own]).zip(moves) {
            let displacement = subtract(to, from);
            *moves = [length(&displacement), length(&subtract(&displacement, of_body))];
            most = [moves[0].larger(most[0]), moves[1].larger(most[1])];
        }
        self.most = most;
    }
}

/// The largest moves of the blocks of a body [m].
fn most_of<const D: usize>(blocks: &[Block<D>]) -> [f64; 2] {
    [0, 1].map(|k| blocks.iter().fold(0.0, |most: f64, block| block.most[k].larger(most)))
}

/// The middle of a box.
fn middle<const D: usize>([low, high]: &Bounds<D>) -> [f64; D] {
    scaled(&add(low, high), 0.5)
}

impl<const D: usize> Reach<D> {
    /// Discards everything if the surface has changed; returns whether it has.
    pub(crate) fn fit(&mut self, surface: &Surface<D>, x: &[[f64; D]]) -> bool {
        if self.x.len() == x.len() {
            return false;
        }
        self.x = x.to_vec();
        self.home = x.to_vec();
        self.moves = vec![[0.0; 2]; x.len()];
        self.grown.clear();
        self.has_grown = vec![false; x.len()];
        self.swept = vec![NOWHERE.map(|c| [c; D]); x.len()];
        self.found_in = vec![NOWHERE.map(|c| [c; D]); x.len()];
        self.bodies = vec![BodyReach::new(); surface.bodies()];
        self.blocks.clear();
        for body in 0..surface.bodies() {
            let all = surface.feature_points_of(body);
            for first in all.clone().step_by(BLOCK) {
                let vertices = first..all.end.min(first + BLOCK);
                let nowhere = NOWHERE.map(|c| [c; D]);
                let (is_whole, most) = (vertices == all, [0.0; 2]);
                let ([hull, free], squares) = ([nowhere; 2], [0.0; 2]);
                self.blocks.push(Block { body: body as u32, vertices, is_whole, hull, free, squares, most });
            }
        }
        true
    }

    /// Begins a step. The method assumes that contact pushes a point at most as far as it moves in the free motion. It also assumes that contact
    /// pushes the point at most as far as it moves relative to its body, plus as far as the neighbours move relative to the body
    /// ([`BodyReach::approach`]). In both cases contact may also separate overlapping bodies. [`Reach::grow`] takes account of a point that contact
    /// pushes farther.
    pub(crate) fn begin(&mut self, motion: FreeMotion<'_, D>, threads: usize) {
        let mut bodies = std::mem::take(&mut self.bodies);
        for body in &mut bodies {
            body.moved = if motion.is_repeated { [0.0; D] } else { body.free };
            body.origin = add(&body.origin, &body.moved);
        }
        let home = std::mem::take(&mut self.home);
        let mut x = std::mem::take(&mut self.x);
        self.each_block(&mut x, threads, |block, x, moves| {
            block.measure(motion.ends, &bodies[block.body as usize], &home, x);
            if block.is_whole {
                block.set_moves(&motion, &middle(&block.free), moves);
            }
        });
        let mut large = false;
        for blocks in self.blocks.chunk_by(|a, b| a.body == b.body) {
            let body = &mut bodies[blocks[0].body as usize];
            let joint = |of: fn(&Block<D>) -> Bounds<D>| blocks[1..].iter().map(of).fold(of(&blocks[0]), joined);
            (body.hull, body.free) = (joint(|block| block.hull), middle(&joint(|block| block.free)));
            body.approach = 0.0;
            let largest = |k: usize| blocks.iter().fold(0.0, |most: f64, block| block.squares[k].larger(most)).sqrt();
            (body.path, body.strayed) = (body.path + largest(0), largest(1));
            large |= blocks.len() > 1;
        }
        if large {
            self.each_block(&mut x, threads, |block, _, moves| {
                if !block.is_whole {
                    block.set_moves(&motion, &bodies[block.body as usize].free, moves);
                }
            });
        }
        for blocks in self.blocks.chunk_by(|a, b| a.body == b.body) {
            let body = &mut bodies[blocks[0].body as usize];
            let [free, relative] = most_of(blocks);
            (body.spread, body.most) = (relative, [motion.recovery + free, motion.recovery + free + relative]);
        }
        (self.bodies, self.x, self.home) = (bodies, x, home);
    }

    /// Computes the possible positions of the points in the step. The approaches of the bodies must be known.
    pub(crate) fn sweep(&mut self, motion: FreeMotion<'_, D>, threads: usize) {
        let FreeMotion { ends: [from, to], recovery, unknown, .. } = motion;
        let mut swept = std::mem::take(&mut self.swept);
        let bodies = std::mem::take(&mut self.bodies);
        self.each_block(&mut swept, threads, |block, swept, moves| {
            let BodyReach { free: of_body, approach, .. } = &bodies[block.body as usize];
            let own = block.vertices.clone();
            let mut most = [0.0; 2];
            let own = from[own.clone()].iter().zip(&to[own]).zip(swept).zip(moves);
            for (((from, to), swept), moves) in own {
                let [free, relative] = *moves;
                let push = recovery + (relative + approach).smaller(free);
                *moves = [push, push + relative + unknown];
                most = [moves[0].larger(most[0]), moves[1].larger(most[1])];
                for d in 0..D {
                    let relative = to[d] - from[d] - of_body[d];
                    swept[0][d] = from[d] + relative.smaller(0.0) - push;
                    swept[1][d] = from[d] + relative.larger(0.0) + push;
                }
            }
            block.most = most;
        });
        (self.swept, self.bodies) = (swept, bodies);
        for blocks in self.blocks.chunk_by(|a, b| a.body == b.body) {
            self.bodies[blocks[0].body as usize].most = most_of(blocks);
        }
    }

    /// Does some work on every block, its entries of a list, and its displacements.
    fn each_block<T: Send>(
        &mut self,
        list: &mut [T],
        threads: usize,
        work: impl Fn(&mut Block<D>, &mut [T], &mut [[f64; 2]]) + Sync + Send,
    ) {
        let (mut x, mut moves, mut first) = (list, &mut self.moves[..], 0);
        let least = (self.blocks.len() * least_parts::POINTS).div_ceil(x.len().max(1));
        let size = threads::part_size(self.blocks.len(), threads, least);
        let parts = self.blocks.chunks_mut(size).filter_map(|blocks| {
            let (start, end) = (first, blocks.last()?.vertices.end);
            first = end;
            Some((blocks, start, x.split_off_mut(..end - start)?, moves.split_off_mut(..end - start)?))
        });
        threads::each_in_pool(parts, |(blocks, start, x, moves)| {
            for block in blocks {
                let own = block.vertices.start - start..block.vertices.end - start;
                work(block, &mut x[own.clone()], &mut moves[own]);
            }
        });
    }

    /// Determines the bodies whose candidates must be searched for anew, with a margin [m].
    pub(crate) fn find_stale(&mut self, surface: &Surface<D>, (margin, steps): (f64, f64)) {
        // The boxes of both features of a pair extend beyond the possible positions.
        let spare = 0.5 * SPARE * margin;
        for number in 0..self.bodies.len() {
            let body = self.bodies[number];
            let [push, moves] = body.most;
            let [shortest, longest] = body.found_within;
            let width = beyond(body.spread, steps, margin);
            let left = shortest - (body.path - body.found_path) - moves - spare;
            let too_wide = longest > MOST_WIDTHS * (push + width);
            let (mut is_stale, mut is_due) = (too_wide, left < body.spread);
            // NaN is never covered.
            if !(left >= 0.0 || too_wide) {
                let mut least = f64::INFINITY;
                for p in surface.feature_points_of(number) {
                    let (own, found) = (&self.swept[p], &self.found_in[p]);
                    for d in 0..D {
                        let origin = body.origin[d];
                        let [below, above] = [own[0][d] - origin - found[0][d], found[1][d] - (own[1][d] - origin)];
                        least = below.smaller(above).smaller(least);
                    }
                }
                let (is_covered, stays_covered) = (least >= spare, least >= spare + body.spread);
                (is_stale, is_due) = (!is_covered, !stays_covered);
            }
            (self.bodies[number].is_stale, self.bodies[number].is_due) = (is_stale, is_due);
        }
    }

    /// Sets the boxes in which the next search looks for candidates of stale bodies, and of those that soon will be. These are the possible positions
    /// in the step, extended by the motion of the points in `steps` more steps (see [`beyond`]), limited by `margin` [m].
    pub(crate) fn widen(&mut self, surface: &Surface<D>, (margin, steps): (f64, f64)) {
        for number in 0..self.bodies.len() {
            if !self.bodies[number].is_stale && !self.bodies[number].is_due {
                continue;
            }
            let (mut region, mut within) = (NOWHERE.map(|c| [c; D]), NOWHERE);
            for p in surface.feature_points_of(number) {
                let [push, _] = self.moves[p];
                let more = beyond(self.bodies[number].spread, steps, margin);
                let mut found = self.swept[p];
                for d in 0..D {
                    found[0][d] -= more + self.bodies[number].origin[d];
                    found[1][d] += more - self.bodies[number].origin[d];
                }
                self.found_in[p] = found;
                region = joined(region, found);
                within = [(push + more).smaller(within[0]), (push + more).larger(within[1])];
            }
            let body = &mut self.bodies[number];
            (body.region, body.found_within, body.found_path) = (region, within, body.path);
            (body.is_stale, body.is_due) = (true, false);
        }
    }

    /// Makes the present positions of a body those of a search for pairs of the body with itself.
    pub(crate) fn come_home(&mut self, surface: &Surface<D>, number: usize) {
        let body = &mut self.bodies[number];
        body.strayed = 0.0;
        for p in surface.feature_points_of(number) {
            self.home[p] = subtract(&self.x[p], &body.origin);
        }
    }

    /// Discards the candidates of all bodies.
    pub(crate) fn forget(&mut self) {
        self.found_in.fill(NOWHERE.map(|c| [c; D]));
        self.bodies.iter_mut().for_each(|body| body.found_within = [f64::NEG_INFINITY, 0.0]);
        self.look_at_all();
    }

    /// Makes the next search cover all bodies.
    pub(crate) fn look_at_all(&mut self) {
        self.bodies.iter_mut().for_each(|body| body.is_stale = true);
    }

    /// Restarts all paths at zero.
    pub(crate) fn restart_paths(&mut self) {
        for body in &mut self.bodies {
            body.found_path -= body.path;
            body.path = 0.0;
        }
    }

    /// Extends the displacements of touched vertices that contact pushes farther, given their positions after the free motion and at the end of the
    /// step [m]; returns whether there are any.
    pub(crate) fn grow(&mut self, surface: &Surface<D>, touched: &[bool], [free, end]: [&[[f64; D]]; 2]) -> bool {
        self.grown.drain(..).for_each(|(p, _)| self.has_grown[p as usize] = false);
        for (number, body) in self.bodies.iter_mut().enumerate() {
            for p in surface.feature_points_of(number).filter(|p| touched[*p]) {
                let displacement = subtract(&end[p], &free[p]);
                let pushed = dot(&displacement, &displacement).sqrt();
                let moves = &mut self.moves[p];
                if pushed > moves[0] {
                    let more = pushed - moves[0];
                    self.grown.push((p as u32, more));
                    self.has_grown[p] = true;
                    *moves = [pushed, moves[1] + more];
                    self.swept[p] = wider(self.swept[p], more);
                    body.most = [moves[0].larger(body.most[0]), moves[1].larger(body.most[1])];
                }
            }
        }
        !self.grown.is_empty()
    }

    /// The displacement that contact may add to the free motion of a point [m].
    #[inline]
    pub(crate) fn push_of(&self, point: u32) -> f64 {
        self.moves[point as usize][0]
    }

    /// The distance between the boxes of two features within the step, along the axis where it is largest [m]; negative if they
    /// overlap.
    #[inline]
    pub(crate) fn apart<const M: usize, const N: usize>(
        &self,
        [a, b]: [u32; 2],
        of_a: &[u32; M],
        of_b: &[u32; N],
    ) -> f64 {
        let of = |p: u32| self.swept[p as usize];
        self.between([(around(of, of_a), a), (around(of, of_b), b)])
    }

    /// The distance between two boxes within the step, along the axis where it is largest, if each moves with its body [m].
    #[inline]
    pub(crate) fn between(&self, [(a, body_a), (b, body_b)]: [(Bounds<D>, u32); 2]) -> f64 {
        let [free_a, free_b] = [body_a, body_b].map(|body| &self.bodies[body as usize].free);
        let mut own = a;
        for d in 0..D {
            let relative = free_a[d] - free_b[d];
            own[0][d] += relative.smaller(0.0);
            own[1][d] += relative.larger(0.0);
        }
        apart(&own, &b)
    }

    /// The largest displacement of the points of one feature relative to its body, plus that of another feature relative to its body [m].
    #[inline]
    pub(crate) fn moves_of<const M: usize, const N: usize>(&self, a: &[u32; M], b: &[u32; N]) -> f64 {
        let of = |p: u32| self.moves[p as usize][1];
        let [mut most_a, mut most_b] = [of(a[0]), of(b[0])];
        a[1..].iter().for_each(|p| most_a = of(*p).larger(most_a));
        b[1..].iter().for_each(|p| most_b = of(*p).larger(most_b));
        most_a + most_b
    }

    /// The distance that two bodies move relative to one another in the free motion [m].
    #[inline]
    pub(crate) fn apart_in_step(&self, [a, b]: [u32; 2]) -> f64 {
        length(&subtract(&self.bodies[a as usize].free, &self.bodies[b as usize].free))
    }

    /// Whether the last call of [`Reach::grow`] extended the displacement of a point.
    pub(crate) fn has_grown(&self, point: u32) -> bool {
        self.has_grown[point as usize]
    }

    /// The points whose displacements the last call of [`Reach::grow`] extended, ascending.
    pub(crate) fn grown(&self) -> impl Iterator<Item = u32> + '_ {
        self.grown.iter().map(|(point, _)| *point)
    }

    /// Whether two features at a given distance may come closer than another distance within the step [m]. If `before` is set, the displacements are
    /// those before the last call of [`Reach::grow`].
    pub(crate) fn may_meet(&self, distance: f64, other: f64, features: [(&[u32], u32); 2], before: bool) -> bool {
        let extension = |p: &u32| match self.grown.binary_search_by_key(p, |(grown, _)| *grown) {
            Ok(k) if before => self.grown[k].1,
            _ => 0.0,
        };
        let of_feature = |(points, body): (&[u32], u32)| {
            let (mut whole, mut most) = (NOWHERE.map(|c| [c; D]), 0.0);
            for p in points {
                let extension = extension(p);
                whole = joined(whole, wider(self.swept[*p as usize], -extension));
                most = (self.moves[*p as usize][1] - extension).larger(most);
            }
            ((whole, body), most)
        };
        let [(a, most_a), (b, most_b)] = features.map(of_feature);
        distance <= other + most_a + most_b + self.apart_in_step([a.1, b.1]) && self.between([a, b]) <= other
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        16 * self.moves.capacity()
            + 48 * D * self.x.capacity()
            + size_of::<BodyReach<D>>() * self.bodies.capacity()
            + size_of::<Block<D>>() * self.blocks.capacity()
            + self.has_grown.capacity()
            + 16 * self.grown.capacity()
    }
}

/// The box around two boxes.
#[inline]
pub(crate) fn joined<const D: usize>(mut a: Bounds<D>, [low, high]: Bounds<D>) -> Bounds<D> {
    for d in 0..D {
        a[0][d] = low[d].smaller(a[0][d]);
        a[1][d] = high[d].larger(a[1][d]);
    }
    a
}

/// The box around the boxes of some points.
#[inline]
pub(crate) fn around<const D: usize, const N: usize>(of: impl Fn(u32) -> Bounds<D>, points: &[u32; N]) -> Bounds<D> {
    points[1..].iter().fold(of(points[0]), |whole, p| joined(whole, of(*p)))
}
