//! Which triangles of a filling are thinner than promised, and why.

use super::{Ring, distance};
use crate::Mesh;

/// The smallest angle [°] of triangles inside, but where the outline is finer than the spacing or its corners are sharper themselves.
pub const SMALLEST_ANGLE: f64 = 25.0;

/// Rounding takes no more than this from an angle [°].
const ROUNDING: f64 = 1e-6;

/// Why a triangle is thin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The outline itself has a corner of this inner angle [°] there.
    Corner(f64),
    /// Sides of the outline come nearer to one another there than the spacing, or nodes of it lie nearer: smaller triangles would take smaller steps.
    Finer,
    /// The refinement ended since it had added as many nodes as it may.
    Unfinished,
}

/// Triangles of a filling with angles below [`SMALLEST_ANGLE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thin {
    /// How many there are.
    pub count: usize,
    /// The smallest angle of all [°].
    pub angle: f64,
    /// Where that is [m].
    pub position: [f64; 2],
    /// Why.
    pub cause: Cause,
}

impl Thin {
    /// Those of the filling of rings; none where all angles are as promised.
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

/// The sharpest inner corner of the rings within a spacing of a position [°].
fn sharpest_corner(rings: &[Ring], position: [f64; 2], spacing: f64) -> Option<f64> {
    let mut sharpest: Option<f64> = None;
    for ring in rings {
        let n = ring.points.len();
        for k in 0..n {
            let point = ring.points[k];
            if distance(point, position) <= spacing {
                // Rings run with the inside on their left.
                let angle = turn(point, ring.points[(k + 1) % n], ring.points[(k + n - 1) % n]);
                let angle = if angle < 0.0 { angle + 360.0 } else { angle };
                sharpest = Some(sharpest.map_or(angle, |least| if angle < least { angle } else { least }));
            }
        }
    }
    sharpest
}

/// The angle at `o` from `a` round to `b`, counter-clockwise [°].
fn turn(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (u, v) = ([a[0] - o[0], a[1] - o[1]], [b[0] - o[0], b[1] - o[1]]);
    libm::atan2(u[0] * v[1] - u[1] * v[0], u[0] * v[0] + u[1] * v[1]) / core::f64::consts::PI * 180.0
}
