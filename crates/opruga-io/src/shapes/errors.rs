//! Errors and notices of the functions that make bodies from shapes.

use opruga_math::message::Setting;
use opruga_math::messages;
use opruga_math::words::{counted, number};

messages! {
    /// The change of an area or a volume.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Change {
        "part.change" #[error("{off} {unit} ({percent} %) of {whole} {unit} are lost")]
        Lost { off: String, unit: &'static str, percent: String, whole: String },
        "part.change" #[error("{off} {unit} ({percent} %) of {whole} {unit} are added")]
        Added { off: String, unit: &'static str, percent: String, whole: String },
    }

    /// The cause of triangles with sharp angles.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ThinCause {
        "part.thin_cause" #[error("the outline itself has a corner of {angle}° there")]
        Corner { angle: String },
        "part.thin_cause" #[error("the outline is finer there than {spacing}")]
        Finer { spacing: Setting },
        "part.thin_cause" #[error("the refinement has added as many nodes as it is allowed to add")]
        Unfinished {},
    }

    /// What helps if a shape is refused or changed.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ShapeHint {
        "part.shape_hint" #[error("use a smaller {spacing}")]
        SmallerSpacing { spacing: Setting },
        "part.shape_hint" #[error("use a larger {spacing}, or a drawing with fewer points")]
        LargerSpacing { spacing: Setting },
        "part.shape_hint" #[error("{spacing} keeps the volume within {percent} %")]
        SpacingKeeps { spacing: Setting, percent: f64 },
        "part.shape_hint" #[error("use a smaller {remesh}")]
        SmallerRemesh { remesh: Setting },
        "part.shape_hint" #[error("{remesh} works")]
        RemeshWorks { remesh: Setting },
        "part.shape_hint" #[error("use a smaller {remesh}: none of the tried lengths of {} m or more works", number(*length))]
        NoRemeshWorks { remesh: Setting, length: f64 },
        "part.shape_hint" #[error("round the corner off in the drawing, or use {lattice}")]
        RoundCorner { lattice: Setting },
        "part.shape_hint" #[error("use a smaller {spacing}, or {lattice}")]
        SmallerOrLattice { spacing: Setting, lattice: Setting },
        "part.shape_hint" #[error("use a larger {spacing}, or {lattice}")]
        LargerOrLattice { spacing: Setting, lattice: Setting },
        "part.shape_hint" #[error("use a smaller {spacing}, a larger {size}, {drop_below}, or {lattice}")]
        FinerOutline { spacing: Setting, size: Setting, drop_below: Setting, lattice: Setting },
        "part.shape_hint" #[error("{union} keeps the area that any outline covers, {parity} keeps the area that an odd number of outlines encloses")]
        Overlap { union: Setting, parity: Setting },
        "part.shape_hint" #[error("if the file is in millimetres, use {scale}; {size} sets the length")]
        Millimetres { scale: Setting, size: Setting },
        "part.shape_hint" #[error("if the file is in kilometres, use {scale}; {size} sets the length")]
        Kilometres { scale: Setting, size: Setting },
        "part.shape_hint" #[error("{size} sets the length")]
        Size { size: Setting },
        "part.shape_hint" #[error("{cap} closes it, {sheet} keeps it as cloth")]
        CapOrSheet { cap: Setting, sheet: Setting },
        "part.shape_hint"
        #[error("{} at the position of another; {weld} joins them. Otherwise, use {cap} or {sheet}", counted(*count as u64, "vertex lies", "vertices lie"))]
        Weld { count: usize, weld: Setting, cap: Setting, sheet: Setting },
    }

    /// Why no body can be made from the contents of a file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ShapeError {
        "scene.unknown_kind" #[error("`{kind}` reads no file")] #[value("{kind}")]
        ReadsNoFile { kind: String },
        "shape.format" #[error("files ending in `.{ending}` cannot be read")]
        #[allowed("a file ending in .obj, .stl, .ply, .gltf, .glb, {others}")]
        Ending { ending: String, others: &'static str },
        "shape.encoding" #[error("byte {byte} is not valid UTF-8")] #[value("{byte}")] #[allowed("a text in UTF-8")] #[hint("save it as UTF-8")]
        Encoding { byte: String },
        "scene.dimension" #[error("this shape does not exist in {dimension}D")]
        Dimension { dimension: usize },
        "scene.shape" #[error("with edges of {length} m, the surface would cross itself")] #[value("{length}")]
        #[allowed("a length smaller than the finest details of the surface")]
        RemeshCrosses { length: f64 },
        "scene.shape" #[error("with edges of {length} m, the surface would enclose {part} of its original volume")] #[value("{length}")]
        #[allowed("a length that keeps the volume within {percent} %")]
        RemeshEncloses { length: f64, part: String, percent: f64 },
        "shape.no_area" #[error("the file contains no closed outline")] #[value("{extent}")]
        #[allowed("outlines that enclose area, of an extent from 1e-150 to 1e150")]
        NoOutline { extent: String },
        "shape.no_area" #[error("no outline is left")] #[value("{least}")]
        NoneLeft { least: f64 },
        "limit.nodes" #[error("with nodes {} m apart, there would be {nodes} nodes", number(*spacing))] #[value("{}", number(*spacing))]
        #[allowed("{least} m or more, for at most {most} nodes")]
        TooFineOutline { spacing: f64, nodes: String, least: String, most: u64 },
    }

    /// What has changed while a body was made from the contents of a file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ShapeNotice {
        "shape.lost_volume" #[error("with the filling, {change}")] #[value("{kept}")]
        #[allowed("up to {warned} % of the volume; more than 25 % is an error")]
        Filling { change: Change, kept: String, warned: f64 },
        "shape.lost_volume" #[error("with edges of {} m, {change}", number(*length))] #[value("{kept}")]
        Remeshed { length: f64, change: Change, kept: String },
        "shape.thinned" #[error("{} {nodes} nodes, {} m apart: {change}", counted(*given as u64, "point of the file becomes", "points of the file become"), number(*spacing))]
        #[value("{given}")] #[hint("a smaller {finer} keeps finer detail, {lattice} keeps all of it")]
        Thinned { given: usize, nodes: usize, spacing: f64, change: Change, finer: Setting, lattice: Setting },
        "shape.thinned" #[error("with {nodes} nodes {} m apart, {change}", number(*spacing))] #[value("{kept}")]
        #[hint("a smaller {finer} keeps finer detail, {lattice} keeps all of it")]
        Coarse { nodes: usize, spacing: f64, change: Change, kept: String, finer: Setting, lattice: Setting },
        "shape.nested" #[error("{}", counted(*count as u64, "outline lies within an outline of another element and is a hole there", "outlines lie within outlines of other elements and are holes there"))]
        #[value("{count}")] #[hint("{union} keeps everything that any element paints, {parity} confirms that the holes are intended")]
        Nested { count: usize, union: Setting, parity: Setting },
        "shape.thin_triangles"
        #[error("{count} of {} {} angles below {least}°, the smallest {angle}° at ({x}, {y}): {cause}", counted(*triangles as u64, "triangle", "triangles"), if *count == 1 { "has" } else { "have" })]
        #[value("{angle}")] #[allowed("angles of at least {least}°")]
        ThinTriangles { count: usize, triangles: usize, least: f64, angle: String, x: String, y: String, cause: ThinCause },
        "shape.no_area" #[error("{} left out", counted(*count as u64, "outline without area is", "outlines without area are"))] #[value("{count}")]
        LeftOut { count: usize },
        "shape.dropped" #[error("{count} of {outlines} outlines {} left out (area below {} m²)", if *count == 1 { "is" } else { "are" }, number(*least))]
        #[value("{count}")]
        Dropped { count: usize, outlines: usize, least: f64 },
        "shape.overlap"
        #[error("{}: {overlap} keeps the area that any of them covers; {}", counted(*count as u64, "outline crosses, covers or touches others or itself", "outlines cross, cover or touch others or themselves"), counted(*left as u64, "outline is left", "outlines are left"))]
        #[value("{count}")]
        Union { count: usize, left: usize, overlap: Setting },
        "shape.overlap"
        #[error("{}: {overlap} keeps the area that an odd number of them encloses; {}", counted(*count as u64, "outline crosses, covers or touches others or itself", "outlines cross, cover or touch others or themselves"), counted(*left as u64, "outline is left", "outlines are left"))]
        #[value("{count}")]
        EvenOdd { count: usize, left: usize, overlap: Setting },
    }
}
