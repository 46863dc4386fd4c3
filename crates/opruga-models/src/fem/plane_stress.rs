//! Plane stress: a law of space whose thickness finds its own stretch.

use super::material::{Material, Parameters, Tangent, no_tangent};
use opruga_core::potential::Definiteness;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, symmetric};

/// A law of space in a thin plate: at every point the stretch t of the thickness is that for which P₃₃ = 0.
///
/// ψ(F) = min over t of ψ₃(diag(F, t)); P is the part of P₃ in the plane, and the tangent is condensed:
/// Cᵢⱼₖₗ − Cᵢⱼ₃₃ C₃₃ₖₗ / C₃₃₃₃. Where no t > 0 has P₃₃ = 0, the energy is not a number and the step is refused.
#[derive(Clone, Copy, Debug)]
pub struct PlaneStress<M>(pub M);

/// The most Newton iterations for the thickness; five are usual.
const MOST_ITERATIONS: usize = 60;

/// The relative change of the thickness after which it is found.
const FOUND: f64 = 1e-12;

/// The deformation gradient in space.
#[inline(always)]
fn in_space<S: Lane, const D: usize>(f: &Matrix<S, D>, thickness: S) -> Matrix<S, 3> {
    let mut out = matrix::zeros();
    for i in 0..D {
        for j in 0..D {
            out[i][j] = f[i][j];
        }
    }
    out[2][2] = thickness;
    out
}

/// The stretch of the thickness for which P₃₃ = 0; not a number where there is none.
#[inline(always)]
fn thickness<M: Material<3>, S: Lane, const D: usize>(p: &Parameters<S>, f: &Matrix<S, D>) -> S {
    let mut t = S::one();
    let mut open = S::zero().less(S::one());
    for _ in 0..MOST_ITERATIONS {
        let space = in_space(f, t);
        let (_, stress) = M::energy_and_stress(p, &space);
        let tangent = M::tangent(p, &space);
        // Newton for t P₃₃ = 0 in ln t, which keeps t positive.
        let value = stress[2][2];
        let slope = value + t * tangent[2][2][2][2];
        let rising = S::zero().less(slope);
        let newton = -value / S::select(rising, slope, S::one());
        let away = S::select(value.less(S::zero()), S::one(), S::splat(-0.5));
        let change = S::select(rising, newton, away).larger(S::splat(-0.5)).smaller(S::one());
        t = S::select(open, t + t * change, t);
        open = S::both(open, S::splat(FOUND).less(change.abs()));
        if !S::any(open) {
            return t;
        }
    }
    S::select(open, S::splat(f64::NAN), t)
}

#[inline(always)]
fn tangent<M: Material<3>, S: Lane, const D: usize>(p: &Parameters<S>, f: &Matrix<S, D>) -> Tangent<S, D> {
    let space = M::tangent(p, &in_space(f, thickness::<M, S, D>(p, f)));
    let inverse = S::one() / space[2][2][2][2];
    let mut out = no_tangent();
    for i in 0..D {
        for j in 0..D {
            let weight = space[i][j][2][2] * inverse;
            for k in 0..D {
                for l in 0..D {
                    out[i][j][k][l] = space[i][j][k][l] - weight * space[2][2][k][l];
                }
            }
        }
    }
    out
}

impl<M: Material<3>> Material<2> for PlaneStress<M> {
    const NAME: &'static str = M::NAME;
    #[inline(always)]
    fn energy_and_stress<S: Lane>(p: &Parameters<S>, f: &Matrix<S, 2>) -> (S, Matrix<S, 2>) {
        let (energy, space) = M::energy_and_stress(p, &in_space(f, thickness::<M, S, 2>(p, f)));
        (energy, [[space[0][0], space[0][1]], [space[1][0], space[1][1]]])
    }
    #[inline(always)]
    fn tangent<S: Lane>(p: &Parameters<S>, f: &Matrix<S, 2>) -> Tangent<S, 2> {
        tangent::<M, S, 2>(p, f)
    }
    #[inline(always)]
    fn clamped_tangent<S: Lane>(p: &Parameters<S>, f: &Matrix<S, 2>) -> Tangent<S, 2> {
        let exact = Self::tangent_of(p, f, Definiteness::Exact);
        let mut square = [[S::zero(); 4]; 4];
        for row in 0..4 {
            for column in 0..4 {
                square[row][column] = exact[row / 2][row % 2][column / 2][column % 2];
            }
        }
        let kept = symmetric::positive_part(&square);
        let mut out = no_tangent();
        for row in 0..4 {
            for column in 0..4 {
                out[row / 2][row % 2][column / 2][column % 2] = kept[row][column];
            }
        }
        out
    }
}
