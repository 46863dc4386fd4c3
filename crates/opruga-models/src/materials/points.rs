//! Data at points of elements, in packs: deformation gradients, parameters and tangents. Functions read and write a part of a
//! pack.

use super::material::{Parameters, Tangent};
use opruga_math::matrix::Matrix;
use opruga_math::{Register, WIDTH};

/// The largest number of packs of points that a law receives together.
pub(crate) const MOST_PACKS: usize = 9;

/// Memory for some packs of points.
#[repr(align(64))]
pub(crate) struct PackBuffer<const SIZE: usize>(pub(crate) [f64; SIZE]);

/// The number of parameters at a point: those of [`Parameters`], and the thermal growth.
pub(crate) const PARAMETERS: usize = 4;

/// Packs of points. Each of them has D² packs of F, row by row, and [`PARAMETERS`] packs of parameters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Points<'a> {
    /// The number of packs.
    pub(crate) count: usize,
    /// Deformation gradients.
    pub(crate) gradient: &'a [f64],
    /// Parameters.
    pub(crate) parameters: &'a [f64],
}

impl<'a> Points<'a> {
    /// The same points, at most [`MOST_PACKS`] packs at a time.
    pub(crate) fn chunks<const D: usize>(self) -> impl Iterator<Item = Points<'a>> {
        (0..self.count).step_by(MOST_PACKS).map(move |first| Points {
            count: MOST_PACKS.min(self.count - first),
            gradient: &self.gradient[first * D * D * WIDTH..],
            parameters: &self.parameters[first * PARAMETERS * WIDTH..],
        })
    }
}

/// The number of values of [`super::material::Invariants`].
pub(crate) const INVARIANTS: usize = 4;

/// The number of matrices of a tangent in the frame of the singular vectors: U, V, the second derivatives by stretches, and for
/// pairs of axes a < b the components of the tangent times u_a v_bᵀ. The component along u_a v_bᵀ is at [a][b], and the
/// component along u_b v_aᵀ is at [b][a].
pub(crate) const PRINCIPAL: usize = 4;

/// Reads the parameters and F of a part of a pack of points.
#[inline(always)]
pub(crate) fn read<R: Register, const D: usize>(
    points: &Points<'_>,
    pack: usize,
    part: usize,
) -> (Parameters<R>, Matrix<R, D>) {
    let own = &points.parameters[pack * PARAMETERS * WIDTH..(pack + 1) * PARAMETERS * WIDTH];
    let at = |k: usize| R::load(&own[k * WIDTH + part * R::NUMBERS..]);
    let parameters = Parameters { mu: at(0), lambda: at(1), own: at(2) };
    (parameters, read_matrix(&points.gradient[pack * D * D * WIDTH..(pack + 1) * D * D * WIDTH], part))
}

/// Reads a part of D² packs, row by row.
#[inline(always)]
pub(crate) fn read_matrix<R: Register, const D: usize>(from: &[f64], part: usize) -> Matrix<R, D> {
    let from = &from[..D * D * WIDTH];
    let mut out = [[R::zero(); D]; D];
    for i in 0..D {
        for j in 0..D {
            out[i][j] = R::load(&from[(i * D + j) * WIDTH + part * R::NUMBERS..]);
        }
    }
    out
}

/// Writes one part of each pack of a D × D matrix.
#[inline(always)]
pub(crate) fn write_matrix<R: Register, const D: usize>(to: &mut [f64], part: usize, matrix: &Matrix<R, D>) {
    let to = &mut to[..D * D * WIDTH];
    for i in 0..D {
        for j in 0..D {
            matrix[i][j].store(&mut to[(i * D + j) * WIDTH + part * R::NUMBERS..]);
        }
    }
}

/// Writes a part of D⁴ packs of a pack of points.
#[inline(always)]
pub(crate) fn write_tangent<R: Register, const D: usize>(
    to: &mut [f64],
    pack: usize,
    part: usize,
    tangent: &Tangent<R, D>,
) {
    for i in 0..D {
        for j in 0..D {
            write_matrix(&mut to[((pack * D + i) * D + j) * D * D * WIDTH..], part, &tangent[i][j]);
        }
    }
}
