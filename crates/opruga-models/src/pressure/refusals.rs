//! Why a body cannot hold gas.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;
use opruga_mesh::MeshError;

messages! {
    /// Why `pressure` refuses a body.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A body without facets.
        "model.open_surface" #[error("the body has no closed boundary to hold a gas")]
        NoBoundary {},
        /// A boundary that is not closed.
        "model.open_surface" #[error("{problem}")]
        OpenBoundary { problem: MeshError },
        /// A chamber without volume.
        "model.volume" #[error("chamber {chamber} encloses {volume} m³")] #[allowed("> 0 (is it inside out?)")]
        NoVolume { chamber: usize, volume: f64 },
        /// A boundary that branches.
        "model.not_manifold" #[error("{problem}")]
        Branches { problem: MeshError },
        /// A boundary without holes.
        "model.no_cavity" #[error("the boundary has no holes, so there is no cavity to hold a gas")] #[hint("`inside = \"boundary\"` fills the body")]
        NoCavity {},
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
