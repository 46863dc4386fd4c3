//! The shapes that a scene can name: their parameters, numbers of nodes, and meshes.

mod filling;
mod from_files;
mod rings;

pub use filling::{Filling, Loss, REPORTED_LOSS, filling};
pub use from_files::is_from_file;
use from_files::{FILLING_OF_SURFACES, SPACING_OF_FILLINGS};

use opruga_core::spec::{Allowed, Bound, Default, Field, Spec, Values};
use opruga_mesh::{LARGEST_ANGLE, MAXIMUM_NODES, MAXIMUM_SUBDIVISIONS, Mesh, MeshError, Must, Quantity};

const fn count(least: i64) -> Allowed {
    Allowed::Integer { least, greatest: MAXIMUM_NODES as i64 }
}

const CENTER: Field = Field::new("center", Allowed::Vector, "m", Default::Origin, "The position of the centre.");
const CORNER: Field = Field::new(
    "corner",
    Allowed::Vector,
    "m",
    Default::Origin,
    "The corner from which the sides extend; in a grid or a box, the corner with the lowest coordinates.",
);
const START_ANGLE: Field = Field::new(
    "start_angle",
    Allowed::Number { least: Bound::Closed(-LARGEST_ANGLE), greatest: Bound::Closed(LARGEST_ANGLE) },
    "rad",
    Default::Number(0.0),
    "The direction of node 0 from the centre, counter-clockwise from the x axis.",
);

static RING: Spec = Spec {
    kind: "ring",
    summary: "a round outline",
    documentation: "The vertices lie on a circle, counter-clockwise; edge i runs from node i to node i + 1.",
    dimensions: &[2],
    fields: &[
        Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The radius of the circle."),
        Field::new("vertices", count(3), "", Default::Required, "The number of vertices."),
        CENTER,
        START_ANGLE,
    ],
    roles: &[],
};

static RINGS: Spec = Spec {
    kind: "rings",
    summary: "several round outlines in one body: chambers, and holes in them",
    documentation: "Circles of `vertices` nodes each; the nodes are numbered one circle after another. A ring with a negative radius is a hole: it \
runs clockwise, and the gas of the ring around it does not fill it. Rings must not cross or touch. A ring may contain only holes, a hole may contain \
only rings, and every hole must lie in a ring.",
    dimensions: &[2],
    fields: &[
        Field::new("centers", Allowed::Points, "m", Default::Required, "The centre of each ring."),
        Field::new(
            "radii",
            Allowed::Numbers,
            "m",
            Default::Required,
            "The radius of each ring; a negative radius makes a hole.",
        ),
        Field::new("vertices", count(3), "", Default::Required, "The number of vertices of each ring."),
    ],
    roles: &[],
};

static REGULAR_POLYGON: Spec = Spec {
    kind: "regular_polygon",
    summary: "an outline of equal sides",
    documentation: "The corners lie on a circle, counter-clockwise; each side is divided into equal edges.",
    dimensions: &[2],
    fields: &[
        Field::new("sides", count(3), "", Default::Required, "The number of sides."),
        Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The distance of the corners from the centre."),
        Field::new("vertices_per_side", count(1), "", Default::Integer(1), "The number of edges of each side."),
        CENTER,
        START_ANGLE,
    ],
    roles: &[],
};

static POLYGON: Spec = Spec {
    kind: "polygon",
    summary: "an outline through points",
    documentation: "Node i is point i. The points may run in either direction; the edges always run counter-clockwise. Edges must not cross or \
touch.",
    dimensions: &[2],
    fields: &[Field::new(
        "points",
        Allowed::Points,
        "m",
        Default::Required,
        "The corners; the first may be repeated at the end.",
    )],
    roles: &[],
};

static LINE: Spec = Spec {
    kind: "line",
    summary: "a straight chain",
    documentation: "Edges of equal length from one point to another. A line encloses nothing.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("from", Allowed::Vector, "m", Default::Required, "The position of the first node."),
        Field::new("to", Allowed::Vector, "m", Default::Required, "The position of the last node."),
        Field::new("segments", count(1), "", Default::Required, "The number of edges."),
    ],
    roles: &[],
};

static POLYLINE: Spec = Spec {
    kind: "polyline",
    summary: "a chain through points",
    documentation: "A polyline encloses nothing, even if it is closed. Node i is point i.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("points", Allowed::Points, "m", Default::Required, "The nodes."),
        Field::new(
            "closed",
            Allowed::Boolean,
            "",
            Default::Boolean(false),
            "Whether the last node is joined to the first.",
        ),
    ],
    roles: &[],
};

static GRID: Spec = Spec {
    kind: "grid",
    summary: "a filled rectangle or box of equal cells",
    documentation: "With nx cells along x and ny along y, node (x, y, z) has number x + (nx+1)·(y + (ny+1)·z). Groups: left, right, bottom, top, and \
in space back and front.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("size", Allowed::Vector, "m", Default::Required, "The lengths of the sides along the axes."),
        Field::new("cells", Allowed::Integers, "", Default::Required, "The number of cells along each axis."),
        CORNER,
    ],
    roles: &[],
};

static QUADRILATERAL: Spec = Spec {
    kind: "quadrilateral",
    summary: "a filled quadrilateral of cells between four corners",
    documentation: "A grid stretched over a convex quadrilateral. With n cells along the side from corner 0 to corner 1, node (i, j) has number i + \
(n+1)·j. Groups: bottom (from corner 0 to 1), right (1 to 2), top (3 to 2) and left (0 to 3).",
    dimensions: &[2],
    fields: &[
        Field::new("corners", Allowed::Points, "m", Default::Required, "The four corners, counter-clockwise."),
        Field::new(
            "cells",
            Allowed::Integers,
            "",
            Default::Required,
            "The number of cells along the side from corner 0 to corner 1, and along the side from corner 1 to corner 2.",
        ),
    ],
    roles: &[],
};

static SHEET: Spec = Spec {
    kind: "sheet",
    summary: "an open flat surface: cloth",
    documentation: "A parallelogram of triangles with alternating diagonals. With nu cells along u, node (i, j) has number i + (nu+1)·j. Groups: \
left and right (at low and high u), bottom and top (at low and high v).",
    dimensions: &[3],
    fields: &[
        CORNER,
        Field::new("u", Allowed::Vector, "m", Default::Required, "The first side, as a vector from the corner."),
        Field::new("v", Allowed::Vector, "m", Default::Required, "The second side, as a vector from the corner."),
        Field::new("cells", Allowed::Integers, "", Default::Required, "The number of cells along u and along v."),
    ],
    roles: &[],
};

static BOX: Spec = Spec {
    kind: "box",
    summary: "the closed surface of a box",
    documentation: "Each cell of a face is cut into two triangles. Groups: left, right, bottom, top, back, front. For a box filled with equal cells, \
use `grid`.",
    dimensions: &[3],
    fields: &[
        Field::new("size", Allowed::Vector, "m", Default::Required, "The lengths of the sides along the axes."),
        Field::new("cells", Allowed::Integers, "", Default::Required, "The number of cells along each axis."),
        CORNER,
        FILLING_OF_SURFACES,
        SPACING_OF_FILLINGS,
    ],
    roles: &[],
};

static ICOSPHERE: Spec = Spec {
    kind: "icosphere",
    summary: "a closed ball surface of nearly equal triangles",
    documentation: "An icosahedron whose faces are divided into four triangles again and again, s = `subdivisions` times. The surface has 10·4^s + 2 \
nodes.",
    dimensions: &[3],
    fields: &[
        Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The radius."),
        Field::new(
            "subdivisions",
            Allowed::Integer { least: 0, greatest: MAXIMUM_SUBDIVISIONS as i64 },
            "",
            Default::Required,
            "How many times each face is divided into four triangles.",
        ),
        CENTER,
        FILLING_OF_SURFACES,
        SPACING_OF_FILLINGS,
    ],
    roles: &[],
};

static TORUS: Spec = Spec {
    kind: "torus",
    summary: "a closed tube around a circle",
    documentation: "The axis of the torus is the z axis. Node (i, j) has number i·`nodes_of_tube` + j.",
    dimensions: &[3],
    fields: &[
        Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The radius of the circle."),
        Field::new(
            "tube_radius",
            Allowed::POSITIVE,
            "m",
            Default::Required,
            "The radius of the tube, less than that of the circle.",
        ),
        Field::new("nodes_around", count(3), "", Default::Required, "The number of nodes around the axis."),
        Field::new("nodes_of_tube", count(3), "", Default::Required, "The number of nodes around the tube."),
        CENTER,
        FILLING_OF_SURFACES,
        SPACING_OF_FILLINGS,
    ],
    roles: &[],
};

/// Returns the specifications of all shapes.
pub fn all() -> Vec<&'static Spec> {
    let made: [&'static Spec; 12] = [
        &RING,
        &RINGS,
        &REGULAR_POLYGON,
        &POLYGON,
        &LINE,
        &POLYLINE,
        &GRID,
        &QUADRILATERAL,
        &SHEET,
        &BOX,
        &ICOSPHERE,
        &TORUS,
    ];
    made.into_iter().chain(from_files::all()).collect()
}

/// The number of nodes that a shape will have, before it is built; exact as far as a floating-point number can be.
pub fn node_count(shape: &Values, dimension: usize) -> f64 {
    match (shape.text("filling"), shape.number("spacing")) {
        (Some("lattice" | "tetrahedra"), Some(spacing)) => filling_estimate(shape, spacing),
        _ => surface_node_count(shape, dimension),
    }
}

/// The approximate number of nodes of a filling of a generated surface: two in every cube of the lattice, and a layer around the surface.
fn filling_estimate(shape: &Values, spacing: f64) -> f64 {
    let pi = core::f64::consts::PI;
    let (radius, tube) = (shape.number("radius").unwrap_or(0.0), shape.number("tube_radius").unwrap_or(0.0));
    let (volume, area) = match shape.kind() {
        "icosphere" => (4.0 / 3.0 * pi * radius * radius * radius, 4.0 * pi * radius * radius),
        "torus" => (2.0 * pi * pi * radius * tube * tube, 4.0 * pi * pi * radius * tube),
        _ => {
            let [a, b, c]: [f64; 3] = shape.vector("size");
            (a * b * c, 2.0 * (a * b + b * c + c * a))
        }
    };
    (2.0 * volume.abs() / (spacing * spacing * spacing) + 2.0 * area.abs() / (spacing * spacing)).floor()
}

fn surface_node_count(shape: &Values, dimension: usize) -> f64 {
    let whole = |name: &str| shape.integer(name).and_then(|n| u32::try_from(n).ok()).map_or(0.0, f64::from);
    let product = |cells: &[u32]| cells.iter().fold(1.0, |n, c| n * (f64::from(*c) + 1.0));
    match shape.kind() {
        "ring" => whole("vertices"),
        "rings" => whole("vertices") * shape.rows("centers").len() as f64,
        "regular_polygon" => whole("sides") * whole("vertices_per_side"),
        "polygon" | "polyline" => shape.rows("points").len() as f64,
        "line" => whole("segments") + 1.0,
        "grid" | "quadrilateral" | "sheet" => {
            product(&shape.integers("cells")[..shape.integers("cells").len().min(dimension)])
        }
        "box" => {
            let n = |a: usize| shape.integers("cells").get(a).map_or(0.0, |c| f64::from(*c));
            2.0 * (n(0) * n(1) + n(1) * n(2) + n(2) * n(0)) + 2.0
        }
        "icosphere" => 10.0 * libm::exp2(2.0 * whole("subdivisions")) + 2.0,
        "torus" => whole("nodes_around") * whole("nodes_of_tube"),
        _ => 0.0,
    }
}

/// The transform of a shape before it is moved to the position of its body.
#[derive(Clone, Copy, Debug)]
pub struct Transform<'a> {
    /// A factor on all lengths.
    pub scale: f64,
    /// The rotation: an angle in 2D, an axis times its angle in 3D [rad].
    pub rotation: &'a [f64],
}

/// A shape that has been built.
#[derive(Clone, Debug, PartialEq)]
pub struct Made<const D: usize> {
    /// Its mesh.
    pub mesh: Mesh<D>,
    /// Whether its points run clockwise, so that its edges run in the opposite direction.
    pub flipped: bool,
    /// The volume that its filling has lost, if that is worth a report.
    pub loss: Option<Loss>,
}

/// Builds the mesh of a shape, scaled and rotated about the origin of its own coordinates.
///
/// # Errors
/// The errors of the generator: crossing edges, too few points, a tube as wide as its circle …
pub fn mesh<const D: usize>(shape: &Values, transform: &Transform<'_>) -> Result<Made<D>, MeshError> {
    if D == 2 {
        let Made { mesh, flipped, loss } = plane(shape, transform)?;
        Ok(Made { mesh: renamed(mesh)?, flipped, loss })
    } else {
        let Made { mesh, flipped, loss } = space(shape, transform)?;
        Ok(Made { mesh: renamed(mesh)?, flipped, loss })
    }
}

/// Converts a mesh between two type parameters that stand for the same dimension; refuses other dimensions.
fn renamed<const A: usize, const B: usize>(mesh: Mesh<A>) -> Result<Mesh<B>, MeshError> {
    if A != B {
        return Err(MeshError::Size { what: Quantity::Dimension, value: B as f64, must: Must::TwoOrThree });
    }
    let Mesh {
        positions,
        facets,
        wires,
        sheets,
        sheet_quadrilaterals,
        cells,
        groups,
        cell_groups,
        cell_values,
        node_values,
        skin,
    } = mesh;
    Ok(Mesh {
        positions: positions.iter().map(|position| core::array::from_fn(|d| position[d])).collect(),
        facets: facets.iter().map(|facet| core::array::from_fn(|d| facet[d])).collect(),
        wires,
        sheets,
        sheet_quadrilaterals,
        cells,
        groups,
        cell_groups,
        cell_values,
        node_values,
        skin,
    })
}

/// The integer value of a field, as a count.
fn number(shape: &Values, name: &str) -> u32 {
    shape.integer(name).and_then(|n| u32::try_from(n).ok()).unwrap_or(0)
}

/// The counts of cells, one for each axis.
fn cells<const N: usize>(shape: &Values) -> Result<[u32; N], MeshError> {
    let given = shape.integers("cells");
    <[u32; N]>::try_from(given).map_err(|_| MeshError::Count {
        what: Quantity::LengthCells,
        value: given.len() as u64,
        least: N as u64,
        most: N as u64,
    })
}

/// Rows as points.
fn points<const D: usize>(rows: &[Vec<f64>]) -> Vec<[f64; D]> {
    rows.iter().map(|row| core::array::from_fn(|a| row.get(a).copied().unwrap_or(0.0))).collect()
}

fn plane(shape: &Values, transform: &Transform<'_>) -> Result<Made<2>, MeshError> {
    let (radius, start) = (shape.number("radius").unwrap_or(0.0), shape.number("start_angle").unwrap_or(0.0));
    let mut flipped = false;
    let mut mesh = match shape.kind() {
        "ring" => Mesh::ring(radius, number(shape, "vertices"), shape.vector("center"), start)?,
        "rings" => rings::rings(shape)?,
        "regular_polygon" => Mesh::regular_polygon(
            number(shape, "sides"),
            radius,
            number(shape, "vertices_per_side"),
            shape.vector("center"),
            start,
        )?,
        "quadrilateral" => {
            let given = points(shape.rows("corners"));
            let corners = <[[f64; 2]; 4]>::try_from(given).map_err(|given| MeshError::Count {
                what: Quantity::NumberCorners,
                value: given.len() as u64,
                least: 4,
                most: 4,
            })?;
            Mesh::quadrilateral(corners, cells(shape)?)?
        }
        "polygon" => {
            let polygon = Mesh::polygon(&points(shape.rows("points")))?;
            flipped = polygon.flipped;
            polygon.mesh
        }
        _ => either(shape)?,
    };
    apply_transform(&mut mesh, transform)?;
    Ok(Made { mesh, flipped, loss: None })
}

fn space(shape: &Values, transform: &Transform<'_>) -> Result<Made<3>, MeshError> {
    let radius = shape.number("radius").unwrap_or(0.0);
    let center: [f64; 3] = shape.vector("center");
    let mut mesh = match shape.kind() {
        "sheet" => Mesh::sheet(shape.vector("corner"), [shape.vector("u"), shape.vector("v")], cells(shape)?)?,
        "box" => Mesh::box_surface(shape.vector("corner"), shape.vector("size"), cells(shape)?)?,
        "icosphere" => moved(Mesh::icosphere(radius, number(shape, "subdivisions"))?, center),
        "torus" => {
            let counts = [number(shape, "nodes_around"), number(shape, "nodes_of_tube")];
            moved(Mesh::torus(radius, shape.number("tube_radius").unwrap_or(0.0), counts)?, center)
        }
        _ => either(shape)?,
    };
    let mut loss = None;
    if let Some(filling) = filling(shape)? {
        (mesh, loss) = filling.of(&mesh)?;
    }
    apply_transform(&mut mesh, transform)?;
    Ok(Made { mesh, flipped: false, loss })
}

/// The shapes that exist in both dimensions.
fn either<const D: usize>(shape: &Values) -> Result<Mesh<D>, MeshError> {
    match shape.kind() {
        "line" => Mesh::line(shape.vector("from"), shape.vector("to"), number(shape, "segments")),
        "polyline" => Mesh::polyline(&points(shape.rows("points")), shape.flag("closed")),
        _ => Mesh::grid(shape.vector("corner"), shape.vector("size"), cells(shape)?),
    }
}

fn moved(mut mesh: Mesh<3>, by: [f64; 3]) -> Mesh<3> {
    mesh.translate(by);
    mesh
}

/// Scales a mesh and rotates it about the origin of its own coordinates.
///
/// # Errors
/// Factors and angles that are not finite.
pub fn apply_transform<const D: usize>(mesh: &mut Mesh<D>, transform: &Transform<'_>) -> Result<(), MeshError> {
    if transform.scale != 1.0 {
        mesh.scale([transform.scale; D], [0.0; D])?;
    }
    match transform.rotation {
        [angle, ..] if D == 2 && *angle != 0.0 => turn(mesh, |plane: &mut Mesh<2>| plane.rotate(*angle, [0.0; 2])),
        [x, y, z] if D == 3 => {
            let angle = (x * x + y * y + z * z).sqrt();
            let rotate = |space: &mut Mesh<3>| space.rotate([*x, *y, *z], angle, [0.0; 3]);
            if angle > 0.0 { turn(mesh, rotate) } else { Ok(()) }
        }
        _ => Ok(()),
    }
}

/// Rotates a mesh whose dimension is a type parameter, using the code for a known dimension.
fn turn<const D: usize, const E: usize>(
    mesh: &mut Mesh<D>,
    rotate: impl FnOnce(&mut Mesh<E>) -> Result<(), MeshError>,
) -> Result<(), MeshError> {
    let mut known = renamed(core::mem::take(mesh))?;
    let turned = rotate(&mut known);
    *mesh = renamed(known)?;
    turned
}
