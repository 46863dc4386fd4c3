//! Parameters of the spring model.

use opruga_core::spec::{Allowed, Default, Field, Role, Spec};

const STIFFNESS: &[&str] = &["stiffness", "modulus"];

/// The parameters of `mass_spring`.
pub const SPEC: Spec = Spec {
    kind: "mass_spring",
    summary: "linear springs along the edges of the mesh, with damping along each spring",
    documentation: "Energy U = Σ ½ k (|x_a − x_b| − l₀)². The elastic force on node a is −k (r − l₀) d/r with d = x_a − x_b and r = |d|; the damping \
force is −c (ḋ·d/r) d/r. With `modulus` E₂D, k = E₂D ΣA/l₀², where ΣA is the area of the triangles next to the edge. On a regular triangular lattice \
k is √3/2·E₂D, and half of that on the boundary; the lattice acts as a sheet with Poisson's ratio 1/3. A spring whose ends coincide has no \
direction, so its force is zero. A ring of springs alone resists neither bending nor a change of its enclosed area. Source: Nealen et al. 2005, §4.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "stiffness",
            Allowed::NOT_NEGATIVE,
            "N/m",
            Default::OneOf(STIFFNESS),
            "Spring constant k of every spring; give exactly one of `stiffness` and `modulus`.",
        )
        .starts_at(400.0),
        Field::new(
            "modulus",
            Allowed::NOT_NEGATIVE,
            "N/m",
            Default::OneOf(STIFFNESS),
            "Membrane modulus E₂D (Young's modulus times thickness) from which each spring's stiffness follows.",
        )
        .starts_at(300.0),
        Field::new(
            "damping",
            Allowed::NOT_NEGATIVE,
            "N·s/m",
            Default::Number(0.0),
            "Damping constant c of every spring; the damping force is zero under rigid motion.",
        ),
        Field::new(
            "edges",
            Allowed::Choice(&["boundary", "all", "shear"]),
            "",
            Default::Text("all"),
            "Which edges carry springs: those of the boundary, all edges, or all edges and the diagonals of grid cells.",
        ),
        Field::new(
            "rest_scale",
            Allowed::NOT_NEGATIVE,
            "",
            Default::Number(1.0),
            "Rest length as a multiple of the length in the rest shape.",
        ),
    ],
    roles: &[Role::Edges],
};
