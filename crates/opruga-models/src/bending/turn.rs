//! The hinge of an outline or chain: a node between two edges.

use super::angle::angle;
use crate::vectors::{cross, dot, in_dimension, in_space, inverse, minus};
use opruga_core::stencil::Kernel;
use opruga_math::Lane;

/// The nodes are before, at and after the hinge. The parameters are k [N·m], c [N·m·s], cos θ₀ and sin θ₀.
///
/// ```text
///             w   2        θ from u to w: signed in the plane (left is positive), 0 … π in space
///   0 ──u──▶ 1 ──▶
/// ```
/// With n = u × w, s = |n| (n itself in the plane) and d = u·w, the angle is atan2(s, d), and ∂θ/∂w = n̂ × w/|w|², ∂θ/∂u = −n̂ ×
/// u/|u|².
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn;

/// The angle and the vectors that determine it.
struct Bent<S> {
    u: [S; 3],
    w: [S; 3],
    normal: [S; 3],
    /// sin and cos of the angle, times the lengths of both edges. The sine is signed in the plane.
    sine: S,
    cosine: S,
}

impl Turn {
    #[inline(always)]
    fn bent<S: Lane, const D: usize>(x: &[[S; D]; 3]) -> Bent<S> {
        let (before, at, after) = (in_space(&x[0]), in_space(&x[1]), in_space(&x[2]));
        let (u, w) = (minus(&at, &before), minus(&after, &at));
        let normal = cross(&u, &w);
        let sine = if D == 2 { normal[2] } else { dot(&normal, &normal).sqrt() };
        Bent { u, w, normal, sine, cosine: dot(&u, &w) }
    }
    /// θ − θ₀, reduced to −π … π.
    #[inline(always)]
    fn excess<S: Lane>(bent: &Bent<S>, [_, _, cos, sin]: &[S; 4]) -> S {
        angle(bent.sine * *cos - bent.cosine * *sin, bent.cosine * *cos + bent.sine * *sin)
    }
    /// n × u/|u|² and n × w/|w|² with the given normal n. Divided by |n|, these levers are −∂θ/∂u and ∂θ/∂w.
    #[inline(always)]
    fn levers<S: Lane>(bent: &Bent<S>, normal: &[S; 3]) -> [[S; 3]; 2] {
        let (iu, iw) = (inverse(dot(&bent.u, &bent.u)), inverse(dot(&bent.w, &bent.w)));
        let (nu, nw) = (cross(normal, &bent.u), cross(normal, &bent.w));
        [[nu[0] * iu, nu[1] * iu, nu[2] * iu], [nw[0] * iw, nw[1] * iw, nw[2] * iw]]
    }
    /// `moment` times ∂θ/∂x, from the levers of both edges.
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(moment: S, [u, w]: &[[S; 3]; 2]) -> [[S; D]; 3] {
        let mut out = [[S::zero(); 3]; 3];
        for d in 0..3 {
            let (mu, mw) = (moment * u[d], moment * w[d]);
            out[0][d] = mu;
            out[1][d] = -(mu + mw);
            out[2][d] = mw;
        }
        [in_dimension(&out[0]), in_dimension(&out[1]), in_dimension(&out[2])]
    }
    /// The unit normal. In the plane it is the third axis. In space it is zero if the edges are collinear.
    #[inline(always)]
    fn unit_normal<S: Lane, const D: usize>(bent: &Bent<S>) -> [S; 3] {
        if D == 2 {
            return [S::zero(), S::zero(), S::one()];
        }
        let i = inverse(bent.sine);
        [bent.normal[0] * i, bent.normal[1] * i, bent.normal[2] * i]
    }
}

impl<const D: usize> Kernel<D, 3, 4> for Turn {
    const NAME: &'static str = "bending";

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 4], x: &[[S; D]; 3]) -> S {
        let bent = Turn::bent(x);
        let excess = Turn::excess(&bent, p);
        S::splat(0.5) * p[0] * excess * excess
    }

    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 4], x: &[[S; D]; 3]) -> [[S; D]; 3] {
        let bent = Turn::bent(x);
        let excess = Turn::excess(&bent, p);
        if D == 2 {
            let levers = Turn::levers(&bent, &Turn::unit_normal::<S, D>(&bent));
            return Turn::spread(p[0] * excess, &levers);
        }
        // In space, (θ − θ₀)/s with the normal n = s n̂. For a straight rest shape this is smooth, even in the straight state.
        let square = dot(&bent.normal, &bent.normal);
        let forward = S::splat(f64::MIN_POSITIVE).less(bent.cosine);
        let i = inverse(S::select(forward, bent.cosine, S::one()));
        let t2 = square * i * i;
        let nearly_straight = S::both(forward, t2.less(S::splat(1e-6)));
        let nearly_straight = S::both(nearly_straight, p[3].abs().less_or_equal(S::zero()));
        let series = i * (S::one() - t2 * (S::splat(1.0 / 3.0) - t2 * S::splat(0.2)));
        let ratio = S::select(nearly_straight, series, excess * inverse(bent.sine));
        Turn::spread(p[0] * ratio, &Turn::levers(&bent, &bent.normal))
    }

    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 4], x: &[[S; D]; 3], v: &[[S; D]; 3]) -> ([[S; D]; 3], S) {
        let bent = Turn::bent(x);
        let levers = Turn::levers(&bent, &Turn::unit_normal::<S, D>(&bent));
        let (v0, v1, v2) = (in_space(&v[0]), in_space(&v[1]), in_space(&v[2]));
        // Rate of the angle: ∂θ/∂u·u̇ + ∂θ/∂w·ẇ.
        let rate = dot(&levers[1], &minus(&v2, &v1)) - dot(&levers[0], &minus(&v1, &v0));
        let moment = p[1] * rate;
        (Turn::spread(-moment, &levers), moment * rate)
    }
}
