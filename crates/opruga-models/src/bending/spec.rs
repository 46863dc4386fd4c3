//! Parameters of the bending model.

use opruga_core::spec::{Allowed, Default, Field, Spec};

const STIFFNESS: &[&str] = &["stiffness", "modulus"];

/// The parameters of `bending`.
pub const SPEC: Spec = Spec {
    kind: "bending",
    summary: "resistance of outlines, chains and shells to bending away from their rest angles",
    documentation: "Energy U = Σ ½ k (θ − θ₀)² over hinges. A hinge is a node between two edges of an outline or chain, or an edge between two \
triangles of a surface. θ is the angle by which the second edge (triangle) turns away from the first, and θ₀ is this angle in the rest shape. \
`stiffness` gives k itself. `modulus` E and `thickness` t give k = EI/ℓ for outlines and chains, where ℓ is the mean length of the two edges; EI is \
E t³/12 times the depth in 2D, and E π t⁴/64 (a round wire) in 3D. For surfaces, `modulus` and `thickness` give k = E t³/12 · l²/(A₁ + A₂), where l \
is the length of the edge and A₁ and A₂ are the areas of the two triangles. This stiffness is exact for a sheet rolled up into a cylinder. A sheet \
that may warp deflects more, by an eighth on regular triangles and by a quarter on right-angled ones. With these values a ring of radius R buckles \
under the outer pressure 3EI/R³, and a strip clamped by two nodes (the clamp acts halfway between them) bends like an Euler–Bernoulli beam. If θ \
differs from θ₀ by more than 180°, the difference is measured the short way round. Edges without length and triangles without area have no angle \
and give no force; close to such shapes, the force is large (k θ/ℓ). Source: Grinspun et al. 2003, Discrete shells; Seung and Nelson 1988.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "stiffness",
            Allowed::NOT_NEGATIVE,
            "N·m",
            Default::OneOf(STIFFNESS),
            "Stiffness k of every hinge (moment per angle); give exactly one of `stiffness` and `modulus`.",
        )
        .starts_at(0.02),
        Field::new(
            "modulus",
            Allowed::NOT_NEGATIVE,
            "Pa",
            Default::OneOf(STIFFNESS),
            "Young's modulus E, from which each hinge's stiffness follows; needs `thickness`.",
        )
        .with(&["thickness"]),
        Field::new(
            "thickness",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "Thickness t of the wall, or diameter of the wire of a chain in 3D; used with `modulus`.",
        )
        .starts_at(0.02),
        Field::new(
            "damping",
            Allowed::NOT_NEGATIVE,
            "N·m·s",
            Default::Number(0.0),
            "Damping constant c of every hinge (moment per angular rate); the damping moment is zero under rigid motion.",
        ),
        Field::new(
            "rest",
            Allowed::Choice(&["shape", "straight"]),
            "",
            Default::Text("shape"),
            "Whether the rest angles are those of the rest shape, or zero.",
        ),
    ],
    roles: &[],
};
