//! Lower bounds on the distances of candidates. Because of these bounds, most candidates need not be examined in a step.

use crate::candidates::Candidates;
use crate::known_pairs::KnownPairs;
use crate::reach::{MOST_WIDTHS, beyond};
use crate::surface::Surface;
use crate::vector::{add, length, scaled, subtract};
use opruga_math::Lane;

/// Known lower bounds on the distances of candidates.
///
/// ```text
/// d(t) ≥ d(t₀) − (s_a(t) − s_a(t₀)) − (s_b(t) − s_b(t₀))
/// ```
///
/// s is the path of the body that has the feature: the largest displacement of the points of this body, summed over the steps. Displacements are
/// relative to the mean displacement of all points. If both features belong to one body, displacements are relative to the mean displacement of the
/// points of this body. Bodies that fall together, or rotate little, therefore keep their bounds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Clearance<const D: usize> {
    /// The positions at the end of the paths [m].
    x: Vec<[f64; D]>,
    /// The motions of the bodies, and the mean displacement of all points in the previous step [m].
    motions: Vec<Motion<D>>,
    whole: Option<[f64; D]>,
    /// The paths of every body [m]: relative to all bodies, and to itself.
    paths: Vec<[f64; 2]>,
    /// For every body, the largest distance by which contact may push one of its points in this step [m].
    push: Vec<f64>,
    /// Upper bounds on both paths of every body at the end of this step [m], wherever contact pushes its points.
    ends: Vec<[f64; 2]>,
    /// For every body, its path at the last search for pairs of the body with itself, and the distance around its points that this search covered
    /// [m].
    own: Vec<[f64; 2]>,
    /// For every body, whether the present search includes its own pairs.
    due: Vec<bool>,
    /// Pairs of a vertex and a facet, and of two edges, in the order of the candidates.
    pairs: [KnownPairs; 2],
}

/// The motion of a body in a step. The fields are the sum of the displacements of its points, the number of these points, the mean displacement of
/// the previous step, the square of the largest displacement relative to that mean, and the largest relative displacement of the previous step [m].
#[derive(Clone, Copy, Debug)]
struct Motion<const D: usize> {
    sum: [f64; D],
    points: f64,
    mean: [f64; D],
    square: f64,
    largest: f64,
}

/// The sum of the paths of both bodies relative to all points. If both features belong to one body, the paths are relative to
/// that body.
#[inline(always)]
fn of_both(paths: &[[f64; 2]], [a, b]: &[u32; 2]) -> f64 {
    let own = usize::from(a == b);
    paths[*a as usize][own] + paths[*b as usize][own]
}

/// The entry of a body without a search for its own pairs so far.
const NEVER: [f64; 2] = [0.0, f64::NEG_INFINITY];

/// Paths that are longer than this many margins restart at zero. Up to this length, additions to them are rounded to 1e-12 of a
/// margin.
const LONG: f64 = 1e4;

/// Stored distances are reduced by this fraction to allow for rounding.
const ROUNDING: f64 = 1e-9;

impl<const D: usize> Clearance<D> {
    /// Advances to the positions at the start of a step [m].
    pub(crate) fn follow(&mut self, surface: &Surface<D>, x: &[[f64; D]]) {
        if self.x.len() != x.len() {
            self.x = x.to_vec();
            let bodies = surface.body.iter().map(|body| *body as usize + 1).max().unwrap_or(0);
            self.motions =
                vec![Motion { sum: [0.0; D], points: 0.0, mean: [0.0; D], square: 0.0, largest: 0.0 }; bodies];
            self.paths = vec![[0.0; 2]; bodies];
            self.push = vec![0.0; bodies];
            self.own = vec![NEVER; bodies];
            self.pairs.iter_mut().for_each(KnownPairs::forget);
            return;
        }
        // Displacements are measured relative to the means of the previous step. The choice of these means affects how tight
        // the bounds are, not whether they are valid.
        for ((from, to), body) in self.x.iter_mut().zip(x).zip(&surface.body) {
            let Motion { sum, points, mean, square, .. } = &mut self.motions[*body as usize];
            let mut own = 0.0;
            for d in 0..D {
                let displacement = to[d] - from[d];
                sum[d] += displacement;
                own += (displacement - mean[d]) * (displacement - mean[d]);
            }
            *points += 1.0;
            *square = own.larger(*square);
            *from = *to;
        }
        let whole = self.whole.unwrap_or([0.0; D]);
        let (mut sum, mut points) = ([0.0; D], 0.0);
        for ([among_all, own], motion) in self.paths.iter_mut().zip(&mut self.motions) {
            motion.largest = motion.square.sqrt();
            *own += motion.largest;
            *among_all += motion.largest + length(&subtract(&motion.mean, &whole));
            (sum, points) = (add(&sum, &motion.sum), points + motion.points);
            motion.mean = scaled(&motion.sum, 1.0 / motion.points.larger(1.0));
            (motion.sum, motion.points, motion.square) = ([0.0; D], 0.0, 0.0);
        }
        self.whole = Some(scaled(&sum, 1.0 / points.larger(1.0)));
    }

    /// Discards the pairs of bodies with themselves.
    pub(crate) fn forget_own(&mut self) {
        self.own.fill(NEVER);
    }

    /// Returns how far points of a body may move relative to their mean in this step, plus the additional distance at which
    /// pairs may be requested [m].
    fn wanted(&self, body: usize, margin: f64) -> f64 {
        2.0 * self.push[body] + 0.125 * margin
    }

    /// Whether all pairs that a body may have with itself in this step are known.
    pub(crate) fn covers(&self, body: usize, margin: f64) -> bool {
        let ([path, width], wanted) = (self.own[body], self.wanted(body, margin));
        // Without the second condition, a body that comes to rest after an impact would keep the pairs of its flight.
        self.paths[body][1] - path + wanted <= width && width <= MOST_WIDTHS * (wanted + 0.5 * margin)
    }

    /// Whether [`Self::covers`] holds for all bodies.
    pub(crate) fn covers_all(&self, margin: f64) -> bool {
        (0..self.own.len()).all(|body| self.covers(body, margin))
    }

    /// Sets the distance around the points of each body whose search is due; within this distance, the search finds the body's own pairs. This
    /// distance allows for the motion of the points relative to their mean in this step and, limited by `margin` [m], in `steps` more steps (see
    /// [`beyond`]).
    pub(crate) fn widen(&mut self, margin: f64, steps: f64) {
        self.due.clear();
        for body in 0..self.own.len() {
            // A body that has used half of its range will soon need a search. It is included now, so that one search serves
            // many bodies.
            let due = !self.covers(body, 3.0 * margin);
            self.due.push(due);
            if due {
                let more = beyond(self.motions[body].largest, steps, margin);
                self.own[body] = [self.paths[body][1], self.wanted(body, margin) + more];
            }
        }
    }

    /// Whether the present search includes the pairs of a body with itself.
    pub(crate) fn is_due(&self, body: u32) -> bool {
        self.due[body as usize]
    }

    /// The box around a point in which the search looks for pairs of the body with itself [m].
    pub(crate) fn own_box(&self, surface: &Surface<D>, point: u32) -> [[f64; D]; 2] {
        let width = self.own[surface.body[point as usize] as usize][1];
        [-width, width].map(|side| self.x[point as usize].map(|c| c + side))
    }

    /// Stores the pairs that a search has found. Both lists of the candidates are ascending. The bounds of known pairs are
    /// kept.
    pub(crate) fn take(&mut self, surface: &Surface<D>, candidates: &Candidates<D>, margin: f64) {
        let body = |point: u32| surface.body[point as usize];
        let of_facet = |[p, f]: [u32; 2]| [body(p), body(surface.facets[f as usize][0])];
        let of_edges = |pair: [u32; 2]| pair.map(|e| body(surface.edges[e as usize][0]));
        if self.paths.iter().flatten().any(|path| *path > LONG * margin) {
            self.own.iter_mut().zip(&self.paths).for_each(|([path, _], [_, own])| *path -= own);
            self.paths.fill([0.0; 2]);
            self.pairs.iter_mut().for_each(KnownPairs::forget);
        }
        self.pairs[0].take(&candidates.vertex_facet, of_facet);
        self.pairs[1].take(&candidates.edge_edge, of_edges);
    }

    /// Sets, for every body, the largest distance by which contact may push one of its points [m].
    pub(crate) fn set_push(&mut self, push: &[f64]) {
        self.push.copy_from_slice(push);
        self.ends.clear();
        self.ends.extend(self.paths.iter().zip(push).map(|(paths, push)| paths.map(|path| path + 2.0 * push)));
    }

    /// Sets the limits of the bounds for this step, given the largest distance that surfaces keep in contact [m]: between bodies, and with
    /// obstacles. All pairs without a body that `counts` are clear.
    pub(crate) fn set_limits(&mut self, surface: &Surface<D>, thickest: [f64; 2], counts: impl Fn(u32) -> bool) {
        let of_obstacle = |bodies: &[u32; 2]| bodies.iter().any(|body| surface.is_obstacle(*body));
        let ends = &self.ends;
        let limit = |bodies: &[u32; 2]| {
            if !bodies.iter().any(|body| counts(*body)) {
                return f64::NEG_INFINITY;
            }
            of_both(ends, bodies) + thickest[usize::from(of_obstacle(bodies))]
        };
        self.pairs.iter_mut().for_each(|pairs| pairs.set_limits(limit));
    }

    /// The bodies of a pair.
    pub(crate) fn bodies(&self, list: usize, pair: usize) -> [u32; 2] {
        self.pairs[list].bodies(pair)
    }

    /// Whether a pair stays farther apart within the step than any contact of its bodies, by more than a distance [m], whatever contact
    /// does.
    #[inline(always)]
    pub(crate) fn is_clear(&self, list: usize, pair: usize, distance: f64) -> bool {
        self.pairs[list].exceeds(pair, distance)
    }

    /// Records a lower bound on the distance of a pair at the start of the step [m].
    #[inline]
    pub(crate) fn note(&mut self, list: usize, pair: usize, distance: f64) {
        let paths = of_both(&self.paths, &self.pairs[list].bodies(pair));
        self.pairs[list].set(pair, paths + (1.0 - ROUNDING) * distance);
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let pairs = self.pairs.iter().map(KnownPairs::heap_bytes).sum::<usize>();
        8 * D * self.x.capacity() + (16 * D + 88) * self.paths.capacity() + pairs
    }
}
