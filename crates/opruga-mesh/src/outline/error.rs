//! Errors of closed curves.

use crate::MeshError;
use opruga_math::words::{counted, number};
use opruga_math::{messages, terms};

terms! {
    /// The outlines that meet.
    pub enum MeetingOf = "part.meeting" {
        Itself = "an outline crosses or touches itself",
        Others = "two outlines cross or touch",
    }
}

messages! {
    /// The reasons why rings do not make a body. `part` is [`super::Ring::part`]; positions are in the units of the rings.
    #[derive(Clone, Debug, PartialEq)]
    pub enum OutlineError {
        /// There are no rings.
        "shape.no_area" #[error("there is no closed outline")]
        Empty {},
        /// A ring has too few points or encloses no area. Contains the number of points in the ring and the position of the first one.
        "shape.no_area" #[error("an outline encloses no area: {}, the first at {}", counted(*points as u64, "point", "points"), at(position))]
        #[value("{}", position.map(number).join(", "))]
        NoArea { part: u32, points: usize, position: [f64; 2] },
        /// A coordinate is infinite or not a number.
        "scene.not_finite" #[error("a coordinate is {value}")] #[value("{value}")]
        NotFinite { part: u32, value: f64 },
        /// Two edges of these parts cross, touch or overlap, near the given position.
        "shape.crossing" #[error("{what} near {}", at(position))] #[value("{}", position.map(number).join(", "))]
        Meeting { what: MeetingOf, parts: [u32; 2], position: [f64; 2] },
        /// With the given spacing of nodes \[m\] edges of these parts cross, because the outline has finer features.
        "shape.spacing" #[error("with nodes {} m apart, edges cross near {}", number(*spacing), at(position))] #[value("{spacing}")]
        TooCoarse { spacing: f64, parts: [u32; 2], position: [f64; 2] },
        /// A filling with this spacing of nodes \[m\] would have, or had, too many nodes.
        "limit.nodes" #[error("filled with nodes {} m apart, the outline would have about {nodes} nodes", number(*spacing))] #[value("{spacing}")]
        TooFine { spacing: f64, nodes: u64 },
        /// The boxes of edges overlap too often.
        "limit.comparisons" #[error("{edges} edges run past one another so closely that more than {most} pairs would have to be compared")]
        #[value("{edges}")] #[allowed("at most {most} pairs of edges that lie side by side")] #[hint("draw the outline with fewer points")]
        NotCompared { edges: u64, most: u64 },
        /// The resulting mesh is refused.
        "scene.shape" #[error("{error}")]
        Mesh { error: MeshError },
    }
}

impl OutlineError {
    /// The error for edges of two parts that meet.
    pub(super) fn meeting(parts: [u32; 2], point: [f64; 2]) -> OutlineError {
        let what = if parts[0] == parts[1] { MeetingOf::Itself } else { MeetingOf::Others };
        OutlineError::Meeting { what, parts, position: point }
    }
}

impl From<MeshError> for OutlineError {
    fn from(error: MeshError) -> OutlineError {
        match error {
            MeshError::NotCompared { edges, most } => OutlineError::NotCompared { edges, most },
            error => OutlineError::Mesh { error },
        }
    }
}

/// A position for a message.
fn at(position: &[f64; 2]) -> String {
    format!("({}, {})", number(position[0]), number(position[1]))
}
