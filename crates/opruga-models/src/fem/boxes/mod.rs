//! The work on quadrilaterals and hexahedra, compiled for every set of vector instructions.
//!
//! A cell has the mean deformation gradient F and hourglass amplitudes gₐ. The law is evaluated at the Gauss points, with
//!
//! F_q = F (1 + ε_q),  ε_q = Σ_s βₛ f_s(q) D_s,  β = X q,  qₐ = F⁻¹ gₐ,
//!
//! where ε_q is the strain of the assumed stresses ([`super::hourglass`]), rotated and stretched with F. The energy of the cell
//! is
//!
//! U = Σ_q V_q ψ(F_q; μ, λ′) + V ψ(F; 0, λ − λ′) + ½ (λ − λ′) Σ_q V_q tr² ε_q + ½ (1 − s) Σ kₐ gₐ·gₐ,  λ′ = min(λ, 2μ):
//!
//! All laws are linear in μ and λ, so the volumetric stiffness beyond λ′ can be separated. This separate stiffness acts on the
//! mean F, since no cell with so few corners could bend much and keep the volume of every point. F⁻¹ is replaced by cof Fᵀ φ(J)
//! with φ = J/(J² + δ² (1 − J)²). The replacement equals F⁻¹ at rest, is close to it while the cell has a volume, and goes to
//! zero with the volume. Then s = Jφ goes to zero too, and an isotropic stiffness replaces the law. In space, (J − 3/2)³ times
//! that stiffness is added above 3/2 of the rest volume. Under `linear`, which does not account for rotations, F_q is F + ε_q
//! and q is g. In plane stress λ′ is λ.

mod columns;
mod corners;
mod deform;
mod hourglass;
mod layout;
mod matrices;
mod pattern;
mod push;
mod rest;

pub(super) use deform::{Deform, DeformRates};
pub(super) use layout::{Boxes, Plan};
pub(super) use matrices::{Contract, Of};
pub(super) use push::{Push, Rates};

use crate::materials::points::{read_matrix, write_matrix};
use hourglass::{MOST_MODES, MOST_STRESSES, modes};
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Register, WIDTH};

/// δ². Cells that have lost most of their volume also lose the bending stiffness of the law.
const FLAT: f64 = 0.01;

/// Hexahedra above this volume ratio are guarded against spurious modes. The strain ε of the assumed stresses is symmetric, so
/// a shear in it reduces det (1 + ε), while a true shear does not. Under a tension p from all sides, this adds −½ p J tr ε² to
/// the energy. In confined bars, this term exceeds the resistance of the law from J = 2.3 on.
const SWOLLEN: f64 = 1.5;

/// The numbers of a cell that are kept between the steps of a pass: F, g and β.
pub(super) const KEPT: usize = 9 + MOST_MODES * 3 + MOST_STRESSES;

/// Amplitudes, or quantities that belong to them, mode by mode.
pub(super) type Modes<R, const D: usize> = [[R; D]; MOST_MODES];

/// Factors of the assumed stresses, or quantities that belong to them.
pub(super) type Stresses<R> = [R; MOST_STRESSES];

/// The derivative of cof F in the direction Z. It is symmetric in F and Z.
#[inline(always)]
pub(super) fn cofactor_along<R: Lane, const D: usize>(f: &Matrix<R, D>, z: &Matrix<R, D>) -> Matrix<R, D> {
    if D == 2 {
        return matrix::cofactor(z);
    }
    let mut out = matrix::zeros::<R, D>();
    for i in 0..D {
        for j in 0..D {
            let (k, m) = ((i + 1) % D, (i + 2) % D);
            let (l, n) = ((j + 1) % D, (j + 2) % D);
            out[i][j] = f[k][l] * z[m][n] + z[k][l] * f[m][n] - f[k][n] * z[m][l] - z[k][n] * f[m][l];
        }
    }
    out
}

/// cof F, φ and 1 − s of a deformation gradient, with their derivatives by J.
pub(super) struct Frame<R, const D: usize> {
    pub(super) cofactors: Matrix<R, D>,
    pub(super) phi: [R; 3],
    /// 1 − s, −s′, −s″.
    pub(super) lost: [R; 3],
}

impl<R: Lane, const D: usize> Frame<R, D> {
    #[inline(always)]
    pub(super) fn new(f: &Matrix<R, D>) -> Self {
        let cofactors = matrix::cofactor(f);
        let j = matrix::determinant_by(f, &cofactors);
        let (flat, two) = (R::splat(FLAT), R::splat(2.0));
        let change = R::one() - j;
        let inverse = R::one() / (j * j + flat * change * change);
        let slope = two * (j - flat * change);
        let bend = R::splat(2.0 * (1.0 + FLAT));
        let phi = j * inverse;
        let first = inverse - phi * slope * inverse;
        let second = (two * slope * slope * phi * inverse - two * slope * inverse - phi * bend) * inverse;
        let mut lost = [flat * change * change * inverse, -(phi + j * first), -(two * first + j * second)];
        let beyond = j - R::splat(SWOLLEN);
        let swollen = R::zero().less(beyond);
        let square = beyond * beyond;
        let more = [square * beyond, R::splat(3.0) * square, R::splat(6.0) * beyond];
        // In the plane the assumed strains contain hardly any shear.
        for (lost, more) in lost.iter_mut().zip(more).take(if D == 3 { 3 } else { 0 }) {
            *lost = R::select(swollen, *lost + more, *lost);
        }
        Frame { cofactors, phi: [phi, first, second], lost }
    }
    /// The transposed cofactors times the amplitudes.
    #[inline(always)]
    fn pulled(cofactors: &Matrix<R, D>, modes: usize, g: &Modes<R, D>) -> Modes<R, D> {
        let mut out = [[R::zero(); D]; MOST_MODES];
        for mode in 0..modes {
            for k in 0..D {
                for j in 0..D {
                    out[mode][k] += cofactors[j][k] * g[mode][j];
                }
            }
        }
        out
    }
}

/// F, g and β of one part of a pack.
pub(super) struct Kept<R, const D: usize> {
    f: Matrix<R, D>,
    g: Modes<R, D>,
    beta: Stresses<R>,
}

impl<R: Register, const D: usize> Kept<R, D> {
    #[inline(always)]
    pub(super) fn read<const N: usize>(from: &[f64], part: usize) -> Self {
        let at = |k: usize| R::load(&from[k * WIDTH + part * R::NUMBERS..]);
        let (mut g, mut beta) = ([[R::zero(); D]; MOST_MODES], [R::zero(); MOST_STRESSES]);
        for k in 0..modes::<D, N>() * D {
            g[k / D][k % D] = at(9 + k);
            beta[k] = at(9 + MOST_MODES * 3 + k);
        }
        Kept { f: read_matrix(from, part), g, beta }
    }
    #[inline(always)]
    fn write<const N: usize>(&self, to: &mut [f64], part: usize) {
        write_matrix(to, part, &self.f);
        for k in 0..modes::<D, N>() * D {
            self.g[k / D][k % D].store(&mut to[(9 + k) * WIDTH + part * R::NUMBERS..]);
            self.beta[k].store(&mut to[(9 + MOST_MODES * 3 + k) * WIDTH + part * R::NUMBERS..]);
        }
    }
}
