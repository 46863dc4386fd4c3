//! Why the published program refuses a body.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;

messages! {
    /// Why `as_published` refuses a body, its parameters or a state.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A three-dimensional body.
        "model.dimension" #[error("the published program is two-dimensional")] #[allowed("dimension = 2")]
        Dimension {},
        /// A body without facets.
        "model.open_surface" #[error("the body has no outline")]
        NoOutline {},
        /// A held pointer without a path.
        "model.one_of" #[error("`held` needs `pointer`")] #[parameters("held", "pointer")]
        NoPointer {},
        /// Intervals that end before they begin.
        "model.interval" #[error("each row of `held` must be [press, release] with press < release")] #[parameters("held")]
        Interval {},
        /// A zero volume, by which the pressure would be divided.
        "run.model" #[error("the published \"volume\" Σ ½ |Δx| |Δy| is zero: every edge lies along an axis")] #[hint("turn the body a little")]
        NoPublishedVolume {},
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
