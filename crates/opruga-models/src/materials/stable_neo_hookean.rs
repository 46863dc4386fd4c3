//! The stable neo-Hookean solid.

use super::material::{Invariants, Material, Parameters, Principal};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};

/// ψ = m/2 (I − 3) − 3m/4 (J − 1) + l/2 (J − 1)² − m/2 ln((I + 1)/4) with m = 4/3 μ, l = λ + 5/6 μ, I = tr FᵀF in space and
/// tr FᵀF + 1 in plane strain, J = det F; P = m (1 − 1/(I + 1)) F + (l (J − 1) − 3m/4) cof F.
///
/// This ψ is m/2 (I − 3) + l/2 (J − α)² − m/2 ln(I + 1) with α = 1 + 3m/4l, minus its value at rest. The law has a stress for
/// every F, including degenerate and inverted states, and no equilibrium except the rest shape.
///
/// # Source
/// Smith, de Goes, Kim, "Stable neo-Hookean flesh simulation", ACM Trans. Graph. 37 (2018), eq. 14 and section 3.4.
#[derive(Clone, Copy, Debug)]
pub struct StableNeoHookean;

/// m and l.
#[inline(always)]
fn moduli<S: Lane>(p: &Parameters<S>) -> (S, S) {
    (S::splat(4.0 / 3.0) * p.mu, p.lambda + S::splat(5.0 / 6.0) * p.mu)
}

/// tr FᵀF of the motion in space.
#[inline(always)]
fn stretch<S: Lane, const D: usize>(f: &Matrix<S, D>) -> S {
    matrix::inner(f, f) + S::splat((3 - D) as f64)
}

impl<const D: usize> Material<D> for StableNeoHookean {
    const NAME: &'static str = "stable_neo_hookean";
    const CANCELS: bool = true;
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let half = S::splat(0.5);
        let (m, l) = moduli(p);
        let cofactors = matrix::cofactor(f);
        let change = matrix::determinant_by(f, &cofactors) - S::one();
        let above = stretch(f) + S::one();
        let rest = S::splat(0.75) * m;
        let energy =
            half * m * (above - S::splat(4.0) - (S::splat(0.25) * above).ln()) + (half * l * change - rest) * change;
        let stress = matrix::scaled(f, m - m / above);
        (energy, matrix::plus(&stress, l * change - rest, &cofactors))
    }
    #[inline(always)]
    fn invariants<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> Option<Invariants<S>> {
        let (m, l) = moduli(p);
        let change = matrix::determinant(f) - S::one();
        let inverse = S::one() / (stretch(f) + S::one());
        Some(Invariants {
            stretch: m - m * inverse,
            stretch_twice: Some(S::splat(2.0) * m * inverse * inverse),
            volume: l * change - S::splat(0.75) * m,
            volume_twice: l,
        })
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let (m, l) = moduli(p);
        let half = S::splat(0.5);
        let inverse = S::one() / (stretch(f) + S::one());
        let mut principal = Principal::zeros();
        principal.add_stretch(sigma, half * (m - m * inverse), half * m * inverse * inverse);
        let first = l * (matrix::determinant(f) - S::one()) - S::splat(0.75) * m;
        principal.add_volumetric(sigma, first, l);
        principal
    }
}
