//! The neo-Hookean solid in its logarithmic form.

use super::material::{Invariants, Material, Parameters, Principal, logarithm_of_volume};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};

/// ψ = μ/2 (I₁ − D) − μ ln J + λ/2 ln² J with I₁ = tr FᵀF and J = det F; P = μF + (λ ln J − μ) J⁻¹ cof F.
///
/// The law is meant for rubber at moderate stretch. Below J = 0.01 the logarithm is continued as a parabola, so that degenerate
/// or inverted elements have a finite energy and are pushed back.
///
/// # Source
/// Bonet, Wood, *Nonlinear continuum mechanics for finite element analysis*, eq. 6.27; in the plane J and I₁ of plane strain.
#[derive(Clone, Copy, Debug)]
pub struct NeoHookean;

/// The first and second derivatives of −μ ln J + λ/2 ln² J.
#[inline(always)]
fn volumetric<S: Lane>(p: &Parameters<S>, j: S) -> (S, S) {
    let [log, first, second] = logarithm_of_volume(j);
    let factor = p.lambda * log - p.mu;
    (factor * first, p.lambda * first * first + factor * second)
}

impl<const D: usize> Material<D> for NeoHookean {
    const NAME: &'static str = "neo_hookean";
    const CANCELS: bool = true;
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let half = S::splat(0.5);
        let cofactors = matrix::cofactor(f);
        let [log, first, _] = logarithm_of_volume(matrix::determinant_by(f, &cofactors));
        let stretch = matrix::inner(f, f) - S::splat(D as f64);
        let energy = p.mu * (half * stretch - log) + half * p.lambda * log * log;
        let factor = (p.lambda * log - p.mu) * first;
        (energy, matrix::plus(&matrix::scaled(f, p.mu), factor, &cofactors))
    }
    #[inline(always)]
    fn invariants<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> Option<Invariants<S>> {
        let (volume, volume_twice) = volumetric(p, matrix::determinant(f));
        Some(Invariants { stretch: p.mu, stretch_twice: None, volume, volume_twice })
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let (first, second) = volumetric(p, matrix::determinant(f));
        let mut principal = Principal::zeros();
        principal.add_stretch(sigma, S::splat(0.5) * p.mu, S::zero());
        principal.add_volumetric(sigma, first, second);
        principal
    }
}
