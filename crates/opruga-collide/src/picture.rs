//! The colliders at a time, as plain data for drawing.

use crate::collider::{Collider, Form};

/// A collider in the coordinates of the world.
#[derive(Clone, Debug, PartialEq)]
pub enum Picture<const D: usize> {
    /// Everything behind a line or plane.
    HalfSpace {
        /// A point of the surface [m].
        point: [f64; D],
        /// The unit normal, out of the solid.
        normal: [f64; D],
    },
    /// A box, solid or as a container.
    Box {
        /// The 2^D corners [m]; bit d of the index gives the side along axis d.
        corners: Vec<[f64; D]>,
        /// Whether bodies are kept inside.
        inside: bool,
    },
    /// A disc or ball, solid or as a container.
    Ball {
        /// The centre [m].
        center: [f64; D],
        /// The radius [m].
        radius: f64,
        /// Whether bodies are kept inside.
        inside: bool,
    },
    /// All points closer to a segment than a radius.
    Capsule {
        /// One end of the segment [m].
        a: [f64; D],
        /// The other end [m].
        b: [f64; D],
        /// The radius [m].
        radius: f64,
    },
    /// A convex polygon (2D).
    Polygon {
        /// Its corners, counterclockwise [m].
        points: Vec<[f64; D]>,
    },
    /// A thin curve (2D).
    Polyline {
        /// Its points [m].
        points: Vec<[f64; D]>,
        /// Whether the last point is joined to the first.
        closed: bool,
    },
    /// Triangles (3D): a thin surface, or the faces of a convex solid.
    Triangles {
        /// The points [m].
        points: Vec<[f64; D]>,
        /// Three numbers of points per triangle.
        triangles: Vec<[u32; 3]>,
        /// Whether they are the faces of a solid.
        solid: bool,
    },
}

impl<const D: usize> Picture<D> {
    /// Returns the same picture in space, with z = 0 for shapes of the plane.
    pub fn in_space(self) -> Picture<3> {
        let three = |p: [f64; D]| core::array::from_fn(|d| p.get(d).copied().unwrap_or(0.0));
        let all = |points: Vec<[f64; D]>| points.into_iter().map(three).collect();
        match self {
            Picture::HalfSpace { point, normal } => Picture::HalfSpace { point: three(point), normal: three(normal) },
            Picture::Box { corners, inside } => Picture::Box { corners: all(corners), inside },
            Picture::Ball { center, radius, inside } => Picture::Ball { center: three(center), radius, inside },
            Picture::Capsule { a, b, radius } => Picture::Capsule { a: three(a), b: three(b), radius },
            Picture::Polygon { points } => Picture::Polygon { points: all(points) },
            Picture::Polyline { points, closed } => Picture::Polyline { points: all(points), closed },
            Picture::Triangles { points, triangles, solid } => {
                Picture::Triangles { points: all(points), triangles, solid }
            }
        }
    }
}

/// A collider at a time.
pub(crate) fn picture<const D: usize>(collider: &Collider<D>, time: f64) -> Picture<D> {
    let pose = collider.motion.pose(time);
    let all = |points: &[[f64; D]]| points.iter().map(|p| pose.transform(p)).collect();
    match &collider.form {
        Form::HalfSpace { point, normal } => {
            Picture::HalfSpace { point: pose.transform(point), normal: pose.direct(normal) }
        }
        Form::Box { shape, inside } => {
            let shape = shape.posed(&pose);
            Picture::Box { corners: (0..1 << D).map(|bits| shape.corner(bits)).collect(), inside: *inside }
        }
        Form::Ball { center, radius, inside } => {
            Picture::Ball { center: pose.transform(center), radius: *radius, inside: *inside }
        }
        Form::Capsule { a, b, radius } => {
            Picture::Capsule { a: pose.transform(a), b: pose.transform(b), radius: *radius }
        }
        Form::Polygon { points } => Picture::Polygon { points: all(points) },
        Form::Polyline { points, closed } => Picture::Polyline { points: all(points), closed: *closed },
        Form::Triangles { points, triangles, solid } => {
            Picture::Triangles { points: all(points), triangles: triangles.clone(), solid: *solid }
        }
    }
}
