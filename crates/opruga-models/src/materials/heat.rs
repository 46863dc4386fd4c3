//! Thermal expansion: laws for bodies that are warmer or colder than at rest.
//!
//! If a point has expanded by the factor g = 1 + α ΔT in every direction, the law applies to the remaining, elastic deformation:
//!
//! F = g F_e,  ψ_T(F) = g³ ψ(F/g),  P = g² P_e,  ∂P/∂F = g ∂P_e/∂F_e.
//!
//! g³ is the volume of the unconstrained heated body divided by the volume at rest, to which ψ refers. The law of small strain
//! subtracts the thermal strain instead, ψ_T = ψ(ε − αΔT 1). With the law of small strain, this ψ_T equals g² ψ(F/g). Both forms
//! of ψ_T hold in space and for a plate, whose thickness is free to change. In plane strain nothing moves out of the plane, so
//! the elastic stretch in that direction is 1/g, and the law in space is evaluated.
//!
//! # Source
//! Vujošević, Lubarda, "Finite-strain thermoelasticity based on multiplicative decomposition of deformation gradient",
//! Theor. Appl. Mech. 28–29 (2002); for small strain Timoshenko, Goodier, *Theory of elasticity*, chapter 13.

use super::law::Law;
use super::points::{MOST_PACKS, PARAMETERS, PackBuffer, Points};
use opruga_core::potential::Definiteness;
use opruga_math::{Simd, WIDTH};

/// A law in space, or of a plate, with thermal expansion.
#[derive(Debug)]
pub(crate) struct Heated<const D: usize>(pub(crate) Box<dyn Law<D>>);

/// A law in plane strain with thermal expansion: the law in space for points that have expanded, and the law in the plane for
/// all others.
#[derive(Debug)]
pub(crate) struct HeatedSlice {
    pub(crate) plane: Box<dyn Law<2>>,
    pub(crate) space: Box<dyn Law<3>>,
}

/// The growth g of the points of a pack.
fn growths<'a>(points: &Points<'a>, point: usize) -> &'a [f64] {
    &points.parameters[(point * PARAMETERS + PARAMETERS - 1) * WIDTH..][..WIDTH]
}

/// Multiplies some packs of every pack of points by gᵏ, lane by lane.
fn scale(points: &Points<'_>, packs: usize, power: i32, numbers: &mut [f64]) {
    for (point, own) in numbers.chunks_exact_mut(packs * WIDTH).enumerate().take(points.count) {
        let growths = growths(points, point);
        for pack in own.chunks_exact_mut(WIDTH) {
            for (number, growth) in pack.iter_mut().zip(growths) {
                for _ in 0..power {
                    *number *= growth;
                }
                if power < 0 {
                    *number /= growth;
                }
            }
        }
    }
}

/// The power of g in ψ_T.
fn power(turns: bool) -> i32 {
    if turns { 3 } else { 2 }
}

impl<const D: usize> Heated<D> {
    /// The elastic deformation gradients F/g.
    fn elastic(points: &Points<'_>) -> PackBuffer<{ MOST_PACKS * 9 * WIDTH }> {
        let mut out = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        let count = points.count * D * D * WIDTH;
        out.0[..count].copy_from_slice(&points.gradient[..count]);
        scale(points, D * D, -1, &mut out.0);
        out
    }
}

impl<const D: usize> Law<D> for Heated<D> {
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]) {
        let gradient = Heated::<D>::elastic(&points);
        self.0.stress(simd, Points { gradient: &gradient.0, ..points }, energy, stress);
        let power = power(self.turns());
        scale(&points, 1, power, energy);
        scale(&points, D * D, power - 1, stress);
    }
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]) {
        let gradient = Heated::<D>::elastic(&points);
        self.0.tangent(simd, Points { gradient: &gradient.0, ..points }, keep, tangent);
        scale(&points, D * D * D * D, power(self.turns()) - 2, tangent);
    }
    fn thickness(&self, simd: Simd, points: Points<'_>, out: &mut [f64]) -> bool {
        let gradient = Heated::<D>::elastic(&points);
        let found = self.0.thickness(simd, Points { gradient: &gradient.0, ..points }, out);
        if found {
            scale(&points, 1, 1, out);
        }
        found
    }
    fn turns(&self) -> bool {
        self.0.turns()
    }
    fn cancels(&self) -> bool {
        self.0.cancels()
    }
}

impl HeatedSlice {
    /// Elastic deformation gradients in space. Nothing moves out of the plane, so the stretch in that direction is 1/g.
    fn raised(points: &Points<'_>) -> PackBuffer<{ MOST_PACKS * 9 * WIDTH }> {
        let mut out = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        for point in 0..points.count {
            for (k, at) in [0, 1, 3, 4].into_iter().enumerate() {
                out.0[(point * 9 + at) * WIDTH..][..WIDTH]
                    .copy_from_slice(&points.gradient[(point * 4 + k) * WIDTH..][..WIDTH]);
            }
            out.0[(point * 9 + 8) * WIDTH..][..WIDTH].fill(1.0);
        }
        scale(points, 9, -1, &mut out.0);
        out
    }

    /// For points that have not expanded, replaces the results of the law in space by the results of the law in the plane. The
    /// result of a body therefore does not depend on the bodies in the other lanes.
    fn keep_what_is_cold(points: &Points<'_>, packs: usize, cold: &[f64], numbers: &mut [f64]) {
        for point in 0..points.count {
            let growths = growths(points, point);
            for pack in 0..packs {
                let at = (point * packs + pack) * WIDTH;
                for l in (0..WIDTH).filter(|l| growths[*l] == 1.0) {
                    numbers[at + l] = cold[at + l];
                }
            }
        }
    }

    fn has_cold(points: &Points<'_>) -> bool {
        (0..points.count).any(|point| growths(points, point).contains(&1.0))
    }
}

impl Law<2> for HeatedSlice {
    fn stress(&self, simd: Simd, points: Points<'_>, energy: &mut [f64], stress: &mut [f64]) {
        let gradient = HeatedSlice::raised(&points);
        let mut in_space = PackBuffer([0.0; MOST_PACKS * 9 * WIDTH]);
        self.space.stress(simd, Points { gradient: &gradient.0, ..points }, energy, &mut in_space.0);
        for point in 0..points.count {
            for (k, at) in [0, 1, 3, 4].into_iter().enumerate() {
                stress[(point * 4 + k) * WIDTH..][..WIDTH]
                    .copy_from_slice(&in_space.0[(point * 9 + at) * WIDTH..][..WIDTH]);
            }
        }
        let power = power(self.turns());
        scale(&points, 1, power, energy);
        scale(&points, 4, power - 1, stress);
        if HeatedSlice::has_cold(&points) {
            let mut cold = (PackBuffer([0.0; MOST_PACKS * WIDTH]), PackBuffer([0.0; MOST_PACKS * 4 * WIDTH]));
            self.plane.stress(simd, points, &mut cold.0.0, &mut cold.1.0);
            HeatedSlice::keep_what_is_cold(&points, 1, &cold.0.0, energy);
            HeatedSlice::keep_what_is_cold(&points, 4, &cold.1.0, stress);
        }
    }
    fn tangent(&self, simd: Simd, points: Points<'_>, keep: Definiteness, tangent: &mut [f64]) {
        let gradient = HeatedSlice::raised(&points);
        let mut in_space = PackBuffer([0.0; MOST_PACKS * 81 * WIDTH]);
        self.space.tangent(simd, Points { gradient: &gradient.0, ..points }, keep, &mut in_space.0);
        // A diagonal block of a matrix without negative eigenvalues has none either.
        for point in 0..points.count {
            for (row, from) in [0, 1, 3, 4].into_iter().enumerate() {
                for (column, at) in [0, 1, 3, 4].into_iter().enumerate() {
                    tangent[((point * 4 + row) * 4 + column) * WIDTH..][..WIDTH]
                        .copy_from_slice(&in_space.0[((point * 9 + from) * 9 + at) * WIDTH..][..WIDTH]);
                }
            }
        }
        scale(&points, 16, power(self.turns()) - 2, tangent);
        if HeatedSlice::has_cold(&points) {
            let mut cold = PackBuffer([0.0; MOST_PACKS * 16 * WIDTH]);
            self.plane.tangent(simd, points, keep, &mut cold.0);
            HeatedSlice::keep_what_is_cold(&points, 16, &cold.0, tangent);
        }
    }
    fn turns(&self) -> bool {
        self.space.turns()
    }
    fn cancels(&self) -> bool {
        self.space.cancels()
    }
}
