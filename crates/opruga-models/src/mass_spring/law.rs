//! The law of one spring.

use opruga_core::pair::{PairLaw, PairTerm};
use opruga_core::state::Parameter;
use opruga_math::{Lane, Pack, lanes};

/// A linear spring with damping along its axis, for the parameters of all springs.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpringLaw<'a, const DAMPED: bool> {
    pub(super) rest_length: &'a Parameter,
    pub(super) stiffness: &'a Parameter,
    pub(super) damping: &'a Parameter,
}

/// 1/|d|. It is zero if the ends coincide, since the force then has no direction and is set to
/// zero.
#[inline(always)]
fn inverse_length<S: Lane, const D: usize>(d: &[S; D]) -> S {
    let square = dot(d, d);
    let inverse = S::one() / square.sqrt();
    // Squares below the smallest normal number count as coincident.
    S::select(S::splat(f64::MIN_POSITIVE).less_or_equal(square), inverse, S::zero())
}

/// The length of d and its inverse. Both are zero if the ends coincide.
#[inline(always)]
pub(super) fn length<S: Lane, const D: usize>(d: &[S; D]) -> (S, S) {
    let inverse = inverse_length(d);
    (dot(d, d) * inverse, inverse)
}

/// Scalar product.
#[inline(always)]
pub(super) fn dot<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> S {
    let mut sum = a[0] * b[0];
    for i in 1..D {
        sum += a[i] * b[i];
    }
    sum
}

impl<const DAMPED: bool, const D: usize> PairLaw<D> for SpringLaw<'_, DAMPED> {
    const DAMPED: bool = DAMPED;
    const UNIFORM: bool = false;
    const SECOND: f64 = -1.0;
    const AHEAD: bool = true;

    #[inline(always)]
    fn parameters(&self) -> [&Parameter; 3] {
        [self.rest_length, self.stiffness, self.damping]
    }
    #[inline(always)]
    fn ahead<S: Lane>(&self, d: [S; D]) -> S {
        inverse_length(&d)
    }
    #[inline(always)]
    fn force<S: Lane>(
        &self,
        [rest_length, stiffness, damping]: [S; 3],
        d: [S; D],
        rate: [S; D],
        inverse: S,
    ) -> ([S; D], S) {
        let length = dot(&d, &d) * inverse;
        // Positive if the spring pushes its ends apart.
        let mut thrust = stiffness * (rest_length - length);
        let mut power = S::zero();
        if DAMPED {
            // The rate of the length; zero under any rigid motion.
            let speed = dot(&rate, &d) * inverse;
            let drag = damping * speed;
            thrust -= drag;
            power = drag * speed;
        }
        let factor = thrust * inverse;
        (lanes!(S, i => d[i] * factor), power)
    }
}

/// The energy of a spring [J].
impl<P: Pack, const D: usize> PairTerm<P, D> for SpringLaw<'_, false> {
    #[inline(always)]
    fn parameters(&self) -> [&Parameter; 3] {
        [self.rest_length, self.stiffness, self.damping]
    }
    #[inline(always)]
    fn of(&self, [rest_length, stiffness, _]: [P; 3], a: [P; D], b: [P; D]) -> P {
        let d = lanes!(P, i => a[i] - b[i]);
        let (length, _) = length(&d);
        let stretch = length - rest_length;
        P::splat(0.5) * stiffness * stretch * stretch
    }
}
