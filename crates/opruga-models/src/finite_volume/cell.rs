//! Dual faces of cells: their location and their area vectors.
//!
//! Every edge (i, j) of a cell has one dual face between the parts of the cell that belong to i and to j. In the plane the dual
//! face is the segment from the midpoint of the edge to the centre of the cell. In space the dual face is the quadrilateral
//! through the midpoint of the edge, the centres of the two adjacent sides, and the centre of the cell. The area vector of the
//! dual face points from i to j.
//!
//! ```text
//!  3 ──── 2      3           quadrilaterals counter-clockwise; hexahedra 0123 below
//!  │  │   │      │ ╲         and 4567 above; triangles counter-clockwise; tetrahedra
//!  ├──┼───┤      │  ╲        with det (x₁ − x₀, x₂ − x₀, x₃ − x₀) > 0
//!  │  │   │      │ ╱╲
//!  0 ──── 1      0 ──── 1
//! ```

use opruga_math::matrix::{self, Matrix};

/// A kind of cells with N nodes.
pub(super) trait Cell<const D: usize, const N: usize>: Copy + core::fmt::Debug + Send + Sync + 'static {
    /// Whether F is constant in the cell.
    const SIMPLEX: bool;
    /// The nodes of every edge.
    const EDGES: &'static [[usize; 2]];
    /// For cells in space, the other corners of the two sides that meet at each edge: two lists for each edge.
    const SIDES: &'static [[&'static [usize]; 2]];
    /// ∂Nₐ/∂ξ at the centre of every dual face, or a single entry if F is constant.
    const SLOPES: &'static [[[f64; D]; N]];
    /// The number of points at which F is evaluated.
    const POINTS: usize = Self::SLOPES.len();
}

/// Triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle;
impl Cell<2, 3> for Triangle {
    const SIMPLEX: bool = true;
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [1, 2], [2, 0]];
    const SIDES: &'static [[&'static [usize]; 2]] = &[];
    const SLOPES: &'static [[[f64; 2]; 3]] = &[[[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]];
}

/// Tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tetrahedron;
impl Cell<3, 4> for Tetrahedron {
    const SIMPLEX: bool = true;
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
    const SIDES: &'static [[&'static [usize]; 2]] =
        &[[&[2], &[3]], [&[1], &[3]], [&[1], &[2]], [&[0], &[3]], [&[0], &[2]], [&[0], &[1]]];
    const SLOPES: &'static [[[f64; 3]; 4]] = &[[[-1.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]];
}

/// Quadrilateral.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quadrilateral;
const QUADRILATERAL: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
impl Cell<2, 4> for Quadrilateral {
    const SIMPLEX: bool = false;
    const EDGES: &'static [[usize; 2]] = &QUADRILATERAL;
    const SIDES: &'static [[&'static [usize]; 2]] = &[];
    const SLOPES: &'static [[[f64; 2]; 4]] = &slopes(&QUADRILATERAL);
}

/// Hexahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hexahedron;
const HEXAHEDRON: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];
impl Cell<3, 8> for Hexahedron {
    const SIMPLEX: bool = false;
    const EDGES: &'static [[usize; 2]] = &HEXAHEDRON;
    const SIDES: &'static [[&'static [usize]; 2]] = &[
        [&[2, 3], &[4, 5]],
        [&[0, 3], &[5, 6]],
        [&[0, 1], &[6, 7]],
        [&[1, 2], &[4, 7]],
        [&[6, 7], &[0, 1]],
        [&[4, 7], &[1, 2]],
        [&[4, 5], &[2, 3]],
        [&[5, 6], &[0, 3]],
        [&[1, 5], &[3, 7]],
        [&[0, 4], &[2, 6]],
        [&[1, 5], &[3, 7]],
        [&[0, 4], &[2, 6]],
    ];
    const SLOPES: &'static [[[f64; 3]; 8]] = &slopes(&HEXAHEDRON);
}

/// Corners of the reference box.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// ∂Nₐ/∂ξ of a box at the centre of the dual face of every edge: half-way from the midpoint of the edge to the centre of the box.
const fn slopes<const D: usize, const N: usize, const E: usize>(edges: &[[usize; 2]; E]) -> [[[f64; D]; N]; E] {
    let mut out = [[[0.0; D]; N]; E];
    let mut e = 0;
    while e < E {
        let [i, j] = edges[e];
        let mut a = 0;
        while a < N {
            let mut d = 0;
            while d < D {
                let mut product = 0.5 * CORNERS[a][d];
                let mut k = 0;
                while k < D {
                    if k != d {
                        let at = 0.25 * (CORNERS[i][k] + CORNERS[j][k]);
                        product *= 0.5 * (1.0 + CORNERS[a][k] * at);
                    }
                    k += 1;
                }
                out[e][a][d] = product;
                d += 1;
            }
            a += 1;
        }
        e += 1;
    }
    out
}

/// ∂X/∂ξ of a cell at a point.
pub(super) fn side<const D: usize, const N: usize>(x: &[[f64; D]; N], slopes: &[[f64; D]; N]) -> Matrix<f64, D> {
    let mut out = matrix::zeros();
    for a in 0..N {
        for i in 0..D {
            for j in 0..D {
                out[i][j] += x[a][i] * slopes[a][j];
            }
        }
    }
    out
}

/// ∂ξ/∂X, and det ∂X/∂ξ.
pub(super) fn inverse<const D: usize>(side: &Matrix<f64, D>) -> (Matrix<f64, D>, f64) {
    let cofactors = matrix::cofactor(side);
    let determinant = matrix::determinant_by(side, &cofactors);
    let mut out = matrix::zeros();
    for i in 0..D {
        for j in 0..D {
            out[i][j] = cofactors[j][i] / determinant;
        }
    }
    (out, determinant)
}

/// The area vectors of the dual faces of all edges [m²]; in the plane, they are lengths [m]. Each vector points from the first
/// node of its edge to the second.
pub(super) fn dual_faces<C: Cell<D, N>, const D: usize, const N: usize>(x: &[[f64; D]; N]) -> Vec<[f64; D]> {
    let center = mean(x, 0..N);
    let face = |(number, &[i, j]): (usize, &[usize; 2])| {
        let middle = mean(x, [i, j]);
        let out: [f64; D] = core::array::from_fn(|d| center[d] - middle[d]);
        if D == 2 {
            let mut turned = [0.0; D];
            (turned[0], turned[1]) = (out[1], -out[0]);
            return turned;
        }
        // Half of the cross product of the diagonals, oriented towards the second node.
        let [one, other] = C::SIDES[number].map(|rest| mean(x, rest.iter().copied().chain([i, j])));
        let across: [f64; D] = core::array::from_fn(|d| other[d] - one[d]);
        let mut area = [0.0; D];
        for d in 0..D {
            let (p, q) = ((d + 1) % D, (d + 2) % D);
            area[d] = 0.5 * (out[p] * across[q] - out[q] * across[p]);
        }
        let along: f64 = (0..D).map(|d| area[d] * (x[j][d] - x[i][d])).sum();
        if along < 0.0 { area.map(|a| -a) } else { area }
    };
    C::EDGES.iter().enumerate().map(face).collect()
}

/// The mean of some corners.
fn mean<const D: usize, const N: usize>(x: &[[f64; D]; N], of: impl IntoIterator<Item = usize>) -> [f64; D] {
    let (mut sum, mut count) = ([0.0; D], 0.0);
    for a in of {
        for d in 0..D {
            sum[d] += x[a][d];
        }
        count += 1.0;
    }
    sum.map(|s| s / count)
}

/// The volume of a cell from its dual faces, by the divergence theorem: (1/D) Σ S·(xⱼ − xᵢ) [m³].
pub(super) fn volume<C: Cell<D, N>, const D: usize, const N: usize>(x: &[[f64; D]; N], faces: &[[f64; D]]) -> f64 {
    let along = |(&[i, j], face): (&[usize; 2], &[f64; D])| (0..D).map(|d| face[d] * (x[j][d] - x[i][d])).sum::<f64>();
    C::EDGES.iter().zip(faces).map(along).sum::<f64>() / D as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The part of a cell around a node is closed: the area vectors of its dual faces and of its shares of the outer sides sum to
    /// zero. So Σ S ⊗ (xⱼ − xᵢ) over the edges of a simplex equals the volume of the simplex times the unit matrix.
    fn check<C: Cell<D, N>, const D: usize, const N: usize>(x: [[f64; D]; N], measure: f64, is_exact: bool) {
        let faces = dual_faces::<C, D, N>(&x);
        assert!(
            !is_exact || (volume::<C, D, N>(&x, &faces) - measure).abs() < 1e-14,
            "{}",
            volume::<C, D, N>(&x, &faces)
        );
        for i in 0..D {
            for j in 0..D {
                let along = |(&[a, b], face): (&[usize; 2], &[f64; D])| face[i] * (x[b][j] - x[a][j]);
                let sum: f64 = C::EDGES.iter().zip(&faces).map(along).sum();
                let expected = if i == j { measure } else { 0.0 };
                assert!(!C::SIMPLEX || (sum - expected).abs() < 1e-14, "{sum}");
            }
        }
        // The shape functions sum to one everywhere.
        for slopes in C::SLOPES {
            for d in 0..D {
                assert!(slopes.iter().map(|s| s[d]).sum::<f64>().abs() < 1e-15);
            }
        }
    }

    #[test]
    fn dual_faces_close_the_part_of_a_node() {
        check::<Triangle, 2, 3>([[0.1, 0.2], [1.3, 0.1], [0.4, 0.9]], 0.5 * (1.2 * 0.7 + 0.3 * 0.1), true);
        check::<Quadrilateral, 2, 4>([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], 2.0, true);
        check::<Tetrahedron, 3, 4>([[0.0; 3], [2.0, 0.0, 0.0], [0.3, 1.0, 0.0], [0.1, 0.2, 1.5]], 0.5, true);
        let cube = CORNERS.map(|c| [0.5 * c[0], c[1], 1.5 * c[2]]);
        check::<Hexahedron, 3, 8>(cube, 6.0, true);
        let mut bent = cube;
        bent[6] = [0.9, 1.2, 1.4];
        check::<Hexahedron, 3, 8>(bent, 0.0, false);
    }
}
