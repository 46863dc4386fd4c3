//! Shapes that are read from files: drawings, maps, texts, images, surfaces, meshes.

use super::CENTER;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

const SPACING: Field = Field::new(
    "spacing",
    Allowed::POSITIVE,
    "m",
    Default::Required,
    "About the distance from node to node, before `scale`: between its corners, turns by more than 45° within a spacing, an outline is cut into equal pieces, as many as make their length along it come nearest to this, and three at least for a whole outline. Finer detail is left out; how much is told where the area changes by more than 5 %, or where the file has more than four points for a node. With `filling = \"lattice\"` it is the side of the squares, and the outline keeps all of its points.",
);
const SIZE: Field =
    Field::new("size", Allowed::POSITIVE, "m", Default::Required, "The longer side of its bounding box.");
const FILLING: Field = Field::new(
    "filling",
    Allowed::Choice(&["none", "triangles", "lattice"]),
    "",
    Default::Text("none"),
    "`none`: a skin of edges, for bending and gas. `triangles`: a lattice of nearly equilateral triangles, without angles below 25° but where corners of the outline are sharper or it is finer than the spacing, which is told. `lattice`: equal squares that reach a little beyond the outline and carry it for drawing, however fine it is.",
);
pub(super) const FILLING_OF_SURFACES: Field = Field::new(
    "filling",
    Allowed::Choice(&["none", "lattice", "tetrahedra"]),
    "",
    Default::Text("none"),
    "`none`: a skin of triangles, for bending and gas. `lattice`: equal tetrahedra that reach a little beyond the surface and carry it for drawing. `tetrahedra`: tetrahedra whose boundary follows the surface, with angles from 10.7° to 164.8°, for finite elements; sharp edges are cut off within a spacing, and parts thinner than that may be lost. A volume that changes by more than 5 % is told, by more than 25 % an error.",
);
pub(super) const SPACING_OF_FILLINGS: Field = Field::new(
    "spacing",
    Allowed::POSITIVE,
    "m",
    Default::Absent,
    "The side of the cubes of their lattice, before `scale`; nodes lie at corners and middles.",
)
.applies(&[Condition::Word("filling", &["lattice", "tetrahedra"])]);
const OVERLAP: Field = Field::new(
    "overlap",
    Allowed::Choice(&["refuse", "union", "even_odd"]),
    "",
    Default::Text("refuse"),
    "What holds where outlines cross or touch: an error, what any part covers, or what an odd number of outlines enclose; how many were joined is told. Areas that touch in points alone are apart there. An outline within another is a hole, and one within that an area again, also of another element of a drawing; with \"union\" what any element paints is inside.",
);
const DROP_BELOW: Field = Field::new(
    "drop_below",
    Allowed::NOT_NEGATIVE,
    "m²",
    Default::Number(0.0),
    "Outlines of less area are left out, and counted.",
);

static SVG: Spec = Spec {
    kind: "svg",
    summary: "the outline of a drawing",
    documentation: "Paths, rectangles, circles, ellipses and polygons of an SVG file, with their transforms; y points up in the scene. Holes follow the even-odd rule, or the non-zero rule where `fill-rule` says so. Style sheets are followed: rules behind names, classes and ids. A clip path that cuts nothing off changes nothing; one that does is an error.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The SVG file, looked up relative to the scene."),
        Field::new(
            "path",
            Allowed::Text,
            "",
            Default::Absent,
            "The `id` of one element or group; the whole drawing where the scene is silent.",
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
            "Whether pictures show the drawing in the fill colours of its parts, one over another, carried by the body; a gradient becomes the mean of its stops.",
        ),
    ],
    roles: &[],
};

static MAP: Spec = Spec {
    kind: "map",
    summary: "a country or any other polygons of a map",
    documentation: "Polygons of GeoJSON or TopoJSON, in degrees, with their holes; islands are parts of one body. Outlines over the antimeridian are in one piece, beyond 180°; those around a pole are cut along the antimeridian and closed along the pole. Neighbours that share a border are joined with `overlap = \"union\"`.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The map, looked up relative to the scene."),
        Field::new(
            "feature",
            Allowed::Text,
            "",
            Default::Absent,
            "The `id` of a feature, or a text among its properties such as its name; all features where the scene is silent.",
        ),
        Field::new("layer", Allowed::Text, "", Default::Absent, "The object of a topology that has several."),
        Field::new(
            "projection",
            Allowed::Choice(&["equirectangular", "mercator", "none"]),
            "",
            Default::Text("equirectangular"),
            "How degrees become lengths; `equirectangular` is true to proportion at the middle latitude, `none` takes coordinates as they are.",
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
    documentation: "The outlines of the letters of an OpenType or TrueType font, on one line, one by one from left to right; counters are holes.",
    dimensions: &[2],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The font, looked up relative to the scene."),
        Field::new("text", Allowed::Text, "", Default::Required, "What is written."),
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
    documentation: "A PNG picture; the contour runs where its pixels cross the threshold, linear between their middles.",
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
            "How dark, bright or opaque a pixel must be at least.",
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
    documentation: "OBJ, STL (text or binary), PLY (text or binary), glTF (.gltf, .glb), or the triangles of a mesh file (see `mesh`), by the ending of the file. Polygons, concave ones too, are cut into triangles inside them. Triangles are turned outward, and counted; every closed component is a chamber, one inside another a cavity. The middle of its bounding box lies at `center`. Groups: the named parts of the file.",
    dimensions: &[3],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The file, looked up relative to the scene."),
        Field::new(
            "size",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "The longest side of its bounding box; the units of the file are metres where the scene is silent.",
        ),
        CENTER,
        Field::new(
            "up",
            Allowed::Choice(&["y", "z"]),
            "",
            Default::Text("y"),
            "Which axis of the file points up, along y.",
        ),
        Field::new(
            "weld",
            Allowed::NOT_NEGATIVE,
            "m",
            Default::Absent,
            "Vertices at most this far apart in the file are joined, and counted; STL joins those at the same place without being asked.",
        ),
        Field::new(
            "open",
            Allowed::Choice(&["refuse", "cap", "sheet"]),
            "",
            Default::Text("refuse"),
            "What becomes of a surface with free boundaries: an error, closed by fans of triangles, or cloth.",
        ),
        Field::new(
            "overlap",
            Allowed::Choice(&["refuse", "keep"]),
            "",
            Default::Text("refuse"),
            "What holds where triangles of a closed surface cross, touch or overlap that share no vertex there: an error that names two of them, or nothing, but they are counted.",
        ),
        Field::new(
            "remesh",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "A closed surface is made anew of nearly equilateral triangles with edges of about this length, before `scale`; edges sharper than 40° stay. Nodes are numbered anew.",
        ),
        FILLING_OF_SURFACES,
        SPACING_OF_FILLINGS,
    ],
    roles: &[],
};

static MESH: Spec = Spec {
    kind: "mesh",
    summary: "a filled body of cells, as another program has meshed it",
    documentation: "Gmsh 2.2 and 4.1 (.msh, text or binary), VTK (.vtk, .vtu), TetGen (.node with .ele), MFEM and Medit (.mesh, .mfem), by the ending of the file. Triangles and quadrilaterals in 2D; tetrahedra and hexahedra in 3D; triangles of 6 and tetrahedra of 10 nodes. Nodes keep the order of the file, and their coordinates in metres. Named parts (physical groups, attributes, references, markers) become groups of nodes and of cells, scalars of elements become values of cells.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("file", Allowed::Text, "", Default::Required, "The file, looked up relative to the scene."),
        Field::new(
            "inverted",
            Allowed::Choice(&["refuse", "turn"]),
            "",
            Default::Text("refuse"),
            "What becomes of cells of negative area or volume: an error, or turned round, and counted.",
        ),
        Field::new(
            "unreferenced",
            Allowed::Choice(&["refuse", "leave_out"]),
            "",
            Default::Text("refuse"),
            "What becomes of nodes that no cell names: an error, or left out, and counted.",
        ),
    ],
    roles: &[Role::CellsFromFile],
};

/// All shapes from files.
pub(super) fn all() -> Vec<&'static Spec> {
    vec![&SVG, &MAP, &TEXT, &BITMAP, &SURFACE, &MESH]
}

/// Whether a shape of this kind is built from a file, which only the reader of that file can do.
pub fn is_from_file(kind: &str) -> bool {
    all().iter().any(|spec| spec.kind == kind)
}
