//! Errors and notices of the readers of surfaces and of the merging of vertices.

use opruga_math::message::Setting;
use opruga_math::messages;
use opruga_math::words::{counted, number};
use opruga_mesh::MeshError;

/// The requirement for the corners of a face.
const CORNERS: &str = "at least three different corners, of a face that is nearly flat and does not cross itself";

/// `is` or `are`.
fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// The number of faces with more than three corners.
fn polygons(count: usize) -> String {
    format!("{} with more than three corners", counted(count as u64, "face", "faces"))
}

/// The number of pairs, exactly or as a lower bound.
fn pairs(count: usize, complete: bool) -> String {
    if complete { counted(count as u64, "pair", "pairs") } else { format!("at least {count} pairs") }
}

messages! {
    /// Why a face cannot be divided into triangles.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum FaceProblem {
        "mesh.degenerate_face" #[error("a face has fewer than three corners")]
        #[allowed("{CORNERS}")]
        Few {},
        "mesh.degenerate_face" #[error("a face names a vertex twice")]
        #[allowed("{CORNERS}")]
        Twice {},
        "mesh.degenerate_face" #[error("a face crosses or touches itself, or encloses nothing")]
        #[allowed("{CORNERS}")]
        Crossing {},
        "mesh.degenerate_face" #[error("a face is far from flat: the distance of a corner from its plane is {off} of the size of the face")]
        #[allowed("{CORNERS}")]
        Bent { off: String },
    }

    /// Errors in a surface of any format.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SurfaceError {
        "mesh.empty" #[error("the file contains no triangles")] #[value("0")] #[allowed("at least one triangle")]
        NoTriangles {},
        "mesh.index" #[error("{problem}")]
        Index { problem: MeshError },
        "scene.range" #[error("{problem}")]
        Weld { problem: MeshError },
        "scene.missing" #[error("{problem}")]
        Filling { problem: MeshError },
        "mesh.duplicate_element" #[error("triangles {first} and {second} have the same corners")] #[value("{second}")] #[hint("leave one of them out")]
        SameCorners { first: u32, second: u32 },
        "mesh.degenerate_face" #[error("triangle {triangle} has almost no area for its size")] #[value("{area}")]
        #[allowed("an area above {least} times its longest edge squared")]
        NoArea { triangle: u32, area: String, least: String },
        "mesh.degenerate_face" #[error("triangle {triangle} has two corners at the same vertex if vertices within {distance} m are joined")]
        #[value("{distance}")] #[hint("use a smaller {weld}, or leave the triangle out")]
        Joined { triangle: u32, distance: f64, weld: Setting },
        "mesh.degenerate_face" #[error("triangle {triangle} names a vertex twice")] #[value("{corners}")] #[allowed("three different vertices")]
        VertexTwice { triangle: usize, corners: String },
        "mesh.index" #[error("triangle {triangle} names vertex {vertex}")] #[value("{vertex}")] #[allowed("below {count}")]
        NoVertexOfTriangle { triangle: usize, vertex: u32, count: usize },
        "mesh.degenerate_face" #[error("{problem}: face {face}")] #[value("{corners}")] #[allowed("{CORNERS}")]
        Face { problem: FaceProblem, face: u64, corners: String },
        "mesh.degenerate_face" #[error("{problem}: element {element}")] #[value("{corners}")] #[allowed("{CORNERS}")]
        Element { problem: FaceProblem, element: u64, corners: String },
        "mesh.open" #[error("an open surface has no inside to fill")] #[value("{filling}")] #[hint("close it with {cap}")]
        NothingToFill { filling: String, cap: Setting },
        "mesh.open" #[error("an open surface cannot be remeshed")] #[allowed("a closed surface")] #[hint("close it with {cap}")]
        NotRemeshed { cap: Setting },
        "mesh.open" #[error("the surface is not closed: {}, through {positions}", counted(*loops as u64, "free boundary", "free boundaries"))]
        #[value("{loops}")] #[allowed("a closed surface")]
        Open { loops: usize, positions: String },
        "mesh.dimension" #[error("a closed surface is flat: it encloses no volume")] #[value("{volume}")]
        #[allowed("a volume above 1e-12 times its extent cubed")]
        Flat { volume: String },
        "mesh.non_manifold" #[error("parts of the surface are joined only at a vertex: {positions}")] #[value("{count}")]
        #[allowed("triangles that form one fan around every vertex")] #[hint("move the parts apart, or give each a vertex of its own")]
        Pinched { positions: String, count: usize },
        "mesh.non_manifold" #[error("more than two triangles meet at {}: {positions}", counted(*count as u64, "edge", "edges"))]
        #[value("{count}")] #[allowed("at most two")]
        CrowdedEdges { count: usize, positions: String },
        "mesh.non_orientable" #[error("the surface has only one side, like a Möbius strip")] #[value("{facet}")]
        OneSided { facet: u32 },
        "mesh.self_intersection"
        #[error("the surface meets itself: triangle {first} around ({first_center}) crosses, touches or overlaps triangle {second} around ({second_center})")]
        #[value("{}", pairs(*count, *complete))] #[allowed("triangles that meet only at common vertices and edges")]
        #[hint("{keep} accepts the surface as it is")]
        MeetsItself { first: u32, first_center: String, second: u32, second_center: String, count: usize, complete: bool, keep: Setting },
        "mesh.size" #[error("the extent of the surface is zero or out of range")] #[value("{extent}")] #[allowed("an extent from 1e-150 to 1e150")]
        Extent { extent: String },
        "scene.not_finite" #[error("a coordinate of vertex {vertex} is {value}")] #[value("{value}")] #[allowed("a finite number")]
        NotFiniteVertex { vertex: usize, value: String },
        "scene.not_finite" #[error("a coordinate is {value}")] #[value("{value}")] #[allowed("a finite number")]
        NotFiniteCoordinate { value: String },
    }

    /// Parts of a surface that are omitted, changed or remarkable.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SurfaceNotice {
        "mesh.concave_face" #[error("{count} of {} {} concave; they were divided along diagonals that lie inside", polygons(*faces), are(*count))] #[value("{count}")]
        Concave { count: usize, faces: usize },
        "mesh.bent_face" #[error("{count} of {} {} not flat (with a deviation of up to {off} of their size); they were divided along the better diagonals", polygons(*faces), are(*count))]
        #[value("{count}")]
        BentFaces { count: usize, faces: usize, off: String },
        "mesh.sliver"
        #[error("{count} of {} {}; the thinnest is triangle {thinnest}, with an area of {} times its longest edge squared", counted(*triangles as u64, "triangle", "triangles"), if *count == 1 { "is a sliver" } else { "are slivers" }, number(*area))]
        #[value("{count}")] #[allowed("areas of at least {least}")] #[hint("{remesh} makes nearly equilateral triangles")]
        Slivers { count: usize, triangles: usize, thinnest: usize, area: f64, least: String, remesh: Setting },
        "mesh.unreferenced" #[error("{} left out", counted(*count as u64, "vertex that no triangle uses is", "vertices that no triangle uses are"))] #[value("{count}")]
        UnreferencedVertices { count: usize },
        "mesh.scale" #[error("the extent of the surface is {} m", number(*extent))] #[value("{extent}")]
        #[allowed("{} m to {} m, if {size} is not given", number(*least), number(*most))]
        Scale { extent: f64, least: f64, most: f64, size: Setting },
        "mesh.welded" #[error("{count} of {vertices} vertices {} joined to others", are(*count))] #[value("{count}")]
        Welded { count: usize, vertices: usize },
        "mesh.capped" #[error("{} closed by fans of triangles", counted(*count as u64, "free boundary is", "free boundaries are"))] #[value("{count}")]
        Capped { count: usize },
        "mesh.flipped" #[error("{} flipped", counted(*count as u64, "triangle oriented against its neighbours is", "triangles oriented against their neighbours are"))]
        #[value("{count}")]
        Against { count: usize },
        "mesh.flipped" #[error("{} flipped", counted(*count as u64, "component that is inside out is", "components that are inside out are"))] #[value("{count}")]
        InsideOut { count: usize },
        "mesh.not_compared" #[error("too many triangles lie close together: not all were compared, and some may cross")]
        NotCompared {},
        "mesh.self_intersection" #[error("{} of triangles cross, touch or overlap", pairs(*count, true))] #[value("{count}")]
        Crossings { count: usize },
        "mesh.self_intersection" #[error("{} of triangles cross, touch or overlap", pairs(*count, false))] #[value("{count}")]
        ManyCrossings { count: usize },
        "mesh.strokes" #[error("{} left out", counted(*count as u64, "line or point is", "lines and points are"))] #[value("{count}")]
        Strokes { count: usize },
    }

    /// Errors in an OBJ file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ObjError {
        "obj.syntax" #[error("a vertex has fewer than three coordinates")] #[allowed("v x y z")]
        FewCoordinates {},
        "obj.syntax" #[error("a vertex has more than seven numbers")] #[allowed("v x y z, with a weight or a colour")]
        ManyNumbers {},
        "obj.syntax" #[error("a vertex has five numbers")] #[allowed("3 numbers, 4 with a weight, 6 with a colour, 7 with both")]
        FiveNumbers {},
        "obj.syntax" #[error("a corner of a face is not a whole number")] #[allowed("v, v/vt, v//vn or v/vt/vn")]
        Corner {},
        "mesh.index" #[error("indices begin at 1")] #[allowed("1 to {count}, or -{count} to -1")]
        Zero { count: i64 },
        "mesh.index" #[error("the index is before the first vertex")] #[allowed("1 to {count}, or -{count} to -1")]
        BeforeFirst { count: i64 },
        "obj.syntax" #[error("statement `{word}` cannot be read")] #[value("{word}")]
        #[allowed("v, vt, vn, vp, f, l, p, o, g, s, usemtl, mtllib, # comments")]
        Statement { word: String },
        "mesh.index" #[error("a face names a `{what}` that does not exist")] #[allowed("no `{what}`: the file has none")]
        NoExtras { what: &'static str },
        "mesh.index" #[error("a face names a `{what}` that does not exist")] #[allowed("1 to {count}, or -{count} to -1")]
        NoExtra { what: &'static str, count: i64 },
        "mesh.index" #[error("there is no vertex {vertex}")] #[value("{vertex}")] #[allowed("1 to {count}")]
        NoVertexOfFile { vertex: i64, count: usize },
        "scene.not_finite" #[error("a coordinate is not finite")] #[allowed("a finite number")]
        NotFiniteNumberOfVertex {},
        "shape.number" #[error("this is not a number")] #[allowed("a number such as 1.5 or -2e-3")]
        NoNumber {},
    }

    /// Parts of an OBJ file that are omitted.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ObjNotice {
        "obj.weight" #[error("{} other than 1, which triangles cannot use", counted(*count as u64, "vertex has a weight", "vertices have weights"))]
        #[value("{count}")]
        Weights { count: usize },
    }

    /// Errors in a PLY file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum PlyError {
        "ply.size" #[error("the header declares {count} elements `{element}`, but only {rest} bytes follow")] #[value("{count}")]
        #[allowed("at most {most}")] #[hint("the file is cut off")]
        Promised { count: u64, element: String, rest: usize, most: usize },
        "ply.syntax" #[error("`vertex` has no properties x, y, z")] #[value("vertex")]
        NoCoordinates {},
        "ply.syntax" #[error("`face` has no list vertex_indices")] #[value("face")]
        NoIndices {},
        "ply.syntax" #[error("the file does not declare the element `{element}`, or declares it too late")] #[value("{element}")]
        NoElement { element: &'static str },
        "mesh.index" #[error("face {face} names vertex {vertex}")] #[value("{vertex}")] #[allowed("0 to {most}")]
        NoVertexOfFace { face: u64, vertex: f64, most: usize },
        "ply.size" #[error("{count} bytes follow the last element")] #[value("{count}")] #[allowed("0 bytes")]
        Behind { count: usize },
        "ply.syntax" #[error("the header has no end")] #[allowed("end_header")]
        NoEnd {},
        "ply.syntax" #[error("the file does not begin with `ply`")] #[allowed("ply")]
        NoMagic {},
        "ply.syntax" #[error("the format is unknown")] #[allowed("ascii, binary_little_endian, binary_big_endian")]
        Format {},
        "ply.syntax" #[error("the count is not a whole number")] #[allowed("0 or more")]
        Count {},
        "ply.syntax" #[error("the property cannot be read")] #[allowed("property list TYPE TYPE name, below an element")]
        ListProperty {},
        "ply.syntax" #[error("the count of a list is not a whole number")] #[allowed("an integer type")]
        ListCount {},
        "ply.syntax" #[error("the property cannot be read")] #[allowed("property TYPE name, below an element")]
        Property {},
        "ply.syntax" #[error("this line cannot be read")] #[allowed("format, comment, element, property, end_header")]
        Line {},
        "ply.syntax" #[error("the header is too long")] #[allowed("at most 1000 elements and 10000 properties")]
        LongHeader {},
        "ply.syntax" #[error("the header names no format")] #[allowed("format ascii 1.0")]
        NoFormat {},
        "ply.size" #[error("a list of `{property}` has {length} values")] #[value("{length}")]
        #[allowed("0 to {most}, as many as the file can hold")]
        ListLength { property: String, length: f64, most: usize },
        "ply.size" #[error("the file ends in the middle of an element")] #[value("{length}")] #[hint("the file is cut off")]
        Ends { length: usize },
        "ply.size" #[error("the file ends in the middle of an element")] #[value("end of file")]
        TextEnds {},
        "shape.number" #[error("`{word}` is not a number")] #[value("{word}")] #[allowed("a number with a decimal point")]
        NoDecimalNumber { word: String },
        "shape.number" #[error("`{word}` is not a number")] #[value("{word}")] #[allowed("a whole number")]
        NotWhole { word: String },
    }

    /// Parts of a PLY file that are omitted.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum PlyNotice {
        "ply.element" #[error("{count} of `{element}` {} left out", if *count == 1 { "is" } else { "are" })] #[value("{count}")]
        Element { count: u64, element: String },
    }

    /// Errors in an STL file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum StlError {
        "stl.size" #[error("at byte 80 the header declares {triangles} triangles, but the file has {length} bytes")] #[value("{length}")]
        #[allowed("{promised} bytes")] #[hint("the file is cut off, or it is not an STL file")]
        Promised { triangles: u64, length: usize, promised: u64 },
        "stl.size" #[error("the file has {length} bytes")] #[value("{length}")]
        #[allowed("84 bytes and 50 for every triangle, or a text that begins with `solid`")]
        Short { length: usize },
        "stl.syntax" #[error("a vertex has {count} coordinates")] #[value("{count}")] #[allowed("vertex x y z")]
        Coordinates { count: usize },
        "stl.syntax" #[error("`{line}` does not belong here")] #[value("{line}")] #[allowed("facet normal … or endsolid")]
        NoFacet { line: String },
        "stl.syntax" #[error("`{line}` does not belong here")] #[value("{line}")] #[allowed("{wanted}")]
        Other { line: String, wanted: &'static str },
        "stl.syntax" #[error("the file ends too early")] #[value("end of file")] #[allowed("{wanted}")]
        Ends { wanted: &'static str },
    }

    /// Parts of an STL file that are ignored.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum StlNotice {
        "stl.normal" #[error("{}; the order of the corners determines the side instead", counted(*count as u64, "normal is not a number", "normals are not numbers"))] #[value("{count}")]
        Broken { count: usize },
        "stl.normal" #[error("{}; the order of the corners determines the side instead", counted(*count as u64, "normal points against its triangle", "normals point against their triangles"))]
        #[value("{count}")]
        Against { count: usize },
    }
}
