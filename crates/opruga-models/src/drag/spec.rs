//! Parameters of the drag.

use opruga_core::spec::{Allowed, Default, Field, Role, Spec};

/// The parameters of `drag`.
pub const SPEC: Spec = Spec {
    kind: "drag",
    summary: "braking of every node in proportion to its mass and velocity",
    documentation: "Force −λ m v on every node: v falls as e^(−λt). The drag brakes rigid motion by design: a falling body tends to the speed g/λ. \
To damp only oscillations, use the `damping` of `mass_spring` or `bending`, which has no effect on rigid motion.",
    dimensions: &[2, 3],
    fields: &[Field::new("rate", Allowed::NOT_NEGATIVE, "1/s", Default::Required, "Rate λ at which velocities fall.")],
    roles: &[Role::WorldDrag],
};
