//! Triangles of a filling that are thinner than promised, and the causes.

use super::{Ring, distance};
use crate::Mesh;

/// The smallest angle [°] of triangles inside, except where the outline is finer than the spacing or has sharper corners itself.
pub const SMALLEST_ANGLE: f64 = 25.0;

/// The largest error of an angle by rounding [°].
const ROUNDING: f64 = 1e-6;

/// The cause of a thin triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The outline itself has a corner with this inner angle [°] at this position.
    Corner(f64),
    /// Sides or nodes of the outline are closer to one another than the spacing at this position; smaller triangles would require shorter time steps.
    Finer,
    /// The refinement ended because it reached the maximum number of added nodes.
    Unfinished,
}

/// Triangles of a filling with angles below [`SMALLEST_ANGLE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thin {
    /// The number of these triangles.
    pub count: usize,
    /// The smallest of all angles [°].
    pub angle: f64,
    /// The position of this angle [m].
    pub position: [f64; 2],
    /// The cause of this angle.
    pub cause: Cause,
}

impl Thin {
    /// The thin triangles in a filling of rings; none if all angles are as promised.
    pub(super) fn of(mesh: &Mesh<2>, rings: &[Ring], spacing: f64, complete: bool) -> Option<Thin> {
        let (mut count, mut angle, mut position) = (0, f64::INFINITY, [0.0; 2]);
        for triangle in &mesh.cells.triangles {
            let corners = triangle.map(|node| mesh.positions[node as usize]);
            let angles = [0, 1, 2].map(|k| turn(corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]));
            count += usize::from(angles.iter().any(|angle| *angle < SMALLEST_ANGLE - ROUNDING));
            for (own, at) in angles.into_iter().zip(corners) {
                if own < angle {
                    (angle, position) = (own, at);
                }
            }
        }
        let cause = || match sharpest_corner(rings, position, spacing) {
            Some(corner) if corner < SMALLEST_ANGLE + SMALLEST_ANGLE => Cause::Corner(corner),
            _ if complete => Cause::Finer,
            _ => Cause::Unfinished,
        };
        (count > 0).then(|| Thin { count, angle, position, cause: cause() })
    }
}

/// The sharpest inner corner [°] of the rings within a spacing of a position.
fn sharpest_corner(rings: &[Ring], position: [f64; 2], spacing: f64) -> Option<f64> {
    let mut sharpest: Option<f64> = None;
    for ring in rings {
        let n = ring.points.len();
        for k in 0..n {
            let point = ring.points[k];
            if distance(point, position) <= spacing {
                // The inside is to the left of rings.
                let angle = turn(point, ring.points[(k + 1) % n], ring.points[(k + n - 1) % n]);
                let angle = if angle < 0.0 { angle + 360.0 } else { angle };
                sharpest = Some(sharpest.map_or(angle, |least| if angle < least { angle } else { least }));
            }
        }
    }
    sharpest
}

/// The angle at `o` from `a` to `b`, counter-clockwise [°].
fn turn(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
    libm::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]) / core::f64::consts::PI * 180.0
}
