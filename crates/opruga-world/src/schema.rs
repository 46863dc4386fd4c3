//! The fixed sections of a scene, described once. The reader, the error messages, the reference page and the JSON Schema are all generated from these
//! constants.
//!
//! A [`Section`] consists of a [`Spec`] (plain fields) and its [`Child`]ren, for everything that a plain field cannot contain: tables, lists of
//! tables, selectors, references to bodies.

mod actions;
mod contact;

pub use actions::{COMMANDS, LOADS, PROBE};
pub use contact::{BODY_CONTACT, CONTACT, CONTACT_PAIR};

use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Spec};

/// The maximum number of substeps in a frame.
pub const MOST_SUBSTEPS: u32 = 1_000_000;

/// One table of a scene: its plain fields and its structured ones.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// The plain fields; `kind` is the word in the scene file (a key, or the value of the tag).
    pub spec: &'static Spec,
    /// The structured fields.
    pub children: &'static [Child],
}

/// A field that contains more than a plain value.
#[derive(Clone, Copy, Debug)]
pub struct Child {
    /// The word in the scene file.
    pub name: &'static str,
    /// Its content.
    pub holds: Holds,
    /// Whether it is required.
    pub required: bool,
    /// One sentence about its physical meaning.
    pub documentation: &'static str,
}

/// What a structured field holds.
#[derive(Clone, Copy, Debug)]
pub enum Holds {
    /// A table.
    Table(&'static Section),
    /// A list of tables.
    List(&'static Section),
    /// A list of tables. The value of the key `tag` in each table is the `spec.kind` of its section.
    Tagged {
        /// The key that names the section: `kind` or `do`.
        tag: &'static str,
        /// The sections.
        sections: &'static [Section],
    },
    /// A table whose `kind` names a shape.
    Shape,
    /// A table whose `kind` names an integrator, or only that word.
    Integrator,
    /// A list of tables whose `kind` names a model.
    Models,
    /// A list of tables whose `kind` names a collider.
    Colliders,
    /// A set of nodes.
    Selector,
    /// One number per axis, or a table.
    VectorOr(&'static Section),
    /// A rotation: one number in 2D, an axis times its angle in 3D.
    Turn,
    /// A body of the scene, by its name or its number.
    BodyReference,
    /// A node by number, `"nearest"` or `"nearest_facet"`.
    Node,
    /// A list of these words, each at most once.
    Words(&'static [&'static str]),
    /// One whole number of at least 1 for each dimension of the scene (if there are fewer numbers, the rest are 1).
    Counts,
    /// A value of any type; the parameter to which it belongs determines what is allowed.
    AnyValue,
}

/// Both dimensions.
pub const ANY_DIMENSION: &[usize] = &[2, 3];

const fn section(
    kind: &'static str,
    summary: &'static str,
    documentation: &'static str,
    fields: &'static [Field],
) -> Spec {
    Spec { kind, summary, documentation, dimensions: ANY_DIMENSION, fields, roles: &[] }
}

const fn child(name: &'static str, holds: Holds, required: bool, documentation: &'static str) -> Child {
    Child { name, holds, required, documentation }
}

/// The largest whole number up to which every number format is exact: 2⁵³.
pub const LARGEST_WHOLE: i64 = 1 << 53;

/// The value of `format` that this version reads and writes.
pub const FORMAT: &str = "opruga-1";

/// The top level of a scene.
pub const SCENE: Section = Section {
    spec: &section(
        "scene",
        "The top of the file",
        "Every scene begins with its format and its number of dimensions.",
        &[
            Field::new("format", Allowed::Text, "", Default::Required, "The version of the format: `opruga-1`."),
            Field::new(
                "dimension",
                Allowed::Integer { least: 2, greatest: 3 },
                "",
                Default::Required,
                "2 for the plane, 3 for space.",
            ),
            Field::new(
                "seed",
                Allowed::Integer { least: 0, greatest: LARGEST_WHOLE },
                "",
                Default::Integer(1),
                "The seed of all random numbers; the same seed gives the same results, bit for bit.",
            ),
            Field::new(
                "title",
                Allowed::Text,
                "",
                Default::Text(""),
                "The title of the scene in lists and pictures, in one sentence.",
            ),
            Field::new(
                "length_unit",
                Allowed::Text,
                "",
                Default::Text("m"),
                "The name of the unit of length in pictures and plots, for scenes that are not in metres. No number depends on it.",
            ),
            Field::new(
                "credit",
                Allowed::Text,
                "",
                Default::Text(""),
                "The authors and licences of the drawings, maps or surfaces that the scene shows. This text appears in small type at the bottom of \
every picture and film of the scene.",
            ),
        ],
    ),
    children: &[
        child("time", Holds::Table(&TIME), true, "How time passes."),
        child("world", Holds::Table(&WORLD), false, "Forces and limits that apply everywhere."),
        child("integrator", Holds::Integrator, true, "How the equations of motion are integrated."),
        child("body", Holds::List(&BODY), false, "The deformable bodies."),
        child("collider", Holds::Colliders, false, "The rigid obstacles."),
        child("contact", Holds::Table(&CONTACT), false, "How deformable bodies touch one another."),
        child("load", Holds::Tagged { tag: "kind", sections: LOADS }, false, "External forces."),
        child(
            "command",
            Holds::Tagged { tag: "do", sections: COMMANDS },
            false,
            "Actions on the bodies while they move.",
        ),
        child("probe", Holds::List(&PROBE), false, "Columns of `diagnostics.csv` that follow nodes."),
        child("picture", Holds::Table(&PICTURE), false, "What pictures of the scene show."),
    ],
};

/// `[time]`.
pub const TIME: Section = Section {
    spec: &section(
        "time",
        "How time passes",
        "A frame is divided into substeps of h = frame / substeps.",
        &[
            Field::new("seconds", Allowed::NOT_NEGATIVE, "s", Default::Required, "How long the scene lasts."),
            Field::new(
                "frame",
                Allowed::POSITIVE,
                "s",
                Default::Number(1.0 / 60.0),
                "The length of a frame, after which the program can draw a picture, write a row of the table and run commands.",
            ),
            Field::new(
                "substeps",
                Allowed::Integer { least: 1, greatest: MOST_SUBSTEPS as i64 },
                "",
                Default::Integer(16),
                "The number of steps of the integrator in a frame.",
            ),
        ],
    ),
    children: &[],
};

/// `[picture]`.
pub const PICTURE: Section = Section {
    spec: &section(
        "picture",
        "What pictures of the scene show",
        "If a field is not given, its value is chosen from what is visible in the run. No physical result depends on these fields.",
        &[
            Field::new(
                "panels",
                Allowed::Integer { least: 1, greatest: 60 },
                "",
                Default::Absent,
                "The number of moments that `strip.png` shows. By default, there are as many moments as possible, provided that bodies remain large \
enough to see.",
            ),
            Field::new(
                "low",
                Allowed::Vector,
                "m",
                Default::Absent,
                "The corner with the smallest coordinates of the region that `strip.png` shows; give it with `high`. By default, `strip.png` shows \
everything that bodies reach, as films do.",
            ),
            Field::new(
                "high",
                Allowed::Vector,
                "m",
                Default::Absent,
                "The corner with the largest coordinates of the region that `strip.png` shows; give it with `low`.",
            ),
            Field::new(
                "azimuth",
                Allowed::Number { least: Bound::Closed(-360.0), greatest: Bound::Closed(360.0) },
                "°",
                Default::Absent,
                "In space: the angle of the camera around the y axis, from z towards x; the default is 32.",
            ),
            Field::new(
                "elevation",
                Allowed::Number { least: Bound::Closed(-89.0), greatest: Bound::Closed(89.0) },
                "°",
                Default::Absent,
                "In space: the angle of the camera above the horizon; the default is 20.",
            ),
        ],
    ),
    children: &[],
};

/// `[world]`.
pub const WORLD: Section = Section {
    spec: &section(
        "world",
        "Forces and limits that apply everywhere",
        "Gravity and drag act on every node. `largest_force` and `largest_velocity` stabilise a scene; `largest_distance` removes bodies that would \
fall for ever. These three limits are off by default; warnings report how often they act. `unfold` is not physical and is also off by default.",
        &[
            Field::new("gravity", Allowed::Vector, "m/s²", Default::Origin, "Acceleration of gravity."),
            Field::new(
                "drag",
                Allowed::NOT_NEGATIVE,
                "1/s",
                Default::Number(0.0),
                "Drag per unit of mass, a = −drag·v; it brakes rigid motion too.",
            ),
            Field::new("largest_force", Allowed::POSITIVE, "N", Default::Absent, "The largest force on a node."),
            Field::new("largest_velocity", Allowed::POSITIVE, "m/s", Default::Absent, "The largest speed of a node."),
            Field::new(
                "largest_distance",
                Allowed::POSITIVE,
                "m",
                Default::Absent,
                "A body is removed when all of its nodes are farther than this from the origin.",
            ),
            Field::new(
                "unfold",
                Allowed::Boolean,
                "",
                Default::Boolean(false),
                "Whether stuck bodies are displaced at random. A body is stuck if it is at rest with degenerate or inverted cells, or if it is at \
rest and strained although nothing acts on it. The first displacement is 1e-4 of the size of the body. If the body stays in this shape, \
displacements of a hundredth and of a tenth of its size follow. A warning reports the number of displacements.",
            ),
        ],
    ),
    children: &[],
};

/// `[[body]]`.
pub const BODY: Section = Section {
    spec: &section(
        "body",
        "A deformable body",
        "Exactly one of `mass`, `density`, `density_of_cells` and `node_mass` gives the mass of the body. The shape is scaled, then rotated about \
the origin of its own coordinates, and then moved to `position`.",
        &[
            Field::new("name", Allowed::Text, "", Default::Required, "The name of the body, unique in the scene."),
            Field::new("mass", Allowed::POSITIVE, "kg", Default::Absent, "Mass of the whole body."),
            Field::new("density", Allowed::POSITIVE, "kg/m³", Default::Absent, "Mass per volume."),
            Field::new(
                "density_of_cells",
                Allowed::Text,
                "",
                Default::Absent,
                "The name of the values in the mesh file that give the mass per volume of each cell [kg/m³].",
            ),
            Field::new("node_mass", Allowed::POSITIVE, "kg", Default::Absent, "Mass of every node."),
            Field::new(
                "fixed",
                Allowed::Boolean,
                "",
                Default::Boolean(false),
                "Whether all nodes are pinned; the body then needs no mass.",
            ),
            Field::new(
                "thickness",
                Allowed::POSITIVE,
                "m",
                Default::Number(1.0),
                "In 2D, the depth out of the plane, also for gas, loads and bending. In 3D, the thickness of a sheet or of the wall of a hollow body, or the \
width of a square wire; only `density` uses it. `density` requires `thickness` for sheets and hollow bodies in 3D, and for wires in 2D and 3D.",
            ),
            Field::new(
                "position",
                Allowed::Vector,
                "m",
                Default::Origin,
                "Where the origin of the shape's own coordinates lies at the start.",
            ),
            Field::new(
                "scale",
                Allowed::POSITIVE,
                "",
                Default::Number(1.0),
                "The factor that multiplies all lengths of the shape.",
            ),
            Field::new(
                "simplices",
                Allowed::Boolean,
                "",
                Default::Boolean(false),
                "Whether quadrilaterals are cut into two triangles each, and hexahedra into tetrahedra.",
            ),
            Field::new(
                "tetrahedra_per_hexahedron",
                Allowed::Integer { least: 5, greatest: 6 },
                "",
                Default::Integer(6),
                "The number of tetrahedra into which `simplices` cuts a hexahedron: six around a diagonal, or five (one inscribed, four at corners). \
The pattern of five alternates from cell to cell and favours no direction.",
            )
            .applies(&[Condition::Dimension(3), Condition::Given("simplices")]),
            Field::new(
                "order",
                Allowed::Integer { least: 1, greatest: 2 },
                "",
                Default::Absent,
                "With 2, triangles and tetrahedra have another node in the middle of every edge; their finite elements then lock neither in bending \
nor near incompressibility. The default is 2 if all cells are triangles or tetrahedra and a model of the body computes the stress of its cells, as \
`fem` does; otherwise it is 1. `finite_volume` needs `order = 1`. With 1, triangles and tetrahedra need less computing time, but bend too stiffly, \
and are refused above ν = 0.45 unless `locking` accepts them.",
            ),
        ],
    ),
    children: &[
        child("shape", Holds::Shape, true, "The shape of the body at rest."),
        child("rotation", Holds::Turn, false, "The rotation of the shape at rest [rad], up to 1e6 in magnitude."),
        child(
            "velocity",
            Holds::VectorOr(&VELOCITY),
            false,
            "Velocity at the start [m/s]: the same for all nodes, or a field.",
        ),
        child(
            "angular_velocity",
            Holds::Turn,
            false,
            "Angular velocity at the start about the centre of mass [rad/s].",
        ),
        child("integrator", Holds::Integrator, false, "The integrator of the body; the default is that of the scene."),
        child("models", Holds::Models, false, "The models that compute the forces of the body."),
        contact::OF_BODY,
        child("pin", Holds::List(&PIN), false, "Nodes that are held in place, or moved along a given path."),
        child(
            "copies",
            Holds::Table(&COPIES),
            false,
            "Copies of the body in rows, columns and layers, called `name[0]`, `name[1]`, …",
        ),
    ],
};

/// `velocity` in a body, as a table.
pub const VELOCITY: Section = Section {
    spec: &section(
        "velocity",
        "The velocity at the start as a field",
        "v = linear + angular × (x − c) + gradient (x − c) + of_nodes, where c is the centre of mass of the body and x the position of a node at the \
start.",
        &[
            Field::new("linear", Allowed::Vector, "m/s", Default::Origin, "The velocity of the centre of mass."),
            Field::new(
                "gradient",
                Allowed::Points,
                "1/s",
                Default::Absent,
                "∂v/∂x, a row for every axis: `[[0.1, 0], [0, 0]]` stretches the plane along x, `[[0, 1], [0, 0]]` shears it.",
            ),
            Field::new(
                "of_nodes",
                Allowed::Text,
                "",
                Default::Absent,
                "The name of the vectors in the mesh file that give the velocity of each node [m/s]. `rotation` also rotates these vectors; `scale` \
does not change them.",
            ),
        ],
    ),
    children: &[child(
        "angular",
        Holds::Turn,
        false,
        "Angular velocity about the centre of mass [rad/s], like `angular_velocity` of the body.",
    )],
};

/// An entry of `pin` in a body.
pub const PIN: Section = Section {
    spec: &section(
        "pin",
        "Nodes that are held in place, or moved along a given path",
        "Between the rows of `motion` the displacement is linear; before the first row and after the last one it is constant. A pinned node follows \
its pin, even through obstacles: an obstacle stops the neighbours of the node, but not the node itself. The work of the pin against springs and \
obstacles counts as work of the user. If a pin catches a moving node, or if `motion` has a corner, the pin changes the velocity of that node by an \
impulse. With `mass = \"consistent\"`, a node shares its inertia with its neighbours, so the impulse makes the neighbours recoil, by the same amount \
with every integrator. To accelerate the nodes gradually instead, give `motion` many rows.",
        &[
            Field::new(
                "axes",
                Allowed::Choice(&["x", "y", "z", "xy", "xz", "yz", "xyz"]),
                "",
                Default::Absent,
                "The axes along which nodes are held; the default is all axes.",
            ),
            Field::new(
                "motion",
                Allowed::Path,
                "s, m",
                Default::Absent,
                "Displacement from the position at the start, over time.",
            ),
        ],
    ),
    children: &[child("select", Holds::Selector, true, "The nodes that are pinned.")],
};

/// `copies` in a body.
pub const COPIES: Section = Section {
    spec: &section(
        "copies",
        "Copies of a body in rows, columns and layers",
        "With `count = [nx, ny, nz]`, copy k = i + nx·(j + ny·l) is called `name[k]` and lies at `position + first + (i, j, l)·spacing + jitter`. \
Copies share one mesh.",
        &[
            Field::new(
                "spacing",
                Allowed::Vector,
                "m",
                Default::Required,
                "The distance from copy to copy along every axis.",
            ),
            Field::new(
                "first",
                Allowed::Vector,
                "m",
                Default::Origin,
                "An offset that is added to the position of every copy.",
            ),
            Field::new(
                "jitter",
                Allowed::NOT_NEGATIVE,
                "m",
                Default::Number(0.0),
                "Each coordinate is displaced at random, uniformly within ±jitter. The random numbers depend on the seed of the scene.",
            ),
        ],
    ),
    children: &[child("count", Holds::Counts, true, "The number of copies along every axis.")],
};

/// The selectors, by their key.
pub const SELECTORS: &[Spec] = &[
    section(
        "box",
        "Nodes in a box between two corners",
        "`{ box = [[x, y], [x, y]] }` [m]; the surface of the box is included.",
        &[],
    ),
    section(
        "ball",
        "Nodes within a radius of a centre",
        "`{ ball = { center = [x, y], radius = r } }`",
        &[
            Field::new("center", Allowed::Vector, "m", Default::Required, "The centre."),
            Field::new("radius", Allowed::NOT_NEGATIVE, "m", Default::Required, "The radius."),
        ],
    ),
    section(
        "half_space",
        "Nodes on a plane, or on the side to which its normal points",
        "`{ half_space = { point = [x, y], normal = [x, y] } }`",
        &[
            Field::new("point", Allowed::Vector, "m", Default::Required, "A point of the plane."),
            Field::new("normal", Allowed::Vector, "", Default::Required, "The normal, of any length but zero."),
        ],
    ),
    section(
        "side",
        "Nodes on one side of the body's bounding box",
        "`{ side = \"left\" }`: left, right (x), bottom, top (y), back, front (z).",
        &[],
    ),
    section("node", "One node by number", "`{ node = 0 }`", &[]),
    section("nodes", "Nodes by number", "`{ nodes = [0, 1, 2] }`", &[]),
    section("group", "A named group of the mesh", "`{ group = \"clamped\" }`", &[]),
    section("boundary", "Nodes of the boundary", "`{ boundary = true }`", &[]),
    section("all", "Every node", "`{ all = true }`", &[]),
    section("and", "Nodes in all of the sets", "`{ and = [ { … }, { … } ] }`", &[]),
    section("or", "Nodes in at least one of the sets", "`{ or = [ { … }, { … } ] }`", &[]),
    section("not", "Nodes that are not in the set", "`{ not = { … } }`", &[]),
];

/// The lower bound of a field, if it has one; for editors and panels.
pub fn least_of(allowed: &Allowed) -> Option<f64> {
    match allowed {
        Allowed::Number { least: Bound::Closed(x) | Bound::Open(x), .. } => Some(*x),
        Allowed::Integer { least, .. } => Some(*least as f64),
        _ => None,
    }
}
