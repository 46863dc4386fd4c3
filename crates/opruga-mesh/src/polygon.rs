//! Outlines through given points.

use crate::lattice::{check_points, without_repeated_end};
use crate::outline::first_meeting;
use crate::plane::outline;
use crate::{Mesh, MeshError, Must, Quantity, signed_volume};

/// An outline through given points, and whether it had to be reversed.
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outline; node i is point i.
    pub mesh: Mesh<2>,
    /// Whether the points ran clockwise, so that the facets run in the opposite direction.
    pub flipped: bool,
}

impl Mesh<2> {
    /// An outline through the given points [m], in either direction; the first point may be repeated at the end.
    ///
    /// Node i is point i. Facets run counter-clockwise: in the direction of the points, or against it if the points run clockwise, which `flipped`
    /// shows.
    ///
    /// # Errors
    /// [`MeshError::Count`] for fewer than 3 points; [`MeshError::Size`] if one is not finite or they enclose no area; [`MeshError::RepeatedPoint`]
    /// if two consecutive ones coincide; [`MeshError::SelfIntersection`] with the first two edges that cross, touch or overlap.
    pub fn polygon(points: &[[f64; 2]]) -> Result<Polygon, MeshError> {
        let points = without_repeated_end(points);
        check_points(points, 3, true)?;
        if let Some([(_, first), (_, second)]) = first_meeting(&[points])? {
            let n = points.len();
            let ends = |edge: usize| [edge as u32, ((edge + 1) % n) as u32];
            return Err(MeshError::SelfIntersection { first: ends(first), second: ends(second) });
        }
        let mut mesh = outline(points.to_vec());
        let area = signed_volume(&mesh.facets, &mesh.positions);
        if area == 0.0 || !area.is_finite() {
            return Err(MeshError::Size { what: Quantity::AreaOutline, value: area, must: Must::NotZero });
        }
        let flipped = area < 0.0;
        if flipped {
            mesh.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
        }
        Ok(Polygon { mesh, flipped })
    }
}
