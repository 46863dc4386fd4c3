//! The report about a body that has exploded.

/// A body that has exploded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exploded {
    /// The body.
    pub body: String,
    /// The kind of the body's integrator.
    pub integrator: String,
    /// Whether that integrator is unstable with this step, as far as the world can determine it.
    pub unstable: bool,
}
