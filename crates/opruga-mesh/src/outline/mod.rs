//! Closed curves in the plane from any source, and bodies made from them.
//!
//! ```text
//! rings as drawn ─nest→ outer rings and holes ─resampled→ equal edges ─skin→ a skin of edges
//!                                                                    └─filled→ triangles inside
//!                     └─squares→ equal squares around, which carry the rings
//! ```
//! Holes follow the even-odd rule: a point is inside if a ray from it to infinity crosses the rings an odd number of times. Rings that meet are
//! refused, unless [`joined`] has joined them before.

mod carrying;
mod constrained;
mod crossing;
mod error;
mod filling;
mod inside;
mod nesting;
mod overlap;
mod resample;
mod segments;
mod squares;
mod thin;
mod touching;

pub use carrying::{Painted, carry};
pub(crate) use crossing::first_meeting;
pub use error::{MeetingOf, OutlineError};
pub(crate) use filling::triangles_between;
pub use filling::{filled, node_estimate};
pub use inside::{Inside, around};
pub use nesting::nest;
pub use overlap::{Overlap, joined, wound};
pub use resample::resampled;
pub use squares::{squares, squares_estimate};
pub use thin::{Cause, SMALLEST_ANGLE, Thin};

use crate::{Mesh, MeshError};

/// A closed curve in the plane.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Ring {
    /// The points of the curve [m]; the first one is not repeated at the end.
    pub points: Vec<[f64; 2]>,
    /// The part of the source to which the ring belongs: a path of a drawing, a letter of a text, a polygon of a map. Rings of one part are holes of
    /// one another; [`Overlap`] determines the effect of parts on each other.
    pub part: u32,
}

impl Ring {
    /// Signed area ½Σ(xᵢyⱼ − xⱼyᵢ) [m²] relative to the first point; positive if the ring runs counter-clockwise.
    pub fn area(&self) -> f64 {
        let Some(o) = self.points.first() else { return 0.0 };
        let mut doubled = 0.0;
        for (a, b) in self.edges() {
            doubled += (a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]);
        }
        0.5 * doubled
    }

    /// Length of the closed curve [m].
    pub fn length(&self) -> f64 {
        self.edges().map(|(a, b)| distance(a, b)).sum()
    }

    /// The edges of the ring as pairs of points, with the closing edge last.
    pub(crate) fn edges(&self) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
        let next = self.points.iter().cycle().skip(1);
        self.points.iter().zip(next).map(|(a, b)| (*a, *b))
    }
}

/// Lowest and highest coordinates of all rings [m]; none if there are no points.
pub fn bounds(rings: &[Ring]) -> Option<([f64; 2], [f64; 2])> {
    let mut points = rings.iter().flat_map(|ring| &ring.points);
    let first = *points.next()?;
    let (mut low, mut high) = (first, first);
    for point in points {
        for axis in 0..2 {
            if point[axis] < low[axis] {
                low[axis] = point[axis];
            }
            if point[axis] > high[axis] {
                high[axis] = point[axis];
            }
        }
    }
    Some((low, high))
}

/// Distance of two points [m].
pub(crate) fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (x, y) = (b[0] - a[0], b[1] - a[1]);
    (x * x + y * y).sqrt()
}

/// A body whose skin consists of the rings, with an edge from every point to the next. Rings that [`nest`] has oriented make
/// chambers with holes.
///
/// # Errors
/// [`MeshError::TooManyNodes`].
pub fn skin(rings: &[Ring]) -> Result<Mesh<2>, MeshError> {
    crate::mesh::limit_nodes(rings.iter().map(|ring| ring.points.len() as u64).sum())?;
    let mut mesh = Mesh::default();
    for ring in rings {
        let first = mesh.positions.len() as u32;
        let n = ring.points.len() as u32;
        mesh.positions.extend(&ring.points);
        mesh.facets.extend((0..n).map(|i| [first + i, first + (i + 1) % n]));
    }
    Ok(mesh)
}
