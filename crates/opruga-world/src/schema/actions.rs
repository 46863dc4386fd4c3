//! `[[load]]`, `[[command]]` and `[[probe]]`.

use super::{BODY, Child, Holds, Section, child, section};
use opruga_core::spec::{Allowed, Default, Field};

const CURVE: Field = Field::new(
    "curve",
    Allowed::Curve,
    "s, 1",
    Default::Absent,
    "A factor over time, linear between its rows; 1 where the scene is silent.",
);
const LOAD_CHILDREN: &[Child] = &[
    child(
        "body",
        Holds::BodyReference,
        true,
        "The body, of the scene or added by a command; the name of a body with copies means all of them, `NAME[i]` one.",
    ),
    child(
        "select",
        Holds::Selector,
        false,
        "Which nodes; all where the scene is silent. Places move along with every copy.",
    ),
];

/// `[[load]]`, by `kind`.
pub const LOADS: &[Section] = &[
    Section {
        spec: &section(
            "force",
            "The same force on every selected node",
            "",
            &[Field::new("value", Allowed::Vector, "N", Default::Required, "The force on every node."), CURVE],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "central_force",
            "A force of one size on every selected node, towards a point that stays where it is",
            "A node at the point itself feels none.",
            &[
                Field::new(
                    "value",
                    Allowed::ANY,
                    "N",
                    Default::Required,
                    "The force on every node; negative: away from the point.",
                ),
                Field::new("center", Allowed::Vector, "m", Default::Required, "The point, the same for all copies."),
                CURVE,
            ],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "traction",
            "A force per area of the boundary at rest",
            "It is spread over the facets of the boundary all of whose nodes are selected.",
            &[Field::new("value", Allowed::Vector, "Pa", Default::Required, "The force per area."), CURVE],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "pressure",
            "A pressure on the boundary, along its present inner normal",
            "It acts on the facets of the boundary all of whose nodes are selected.",
            &[
                Field::new("value", Allowed::ANY, "Pa", Default::Required, "The pressure; positive presses inwards."),
                CURVE,
            ],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "body_force",
            "A force per volume at rest",
            "It is spread over the cells all of whose nodes are selected, by their shape functions: on a node acts the force times the integral of its \
function over the volume; in 2D the volume is the area times the body's `thickness`.",
            &[Field::new("value", Allowed::Vector, "N/m³", Default::Required, "The force per volume."), CURVE],
        ),
        children: LOAD_CHILDREN,
    },
];

const AT: Field = Field::new(
    "at",
    Allowed::NOT_NEGATIVE,
    "s",
    Default::Required,
    "When it begins: with the first frame that begins then or later.",
);
const UNTIL: Field = Field::new(
    "until",
    Allowed::NOT_NEGATIVE,
    "s",
    Default::Required,
    "When it ends: with the first frame that begins then or later.",
);

/// `[[command]]`, by `do`.
pub const COMMANDS: &[Section] = &[
    Section {
        spec: &section(
            "drag",
            "Pull a node toward a moving pointer by a critically damped spring",
            "",
            &[
                AT,
                Field::new(
                    "until",
                    Allowed::NOT_NEGATIVE,
                    "s",
                    Default::Absent,
                    "When it ends: with the first frame that begins then or later; the end of the path where the scene is silent.",
                ),
                Field::new("path", Allowed::Path, "s, m", Default::Required, "The path of the pointer."),
                Field::new(
                    "stiffness",
                    Allowed::POSITIVE,
                    "N/m",
                    Default::Absent,
                    "Stiffness of the spring; chosen from the body where the scene is silent.",
                ),
                Field::new(
                    "largest_force",
                    Allowed::POSITIVE,
                    "N",
                    Default::Absent,
                    "The largest force, every time it acts is counted; that of the spring stretched by ten sizes of the body where the scene is silent.",
                ),
            ],
        ),
        children: &[
            child("body", Holds::BodyReference, true, "The body; of copies one, `NAME[i]`."),
            child(
                "node",
                Holds::Node,
                false,
                "What is held: a node, the node nearest to the pointer at the beginning (so too where the scene is silent), or the nearest point of a facet.",
            ),
        ],
    },
    Section {
        spec: &section(
            "push",
            "A force on nodes",
            "",
            &[AT, UNTIL, Field::new("force", Allowed::Vector, "N", Default::Required, "The force on every node.")],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "pin",
            "Hold nodes where they are at the beginning",
            "",
            &[
                AT,
                UNTIL,
                Field::new(
                    "axes",
                    Allowed::Choice(&["x", "y", "z", "xy", "xz", "yz", "xyz"]),
                    "",
                    Default::Absent,
                    "The axes that are held; all where the scene is silent.",
                ),
            ],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "free",
            "Let go of nodes that are held",
            "Pins of the body, and of commands before this one, hold these nodes no longer.",
            &[AT],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "set",
            "Change a parameter",
            "",
            &[
                AT,
                Field::new(
                    "path",
                    Allowed::Text,
                    "",
                    Default::Required,
                    "The parameter: `body.NAME.models.KIND.field` (`NAME` of a body with copies: all of them), `body.NAME.integrator.field`, `integrator.field`, `world.field`, `collider.NUMBER.field` or `time.substeps`.",
                ),
            ],
        ),
        children: &[child("value", Holds::AnyValue, true, "Its new value.")],
    },
    Section {
        spec: &section(
            "change",
            "Give a body other models or another integrator while it moves",
            "Positions and velocities stay. What a model remembers, such as the amount of its gas, stays with the first of its kind; a kind that the body did not have begins as at the start of a scene. What is silent stays as it was.",
            &[AT],
        ),
        children: &[
            child(
                "body",
                Holds::BodyReference,
                true,
                "The body; the name of a body with copies means all of them, `NAME[i]` one.",
            ),
            child("models", Holds::Models, false, "Its models from now on, as in `[[body]]`."),
            child("integrator", Holds::Integrator, false, "Its own integrator from now on."),
        ],
    },
    Section {
        spec: &section("add", "Add a body", "", &[AT]),
        children: &[child("body", Holds::Table(&BODY), true, "The body, as in `[[body]]`, without copies.")],
    },
    Section {
        spec: &section(
            "remove",
            "Take a body away",
            "",
            &[
                AT,
                Field::new(
                    "body",
                    Allowed::Text,
                    "",
                    Default::Required,
                    "The name of the body, of the scene or added before.",
                ),
            ],
        ),
        children: &[],
    },
];

/// `[[probe]]`.
pub const PROBE: Section = Section {
    spec: &section(
        "probe",
        "Columns of diagnostics.csv that follow nodes",
        "Of positions and velocities the mean over the nodes is written, of reactions the sum: the force that pins give, mass \
times acceleration less the forces of the models and the weight on what is held. How a pin accelerates is taken from its motion \
over the frame before and the one after. The impulse with which a pin takes hold of what moves is not in it. `contact` is the sum of the forces of \
obstacles in the coming step, normal force and friction; what a pin holds has none. `stress` is Cauchy's stress and `volume_ratio` J: a node has of the cells of finite \
elements around it the mean by their volume at rest, and of the nodes the mean is written, and the von Mises stress of it. Columns are NAME.x, \
NAME.y (position), NAME.vx … (velocity), NAME.rx … (reaction), NAME.cx … (contact), NAME.sxx, syy, szz, sxy, in 3D syz, szx, and von_mises \
(stress, szz in 2D across the plane), NAME.volume_ratio; not a number while the body is not there, or has no finite elements any more.",
        &[Field::new(
            "name",
            Allowed::Text,
            "",
            Default::Required,
            "The first part of the names of its columns, unique in the scene.",
        )],
    ),
    children: &[
        child("body", Holds::BodyReference, true, "The body; of copies one, `NAME[i]`."),
        child("select", Holds::Selector, false, "Which nodes; all where the scene is silent."),
        child(
            "record",
            Holds::Words(&["position", "velocity", "reaction", "contact", "stress", "volume_ratio"]),
            true,
            "What is written down.",
        ),
    ],
};
