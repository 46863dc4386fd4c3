//! Parameters of boundary elements.

use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

/// The parameters of `boundary_element`.
pub const SPEC: Spec = Spec {
    kind: "boundary_element",
    summary: "an elastic solid, computed from its boundary alone: Kelvin's solution on the edges of an outline or the triangles of a surface",
    documentation: "The solid inside a closed boundary follows linear elasticity and needs no mesh inside. Displacements and tractions are linear on \
each edge (in space, on each triangle). Every vertex has one traction for each smooth part of the boundary that meets at the vertex. The stiffness K \
of the boundary is dense. K is corrected so that it is symmetric and so that rigid motion causes no forces; readings report the size of both \
corrections. The force is the gradient of U = ½ uᵀKu with u = Rᵀ(x − x̄) − X, where R is the rotation nearest to the deformation of the whole body. \
The body may therefore move and rotate freely, but its strain must be small in the frame R. The mass lies on the boundary, so frequencies differ \
from those of a solid whose mass is spread through its volume. `exterior = true` models the infinite medium around the boundary instead. This medium \
does not rotate: R is the identity. Limits: one solid, which may have cavities, with at most 2000 vertices; even large strain and bending by large \
angles are computed by linear elasticity in one frame. Equations and measurements: docs/boundary-elements.md. Source: Brebbia, Telles, Wrobel 1984, \
Boundary element techniques; James, Pai 1999, ArtDefo.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("youngs_modulus", Allowed::POSITIVE, "Pa", Default::Required, "Young's modulus E.").starts_at(1e5),
        Field::new(
            "poissons_ratio",
            Allowed::Number { least: Bound::Open(-1.0), greatest: Bound::Open(0.5) },
            "",
            Default::Number(0.3),
            "Poisson's ratio ν.",
        ),
        Field::new(
            "plane",
            Allowed::Choice(&["strain", "stress"]),
            "",
            Default::Text("strain"),
            "With \"strain\", nothing moves across the plane; with \"stress\", no stress acts across it.",
        )
        .applies(&[Condition::Dimension(2)]),
        Field::new(
            "exterior",
            Allowed::Boolean,
            "",
            Default::Boolean(false),
            "Whether the solid is the infinite medium around the boundary instead of the region inside.",
        ),
        Field::new(
            "stress_points",
            Allowed::Points,
            "m",
            Default::Absent,
            "Points in the solid at rest. Readings report the stress at these points in the frame R, as `stress0.xx`, `stress0.xy` and so on.",
        ),
    ],
    roles: &[Role::InsideOfBoundary],
};
