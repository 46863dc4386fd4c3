//! Errors and notices of the readers of mesh files.

use super::ENDINGS;
use super::terms::{ElementName, Expected};
use opruga_math::message::{AnyMessage, Setting, if_any};
use opruga_math::words::counted;
use opruga_math::{messages, terms};
use opruga_mesh::MeshError;

/// A kind of element with its article.
fn one(name: &ElementName) -> String {
    let name = name.to_string();
    format!("{} {name}", if name.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" })
}

/// Returns a phrase with the number of cells that share the fault of the named cell; empty if there is only one.
fn among(count: usize, cells: usize) -> String {
    if count == 1 { String::new() } else { format!(" ({count} of {cells} are)") }
}

terms! {
    /// What helps if a number cannot be read.
    pub(crate) enum NumberHint = "part.number_hint" { Comma = "write a decimal point, not a comma" }
}

terms! {
    /// The order of the corners of a cell.
    pub(crate) enum CornerOrder = "part.corner_order" {
        Plane = "a positive area: corners counter-clockwise",
        Space = "a positive volume: the other corners run counter-clockwise as seen from the last one",
    }
}

messages! {
    /// The numbers that an array or a word may hold.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum NumberRange {
        "part.number_range" #[error("a number such as 1.5 or -2e-3")]
        Real {},
        "part.number_range" #[error("a number >= {least} and <= {most}")]
        Between { least: String, most: String },
        "part.number_range" #[error("a whole number from {least} to {most}")]
        Whole { least: i128, most: i128 },
    }

    /// The nodes or entities that a file has.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Listed {
        "part.listed" #[error("one of the {count} nodes from {first} to {last}")]
        Nodes { count: usize, first: u64, last: u64 },
        "part.listed" #[error("the file has no nodes")]
        NoNodes {},
        "part.listed" #[error("$Entities lists no entity of dimension {dimension}")]
        NoEntities { dimension: usize },
        "part.listed" #[error("{entity}")]
        Entity { entity: i32 },
        "part.listed" #[error("one of the {count} listed from {first} to {last}")]
        Entities { count: usize, first: i32, last: i32 },
    }

    /// A word in quotes that is expected somewhere.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Keyword {
        "part.keyword" #[error("`{word}`")]
        One { word: String },
        "part.keyword" #[error("`{first}` and `{second}`")]
        Two { first: &'static str, second: &'static str },
    }

    /// Errors in words and numbers of any format. Each error gets the code of its format.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ScanError {
        "part.scan" #[error("the file ends where {wanted} should follow")]
        #[value("end of file")] #[hint("the file is cut off")]
        Ends { wanted: AnyMessage },
        "part.scan" #[error("the file ends in the middle of its last line, possibly in a number")]
        #[value("{word}")] #[allowed("a line break after the last word")]
        #[hint("if the file is complete, end its last line with a line break; if not, it is cut off")]
        CutLine { word: String },
        "part.scan" #[error("something follows {of}")] #[value("{word}")] #[allowed("the end of the line")]
        Behind { of: Expected, word: String },
        "part.scan" #[error("found `{word}` instead of `{wanted}`")] #[value("{word}")] #[allowed("{wanted}")]
        Other { word: String, wanted: String },
        "part.scan" #[error("found `{word}` instead of {what}")] #[value("{word}")] #[allowed("a whole number")]
        NotWhole { word: String, what: Expected },
        "part.scan" #[error("found `{word}` instead of {what}")] #[value("{word}")] #[allowed("{allowed}")] #[hint("{}", if_any(hint))]
        NotNumber { word: String, what: Expected, allowed: NumberRange, hint: Option<NumberHint> },
        "scene.not_finite" #[error("{what} is not finite")] #[value("{number}")] #[allowed("a finite number")]
        NotFiniteNumber { what: Expected, number: f64 },
        "part.scan" #[error("{count} {what} are declared, but only {rest} bytes follow")]
        #[value("{count}")] #[allowed("at most {most}")] #[hint("the file is cut off")]
        Promised { count: u64, what: Expected, rest: u64, most: u64 },
        "part.scan" #[error("there is a second section `{section}`")] #[value("{section}")] #[allowed("one")]
        SecondSection { section: String },
        "part.scan" #[error("`{word}` is not a number type")] #[value("{word}")] #[allowed("{allowed}")]
        NumberType { word: String, allowed: &'static str },
        "part.scan" #[error("the array `{name}` of the points is given twice")] #[value("{name}")] #[allowed("a different name for every array")]
        PointValuesTwice { name: String },
        "part.scan" #[error("the array `{name}` of the cells is given twice")] #[value("{name}")] #[allowed("a different name for every array")]
        CellValuesTwice { name: String },
    }

    /// Errors in the nodes and elements of a file of any format.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MeshFileError {
        "mesh.empty" #[error("the file is empty")] #[value("0 bytes")] #[allowed("a mesh")]
        Empty {},
        "mesh.format" #[error("the file is not a mesh of MFEM or Medit")] #[value("{word}")]
        #[allowed("`MFEM mesh v1.0` or `MeshVersionFormatted 2` at its start")]
        NeitherMfemNorMedit { word: String },
        "mesh.unsupported_element" #[error("{} (type {number}) cannot be read", one(element))] #[value("{number}")]
        #[allowed("points, lines of 2 or 3 nodes, triangles of 3 or 6, quadrilaterals of 4, tetrahedra of 4 or 10, hexahedra of 8")]
        UnsupportedType { element: ElementName, number: i64 },
        "mesh.unsupported_element" #[error("{} (geometry {number}) cannot be read", one(element))] #[value("{number}")]
        #[allowed("points, lines of 2 or 3 nodes, triangles of 3 or 6, quadrilaterals of 4, tetrahedra of 4 or 10, hexahedra of 8")]
        UnsupportedGeometry { element: ElementName, number: u64 },
        "mesh.unsupported_element" #[error("cell {cell}, a {element} (type {number}), cannot be read")] #[value("{number}")]
        #[allowed("points, lines of 2 or 3 nodes, triangles of 3 or 6, quadrilaterals of 4, tetrahedra of 4 or 10, hexahedra of 8")]
        UnsupportedCell { cell: u64, element: ElementName, number: i128 },
        "mesh.duplicate_element" #[error("two elements have the number {number}")] #[value("{number}")]
        #[allowed("a different number for every element")]
        ElementTwice { number: u64 },
        "mesh.duplicate_node" #[error("two nodes have the number {number}")] #[value("{number}")]
        #[allowed("a different number for every node")]
        NodeTwice { number: u64 },
        "mesh.components" #[error("`{name}` has {before} numbers at some nodes and {components} at others")] #[value("{components}")] #[allowed("{before}")]
        Components { before: usize, name: String, components: usize },
        "mesh.index" #[error("element {element} names node {node}, which does not exist")] #[value("{node}")] #[allowed("{listed}")]
        NoNode { element: u64, node: u64, listed: Listed },
        "mesh.index" #[error("a value is given for node {node}, which does not exist")] #[value("{node}")] #[allowed("{listed}")]
        NoNodeOfValue { node: u64, listed: Listed },
        "mesh.index" #[error("{element} {index} names vertex {vertex}")] #[value("{vertex}")] #[allowed("{least} to {most}")]
        NoVertex { element: ElementName, index: usize, vertex: u64, least: u64, most: u64 },
        "mesh.empty" #[error("the file contains no elements")] #[value("0")] #[allowed("at least one element")]
        NoElements {},
        "mesh.dimension" #[error("the file contains only points")] #[value("{element}")]
        #[allowed("lines, triangles, quadrilaterals, tetrahedra or hexahedra")]
        PointsOnly { element: ElementName },
        "mesh.dimension" #[error("the file contains a surface in 3D, but no cells that fill it")] #[value("{element}")]
        #[allowed("tetrahedra or hexahedra")]
        #[hint("`kind = \"surface\"` reads surfaces; with `filling = \"tetrahedra\"` it fills them")]
        SurfaceInSpace { element: ElementName },
        "mesh.dimension" #[error("the file contains 3D elements, but the scene is 2D")] #[value("{element}")]
        #[allowed("triangles or quadrilaterals")] #[hint("write `dimension = 3` at the top of the scene")]
        SpaceInPlane { element: ElementName },
        "mesh.dimension" #[error("node {node} lies outside the plane of the first node")] #[value("{z}")]
        #[allowed("z = {plane}")] #[hint("write `dimension = 3` at the top of the scene")]
        OutOfPlane { node: u64, z: String, plane: String },
        "mesh.dimension" #[error("the file contains the cells of a filled body, not a surface")] #[value("3")]
        #[allowed("triangles and quadrilaterals")] #[hint("`kind = \"mesh\"` reads filled bodies")]
        NoSurface {},
        "shape.too_large" #[error("the mesh has {nodes} nodes")] #[value("{nodes}")] #[allowed("at most {most}")]
        TooManyNodes { nodes: usize, most: u64 },
        "mesh.degenerate_element" #[error("{element} {index} names node {node} twice")] #[value("{node}")] #[allowed("every node once")]
        RepeatedNode { element: ElementName, index: u64, node: u64 },
        "mesh.duplicate_element" #[error("elements {first} and {second} have the same nodes")] #[value("{second}")]
        #[hint("leave one of them out")]
        SameNodes { first: u64, second: u64 },
        "mesh.mixed_dimension" #[error("{element} {index} is not part of a cell")] #[value("{index}")]
        #[allowed("faces, edges and corners of the cells, or a one-dimensional body")]
        NoPartOfCell { element: ElementName, index: u64 },
        "mesh.degenerate_element" #[error("{element} {index} has almost no area for its size")] #[value("{area}")]
        #[allowed("more than {least} times its longest edge squared")]
        NoArea { element: ElementName, index: u64, area: String, least: String },
        "mesh.degenerate_element" #[error("{element} {index} has almost no volume for its size")] #[value("{volume}")]
        #[allowed("more than {least} times its longest edge cubed")]
        NoVolume { element: ElementName, index: u64, volume: String, least: String },
        "mesh.inverted" #[error("{element} {index} folds over itself{}", among(*count, *cells))] #[value("{measure}")] #[allowed("{order}")]
        Folded { element: ElementName, index: u64, count: usize, cells: usize, measure: String, order: CornerOrder },
        "mesh.inverted" #[error("{element} {index} is inverted{}", among(*count, *cells))] #[value("{measure}")] #[allowed("{order}")]
        #[hint("{turn} flips and counts such cells")]
        Inverted { element: ElementName, index: u64, count: usize, cells: usize, measure: String, order: CornerOrder, turn: Setting },
        "mesh.inverted" #[error("{element} {index} is inverted{}", among(*cells, *cells))] #[value("{measure}")] #[allowed("{order}")]
        #[hint("all cells of the file have the opposite orientation: {turn} flips and counts them")]
        AllInverted { element: ElementName, index: u64, cells: usize, measure: String, order: CornerOrder, turn: Setting },
        "mesh.topology" #[error("{problem}")]
        Topology { problem: MeshError },
        "mesh.non_manifold" #[error("more than two cells share the face through nodes {first} and {second}")]
        #[value("{edges}")] #[allowed("at most two cells at a face")]
        Crowded { first: u64, second: u64, edges: usize },
        "mesh.unreferenced" #[error("node {first} belongs to no cell")] #[value("{first}")] #[allowed("nodes of cells")]
        #[hint("{leave_out} leaves such nodes out and counts them")]
        LooseNode { first: u64, leave_out: Setting },
        "mesh.unreferenced" #[error("{count} nodes belong to no cell; the first is node {first}")] #[value("{first}")] #[allowed("nodes of cells")]
        #[hint("{leave_out} leaves such nodes out and counts them")]
        LooseNodes { count: usize, first: u64, leave_out: Setting },
    }

    /// Parts of a mesh file that are omitted or repaired.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MeshFileNotice {
        "mesh.left_out" #[error("the section ${section} is left out")] #[value("{section}")]
        Section { section: String },
        "mesh.left_out" #[error("values of {components} components are left out: `{name}`")] #[value("{components}")]
        Components { components: u64, name: String },
        "mesh.left_out" #[error("{} left out of the values `{name}`", counted(*count, "later step is", "later steps are"))] #[value("{count}")]
        LaterSteps { count: u64, name: String },
        "mesh.left_out" #[error("{} left out", counted(*count as u64, "attribute of every node is", "attributes of every node are"))] #[value("{count}")]
        Attributes { count: usize },
        "mesh.left_out" #[error("the values `{name}` are left out")] #[value("{name}")]
        Values { name: String },
        "mesh.left_out" #[error("the colours `{name}` are left out")] #[value("{name}")]
        Colours { name: String },
        "mesh.left_out" #[error("{count} {section} are left out")] #[value("{count}")]
        Lines { count: u64, section: String },
        "mesh.left_out" #[error("z = {z} of all nodes is left out")] #[value("{z}")]
        PlaneOffset { z: String },
        "mesh.left_out" #[error("{count} more items are left out")] #[value("{count}")]
        More { count: usize },
        "mesh.flipped" #[error("{} of {cells} flipped", counted(*count as u64, "inverted cell", "inverted cells"))] #[value("{count}")]
        Turned { count: usize, cells: usize },
        "mesh.unreferenced" #[error("{} left out", counted(*count as u64, "node that no cell uses is", "nodes that no cell uses are"))] #[value("{count}")]
        Unreferenced { count: usize },
    }
}

messages! {
    /// Reasons why a file is not read as a mesh.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum EndingError {
        "shape.format" #[error("files ending in `.{ending}` cannot be read")] #[value("{name}")] #[allowed("a file ending in {ENDINGS}")]
        Unreadable { name: String, ending: String },
    }
}
