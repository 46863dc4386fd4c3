//! Errors of a world.

use crate::schema::MOST_SUBSTEPS;
use opruga_core::error::{BuildError, StepError, what_was_left};
use opruga_math::message::{AnyMessage, Message};
use opruga_math::messages;
use opruga_math::words::number;

/// A hint that names the number of substeps that would be stable, if there is one.
fn remedy(substeps: u32) -> String {
    match substeps {
        ..=MOST_SUBSTEPS => format!("use substeps >= {substeps}"),
        _ => format!(
            "a frame has at most {MOST_SUBSTEPS} substeps: use a shorter frame, a softer or heavier body, or another integrator"
        ),
    }
}

/// The largest damping rate of a body, if the body is damped.
fn damped(damping: f64) -> String {
    if damping == 0.0 { String::new() } else { format!(", damping {} 1/s", number(damping)) }
}

/// A hint for a body that may fall for ever.
fn falls(range: Option<f64>) -> &'static str {
    match range {
        Some(_) => "; `world.largest_distance` removes bodies that fall for ever",
        None => "",
    }
}

/// What two surfaces do, or one with itself.
fn meeting(first: &str, second: &str) -> String {
    if first == second {
        format!("parts of the surface of `{first}` are closer to one another than its thickness")
    } else {
        format!("the surfaces of `{first}` and `{second}` are closer to one another than their thickness")
    }
}

/// How many pairs of bodies cross, if there are several.
fn others(pairs: usize) -> String {
    if pairs > 1 { format!("; in all, {pairs} pairs of bodies cross") } else { String::new() }
}

/// The other body, or "itself" if both are the same.
fn other(first: &str, second: &str) -> String {
    if first == second { "itself".into() } else { format!("`{second}`") }
}

/// A part of a world and the kind of the component that refuses it.
fn refusing(part: &Part, kind: &str) -> String {
    match part {
        Part::Collider { .. } => format!("{part} ({kind})"),
        part => format!("{part}: {kind}"),
    }
}

messages! {
    /// A part of a world that is refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Part {
        "part.place" #[error("body `{name}`")]
        Body { name: String },
        "part.place" #[error("body {index}")]
        BodyAt { index: usize },
        "part.place" #[error("integrator of body `{name}`")]
        IntegratorOf { name: String },
        "part.place" #[error("load {index}")]
        Load { index: usize },
        "part.place" #[error("command {index}")]
        Command { index: usize },
        "part.place" #[error("probe `{name}`")]
        Probe { name: String },
        "part.place" #[error("contact.pair {index}")]
        Pair { index: usize },
        "part.place" #[error("collider {index}")]
        Collider { index: usize },
        "part.place" #[error("{path}")]
        Section { path: &'static str },
    }

    /// Surfaces that cross.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Crossing {
        "part.crossing" #[error("facets {first} and {second} of body `{body}` cross")]
        Within { first: u32, second: u32, body: String },
        "part.crossing" #[error("facet {first} of body `{body}` and facet {second} of body `{other}` cross")]
        Between { first: u32, body: String, second: u32, other: String },
        "part.crossing" #[error("one of the bodies `{body}` and `{other}` lies inside the other")]
        Inside { body: String, other: String },
    }

    /// The reasons why a world could not be built, changed or stepped. The world is as it was before the call.
    #[derive(Clone, Debug, PartialEq)]
    pub enum WorldError {
        /// A model, integrator or collider could not be built. The error has the code of `source`.
        "part.build" #[error("{}: {}", refusing(part, &source.kind), source.about)]
        #[allowed("{}", source.about.allowed().unwrap_or_default())] #[hint("{}", source.about.hint().unwrap_or_default())]
        Build { part: Part, source: BuildError },
        /// The substep h \[s\] is longer than the integrator allows. Contains the longest allowed substep \[s\], the largest frequency \[rad/s\], the
        /// largest damping rate \[1/s\], and the smallest stable number of substeps of a frame, which may exceed the limit of a frame.
        "step.unstable"
        #[error("the step h = {} s of `{integrator}` is unstable for body `{body}`", number(*h))]
        #[allowed("h <= {} s (the fastest motion of the body: {} rad/s{})", number(*limit), number(*omega), damped(*damping))]
        #[hint("{}", remedy(*substeps))]
        UnstableStep { integrator: &'static str, body: String, h: f64, limit: f64, omega: f64, damping: f64, substeps: u32 },
        /// A number of the motion is not finite, or a position is outside the range in which positions keep their digits. Contains the time at the
        /// start of the substep \[s\], the time of the last good frame \[s\], and, if the node left that range, the distance from the origin up to
        /// which positions keep their digits \[m\].
        "run.diverged"
        #[error("body `{body}` diverged: node {node} left {} in the substep from t = {} s; the world is at its last good frame, t = {} s", what_was_left(*range), number(*time), number(*last))]
        #[hint("more substeps may help{}", falls(*range))]
        Diverged { body: String, node: u32, time: f64, last: f64, range: Option<f64> },
        /// A model is not defined in the state that was reached.
        "run.model" #[error("body `{body}`: {cause}; the world is at its last good frame")]
        #[allowed("{}", cause.allowed().unwrap_or_default())] #[hint("{}", cause.hint().unwrap_or_default())]
        Step { body: String, cause: Box<StepError> },
        /// An implicit integrator did not find the end of a step.
        "run.not_converged" #[error("body `{body}`: {cause}; the world is at its last good frame")]
        #[allowed("{}", cause.allowed().unwrap_or_default())] #[hint("{}", cause.hint().unwrap_or_default())]
        NotConverged { body: String, cause: Box<StepError> },
        /// The sums over all bodies are not finite in the frame after the last good one. Contains the time of the last good frame \[s\].
        "run.overflow"
        #[error("the energy or the momentum of all bodies together left the range of finite numbers in the frame from t = {} s; the world is at its last good frame", number(*last))]
        #[hint("are masses, stiffnesses and speeds in consistent units (metres, kilograms, seconds)?")]
        Overflow { last: f64 },
        /// More pairs may touch in a step than the scene allows. Contains the time of the last good frame \[s\].
        "limit.contacts"
        #[error("in the frame from t = {} s, more than {most} pairs of vertices, edges and facets could touch in one step; the world is at its last good frame", number(*last))]
        #[allowed("{most}")] #[hint("use a larger `most_pairs` in `[contact]`, or coarser surfaces")]
        TooManyContacts { found: usize, most: usize, last: f64 },
        /// Surfaces that a barrier should keep apart meet. The second surface belongs to another body, the same body, or an obstacle. Contains the
        /// time at the end of the substep \[s\].
        "contact.surfaces_meet"
        #[error("{} at t = {} s, but a barrier needs a larger distance; the world is at its last good frame", meeting(first, second), number(*time))]
        #[hint("move the bodies apart, or use a smaller `thickness` or `response = \"constraint\"`")]
        Meet { first: String, second: String, time: f64 },
        /// Surfaces that a barrier should keep apart cross before the frame. Contains the number of pairs of bodies that cross, and the time \[s\].
        "contact.surfaces_meet"
        #[error("at t = {} s, {crossing}{}, but a barrier keeps apart only surfaces that do not cross", number(*time), others(*pairs))]
        #[hint("move the bodies apart, or use `response = \"constraint\"`, which moves them apart")]
        Cross { crossing: Crossing, pairs: usize, time: f64 },
        /// Pins and obstacles move a body through another body, itself, or an obstacle. Contains the time at the end of the substep \[s\].
        "contact.led_through"
        #[error("pins and obstacles move `{first}` through {} at t = {} s; the world is at its last good frame", other(first, second), number(*time))]
        #[parameters("pin", "fixed")]
        #[hint("use another path for the pins of these bodies and for the obstacles at them, or let the bodies pass through one another (`touch = false` in a `[[contact.pair]]`)")]
        LedThrough { first: String, second: String, time: f64 },
        /// A pin or another obstacle moves a body through a face, an edge or a corner of an obstacle, or the obstacle moves through the body. Contains
        /// the number and the kind of the obstacle, and the time at the end of the substep \[s\].
        "contact.led_through"
        #[error("obstacle {collider} ({kind}) and body `{body}` are moved through one another by the obstacle, by pins of the body or by other obstacles, at t = {} s; the world is at its last good frame", number(*time))]
        #[hint("use another path for the obstacle or for the pins, or leave room between this obstacle and others; with `contact = {{ touch = false }}`, edges and corners of obstacles pass through the body, and only its nodes touch obstacles")]
        LedThroughObstacle { body: String, collider: usize, kind: String, time: f64 },
        /// The frame was cancelled from outside ([`crate::Options::break_off`]).
        "run.broken_off" #[error("the frame was interrupted; the world is at its last good frame")]
        BrokenOff {},
        /// A name, path or value is not valid.
        "path.unknown" #[error("`{path}`: {about}")]
        #[allowed("{}", about.allowed().unwrap_or_default())] #[hint("{}", about.hint().unwrap_or_default())]
        Path { path: String, about: AnyMessage },
        /// A snapshot does not belong to this world or is damaged.
        "snapshot.damaged" #[error("the snapshot cannot be restored: {about}")]
        Snapshot { about: AnyMessage },
    }
}

impl Part {
    /// A body by its name.
    pub fn body(name: &str) -> Part {
        Part::Body { name: name.into() }
    }
}

impl WorldError {
    /// A name, path or value is not valid.
    pub fn path(path: impl Into<String>, about: impl Into<AnyMessage>) -> WorldError {
        WorldError::Path { path: path.into(), about: about.into() }
    }
    /// A snapshot does not belong to this world or is damaged.
    pub fn snapshot(about: impl Into<AnyMessage>) -> WorldError {
        WorldError::Snapshot { about: about.into() }
    }
    /// The stable code of the error.
    pub fn code(&self) -> &'static str {
        match self {
            WorldError::Build { source, .. } => source.code(),
            other => Message::code(other),
        }
    }
}
