//! The ends of a spectrum by the Lanczos recurrence.

use super::Unstable;
use crate::error::StepError;
use crate::state::Columns;
use opruga_math::{Lane, WIDTH, sum_in_fixed_order};

/// The largest number of products with K or C.
const MOST_PRODUCTS: usize = 300;

/// A Ritz value has converged if its residual is at most this fraction of the largest Ritz value.
const TOLERANCE: f64 = 2e-3;

/// The largest entry, by absolute value.
pub(super) fn largest<const D: usize>(columns: &Columns<D>) -> f64 {
    let mut most = [f64::MIN_POSITIVE; WIDTH];
    for column in &columns.0 {
        for values in column.chunks_exact(WIDTH) {
            for l in 0..WIDTH {
                most[l] = values[l].abs().larger(most[l]);
            }
        }
    }
    most.into_iter().fold(0.0, Lane::larger)
}

/// The scalar product, in eight partial sums.
fn dot<const D: usize>(a: &Columns<D>, b: &Columns<D>) -> f64 {
    let mut sums = [0.0; WIDTH];
    for i in 0..D {
        for (a, b) in a.0[i].chunks_exact(WIDTH).zip(b.0[i].chunks_exact(WIDTH)) {
            for l in 0..WIDTH {
                sums[l] += a[l] * b[l];
            }
        }
    }
    sum_in_fixed_order(&sums)
}

/// Bounds on the smallest and the largest eigenvalue of W A W, where W is diagonal. `product` adds A d to a vector of zeros.
///
/// Uses the Lanczos recurrence q ← (W A W − α) q − β q′ from a fixed start. The recurrence continues until the residuals of
/// both ends, or only of the upper one, are small compared with the larger of these values and `reference`.
pub(super) fn extremes<const D: usize>(
    weights: &Columns<D>,
    both: bool,
    reference: f64,
    mut product: impl FnMut(&Columns<D>, &mut Columns<D>) -> Result<(), StepError>,
) -> Result<[f64; 2], StepError> {
    let mut q = start(weights);
    let freedom = weights.0.iter().flatten().filter(|w| **w > 0.0).count();
    let index_count = weights.0[0].len() - WIDTH;
    let mut before: Columns<D> = Columns::zeros(index_count);
    let (mut d, mut r): (Columns<D>, Columns<D>) = (Columns::zeros(index_count), Columns::zeros(index_count));
    let mut matrix = Tridiagonal::default();
    let mut found = [None, None];
    for iteration in 1..=MOST_PRODUCTS.min(freedom) {
        for i in 0..D {
            for ((d, w), q) in d.0[i].iter_mut().zip(&weights.0[i]).zip(&q.0[i]) {
                *d = w * q;
            }
            r.0[i].fill(0.0);
        }
        product(&d, &mut r)?;
        // The components of the product along the last two vectors are the new row of the tridiagonal matrix.
        let beta = matrix.beta.last().copied().unwrap_or(0.0);
        for i in 0..D {
            for ((r, w), before) in r.0[i].iter_mut().zip(&weights.0[i]).zip(&before.0[i]) {
                *r = w * *r - beta * before;
            }
        }
        let alpha = dot(&r, &q);
        for i in 0..D {
            for (r, q) in r.0[i].iter_mut().zip(&q.0[i]) {
                *r -= alpha * q;
            }
        }
        let beta = dot(&r, &r).sqrt();
        if !(alpha.is_finite() && beta.is_finite()) {
            return Err(StepError::of("stability", Unstable::Forces {}));
        }
        matrix.alpha.push(alpha);
        matrix.beta.push(beta);

        let [low, high] = matrix.extremes();
        let scale = low.abs().larger(high.abs());
        let last = beta <= 1e-12 * scale || iteration == MOST_PRODUCTS.min(freedom);
        for (end, value) in [low, high].into_iter().enumerate() {
            let residual = matrix.residual(value);
            if found[end].is_none() && (last || residual <= TOLERANCE * scale.larger(reference)) {
                // If the recurrence has exhausted the space, the Ritz values are exact.
                let rest = if beta <= 1e-12 * scale || iteration == freedom { 0.0 } else { residual };
                found[end] = Some(if end == 0 { value - rest } else { value + rest });
            }
        }
        if found[1].is_some() && (!both || found[0].is_some()) {
            break;
        }
        core::mem::swap(&mut before, &mut q);
        let factor = 1.0 / beta;
        for i in 0..D {
            for (q, r) in q.0[i].iter_mut().zip(&r.0[i]) {
                *q = factor * r;
            }
        }
    }
    Ok([found[0].unwrap_or(0.0), found[1].unwrap_or(0.0)])
}

/// The start vector: a unit vector with pseudo-random entries where the weights are not zero. The start vector is always the same.
fn start<const D: usize>(weights: &Columns<D>) -> Columns<D> {
    let mut out = weights.clone();
    let mut square = 0.0;
    for (d, column) in out.0.iter_mut().enumerate() {
        for (p, value) in column.iter_mut().enumerate() {
            if *value > 0.0 {
                // SplitMix64 of the number of the coordinate (Steele, Lea, Flood 2014).
                let mut z = ((p * D + d + 1) as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
                *value = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
                square += *value * *value;
            }
        }
    }
    let factor = if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 };
    out.0.iter_mut().flat_map(|c| c.iter_mut()).for_each(|v| *v *= factor);
    out
}

/// A symmetric tridiagonal matrix: its diagonal and its off-diagonal (with one additional entry: the next one).
#[derive(Default)]
struct Tridiagonal {
    alpha: Vec<f64>,
    beta: Vec<f64>,
}

impl Tridiagonal {
    /// The smallest and the largest eigenvalue.
    fn extremes(&self) -> [f64; 2] {
        let n = self.alpha.len();
        // Gershgorin's circles.
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for i in 0..n {
            let radius = if i > 0 { self.beta[i - 1] } else { 0.0 } + if i + 1 < n { self.beta[i] } else { 0.0 };
            low = (self.alpha[i] - radius).smaller(low);
            high = (self.alpha[i] + radius).larger(high);
        }
        [self.bisect(low, high, 1), self.bisect(low, high, n)]
    }
    /// The value below which there are `count` eigenvalues.
    fn bisect(&self, mut low: f64, mut high: f64, count: usize) -> f64 {
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.below(middle) >= count {
                high = middle;
            } else {
                low = middle;
            }
        }
        0.5 * (low + high)
    }
    /// The number of eigenvalues below a value (Sturm sequence).
    fn below(&self, value: f64) -> usize {
        let mut count = 0;
        let mut pivot = 1.0;
        for i in 0..self.alpha.len() {
            let beta = if i > 0 { self.beta[i - 1] } else { 0.0 };
            let safe = if pivot == 0.0 { f64::MIN_POSITIVE } else { pivot };
            pivot = self.alpha[i] - value - beta * beta / safe;
            count += usize::from(pivot < 0.0);
        }
        count
    }
    /// A bound on the distance of a Ritz value from an eigenvalue of the whole matrix: the next β times the last entry of its
    /// unit vector.
    fn residual(&self, value: f64) -> f64 {
        let n = self.alpha.len();
        let (mut before, mut entry, mut square) = (0.0, 1.0, 1.0);
        for i in 0..n - 1 {
            let left = if i > 0 { self.beta[i - 1] * before } else { 0.0 };
            let next = ((value - self.alpha[i]) * entry - left) / self.beta[i];
            (before, entry) = (entry, next);
            square += entry * entry;
        }
        self.beta[n - 1] * entry.abs() / square.sqrt()
    }
}
