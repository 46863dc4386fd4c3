//! How far points may move within a step, and whether the present candidates include all pairs that meet in it.

use crate::least_parts;
use crate::vector::{Bounds, dot, subtract};
use opruga_core::threads;
use opruga_math::Lane;

/// For every point, a box around its motion in the step, including the motion that contact may add. Also the larger box of the last search for
/// candidates.
///
/// Every point has its own box, so one fast point does not turn all the others into candidates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reach<const D: usize> {
    /// The displacement that contact may add to the free motion of every point [m].
    push: Vec<f64>,
    /// The box of every point within the step [m].
    pub(crate) swept: Vec<Bounds<D>>,
    /// The box of every point for which the present candidates are complete [m]; empty if there are none.
    pub(crate) found_in: Vec<Bounds<D>>,
    /// For every body, the largest displacement that contact may add to the motion of one of its points [m].
    body_push: Vec<f64>,
    /// For every body, whether a new search must find its candidates. A new search is necessary if a box of the step is not inside the box of the
    /// last search with a quarter of a margin to spare. It is also necessary if the box of the last search is far too large because it was made for a
    /// faster motion.
    stale: Vec<bool>,
    /// For every body, whether it will soon be stale. The next search covers all such bodies at once.
    due: Vec<bool>,
    /// The points whose boxes the last call of [`Reach::grow`] extended, ascending. Also the displacement that contact may add to the motion of each
    /// point, and its box, both as they were before that call.
    grown: Vec<(u32, f64, Bounds<D>)>,
    /// The results for the points of bodies in this step, one list for each part of the points.
    began: Vec<Vec<Began>>,
}

/// A search finds all pairs within the boxes of its points. These boxes extend at least this many margins beyond the boxes of every step that uses its
/// pairs. In bodies at rest, and around vertices that seem to be deep inside a body, gaps are computed up to this distance beyond the boxes of the step.
/// If the distance in one of these places were larger than in the other, results would depend on when a search was made.
pub(crate) const SPARE: f64 = 0.25;

/// If the margin of a box is this many times as wide as it would be now, the box is computed anew. Otherwise bodies that come to rest after an impact
/// would keep the candidates of their flight (`candidates_of_a_flight_are_dropped_at_rest`). The number is above 2 because a point that moves
/// straight ahead has up to twice the margin behind it.
pub(crate) const MOST_WIDTHS: f64 = 4.0;

/// Returns how far beyond the box of a step the search for candidates extends [m], for a point or body that moves by `moves` in the step. This
/// distance is what the point or body covers in `steps` more steps, but at least half a margin and at most a whole one. Without the upper limit, long
/// steps of fast bodies would make everything around them a candidate (ten times as many candidates for eight falling cubes).
pub(crate) fn beyond(moves: f64, steps: f64, margin: f64) -> f64 {
    (0.5 * margin).larger((steps * moves).smaller(margin))
}

/// The results of [`Reach::begin`] for the points of a body, or of a part of it.
#[derive(Clone, Debug)]
struct Began {
    body: u32,
    push: f64,
    stale: bool,
    due: bool,
}

/// An empty box.
const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl<const D: usize> Reach<D> {
    /// Begins a step from the positions of points before and after the free motion [m] and their bodies. The method assumes that contact pushes a
    /// point at most as far as the free motion moves it, plus the distance by which overlapping bodies are separated. [`Reach::grow`] widens the box
    /// of a point that contact pushes farther.
    pub(crate) fn begin(
        &mut self,
        body: &[u32],
        [from, to]: [&[[f64; D]]; 2],
        recovery: f64,
        (margin, steps): (f64, f64),
        threads: usize,
    ) {
        self.push.resize(from.len(), 0.0);
        self.swept.resize(from.len(), [[0.0; D]; 2]);
        if self.found_in.len() != self.swept.len() {
            self.found_in.clear();
            self.found_in.resize(from.len(), NOWHERE.map(|c| [c; D]));
            self.stale.resize(body.iter().map(|body| *body as usize + 1).max().unwrap_or(0), true);
            self.due.resize(self.stale.len(), true);
            self.body_push.resize(self.stale.len(), 0.0);
        }
        self.stale.fill(false);
        self.due.fill(false);
        self.body_push.fill(0.0);
        let spare = SPARE * margin;
        let size = threads::part_size(from.len(), threads, least_parts::POINTS);
        let boxes = self.push.chunks_mut(size).zip(self.swept.chunks_mut(size)).zip(self.found_in.chunks(size));
        let points = from.chunks(size).zip(to.chunks(size)).zip(body.chunks(size));
        let began = threads::empty_lists(&mut self.began, from.len().div_ceil(size));
        let parts = points.zip(boxes).zip(began.iter_mut());
        threads::each_in_pool(parts, |(((points, body), ((push, swept), found)), bodies)| {
            let own = push.iter_mut().zip(swept.iter_mut()).zip(found.iter()).zip(body.iter());
            for ((from, to), (((push, swept), found), body)) in points.0.iter().zip(points.1).zip(own) {
                let displacement = subtract(to, from);
                *push = dot(&displacement, &displacement).sqrt() + recovery;
                let (mut least, mut most) = (f64::INFINITY, 0.0);
                for d in 0..D {
                    let (low, high) = (from[d].smaller(to[d]) - *push, from[d].larger(to[d]) + *push);
                    (swept[0][d], swept[1][d]) = (low, high);
                    let [below, above] = [low - found[0][d], found[1][d] - high];
                    least = below.smaller(above).smaller(least);
                    most = below.larger(above).larger(most);
                }
                let wide = beyond(*push, steps, margin);
                // NaN is never covered.
                let covered = least >= spare && most <= MOST_WIDTHS * wide;
                let lasting = least >= spare + 0.5 * (wide - spare);
                if bodies.last().is_none_or(|last: &Began| last.body != *body) {
                    bodies.push(Began { body: *body, push: 0.0, stale: false, due: false });
                }
                if let Some(last) = bodies.last_mut() {
                    last.push = push.larger(last.push);
                    last.stale |= !covered;
                    last.due |= !lasting;
                }
            }
        });
        for Began { body, push, stale, due } in began.iter().flatten() {
            let body = *body as usize;
            self.body_push[body] = push.larger(self.body_push[body]);
            self.stale[body] |= stale;
            self.due[body] |= due;
        }
    }

    /// Whether all boxes are inside the boxes of the last search, with a quarter of a margin to spare. Then even pairs slightly beyond the boxes of
    /// the step are known, whenever the last search was made.
    pub(crate) fn is_covered(&self) -> bool {
        !self.stale.contains(&true)
    }

    /// Whether a new search must find the candidates of a body.
    pub(crate) fn is_stale(&self, body: u32) -> bool {
        self.stale[body as usize]
    }

    /// Marks all bodies that are due as stale.
    pub(crate) fn take_due(&mut self) {
        self.stale.iter_mut().zip(&self.due).for_each(|(stale, due)| *stale |= due);
    }

    /// Sets the boxes in which the next search looks for candidates of stale bodies. These are the boxes of the step, extended by the motion of the
    /// points in `steps` more steps (see [`beyond`]), limited by `margin` [m].
    pub(crate) fn widen(&mut self, body: &[u32], margin: f64, steps: f64) {
        let own = self.swept.iter().zip(&self.push).zip(body);
        for (found, ((swept, push), body)) in self.found_in.iter_mut().zip(own) {
            if !self.stale[*body as usize] {
                continue;
            }
            *found = *swept;
            let more = beyond(*push, steps, margin);
            for d in 0..D {
                found[0][d] -= more;
                found[1][d] += more;
            }
        }
    }

    /// Discards the candidates of all bodies.
    pub(crate) fn forget(&mut self) {
        self.found_in.clear();
        self.stale.fill(true);
    }

    /// Makes the next search cover all bodies. The boxes are kept.
    pub(crate) fn look_at_all(&mut self) {
        self.stale.fill(true);
    }

    /// Records that candidates were found.
    pub(crate) fn found(&mut self) {
        self.stale.fill(false);
    }

    /// Widens the boxes of touched points that contact pushes beyond them; returns whether there are any.
    pub(crate) fn grow(&mut self, body: &[u32], touched: &[bool], [free, end]: [&[[f64; D]]; 2], margin: f64) -> bool {
        let spare = SPARE * margin;
        self.grown.clear();
        for p in (0..touched.len()).filter(|p| touched[*p]) {
            let displacement = subtract(&end[p], &free[p]);
            let pushed = dot(&displacement, &displacement).sqrt();
            if pushed > self.push[p] {
                let more = pushed - self.push[p];
                self.grown.push((p as u32, self.push[p], self.swept[p]));
                self.push[p] = pushed;
                let most = &mut self.body_push[body[p] as usize];
                *most = self.push[p].larger(*most);
                let ([low, high], found) = (&mut self.swept[p], &self.found_in[p]);
                for d in 0..D {
                    low[d] -= more;
                    high[d] += more;
                    if found[0][d] > low[d] - spare || high[d] + spare > found[1][d] {
                        self.stale[body[p] as usize] = true;
                    }
                }
            }
        }
        !self.grown.is_empty()
    }

    /// The largest displacement that contact may add to the motion of any point of every body [m].
    pub(crate) fn body_push(&self) -> &[f64] {
        &self.body_push
    }

    /// The displacement that contact may add to the motion of a point [m].
    #[inline]
    pub(crate) fn push_of(&self, point: u32) -> f64 {
        self.push[point as usize]
    }

    /// The distance between the boxes of two features within the step, along the axis where it is largest [m]; negative if they
    /// overlap.
    #[inline]
    pub(crate) fn apart<const M: usize, const N: usize>(&self, a: &[u32; M], b: &[u32; N]) -> f64 {
        let of = |p: u32| self.swept[p as usize];
        between(around(of, a), around(of, b))
    }

    /// Whether the last call of [`Reach::grow`] extended the box of a point.
    pub(crate) fn has_grown(&self, point: u32) -> bool {
        self.grown.binary_search_by_key(&point, |(grown, ..)| *grown).is_ok()
    }

    /// The points whose boxes the last call of [`Reach::grow`] extended, ascending.
    pub(crate) fn grown(&self) -> impl Iterator<Item = u32> + '_ {
        self.grown.iter().map(|(point, ..)| *point)
    }

    /// Whether two features at a given distance may come closer than another distance within the step [m]. If `before` is set, the boxes are those
    /// before the last call of [`Reach::grow`].
    pub(crate) fn may_meet(&self, distance: f64, other: f64, [a, b]: [&[u32]; 2], before: bool) -> bool {
        let of = |p: u32| match self.grown.binary_search_by_key(&p, |(grown, ..)| *grown) {
            Ok(k) if before => (self.grown[k].1, self.grown[k].2),
            _ => (self.push[p as usize], self.swept[p as usize]),
        };
        let push = |points: &[u32]| points.iter().fold(0.0, |most: f64, p| of(*p).0.larger(most));
        let whole = |points: &[u32]| points.iter().fold(NOWHERE.map(|c| [c; D]), |whole, p| joined(whole, of(*p).1));
        distance <= other + 2.0 * (push(a) + push(b)) && between(whole(a), whole(b)) <= other
    }

    pub(crate) fn points(&self) -> usize {
        self.swept.capacity()
    }

    /// Bytes on the heap, apart from those of points.
    pub(crate) fn heap_bytes(&self) -> usize {
        size_of::<Began>() * self.began.iter().map(Vec::capacity).sum::<usize>()
            + size_of::<(u32, f64, Bounds<D>)>() * self.grown.capacity()
    }
}

/// The distance between two boxes along the axis where it is largest [m]; negative if they overlap.
#[inline]
fn between<const D: usize>([low_a, high_a]: Bounds<D>, [low_b, high_b]: Bounds<D>) -> f64 {
    let mut most = f64::NEG_INFINITY;
    for d in 0..D {
        most = (low_a[d] - high_b[d]).larger(low_b[d] - high_a[d]).larger(most);
    }
    most
}

/// The box around two boxes.
#[inline]
fn joined<const D: usize>(mut a: Bounds<D>, [low, high]: Bounds<D>) -> Bounds<D> {
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
