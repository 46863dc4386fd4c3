//! What can go wrong while a world is built or stepped.

use opruga_math::message::AnyMessage;
use opruga_math::words::{counted, number};

/// Why a model, integrator or collider could not be built from its parameters and the body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}: {message}")]
pub struct BuildError {
    /// The model, integrator, collider or section that refuses.
    pub kind: String,
    /// A stable code, such as `model.open_surface`.
    pub code: &'static str,
    /// What is wrong, with the offending value and what is allowed.
    pub message: String,
    /// The same as a value; none where the text is all there is.
    pub about: Option<AnyMessage>,
}

impl BuildError {
    /// The code of a preparation that was broken off from outside.
    pub const BROKEN_OFF: &'static str = "run.broken_off";

    /// A preparation that was broken off from outside.
    pub fn broken_off(kind: impl Into<String>) -> BuildError {
        BuildError::new(kind, BuildError::BROKEN_OFF, "the preparation was broken off")
    }
    /// An error of a kind of thing, with a stable code and a message.
    pub fn new(kind: impl Into<String>, code: &'static str, message: impl Into<String>) -> BuildError {
        BuildError { kind: kind.into(), code, message: message.into(), about: None }
    }
    /// An error of a kind of thing from a message.
    pub fn of(kind: impl Into<String>, about: impl Into<AnyMessage>) -> BuildError {
        let about = about.into();
        BuildError { about: Some(about.clone()), ..BuildError::new(kind, about.code(), about.in_full()) }
    }
}

/// What a body that diverges leaves: the finite numbers, or the range of its positions [m].
pub fn what_was_left(range: Option<f64>) -> String {
    match range {
        None => "the finite numbers".into(),
        Some(range) => {
            format!("the range in which rounding is small beside its elements, {} m about the origin", number(range))
        }
    }
}

/// Why a substep could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// A position or velocity is not finite any more, or a position is so far from the origin that it is mostly rounding.
    #[error("node {node} of body {body} left {} at t = {} s", what_was_left(*range), number(*time))]
    Diverged {
        /// The body, by its place in the island.
        body: usize,
        /// The node.
        node: u32,
        /// The time at the start of the substep [s].
        time: f64,
        /// How far from the origin along an axis positions keep their digits [m], where the node went beyond that.
        range: Option<f64>,
    },
    /// An implicit rule has not found the end of the step.
    #[error(
        "`{integrator}` did not converge in {} at t = {} s{}: the forces are out of balance by {} N, and the last correction \
         was {} m; allowed: {} m",
        counted(u64::from(*iterations), "iteration", "iterations"), number(*time),
        match (beyond, flat_cells) {
            (Some(part), _) => format!(", beyond {part}"),
            (None, Some([flat, all])) => format!(", from a state with {flat} of {all} cells flat or inside out"),
            (None, None) => String::new(),
        },
        number(*residual), number(*correction), number(*tolerance)
    )]
    NotConverged {
        /// The rule.
        integrator: &'static str,
        /// How many iterations of Newton were made.
        iterations: u32,
        /// The largest force out of balance on a node [N].
        residual: f64,
        /// The largest displacement in the last iteration [m].
        correction: f64,
        /// The correction that ends the iteration [m].
        tolerance: f64,
        /// The time at the start of the step [s].
        time: f64,
        /// Up to where it was found, such as `0.25 of the load`, where that was looked for in parts.
        beyond: Option<String>,
        /// How many cells are flat or inside out where the step begins, and how many there are; none if none is.
        flat_cells: Option<[usize; 2]>,
        /// What helps under the settings of the rule.
        hint: Box<str>,
    },
    /// The step was broken off from outside.
    #[error("the step was broken off")]
    BrokenOff,
    /// A model has no meaning in this state.
    #[error("{model}: {message}")]
    Model {
        /// The model.
        model: &'static str,
        /// What is wrong.
        message: String,
    },
}
