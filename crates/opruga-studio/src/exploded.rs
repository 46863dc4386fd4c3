//! What is told of a body that has exploded.

/// A body that has exploded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exploded {
    /// The body.
    pub body: String,
    /// The kind of its integrator.
    pub integrator: String,
    /// Whether that integrator is unstable at this step, as far as the world can tell.
    pub unstable: bool,
}

/// What is said of it beside the other scene, in the words of the world: a kind in quotes.
impl core::fmt::Display for Exploded {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Exploded { body, integrator, unstable } = self;
        match unstable {
            true => write!(f, "`{body}` exploded: `{integrator}` is unstable at this step"),
            false => write!(f, "`{body}` exploded: it is more than 100 times as large as the scene was"),
        }
    }
}
