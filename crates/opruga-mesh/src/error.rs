//! What can be wrong with a mesh or with the numbers that a generator is given.

use opruga_math::words::{counted, number};
use std::fmt;

/// The kinds of element that a mesh is made of; used to say where something is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Element {
    /// An oriented piece of the boundary: an edge in the plane, a triangle in space.
    Facet,
    /// An edge of a chain that bounds nothing.
    Wire,
    /// A triangle of an open surface.
    Sheet,
    /// A quadrilateral of an open surface, cut into two sheet triangles.
    SheetQuadrilateral,
    /// A filled triangle of the plane.
    Triangle,
    /// A filled quadrilateral of the plane.
    Quadrilateral,
    /// A filled tetrahedron of space.
    Tetrahedron,
    /// A filled hexahedron of space.
    Hexahedron,
    /// A filled triangle of second order.
    QuadraticTriangle,
    /// A filled tetrahedron of second order.
    QuadraticTetrahedron,
    /// An edge of an edge list.
    Edge,
    /// A named set of nodes; its index counts the groups in order of name.
    Group,
}

impl fmt::Display for Element {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Element::Facet => "facet",
            Element::Wire => "wire",
            Element::Sheet => "sheet triangle",
            Element::SheetQuadrilateral => "sheet quadrilateral",
            Element::Triangle => "triangle",
            Element::Quadrilateral => "quadrilateral",
            Element::Tetrahedron => "tetrahedron",
            Element::Hexahedron => "hexahedron",
            Element::QuadraticTriangle => "quadratic triangle",
            Element::QuadraticTetrahedron => "quadratic tetrahedron",
            Element::Edge => "edge",
            Element::Group => "group",
        })
    }
}

/// Why a mesh could not be made or read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A count lies outside what the generator allows.
    #[error("{what} is {value}, but must be between {least} and {most}")]
    Count {
        /// Name of the count.
        what: &'static str,
        /// The count that was given.
        value: u64,
        /// Smallest count allowed.
        least: u64,
        /// Largest count allowed.
        most: u64,
    },
    /// A length, coordinate or angle has an impossible value.
    #[error("{what} is {value}, but must be {must}")]
    Size {
        /// Name of the quantity.
        what: &'static str,
        /// The value that was given [m, or rad for angles].
        value: f64,
        /// What the value has to satisfy.
        must: &'static str,
    },
    /// The mesh would have more nodes than [`crate::MAXIMUM_NODES`].
    #[error("the mesh would have {nodes} nodes, but at most {most} are allowed")]
    TooManyNodes {
        /// Number of nodes asked for.
        nodes: u64,
        /// Number of nodes allowed.
        most: u64,
    },
    /// Edges lie over one another's boxes so often that it cannot be told in time whether they meet.
    #[error("{edges} edges run past one another so closely that more than {most} pairs would have to be compared")]
    NotCompared {
        /// How many edges there are.
        edges: u64,
        /// How many comparisons are allowed.
        most: u64,
    },
    /// Two consecutive points of an outline or chain coincide.
    #[error("points {first} and {second} follow each other at the same place")]
    RepeatedPoint {
        /// Index of the first point.
        first: u32,
        /// Index of the point that follows it.
        second: u32,
    },
    /// Two edges of an outline cross, touch or overlap.
    #[error(
        "the edge from point {} to point {} meets the edge from point {} to point {}",
        first[0], first[1], second[0], second[1]
    )]
    SelfIntersection {
        /// End points of one edge, in the order given.
        first: [u32; 2],
        /// End points of the other edge, in the order given.
        second: [u32; 2],
    },
    /// An element or group names a node that does not exist.
    #[error("{element} {index} names node {node}, but there are {nodes} nodes")]
    IndexOutOfRange {
        /// Kind of the element.
        element: Element,
        /// Index of the element among its kind.
        index: u32,
        /// The node that it names.
        node: u32,
        /// Number of nodes of the mesh.
        nodes: u32,
    },
    /// An element names the same node twice.
    #[error("{element} {index} names node {node} twice")]
    RepeatedNode {
        /// Kind of the element.
        element: Element,
        /// Index of the element among its kind.
        index: u32,
        /// The node that is named twice.
        node: u32,
    },
    /// A group of cells names a cell that does not exist.
    #[error("the group `{group}` names cell {cell}, but there are {cells} cells")]
    CellOutOfRange {
        /// Name of the group.
        group: String,
        /// The cell that it names.
        cell: u32,
        /// Number of cells of the mesh.
        cells: usize,
    },
    /// Values of cells are more or fewer than there are cells.
    #[error("`{name}` has {values} values for {cells} cells")]
    CellValues {
        /// Name of the quantity.
        name: String,
        /// Number of values.
        values: usize,
        /// Number of cells of the mesh.
        cells: usize,
    },
    /// Values of nodes are more or fewer than there are nodes.
    #[error("`{name}` has {values} numbers, {components} a node, for {nodes} nodes")]
    NodeValues {
        /// Name of the quantity.
        name: String,
        /// Number of numbers.
        values: usize,
        /// Numbers that a node has.
        components: usize,
        /// Number of nodes of the mesh.
        nodes: usize,
    },
    /// Something that only triangles and tetrahedra can do was asked of another cell.
    #[error("a {element} is no triangle or tetrahedron; it has to be cut into these first")]
    NotSimplices {
        /// Kind of the cell.
        element: Element,
    },
    /// Hexahedra that cannot be cut into five tetrahedra each with common faces cut alike.
    #[error(
        "the hexahedra around the edge from node {} to node {} cannot alternate: a loop of an odd number of edges leads through it",
        edge[0], edge[1]
    )]
    OddLoop {
        /// An edge of such a loop, lower node first.
        edge: [u32; 2],
    },
    /// A quantity that is needed was not given.
    #[error("`{what}` is missing: {why}")]
    Missing {
        /// Name of the quantity.
        what: &'static str,
        /// What it is needed for.
        why: &'static str,
    },
    /// A filling does not hold together as its surface does: it is too coarse.
    #[error("with a spacing of {} m the filling of {} falls into {pieces} pieces", number(*spacing), counted(*parts as u64, "closed surface", "closed surfaces"))]
    Torn {
        /// Side of the cubes of the lattice [m].
        spacing: f64,
        /// Pieces of the filling that share no node.
        pieces: usize,
        /// Closed surfaces around them.
        parts: usize,
    },
    /// A filling has far less or more volume than its surface encloses: it is too coarse.
    #[error("with a spacing of {} m the filling would have {kept:.2} of the volume{}", number(*spacing), keeps(*finer))]
    Lost {
        /// Side of the cubes of the lattice [m].
        spacing: f64,
        /// The volume of the filling over that of the surface.
        kept: f64,
        /// A spacing that keeps the volume, if one is known [m].
        finer: Option<f64>,
    },
    /// An element of space in a plane mesh, or a filled plane cell in a mesh of space.
    #[error("a {element} has no place in a mesh of {dimension} dimensions")]
    WrongDimension {
        /// Kind of the element.
        element: Element,
        /// Dimension of the mesh.
        dimension: usize,
    },
    /// Sheet quadrilateral k is not the union of sheet triangles 2k and 2k + 1.
    #[error("sheet quadrilateral {index} is not cut into sheet triangles {} and {}", 2 * u64::from(*index), 2 * u64::from(*index) + 1)]
    SheetPairing {
        /// Index of the quadrilateral.
        index: u32,
    },
    /// The boundary has free ends: open chains in the plane, boundary loops of an open surface in space.
    #[error("the boundary is not closed: {}, through nodes {nodes:?}", counted(*loops as u64, "free boundary", "free boundaries"))]
    Open {
        /// Number of open chains (plane) or boundary loops (space).
        loops: usize,
        /// One node on each, ascending: its lowest node, for an open chain its lower end.
        nodes: Vec<u32>,
    },
    /// More than two triangles meet at an edge.
    #[error("more than two triangles meet at the edges {edges:?}")]
    NonManifoldEdges {
        /// The edges, lower node first, in ascending order.
        edges: Vec<[u32; 2]>,
    },
    /// More than two edges of an outline meet at a node, or the triangles at a node form more than one fan.
    #[error("the boundary touches itself at the nodes {nodes:?}")]
    NonManifoldNodes {
        /// The nodes, in ascending order.
        nodes: Vec<u32>,
    },
    /// The surface has only one side, as a Möbius band.
    #[error("the surface through facet {facet} has only one side")]
    NonOrientable {
        /// A facet that would have to face both ways.
        facet: u32,
    },
    /// Neighbouring facets face opposite ways; [`crate::Mesh::orient_outward`] repairs it.
    #[error("{} against their neighbours, the first is facet {}", counted(facets.len() as u64, "facet faces", "facets face"), facets.first().copied().unwrap_or(0))]
    InconsistentOrientation {
        /// The minority of each connected component, in ascending order.
        facets: Vec<u32>,
    },
    /// A component with negative volume lies in no enclosing component; [`crate::Mesh::orient_outward`] repairs a mesh that is inside out.
    #[error(
        "the component through facet {facet} is inside out: its volume is {} and no other component encloses it",
        number(*signed_volume)
    )]
    InsideOut {
        /// Lowest facet of the component.
        facet: u32,
        /// Its signed area [m²] or volume [m³].
        signed_volume: f64,
    },
    /// Two rings of one body have points in common.
    #[error("the rings {first} and {second} cross or touch")]
    RingsMeet {
        /// The one, by its number from 0.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A ring lies in a ring, or a hole in a hole: the area would count twice, or be left out twice.
    #[error("ring {inner} lies inside ring {outer}, and their radii have the same sign")]
    RingsAlike {
        /// The one around, by its number from 0.
        outer: usize,
        /// The one inside.
        inner: usize,
    },
    /// A ring that is a hole lies in no other ring.
    #[error("ring {ring} is a hole, by its negative radius, and lies inside no other ring")]
    HoleInNothing {
        /// Its number from 0.
        ring: usize,
    },
    /// Elements of different dimension share one mesh, so that one density cannot give a mass.
    #[error("the mesh mixes {first} and {second} elements, which have no common measure")]
    MixedMeasures {
        /// One kind of element.
        first: Element,
        /// The other.
        second: Element,
    },
}

/// Which spacing would keep the volume.
fn keeps(finer: Option<f64>) -> String {
    finer.map_or(String::new(), |spacing| format!("; {} m would keep it", number(spacing)))
}
