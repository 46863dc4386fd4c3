//! Errors of the readers of single mesh formats.

use super::errors::Listed;
use super::terms::{ElementName, Expected};
use opruga_math::messages;

messages! {
    /// Errors in a Gmsh file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum GmshError {
        "msh.syntax" #[error("`{word}` is between sections")] #[value("{word}")] #[allowed("a section such as $Nodes")]
        BetweenSections { word: String },
        "msh.syntax" #[error("the section ${section} comes after the elements")] #[value("${section}")] #[allowed("before $Elements")]
        BehindElements { section: String },
        "msh.syntax" #[error("the elements come before the nodes")] #[value("$Elements")] #[allowed("$Nodes")]
        ElementsFirst {},
        "msh.syntax" #[error("there is a second section ${section}")] #[value("${section}")] #[allowed("one")]
        SecondSection { section: String },
        "msh.version" #[error("version `{version}` cannot be read")] #[value("{version}")] #[allowed("2.2 or 4.1")]
        #[hint("with `-format msh41` or `-format msh22`, Gmsh writes a version that can be read")]
        Version { version: String },
        "msh.syntax" #[error("{kind} is not a file type")] #[value("{kind}")] #[allowed("0 (text) or 1 (binary)")]
        FileKind { kind: u32 },
        "msh.version" #[error("numbers have {size} bytes")] #[value("{size}")] #[allowed("8")]
        NumberSize { size: u32 },
        "msh.endianness" #[error("{number} was found instead of 1")] #[value("{number}")]
        #[allowed("1, in the byte order of the file")]
        Endianness { number: i32 },
        "msh.syntax" #[error("a group has {dimension} dimensions")] #[value("{dimension}")] #[allowed("0 to 3")]
        GroupDimension { dimension: usize },
        "msh.syntax" #[error("the name of a group is not in quotes")] #[value("{text}")] #[allowed("\"name\"")]
        GroupQuotes { text: String },
        "msh.syntax" #[error("group {group} of {dimension} dimensions already has the name `{name}`")] #[value("{group}")]
        #[allowed("one name for every group of a dimension")]
        GroupTwice { group: i64, dimension: usize, name: String },
        "msh.syntax" #[error("the section ${section} has no end")] #[value("${section}")] #[allowed("$End{section}")] #[hint("the file is cut off")]
        NoEnd { section: String },
        "msh.syntax" #[error("the step, the number of components and the number of values are missing")] #[value("{tags}")] #[allowed("at least 3 integer tags")]
        FewTags { tags: usize },
        "mesh.index" #[error("a value is given for element {element}, which does not exist")] #[value("{element}")] #[allowed("the number of an element")]
        NoElement { element: u64 },
        "mesh.duplicate_node" #[error("values are given twice for node {node}")] #[value("{node}")] #[allowed("every node once")]
        NodeValueTwice { node: u64 },
        "mesh.duplicate_element" #[error("values are given twice for element {element}")] #[value("{element}")] #[allowed("every element once")]
        ElementValueTwice { element: u64 },
        "msh.size" #[error("a block has a negative number of elements or tags")] #[value("{elements}, {tags}")] #[allowed("0 or more")]
        NegativeBlock { elements: i32, tags: i32 },
        "msh.size" #[error("a block has {elements} elements")] #[value("{elements}")] #[allowed("1 to {most}")]
        BlockSize { elements: usize, most: usize },
        "msh.syntax" #[error("an entity has {dimension} dimensions")] #[value("{dimension}")] #[allowed("0 to 3")]
        EntityDimension { dimension: i32 },
        "msh.syntax" #[error("two entities of {dimension} dimensions have the number {entity}")] #[value("{entity}")]
        #[allowed("a different number for every entity of a dimension")]
        EntityTwice { dimension: usize, entity: i32 },
        "msh.size" #[error("the header declares {what} numbered from {lowest} to {highest}, but the file numbers them from {low} to {high}")]
        #[value("{lowest}, {highest}")] #[allowed("{low}, {high}")]
        #[hint("the header of the section is wrong, or a part of its content is missing")]
        Bounds { what: Expected, lowest: u64, highest: u64, low: u64, high: u64 },
        "msh.syntax" #[error("the flag of parametric nodes is {parametric}")] #[value("{parametric}")] #[allowed("0 or 1")]
        Parametric { parametric: i32 },
        "msh.size" #[error("{promised} {what} are declared, but there are {there}")] #[value("{promised}")] #[allowed("{there}")]
        Promised { promised: u64, what: Expected, there: usize },
        "msh.syntax" #[error("an entity of {dimension} dimensions has elements of the kind {element}")] #[value("{dimension}")] #[allowed("{wanted}")]
        ElementOfEntity { dimension: usize, element: ElementName, wanted: usize },
        "mesh.index" #[error("$Entities lists no entity {entity} of dimension {dimension}")] #[value("{entity}")] #[allowed("{listed}")]
        NoEntity { entity: i32, dimension: usize, listed: Listed },
    }

    /// Errors in a Medit file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MeditError {
        "medit.version" #[error("version `{version}` cannot be read")] #[value("{version}")] #[allowed("1 to 4")]
        Version { version: u32 },
        "medit.syntax" #[error("the dimension is {dimension}")] #[value("{dimension}")] #[allowed("2 or 3")]
        Dimension { dimension: usize },
        "medit.syntax" #[error("vertices are given twice")] #[value("Vertices")] #[allowed("Dimension, then Vertices once")]
        VerticesTwice {},
        "medit.syntax" #[error("the vertices come before the dimension")] #[value("Vertices")] #[allowed("Dimension, then Vertices once")]
        VerticesFirst {},
        "mesh.unsupported_element" #[error("{keyword} cannot be read")] #[value("{keyword}")]
        #[allowed("Edges, Triangles, Quadrilaterals, Tetrahedra, Hexahedra")]
        Unsupported { keyword: String },
        "mesh.unsupported_element" #[error("{keyword} cannot be read")] #[value("{keyword}")]
        #[allowed("Edges, Triangles, Quadrilaterals, Tetrahedra, Hexahedra")]
        #[hint("triangles of 6 nodes and tetrahedra of 10 are read from Gmsh and VTK files")]
        Quadratic { keyword: String },
        "medit.syntax" #[error("`{word}` is not a keyword that can be read")] #[value("{word}")]
        #[allowed("Dimension, Vertices, Triangles, Tetrahedra … or End")]
        Keyword { word: String },
        "medit.syntax" #[error("{section} come before the vertices")] #[value("{section}")] #[allowed("Vertices")]
        BeforeVertices { section: String },
        "medit.syntax" #[error("something follows `End`")] #[value("{word}")] #[allowed("the end of the file")]
        BehindEnd { word: String },
    }

    /// Errors in an MFEM file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MfemError {
        "mfem.version" #[error("version `{version}` cannot be read")] #[value("{version}")] #[allowed("v1.0, v1.2, v1.3")]
        Version { version: String },
        "mfem.syntax" #[error("something follows `mfem_mesh_end`")] #[value("{word}")] #[allowed("the end of the file")]
        BehindEnd { word: String },
        "mfem.syntax" #[error("the dimension is {dimension}")] #[value("{dimension}")] #[allowed("1, 2 or 3")]
        Dimension { dimension: usize },
        "mfem.syntax" #[error("`{section}` comes before `dimension`")] #[value("{section}")] #[allowed("dimension")]
        BeforeDimension { section: String },
        "mfem.curved" #[error("curved elements (`nodes`) cannot be read")] #[value("nodes")] #[allowed("`vertices` with coordinates")]
        #[hint("save the mesh without `nodes`, with straight sides; curved cells of second order can be read from Gmsh and VTK files")]
        Curved {},
        "mfem.syntax" #[error("`{word}` is not a section that can be read")] #[value("{word}")] #[allowed("dimension, elements, boundary, vertices")]
        Section { word: String },
        "mesh.index" #[error("a boundary element names vertex {vertex}")] #[value("{vertex}")] #[allowed("0 to {most}")]
        NoVertexOfBoundary { vertex: u64, most: usize },
        "mesh.index" #[error("an element names vertex {vertex}")] #[value("{vertex}")] #[allowed("0 to {most}")]
        NoVertexOfElement { vertex: u64, most: usize },
        "mesh.mixed_dimension" #[error("`{section}` of a mesh of {dimension} dimensions has elements of the kind {element}")]
        #[value("{geometry}")] #[allowed("{wanted}")]
        ElementOfSection { section: &'static str, dimension: usize, element: ElementName, geometry: u64, wanted: Geometry },
        "mfem.syntax" #[error("vertices have {coordinates} coordinates")] #[value("{coordinates}")] #[allowed("{wanted}")]
        Coordinates { coordinates: usize, wanted: Counts },
    }

    /// Errors in TetGen files.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum TetgenError {
        "tetgen.syntax" #[error("nodes have {coordinates} coordinates")] #[value("{coordinates}")] #[allowed("2 or 3")]
        Coordinates { coordinates: usize },
        "tetgen.syntax" #[error("nodes have {markers} markers")] #[value("{markers}")] #[allowed("0 or 1")]
        Markers { markers: usize },
        "mesh.unsupported_element" #[error("elements have {nodes} nodes")] #[value("{nodes}")] #[allowed("4 (tetrahedra) or 3 (triangles)")]
        #[hint("TetGen writes linear tetrahedra without the option -o2")]
        Corners { nodes: usize },
        "tetgen.syntax" #[error("found element {element} instead of element {wanted}")] #[value("{element}")] #[allowed("{wanted}")]
        Order { element: u64, wanted: u64 },
        "tetgen.size" #[error("the file continues after the lines that its header declares")] #[value("more lines")] #[allowed("as many lines as declared")]
        Behind {},
    }
}

opruga_math::terms! {
    /// The elements of MFEM in one dimension, with their numbers.
    pub(crate) enum Geometry = "part.geometry" {
        Point = "0 (point)",
        Line = "1 (line)",
        Plane = "2 (triangle) or 3 (quadrilateral)",
        Space = "4 (tetrahedron) or 5 (hexahedron)",
    }
}

opruga_math::terms! {
    /// The allowed numbers of coordinates.
    pub(crate) enum Counts = "part.counts" { OneToThree = "1, 2 or 3", TwoOrThree = "2 or 3", Three = "3" }
}
