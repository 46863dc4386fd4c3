//! The interface between elements and materials: one call for several points, so that elements and materials are compiled
//! separately and not in pairs.
//!
//! Elements write deformation gradients of some packs of points to a buffer in the first-level cache, a law computes stresses
//! from them, and elements compute forces from these. Two calls for 64 points cost less than a nanosecond per point.

use super::material::Material;
use super::points::{INVARIANTS, MOST_PACKS, PRINCIPAL, PackBuffer, Points, read, write_matrix, write_tangent};
use super::principal_frame::{Clamp, Frames, InFrame, OutOfFrame};
use core::fmt::Debug;
use opruga_core::potential::Definiteness;
use opruga_math::{Lane, Pack, Register, Simd, WIDTH, Work};

/// The interface of a material for elements.
pub(crate) trait Law<const D: usize>: Send + Sync + Debug {
    /// Computes energy densities (one pack per pack of points) and stresses (D² packs).
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]);
    /// Computes tangents (D⁴ packs per pack of points).
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]);
    /// Computes tangents in the shortest form that the law has, and returns that form.
    fn short_tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, out: &mut [f64]) -> Form {
        self.tangent(simd, points, keep, out);
        Form::Whole
    }
    /// Writes the out-of-plane stretch that the law determines at every point (a pack per pack of points). Returns whether the
    /// law determines one.
    fn thickness(&self, _simd: Simd, _points: Points<'_>, _out: &mut [f64]) -> bool {
        false
    }
    /// Whether the law accounts for rotations.
    fn turns(&self) -> bool;
    /// Whether the energy at rest is a difference of terms as large as the moduli.
    fn cancels(&self) -> bool;
}

/// The form of a tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Form {
    /// D⁴ packs per pack of points.
    Whole,
    /// In the frame of the singular vectors: [`PRINCIPAL`] · D² packs per pack of points.
    Principal,
    /// By the invariants of F: [`INVARIANTS`] packs per pack of points, in the order of [`super::material::Invariants`].
    Invariants,
}

/// A material as a law.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lift<M>(pub(crate) M);

impl<M: Material<D>, const D: usize> Law<D> for Lift<M> {
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]) {
        simd.run(Stress::<M, D> { points, energy, stress, material: self.0 });
    }
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]) {
        match keep {
            Definiteness::Exact => simd.run(Tangents::<M, D> { points, tangent, material: self.0 }),
            Definiteness::Clamped => {
                let mut principal = PackBuffer([0.0; MOST_PACKS * PRINCIPAL * 9 * WIDTH]);
                self.principal(simd, points, &mut principal.0);
                simd.run(OutOfFrame::<D> { count: points.count, principal: &principal.0, tangent });
            }
        }
    }
    fn short_tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, out: &mut [f64]) -> Form {
        if keep == Definiteness::Clamped {
            self.principal(simd, points, out);
            return Form::Principal;
        }
        if simd.run(ByInvariants::<M, D> { points, out, material: self.0 }) {
            return Form::Invariants;
        }
        self.tangent(simd, points, keep, out);
        Form::Whole
    }
    fn turns(&self) -> bool {
        M::TURNS
    }
    fn cancels(&self) -> bool {
        M::CANCELS
    }
}

impl<M> Lift<M> {
    /// Computes tangents without negative eigenvalues, in the form [`Form::Principal`].
    fn principal<const D: usize>(&self, simd: Simd, points: Points<'_>, out: &mut [f64])
    where
        M: Material<D>,
    {
        simd.run(Frames::<D> { points, turns: M::TURNS, out });
        simd.run(InFrame::<M, D> { points, out, material: self.0 });
        simd.run(Clamp::<D> { count: points.count, out });
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

struct Tangents<'a, M, const D: usize> {
    points: Points<'a>,
    tangent: &'a mut [f64],
    #[allow(dead_code)] // says which material
    material: M,
}
impl<M: Material<D>, const D: usize> Work for Tangents<'_, M, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        for pack in 0..self.points.count {
            for part in 0..P::PARTS {
                let (p, f) = read::<P::Part, D>(&self.points, pack, part);
                write_tangent(self.tangent, pack, part, &M::tangent(&p, &f));
            }
        }
    }
}

/// Computes the derivatives by invariants, from which the tangent follows. Returns whether the material has them.
struct ByInvariants<'a, M, const D: usize> {
    points: Points<'a>,
    out: &'a mut [f64],
    #[allow(dead_code)] // says which material
    material: M,
}
impl<M: Material<D>, const D: usize> Work for ByInvariants<'_, M, D> {
    type Output = bool;
    #[inline(always)]
    fn run<P: Pack>(self) -> bool {
        for pack in 0..self.points.count {
            let out = &mut self.out[pack * INVARIANTS * WIDTH..(pack + 1) * INVARIANTS * WIDTH];
            for part in 0..P::PARTS {
                let (p, f) = read::<P::Part, D>(&self.points, pack, part);
                let Some(of) = M::invariants(&p, &f) else { return false };
                let twice = of.stretch_twice.unwrap_or(P::Part::zero());
                for (k, number) in [of.stretch, twice, of.volume, of.volume_twice].into_iter().enumerate() {
                    number.store(&mut out[k * WIDTH + part * P::Part::NUMBERS..]);
                }
            }
        }
        true
    }
}
