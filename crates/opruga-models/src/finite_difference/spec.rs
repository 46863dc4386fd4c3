//! Parameters of finite differences.

use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Role, Spec};

/// The parameters of `finite_difference`.
pub const SPEC: Spec = Spec {
    kind: super::KIND,
    summary: "an elastic curve, surface or solid, computed from finite differences of its metric and its curvature",
    documentation: "The energy depends on how the metric tensor G and the curvature tensor B differ from those at rest. Both tensors follow from \
differences on the regular grid of the body. With ε = ½ (G − G₀), the energy of a curve (`line`, `ring`, `polyline`, closed or open) is ½ EA ε² + ½ \
EI (B − B₀)² per length. The energy of a surface (`sheet`) is ½ Et/(1 − ν²) [(1 − ν) ε:ε + ν (tr ε)²] per area, plus the same expression in B − B₀ \
with Et³/12(1 − ν²) instead of Et/(1 − ν²). A solid (`grid`) follows the law of St. Venant and Kirchhoff. EI is E t³/12 times the depth for a curve \
in the plane, and E π t⁴/64 (a round wire) in space. Strains along an axis are defined on edges, shear strains in the middle of cells or faces, and \
curvatures at nodes. The method is of second order, and no checkerboard mode has zero energy. ν = 0 gives the uncoupled tensors of the paper. Forces \
are the exact gradient of the energy; the forces of the paper neglect the rotation of the normal. Optionally, a curve in space resists changes of \
its Frenet torsion with the stiffness GJ = EI/(1 + ν) of a round wire. This is the torsion of the centre line, not a twist of the cross-section. A \
body without a regular grid is refused. Source: Terzopoulos, Platt, Barr, Fleischer 1987, Elastically deformable models. Equations and limits: \
docs/finite-differences.md.",
    dimensions: &[2, 3],
    fields: &[
        Field::new("youngs_modulus", Allowed::POSITIVE, "Pa", Default::Required, "Young's modulus E.").starts_at(1e5),
        Field::new(
            "poissons_ratio",
            Allowed::Number { least: Bound::Open(-1.0), greatest: Bound::Open(0.5) },
            "",
            Default::Number(0.3),
            "Poisson's ratio ν of surfaces and solids (curves have none); 0 gives the uncoupled tensors of the paper.",
        ),
        Field::new(
            "thickness",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "Thickness t of a surface or of a curve in the plane, or diameter of a wire in space; a solid has none.",
        )
        .starts_at(0.02),
        Field::new(
            "damping",
            Allowed::NOT_NEGATIVE,
            "s",
            Default::Number(0.0),
            "Retardation time τ of a Kelvin–Voigt solid: stresses follow from ε + τ dε/dt, and moments from B + τ dB/dt.",
        ),
        Field::new(
            "torsion",
            Allowed::Boolean,
            "",
            Default::Boolean(false),
            "Whether a curve resists a change of its Frenet torsion; the curve must then be curved at every inner node.",
        )
        .applies(&[Condition::Dimension(3)]),
        Field::new(
            "plane",
            Allowed::Choice(&["strain", "stress"]),
            "",
            Default::Text("strain"),
            "For solids in the plane: with \"strain\", nothing moves across the plane; with \"stress\", no stress acts across it.",
        )
        .applies(&[Condition::Dimension(2)]),
    ],
    roles: &[Role::OwnsCells],
};
