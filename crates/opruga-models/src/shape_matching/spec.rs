//! Parameters of shape matching.

use opruga_core::spec::{Allowed, Bound, Condition, Default, Field, Spec};

const STIFFNESS: &[&str] = &["stiffness", "goal_step"];
const PUBLISHED: Condition = Condition::Word("scheme", &["as_published"]);

/// The parameters of `shape_matching`.
pub const SPEC: Spec = Spec {
    kind: "shape_matching",
    summary: "clusters of nodes that are pulled towards their rest shape, which is rotated or fitted to the present positions",
    documentation: "Energy U = (1 − β) U_R + β U_A. Both parts are ½ κ Σ m |x − g|² over the nodes of every cluster, where g is the goal of a node. \
U_R is the minimum over all rotations and translations of the rest shape, U_A the minimum over all linear or quadratic maps of it. The force is the \
gradient of U, and the Hessian is exact. κ is a stiffness per mass. Motions that no map of the cluster can follow oscillate with the angular \
frequency √κ. Strains that a linear map can follow oscillate with √((1 − β)κ). Rotation and translation do not oscillate. These frequencies do not \
depend on the step or the number of nodes. Without `region` and `groups` the whole body is one cluster. Where clusters overlap, the mass of a node \
is shared evenly among them. The model needs no edges and no cells. A cluster does not resist motion in directions in which it has no extent. \
`scheme = \"as_published\"` selects the goal of the paper, in which the fitted map is divided by the D-th root of its determinant in D dimensions. \
The force then has no potential, so only explicit integrators can step the body. With `goal_step`, the stiffness α/h² depends on the step of the \
scene. Limits: κ is not Young's modulus, and stiffness does not increase with smaller cells. Equations and measurements: docs/shape-matching.md. \
Source: Müller, Heidelberger, Teschner, Gross 2005, Meshless deformations based on shape matching.",
    dimensions: &[2, 3],
    fields: &[
        Field::new(
            "stiffness",
            Allowed::NOT_NEGATIVE,
            "1/s²",
            Default::OneOf(STIFFNESS),
            "Stiffness per mass κ; give exactly one of `stiffness` and `goal_step`.",
        )
        .starts_at(1000.0),
        Field::new(
            "goal_step",
            Allowed::Number { least: Bound::Open(0.0), greatest: Bound::Closed(1.0) },
            "",
            Default::OneOf(STIFFNESS),
            "The fraction α of its distance from the goal by which a node moves in a substep h; κ = α/h² therefore depends on the step.",
        )
        .starts_at(0.05)
        .applies(&[PUBLISHED]),
        Field::new(
            "fit_share",
            Allowed::FRACTION,
            "",
            Default::Number(0.0),
            "Share β of the energy of the fitted map: with 0, every strain of a cluster costs energy; with 1, strains that a fitted map can follow \
cost none.",
        ),
        Field::new(
            "fit",
            Allowed::Choice(&["linear", "quadratic"]),
            "",
            Default::Text("linear"),
            "With \"linear\", the fitted map stretches and shears; with \"quadratic\", it also bends and twists.",
        )
        .applies(&[Condition::NotZero("fit_share")]),
        Field::new(
            "region",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "Side of the boxes that form clusters in the rest shape; neighbouring boxes overlap by half.",
        )
        .applies(&[Condition::NotGiven("groups")]),
        Field::new(
            "groups",
            Allowed::Text,
            "",
            Default::Absent,
            "The names of the groups of nodes of the mesh that serve as clusters, separated by commas. Every node must be in at least one of these \
groups.",
        ),
        Field::new(
            "scheme",
            Allowed::Choice(&["potential", "as_published"]),
            "",
            Default::Text("potential"),
            "With \"potential\", the force is the gradient of U; with \"as_published\", it is the published force, which keeps the volume of the \
fitted map.",
        ),
    ],
    roles: &[],
};
