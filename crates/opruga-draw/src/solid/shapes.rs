//! The surfaces of obstacles.

use super::camera::{along, cross, unit};
use crate::picture::ColliderPicture;
use std::f64::consts::{PI, TAU};

/// The scale at which round obstacles are drawn. These obstacles are slightly reduced, because only the nodes of a cloth touch them. Between its
/// nodes, the cloth is inside the obstacle and would be hidden.
const ROUND: f64 = 0.985;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Shape {
    /// The corners.
    pub(crate) positions: Vec<[f64; 3]>,
    /// The triangles.
    pub(crate) triangles: Vec<[u32; 3]>,
}

/// The faces of a box, each given by its corners, its axis, and whether it is at the high end of that axis. A corner is a number whose bits mean low
/// or high along the three axes.
pub(crate) const FACES: [([usize; 4], usize, bool); 6] = [
    ([0, 4, 6, 2], 0, false),
    ([1, 3, 7, 5], 0, true),
    ([0, 1, 5, 4], 1, false),
    ([2, 6, 7, 3], 1, true),
    ([0, 2, 3, 1], 2, false),
    ([4, 5, 7, 6], 2, true),
];

/// A corner of a box.
pub(crate) fn corner(min: [f64; 3], max: [f64; 3], bits: usize) -> [f64; 3] {
    std::array::from_fn(|axis| if bits >> axis & 1 == 0 { min[axis] } else { max[axis] })
}

/// The surface of an obstacle; none for rooms, planes and lines.
pub(crate) fn shape(collider: &ColliderPicture) -> Option<Shape> {
    match collider {
        ColliderPicture::HalfSpace { .. } | ColliderPicture::Box { inside: true, .. } => None,
        ColliderPicture::Polyline(_) => None,
        ColliderPicture::Box { min, max, inside: false } => {
            let mut shape = Shape::default();
            for (corners, _, _) in FACES {
                let first = shape.positions.len() as u32;
                shape.positions.extend(corners.map(|bits| corner(*min, *max, bits)));
                shape.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            }
            Some(shape)
        }
        ColliderPicture::Ball { center, radius } => Some(capsule(*center, *center, ROUND * radius, FINE)),
        ColliderPicture::Capsule { a, b, radius } => Some(capsule(*a, *b, ROUND * radius, FINE)),
        ColliderPicture::Polygon(points) => {
            let triangles = (2..points.len() as u32).map(|last| [0, last - 1, last]).collect();
            Some(Shape { positions: points.clone(), triangles })
        }
        ColliderPicture::Mesh { positions, triangles } => {
            let known = |triangle: &&[u32; 3]| triangle.iter().all(|&node| (node as usize) < positions.len());
            Some(Shape { positions: positions.clone(), triangles: triangles.iter().filter(known).copied().collect() })
        }
    }
}

/// The numbers of points around an obstacle and along it, and those of a piece of a wire, of which there are many.
const FINE: [u32; 2] = [48, 26];
const COARSE: [u32; 2] = [16, 10];

/// A round piece of a wire. The points of its second half belong to its second end.
pub(crate) fn wire(ends: [[f64; 3]; 2], width: f64) -> Shape {
    capsule(ends[0], ends[1], 0.5 * width, COARSE)
}

/// The surface of a capsule; a ball if both ends are equal.
fn capsule(a: [f64; 3], b: [f64; 3], radius: f64, [around, rings]: [u32; 2]) -> Shape {
    let axis = unit(super::camera::between(a, b));
    let axis = if axis == [0.0; 3] { [0.0, 1.0, 0.0] } else { axis };
    let other = if axis[0].abs() < 0.7 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let side = unit(cross(axis, other));
    let third = cross(axis, side);
    let mut shape = Shape::default();
    for ring in 0..rings {
        // The straight part has a ring at each of its ends, so there are two rings in the middle.
        let half = rings / 2;
        let (end, step) = if ring < half { (a, ring) } else { (b, ring - 1) };
        let angle = PI * f64::from(step) / f64::from(rings - 2);
        for index in 0..around {
            let turn = TAU * f64::from(index) / f64::from(around);
            let point = along(end, axis, -radius * angle.cos());
            let point = along(point, side, radius * angle.sin() * turn.cos());
            shape.positions.push(along(point, third, radius * angle.sin() * turn.sin()));
        }
    }
    for ring in 0..rings - 1 {
        for index in 0..around {
            let (p, q) = (ring * around + index, ring * around + (index + 1) % around);
            shape.triangles.push([p, q, q + around]);
            shape.triangles.push([p, q + around, p + around]);
        }
    }
    shape
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solid::camera::{between, dot};

    #[test]
    fn a_ball_has_one_radius_everywhere() {
        let ball = shape(&ColliderPicture::Ball { center: [1.0, 2.0, 3.0], radius: 0.5 }).unwrap();
        for position in &ball.positions {
            let arm = between([1.0, 2.0, 3.0], *position);
            assert!((dot(arm, arm).sqrt() - 0.5 * ROUND).abs() < 1e-12);
        }
    }

    #[test]
    fn a_box_has_twelve_triangles_which_face_outwards() {
        let found = shape(&ColliderPicture::Box { min: [0.0; 3], max: [1.0; 3], inside: false }).unwrap();
        assert_eq!(found.triangles.len(), 12);
        for triangle in &found.triangles {
            let [a, b, c] = triangle.map(|node| found.positions[node as usize]);
            let normal = cross(between(a, b), between(a, c));
            assert!(dot(normal, between([0.5; 3], a)) > 0.0);
        }
    }
}
