//! Errors while a world is built or stepped.

use opruga_math::message::{AnyMessage, Field, IntoField, Replacing};
use opruga_math::messages;
use opruga_math::words::{counted, number};

/// Why a model, integrator or collider could not be built from its parameters and the body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{kind}: {}", about.in_full())]
pub struct BuildError {
    /// The model, integrator, collider or section that refuses.
    pub kind: String,
    /// What is wrong.
    pub about: AnyMessage,
}

impl BuildError {
    /// The code of a preparation that was stopped from outside.
    pub const BROKEN_OFF: &'static str = "run.broken_off";

    /// The error of a preparation that was stopped from outside.
    pub fn broken_off(kind: impl Into<String>) -> BuildError {
        BuildError::of(kind, BrokenOff::Preparation {})
    }
    /// An error of a kind that a program has added, with a stable code and an English text.
    pub fn new(kind: impl Into<String>, code: &'static str, text: impl Into<String>) -> BuildError {
        BuildError::of(kind, AnyMessage::plain(code, text.into()))
    }
    /// An error of a kind, from a message.
    pub fn of(kind: impl Into<String>, about: impl Into<AnyMessage>) -> BuildError {
        BuildError { kind: kind.into(), about: about.into() }
    }
    /// The stable code, such as `model.open_surface`.
    pub fn code(&self) -> &'static str {
        self.about.code()
    }
}

impl IntoField for BuildError {
    fn field(&self) -> Field {
        Source::Of { kind: self.kind.clone(), about: self.about.clone() }.field()
    }
    fn replaced(&self, by: &Replacing<'_>) -> BuildError {
        BuildError { kind: self.kind.clone(), about: self.about.replaced(by) }
    }
}

/// The range that a diverging body has left: the range of finite numbers, or the range of its positions [m].
pub fn what_was_left(range: Option<f64>) -> String {
    match range {
        None => "the range of finite numbers".into(),
        Some(range) => {
            format!(
                "the range of {} m around the origin, in which rounding is small compared with the size of the elements,",
                number(range)
            )
        }
    }
}

/// Describes up to which load an equilibrium was found, and how many cells were degenerate at the start of the step.
fn circumstances(beyond: Option<f64>, inverted: u32, cells: u32) -> String {
    match (beyond, inverted) {
        (Some(load), _) => format!(", beyond {} of the load", number(load)),
        (None, 0) => String::new(),
        (None, _) => format!(", from a state with {inverted} of {cells} cells degenerate or inverted"),
    }
}

messages! {
    /// Why a preparation ended early.
    #[derive(Clone, Debug, PartialEq)]
    pub enum BrokenOff {
        "run.broken_off" #[error("the preparation was interrupted")]
        Preparation {},
    }

    /// A [`BuildError`] as a part of a text: what refuses, and why.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Source {
        "part.source" #[error("{kind}: {about}")]
        #[allowed("{}", about.allowed().unwrap_or_default())] #[hint("{}", about.hint().unwrap_or_default())]
        Of { kind: String, about: AnyMessage },
    }

    /// Why a substep could not be made.
    #[derive(Clone, Debug, PartialEq)]
    pub enum StepError {
        /// A position or velocity is no longer finite, or a position is so far from the origin that rounding dominates. The fields are the index of
        /// the body in the island, the node, the time at the start of the substep \[s\], and, if the node is too far from the origin, the limit. The
        /// limit is the distance along an axis up to which positions keep their digits \[m\].
        "part.step" #[error("node {node} of body {body} left {} at t = {} s", what_was_left(*range), number(*time))]
        Diverged { body: usize, node: u32, time: f64, range: Option<f64> },
        /// An implicit integrator has not found the end of the step. The fields are the number of Newton iterations, the largest
        /// residual force on a node \[N\], the largest displacement in the last iteration \[m\], the correction below which the
        /// iteration ends \[m\], the time at the start of the step \[s\], the fraction of the load up to which an equilibrium
        /// was found, the number of degenerate or inverted cells at the start of the step, and the total number of cells.
        "part.step"
        #[error("`{integrator}` did not converge in {} at t = {} s{}: the forces are out of balance by {} N, and the last correction was {} m", counted(u64::from(*iterations), "iteration", "iterations"), number(*time), circumstances(*beyond, *inverted, *cells), number(*residual), number(*correction))]
        #[allowed("{} m", number(*tolerance))] #[hint("{hint}")]
        NotConverged {
            integrator: &'static str,
            iterations: u32,
            residual: f64,
            correction: f64,
            tolerance: f64,
            time: f64,
            beyond: Option<f64>,
            inverted: u32,
            cells: u32,
            hint: AnyMessage,
        },
        /// The step was stopped from outside.
        "part.step" #[error("the step was interrupted")]
        BrokenOff {},
        /// A model has no value in this state. If the model gives no hint, the settings of the integrator may give one.
        "part.step" #[error("{model}: {about}")]
        #[allowed("{}", about.allowed().unwrap_or_default())]
        #[hint("{}", about.hint().or_else(|| helps.as_ref().map(ToString::to_string)).unwrap_or_default())]
        Model { model: &'static str, about: AnyMessage, helps: Option<AnyMessage> },
    }
}

impl StepError {
    /// A model has no value in this state.
    pub fn of(model: &'static str, about: impl Into<AnyMessage>) -> StepError {
        StepError::Model { model, about: about.into(), helps: None }
    }
}
