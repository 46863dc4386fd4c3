//! How far points may get within a step, and whether the candidates at hand are all that meet there.

use crate::vector::{dot, subtract};
use opruga_math::Lane;

type Bounds<const D: usize> = [[f64; D]; 2];

/// For every point the box that it does not leave within the step, whatever contact does; and the box for which candidates were looked for.
///
/// Every point has a box of its own: one fast point does not make candidates of all the others.
#[derive(Clone, Debug, Default)]
pub(crate) struct Reach<const D: usize> {
    /// What contact may add to the free motion of every point [m].
    push: Vec<f64>,
    /// Where every point may be within the step [m].
    pub(crate) swept: Vec<Bounds<D>>,
    /// Where points may be while the candidates at hand are all [m]; nowhere where there are none.
    pub(crate) found_in: Vec<Bounds<D>>,
    /// Whether the boxes of the step lie within those, with a quarter of a margin to spare.
    covered: bool,
}

/// A box in which nothing lies.
const NOWHERE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

impl<const D: usize> Reach<D> {
    /// Begins a step from the positions before and after the free motion [m]: contact may push every point as far as it goes by itself, and
    /// by what takes overlapping bodies apart.
    pub(crate) fn begin(&mut self, [from, to]: [&[[f64; D]]; 2], recovery: f64, margin: f64) {
        self.push.resize(from.len(), 0.0);
        self.swept.resize(from.len(), [[0.0; D]; 2]);
        if self.found_in.len() != self.swept.len() {
            self.forget();
            self.found_in.resize(from.len(), NOWHERE.map(|c| [c; D]));
        }
        let spare = 0.25 * margin;
        let mut covered = true;
        let boxes = self.push.iter_mut().zip(&mut self.swept).zip(&self.found_in);
        for ((from, to), ((push, swept), found)) in from.iter().zip(to).zip(boxes) {
            let displacement = subtract(to, from);
            *push = dot(&displacement, &displacement).sqrt() + recovery;
            for d in 0..D {
                let (low, high) = (from[d].smaller(to[d]) - *push, from[d].larger(to[d]) + *push);
                (swept[0][d], swept[1][d]) = (low, high);
                covered &= (found[0][d] <= low - spare) & (high + spare <= found[1][d]);
            }
        }
        self.covered = covered;
    }

    /// Whether all boxes lie within those for which candidates were looked for, with a quarter of a margin to spare: pairs that are
    /// asked for beyond the step are at hand then, whenever they were looked for.
    pub(crate) fn is_covered(&self) -> bool {
        self.covered
    }

    /// Sets the boxes for which candidates are looked for: half a margin [m] beyond those of the step, and for fast points as far as they
    /// go in so many more steps.
    pub(crate) fn widen(&mut self, margin: f64, steps: f64) {
        self.covered = true;
        self.found_in.clone_from(&self.swept);
        for ([low, high], push) in self.found_in.iter_mut().zip(&self.push) {
            let more = (0.5 * margin).larger(steps * push);
            for d in 0..D {
                low[d] -= more;
                high[d] += more;
            }
        }
    }

    /// Forgets the candidates.
    pub(crate) fn forget(&mut self) {
        self.covered = false;
        self.found_in.clear();
    }

    /// Widens the boxes of touched points that contact pushes beyond them; says whether there are any.
    pub(crate) fn grow(&mut self, touched: &[bool], free: &[[f64; D]], end: &[[f64; D]], margin: f64) -> bool {
        let (mut any, spare) = (false, 0.25 * margin);
        for p in (0..touched.len()).filter(|p| touched[*p]) {
            let displacement = subtract(&end[p], &free[p]);
            let pushed = dot(&displacement, &displacement).sqrt();
            if pushed > self.push[p] {
                let more = 2.0 * pushed - self.push[p];
                self.push[p] = 2.0 * pushed;
                let ([low, high], found) = (&mut self.swept[p], &self.found_in[p]);
                for d in 0..D {
                    low[d] -= more;
                    high[d] += more;
                    self.covered &= found[0][d] <= low[d] - spare && high[d] + spare <= found[1][d];
                }
                any = true;
            }
        }
        any
    }

    /// What contact may add to the motion of a point [m].
    #[inline]
    pub(crate) fn push_of(&self, point: u32) -> f64 {
        self.push[point as usize]
    }

    /// Whether two features may come closer than a distance [m] within the step.
    #[inline]
    pub(crate) fn meet<const M: usize, const N: usize>(&self, a: &[u32; M], b: &[u32; N], distance: f64) -> bool {
        let ([low_a, high_a], [low_b, high_b]) = (around(&self.swept, a), around(&self.swept, b));
        (0..D).all(|d| low_a[d] <= high_b[d] + distance && low_b[d] <= high_a[d] + distance)
    }

    pub(crate) fn points(&self) -> usize {
        self.swept.capacity()
    }
}

/// The box around the boxes of some points.
#[inline]
pub(crate) fn around<const D: usize, const N: usize>(boxes: &[Bounds<D>], points: &[u32; N]) -> Bounds<D> {
    let mut out = boxes[points[0] as usize];
    for p in &points[1..] {
        let [low, high] = &boxes[*p as usize];
        for d in 0..D {
            out[0][d] = low[d].smaller(out[0][d]);
            out[1][d] = high[d].larger(out[1][d]);
        }
    }
    out
}
