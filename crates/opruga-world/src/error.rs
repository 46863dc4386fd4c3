//! What can go wrong in a world.

use crate::schema::MOST_SUBSTEPS;
use opruga_core::error::{BuildError, what_was_left};
use opruga_math::words::number;

/// What would help where so many substeps would be stable.
fn way_out(substeps: u32) -> String {
    match substeps {
        ..=MOST_SUBSTEPS => format!("substeps >= {substeps}"),
        _ => {
            format!(
                "a frame has at most {MOST_SUBSTEPS} substeps: a shorter one, a softer or heavier body, or another integrator"
            )
        }
    }
}

/// Why a world could not be built, changed or stepped. The world is as it was before the call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WorldError {
    /// A model, integrator or collider refuses.
    #[error("{place}: {source}")]
    Build {
        /// The body or section.
        place: String,
        /// Why.
        source: BuildError,
    },
    /// The substep is longer than the integrator allows.
    #[error(
        "the step h = {} s of `{integrator}` is unstable for body `{body}`: the largest stable step is {} s \
         (stiffness ω = {} rad/s, damping {} 1/s); allowed: h <= {}; hint: {}",
        number(*h), number(*limit), number(*omega), number(*damping), number(*limit), way_out(*substeps)
    )]
    UnstableStep {
        /// The integrator.
        integrator: &'static str,
        /// The body that limits it.
        body: String,
        /// The substep [s].
        h: f64,
        /// The largest stable substep [s].
        limit: f64,
        /// The largest frequency [rad/s].
        omega: f64,
        /// The largest damping rate [1/s].
        damping: f64,
        /// The least number of substeps of a frame that is stable; a frame may not have as many ([`MOST_SUBSTEPS`]).
        substeps: u32,
    },
    /// The motion left the finite numbers, or the range in which positions have digits.
    #[error(
        "body `{body}` diverged: node {node} left {} in the substep from t = {} s; the world is at its last good frame, t = {} s",
        what_was_left(*range), number(*time), number(*last)
    )]
    Diverged {
        /// The body.
        body: String,
        /// The node.
        node: u32,
        /// The time at the start of the substep [s].
        time: f64,
        /// The time of the last good frame [s].
        last: f64,
        /// How far from the origin positions of the body keep their digits [m], where the node went beyond that.
        range: Option<f64>,
    },
    /// A model has no meaning in the state reached.
    #[error("body `{body}`: {message}; the world is at its last good frame")]
    Step {
        /// The body.
        body: String,
        /// What the model says.
        message: String,
    },
    /// An implicit integrator has not found the end of a step.
    #[error("body `{body}`: {message}; the world is at its last good frame; hint: {hint}")]
    NotConverged {
        /// The body.
        body: String,
        /// What the integrator says.
        message: String,
        /// What helps under the settings of the integrator.
        hint: String,
    },
    /// The sums over all bodies left the finite numbers.
    #[error(
        "the energy or the momentum of all bodies together left the finite numbers in the frame from t = {} s; the world is at its \
         last good frame; hint: are masses, stiffnesses and speeds in units that go together (metres, kilograms, seconds)?",
        number(*last)
    )]
    Overflow {
        /// The time of the last good frame [s].
        last: f64,
    },
    /// More pairs may touch in a step than the scene allows.
    #[error(
        "more than {most} pairs of vertices, edges and facets may touch in a step ({found} were found) in the frame from t = {} s; \
         allowed: {most}; the world is at its last good frame; hint: a larger `most_pairs` in `[contact]`, or coarser surfaces",
        number(*last)
    )]
    TooManyContacts {
        /// How many were found.
        found: usize,
        /// The most that the scene allows.
        most: usize,
        /// The time of the last good frame [s].
        last: f64,
    },
    /// Surfaces meet that a barrier keeps apart.
    #[error(
        "the surfaces of `{first}` and {} meet at t = {} s, where a barrier needs a gap; the world is at its last good frame; hint: bodies that begin \
         apart, a smaller `thickness`, or `response = \"constraint\"`",
        if first == second { "itself".into() } else { format!("`{second}`") },
        number(*time)
    )]
    Meet {
        /// One body.
        first: String,
        /// The other one, the same, or an obstacle.
        second: String,
        /// The time at the end of the substep [s].
        time: f64,
    },
    /// Pins and obstacles lead bodies through one another.
    #[error(
        "pins and obstacles lead `{first}` through {} at t = {} s; the world is at its last good frame; hint: another path of what \
         leads them, or `touch = false` for the pair",
        if first == second { "itself".into() } else { format!("`{second}`") },
        number(*time)
    )]
    LedThrough {
        /// One body.
        first: String,
        /// The other one, the same, or an obstacle.
        second: String,
        /// The time at the end of the substep [s].
        time: f64,
    },
    /// The frame was broken off from outside ([`crate::Options::break_off`]).
    #[error("the frame was broken off; the world is at its last good frame")]
    BrokenOff,
    /// A name, path or value does not fit.
    #[error("`{path}`: {message}")]
    Path {
        /// What was given.
        path: String,
        /// What is wrong, and what is allowed.
        message: String,
    },
    /// A snapshot does not belong to this world or is damaged.
    #[error("the snapshot cannot be restored: {0}")]
    Snapshot(String),
}

impl WorldError {
    /// The stable code of the error.
    pub fn code(&self) -> &'static str {
        match self {
            WorldError::Build { source, .. } => source.code,
            WorldError::UnstableStep { .. } => "step.unstable",
            WorldError::Diverged { .. } => "run.diverged",
            WorldError::Step { .. } => "run.model",
            WorldError::NotConverged { .. } => "run.not_converged",
            WorldError::Overflow { .. } => "run.overflow",
            WorldError::TooManyContacts { .. } => "limit.contacts",
            WorldError::Meet { .. } => "contact.surfaces_meet",
            WorldError::LedThrough { .. } => "contact.led_through",
            WorldError::BrokenOff => "run.broken_off",
            WorldError::Path { .. } => "path.unknown",
            WorldError::Snapshot(_) => "snapshot.damaged",
        }
    }
}
