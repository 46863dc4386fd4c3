//! Sides of cells on the boundary, on which a pressure acts, and their shape functions.

use crate::Mesh;
use crate::geometry::{HEXAHEDRON_FACES, lift};
use crate::quadratic::{TETRAHEDRON_FACES, TRIANGLE_SIDES};
use std::collections::{BTreeMap, BTreeSet};

/// The maximum number of nodes of a side.
pub const MOST_SIDE_NODES: usize = 6;

/// An integration point of a side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SidePoint {
    /// The weight, in the coordinates of the side.
    pub weight: f64,
    /// The shape functions Nₐ.
    pub shape: [f64; MOST_SIDE_NODES],
    /// The derivatives of the shape functions by the coordinates of the side; only one in the plane.
    pub slope: [[f64; 2]; MOST_SIDE_NODES],
}

/// The shape functions of a side in the plane at ξ from 0 to 1: ends, then the midpoint.
fn edge(nodes: usize, x: f64) -> [(f64, f64); 3] {
    if nodes == 2 {
        [(1.0 - x, -1.0), (x, 1.0), (0.0, 0.0)]
    } else {
        [
            ((1.0 - x) * (1.0 - 2.0 * x), 4.0 * x - 3.0),
            (x * (2.0 * x - 1.0), 4.0 * x - 1.0),
            (4.0 * x * (1.0 - x), 4.0 - 8.0 * x),
        ]
    }
}

/// Shape functions of a triangle at its barycentric coordinates 1 − ξ − η, ξ, η, with slopes.
fn triangle(nodes: usize, x: f64, y: f64) -> [(f64, [f64; 2]); MOST_SIDE_NODES] {
    let l = [1.0 - x - y, x, y];
    let by = [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]];
    core::array::from_fn(|n| match (nodes, n) {
        (3, 0..3) => (l[n], by[n]),
        (3, _) => (0.0, [0.0; 2]),
        (_, 0..3) => (l[n] * (2.0 * l[n] - 1.0), by[n].map(|b| b * (4.0 * l[n] - 1.0))),
        _ => {
            let (i, j) = (n - 3, (n - 2) % 3);
            (4.0 * l[i] * l[j], [0, 1].map(|k| 4.0 * (by[i][k] * l[j] + l[i] * by[j][k])))
        }
    })
}

/// Shape functions of a quadrilateral at ξ, η from 0 to 1, with slopes.
fn quadrilateral(x: f64, y: f64) -> [(f64, [f64; 2]); 4] {
    [
        ((1.0 - x) * (1.0 - y), [y - 1.0, x - 1.0]),
        (x * (1.0 - y), [1.0 - y, -x]),
        (x * y, [y, x]),
        ((1.0 - x) * y, [-y, 1.0 - x]),
    ]
}

/// The integration points of a side with `nodes` nodes in `dimensions` dimensions. With these points, products of a shape function and the area
/// vector ∂x/∂ξ × ∂x/∂η are integrated exactly.
///
/// # Source
/// Gauss; D. A. Dunavant, International Journal for Numerical Methods in Engineering 21 (1985), degree 4.
pub fn side_points(dimensions: usize, nodes: usize) -> Vec<SidePoint> {
    let gauss = [0.5 - 0.5 / 3.0f64.sqrt(), 0.5 + 0.5 / 3.0f64.sqrt()];
    let point = |weight: f64, values: &[(f64, [f64; 2])]| {
        let mut point = SidePoint { weight, shape: [0.0; MOST_SIDE_NODES], slope: [[0.0; 2]; MOST_SIDE_NODES] };
        for (n, (shape, slope)) in values.iter().enumerate() {
            (point.shape[n], point.slope[n]) = (*shape, *slope);
        }
        point
    };
    match (dimensions, nodes) {
        (2, 2) => vec![point(1.0, &edge(2, 0.5).map(|(n, s)| (n, [s, 0.0])))],
        (2, _) => gauss.map(|x| point(0.5, &edge(3, x).map(|(n, s)| (n, [s, 0.0])))).to_vec(),
        (_, 3) => vec![point(0.5, &triangle(3, 1.0 / 3.0, 1.0 / 3.0))],
        (_, 4) => {
            let pairs = gauss.into_iter().flat_map(|x| gauss.map(|y| (x, y)));
            pairs.map(|(x, y)| point(0.25, &quadrilateral(x, y))).collect()
        }
        _ => {
            let rings =
                [(0.223_381_589_678_011, 0.445_948_490_915_965), (0.109_951_743_655_322, 0.091_576_213_509_771)];
            let points = rings.into_iter().flat_map(|(weight, a)| {
                let b = 1.0 - 2.0 * a;
                [(a, a), (a, b), (b, a)].map(|(x, y)| (0.5 * weight, x, y))
            });
            points.map(|(weight, x, y)| point(weight, &triangle(6, x, y))).collect()
        }
    }
}

/// The outward length vector (plane) or area vector (space) of a side at a point: ∂x/∂ξ rotated to the right, or ∂x/∂ξ × ∂x/∂η.
pub fn side_vector<const D: usize>(point: &SidePoint, x: &[[f64; D]]) -> [f64; D] {
    let t = side_tangents(point, x);
    if D == 2 {
        core::array::from_fn(|d| if d == 0 { t[0][1] } else { -t[0][0] })
    } else {
        core::array::from_fn(|d| {
            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
            t[0][e] * t[1][f] - t[0][f] * t[1][e]
        })
    }
}

/// The tangents ∂x/∂ξ and ∂x/∂η of a side at a point.
pub fn side_tangents<const D: usize>(point: &SidePoint, x: &[[f64; D]]) -> [[f64; D]; 2] {
    [0, 1].map(|k| {
        let mut out = [0.0; D];
        for (slope, x) in point.slope.iter().zip(x) {
            for d in 0..D {
                out[d] += slope[k] * x[d];
            }
        }
        out
    })
}

/// The shape functions of a side at given local coordinates, without a weight.
#[cfg(test)]
pub(crate) fn at(dimensions: usize, nodes: usize, x: f64, y: f64) -> SidePoint {
    let values: Vec<(f64, [f64; 2])> = match (dimensions, nodes) {
        (2, _) => edge(nodes, x)[..nodes].iter().map(|(n, s)| (*n, [*s, 0.0])).collect(),
        (_, 4) => quadrilateral(x, y).to_vec(),
        _ => triangle(nodes, x, y)[..nodes].to_vec(),
    };
    let mut point = SidePoint { weight: 0.0, shape: [0.0; MOST_SIDE_NODES], slope: [[0.0; 2]; MOST_SIDE_NODES] };
    for (n, (shape, slope)) in values.into_iter().enumerate() {
        (point.shape[n], point.slope[n]) = (shape, slope);
    }
    point
}

impl<const D: usize> Mesh<D> {
    /// The sides of cells that are on the boundary and whose nodes are all selected, each with its nodes as seen from outside.
    ///
    /// In the plane these are two ends, and the node between them if the cell is quadratic. In space they are the three corners of a triangle, the
    /// four corners of a quadrilateral, or three corners and the nodes between corners 0–1, 1–2, 2–0. Facets without cells are sides themselves. Node
    /// numbers beyond the last node are ignored.
    pub fn boundary_sides(&self, selected: &[u32]) -> Vec<Vec<u32>> {
        let chosen: BTreeSet<u32> = selected.iter().copied().collect();
        // The selected facets that are not part of a side yet: a map from their ascending nodes to their numbers.
        let mut left = BTreeMap::new();
        for (number, facet) in self.facets.iter().enumerate() {
            if facet.iter().all(|node| chosen.contains(node)) {
                left.insert(ascending(facet), number);
            }
        }
        let mut sides: Vec<(usize, Vec<u32>)> = Vec::new();
        let mut take = |nodes: Vec<u32>, parts: &[&[u32]]| {
            let numbers: Vec<usize> = parts.iter().filter_map(|part| left.get(&ascending(part)).copied()).collect();
            if numbers.len() == parts.len()
                && let Some(first) = numbers.iter().min()
            {
                parts.iter().for_each(|part| {
                    left.remove(&ascending(part));
                });
                sides.push((*first, nodes));
            }
        };
        for cell in &self.cells.quadratic_triangles {
            for (side, [i, j]) in TRIANGLE_SIDES.into_iter().enumerate() {
                let [a, b, m] = [cell[i], cell[j], cell[3 + side]];
                take(vec![a, b, m], &[&[a, m], &[m, b]]);
            }
        }
        for cell in &self.cells.quadratic_tetrahedra {
            for face in TETRAHEDRON_FACES {
                let n = face.map(|k| cell[k]);
                take(n.to_vec(), &[&[n[0], n[3], n[5]], &[n[1], n[4], n[3]], &[n[2], n[5], n[4]], &[n[3], n[4], n[5]]]);
            }
        }
        for cell in &self.cells.hexahedra {
            for face in HEXAHEDRON_FACES {
                let n = face.map(|k| cell[k]);
                take(n.to_vec(), &[&[n[0], n[1], n[2]], &[n[0], n[2], n[3]]]);
                take(n.to_vec(), &[&[n[1], n[2], n[3]], &[n[1], n[3], n[0]]]);
            }
        }
        sides.extend(left.into_values().map(|number| (number, self.facets[number].to_vec())));
        sides.sort_unstable();
        sides.into_iter().map(|(_, nodes)| nodes).collect()
    }

    /// The shares ∫ Nₐ dA of nodes at rest, over the sides whose nodes are all selected: lengths [m] in the plane, areas [m²] in space. Nₐ are the
    /// shape functions of the cells.
    ///
    /// A uniform traction multiplied by the shares does the same work as the traction on the sides, for every displacement of the cells, if sides are
    /// flat. Nodes without a share are omitted. Node numbers beyond the last node are ignored.
    pub fn boundary_shares(&self, selected: &[u32]) -> BTreeMap<u32, f64> {
        let mut shares = BTreeMap::new();
        for side in self.boundary_sides(selected) {
            let x: Vec<[f64; D]> = side.iter().map(|&node| self.positions[node as usize]).collect();
            for point in side_points(D, side.len()) {
                let size = crate::geometry::norm(lift(&side_vector(&point, &x)));
                for (node, shape) in side.iter().zip(point.shape) {
                    *shares.entry(*node).or_insert(0.0) += point.weight * shape * size;
                }
            }
        }
        shares
    }
}

fn ascending(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The work of a uniform traction on x², which linear cells interpolate linearly between nodes.
    #[test]
    fn shares_of_quadratic_sides_integrate_quadratic_motion() {
        let plane = Mesh::<2>::grid([0.0; 2], [1.0, 2.0], [2, 3]).unwrap().into_simplices().unwrap();
        let plane = plane.into_quadratic().unwrap();
        let top = plane.boundary_shares(&plane.groups["top"]);
        assert!((top.values().sum::<f64>() - 1.0).abs() < 1e-14);
        let work: f64 = top
            .iter()
            .map(|(node, share)| plane.positions[*node as usize][0] * plane.positions[*node as usize][0] * share)
            .sum();
        assert!((work - 1.0 / 3.0).abs() < 1e-14, "{work}");

        let space = Mesh::<3>::grid([0.0; 3], [1.0, 2.0, 1.5], [2, 1, 3]).unwrap().into_simplices().unwrap();
        let space = space.into_quadratic().unwrap();
        let top = space.boundary_shares(&space.groups["top"]);
        assert!((top.values().sum::<f64>() - 1.5).abs() < 1e-14);
        let work: f64 = top
            .iter()
            .map(|(node, share)| {
                let [x, _, z] = space.positions[*node as usize];
                (x * x + x * z) * share
            })
            .sum();
        // ∫₀¹∫₀^1.5 x² + xz dz dx.
        assert!((work - (0.5 + 0.5 * 1.125)).abs() < 1e-13, "{work}");
        // Corners of triangles have no share.
        let corner = space.positions.iter().position(|x| *x == [0.5, 2.0, 0.5]).unwrap() as u32;
        assert!(top[&corner].abs() < 1e-15);
    }

    #[test]
    fn facets_that_are_not_selected_whole_give_nothing() {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
        assert!(mesh.boundary_shares(&[0, 99]).is_empty());
        assert_eq!(mesh.boundary_shares(&[0, 1]), BTreeMap::from([(0, 0.25), (1, 0.25)]));
    }

    #[test]
    fn sides_of_hexahedra_are_quadrilaterals_with_even_shares() {
        let mesh = Mesh::<3>::grid([0.0; 3], [1.0, 1.0, 1.0], [2, 2, 2]).unwrap();
        let top = mesh.boundary_shares(&mesh.groups["top"]);
        let middle = mesh.positions.iter().position(|x| *x == [0.5, 1.0, 0.5]).unwrap() as u32;
        assert_eq!(top.len(), 9);
        assert!((top[&middle] - 0.25).abs() < 1e-15, "{}", top[&middle]);
        assert!(mesh.boundary_sides(&mesh.groups["top"]).iter().all(|side| side.len() == 4));
    }

    /// ∫ n dA over a closed surface is zero, and ∫ x·n dA is three times the enclosed volume, whatever the shape of its sides.
    #[test]
    fn sides_close_and_enclose_the_volume_of_their_cells() {
        let plain = Mesh::<3>::grid([0.0; 3], [1.0, 1.2, 0.8], [2, 3, 2]).unwrap();
        let quadratic = plain.clone().into_simplices().unwrap().into_quadratic().unwrap();
        for mut mesh in [plain.clone(), plain.into_simplices().unwrap(), quadratic] {
            for x in &mut mesh.positions {
                *x = [x[0] + 0.1 * x[1] * x[2], x[1] - 0.2 * x[0] * x[0], x[2] + 0.15 * x[0] * x[1]];
            }
            let all: Vec<u32> = (0..mesh.nodes() as u32).collect();
            let (mut whole, mut sum) = (0.0, [0.0; 3]);
            for side in mesh.boundary_sides(&all) {
                let x: Vec<[f64; 3]> = side.iter().map(|&node| mesh.positions[node as usize]).collect();
                for point in side_points(3, side.len()) {
                    let n = side_vector(&point, &x);
                    for d in 0..3 {
                        let at: f64 = point.shape.iter().zip(&x).map(|(shape, x)| shape * x[d]).sum();
                        whole += point.weight * at * n[d] / 3.0;
                        sum[d] += point.weight * n[d];
                    }
                }
            }
            let cells = mesh.cell_quality().unwrap().measure;
            assert!(sum.iter().all(|s| s.abs() < 1e-13), "{sum:?}");
            assert!((whole - cells).abs() < 1e-9, "{whole} and {cells}");
        }
    }
}
