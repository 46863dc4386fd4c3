//! `[[load]]`, `[[command]]` and `[[probe]]`.

use super::{BODY, Child, Holds, Section, child, section};
use opruga_core::spec::{Allowed, Default, Field};

const CURVE: Field = Field::new(
    "curve",
    Allowed::Curve,
    "s, 1",
    Default::Absent,
    "The factor of the load over time, linear between the rows; the default is 1.",
);
const LOAD_CHILDREN: &[Child] = &[
    child(
        "body",
        Holds::BodyReference,
        true,
        "The body, from the scene or added by a command. The name of a body with copies means all copies; `NAME[i]` means one of them.",
    ),
    child(
        "select",
        Holds::Selector,
        false,
        "The selected nodes; the default is all nodes. For copies, positions in the selector are shifted with each copy.",
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
            "A force of the same magnitude on every selected node, towards a fixed point",
            "There is no force on a node at the point itself.",
            &[
                Field::new(
                    "value",
                    Allowed::ANY,
                    "N",
                    Default::Required,
                    "The force on every node; if it is negative, the force points away from the point.",
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
            "The force is spread over the facets of the boundary whose nodes are all selected.",
            &[Field::new("value", Allowed::Vector, "Pa", Default::Required, "The force per area."), CURVE],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "pressure",
            "A pressure on the boundary, along its current inward normal",
            "The pressure acts on the facets of the boundary whose nodes are all selected.",
            &[
                Field::new(
                    "value",
                    Allowed::ANY,
                    "Pa",
                    Default::Required,
                    "The pressure; a positive value presses inwards.",
                ),
                CURVE,
            ],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "body_force",
            "A force per volume at rest",
            "The force is spread over the cells whose nodes are all selected. The force on a node is `value` times the integral of the shape \
function of the node over the volume of these cells. In 2D, the volume is the area times the body's `thickness`.",
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
    "The command begins at the start of the first frame that begins at this time or later.",
);
const UNTIL: Field = Field::new(
    "until",
    Allowed::NOT_NEGATIVE,
    "s",
    Default::Required,
    "The command ends at the start of the first frame that begins at this time or later.",
);

/// `[[command]]`, by `do`.
pub const COMMANDS: &[Section] = &[
    Section {
        spec: &section(
            "drag",
            "Pull a node towards a moving pointer with a critically damped spring",
            "",
            &[
                AT,
                Field::new(
                    "until",
                    Allowed::NOT_NEGATIVE,
                    "s",
                    Default::Absent,
                    "The command ends at the start of the first frame that begins at this time or later; the default is the end of the path.",
                ),
                Field::new("path", Allowed::Path, "s, m", Default::Required, "The path of the pointer."),
                Field::new(
                    "stiffness",
                    Allowed::POSITIVE,
                    "N/m",
                    Default::Absent,
                    "Stiffness of the spring; by default it is chosen for the body.",
                ),
                Field::new(
                    "largest_force",
                    Allowed::POSITIVE,
                    "N",
                    Default::Absent,
                    "The largest force of the spring; a warning counts how often this limit acts. The default is the force of the spring when it is \
stretched by ten times the size of the body.",
                ),
            ],
        ),
        children: &[
            child("body", Holds::BodyReference, true, "The body; if it has copies, one of the copies: `NAME[i]`."),
            child(
                "node",
                Holds::Node,
                false,
                "What is pulled: a node, the node nearest to the pointer at the beginning (the default), or the nearest point of a facet.",
            ),
        ],
    },
    Section {
        spec: &section(
            "push",
            "Push nodes with a force",
            "",
            &[AT, UNTIL, Field::new("force", Allowed::Vector, "N", Default::Required, "The force on every node.")],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "pin",
            "Pin nodes where they are when the command begins",
            "",
            &[
                AT,
                UNTIL,
                Field::new(
                    "axes",
                    Allowed::Choice(&["x", "y", "z", "xy", "xz", "yz", "xyz"]),
                    "",
                    Default::Absent,
                    "The axes along which nodes are held; the default is all axes.",
                ),
            ],
        ),
        children: LOAD_CHILDREN,
    },
    Section {
        spec: &section(
            "free",
            "Release pinned nodes",
            "Pins of the body and of earlier commands no longer hold these nodes.",
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
                    "The parameter: `body.NAME.models.KIND.field` (the `NAME` of a body with copies means all copies), `body.NAME.integrator.field`, \
`integrator.field`, `world.field`, `contact.field`, `collider.NUMBER.field` or `time.substeps`.",
                ),
            ],
        ),
        children: &[child("value", Holds::AnyValue, true, "The new value of the parameter.")],
    },
    Section {
        spec: &section(
            "change",
            "Give a body other models or another integrator while it moves",
            "Positions and velocities do not change. The first new model of a kind inherits the state of the body's previous model of that kind, \
such as the amount of gas. If the body had no model of that kind, the new model begins as at the start of a scene. Fields that are not given do not \
change.",
            &[AT],
        ),
        children: &[
            child(
                "body",
                Holds::BodyReference,
                true,
                "The body. The name of a body with copies means all copies; `NAME[i]` means one of them.",
            ),
            child("models", Holds::Models, false, "The models of the body from now on, as in `[[body]]`."),
            child("integrator", Holds::Integrator, false, "The integrator of the body from now on."),
        ],
    },
    Section {
        spec: &section("add", "Add a body", "", &[AT]),
        children: &[child("body", Holds::Table(&BODY), true, "The body, as in `[[body]]`, without copies.")],
    },
    Section {
        spec: &section(
            "remove",
            "Remove a body",
            "",
            &[
                AT,
                Field::new(
                    "body",
                    Allowed::Text,
                    "",
                    Default::Required,
                    "The name of a body of the scene, or of a body that a command has added.",
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
        "Positions and velocities are means over the nodes; reactions are sums. A reaction is the force that pins exert on pinned nodes: mass times \
acceleration, minus the forces of models and loads, minus the weight. The acceleration of a pin is computed from its motion over the previous frame \
and the next one. The impulse of a pin that catches a moving node is not included. `contact` is the sum of the normal forces and friction that \
obstacles exert in the next substep; obstacles exert no such forces on pinned nodes. With `[contact]`, this sum also contains the forces of other \
bodies, and of corners and edges of obstacles, in the previous substep. `stress` is Cauchy's stress and `volume_ratio` is J: the value at a node is \
the mean over the finite elements around it, weighted by their volume at rest. The columns contain the mean over the nodes, and the von Mises stress \
of this mean. The names of the columns are NAME.x, NAME.y, … for the position, NAME.vx, … for the velocity, NAME.rx, … for the reaction, and \
NAME.cx, … for the contact. For the stress, they are NAME.sxx, NAME.syy, NAME.szz, NAME.sxy, in 3D also NAME.syz and NAME.szx, and NAME.von_mises; \
in 2D, szz acts across the plane. The volume ratio is NAME.volume_ratio. All columns are NaN while the body does not exist; stress and volume ratio \
are also NaN while no model of the body computes them.",
        &[Field::new(
            "name",
            Allowed::Text,
            "",
            Default::Required,
            "The first part of the names of the columns; no other probe of the scene has the same name.",
        )],
    ),
    children: &[
        child("body", Holds::BodyReference, true, "The body; if it has copies, one of the copies: `NAME[i]`."),
        child("select", Holds::Selector, false, "The selected nodes; the default is all nodes."),
        child(
            "record",
            Holds::Words(&["position", "velocity", "reaction", "contact", "stress", "volume_ratio"]),
            true,
            "The quantities that are recorded.",
        ),
    ],
};
