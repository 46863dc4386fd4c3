//! The consistent mass matrix of cells: ρ ∫ Nₐ Nᵦ dX, minus the lumped masses of the cell.

use super::elements::{Shape, rest_gradient};

/// Gauss points and weights on [0, 1], exact to degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// Points and weights of a reference cell: products of Gauss points. For simplices a side of the box is collapsed to a point
/// (Duffy 1982), and the points then also integrate Nₐ Nᵦ of curved quadratic cells exactly.
fn points<const D: usize>(simplex: bool) -> Vec<([f64; 3], f64)> {
    let mut out = Vec::new();
    for number in 0..GAUSS.len().pow(D as u32) {
        let (mut at, mut weight, mut rest) = ([0.0; 3], 1.0, number);
        for x in at.iter_mut().take(D) {
            let (position, own) = GAUSS[rest % GAUSS.len()];
            *x = position;
            weight *= own;
            rest /= GAUSS.len();
        }
        if simplex {
            // ξ₁ = a, ξ₂ = (1 − a) b, ξ₃ = (1 − a)(1 − b) c.
            let mut left = 1.0;
            for (k, x) in at.iter_mut().take(D).enumerate() {
                let share = *x;
                weight *= (0..D - 1 - k).map(|_| 1.0 - share).product::<f64>();
                *x = left * share;
                left *= 1.0 - share;
            }
        } else {
            for x in at.iter_mut().take(D) {
                *x = 2.0 * *x - 1.0;
                weight *= 2.0;
            }
        }
        out.push((at, weight));
    }
    out
}

/// ∫ Nₐ Nᵦ dX of a cell [m, m² or m³].
pub(super) fn of_cell<E: Shape<D, N>, const D: usize, const N: usize>(rest: &[[f64; D]; N]) -> [[f64; N]; N] {
    let mut out = [[0.0; N]; N];
    for (at, weight) in points::<D>(E::CORNERS == D + 1) {
        let (values, slopes) = E::at(at);
        let measure = weight * rest_gradient(rest, &slopes).1;
        for a in 0..N {
            for b in 0..N {
                out[a][b] += measure * values[a] * values[b];
            }
        }
    }
    out
}

/// Entries of the consistent mass matrix of a cell with a given density, minus its lumped masses, as
/// [`opruga_core::potential::Potential::inertia`] gives them.
pub(super) fn entries<E: Shape<D, N>, const D: usize, const N: usize>(
    nodes: &[u32; N],
    rest: &[[f64; D]; N],
    density: f64,
    out: &mut Vec<(u32, u32, f64)>,
) {
    let matrix = of_cell::<E, D, N>(rest);
    let measure: f64 = matrix.as_flattened().iter().sum();
    let lumped = E::lumped();
    for a in 0..N {
        for b in 0..N {
            let less = if a == b { lumped[a] * measure } else { 0.0 };
            out.push((nodes[a], nodes[b], density * (matrix[a][b] - less)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::elements::*;
    use super::*;

    /// The corners of a reference cell, moved by a quadratic map that keeps straight cells straight if `bend` is zero.
    fn cell<E: Shape<D, N>, const D: usize, const N: usize>(nodes: [[f64; D]; N], bend: f64) -> [[f64; D]; N] {
        nodes.map(|x| {
            core::array::from_fn(|i| {
                let (p, q) = (x[i], x[(i + 1) % D]);
                1.5 * p + 0.3 * q + bend * p * q
            })
        })
    }

    /// The sum of a row is ∫ Nₐ. For a linear field, the matrix gives the exact ∫ x² of a cell, whereas the lumped masses of
    /// linear cells overestimate it.
    fn check<E: Shape<D, N>, const D: usize, const N: usize>(nodes: [[f64; D]; N], square: f64) {
        let matrix = of_cell::<E, D, N>(&nodes);
        let mut found = 0.0;
        for a in 0..N {
            for b in 0..N {
                assert!((matrix[a][b] - matrix[b][a]).abs() < 1e-15);
                found += matrix[a][b] * nodes[a][0] * nodes[b][0];
            }
        }
        assert!((found - square).abs() < 1e-14, "{found} {square}");
        let mut entries = Vec::new();
        super::entries::<E, D, N>(&core::array::from_fn(|a| a as u32), &cell::<E, D, N>(nodes, 0.1), 3.0, &mut entries);
        assert!(entries.iter().map(|(_, _, mass)| mass).sum::<f64>().abs() < 1e-13);
        assert!((E::lumped().iter().sum::<f64>() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn linear_fields_have_their_exact_square_in_every_cell() {
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let tetrahedron = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        check::<Triangle, 2, 3>(triangle, 1.0 / 12.0);
        check::<Tetrahedron, 3, 4>(tetrahedron, 1.0 / 60.0);
        check::<QuadraticTriangle, 2, 6>(corners_and_middles(triangle, &opruga_mesh::TRIANGLE_SIDES), 1.0 / 12.0);
        check::<QuadraticTetrahedron, 3, 10>(
            corners_and_middles(tetrahedron, &opruga_mesh::TETRAHEDRON_EDGES),
            1.0 / 60.0,
        );
        check::<Quadrilateral, 2, 4>(core::array::from_fn(|a| [CORNERS[a][0], CORNERS[a][1]]), 4.0 / 3.0);
        check::<Hexahedron, 3, 8>(CORNERS, 8.0 / 3.0);
    }

    fn corners_and_middles<const D: usize, const C: usize, const N: usize>(
        corners: [[f64; D]; C],
        sides: &[[usize; 2]],
    ) -> [[f64; D]; N] {
        core::array::from_fn(|a| match a.checked_sub(C) {
            None => corners[a],
            Some(side) => {
                let [p, q] = sides[side];
                core::array::from_fn(|d| 0.5 * (corners[p][d] + corners[q][d]))
            }
        })
    }

    /// Textbook matrices: V/20 (1 + δ) of the tetrahedron, A/12 (1 + δ) of the triangle, A/180 (6, −1, −4, 0, 32, 16) of the
    /// quadratic triangle (Zienkiewicz and Taylor, appendix).
    #[test]
    fn matrices_are_those_of_the_textbooks() {
        let m = of_cell::<Tetrahedron, 3, 4>(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.5, 0.5, 3.0]]);
        for (a, row) in m.iter().enumerate() {
            for (b, mass) in row.iter().enumerate() {
                assert!((mass - if a == b { 0.1 } else { 0.05 }).abs() < 1e-15, "{m:?}");
            }
        }
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let m = of_cell::<QuadraticTriangle, 2, 6>(&corners_and_middles(corners, &opruga_mesh::TRIANGLE_SIDES));
        let unit = 0.5 / 180.0;
        assert!((m[0][0] - 6.0 * unit).abs() < 1e-16 && (m[0][1] + unit).abs() < 1e-16);
        assert!((m[3][3] - 32.0 * unit).abs() < 1e-16 && (m[3][4] - 16.0 * unit).abs() < 1e-16);
        let sums: [f64; 6] = m.map(|row| row.iter().sum());
        assert!(sums[..3].iter().all(|s| s.abs() < 1e-16), "{sums:?}");
    }
}
