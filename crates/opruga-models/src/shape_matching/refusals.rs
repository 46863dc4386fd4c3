//! Why shape matching refuses a body.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;
use opruga_math::words::number;

messages! {
    /// Why `shape_matching` refuses a body or its parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A group that the mesh lacks.
        "model.no_group"
        #[error("the mesh has no group of nodes `{name}`")]
        #[allowed("{known}")]
        #[hint("`region` makes clusters in any body")]
        NoGroup { name: String, known: String },
        /// Nodes without a cluster.
        "model.cluster_misses"
        #[error("{missed} of {nodes} nodes are in no cluster; the first is node {first}")]
        #[allowed("every node in at least one")]
        #[hint("also name a group that contains the other nodes")]
        Misses { missed: usize, nodes: usize, first: usize },
        /// Regions much smaller than the distance between nodes.
        "model.region"
        #[error("`region` is {} m, which makes {} boxes for {nodes} nodes", number(*region), number(*boxes))] #[value("{}", number(*region))] #[parameters("region")]
        #[allowed("at most {most} boxes")]
        #[hint("a region should contain several nodes along each axis")]
        TooManyRegions { region: f64, boxes: f64, nodes: usize, most: usize },
        /// A step-dependent stiffness with a potential.
        "model.goal_step"
        #[error("`goal_step` is {}, but `scheme` is \"potential\", whose stiffness does not depend on the step", number(*share))] #[value("{}", number(*share))] #[parameters("goal_step", "scheme")]
        #[allowed("`stiffness`")]
        #[hint("with this step, `stiffness = {}` means the same; `scheme = \"as_published\"` accepts `goal_step`", number(*stiffness))]
        GoalStep { share: f64, stiffness: f64 },
        /// A substep that differs from the declared one.
        "model.step_changed"
        #[error("the substep is {} s, but `goal_step` applies to the substep of {} s that the scene declares", number(*now), number(*declared))] #[parameters("goal_step")]
        #[allowed("a substep of this length")]
        #[hint("`stiffness = {}` means the same with any step", number(*stiffness))]
        StepChanged { now: f64, declared: f64, stiffness: f64 },
        /// The reason why the published scheme has no potential, as a part of a refusal.
        "part.no_potential"
        #[error("`scheme` is \"as_published\", whose goal (the fitted map divided by a root of its determinant) is not the gradient of a potential; `scheme = \"potential\"` has second derivatives, and they are symmetric")] #[parameters("scheme")]
        NoPotentialOfGoal {},
    }
}

messages! {
    /// Warnings about clusters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum MatchingWarning {
        /// A mirrored cluster.
        "shape_matching.mirrored"
        #[error("a cluster was mirrored: rotations do not restore a mirrored shape, so overlapping clusters that are all mirrored may stay folded (counted once per substep and cluster)")]
        #[hint("use fewer, larger clusters")]
        Mirrored {},
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
