//! Round and regular outlines in the plane.

use std::f64::consts::PI;

use crate::mesh::{count, finite, limit_nodes, positive};
use crate::{MAXIMUM_NODES, Mesh, MeshError, Must, Quantity};

/// The outline 0 → 1 → … → n−1 → 0.
pub(crate) fn outline(positions: Vec<[f64; 2]>) -> Mesh<2> {
    let n = positions.len() as u32;
    let facets = (0..n).map(|i| [i, (i + 1) % n]).collect();
    Mesh { positions, facets, ..Mesh::default() }
}

/// The largest start angle [rad]: beyond it, rounding changes the angles between neighbouring vertices, and from 1e17 on they are zero.
pub const LARGEST_ANGLE: f64 = 1e6;

/// Refuses an angle [rad] so large that rounding would move nodes.
fn angle(what: Quantity, value: f64) -> Result<(), MeshError> {
    if (-LARGEST_ANGLE..=LARGEST_ANGLE).contains(&value) {
        Ok(())
    } else {
        Err(MeshError::Size { what, value, must: Must::Turns })
    }
}

/// Points on a circle, counter-clockwise from the start angle.
fn circle(radius: f64, vertices: u32, center: [f64; 2], start_angle: f64) -> Vec<[f64; 2]> {
    let at = |i: u32| {
        let angle = start_angle + 2.0 * PI * f64::from(i) / f64::from(vertices);
        [center[0] + radius * libm::cos(angle), center[1] + radius * libm::sin(angle)]
    };
    (0..vertices).map(at).collect()
}

impl Mesh<2> {
    /// A round outline of radius r [m]: n vertices on a circle about `center` [m], counter-clockwise from `start_angle` [rad]. Facet i runs from node
    /// i to node i + 1.
    ///
    /// The area of the outline is ½ n r² sin(2π/n), and its length is 2 n r sin(π/n).
    ///
    /// # Errors
    /// [`MeshError::Count`] for fewer than 3 vertices or too many; [`MeshError::Size`] for a radius that is not positive and finite, a centre that is
    /// not finite, or an angle beyond ±[`LARGEST_ANGLE`].
    pub fn ring(radius: f64, vertices: u32, center: [f64; 2], start_angle: f64) -> Result<Mesh<2>, MeshError> {
        count(Quantity::NumberVertices, vertices, 3, MAXIMUM_NODES)?;
        positive(Quantity::Radius, radius)?;
        finite(Quantity::Centre, &center)?;
        angle(Quantity::StartAngle, start_angle)?;
        Ok(outline(circle(radius, vertices, center, start_angle)))
    }

    /// A regular polygon with corners at `radius` [m] from `center` [m] and `vertices_per_side` equal edges per side. The first corner, node 0, is at
    /// `start_angle` [rad]; the others follow counter-clockwise.
    ///
    /// # Errors
    /// The errors of [`Mesh::ring`], also for fewer than three sides or no vertices per side; [`MeshError::TooManyNodes`].
    pub fn regular_polygon(
        sides: u32,
        radius: f64,
        vertices_per_side: u32,
        center: [f64; 2],
        start_angle: f64,
    ) -> Result<Mesh<2>, MeshError> {
        count(Quantity::NumberSides, sides, 3, MAXIMUM_NODES)?;
        count(Quantity::NumberVerticesPerSide, vertices_per_side, 1, MAXIMUM_NODES)?;
        limit_nodes(u64::from(sides) * u64::from(vertices_per_side))?;
        positive(Quantity::Radius, radius)?;
        finite(Quantity::Centre, &center)?;
        angle(Quantity::StartAngle, start_angle)?;
        let corners = circle(radius, sides, center, start_angle);
        let mut positions = Vec::with_capacity(sides as usize * vertices_per_side as usize);
        for (side, a) in corners.iter().enumerate() {
            let b = corners[(side + 1) % corners.len()];
            for step in 0..vertices_per_side {
                let t = f64::from(step) / f64::from(vertices_per_side);
                positions.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        Ok(outline(positions))
    }
}
