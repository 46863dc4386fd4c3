//! What can be wrong with closed curves.

use crate::MeshError;
use opruga_math::words::{counted, number};

/// Why rings make no body. `part` is [`super::Ring::part`], places are in the units of the rings.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OutlineError {
    /// There is no ring at all.
    #[error("there is no closed outline")]
    Empty,
    /// A ring has too few points or encloses no area.
    #[error("an outline encloses no area: {}, the first at {}", counted(*points as u64, "point", "points"), at(place))]
    NoArea {
        /// The part that it belongs to.
        part: u32,
        /// How many points it has.
        points: usize,
        /// Its first point.
        place: [f64; 2],
    },
    /// A coordinate is infinite or not a number.
    #[error("a coordinate is {value}")]
    NotFinite {
        /// The part that it belongs to.
        part: u32,
        /// The coordinate.
        value: f64,
    },
    /// Two edges cross, touch or overlap.
    #[error("{} near {}", if parts[0] == parts[1] { "an outline crosses or touches itself" } else { "two outlines cross or touch" }, at(place))]
    Meeting {
        /// The parts that the two edges belong to.
        parts: [u32; 2],
        /// Where they meet, roughly.
        place: [f64; 2],
    },
    /// At the wanted spacing of nodes edges cross: the outline has features that are finer.
    #[error("with nodes {} m apart edges cross near {}", number(*spacing), at(place))]
    TooCoarse {
        /// The wanted distance of nodes [m].
        spacing: f64,
        /// The parts that the two edges belong to.
        parts: [u32; 2],
        /// Where they cross, roughly.
        place: [f64; 2],
    },
    /// Filling would take, or took, too many nodes.
    #[error("filled with nodes {} m apart the outline would have about {nodes} nodes", number(*spacing))]
    TooFine {
        /// The wanted distance of nodes [m].
        spacing: f64,
        /// About how many nodes.
        nodes: u64,
    },
    /// The mesh that came out is refused.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A place in a sentence.
fn at(place: &[f64; 2]) -> String {
    format!("({}, {})", number(place[0]), number(place[1]))
}
