//! Why a body cannot carry springs.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;
use opruga_mesh::MeshError;

messages! {
    /// Why `mass_spring` refuses a body or its parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A body without edges.
        "model.no_edges" #[error("the body has no edges to carry springs (`edges = \"{edges}\"`)")] #[parameters("edges")]
        NoEdges { edges: String },
        /// An edge between two nodes at one point.
        "model.zero_length" #[error("edge {edge} has no length; `modulus` needs one")] #[parameters("modulus")]
        NoLengthOfSpring { edge: usize },
        /// A modulus without an area.
        "model.no_area" #[error("`modulus` needs triangles next to the edges")] #[parameters("modulus")] #[hint("for a chain or an outline, give `stiffness`")]
        NoTriangles {},
        /// A mesh whose areas cannot be determined.
        "model.mesh" #[error("{problem}")]
        Mesh { problem: MeshError },
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
