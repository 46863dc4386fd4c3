//! Errors of a mesh, or of the numbers that are passed to a generator.

use opruga_math::words::{counted, number};
use opruga_math::{messages, terms};

terms! {
    /// The kinds of elements of a mesh, as messages name them.
    pub enum Element = "part.mesh_element" {
        Facet = "facet",
        Wire = "wire",
        Sheet = "sheet triangle",
        SheetQuadrilateral = "sheet quadrilateral",
        Triangle = "triangle",
        Quadrilateral = "quadrilateral",
        Tetrahedron = "tetrahedron",
        Hexahedron = "hexahedron",
        QuadraticTriangle = "quadratic triangle",
        QuadraticTetrahedron = "quadratic tetrahedron",
        Edge = "edge",
        Group = "group",
    }
}

terms! {
    /// A number that is passed to a generator.
    pub enum Quantity = "part.quantity" {
        NumberCellsPerAxis = "number of cells per axis",
        NumberCellsPerSide = "number of cells per side",
        NumberNodesAroundAxis = "number of nodes around the axis",
        NumberNodesAroundTube = "number of nodes around the tube",
        NumberPoints = "number of points",
        NumberSegments = "number of segments",
        NumberSides = "number of sides",
        NumberSubdivisions = "number of subdivisions",
        NumberVerticesPerSide = "number of vertices per side",
        NumberVertices = "number of vertices",
        CentreMap = "centre of the map",
        Centre = "centre",
        CoordinatePoint = "coordinate of a point",
        CornerQuadrilateral = "corner of the quadrilateral",
        CornerSheet = "corner of the sheet",
        EndLine = "end of the line",
        EntryMap = "entry of the map",
        LowerCornerBox = "lower corner of the box",
        LowerCornerGrid = "lower corner of the grid",
        RotationAngle = "rotation angle",
        AreaSheet = "area of the sheet",
        LengthEdges = "length of edges",
        MajorRadius = "major radius",
        MinorRadius = "minor radius",
        Radius = "radius",
        SizeBox = "size of the box",
        SizeGrid = "size of the grid",
        Spacing = "spacing",
        AreaOutline = "area of the outline",
        AreaSpannedSidesCorner = "area spanned by the sides at a corner",
        DeterminantMap = "determinant of the map",
        Dimension = "dimension",
        DistanceWelding = "welding distance",
        LengthCells = "length of `cells`",
        LengthRadii = "length of `radii`",
        StartAngle = "start angle",
        LengthNormal = "length of the normal",
        LengthRotationAxis = "length of the rotation axis",
        LengthLine = "length of the line",
        NumberCorners = "number of corners",
    }
}

terms! {
    /// The condition that a number must satisfy.
    pub enum Must = "part.must" {
        NotNegative = "0 or more, and finite",
        TwoOrThree = "2 or 3",
        NotZero = "finite and not zero",
        Finite = "finite",
        Turns = "from -1e6 to 1e6 rad",
        Positive = "positive and finite",
        Convex = "positive at every corner: four corners of a convex quadrilateral, counter-clockwise",
        BelowBody = "smaller than the body: no tetrahedron fits into it",
        BelowMajorRadius = "smaller than the major radius",
    }
}

messages! {
    /// The reasons why a mesh could not be created or read.
    #[derive(Clone, Debug, PartialEq)]
    pub enum MeshError {
        /// A count is outside the range that the generator allows.
        "part.mesh" #[error("{what} is {value}, but must be between {least} and {most}")]
        Count { what: Quantity, value: u64, least: u64, most: u64 },
        /// A length, coordinate or angle has an impossible value.
        "part.mesh" #[error("{what} is {value}, but must be {must}")]
        Size { what: Quantity, value: f64, must: Must },
        /// The mesh would have more nodes than [`crate::MAXIMUM_NODES`].
        "part.mesh" #[error("the mesh would have {nodes} nodes, but at most {most} are allowed")]
        TooManyNodes { nodes: u64, most: u64 },
        /// The boxes of edges overlap so often that there is not enough time to determine whether the edges meet.
        "part.mesh" #[error("{edges} edges run past one another so closely that more than {most} pairs would have to be compared")]
        NotCompared { edges: u64, most: u64 },
        /// Two consecutive points of an outline or chain coincide.
        "part.mesh" #[error("the consecutive points {first} and {second} are at the same position")]
        RepeatedPoint { first: u32, second: u32 },
        /// Two edges of an outline cross, touch or overlap.
        "part.mesh" #[error("the edge from point {} to point {} meets the edge from point {} to point {}",
            first[0], first[1], second[0], second[1])]
        SelfIntersection { first: [u32; 2], second: [u32; 2] },
        /// An element or group names a node that does not exist.
        "part.mesh" #[error("{element} {index} names node {node}, but there are {nodes} nodes, numbered from 0")]
        IndexOutOfRange { element: Element, index: u32, node: u32, nodes: u32 },
        /// An element names the same node twice.
        "part.mesh" #[error("{element} {index} names node {node} twice")]
        RepeatedNode { element: Element, index: u32, node: u32 },
        /// A group of cells names a cell that does not exist.
        "part.mesh" #[error("the group `{group}` names cell {cell}, but there are {cells} cells, numbered from 0")]
        CellOutOfRange { group: String, cell: u32, cells: usize },
        /// The number of values of cells differs from the number of cells.
        "part.mesh" #[error("`{name}` has {values} values for {cells} cells")]
        CellValues { name: String, values: usize, cells: usize },
        /// The number of values of nodes differs from the number of nodes.
        "part.mesh" #[error("`{name}` has {values} numbers, {components} per node, for {nodes} nodes")]
        NodeValues { name: String, values: usize, components: usize, nodes: usize },
        /// An operation that supports only triangles and tetrahedra was applied to another cell.
        "part.mesh" #[error("elements of the kind {element} are neither triangles nor tetrahedra; cut them into these first")]
        NotSimplices { element: Element },
        /// Hexahedra cannot each be cut into five tetrahedra in such a way that neighbours cut their common faces alike.
        "part.mesh" #[error("hexahedra at the edge from node {} to node {} cannot be cut into five tetrahedra each, because a loop of an odd number of edges passes through this edge",
            edge[0], edge[1])]
        OddLoop { edge: [u32; 2] },
        /// The spacing of a filling is missing.
        "part.mesh" #[error("`spacing` is missing: the side of the cubes that the filling is made of [m]")]
        NoSpacing {},
        /// A filling is so coarse that it is not connected in the same way as its surface.
        "part.mesh" #[error("with a spacing of {} m, the filling of {} falls into {pieces} pieces", number(*spacing), counted(*parts as u64, "closed surface", "closed surfaces"))]
        Torn { spacing: f64, pieces: usize, parts: usize },
        /// A filling is so coarse that its volume differs much from that enclosed by its surface.
        "part.mesh" #[error("with a spacing of {} m, the filling would have {kept:.2} of the volume{}", number(*spacing), keeps(*finer))]
        Lost { spacing: f64, kept: f64, finer: Option<f64> },
        /// A three-dimensional element in a plane mesh, or a filled plane cell in a mesh in space.
        "part.mesh" #[error("a mesh of {dimension} dimensions cannot contain elements of the kind {element}")]
        WrongDimension { element: Element, dimension: usize },
        /// Sheet quadrilateral k is not the union of sheet triangles 2k and 2k + 1.
        "part.mesh" #[error("sheet quadrilateral {index} is not cut into sheet triangles {} and {}", 2 * u64::from(*index), 2 * u64::from(*index) + 1)]
        SheetPairing { index: u32 },
        /// The boundary has free ends: open chains in the plane, boundary loops of an open surface in space.
        "part.mesh" #[error("the boundary is not closed: {}, through nodes {nodes:?}", counted(*loops as u64, "free boundary", "free boundaries"))]
        Open { loops: usize, nodes: Vec<u32> },
        /// More than two triangles meet at an edge.
        "part.mesh" #[error("more than two triangles meet at the edges {edges:?}")]
        NonManifoldEdges { edges: Vec<[u32; 2]> },
        /// More than two edges of an outline meet at a node, or the triangles at a node form more than one fan.
        "part.mesh" #[error("the boundary touches itself at the nodes {nodes:?}")]
        NonManifoldNodes { nodes: Vec<u32> },
        /// The surface has only one side, like a Möbius band.
        "part.mesh" #[error("the surface through facet {facet} has only one side")]
        NonOrientable { facet: u32 },
        /// Neighbouring facets have opposite orientations; [`crate::Mesh::orient_outward`] repairs this.
        "part.mesh" #[error("{} against their neighbours; the first is facet {}", counted(*count as u64, "facet is oriented", "facets are oriented"), first)]
        InconsistentOrientation { count: usize, first: u32 },
        /// A component with negative volume is in no enclosing component; [`crate::Mesh::orient_outward`] repairs a mesh that is inside out.
        "part.mesh" #[error("the component through facet {facet} is inside out: its volume is {} and no other component encloses it",
            number(*signed_volume))]
        InsideOut { facet: u32, signed_volume: f64 },
        /// Two rings of one body have points in common.
        "part.mesh" #[error("the rings {first} and {second} cross or touch")]
        RingsMeet { first: usize, second: usize },
        /// A ring directly inside a ring, or a hole directly inside a hole: the area would count twice, or be removed twice.
        "part.mesh" #[error("ring {inner} lies inside ring {outer}, and their radii have the same sign")]
        RingsAlike { outer: usize, inner: usize },
        /// A ring that is a hole is inside no other ring.
        "part.mesh" #[error("ring {ring} is a hole, because its radius is negative, but it lies inside no other ring")]
        HoleInNothing { ring: usize },
        /// Elements of different dimensions share one mesh, so a single density cannot define a mass.
        "part.mesh" #[error("the mesh mixes {first} and {second} elements, which have no common measure")]
        MixedMeasures { first: Element, second: Element },
    }
}

/// The end of a message: a spacing that would keep the volume, if there is one.
fn keeps(finer: Option<f64>) -> String {
    finer.map_or(String::new(), |spacing| format!("; a spacing of {} m would keep it", number(spacing)))
}
