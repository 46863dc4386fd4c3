//! The elements: shape functions on reference cells, and their integration points.
//!
//! Nodes are numbered as in [`opruga_mesh::Cells`]. Reference simplices have the corner 0 at the origin and the others at the
//! unit vectors. Reference boxes are [−1, 1]ᴰ.

use core::fmt::Debug;
use opruga_mesh::{TETRAHEDRON_EDGES, TETRAHEDRON_SHARES, TRIANGLE_SHARES, TRIANGLE_SIDES};

/// A kind of element with N nodes in D dimensions.
pub(super) trait Shape<const D: usize, const N: usize>: Copy + Debug + Send + Sync + 'static {
    /// The number of integration points for the whole law.
    const POINTS: usize;
    /// The weights of the points. Their sum is the measure of the reference cell.
    const WEIGHTS: &'static [f64];
    /// ∂Nₐ/∂ξ at the points, `[point][node][axis]`.
    const SLOPES: &'static [[[f64; D]; N]];
    /// The number of corners, which is D + 1 in a simplex.
    const CORNERS: usize;
    /// The shape functions and ∂Nₐ/∂ξ at a point of the reference cell.
    fn at(xi: [f64; 3]) -> ([f64; N], [[f64; D]; N]);
    /// The shares of the nodes in the lumped mass of a cell, as [`opruga_mesh::Mesh::lumped_measures`] gives them.
    fn lumped() -> [f64; N] {
        [1.0 / N as f64; N]
    }
    /// Whether ∂x/∂ξ is computed from differences to the first node.
    const SIMPLEX: bool;
    /// Whether the element bends with the assumed strain of [`super::boxes`].
    const BOX: bool = false;
}

/// An element of a mesh, with the data that a section needs.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell<const N: usize> {
    /// The number of the element in the mesh.
    pub(super) number: u32,
    /// The nodes of the element.
    pub(super) nodes: [u32; N],
}

/// (∂X/∂ξ)⁻¹ and det ∂X/∂ξ of the rest shape at a point.
pub(super) fn rest_gradient<const D: usize, const N: usize>(
    rest: &[[f64; D]; N],
    slopes: &[[f64; D]; N],
) -> ([[f64; D]; D], f64) {
    let mut jacobian = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            for a in 0..N {
                jacobian[i][j] += rest[a][i] * slopes[a][j];
            }
        }
    }
    let cofactors = opruga_math::matrix::cofactor(&jacobian);
    let determinant = opruga_math::matrix::determinant_by(&jacobian, &cofactors);
    let mut inverse = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..D {
            inverse[i][j] = cofactors[j][i] / determinant;
        }
    }
    (inverse, determinant)
}

/// λ₀ = 1 − Σ ξ, λᵢ = ξᵢ of a simplex with C corners.
fn barycentric<const C: usize>(xi: [f64; 3]) -> [f64; C] {
    let mut out = [1.0; C];
    for (own, x) in out[1..].iter_mut().zip(xi) {
        *own = x;
    }
    out[0] -= out[1..].iter().sum::<f64>();
    out
}

/// Shape functions of quadratic simplices.
fn quadratic_values<const N: usize, const C: usize>(at: [f64; C], sides: &[[usize; 2]]) -> [f64; N] {
    core::array::from_fn(|a| match a.checked_sub(C) {
        None => at[a] * (2.0 * at[a] - 1.0),
        Some(side) => 4.0 * at[sides[side][0]] * at[sides[side][1]],
    })
}

/// Π ½(1 + ξₐξ) at a point.
fn box_values<const D: usize, const N: usize>(at: [f64; 3]) -> [f64; N] {
    core::array::from_fn(|a| (0..D).map(|d| 0.5 * (1.0 + CORNERS[a][d] * at[d])).product())
}

/// A triangle with three nodes and one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle;
impl Shape<2, 3> for Triangle {
    const POINTS: usize = 1;
    const WEIGHTS: &'static [f64] = &[0.5];
    const SLOPES: &'static [[[f64; 2]; 3]] = &[[[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]];
    const SIMPLEX: bool = true;
    const CORNERS: usize = 3;
    fn at(xi: [f64; 3]) -> ([f64; 3], [[f64; 2]; 3]) {
        (barycentric(xi), Self::SLOPES[0])
    }
}

/// A tetrahedron with four nodes and one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tetrahedron;
impl Shape<3, 4> for Tetrahedron {
    const POINTS: usize = 1;
    const WEIGHTS: &'static [f64] = &[1.0 / 6.0];
    const SLOPES: &'static [[[f64; 3]; 4]] = &[[[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
    const SIMPLEX: bool = true;
    const CORNERS: usize = 4;
    fn at(xi: [f64; 3]) -> ([f64; 4], [[f64; 3]; 4]) {
        (barycentric(xi), Self::SLOPES[0])
    }
}

/// ∂λᵢ/∂ξⱼ of barycentric coordinates.
const fn barycentric_slope(i: usize, j: usize) -> f64 {
    if i == 0 {
        -1.0
    } else if i == j + 1 {
        1.0
    } else {
        0.0
    }
}

/// Slopes of quadratic simplices with C corners: λᵢ(2λᵢ − 1) at corners, 4λᵢλⱼ between them.
const fn quadratic_slopes<const D: usize, const N: usize, const C: usize>(
    at: [f64; C],
    sides: &[[usize; 2]],
) -> [[f64; D]; N] {
    let mut out = [[0.0; D]; N];
    let mut axis = 0;
    while axis < D {
        let mut i = 0;
        while i < C {
            out[i][axis] = (4.0 * at[i] - 1.0) * barycentric_slope(i, axis);
            i += 1;
        }
        while i < N {
            let [p, q] = sides[i - C];
            out[i][axis] = 4.0 * (at[p] * barycentric_slope(q, axis) + at[q] * barycentric_slope(p, axis));
            i += 1;
        }
        axis += 1;
    }
    out
}

/// A triangle with six nodes and three points (degree 2).
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadraticTriangle;
impl Shape<2, 6> for QuadraticTriangle {
    const POINTS: usize = 3;
    const WEIGHTS: &'static [f64] = &[1.0 / 6.0; 3];
    const SLOPES: &'static [[[f64; 2]; 6]] = &{
        let (near, far) = (2.0 / 3.0, 1.0 / 6.0);
        [
            quadratic_slopes([near, far, far], &TRIANGLE_SIDES),
            quadratic_slopes([far, near, far], &TRIANGLE_SIDES),
            quadratic_slopes([far, far, near], &TRIANGLE_SIDES),
        ]
    };
    const SIMPLEX: bool = false;
    const CORNERS: usize = 3;
    fn at(xi: [f64; 3]) -> ([f64; 6], [[f64; 2]; 6]) {
        let at = barycentric::<3>(xi);
        (quadratic_values(at, &TRIANGLE_SIDES), quadratic_slopes(at, &TRIANGLE_SIDES))
    }
    fn lumped() -> [f64; 6] {
        TRIANGLE_SHARES
    }
}

/// A tetrahedron with ten nodes and four points (degree 2; Keast 1986).
#[derive(Clone, Copy, Debug)]
pub(super) struct QuadraticTetrahedron;
impl Shape<3, 10> for QuadraticTetrahedron {
    const POINTS: usize = 4;
    const WEIGHTS: &'static [f64] = &[1.0 / 24.0; 4];
    const SLOPES: &'static [[[f64; 3]; 10]] = &{
        // (5 + 3√5)/20 and (5 − √5)/20.
        let (near, far) = (0.585_410_196_624_968_5, 0.138_196_601_125_010_5);
        [
            quadratic_slopes([near, far, far, far], &TETRAHEDRON_EDGES),
            quadratic_slopes([far, near, far, far], &TETRAHEDRON_EDGES),
            quadratic_slopes([far, far, near, far], &TETRAHEDRON_EDGES),
            quadratic_slopes([far, far, far, near], &TETRAHEDRON_EDGES),
        ]
    };
    const SIMPLEX: bool = false;
    const CORNERS: usize = 4;
    fn at(xi: [f64; 3]) -> ([f64; 10], [[f64; 3]; 10]) {
        let at = barycentric::<4>(xi);
        (quadratic_values(at, &TETRAHEDRON_EDGES), quadratic_slopes(at, &TETRAHEDRON_EDGES))
    }
    fn lumped() -> [f64; 10] {
        TETRAHEDRON_SHARES
    }
}

/// The corners of the reference boxes.
pub(super) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Slopes of Π ½(1 + ξₐξ) at a point.
const fn box_slopes<const D: usize, const N: usize>(at: [f64; 3]) -> [[f64; D]; N] {
    let mut out = [[0.0; D]; N];
    let mut a = 0;
    while a < N {
        let mut axis = 0;
        while axis < D {
            let mut value = 1.0;
            let mut d = 0;
            while d < D {
                value *= 0.5 * if d == axis { CORNERS[a][d] } else { 1.0 + CORNERS[a][d] * at[d] };
                d += 1;
            }
            out[a][axis] = value;
            axis += 1;
        }
        a += 1;
    }
    out
}

/// Slopes at the two Gauss points per axis.
const fn gauss_slopes<const D: usize, const N: usize>() -> [[[f64; D]; N]; N] {
    // 1/√3.
    let gauss = 0.577_350_269_189_625_8;
    let mut out = [[[0.0; D]; N]; N];
    let mut q = 0;
    while q < N {
        let corner = CORNERS[q];
        out[q] = box_slopes([gauss * corner[0], gauss * corner[1], gauss * corner[2]]);
        q += 1;
    }
    out
}

/// A quadrilateral with four nodes and 2 × 2 points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadrilateral;
impl Shape<2, 4> for Quadrilateral {
    const POINTS: usize = 4;
    const WEIGHTS: &'static [f64] = &[1.0; 4];
    const SLOPES: &'static [[[f64; 2]; 4]] = &gauss_slopes::<2, 4>();
    const SIMPLEX: bool = false;
    const CORNERS: usize = 4;
    fn at(xi: [f64; 3]) -> ([f64; 4], [[f64; 2]; 4]) {
        (box_values::<2, 4>(xi), box_slopes(xi))
    }
    const BOX: bool = true;
}

/// A hexahedron with eight nodes and 2 × 2 × 2 points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hexahedron;
impl Shape<3, 8> for Hexahedron {
    const POINTS: usize = 8;
    const WEIGHTS: &'static [f64] = &[1.0; 8];
    const SLOPES: &'static [[[f64; 3]; 8]] = &gauss_slopes::<3, 8>();
    const SIMPLEX: bool = false;
    const CORNERS: usize = 8;
    fn at(xi: [f64; 3]) -> ([f64; 8], [[f64; 3]; 8]) {
        (box_values::<3, 8>(xi), box_slopes(xi))
    }
    const BOX: bool = true;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes at every point sum to zero, and reproduce ξ from the nodes of the reference cell.
    fn reproduces<E: Shape<D, N>, const D: usize, const N: usize>(nodes: [[f64; D]; N]) {
        assert_eq!((E::SLOPES.len(), E::WEIGHTS.len()), (E::POINTS, E::POINTS));
        for slopes in E::SLOPES {
            for i in 0..D {
                for j in 0..D {
                    let sum: f64 = (0..N).map(|a| slopes[a][j] * nodes[a][i]).sum();
                    assert!((sum - if i == j { 1.0 } else { 0.0 }).abs() < 1e-15);
                }
                assert!(slopes.iter().map(|s| s[i]).sum::<f64>().abs() < 1e-15);
            }
        }
    }

    #[test]
    fn shape_functions_reproduce_linear_fields() {
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        reproduces::<Triangle, 2, 3>(triangle);
        reproduces::<Tetrahedron, 3, 4>(tetrahedron);
        reproduces::<QuadraticTriangle, 2, 6>(core::array::from_fn(|a| match a {
            0..3 => triangle[a],
            _ => {
                let [p, q] = TRIANGLE_SIDES[a - 3];
                core::array::from_fn(|d| 0.5 * (triangle[p][d] + triangle[q][d]))
            }
        }));
        reproduces::<QuadraticTetrahedron, 3, 10>(core::array::from_fn(|a| match a {
            0..4 => tetrahedron[a],
            _ => {
                let [p, q] = TETRAHEDRON_EDGES[a - 4];
                core::array::from_fn(|d| 0.5 * (tetrahedron[p][d] + tetrahedron[q][d]))
            }
        }));
        reproduces::<Quadrilateral, 2, 4>(core::array::from_fn(|a| [CORNERS[a][0], CORNERS[a][1]]));
        reproduces::<Hexahedron, 3, 8>(CORNERS);
    }

    #[test]
    fn weights_sum_to_the_measure_of_the_reference_cell() {
        let sum = |weights: &[f64]| weights.iter().sum::<f64>();
        assert_eq!((sum(Triangle::WEIGHTS), sum(QuadraticTriangle::WEIGHTS)), (0.5, 0.5));
        assert!((sum(QuadraticTetrahedron::WEIGHTS) - sum(Tetrahedron::WEIGHTS)).abs() < 1e-16);
        assert_eq!((sum(Quadrilateral::WEIGHTS), sum(Hexahedron::WEIGHTS)), (4.0, 8.0));
    }
}
