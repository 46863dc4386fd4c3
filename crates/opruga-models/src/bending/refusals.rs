//! Why a body cannot resist bending.

use super::SPEC;
use opruga_core::error::BuildError;
use opruga_math::messages;
use opruga_mesh::MeshError;

messages! {
    /// Why `bending` refuses a body or its parameters.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A modulus without a thickness.
        "model.one_of" #[error("`modulus` needs `thickness`")] #[parameters("modulus", "thickness")]
        NoThickness {},
        /// A thickness next to a stiffness.
        "model.one_of" #[error("`thickness` goes with `modulus`, not with `stiffness`")] #[parameters("thickness", "modulus", "stiffness")]
        Thickness {},
        /// An outline or chain whose hinges cannot be determined.
        "model.mesh" #[error("{problem}")]
        Bends { problem: MeshError },
        /// A surface whose hinges cannot be determined.
        "model.not_manifold" #[error("{problem}")]
        Hinges { problem: MeshError },
        /// A body without hinges.
        "model.no_hinges"
        #[error("the body has nothing to bend: no node between two edges of an outline or chain, no edge between two triangles")]
        NoHinges {},
        /// A hinge with an edge of zero length or a degenerate triangle.
        "model.zero_length" #[error("hinge {hinge} has an edge without length or a triangle without area at rest")]
        NoHingeLength { hinge: usize },
    }
}

impl From<Refusal> for BuildError {
    fn from(refusal: Refusal) -> BuildError {
        BuildError::of(SPEC.kind, refusal)
    }
}
