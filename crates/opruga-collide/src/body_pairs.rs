//! Pairs of bodies that are close to one another, and the pairs of their features that may meet.

use crate::close_bodies::CloseBodies;
use crate::comparison::{Compared, Comparison, Comparisons, key};
use crate::least_parts;
use crate::lists;
use crate::reach::{BodyReach, MOST_WIDTHS, Reach, SPARE, beyond};
use crate::surface::Surface;
use crate::vector::{Bounds, apart, length, subtract, wider};
use core::ops::Range;
use core::sync::atomic::AtomicUsize;
use opruga_core::threads;
use opruga_math::{Lane, Pack, Simd, WIDTH};

/// The pairs of features that may meet, pair of bodies by pair of bodies, and lower bounds on their distances. Because of these bounds, most pairs of
/// features need not be examined in a step.
///
/// ```text
/// d(t) ≥ d(t₀) − (s_a(t) − s_a(t₀)) − (s_b(t) − s_b(t₀)) − (s_ab(t) − s_ab(t₀))
/// ```
///
/// s_a is the path of the points of a body relative to the body: the largest relative displacement, summed over the steps. s_ab is the path of the
/// bodies relative to one another. Bodies that move together, or rotate little, therefore keep their bounds.
///
/// Both features may belong to one body. Then the positions at the last search for such pairs replace those at t₀, and the distances from these
/// positions replace the paths, because vibrations have long paths but return.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodyPairs<const D: usize> {
    /// The pairs of bodies, ascending.
    pub(crate) all: Vec<BodyPair<D>>,
    /// The pairs of a vertex and a facet, and of two edges, and the bound on the distance of each pair plus the path of its bodies at the time of the
    /// bound [m].
    pub(crate) features: [Vec<[u32; 2]>; 2],
    until: [Vec<f64>; 2],
    /// The vector instructions and the threads that may compare features. The pairs that a search finds do not depend on them.
    pub(crate) simd: Simd,
    /// For every body, the box within which all its neighbours are among the pairs of bodies [m].
    wide: Vec<Bounds<D>>,
    close_bodies: CloseBodies<D>,
    /// The pairs of bodies before the present search for neighbours, and the pairs of features of two bodies before the present search for features,
    /// with their bounds.
    before: Vec<BodyPair<D>>,
    known: Vec<([u32; 2], f64)>,
    /// The pairs of bodies whose features the present search compares.
    fresh: Vec<u32>,
    compared: Vec<Compared<D>>,
    regions: Vec<Bounds<D>>,
    parts: Vec<Comparison<D>>,
}

/// Two bodies, or a body and itself.
#[derive(Clone, Debug)]
pub(crate) struct BodyPair<const D: usize> {
    /// The bodies; the first number is not larger than the second.
    pub(crate) bodies: [u32; 2],
    /// The largest distance that surfaces of these kinds keep in contact [m].
    pub(crate) thickest: f64,
    /// Whether features of the bodies may meet in this step.
    pub(crate) is_active: bool,
    /// The value below which a bound does not exclude a contact in this step [m].
    limit: f64,
    /// The path of the bodies relative to one another, and the displacement in the free motion of this step [m].
    path: f64,
    pub(crate) relative: f64,
    /// Whether the lists hold the pairs of features of a search. Also the displacement of the bodies relative to one another at the time of that
    /// search. For two bodies, `slack` is the change of this displacement that the search covered, apart from the motion of points relative to their
    /// bodies. For a body and itself, it is the relative motion of two points that the search covered [m].
    is_known: bool,
    offset: [f64; D],
    slack: f64,
    /// Where the lists hold its pairs of features, and the smallest bound of each range when it was last examined [m].
    ranges: [[u32; 2]; 2],
    least: [f64; 2],
}

/// A pair of bodies, a list of candidates, and a range in this list.
pub(crate) type Piece = (u32, usize, Range<usize>);

/// The distances of a search for features [m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Distances {
    /// The margin of the search, and the number of later steps that it covers.
    pub(crate) margin: (f64, f64),
    /// The largest distance that surfaces keep in contact: between bodies, and with obstacles.
    pub(crate) thickest: [f64; 2],
}

/// Paths that are longer than this many margins restart at zero. Up to this length, additions to them are rounded to 1e-12 of a
/// margin.
const LONG: f64 = 1e4;

/// Stored distances are reduced by this fraction to allow for rounding.
const ROUNDING: f64 = 1e-9;

impl<const D: usize> BodyPair<D> {
    fn new(bodies: [u32; 2]) -> Self {
        BodyPair {
            bodies,
            thickest: 0.0,
            is_active: false,
            limit: 0.0,
            path: 0.0,
            relative: 0.0,
            is_known: false,
            offset: [0.0; D],
            slack: 0.0,
            ranges: [[0; 2]; 2],
            least: [f64::NEG_INFINITY; 2],
        }
    }

    /// Where a list holds its pairs of features.
    pub(crate) fn range(&self, list: usize) -> Range<usize> {
        let [start, end] = self.ranges[list];
        start as usize..end as usize
    }

    fn of<'a>(&self, bodies: &'a [BodyReach<D>]) -> [&'a BodyReach<D>; 2] {
        self.bodies.map(|body| &bodies[body as usize])
    }

    /// The sum of all paths. For a body and itself, twice the distance by which its points have strayed since the last search for such pairs [m].
    fn whole_path(&self, bodies: &[BodyReach<D>]) -> f64 {
        let [a, b] = self.of(bodies);
        if self.is_of_one_body() { 2.0 * a.strayed } else { self.path + a.path + b.path }
    }

    fn is_of_one_body(&self) -> bool {
        self.bodies[0] == self.bodies[1]
    }

    /// The distance that the slack of the last search still leaves after this step [m]; −∞ without a search.
    fn left(&self, bodies: &[BodyReach<D>], margin: f64) -> f64 {
        let [a, b] = self.of(bodies);
        if !self.is_known {
            return f64::NEG_INFINITY;
        }
        if self.is_of_one_body() {
            return self.slack - 2.0 * (a.strayed + a.most[1]) - SPARE * margin;
        }
        let mut least = f64::INFINITY;
        for d in 0..D {
            let (offset, free) = (a.origin[d] - b.origin[d], a.free[d] - b.free[d]);
            least = (self.slack - (offset - self.offset[d]).abs() - free.abs()).smaller(least);
        }
        least
    }

    /// The relative motion of bodies or points that a search covers now [m].
    fn slack_now(&self, bodies: &[BodyReach<D>], (margin, steps): (f64, f64)) -> f64 {
        if self.is_of_one_body() {
            let body = &bodies[self.bodies[0] as usize];
            return 2.0 * body.most[1] + SPARE * margin + beyond(2.0 * body.spread, steps, margin);
        }
        self.relative + 0.5 * beyond(self.relative, steps, margin)
    }

    /// Whether a new search must find its pairs of features.
    fn is_stale(&self, bodies: &[BodyReach<D>], margin: (f64, f64)) -> bool {
        // Without the last condition, bodies that come to rest after an impact would keep the candidates of their flight.
        !self.is_of_one_body() && self.of(bodies).iter().any(|body| body.is_stale)
            || self.left(bodies, margin.0) < 0.0
            || self.slack > MOST_WIDTHS * self.slack_now(bodies, margin)
    }
}

impl<const D: usize> BodyPairs<D> {
    /// Discards everything.
    pub(crate) fn clear(&mut self) {
        self.all.clear();
        self.wide.clear();
    }

    /// Makes the next search find all pairs of features.
    pub(crate) fn forget_features(&mut self) {
        self.all.iter_mut().for_each(|pair| pair.is_known = false);
    }

    /// The number of pairs of features.
    pub(crate) fn len(&self) -> usize {
        self.features.iter().map(Vec::len).sum()
    }

    /// The index of two bodies; `None` if they are not close to one another.
    pub(crate) fn index_of(&self, [a, b]: [u32; 2]) -> Option<usize> {
        let bodies = if a < b { [a, b] } else { [b, a] };
        self.all.binary_search_by_key(&bodies, |pair| pair.bodies).ok()
    }

    /// Adds the previous step to the paths.
    pub(crate) fn follow(&mut self, reach: &mut Reach<D>, margin: f64) {
        for pair in &mut self.all {
            let [a, b] = pair.of(&reach.bodies);
            pair.path += length(&subtract(&a.moved, &b.moved));
            pair.relative = length(&subtract(&a.free, &b.free));
        }
        let most = LONG * margin;
        if self.all.iter().any(|pair| pair.path > most) || reach.bodies.iter().any(|body| body.path > most) {
            self.all.iter_mut().for_each(|pair| (pair.path, pair.least) = (0.0, [f64::NEG_INFINITY; 2]));
            self.until.iter_mut().for_each(|until| until.fill(f64::NEG_INFINITY));
            reach.restart_paths();
        }
    }

    /// Includes all neighbours among the pairs of bodies: those that may touch according to `meet`, and come close to one another in this step.
    pub(crate) fn include_neighbours(
        &mut self,
        surface: &Surface<D>,
        reach: &Reach<D>,
        distances: Distances,
        meet: impl Fn(u32, u32) -> bool,
    ) {
        let Distances { margin: (margin, steps), thickest } = distances;
        let swept = |body: usize| wider(reach.bodies[body].hull, reach.bodies[body].most[0]);
        let within = |body: usize| {
            let (own, wide) = (swept(body), &self.wide[body]);
            (0..D).all(|d| !(own[0][d] < wide[0][d] || own[1][d] > wide[1][d]))
        };
        if self.wide.len() == reach.bodies.len() && (0..self.wide.len()).all(within) {
            return;
        }
        self.wide.clear();
        self.wide.extend((0..reach.bodies.len()).map(|body| {
            let covered = steps * (length(&reach.bodies[body].free) + reach.bodies[body].most[1]);
            wider(swept(body), covered.larger(margin))
        }));
        // In bodies at rest, and around points deep inside a body, gaps are computed beyond the boxes of a step.
        self.close_bodies.find(surface, &self.wide, thickest.map(|distance| distance + SPARE * margin), meet);
        std::mem::swap(&mut self.all, &mut self.before);
        self.all.clear();
        lists::reserve(&mut self.all, self.close_bodies.pairs.len());
        let mut known = self.before.iter().peekable();
        for bodies in &self.close_bodies.pairs {
            while known.next_if(|pair| pair.bodies < *bodies).is_some() {}
            let mut pair = known.next_if(|pair| pair.bodies == *bodies).cloned().unwrap_or(BodyPair::new(*bodies));
            pair.thickest = thickest[usize::from(bodies.iter().any(|body| surface.is_obstacle(*body)))];
            let [a, b] = pair.of(&reach.bodies);
            pair.relative = length(&subtract(&a.free, &b.free));
            self.all.push(pair);
        }
    }

    /// Computes, for every body, the largest displacement of a neighbour relative to the body ([`BodyReach::approach`]).
    pub(crate) fn find_approaches(&self, reach: &mut Reach<D>) {
        for pair in self.all.iter().filter(|pair| pair.bodies[0] != pair.bodies[1]) {
            let [a, b] = pair.bodies.map(|body| body as usize);
            let [own, other] = [reach.bodies[a], reach.bodies[b]];
            if apart(&own.hull, &other.hull) > pair.thickest {
                continue;
            }
            reach.bodies[a].approach = pair.relative.larger(own.approach);
            reach.bodies[b].approach = pair.relative.larger(other.approach);
        }
    }

    /// Determines the pairs of bodies whose features may meet in this step.
    pub(crate) fn activate(&mut self, reach: &Reach<D>, margin: f64) {
        for pair in &mut self.all {
            let [a, b] = pair.bodies.map(|body| body as usize);
            let [a, b] = [a, b].map(|body| wider(reach.bodies[body].hull, reach.bodies[body].most[0]));
            let is_apart = apart(&a, &b) > pair.thickest + SPARE * margin;
            pair.is_active = !is_apart;
        }
    }

    /// Whether the lists hold all pairs of features that may meet in this step.
    pub(crate) fn are_complete(&self, reach: &Reach<D>, margin: (f64, f64)) -> bool {
        !self.all.iter().any(|pair| pair.is_active && pair.is_stale(&reach.bodies, margin))
    }

    /// Searches for the pairs of features that the lists lack, or soon will. Ends and returns false if there are more than `most` pairs.
    pub(crate) fn search(
        &mut self,
        surface: &Surface<D>,
        reach: &mut Reach<D>,
        threads: usize,
        distances: Distances,
        most: usize,
    ) -> bool {
        let (margin, _) = distances.margin;
        reach.widen(surface, distances.margin);
        self.fresh.clear();
        self.compared.clear();
        let mut kept = 0;
        for (k, pair) in self.all.iter_mut().enumerate() {
            let [a, b] = pair.bodies.map(|body| &reach.bodies[body as usize]);
            let one_step = if pair.is_of_one_body() { 2.0 * a.spread } else { pair.relative };
            let is_due = pair.left(&reach.bodies, margin) < one_step;
            if !pair.is_active {
                pair.is_known &= !a.is_stale && !b.is_stale;
            } else if pair.is_stale(&reach.bodies, distances.margin) || is_due {
                pair.offset = subtract(&a.origin, &b.origin);
                pair.slack = pair.slack_now(&reach.bodies, distances.margin);
                pair.is_known = true;
                let (bodies, distance) = (pair.bodies, pair.thickest + pair.slack);
                self.compared.push(Compared { bodies, shift: pair.offset, distance });
                self.fresh.push(k as u32);
                if pair.is_of_one_body() {
                    reach.come_home(surface, pair.bodies[0] as usize);
                }
                continue;
            }
            if pair.is_known {
                kept += pair.range(0).len() + pair.range(1).len();
            }
        }
        reach.bodies.iter_mut().for_each(|body| body.is_stale = false);
        self.regions.clear();
        self.regions.extend(reach.bodies.iter().map(|body| body.region));
        let parts = threads::parts(self.compared.len(), threads, least_parts::PAIRS_OF_BODIES);
        self.parts.resize_with(parts.len(), Comparison::default);
        parts.zip(&mut self.parts).for_each(|(range, part)| part.range = range);
        let counted = AtomicUsize::new(kept);
        let (boxes, own, simd) = (&reach.found_in[..], &reach.swept[..], self.simd);
        let (bodies, pairs) = (&self.regions[..], &self.compared[..]);
        let comparisons = Comparisons { surface, boxes, own, bodies, pairs, simd, most, counted: &counted };
        threads::each_in_pool(self.parts.iter_mut(), |part| comparisons.compare(part));
        if counted.into_inner() > most {
            return false;
        }
        (0..2).for_each(|list| self.replace(list));
        true
    }

    /// Puts the pairs of features that the present search has found into a list, and keeps the bounds of known pairs. The list is rewritten in place,
    /// from its start. Its old content first moves towards the end, far enough that every part is read before it is overwritten.
    fn replace(&mut self, list: usize) {
        let BodyPairs { all, fresh, parts, known, features, until, .. } = self;
        let (features, until) = (&mut features[list], &mut until[list]);
        let of_part = |part: &Comparison<D>, k: usize| match k {
            0 => 0..part.ends[0][list],
            _ => part.ends[k - 1][list]..part.ends[k][list],
        };
        let found =
            parts.iter().flat_map(|part| (0..part.ends.len()).map(move |k| &part.pairs[list][of_part(part, k)]));

        let (mut end, mut end_before, mut offset) = (0, 0, 0);
        let (mut next_found, mut next_fresh) = (found.clone(), fresh.iter().peekable());
        for (k, pair) in all.iter().enumerate() {
            let own = pair.range(list);
            if next_fresh.next_if(|fresh| **fresh as usize == k).is_some() {
                end += next_found.next().map_or(0, <[_]>::len);
            } else if pair.is_known {
                end += own.len();
            }
            if !own.is_empty() {
                end_before = own.end;
            }
            offset = offset.max(end.saturating_sub(end_before));
        }
        let length = features.len();
        lists::resize(features, length + offset, [0; 2]);
        lists::resize(until, length + offset, 0.0);
        features.copy_within(..length, offset);
        until.copy_within(..length, offset);

        let (mut next_found, mut next_fresh) = (found, fresh.iter().peekable());
        let mut end = 0;
        for (k, pair) in all.iter_mut().enumerate() {
            let (start, own) = (end, pair.range(list));
            let before = own.start + offset..own.end + offset;
            if next_fresh.next_if(|fresh| **fresh as usize == k).is_some() {
                // Bounds of a body and itself apply to the positions of the last search.
                let before = if pair.is_of_one_body() { 0..0 } else { before };
                known.clear();
                known.extend(features[before.clone()].iter().copied().zip(until[before].iter().copied()));
                let mut known = known.iter().peekable();
                for pair in next_found.next().unwrap_or_default() {
                    while known.next_if(|(one, _)| key(one) < key(pair)).is_some() {}
                    let same = known.next_if(|(one, _)| one == pair);
                    (features[end], until[end]) = (*pair, same.map_or(f64::NEG_INFINITY, |(_, until)| *until));
                    end += 1;
                }
                pair.least[list] = f64::NEG_INFINITY;
            } else if pair.is_known {
                end += own.len();
                if before.start != start {
                    features.copy_within(before.clone(), start);
                    until.copy_within(before, start);
                }
            }
            pair.ranges[list] = [start as u32, end as u32];
        }
        features.truncate(end);
        until.truncate(end);
    }

    /// Sets the limits of the bounds for this step.
    pub(crate) fn set_limits(&mut self, reach: &Reach<D>) {
        for pair in &mut self.all {
            let [a, b] = pair.bodies.map(|body| reach.bodies[body as usize].most[1]);
            let approach = a + b + pair.relative;
            pair.limit = pair.whole_path(&reach.bodies) + approach + pair.thickest;
        }
    }

    /// Calls `visit` with the indices of those pairs of features of two bodies, in a part of a list, that may come closer than a distance beyond any contact
    /// in this step [m], according to their bounds. Returns the smallest bound in this part [m].
    #[inline(always)]
    pub(crate) fn visit_unclear<P: Pack>(
        &self,
        (pair, list, part): (usize, usize, Range<usize>),
        beyond: f64,
        mut visit: impl FnMut(usize),
    ) -> f64 {
        let (limit, least) = (self.all[pair].limit + beyond, self.all[pair].least[list]);
        if least > limit {
            return least;
        }
        let until = &self.until[list];
        let (mut first, limits, mut least) = (part.start, P::splat(limit), P::splat(f64::INFINITY));
        while first + WIDTH <= part.end {
            let bounds = P::load(&until[first..]);
            least = bounds.smaller(least);
            if P::any(bounds.less_or_equal(limits)) {
                (first..first + WIDTH).filter(|k| until[*k] <= limit).for_each(&mut visit);
            }
            first += WIDTH;
        }
        let mut least = least.to_array().into_iter().fold(f64::INFINITY, f64::smaller);
        for k in first..part.end {
            least = until[k].smaller(least);
            if until[k] <= limit {
                visit(k);
            }
        }
        least
    }

    /// Records the smallest bound of a whole range that was examined [m].
    pub(crate) fn set_least(&mut self, pair: usize, list: usize, least: f64) {
        self.all[pair].least[list] = least;
    }

    /// Whether features of two bodies stay farther apart within the step than any contact of these bodies, by more than a distance [m], whatever contact
    /// does.
    #[inline(always)]
    pub(crate) fn is_clear(&self, pair: usize, list: usize, candidate: usize, distance: f64) -> bool {
        self.until[list][candidate] > self.all[pair].limit + distance
    }

    /// Records a lower bound on the distance of two features at the start of the step [m].
    #[inline]
    pub(crate) fn note(&mut self, reach: &Reach<D>, pair: usize, list: usize, candidate: usize, distance: f64) {
        let pair = &mut self.all[pair];
        let (path, distance) = (pair.whole_path(&reach.bodies), (1.0 - ROUNDING) * distance);
        let known = self.until[list][candidate];
        // Points can come back to the positions of the search, so a known bound may be better.
        let until = if pair.is_of_one_body() { (distance - path).larger(known) } else { distance + path };
        // A distance that is not a number excludes nothing.
        let until = if until.is_nan() { f64::NEG_INFINITY } else { until };
        pair.least[list] = until.smaller(pair.least[list]);
        self.until[list][candidate] = until;
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let lists = self.features.iter().map(Vec::capacity).sum::<usize>();
        let bounds = self.until.iter().map(Vec::capacity).sum::<usize>();
        8 * (lists + bounds)
            + 16 * self.known.capacity()
            + size_of::<BodyPair<D>>() * (self.all.capacity() + self.before.capacity())
            + 16 * D * (self.wide.capacity() + self.regions.capacity())
            + self.close_bodies.heap_bytes()
            + 4 * self.fresh.capacity()
            + size_of::<Compared<D>>() * self.compared.capacity()
            + self.parts.iter().map(Comparison::heap_bytes).sum::<usize>()
    }
}
