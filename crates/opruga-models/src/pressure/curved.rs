//! Boundaries of quadratic cells and of boxes: curved sides, and the volume that they enclose according to the shape functions of
//! the cells.
//!
//! If sides were divided into straight pieces, the gas would load an end and the midpoint of a side with ¼ and ½ of its area,
//! while the shape functions of the cells give ⅙ and ⅔ for a uniform pressure. Stresses would then oscillate from node to node.

use opruga_core::potential::Sink;
use opruga_core::state::View;
use std::collections::BTreeMap;

/// The volume as a sum over groups of nodes: ½ Σ w xₐ × x_b in the plane, ⅙ Σ w xₐ·(x_b × x_c) in space.
#[derive(Debug)]
pub(super) struct CurvedSides {
    /// The nodes of each group and its weight w. A group of two nodes contains the last node twice.
    pub(super) terms: Vec<([u32; 3], f64)>,
    /// The nodes of the boundary, ascending.
    pub(super) nodes: Vec<u32>,
}

/// ∫ x × x′ over a parabola through both ends and the midpoint, as coefficients of products of two of its nodes (0 and 1 are the
/// ends).
const PARABOLA: [Term; 3] = [([0, 2, 2], 4.0 / 3.0), ([2, 1, 1], 4.0 / 3.0), ([0, 1, 1], -1.0 / 3.0)];

/// The terms of the bilinear side of a box: the mean of the two divisions into triangles.
const SADDLE: [Term; 4] = [([0, 1, 2], 0.5), ([0, 2, 3], 0.5), ([0, 1, 3], 0.5), ([1, 2, 3], 0.5)];

/// The integral of x·(∂x/∂ξ × ∂x/∂η) over a quadratic triangle with the corners 0–2 and the midpoints 3 (0–1), 4 (1–2), 5
/// (2–0): twice the alternating sum of ∫ Nᵢ ∂Nⱼ/∂ξ ∂N_k/∂η, a polynomial of fourth degree.
const CAP: [Term; 20] = [
    ([0, 1, 2], 2.0 / 15.0),
    ([0, 1, 3], 0.2),
    ([0, 1, 4], -1.0 / 3.0),
    ([0, 1, 5], -1.0 / 3.0),
    ([0, 2, 3], 1.0 / 3.0),
    ([0, 2, 4], 1.0 / 3.0),
    ([0, 2, 5], -0.2),
    ([0, 3, 4], 4.0 / 15.0),
    ([0, 3, 5], 1.6),
    ([0, 4, 5], 4.0 / 15.0),
    ([1, 2, 3], -1.0 / 3.0),
    ([1, 2, 4], 0.2),
    ([1, 2, 5], -1.0 / 3.0),
    ([1, 3, 4], -1.6),
    ([1, 3, 5], -4.0 / 15.0),
    ([1, 4, 5], 4.0 / 15.0),
    ([2, 3, 4], 4.0 / 15.0),
    ([2, 3, 5], -4.0 / 15.0),
    ([2, 4, 5], -1.6),
    ([3, 4, 5], 16.0 / 15.0),
];

/// The indices of nodes in a side, and the weight of the product of these nodes.
type Term = ([usize; 3], f64);

/// Facets by the indices of their nodes in a side.
type Facets = [[usize; 3]];

/// The possible divisions of a side of a cell into facets, and the terms that the side adds to the volume. Returns `None` for a
/// straight side.
fn kind<const D: usize>(nodes: usize) -> Option<(&'static [&'static Facets], &'static [Term])> {
    match (D, nodes) {
        (2, 3) => Some((&[&[[0, 2, 2], [2, 1, 1]]], &PARABOLA)),
        (3, 4) => Some((&[&[[0, 1, 2], [0, 2, 3]], &[[1, 2, 3], [1, 3, 0]]], &SADDLE)),
        (3, 6) => Some((&[&[[0, 3, 5], [1, 4, 3], [2, 5, 4], [3, 4, 5]]], &CAP)),
        _ => None,
    }
}

fn ascending<const D: usize>(facet: &[u32; D]) -> [u32; D] {
    let mut key = *facet;
    key.sort_unstable();
    key
}

/// Whether two facets with the same nodes have the same orientation.
fn face_alike<const D: usize>(one: &[u32; D], other: &[u32; D]) -> bool {
    let shift = (0..D).find(|k| other[*k] == one[0]).unwrap_or(0);
    (0..D).all(|k| one[k] == other[(k + shift) % D]) && (D != 2 || shift == 0)
}

impl CurvedSides {
    /// Finds the curved sides of a chamber: those of `sides` whose pieces are among its facets. Returns `None` if the chamber has
    /// no curved sides.
    pub(super) fn of<const D: usize>(facets: &[[u32; D]], sides: &[Vec<u32>]) -> Option<CurvedSides> {
        let mut left: BTreeMap<[u32; D], [u32; D]> = facets.iter().map(|facet| (ascending(facet), *facet)).collect();
        let mut terms = Vec::new();
        for side in sides {
            let Some((cuts, weights)) = kind::<D>(side.len()) else { continue };
            for cut in cuts {
                let pieces: Vec<[u32; D]> = cut.iter().map(|piece| core::array::from_fn(|d| side[piece[d]])).collect();
                let own: Vec<_> = pieces.iter().filter_map(|piece| left.get(&ascending(piece))).collect();
                if own.len() != pieces.len() {
                    continue;
                }
                // The boundary of a cavity is oriented away from the cells.
                let sign = if face_alike(own[0], &pieces[0]) { 1.0 } else { -1.0 };
                pieces.iter().for_each(|piece| {
                    left.remove(&ascending(piece));
                });
                terms.extend(weights.iter().map(|(k, weight)| (k.map(|k| side[k]), sign * weight)));
            }
        }
        if terms.is_empty() {
            return None;
        }
        terms.extend(left.into_values().map(|facet| ([facet[0], facet[1], facet[D - 1]], 1.0)));
        let mut nodes: Vec<u32> = terms.iter().flat_map(|(nodes, _)| *nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Some(CurvedSides { terms, nodes })
    }

    /// The volume (area in the plane) at positions. Writes ∂V/∂x to `slope`, node by node.
    pub(super) fn volume<const D: usize>(
        &self,
        at: impl Fn(u32) -> [f64; D],
        mut slope: impl FnMut(u32, [f64; D]),
    ) -> f64 {
        // Relative to a node, so that no digits are lost far from the origin.
        let origin = at(self.nodes[0]);
        let relative = |node: u32| {
            let x = at(node);
            core::array::from_fn::<f64, D, _>(|d| x[d] - origin[d])
        };
        let mut sum = 0.0;
        for (nodes, weight) in &self.terms {
            let x = nodes.map(relative);
            if D == 2 {
                let half = 0.5 * weight;
                sum += half * (x[0][0] * x[1][1] - x[0][1] * x[1][0]);
                slope(nodes[0], core::array::from_fn(|d| if d == 0 { half * x[1][1] } else { -half * x[1][0] }));
                slope(nodes[1], core::array::from_fn(|d| if d == 0 { -half * x[0][1] } else { half * x[0][0] }));
                continue;
            }
            for k in 0..3 {
                let (p, q) = (x[(k + 1) % 3], x[(k + 2) % 3]);
                let vector: [f64; D] = core::array::from_fn(|d| {
                    let (e, f) = ((d + 1) % D, (d + 2) % D);
                    weight * (p[e] * q[f] - p[f] * q[e]) / 6.0
                });
                if k == 0 {
                    sum += (0..D).map(|d| vector[d] * x[0][d]).sum::<f64>();
                }
                slope(nodes[k], vector);
            }
        }
        sum
    }

    /// The volume of one of the bodies. Adds ∂V/∂x to `area`, column by column.
    pub(super) fn volume_of<const D: usize>(&self, view: &View<D>, body: usize, area: &mut [f64]) -> f64 {
        let index_count = area.len() / D;
        let index = |node: u32| view.layout.index(node as usize, body);
        self.volume(
            |node| view.position(index(node)),
            |node, vector| {
                for d in 0..D {
                    area[d * index_count + index(node)] += vector[d];
                }
            },
        )
    }
}

/// Delivers `factor` times the second derivatives of ½ xₐ × x_b of a pair of indices in the plane.
pub(super) fn second_of_pair<const D: usize>(indices: [usize; 2], factor: f64, sink: &mut dyn Sink<D>) {
    let mut block = [[0.0; D]; D];
    (block[0][1], block[1][0]) = (0.5 * factor, -0.5 * factor);
    let transposed = core::array::from_fn(|i| core::array::from_fn(|j| block[j][i]));
    sink.block(indices[0], indices[1], block);
    sink.block(indices[1], indices[0], transposed);
}

/// Delivers `factor` times the second derivatives of ⅙ xₐ·(x_b × x_c) of three indices: ∂²/∂xₐ∂x_b = −⅙ [x_c]×, cyclically.
pub(super) fn second_of_triple<const D: usize>(
    view: &View<D>,
    indices: [usize; 3],
    factor: f64,
    sink: &mut dyn Sink<D>,
) {
    for k in 0..3 {
        let [a, b, c] = [indices[k], indices[(k + 1) % 3], indices[(k + 2) % 3]];
        let x = view.position(c).map(|v| v * factor / 6.0);
        let mut block = [[0.0; D]; D];
        for d in 0..3 {
            let (e, f) = ((d + 1) % 3, (d + 2) % 3);
            // [x]× has −x_f at (d, e) and x_e at (d, f).
            block[d][e] = x[f];
            block[d][f] = -x[e];
        }
        let transposed = core::array::from_fn(|i| core::array::from_fn(|j| block[j][i]));
        sink.block(a, b, block);
        sink.block(b, a, transposed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_mesh::Mesh;

    /// Straight sides enclose the same volume as their pieces, and a uniform pressure loads corners and midpoints according to
    /// their shape functions.
    #[test]
    fn straight_sides_push_as_the_shape_functions_say() {
        let mesh =
            Mesh::<2>::grid([0.0; 2], [1.0; 2], [1; 2]).and_then(Mesh::into_simplices).and_then(Mesh::into_quadratic);
        let mesh = mesh.expect("a square");
        let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        let sides = CurvedSides::of(&mesh.facets, &mesh.boundary_sides(&all)).expect("quadratic sides");
        let mut push = vec![[0.0; 2]; all.len()];
        let area = sides.volume(
            |node| mesh.positions[node as usize],
            |node, by| (0..2).for_each(|d| push[node as usize][d] += by[d]),
        );
        assert!((area - 1.0).abs() < 1e-15, "{area}");
        for (node, x) in mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == 1.0) {
            let share = if x[1] == 0.5 { 2.0 / 3.0 } else { 1.0 / 6.0 };
            assert!((push[node][0] - share).abs() < 1e-15, "{x:?}: {:?}", push[node]);
        }
        let mesh =
            Mesh::<3>::grid([0.0; 3], [1.0; 3], [1; 3]).and_then(Mesh::into_simplices).and_then(Mesh::into_quadratic);
        let mesh = mesh.expect("a cube");
        let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        let list = mesh.boundary_sides(&all);
        let sides = CurvedSides::of(&mesh.facets, &list).expect("quadratic sides");
        let mut push = vec![[0.0; 3]; all.len()];
        let volume = sides.volume(
            |node| mesh.positions[node as usize],
            |node, by| (0..3).for_each(|d| push[node as usize][d] += by[d]),
        );
        assert!((volume - 1.0).abs() < 1e-14, "{volume}");
        // Each midpoint of a side of a triangle gets a third of the area of the triangle, and corners get nothing.
        let mut expected = vec![0.0; all.len()];
        for side in list.iter().filter(|side| side.iter().all(|n| mesh.positions[*n as usize][0] == 1.0)) {
            side[3..].iter().for_each(|middle| expected[*middle as usize] += 0.5 / 3.0);
        }
        for (node, x) in mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == 1.0) {
            assert!((push[node][0] - expected[node]).abs() < 1e-14, "{x:?}: {:?}", push[node]);
        }
    }

    /// The corners of the side of a box get equal shares of a uniform pressure, whichever way its facets were divided.
    #[test]
    fn sides_of_boxes_push_their_corners_evenly() {
        let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2; 3]).expect("a cube");
        let all: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        let sides = CurvedSides::of(&mesh.facets, &mesh.boundary_sides(&all)).expect("sides of boxes");
        let mut push = vec![[0.0; 3]; all.len()];
        let volume = sides.volume(
            |node| mesh.positions[node as usize],
            |node, by| (0..3).for_each(|d| push[node as usize][d] += by[d]),
        );
        assert!((volume - 1.0).abs() < 1e-14, "{volume}");
        for (node, x) in mesh.positions.iter().enumerate().filter(|(_, x)| x[0] == 1.0) {
            let cells: f64 = [x[1], x[2]].iter().map(|c| if *c == 0.5 { 2.0 } else { 1.0 }).product();
            assert!((push[node][0] - cells / 16.0).abs() < 1e-15, "{x:?}: {:?}", push[node]);
        }
    }

    /// The volume of a tetrahedron with curved faces is the integral of its Jacobian determinant, and ∂V/∂x is the derivative
    /// of that volume.
    #[test]
    fn curved_sides_enclose_the_volume_of_their_cell() {
        let mut mesh = Mesh::<3> {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            ..Mesh::default()
        };
        mesh.cells.tetrahedra = vec![[0, 1, 2, 3]];
        mesh.facets = mesh.facets_from_cells().expect("faces");
        let mut mesh = mesh.into_quadratic().expect("a tetrahedron");
        for (node, x) in mesh.positions.iter_mut().enumerate() {
            for d in 0..3 {
                x[d] += 0.05 * f64::from((7 * node as u32 + 5 * d as u32) % 11) / 11.0;
            }
        }
        let all: Vec<u32> = (0..10).collect();
        let sides = CurvedSides::of(&mesh.facets, &mesh.boundary_sides(&all)).expect("quadratic sides");
        let mut slope = vec![[0.0; 3]; 10];
        let volume = sides.volume(
            |node| mesh.positions[node as usize],
            |node, by| (0..3).for_each(|d| slope[node as usize][d] += by[d]),
        );
        let cells = mesh.measure().expect("a volume").value();
        assert!((volume - cells).abs() < 1e-15, "{volume} {cells}");
        for node in 0..10 {
            for d in 0..3 {
                let at = |step: f64| {
                    sides.volume(
                        |n| {
                            let mut x = mesh.positions[n as usize];
                            x[d] += if n == node { step } else { 0.0 };
                            x
                        },
                        |_, _| {},
                    )
                };
                let found = (at(1e-4) - at(-1e-4)) / 2e-4;
                assert!((found - slope[node as usize][d]).abs() < 1e-10, "node {node}, axis {d}");
            }
        }
    }
}
