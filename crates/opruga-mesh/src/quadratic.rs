//! Cells of second order: numbering, areas and volumes of curved cells, and conversion of linear cells to quadratic ones.
//!
//! A point of a quadratic cell is x(λ) = Σ Nₐ(λ) xₐ with barycentric coordinates λ: Nᵢ = λᵢ (2 λᵢ − 1) for corner i, Nᵢⱼ = 4 λᵢ λⱼ for the node at
//! the midpoint of edge ij. Sides may be curved, as parabolas.

use crate::geometry::{Point, ascending, cross, tetrahedron_volume};
use crate::{Element, Mesh, MeshError};
use std::collections::BTreeMap;

/// The two corners beside each mid-edge node of a quadratic triangle, for nodes 3 to 5.
pub const TRIANGLE_SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// The two corners beside each mid-edge node of a quadratic tetrahedron, for nodes 4 to 9.
pub const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];

/// The four triangles through the nodes of a quadratic triangle, with its orientation.
pub(crate) const TRIANGLE_PARTS: [[usize; 3]; 4] = [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];

/// The outward faces of a quadratic tetrahedron as quadratic triangles.
pub(crate) const TETRAHEDRON_FACES: [[usize; 6]; 4] =
    [[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]];

/// The shares of the nodes in the mass of a quadratic triangle: the diagonal of its consistent mass matrix, scaled to the total.
///
/// # Source
/// E. Hinton, T. Rock, O. C. Zienkiewicz, "A note on mass lumping and related processes in the finite element method", Earthquake Engineering and
/// Structural Dynamics 4 (1976): 1/19 and 16/57 with straight sides. All shares are positive, whereas plain row sums give nothing to the corners.
pub const TRIANGLE_SHARES: [f64; 6] = [1.0 / 19.0, 1.0 / 19.0, 1.0 / 19.0, 16.0 / 57.0, 16.0 / 57.0, 16.0 / 57.0];

/// The shares of the nodes in the mass of a quadratic tetrahedron, computed as for [`TRIANGLE_SHARES`]: 1/36 and 4/27 (row sums would be −1/20 and
/// 1/5).
pub const TETRAHEDRON_SHARES: [f64; 10] = [
    1.0 / 36.0,
    1.0 / 36.0,
    1.0 / 36.0,
    1.0 / 36.0,
    4.0 / 27.0,
    4.0 / 27.0,
    4.0 / 27.0,
    4.0 / 27.0,
    4.0 / 27.0,
    4.0 / 27.0,
];

/// The four triangles through the nodes of a quadratic triangle.
pub fn triangle_parts(nodes: &[u32; 6]) -> [[u32; 3]; 4] {
    TRIANGLE_PARTS.map(|part| part.map(|corner| nodes[corner]))
}

/// The sixteen boundary triangles of a quadratic tetrahedron, four per face, oriented outward.
pub(crate) fn tetrahedron_parts(nodes: &[u32; 10]) -> impl Iterator<Item = [u32; 3]> {
    TETRAHEDRON_FACES.into_iter().flat_map(move |face| triangle_parts(&face.map(|corner| nodes[corner])))
}

/// Signed area of a quadratic triangle with curved sides [m²]: each parabola adds 4/3 of the triangle a, midpoint, b to the triangle of the corners.
pub(crate) fn triangle_area(nodes: &[Point; 6]) -> f64 {
    let part = |a: usize, b: usize, c: usize| crate::geometry::area_vector(nodes[a], nodes[b], nodes[c])[2];
    part(0, 1, 2) + 4.0 / 3.0 * (part(0, 3, 1) + part(1, 4, 2) + part(2, 5, 0))
}

/// Signed volume of a quadratic tetrahedron with curved sides [m³]: ∫ det ∂x/∂λ, whose integrand is a polynomial of degree 3, computed by a
/// five-point rule that is exact for this degree.
pub(crate) fn tetrahedron_volume_of(nodes: &[Point; 10]) -> f64 {
    let mut sum = -0.8 * tetrahedron_jacobian(nodes, [0.25; 4]);
    for corner in 0..4 {
        let mut at = [1.0 / 6.0; 4];
        at[corner] = 0.5;
        sum += 0.45 * tetrahedron_jacobian(nodes, at);
    }
    sum / 6.0
}

/// The determinant det ∂x/∂λ of a quadratic triangle at barycentric coordinates λ [m²]: twice the area if the triangle is straight.
fn triangle_jacobian(nodes: &[Point; 6], at: [f64; 3]) -> f64 {
    let by = derivatives(nodes, &TRIANGLE_SIDES, at);
    let side = |k: usize| [by[k][0] - by[0][0], by[k][1] - by[0][1], 0.0];
    cross(side(1), side(2))[2]
}

/// The determinant det ∂x/∂λ of a quadratic tetrahedron at barycentric coordinates λ [m³]: six times the volume if it is straight.
pub(crate) fn tetrahedron_jacobian(nodes: &[Point; 10], at: [f64; 4]) -> f64 {
    let by = derivatives(nodes, &TETRAHEDRON_EDGES, at);
    6.0 * tetrahedron_volume(by[0], by[1], by[2], by[3])
}

/// The derivatives ∂x/∂λᵢ for every corner i: (4 λᵢ − 1) xᵢ + 4 Σ λⱼ xᵢⱼ.
fn derivatives<const N: usize, const C: usize, const E: usize>(
    nodes: &[Point; N],
    edges: &[[usize; 2]; E],
    at: [f64; C],
) -> [Point; C] {
    let mut out = [[0.0; 3]; C];
    for i in 0..C {
        for d in 0..3 {
            out[i][d] = (4.0 * at[i] - 1.0) * nodes[i][d];
        }
    }
    for (k, &[i, j]) in edges.iter().enumerate() {
        for d in 0..3 {
            out[i][d] += 4.0 * at[j] * nodes[C + k][d];
            out[j][d] += 4.0 * at[i] * nodes[C + k][d];
        }
    }
    out
}

/// The determinant det ∂x/∂λ at the six nodes of a quadratic triangle, as areas [m²]; negative if the triangle folds over there.
pub(crate) fn triangle_areas(nodes: &[Point; 6]) -> [f64; 6] {
    core::array::from_fn(|node| 0.5 * triangle_jacobian(nodes, coordinates(node, &TRIANGLE_SIDES)))
}

/// The determinant det ∂x/∂λ at the ten nodes of a quadratic tetrahedron, as volumes [m³]; negative if the tetrahedron folds over there.
pub(crate) fn tetrahedron_volumes(nodes: &[Point; 10]) -> [f64; 10] {
    core::array::from_fn(|node| tetrahedron_jacobian(nodes, coordinates(node, &TETRAHEDRON_EDGES)) / 6.0)
}

/// Barycentric coordinates of a node of a quadratic cell with C corners.
fn coordinates<const C: usize, const E: usize>(node: usize, edges: &[[usize; 2]; E]) -> [f64; C] {
    core::array::from_fn(|corner| match node.checked_sub(C) {
        None => f64::from(u8::from(corner == node)),
        Some(edge) => 0.5 * f64::from(u8::from(edges[edge].contains(&corner))),
    })
}

impl<const D: usize> Mesh<D> {
    /// The same body made of quadratic cells: every triangle and tetrahedron gets a node at the midpoint of each of its edges.
    ///
    /// Corners keep their numbers; the new nodes follow, in the order of (lower corner, higher corner). A new node joins every node group that
    /// contains both ends of its edge, and gets the mean of their values. Cells keep their groups and values. Facets are recomputed; sides are
    /// straight. Existing quadratic cells do not change, and neighbours use their nodes at common edges.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::NotSimplices`] for quadrilaterals and hexahedra ([`Mesh::into_simplices`] cuts them);
    /// [`MeshError::TooManyNodes`].
    pub fn into_quadratic(mut self) -> Result<Mesh<D>, MeshError> {
        self.validate()?;
        for (element, empty) in [
            (Element::Quadrilateral, self.cells.quadrilaterals.is_empty()),
            (Element::Hexahedron, self.cells.hexahedra.is_empty()),
        ] {
            if !empty {
                return Err(MeshError::NotSimplices { element });
            }
        }
        // The old cell of each new cell. Linear cells are numbered first; once they are quadratic, they follow the cells that already were.
        let linear = self.cells.triangles.len() + self.cells.tetrahedra.len();
        let origins: Vec<u32> = (linear..self.cells.len()).chain(0..linear).map(|cell| cell as u32).collect();

        // Nodes at the midpoints of edges: first existing ones, then new ones in ascending order.
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        let triangles = std::mem::take(&mut self.cells.triangles);
        let tetrahedra = std::mem::take(&mut self.cells.tetrahedra);
        for (cell, [i, j]) in triangles.iter().flat_map(|cell| TRIANGLE_SIDES.map(|edge| (cell, edge))) {
            middles.insert(ascending(cell[i], cell[j]), u32::MAX);
        }
        for (cell, [i, j]) in tetrahedra.iter().flat_map(|cell| TETRAHEDRON_EDGES.map(|edge| (cell, edge))) {
            middles.insert(ascending(cell[i], cell[j]), u32::MAX);
        }
        let mut lend = |edge: [u32; 2], middle: u32| {
            middles.entry(edge).and_modify(|known| *known = middle);
        };
        for cell in &self.cells.quadratic_triangles {
            TRIANGLE_SIDES.iter().zip(3..).for_each(|(&[i, j], k)| lend(ascending(cell[i], cell[j]), cell[k]));
        }
        for cell in &self.cells.quadratic_tetrahedra {
            TETRAHEDRON_EDGES.iter().zip(4..).for_each(|(&[i, j], k)| lend(ascending(cell[i], cell[j]), cell[k]));
        }
        let new = middles.values().filter(|node| **node == u32::MAX).count();
        crate::mesh::limit_nodes((self.nodes() + new) as u64)?;
        for (&[a, b], node) in middles.iter_mut().filter(|entry| *entry.1 == u32::MAX) {
            *node = self.positions.len() as u32;
            let (p, q) = (self.positions[a as usize], self.positions[b as usize]);
            self.positions.push(core::array::from_fn(|axis| 0.5 * (p[axis] + q[axis])));
            for field in self.node_values.values_mut() {
                let width = field.components;
                for k in 0..width {
                    let of = |node: u32| field.values[node as usize * width + k];
                    field.values.push(0.5 * (of(a) + of(b)));
                }
            }
            for nodes in self.groups.values_mut() {
                if nodes.binary_search(&a).is_ok() && nodes.binary_search(&b).is_ok() {
                    nodes.push(*node);
                }
            }
        }
        let middle = |a: u32, b: u32| middles[&ascending(a, b)];
        for [a, b, c] in triangles {
            self.cells.quadratic_triangles.push([a, b, c, middle(a, b), middle(b, c), middle(c, a)]);
        }
        for [a, b, c, d] in tetrahedra {
            let middles = [middle(a, b), middle(b, c), middle(c, a), middle(a, d), middle(b, d), middle(c, d)];
            let [p, q, r, s, t, u] = middles;
            self.cells.quadratic_tetrahedra.push([a, b, c, d, p, q, r, s, t, u]);
        }
        self.follow_cells(&origins);
        if !self.cells.is_empty() {
            self.facets = self.facets_from_cells()?;
        }
        Ok(self)
    }

    /// Updates cell groups and cell values after cells have been rebuilt: new cell k comes from old cell `origins[k]`.
    pub(crate) fn follow_cells(&mut self, origins: &[u32]) {
        for values in self.cell_values.values_mut() {
            *values = origins.iter().map(|&origin| values[origin as usize]).collect();
        }
        for cells in self.cell_groups.values_mut() {
            let within = |origin: &u32| cells.binary_search(origin).is_ok();
            *cells = (0..origins.len()).filter(|&cell| within(&origins[cell])).map(|cell| cell as u32).collect();
        }
    }
}
