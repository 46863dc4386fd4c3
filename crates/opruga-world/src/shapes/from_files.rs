//! Shapes that are read from files: drawings, maps, texts, images, surfaces, meshes.

use super::CENTER;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

const SPACING: Field = Field::new(
    "spacing",
    Allowed::POSITIVE,
    "m",
    Default::Required,
    "The approximate distance between nodes, before `scale`. An outline has a corner where it turns by more than 45° within this distance. Between \
corners, the outline is divided into pieces of equal length, as close to `spacing` as possible; a whole outline has at least three pieces. Finer \
detail is left out; a warning reports the loss if the area changes by more than 5 %, or if the file has more than four points per node. With \
`filling = \"lattice\"`, `spacing` is the side of the squares, and the outline keeps all of its points.",
);
const SIZE: Field =
    Field::new("size", Allowed::POSITIVE, "m", Default::Required, "The length of the longer side of the bounding box.");
const FILLING: Field = Field::new(
    "filling",
    Allowed::Choice(&["none", "triangles", "lattice"]),
    "",
    Default::Text("none"),
    "`none`: a skin of edges, for bending and gas. `triangles`: a lattice of nearly equilateral triangles; angles below 25° occur only where the \
outline has a sharper corner or details finer than the spacing, and they are reported. `lattice`: equal squares that reach a little beyond the \
outline and carry it for drawing, however fine the outline is.",
);
pub(super) const FILLING_OF_SURFACES: Field = Field::new(
    "filling",
    Allowed::Choice(&["none", "lattice", "tetrahedra"]),
    "",
    Default::Text("none"),
    "`none`: a skin of triangles, for bending and gas. `lattice`: equal tetrahedra that reach a little beyond the surface and carry it for drawing. \
`tetrahedra`: tetrahedra whose boundary follows the surface, with angles from 10.7° to 164.8°, for finite elements. These tetrahedra cut off sharp \
edges within a spacing, and may lose parts thinner than a spacing. A change of volume above 5 % is reported; above 25 % it is an error.",
);
pub(super) const SPACING_OF_FILLINGS: Field = Field::new(
    "spacing",
    Allowed::POSITIVE,
    "m",
    Default::Absent,
    "The side of the cubes of the lattice, before `scale`; nodes lie at the corners and centres of the cubes.",
)
.applies(&[Condition::Word("filling", &["lattice", "tetrahedra"])]);
const OVERLAP: Field = Field::new(
    "overlap",
    Allowed::Choice(&["refuse", "union", "even_odd"]),
    "",
    Default::Text("refuse"),
    "What happens if outlines cross or touch: \"refuse\" gives an error, \"union\" keeps what any part covers, and \"even_odd\" keeps what an odd \
number of outlines enclose. The number of joined outlines is reported. Areas that touch only at points are not joined at these points. An outline \
inside another one is a hole, and an outline inside a hole is an area again, even if the outlines belong to different elements of a drawing. With \
\"union\", everything that any element paints is inside.",
);
const DROP_BELOW: Field = Field::new(
    "drop_below",
    Allowed::NOT_NEGATIVE,
    "m²",
    Default::Number(0.0),
    "Outlines with a smaller area are left out and counted.",
);

static SVG: Spec = Spec {
    kind: "svg",
    summary: "the outline of a drawing",
    documentation: "Paths, rectangles, circles, ellipses and polygons of an SVG file, with their transforms; y points up in the scene. Holes follow \
the even-odd rule, or the non-zero rule if `fill-rule` selects it. Rules of style sheets are applied if their selectors are names, classes or ids. A \
clip path that cuts nothing off has no effect; one that cuts something off is an error.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The SVG file, looked up relative to the scene."),
        Field::new(
            "path",
            Allowed::Text,
            "",
            Default::Absent,
            "The `id` of one element or group; the default is the whole drawing.",
        ),
        SPACING,
        SIZE,
        CENTER,
        FILLING,
        OVERLAP,
        DROP_BELOW,
        Field::new(
            "colours",
            Allowed::Boolean,
            "",
            Default::Boolean(false),
            "Whether pictures show the drawing on the body, with its parts painted one over another in their fill colours. A gradient becomes the \
mean colour of its stops.",
        ),
    ],
    roles: &[],
};

static MAP: Spec = Spec {
    kind: "map",
    summary: "a country or any other polygons of a map",
    documentation: "Polygons of GeoJSON or TopoJSON, in degrees, with their holes; islands are parts of one body. Outlines that cross the \
antimeridian stay in one piece, with longitudes beyond 180°; outlines around a pole are cut along the antimeridian and closed along the pole. With \
`overlap = \"union\"`, neighbours that share a border are joined.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The map, looked up relative to the scene."),
        Field::new(
            "feature",
            Allowed::Text,
            "",
            Default::Absent,
            "The `id` of a feature, or a text among its properties, such as its name; the default is all features.",
        ),
        Field::new(
            "layer",
            Allowed::Text,
            "",
            Default::Absent,
            "The name of the object to read from a TopoJSON file that has several.",
        ),
        Field::new(
            "projection",
            Allowed::Choice(&["equirectangular", "mercator", "none"]),
            "",
            Default::Text("equirectangular"),
            "How degrees are converted to lengths: `equirectangular` keeps proportions at the middle latitude, `none` uses coordinates as they are.",
        ),
        SPACING,
        SIZE,
        CENTER,
        FILLING,
        OVERLAP,
        DROP_BELOW,
    ],
    roles: &[],
};

static TEXT: Spec = Spec {
    kind: "text",
    summary: "a word in the letters of a font",
    documentation: "The outlines of letters from an OpenType or TrueType font, set one by one from left to right on one line; counters are holes.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The font, looked up relative to the scene."),
        Field::new("text", Allowed::Text, "", Default::Required, "The text to write."),
        SPACING,
        SIZE,
        CENTER,
        FILLING,
        OVERLAP,
        DROP_BELOW,
    ],
    roles: &[],
};

static BITMAP: Spec = Spec {
    kind: "bitmap",
    summary: "the contour of a picture",
    documentation: "The contour of a PNG picture runs where its pixels cross the threshold, with linear interpolation between their centres.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The PNG file, looked up relative to the scene."),
        Field::new(
            "inside",
            Allowed::Choice(&["dark", "bright", "opaque"]),
            "",
            Default::Text("dark"),
            "Which pixels are inside: dark ones (on white), bright ones (on black), or opaque ones.",
        ),
        Field::new(
            "threshold",
            Allowed::Number { least: Bound::Open(0.0), greatest: Bound::Open(1.0) },
            "",
            Default::Number(0.5),
            "The least darkness, brightness or opacity with which a pixel counts as inside.",
        ),
        SPACING,
        SIZE,
        CENTER,
        FILLING,
        OVERLAP,
        DROP_BELOW,
    ],
    roles: &[],
};

static SURFACE: Spec = Spec {
    kind: "surface",
    summary: "a surface of triangles",
    documentation: "The ending of the file name determines the format: OBJ, STL (text or binary), PLY (text or binary), glTF (.gltf, .glb), or a \
mesh file (see `mesh`), whose triangles are read. Polygons, including concave ones, are cut into triangles that lie inside them. Triangles that face \
inward are flipped and counted. Every closed component is a chamber, and a component inside another one is a cavity. The centre of the bounding box \
lies at `center`. Groups: the named parts of the file.",
    dimensions: &[3],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The file, looked up relative to the scene."),
        Field::new(
            "size",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "The length of the longest side of the bounding box. If no size is given, the units of the file are metres.",
        ),
        CENTER,
        Field::new(
            "up",
            Allowed::Choice(&["y", "z"]),
            "",
            Default::Text("y"),
            "The axis that points up in the file; it becomes y.",
        ),
        Field::new(
            "weld",
            Allowed::NOT_NEGATIVE,
            "m",
            Default::Absent,
            "Vertices of the file that are at most this far apart are joined and counted. In STL files, vertices at the same position are always \
joined.",
        ),
        Field::new(
            "open",
            Allowed::Choice(&["refuse", "cap", "sheet"]),
            "",
            Default::Text("refuse"),
            "What happens to a surface with free boundaries: \"refuse\" gives an error, \"cap\" closes the surface with fans of triangles, and \
\"sheet\" keeps it as cloth.",
        ),
        Field::new(
            "overlap",
            Allowed::Choice(&["refuse", "keep"]),
            "",
            Default::Text("refuse"),
            "What happens if triangles of a closed surface cross, touch or overlap although they share no vertex there: \"refuse\" gives an error \
that names two of these triangles, and \"keep\" accepts and counts them.",
        ),
        Field::new(
            "remesh",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "If this length is given, a closed surface is rebuilt from nearly equilateral triangles with edges of about this length, before `scale`. \
Edges sharper than 40° are kept, and nodes are renumbered.",
        ),
        FILLING_OF_SURFACES,
        SPACING_OF_FILLINGS,
    ],
    roles: &[],
};

static MESH: Spec = Spec {
    kind: "mesh",
    summary: "a filled body of cells, meshed by another program",
    documentation: "The ending of the file name determines the format: Gmsh 2.2 and 4.1 (.msh, text or binary), VTK (.vtk, .vtu), TetGen (.node with \
.ele), MFEM and Medit (.mesh, .mfem). The cells may be triangles and quadrilaterals in 2D, tetrahedra and hexahedra in 3D; triangles may have 6 \
nodes and tetrahedra 10. Nodes keep the order of the file, and their coordinates are in metres. Named parts (physical groups, attributes, \
references, markers) become groups of nodes and of cells, and scalars of elements become values of cells.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The file, looked up relative to the scene."),
        Field::new(
            "inverted",
            Allowed::Choice(&["refuse", "turn"]),
            "",
            Default::Text("refuse"),
            "What happens to cells of negative area or volume: \"refuse\" gives an error, and \"turn\" flips and counts the cells.",
        ),
        Field::new(
            "unreferenced",
            Allowed::Choice(&["refuse", "leave_out"]),
            "",
            Default::Text("refuse"),
            "What happens to nodes that no cell uses: \"refuse\" gives an error, and \"leave_out\" leaves the nodes out and counts them.",
        ),
    ],
    roles: &[Role::CellsFromFile],
};

/// All shapes from files.
pub(super) fn all() -> Vec<&'static Spec> {
    vec![&SVG, &MAP, &TEXT, &BITMAP, &SURFACE, &MESH]
}

/// Whether a shape of this kind comes from a file, so that only the reader of that file can build it.
pub fn is_from_file(kind: &str) -> bool {
    all().iter().any(|spec| spec.kind == kind)
}
