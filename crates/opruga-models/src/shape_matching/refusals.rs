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
        #[hint("`region` makes clusters of any body")]
        NoGroup { name: String, known: String },
        /// Nodes without a cluster.
        "model.cluster_misses"
        #[error("{missed} of {nodes} nodes are in no cluster, the first of them node {first}")]
        #[allowed("every node in one at least")]
        #[hint("name a group of all others too")]
        Misses { missed: usize, nodes: usize, first: usize },
        /// Regions much smaller than the distance between nodes.
        "model.region"
        #[error("`region` is {} m, which makes {} boxes of {nodes} nodes", number(*region), number(*boxes))] #[value("{}", number(*region))] #[parameters("region")]
        #[allowed("at most {most} boxes")]
        #[hint("a region holds some nodes along each axis")]
        TooManyRegions { region: f64, boxes: f64, nodes: usize, most: usize },
        /// A step-dependent stiffness with a potential.
        "model.goal_step"
        #[error("`goal_step` is {}, and `scheme` is \"potential\", whose stiffness does not depend on the step", number(*share))] #[value("{}", number(*share))] #[parameters("goal_step", "scheme")]
        #[allowed("`stiffness`")]
        #[hint("at this step, `stiffness = {}` means the same, and `scheme = \"as_published\"` takes `goal_step`", number(*stiffness))]
        GoalStep { share: f64, stiffness: f64 },
        /// A substep that differs from the declared one.
        "model.step_changed"
        #[error("the substep is {} s, and `goal_step` counts for the {} s that the scene declared", number(*now), number(*declared))] #[parameters("goal_step")]
        #[allowed("that step")]
        #[hint("`stiffness = {}` means the same at any step", number(*stiffness))]
        StepChanged { now: f64, declared: f64, stiffness: f64 },
        /// The reason why the published scheme has no potential, as a part of a refusal.
        "part.no_potential"
        #[error("`scheme` is \"as_published\", whose goal, the fitted map over the root of its determinant, is the gradient of no potential; `scheme = \"potential\"` has both")] #[parameters("scheme")]
        NoPotentialOfGoal {},
    }
}

messages! {
    /// Warnings about clusters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum MatchingWarning {
        /// A mirrored cluster.
        "shape_matching.mirrored"
        #[error("a cluster was mirrored, counted per substep and cluster: rotations do not turn a mirrored shape back, so overlapping clusters that are all mirrored may stay folded")]
        #[hint("fewer, larger clusters")]
        Mirrored {},
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
