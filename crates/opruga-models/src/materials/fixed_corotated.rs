//! Fixed corotated elasticity: distance from the nearest rotation, and change of volume.

use super::corotated::distance_from_rotation;
use super::material::{Material, Parameters, Principal};
use opruga_math::Lane;
use opruga_math::matrix::{self, Matrix};
use opruga_math::rotation::nearest_rotation;

/// ψ = μ |F − R|² + λ/2 (J − 1)² with the rotation R nearest to F and J = det F; P = 2μ(F − R) + λ(J − 1) cof F.
///
/// This law resists changes of the true volume, whereas the corotated law resists changes of its linear measure. The law
/// has a stress for every F.
///
/// # Source
/// Stomakhin, Howes, Schroeder, Teran, "Energetically consistent invertible elasticity" (2012).
#[derive(Clone, Copy, Debug)]
pub struct FixedCorotated;

impl<const D: usize> Material<D> for FixedCorotated {
    const NAME: &'static str = "fixed_corotated";
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>) -> (S, Matrix<S, D>) {
        let difference = matrix::plus(f, -S::one(), &nearest_rotation(f));
        let cofactors = matrix::cofactor(f);
        let change = matrix::determinant_by(f, &cofactors) - S::one();
        let energy = p.mu * matrix::inner(&difference, &difference) + S::splat(0.5) * p.lambda * change * change;
        (energy, matrix::plus(&matrix::scaled(&difference, p.mu + p.mu), p.lambda * change, &cofactors))
    }
    #[inline(always)]
    fn principal<S: Lane>(p: &Parameters<S>, f: &Matrix<S, D>, sigma: &[S; D]) -> Principal<S, D> {
        let mut principal = distance_from_rotation(p.mu, sigma);
        principal.add_volumetric(sigma, p.lambda * (matrix::determinant(f) - S::one()), p.lambda);
        principal
    }
}
