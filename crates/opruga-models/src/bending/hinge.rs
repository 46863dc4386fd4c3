//! The hinge of a surface: an edge between two triangles.

use super::angle::angle;
use crate::vectors::{cross, dot, in_dimension, in_space, inverse, minus, scaled};
use opruga_core::stencil::Kernel;
use opruga_math::Lane;

/// Nodes a and b are on the edge, and nodes c and d are opposite to it. The parameters are k [N·m], c [N·m·s], cos θ₀ and sin
/// θ₀.
///
/// ```text
///         c            e = b − a
///        / \           n₁ = e × (c − a), n₂ = (d − a) × e: normals, twice the area long
///       /   \          θ from n₁ to n₂, positive where the edge is a ridge seen from where the normals point
///      a──e─▶b
///       \   /          sin θ |n₁||n₂| = −|e| n₁·(d − a),  cos θ |n₁||n₂| = n₁·n₂
///        \ /           ∂θ/∂c = −|e| n₁/|n₁|²,  ∂θ/∂d = −|e| n₂/|n₂|²
///         d
/// ```
/// ∂θ/∂a and ∂θ/∂b follow, because moving the edge along a normal is the same as moving c or d the opposite way, in proportion
/// to their positions along the edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hinge;

/// The edge, the normals and the vectors that determine θ.
struct Folded<S> {
    sine: S,
    cosine: S,
    /// ∂θ/∂x of a, b, c, d.
    slope: [[S; 3]; 4],
}

/// cos θ and sin θ of four points in the order of [`Hinge`].
pub(crate) fn direction(x: &[[f64; 3]; 4]) -> [f64; 2] {
    let folded = Hinge::folded(x);
    let length = (folded.cosine * folded.cosine + folded.sine * folded.sine).sqrt();
    [folded.cosine / length, folded.sine / length]
}

impl Hinge {
    #[inline(always)]
    fn folded<S: Lane, const D: usize>(x: &[[S; D]; 4]) -> Folded<S> {
        let (a, b, c, d) = (in_space(&x[0]), in_space(&x[1]), in_space(&x[2]), in_space(&x[3]));
        let (e, ac, ad) = (minus(&b, &a), minus(&c, &a), minus(&d, &a));
        let (n1, n2) = (cross(&e, &ac), cross(&ad, &e));
        let square = dot(&e, &e);
        let present = S::splat(f64::MIN_POSITIVE).less_or_equal(square);
        let length = S::select(present, S::select(present, square, S::one()).sqrt(), S::zero());
        let per_length = inverse(square);
        // The positions of c and d along the edge: 0 at a, 1 at b.
        let (alpha, beta) = (dot(&ac, &e) * per_length, dot(&ad, &e) * per_length);
        let of_c = scaled(&n1, -(length * inverse(dot(&n1, &n1))));
        let of_d = scaled(&n2, -(length * inverse(dot(&n2, &n2))));
        let mut slope = [[S::zero(); 3], [S::zero(); 3], of_c, of_d];
        for i in 0..3 {
            slope[0][i] = -((S::one() - alpha) * of_c[i] + (S::one() - beta) * of_d[i]);
            slope[1][i] = -(alpha * of_c[i] + beta * of_d[i]);
        }
        Folded { sine: -(length * dot(&n1, &ad)), cosine: dot(&n1, &n2), slope }
    }
    /// θ − θ₀, reduced to −π … π.
    #[inline(always)]
    fn excess<S: Lane>(folded: &Folded<S>, [_, _, cos, sin]: &[S; 4]) -> S {
        angle(folded.sine * *cos - folded.cosine * *sin, folded.cosine * *cos + folded.sine * *sin)
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(moment: S, slope: &[[S; 3]; 4]) -> [[S; D]; 4] {
        let mut out = [[S::zero(); D]; 4];
        for a in 0..4 {
            out[a] = in_dimension(&scaled(&slope[a], moment));
        }
        out
    }
}

impl<const D: usize> Kernel<D, 4, 4> for Hinge {
    const NAME: &'static str = "bending";

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 4], x: &[[S; D]; 4]) -> S {
        let folded = Hinge::folded(x);
        let excess = Hinge::excess(&folded, p);
        S::splat(0.5) * p[0] * excess * excess
    }

    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 4], x: &[[S; D]; 4]) -> [[S; D]; 4] {
        let folded = Hinge::folded(x);
        Hinge::spread(p[0] * Hinge::excess(&folded, p), &folded.slope)
    }

    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 4], x: &[[S; D]; 4], v: &[[S; D]; 4]) -> ([[S; D]; 4], S) {
        let folded = Hinge::folded(x);
        // Velocities relative to a, so that no digits are lost in fast flight.
        let va = in_space(&v[0]);
        let mut rate = S::zero();
        for node in 1..4 {
            rate += dot(&folded.slope[node], &minus(&in_space(&v[node]), &va));
        }
        let moment = p[1] * rate;
        (Hinge::spread(-moment, &folded.slope), moment * rate)
    }
}
