//! Materials behind one call per handful of points, so that elements and materials are compiled once each and not in pairs.
//!
//! Elements write deformation gradients of some packs of points into a buffer of the first-level cache, a law makes
//! stresses of them, elements make forces of these: two calls for 64 points cost less than a nanosecond per point.

use super::material::{Material, Parameters, Tangent};
use core::fmt::Debug;
use opruga_core::potential::Definiteness;
use opruga_math::matrix::Matrix;
use opruga_math::{Pack, Register, Simd, WIDTH, Work};

/// Numbers of [`Parameters`] at a point.
pub(super) const PARAMETERS: usize = 3;

/// Packs of points: for each pack D² packs of F, row by row, and [`PARAMETERS`] packs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'a> {
    /// Packs.
    pub(super) count: usize,
    /// Deformation gradients.
    pub(super) gradient: &'a [f64],
    /// Parameters.
    pub(super) parameters: &'a [f64],
}

/// A material as elements see it.
pub(super) trait Law<const D: usize>: Send + Sync + Debug {
    /// Energy densities (one pack per pack of points) and stresses (D² packs).
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]);
    /// Tangents (D⁴ packs per pack of points).
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]);
}

/// A material as a law.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lift<M>(pub(super) M);

impl<M: Material<D>, const D: usize> Law<D> for Lift<M> {
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]) {
        simd.run(Stress::<M, D> { points, energy, stress, material: self.0 });
    }
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]) {
        match keep {
            Definiteness::Exact => simd.run(Tangents::<M, D, false> { points, tangent, material: self.0 }),
            Definiteness::Clamped => simd.run(Tangents::<M, D, true> { points, tangent, material: self.0 }),
        }
    }
}

/// The numbers of a part of a pack of points.
#[inline(always)]
fn read<R: Register, const D: usize>(points: &Points<'_>, pack: usize, part: usize) -> (Parameters<R>, Matrix<R, D>) {
    let own = &points.parameters[pack * PARAMETERS * WIDTH..(pack + 1) * PARAMETERS * WIDTH];
    let at = |k: usize| R::load(&own[k * WIDTH + part * R::NUMBERS..]);
    let parameters = Parameters { mu: at(0), lambda: at(1), own: at(2) };
    (parameters, read_matrix(&points.gradient[pack * D * D * WIDTH..(pack + 1) * D * D * WIDTH], part))
}

/// A part of D² packs, row by row.
#[inline(always)]
pub(super) fn read_matrix<R: Register, const D: usize>(from: &[f64], part: usize) -> Matrix<R, D> {
    let from = &from[..D * D * WIDTH];
    let mut out = [[R::zero(); D]; D];
    for i in 0..D {
        for j in 0..D {
            out[i][j] = R::load(&from[(i * D + j) * WIDTH + part * R::NUMBERS..]);
        }
    }
    out
}

/// Writes a part of D² packs.
#[inline(always)]
pub(super) fn write_matrix<R: Register, const D: usize>(to: &mut [f64], part: usize, matrix: &Matrix<R, D>) {
    let to = &mut to[..D * D * WIDTH];
    for i in 0..D {
        for j in 0..D {
            matrix[i][j].store(&mut to[(i * D + j) * WIDTH + part * R::NUMBERS..]);
        }
    }
}

struct Stress<'a, M, const D: usize> {
    points: Points<'a>,
    energy: &'a mut [f64],
    stress: &'a mut [f64],
    #[allow(dead_code)] // says which material
    material: M,
}
impl<M: Material<D>, const D: usize> Work for Stress<'_, M, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for pack in 0..self.points.count {
            for part in 0..P::PARTS {
                let (p, f) = read::<P::Part, D>(&self.points, pack, part);
                let (energy, stress) = M::energy_and_stress(&p, &f);
                energy.store(&mut self.energy[pack * WIDTH + part * P::Part::NUMBERS..]);
                write_matrix(&mut self.stress[pack * D * D * WIDTH..], part, &stress);
            }
        }
    }
}

struct Tangents<'a, M, const D: usize, const CLAMPED: bool> {
    points: Points<'a>,
    tangent: &'a mut [f64],
    #[allow(dead_code)] // says which material
    material: M,
}
impl<M: Material<D>, const D: usize, const CLAMPED: bool> Work for Tangents<'_, M, D, CLAMPED> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let keep = if CLAMPED { Definiteness::Clamped } else { Definiteness::Exact };
        for pack in 0..self.points.count {
            let out = &mut self.tangent[pack * D * D * D * D * WIDTH..(pack + 1) * D * D * D * D * WIDTH];
            for part in 0..P::PARTS {
                let (p, f) = read::<P::Part, D>(&self.points, pack, part);
                let tangent: Tangent<P::Part, D> = M::tangent_of(&p, &f, keep);
                for i in 0..D {
                    for j in 0..D {
                        write_matrix(&mut out[(i * D + j) * D * D * WIDTH..], part, &tangent[i][j]);
                    }
                }
            }
        }
    }
}
