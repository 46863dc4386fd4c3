//! Differences along a curve: its metric on edges, its curvature at nodes.

use crate::vectors::{cross, dot, in_dimension, in_space, inverse, minus, scaled};
use opruga_core::stencil::Kernel;
use opruga_math::Lane;

/// The metric of an edge between two nodes. The parameters are EA L [N·m], 1/L² [1/m²] and the retardation time τ [s].
///
/// U = ½ EA L ε² with ε = ½ (|x₁ − x₀|²/L² − 1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch;

impl<const D: usize> Kernel<D, 2, 3> for Stretch {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 3], x: &[[S; D]; 2]) -> S {
        let d = minus(&in_space(&x[1]), &in_space(&x[0]));
        let strain = S::splat(0.5) * (dot(&d, &d) * p[1] - S::one());
        S::splat(0.5) * p[0] * strain * strain
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 3], x: &[[S; D]; 2]) -> [[S; D]; 2] {
        let d = minus(&in_space(&x[1]), &in_space(&x[0]));
        let strain = S::splat(0.5) * (dot(&d, &d) * p[1] - S::one());
        let pull = scaled(&d, p[0] * strain * p[1]);
        [in_dimension(&scaled(&pull, -S::one())), in_dimension(&pull)]
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 3], x: &[[S; D]; 2], v: &[[S; D]; 2]) -> ([[S; D]; 2], S) {
        let d = minus(&in_space(&x[1]), &in_space(&x[0]));
        let rate = dot(&d, &minus(&in_space(&v[1]), &in_space(&v[0]))) * p[1];
        let stress = p[2] * p[0] * rate;
        let pull = scaled(&d, stress * p[1]);
        ([in_dimension(&pull), in_dimension(&scaled(&pull, -S::one()))], stress * rate)
    }
}

/// The curvature at a node between two edges. The parameters are EI ℓ [N·m³], 1/L₋, 1/L₊ [1/m], the share of the first edge
/// in the tangent, 1/ℓ [1/m], the curvature at rest B₀ [1/m] and the retardation time τ [s].
///
/// ```text
///   0 ──a──▶ 1 ──b──▶ 2      a = (x₁ − x₀)/L₋, b = (x₂ − x₁)/L₊, ℓ = ½ (L₋ + L₊)
///
///   x′ = (L₊ a + L₋ b)/(L₋ + L₊),  x″ = (b − a)/ℓ,  x′ × x″ = a × b/ℓ
///   B = n·x″ = |a × b|/(ℓ |x′|), signed in the plane
/// ```
/// U = ½ EI ℓ (B − B₀)². In space the force is −EI ℓ (1 − B₀/B) ½∇B². If the curve is straight at rest, this force is smooth
/// in the straight state. If the curve is bent at rest, the force has no direction in the straight state and is set to zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend;

/// A bent curve: a, b, the tangent, and B with ½∇B² (in the plane B ∇B) by a and b.
struct Bent<S> {
    /// B [1/m].
    curvature: S,
    /// ∂B/∂a and ∂B/∂b in the plane, ½ ∂B²/∂a and ½ ∂B²/∂b in space.
    slope: [[S; 3]; 2],
}

impl Bend {
    #[inline(always)]
    fn bent<S: Lane, const D: usize>(p: &[S; 7], x: &[[S; D]; 3]) -> Bent<S> {
        let (before, at, after) = (in_space(&x[0]), in_space(&x[1]), in_space(&x[2]));
        let (a, b) = (scaled(&minus(&at, &before), p[1]), scaled(&minus(&after, &at), p[2]));
        let (of_a, of_b) = (p[3], S::one() - p[3]);
        let mut tangent = [S::zero(); 3];
        for d in 0..3 {
            tangent[d] = of_a * a[d] + of_b * b[d];
        }
        let square = dot(&tangent, &tangent);
        let per_square = inverse(square);
        let normal = cross(&a, &b);
        // The length of the tangent changes too, which subtracts a part along the tangent.
        if D == 2 {
            let length = S::select(S::zero().less(square), square, S::one()).sqrt();
            let scale = p[4] * inverse(length);
            let curvature = normal[2] * scale;
            let less = curvature * per_square;
            let mut slope = [[S::zero(); 3]; 2];
            slope[0] = [scale * b[1], -(scale * b[0]), S::zero()];
            slope[1] = [-(scale * a[1]), scale * a[0], S::zero()];
            for d in 0..2 {
                slope[0][d] -= less * of_a * tangent[d];
                slope[1][d] -= less * of_b * tangent[d];
            }
            return Bent { curvature, slope };
        }
        let scale = p[4] * p[4] * per_square;
        let curvature_square = dot(&normal, &normal) * scale;
        let less = curvature_square * per_square;
        let (by_a, by_b) = (cross(&b, &normal), cross(&normal, &a));
        let mut slope = [[S::zero(); 3]; 2];
        for d in 0..3 {
            slope[0][d] = scale * by_a[d] - less * of_a * tangent[d];
            slope[1][d] = scale * by_b[d] - less * of_b * tangent[d];
        }
        let positive = S::zero().less(curvature_square);
        let root = S::select(positive, S::select(positive, curvature_square, S::one()).sqrt(), S::zero());
        Bent { curvature: root, slope }
    }
    /// The factor by which the slopes must be multiplied to give `moment` times ∂B/∂x.
    #[inline(always)]
    fn factor<S: Lane, const D: usize>(bent: &Bent<S>, moment: S) -> S {
        if D == 2 { moment } else { moment * inverse(bent.curvature) }
    }
    /// Distributes a factor times the slopes to the nodes.
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(p: &[S; 7], bent: &Bent<S>, factor: S) -> [[S; D]; 3] {
        let (a, b) = (scaled(&bent.slope[0], factor * p[1]), scaled(&bent.slope[1], factor * p[2]));
        [in_dimension(&scaled(&a, -S::one())), in_dimension(&minus(&a, &b)), in_dimension(&b)]
    }
}

impl<const D: usize> Kernel<D, 3, 7> for Bend {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 7], x: &[[S; D]; 3]) -> S {
        let excess = Bend::bent(p, x).curvature - p[5];
        S::splat(0.5) * p[0] * excess * excess
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 7], x: &[[S; D]; 3]) -> [[S; D]; 3] {
        let bent = Bend::bent(p, x);
        let factor = if D == 2 {
            p[0] * (bent.curvature - p[5])
        } else {
            // If the curve is straight at rest, the square root is not used, because its derivative is undefined in the
            // straight state.
            let curved = S::zero().less(p[5]);
            let quotient = p[5] * inverse(S::select(curved, bent.curvature, S::one()));
            p[0] * (S::one() - S::select(curved, quotient, S::zero()))
        };
        Bend::spread(p, &bent, factor)
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 7], x: &[[S; D]; 3], v: &[[S; D]; 3]) -> ([[S; D]; 3], S) {
        let bent = Bend::bent(p, x);
        let (before, at, after) = (in_space(&v[0]), in_space(&v[1]), in_space(&v[2]));
        let rate = Bend::factor::<S, D>(&bent, S::one())
            * (dot(&bent.slope[0], &scaled(&minus(&at, &before), p[1]))
                + dot(&bent.slope[1], &scaled(&minus(&after, &at), p[2])));
        let moment = p[6] * p[0] * rate;
        (Bend::spread(p, &bent, -Bend::factor::<S, D>(&bent, moment)), moment * rate)
    }
}
