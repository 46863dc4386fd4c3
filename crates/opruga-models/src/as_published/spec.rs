//! Parameters of the published program.

use opruga_core::spec::{Allowed, Default, Field, Role, Spec};

/// The parameters of `as_published`.
pub const SPEC: Spec = Spec {
    kind: "as_published",
    summary: "the program of the thesis as published, including its errors, with springs, a \"volume\", doubled pressure, a ramp and a pointer",
    documentation: "The model computes the forces of the program in D. Križaić's thesis (2012, 3.3 and 4). Lengths are in pixels of that program, \
and y points downwards. Use the model with `symplectic_euler`, a step of 0.001 s, `node_mass = 1` and world gravity 0 (the model has its own \
gravity). The floor of the program is an ordinary collider: a half-space at y = 500 with normal [0, -1], restitution 0.5, friction 0. The model has \
no potential: energy is not conserved, and the work of the model counts as work from outside. An edge without length makes its forces infinite or \
not a number, as published. For correct physics, use `mass_spring` with `pressure`. The documentation of the module describes the eleven differences \
(E1 to E11) between `as_published` and these models.",
    dimensions: &[2],
    fields: &[
        Field::new("stiffness", Allowed::NOT_NEGATIVE, "kg/s²", Default::Number(1600.0), "Spring constant KS."),
        Field::new(
            "damping",
            Allowed::NOT_NEGATIVE,
            "kg/s",
            Default::Number(40.0),
            "Damping constant KD along each spring.",
        ),
        Field::new(
            "final_pressure",
            Allowed::NOT_NEGATIVE,
            "",
            Default::Number(100.0),
            "FINAL_PRESSURE; the pressure rises to it in steps of a hundredth of this value.",
        ),
        Field::new("factor", Allowed::ANY, "", Default::Number(1000.0), "The stray factor on the pressure force (E3)."),
        Field::new(
            "gravity_y",
            Allowed::ANY,
            "px/s²",
            Default::Number(10.0),
            "GY, positive downwards; gravity acts only after the ramp has ended (E5).",
        ),
        Field::new(
            "pointer",
            Allowed::Path,
            "px",
            Default::Absent,
            "The position of the mouse over time: `[[t, x, y], …]`, linear between its points; the button is held from the first point to the last.",
        ),
        Field::new(
            "held",
            Allowed::Curve,
            "s",
            Default::Absent,
            "The times at which the button is held, if it is not held throughout `pointer`: `[[press, release], …]`. Each press grabs the vertex \
nearest to the pointer.",
        ),
    ],
    roles: &[Role::Published],
};
