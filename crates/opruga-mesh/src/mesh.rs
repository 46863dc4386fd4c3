//! The mesh, and the checks on which all code that reads it relies.

use std::collections::BTreeMap;

use crate::{Element, MeshError, Must, Quantity, Skin};

/// The maximum number of nodes of a mesh: 2²⁵, so that every index and every doubled index fits into a `u32`, and so that a mistyped count cannot
/// exhaust the memory.
pub const MAXIMUM_NODES: u64 = 1 << 25;

/// The filled interior of a body.
///
/// ```text
///  triangle    quadrilateral    tetrahedron         hexahedron
///     2           3-----2            3                7------6
///    / \          |     |           /|\              /|     /|      z  y
///   /   \         |     |          / | \            4------5 |      | /
///  0-----1        0-----1         0--|--2           | 3----|-2      |/
///                                  \ | /            |/     |/       +---x
///                                   \|/             0------1
///                                    1
///
///  quadratic triangle          quadratic tetrahedron
///        2                         3
///       / \                       /|\          node  4  5  6  7  8  9
///      5   4                     7 | 9         of    0  1  2  0  1  2
///     /     \                   /  8  \        and   1  2  0  3  3  3
///    0---3---1                 0--6|---2
///                               \  |  /        corners first, then the nodes in the middle of edges
///                                4 | 5
///                                 \|/
///                                  1
/// ```
/// Triangles and quadrilaterals are counter-clockwise; a tetrahedron has (X₁−X₀)·((X₂−X₀)×(X₃−X₀)) > 0; a hexahedron has its nodes 0 1 2 3
/// counter-clockwise as seen from 4 5 6 7, which are above them. The corners of quadratic cells have the order of linear ones; their sides may be
/// curved.
///
/// Cells are numbered kind by kind, in the order of the fields below.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Cells {
    /// Triangles in the plane, 3 nodes each.
    pub triangles: Vec<[u32; 3]>,
    /// Quadrilaterals in the plane, 4 nodes each.
    pub quadrilaterals: Vec<[u32; 4]>,
    /// Tetrahedra in space, 4 nodes each.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Hexahedra in space, 8 nodes each.
    pub hexahedra: Vec<[u32; 8]>,
    /// Triangles of second order in the plane: 3 corners, then the nodes between corners 0–1, 1–2, 2–0.
    pub quadratic_triangles: Vec<[u32; 6]>,
    /// Tetrahedra of second order in space: 4 corners, then the nodes between corners 0–1, 1–2, 2–0, 0–3, 1–3, 2–3.
    pub quadratic_tetrahedra: Vec<[u32; 10]>,
}

impl Cells {
    /// Whether the body has no filled interior.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of cells of all kinds.
    pub fn len(&self) -> usize {
        self.triangles.len()
            + self.quadrilaterals.len()
            + self.tetrahedra.len()
            + self.hexahedra.len()
            + self.quadratic_triangles.len()
            + self.quadratic_tetrahedra.len()
    }

    /// All cells in the order of their numbers, as (kind, index among its kind, nodes).
    pub fn iter(&self) -> impl Iterator<Item = (Element, u32, &[u32])> {
        rows(Element::Triangle, &self.triangles)
            .chain(rows(Element::Quadrilateral, &self.quadrilaterals))
            .chain(rows(Element::Tetrahedron, &self.tetrahedra))
            .chain(rows(Element::Hexahedron, &self.hexahedra))
            .chain(rows(Element::QuadraticTriangle, &self.quadratic_triangles))
            .chain(rows(Element::QuadraticTetrahedron, &self.quadratic_tetrahedra))
    }

    /// The nodes of all cells, for renumbering.
    pub(crate) fn nodes_mut(&mut self) -> impl Iterator<Item = &mut u32> {
        let straight = self.triangles.iter_mut().flatten().chain(self.quadrilaterals.iter_mut().flatten());
        let solid = self.tetrahedra.iter_mut().flatten().chain(self.hexahedra.iter_mut().flatten());
        let quadratic = self.quadratic_triangles.iter_mut().flatten();
        straight.chain(solid).chain(quadratic).chain(self.quadratic_tetrahedra.iter_mut().flatten())
    }
}

/// A body at rest: the positions of its nodes and the elements between them, in the plane (`D = 2`) or in space (`D = 3`).
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Mesh<const D: usize> {
    /// Rest positions X [m], one row per node.
    pub positions: Vec<[f64; D]>,
    /// The boundary: edges with the interior to their left in the plane, triangles counter-clockwise as seen from outside in space.
    pub facets: Vec<[u32; D]>,
    /// One-dimensional cells: edges of open or closed chains that bound nothing.
    pub wires: Vec<[u32; 2]>,
    /// Triangles of an open surface (cloth), in space only.
    pub sheets: Vec<[u32; 3]>,
    /// Quadrilaterals of an open surface that is a grid: number k is the union of triangles 2k and 2k + 1 of `sheets`.
    pub sheet_quadrilaterals: Vec<[u32; 4]>,
    /// The filled interior.
    pub cells: Cells,
    /// Named node sets, ascending (`left`, `right`, `bottom`, `top`, `back`, `front` for grids).
    pub groups: BTreeMap<String, Vec<u32>>,
    /// Named sets of cells, ascending; cells are numbered as in [`Cells::iter`].
    pub cell_groups: BTreeMap<String, Vec<u32>>,
    /// Named numbers, one per cell in the order of [`Cells::iter`], such as material parameters; NaN for a cell without a value.
    pub cell_values: BTreeMap<String, Vec<f64>>,
    /// Named numbers or vectors of nodes, such as a velocity that another program has computed.
    pub node_values: BTreeMap<String, NodeValues>,
    /// The surface that is drawn instead of the boundary, in space only.
    pub skin: Option<Skin>,
}

/// Numbers or vectors, one per node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeValues {
    /// The number of values per node.
    pub components: usize,
    /// The numbers, node by node; NaN for a node without a value.
    pub values: Vec<f64>,
}

/// A row of elements as (kind, index, nodes).
fn rows<const N: usize>(kind: Element, list: &[[u32; N]]) -> impl Iterator<Item = (Element, u32, &[u32])> {
    list.iter().enumerate().map(move |(index, nodes)| (kind, index as u32, nodes.as_slice()))
}

impl<const D: usize> Mesh<D> {
    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.positions.len()
    }

    /// All elements, kind by kind, as (kind, index, nodes); groups are not elements.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (Element, u32, &[u32])> {
        rows(Element::Facet, &self.facets)
            .chain(rows(Element::Wire, &self.wires))
            .chain(rows(Element::Sheet, &self.sheets))
            .chain(rows(Element::SheetQuadrilateral, &self.sheet_quadrilaterals))
            .chain(self.cells.iter())
    }

    /// Facets as triangles; empty in the plane.
    pub(crate) fn facet_triangles(&self) -> Vec<[u32; 3]> {
        if D != 3 {
            return Vec::new();
        }
        self.facets.iter().map(|facet| [facet[0], facet[1], facet[D - 1]]).collect()
    }

    /// Checks that every index names a node and that no element names a node twice, so that all code can rely on the mesh.
    ///
    /// # Errors
    /// [`MeshError::TooManyNodes`], [`MeshError::IndexOutOfRange`], [`MeshError::RepeatedNode`], [`MeshError::WrongDimension`],
    /// [`MeshError::SheetPairing`], [`MeshError::CellOutOfRange`], [`MeshError::CellValues`] or [`MeshError::NodeValues`], whichever is found first.
    /// [`Mesh::check`] lists every problem instead.
    pub fn validate(&self) -> Result<(), MeshError> {
        const { assert!(D == 2 || D == 3, "bodies live in the plane or in space") }
        limit_nodes(self.positions.len() as u64)?;
        let nodes = self.positions.len() as u32;

        // Every element: the dimension matches, indices are in range and distinct.
        for (element, index, list) in self.elements() {
            if !belongs(element, D) {
                return Err(MeshError::WrongDimension { element, dimension: D });
            }
            for (place, &node) in list.iter().enumerate() {
                if node >= nodes {
                    return Err(MeshError::IndexOutOfRange { element, index, node, nodes });
                }
                if list[..place].contains(&node) {
                    return Err(MeshError::RepeatedNode { element, index, node });
                }
            }
        }

        // Groups: indices in range.
        for (index, list) in self.groups.values().enumerate() {
            if let Some(&node) = list.iter().find(|&&node| node >= nodes) {
                return Err(MeshError::IndexOutOfRange { element: Element::Group, index: index as u32, node, nodes });
            }
        }

        // Groups and values of cells.
        let cells = self.cells.len();
        for (name, list) in &self.cell_groups {
            if let Some(&cell) = list.iter().find(|&&cell| cell as usize >= cells) {
                return Err(MeshError::CellOutOfRange { group: name.clone(), cell, cells });
            }
        }
        if let Some((name, values)) = self.cell_values.iter().find(|(_, values)| values.len() != cells) {
            return Err(MeshError::CellValues { name: name.clone(), values: values.len(), cells });
        }

        // Values of nodes.
        for (name, field) in &self.node_values {
            if field.components == 0 || field.components.checked_mul(self.nodes()) != Some(field.values.len()) {
                let (components, values) = (field.components, field.values.len());
                return Err(MeshError::NodeValues { name: name.clone(), values, components, nodes: self.nodes() });
            }
        }

        // Sheet quadrilaterals: each the union of its two triangles.
        for (index, quadrilateral) in self.sheet_quadrilaterals.iter().enumerate() {
            let halves = self.sheets.get(2 * index..2 * index + 2);
            let covers = |halves: &[[u32; 3]]| {
                let within = halves.iter().flatten().all(|node| quadrilateral.contains(node));
                within && quadrilateral.iter().all(|node| halves.iter().flatten().any(|other| other == node))
            };
            if !halves.is_some_and(covers) {
                return Err(MeshError::SheetPairing { index: index as u32 });
            }
        }
        Ok(())
    }

    /// The Euler characteristic of the boundary: the number of vertices − edges + facets, which is 2 for each sphere and 0 for each torus. For
    /// outlines, it is the number of vertices − edges, which is 0 for each closed loop.
    ///
    /// Only nodes of facets are counted.
    pub fn euler_characteristic(&self) -> i64 {
        let mut vertices: Vec<u32> = self.facets.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        let edges = self.edges(crate::EdgeSet::Boundary).len() as i64;
        let faces = if D == 3 { self.facets.len() as i64 } else { 0 };
        vertices.len() as i64 - edges + faces
    }
}

/// Whether an element of this kind may be part of a mesh of this dimension.
fn belongs(element: Element, dimension: usize) -> bool {
    match element {
        Element::Facet | Element::Wire | Element::Edge | Element::Group => true,
        Element::Triangle | Element::Quadrilateral | Element::QuadraticTriangle => dimension == 2,
        Element::Sheet | Element::SheetQuadrilateral => dimension == 3,
        Element::Tetrahedron | Element::Hexahedron | Element::QuadraticTetrahedron => dimension == 3,
    }
}

/// Rounds an estimate of a number of nodes down to a whole number; infinity for NaN.
pub(crate) fn estimated(nodes: f64) -> f64 {
    if nodes.is_nan() { f64::INFINITY } else { nodes.floor() }
}

/// Refuses more than [`MAXIMUM_NODES`] nodes.
pub(crate) fn limit_nodes(nodes: u64) -> Result<(), MeshError> {
    if nodes > MAXIMUM_NODES { Err(MeshError::TooManyNodes { nodes, most: MAXIMUM_NODES }) } else { Ok(()) }
}

/// Refuses a count outside `least..=most`.
pub(crate) fn count(what: Quantity, value: u32, least: u64, most: u64) -> Result<(), MeshError> {
    let value = u64::from(value);
    if (least..=most).contains(&value) { Ok(()) } else { Err(MeshError::Count { what, value, least, most }) }
}

/// Refuses a length that is not positive and finite [m].
pub(crate) fn positive(what: Quantity, value: f64) -> Result<(), MeshError> {
    if value > 0.0 && value.is_finite() { Ok(()) } else { Err(MeshError::Size { what, value, must: Must::Positive }) }
}

/// Refuses coordinates that are not finite [m].
pub(crate) fn finite(what: Quantity, values: &[f64]) -> Result<(), MeshError> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(&value) => Err(MeshError::Size { what, value, must: Must::Finite }),
        None => Ok(()),
    }
}
