//! The distribution of a force per volume to the nodes of cells: ∫ Nₐ dV with the shape functions of the cells.

use crate::geometry::{Point, lift};
use crate::quadratic::{TETRAHEDRON_EDGES, tetrahedron_jacobian};
use crate::sides::{side_points, side_vector};
use crate::{Element, Mesh};
use std::collections::{BTreeMap, BTreeSet};

/// Gauss points and weights on [0, 1], exact up to degree 7, because a collapsed tetrahedron has products of degree 7.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];

/// The integrals ∫ Nₐ dV over a quadratic tetrahedron with curved sides, computed exactly on a box collapsed to a corner (Duffy 1982).
fn of_quadratic_tetrahedron(x: &[Point; 10]) -> [f64; 10] {
    let mut out = [0.0; 10];
    for (a, of_a) in GAUSS {
        for (b, of_b) in GAUSS {
            for (c, of_c) in GAUSS {
                let (second, third) = ((1.0 - a) * b, (1.0 - a) * (1.0 - b) * c);
                let at = [1.0 - a - second - third, a, second, third];
                let weight = of_a * of_b * of_c * (1.0 - a) * (1.0 - a) * (1.0 - b) * tetrahedron_jacobian(x, at);
                for (corner, l) in at.iter().enumerate() {
                    out[corner] += weight * l * (2.0 * l - 1.0);
                }
                for (side, [i, j]) in TETRAHEDRON_EDGES.into_iter().enumerate() {
                    out[4 + side] += weight * 4.0 * at[i] * at[j];
                }
            }
        }
    }
    out
}

/// The integrals ∫ Nₐ dV over a hexahedron, computed exactly with two Gauss points along every axis.
fn of_hexahedron(x: &[Point; 8]) -> [f64; 8] {
    /// The corners of the reference box [0, 1]³.
    const CORNERS: [[usize; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let gauss = [0.5 - 0.5 / 3.0f64.sqrt(), 0.5 + 0.5 / 3.0f64.sqrt()];
    let mut out = [0.0; 8];
    for point in CORNERS {
        let at = point.map(|k| gauss[k]);
        let factor = |corner: usize, d: usize| if CORNERS[corner][d] == 1 { at[d] } else { 1.0 - at[d] };
        let mut by = [[0.0; 3]; 3];
        for (corner, x) in x.iter().enumerate() {
            for (d, by) in by.iter_mut().enumerate() {
                let sign = if CORNERS[corner][d] == 1 { 1.0 } else { -1.0 };
                let slope = sign * factor(corner, (d + 1) % 3) * factor(corner, (d + 2) % 3);
                (0..3).for_each(|i| by[i] += slope * x[i]);
            }
        }
        let [a, b, c] = by;
        let jacobian = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        for (corner, out) in out.iter_mut().enumerate() {
            *out += 0.125 * jacobian * factor(corner, 0) * factor(corner, 1) * factor(corner, 2);
        }
    }
    out
}

impl<const D: usize> Mesh<D> {
    /// The integral of the shape functions ∫ Nₐ dV [m², m³] over the cells whose nodes are all selected, for every node of these cells. Multiplied by
    /// a force per volume, this integral gives the nodal forces that do the same work in every motion of the cells.
    ///
    /// The values add up to the measure of these cells. Corners of quadratic tetrahedra have negative values, which is correct: the nodes at the
    /// midpoints of their edges have larger ones. Node numbers beyond the last node are ignored.
    pub fn cell_shares(&self, selected: &[u32]) -> BTreeMap<u32, f64> {
        let chosen: BTreeSet<u32> = selected.iter().copied().collect();
        let mut shares = BTreeMap::new();
        for (element, _, nodes) in self.cells.iter() {
            if !nodes.iter().all(|node| chosen.contains(node)) {
                continue;
            }
            let mut x: [Point; 10] = [[0.0; 3]; 10];
            for (x, node) in x.iter_mut().zip(nodes) {
                *x = lift(&self.positions[*node as usize]);
            }
            let mut own = [0.0; 10];
            match element {
                Element::QuadraticTetrahedron => own = of_quadratic_tetrahedron(&x),
                Element::Hexahedron => {
                    let [a, b, c, d, e, f, g, h, ..] = x;
                    own[..8].copy_from_slice(&of_hexahedron(&[a, b, c, d, e, f, g, h]));
                }
                Element::Tetrahedron => own[..4].fill(0.25 * self.size_of(nodes, element)),
                // Cells in the plane are treated as sides in space that lie in the plane.
                _ => {
                    for point in side_points(3, nodes.len()) {
                        let area = side_vector(&point, &x[..nodes.len()])[2];
                        own.iter_mut().zip(point.shape).for_each(|(own, shape)| *own += point.weight * area * shape);
                    }
                }
            }
            for (node, share) in nodes.iter().zip(own) {
                *shares.entry(*node).or_insert(0.0) += share;
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares reproduce ∫ 1 and ∫ x for cells of every kind, straight and curved, so a force per volume has the right sum and moment.
    #[test]
    fn shares_have_the_volume_and_the_centre_of_the_cells() {
        let plate = Mesh::<2>::grid([0.0; 2], [1.0, 1.2], [3, 2]).unwrap();
        let block = Mesh::<3>::grid([0.0; 3], [1.0, 1.2, 0.8], [2, 3, 2]).unwrap();
        let simplices = plate.clone().into_simplices().unwrap();
        for mut mesh in [plate, simplices.clone(), simplices.into_quadratic().unwrap()] {
            let bent = |x: [f64; 2]| [x[0] + 0.1 * x[1] * x[1], x[1] - 0.2 * x[0] * x[0]];
            mesh.positions.iter_mut().for_each(|x| *x = bent(*x));
            check(&mesh);
        }
        let simplices = block.clone().into_simplices().unwrap();
        for mut mesh in [block, simplices.clone(), simplices.into_quadratic().unwrap()] {
            let bent = |x: [f64; 3]| [x[0] + 0.1 * x[1] * x[2], x[1] - 0.2 * x[0] * x[0], x[2] + 0.15 * x[0] * x[1]];
            mesh.positions.iter_mut().for_each(|x| *x = bent(*x));
            check(&mesh);
        }
    }

    /// By Gauss's theorem over the boundary: ∫ dV = ∮ x n dA / D, ∫ xᵢ dV = ∮ ½ xᵢ² nᵢ dA.
    fn check<const D: usize>(mesh: &Mesh<D>) {
        let all: Vec<u32> = (0..mesh.nodes() as u32).collect();
        let shares = mesh.cell_shares(&all);
        let (mut volume, mut moment) = (0.0, [0.0; D]);
        for side in mesh.boundary_sides(&all) {
            let x: Vec<[f64; D]> = side.iter().map(|&node| mesh.positions[node as usize]).collect();
            // Many points are used, because the degree of ½ x² n is higher than that for which sides are integrated exactly.
            for (weight, at, n) in fine(&x) {
                for d in 0..D {
                    volume += weight * at[d] * n[d] / D as f64;
                    moment[d] += 0.5 * weight * at[d] * at[d] * n[d];
                }
            }
        }
        let sum: f64 = shares.values().sum();
        assert!((sum - volume).abs() < 1e-6, "{sum} {volume}");
        for d in 0..D {
            let found: f64 = shares.iter().map(|(node, share)| share * mesh.positions[*node as usize][d]).sum();
            assert!((found - moment[d]).abs() < 1e-6, "{found} {}", moment[d]);
        }
    }

    /// Weight, position and area vector at many points of a side.
    fn fine<const D: usize>(x: &[[f64; D]]) -> Vec<(f64, [f64; D], [f64; D])> {
        // Midpoint rule on small parts, and Richardson extrapolation to parts of size zero.
        let at = |parts: usize| -> Vec<(f64, [f64; D], [f64; D])> {
            let mut out = Vec::new();
            let h = 1.0 / parts as f64;
            for i in 0..parts {
                for j in 0..if D == 2 { 1 } else { parts } {
                    let (u, v) = ((i as f64 + 0.5) * h, (j as f64 + 0.5) * h);
                    let triangular = D == 3 && x.len() != 4;
                    let (xi, eta) = if triangular { (u, (1.0 - u) * v) } else { (u, v) };
                    let weight = if D == 2 {
                        h
                    } else if triangular {
                        h * h * (1.0 - u)
                    } else {
                        h * h
                    };
                    let point = crate::sides::at(D, x.len(), xi, eta);
                    let place = core::array::from_fn(|d| point.shape.iter().zip(x).map(|(n, x)| n * x[d]).sum());
                    out.push((weight, place, side_vector(&point, x)));
                }
            }
            out
        };
        let scaled =
            |list: Vec<(f64, [f64; D], [f64; D])>, by: f64| list.into_iter().map(move |(w, x, n)| (by * w, x, n));
        scaled(at(32), 4.0 / 3.0).chain(scaled(at(16), -1.0 / 3.0)).collect()
    }

    #[test]
    fn cells_that_are_not_selected_whole_give_nothing() {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 1]).unwrap();
        assert!(mesh.cell_shares(&[0, 1]).is_empty());
        let left: Vec<u32> = (0..6).filter(|node| mesh.positions[*node as usize][0] < 0.75).collect();
        let shares = mesh.cell_shares(&left);
        assert_eq!((shares.len(), shares.values().sum::<f64>()), (4, 0.5));
    }
}
