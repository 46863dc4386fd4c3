//! Parameters of the colliders.
//!
//! Only two fields depend on the dimension: a spin and a rotation are a number in 2D and a vector along the axis in 3D.

use opruga_core::spec::{Allowed, Condition, Default, Field, Role, Spec};

const NO: Default = Default::Boolean(false);
const ZERO: Default = Default::Number(0.0);

/// Writes the specification of one kind for one dimension: its own fields, then the fields that every collider has.
macro_rules! collider {
    ($(#[$note:meta])* $name:ident, $kind:literal, $dimension:literal, $turn:expr, $roles:expr, $summary:literal, $documentation:expr; $($own:expr),+ $(,)?) => {
        $(#[$note])*
        pub const $name: Spec = Spec {
            kind: $kind,
            summary: $summary,
            documentation: $documentation,
            dimensions: &[$dimension],
            fields: &[
                $($own,)+
                Field::new("restitution", Allowed::FRACTION, "", ZERO, "Ratio of the normal speeds after and before an impact. The speed before an \
impact is the speed at which a node meets the surface within the step: √(u² + 2 a g), where u and g are the speed and the gap of the node at the \
start of the step, and a is its acceleration by forces. This speed is limited to the speed at the end of the step, so that an impact creates no \
energy. With `rest_speed = 0`, the speed at the end of the step is always used, as in the thesis. Forces that push a node towards the surface then \
give it a little energy. Between two impacts at speed v, `symplectic_euler` loses about m g h v of energy: a ball dropped from 1 m loses a tenth of \
its energy in 20 s at 16 substeps. `verlet` loses no energy."),
                Field::new("friction", Allowed::NOT_NEGATIVE, "", ZERO, "Coulomb's coefficient µ, for both sticking and sliding."),
                Field::new("rest_speed", Allowed::NOT_NEGATIVE, "m/s", Default::Number(0.05), "Normal speed up to which a contact does not bounce; \
with 0, every node that crosses the surface bounces, even a node at rest on the collider.").applies(&[Condition::NotZero("restitution")]),
                Field::new("thickness", Allowed::NOT_NEGATIVE, "m", ZERO, "Distance that nodes keep from the surface; edges and corners become round."),
                Field::new("motion", Allowed::Path, "s, m", Default::Absent, "Displacement over time, added to the position; the obstacle is at rest \
before the first row and after the last one."),
                Field::new("spin", $turn, "rad/s", Default::Absent, "Angular velocity about the pivot, from t = 0 on; in 3D a vector along the axis."),
                Field::new("pivot", Allowed::Vector, "m", Default::Absent, "A point of the axis of the spin; the default is the centre of the \
shape.").applies(&[Condition::Given("spin")]),
            ], roles: $roles, };
    };
}

/// Writes a specification for 2D and for 3D.
macro_rules! both {
    ($plane:ident, $space:ident, $kind:literal, $roles:expr, $summary:literal, $documentation:expr; $($own:expr),+ $(,)?) => {
        collider! { #[doc = concat!("The parameters of `", $kind, "` in 2D.")] $plane, $kind, 2, Allowed::ANY, $roles, $summary, $documentation; $($own),+ }
        collider! { #[doc = concat!("The parameters of `", $kind, "` in 3D.")] $space, $kind, 3, Allowed::Vector, $roles, $summary, $documentation; $($own),+ }
    };
}

both! { HALF_SPACE_2D, HALF_SPACE_3D, "half_space", &[Role::HalfSpace],
    "everything behind a line (2D) or plane (3D): floor, wall, incline",
    "The region with (x − point)·normal < 0 is solid. The normal may have any length above zero.";
    Field::new("point", Allowed::Vector, "m", Default::Origin, "A point of the surface."),
    Field::new("normal", Allowed::Direction, "", Default::Required, "Direction out of the solid."),
}

const BOX_TEXT: &str = "The box is solid; with `inside = true`, it is a container that keeps bodies within its walls. The box is given by two \
opposite corners, or by its centre and size; in the second case, it can also be rotated. A node inside the solid box leaves through the nearest \
face. If it has moved by more than a quarter of the smallest side in a step, it leaves through the face by which it entered.";
const MIN: Field = Field::new(
    "min",
    Allowed::Vector,
    "m",
    Default::Absent,
    "Corner with the least coordinates; give it with `max`, instead of `center` and `size`.",
)
.with(&["max"]);
const MAX: Field =
    Field::new("max", Allowed::Vector, "m", Default::Absent, "Corner with the greatest coordinates.").with(&["min"]);
const CENTER: Field = Field::new(
    "center",
    Allowed::Vector,
    "m",
    Default::Absent,
    "Centre of the box; give it with `size`, instead of `min` and `max`.",
)
.with(&["size"]);
const SIZE: Field =
    Field::new("size", Allowed::Vector, "m", Default::Absent, "Lengths of the sides.").with(&["center"]);
const INSIDE_BOX: Field =
    Field::new("inside", Allowed::Boolean, "", NO, "Whether the obstacle keeps bodies inside instead of outside.");

collider! {
    /// The parameters of `box` in 2D.
    BOX_2D, "box", 2, Allowed::ANY, &[], "a box: solid, or a container", BOX_TEXT;
    MIN, MAX, CENTER, SIZE,
    Field::new("rotation", Allowed::ANY, "rad", Default::Absent, "Angle by which the box is rotated about its centre, counter-clockwise."),
    INSIDE_BOX,
}
collider! {
    /// The parameters of `box` in 3D.
    BOX_3D, "box", 3, Allowed::Vector, &[], "a box: solid, or a container", BOX_TEXT;
    MIN, MAX, CENTER, SIZE,
    Field::new("rotation", Allowed::Vector, "rad", Default::Absent, "Rotation vector (axis times angle) by which the box is rotated about its \
centre."),
    INSIDE_BOX,
}

both! { BALL_2D, BALL_3D, "ball", &[],
    "a disc (2D) or ball (3D): solid, or a container",
    "The region with |x − center| < radius is solid; with `inside = true`, everything else is solid. A node exactly at the centre leaves along +y.";
    Field::new("center", Allowed::Vector, "m", Default::Origin, "The centre."),
    Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The radius."),
    Field::new("inside", Allowed::Boolean, "", NO, "Whether the obstacle keeps bodies inside instead of outside."),
}

both! { CAPSULE_2D, CAPSULE_3D, "capsule", &[],
    "all points within a given distance of a segment",
    "The region closer than `radius` to the segment from `a` to `b` is solid. A node exactly on the segment leaves at a right angle to it.";
    Field::new("a", Allowed::Vector, "m", Default::Required, "One end of the segment."),
    Field::new("b", Allowed::Vector, "m", Default::Required, "The other end, a different point from `a`."),
    Field::new("radius", Allowed::POSITIVE, "m", Default::Required, "The radius."),
}

both! { CONVEX_2D, CONVEX_3D, "convex", &[],
    "the convex hull of points",
    "The convex hull of the points is solid; points inside the hull have no effect. A node inside the hull leaves through the nearest face.";
    Field::new("points", Allowed::Points, "m", Default::Required, "Points whose hull has an area (2D) or a volume (3D)."),
}

const THIN: &str = "An infinitely thin surface that stops nodes from either side: a node stays on the side on which it was before the step, however \
fast it is. Nodes keep a distance of at least a hundred-millionth of the size of the surface. A node that starts exactly on the surface goes to the \
side of the normal (in 2D, to the left of the direction in which the points run; in 3D, by the right-hand rule).";

collider! {
    /// The parameters of `polyline` (2D).
    POLYLINE, "polyline", 2, Allowed::ANY, &[], "a thin curve of straight segments, open or closed", THIN;
    Field::new("points", Allowed::Points, "m", Default::Required, "Two or more points, each different from the one before."),
    Field::new("closed", Allowed::Boolean, "", NO, "Whether the last point is joined to the first; needs three points."),
}
collider! {
    /// The parameters of `triangle_mesh` (3D).
    TRIANGLE_MESH, "triangle_mesh", 3, Allowed::Vector, &[], "a thin surface of triangles, open or closed", THIN;
    Field::new("points", Allowed::Points, "m", Default::Required, "The corners of the triangles."),
    Field::new("triangles", Allowed::Integers, "", Default::Required, "The numbers of the three points of each triangle, counted from 0."),
}

/// The specification of every kind of collider that exists in a dimension.
pub fn all(dimension: usize) -> Vec<&'static Spec> {
    match dimension {
        2 => vec![&HALF_SPACE_2D, &BOX_2D, &BALL_2D, &CAPSULE_2D, &CONVEX_2D, &POLYLINE],
        3 => vec![&HALF_SPACE_3D, &BOX_3D, &BALL_3D, &CAPSULE_3D, &CONVEX_3D, &TRIANGLE_MESH],
        _ => Vec::new(),
    }
}
