//! Parameters of finite volumes.

use crate::materials::NAMES;
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

/// The parameters of `finite_volume`.
pub const SPEC: Spec = Spec {
    kind: "finite_volume",
    summary: "an elastic solid, computed with finite volumes: tractions act on the faces of the dual cell of each node",
    documentation: "The force on a node is the traction P N of the first Piola–Kirchhoff stress, summed over the faces of the dual cell of the node. \
These faces lie between the middles of edges, sides and cells. On triangles and tetrahedra F is constant, and forces, energy and Hessian are those \
of linear finite elements (`fem` with `order = 1`). On quadrilaterals and hexahedra, F is evaluated at the middle of each dual face. The forces are \
then not the gradient of an energy, and their tangent is not symmetric. Only explicit integrators and `equilibrium` can step bodies of these cells. \
The ledger contains no elastic energy for such bodies. Materials, E and ν, plane strain and plane stress have the same meaning as in `fem`. Limits: \
triangles and tetrahedra lock in bending and above ν = 0.45; above ν = 0.45, they are refused unless `locking` accepts them. The model has no \
damping of its own (use `world.drag`). Equations and measurements: docs/finite-volumes.md. Source: Teran, Blemker, Ng-Thow-Hing, Fedkiw 2003, Finite \
volume methods for the simulation of skeletal muscle.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "material",
            Allowed::Choice(NAMES),
            "",
            Default::Text("stable_neo_hookean"),
            "The law: `linear` for small strain, `corotated` for small strain with large rotation, or a law of rubber for large strain.",
        ),
        Field::new("youngs_modulus", Allowed::POSITIVE, "Pa", Default::Required, "Young's modulus E."),
        Field::new(
            "poissons_ratio",
            Allowed::Number { least: Bound::Open(-1.0), greatest: Bound::Open(0.5) },
            "",
            Default::Number(0.3),
            "Poisson's ratio ν; it is nearly 0.5 for rubber.",
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
            "mooney_share",
            Allowed::FRACTION,
            "",
            Default::Number(0.2),
            "C₂/(C₁ + C₂), where 2(C₁ + C₂) = μ; 0.2 means C₁ : C₂ = 4 : 1. At most ν/(1 − 2ν) is allowed.",
        )
        .applies(&[Condition::Word("material", &["mooney_rivlin"])]),
        Field::new(
            "locking",
            Allowed::Choice(&["refuse", "accept"]),
            "",
            Default::Text("refuse"),
            "What happens with triangles and tetrahedra above ν = 0.45: \"refuse\" gives an error, and \"accept\" accepts them although they lock.",
        ),
    ],
    roles: &[Role::OwnsCells],
};
