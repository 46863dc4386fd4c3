//! The camera of a solid scene.

use crate::view::View;

/// Half of the height of the picture divided by the distance: the tangent of half of the angle of view.
const HALF_HEIGHT: f64 = 0.27;

/// The dot product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The vector from one point to another.
pub(crate) fn between(from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| to[axis] - from[axis])
}

/// The vector scaled to length one; a vector of length zero is unchanged.
pub(crate) fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 { vector.map(|value| value / length) } else { vector }
}

/// A point plus a multiple of a vector.
pub(crate) fn along(point: [f64; 3], vector: [f64; 3], factor: f64) -> [f64; 3] {
    std::array::from_fn(|axis| point[axis] + factor * vector[axis])
}

/// A point on the screen: its pixel and its inverse distance along the camera axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Seen {
    /// The pixel, from the left and from the top.
    pub(crate) pixel: [f32; 2],
    /// One divided by the distance along the camera axis.
    pub(crate) inverse_distance: f32,
}

/// The directions to the right, upwards and forwards of the camera of a view.
pub(crate) fn axes(view: &View) -> [[f64; 3]; 3] {
    let (azimuth, elevation) = (view.azimuth.to_radians(), view.elevation.clamp(-89.0, 89.0).to_radians());
    let back = [elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos()];
    let forward = back.map(|value| -value);
    let right = unit(cross(forward, [0.0, 1.0, 0.0]));
    [right, cross(right, forward), forward]
}

/// The points that a camera must see: the extreme points of the view or, if it has none, the corners of its box.
fn must_see(view: &View) -> Vec<[f64; 3]> {
    if !view.points.is_empty() {
        return view.points.clone();
    }
    let end = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { view.low[axis] } else { view.high[axis] };
    (0..8).map(|corner| std::array::from_fn(|axis| end(corner, axis))).collect()
}

/// The width and the height [m] of the part that the camera of a view must see, without perspective.
pub(crate) fn seen_size(view: &View) -> [f64; 2] {
    let (axes, points) = (axes(view), must_see(view));
    [0, 1].map(|axis| {
        let along = |ends: [f64; 2], point: &[f64; 3]| {
            let coordinate = dot(axes[axis], *point);
            [ends[0].min(coordinate), ends[1].max(coordinate)]
        };
        let [low, high] = points.iter().fold([f64::INFINITY, f64::NEG_INFINITY], along);
        high - low
    })
}

/// A camera with a perspective view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Camera {
    /// The position of the camera [m].
    pub(crate) position: [f64; 3],
    /// The directions to the right, upwards and forwards.
    pub(crate) axes: [[f64; 3]; 3],
    /// The distance [pixels] from the camera axis at which a direction at 45° to this axis is seen.
    pub(crate) focus: f64,
    /// The pixel on the camera axis.
    pub(crate) middle: [f64; 2],
}

impl Camera {
    /// The camera that sees the whole view in an image of the given size.
    pub(crate) fn new(view: &View, width: f64, height: f64) -> Camera {
        let axes = axes(view);
        let forward = axes[2];
        let margin = 1.08;
        let slope = [HALF_HEIGHT * width / height / margin, HALF_HEIGHT / margin];
        let corners = must_see(view);
        let mut target = view.center();
        let seen = |target: [f64; 3]| -> Vec<[f64; 3]> {
            corners.iter().map(|&corner| axes.map(|axis| dot(axis, between(target, corner)))).collect()
        };
        let far_enough = |seen: &[[f64; 3]]| {
            let need = |p: &[f64; 3]| (0..2).map(|axis| p[axis].abs() / slope[axis] - p[2]).fold(0.0, f64::max);
            // The camera must not come too close to a point in front of the centre.
            let free = |p: &[f64; 3]| 0.8 * view.extent() - p[2];
            seen.iter().map(|p| need(p).max(free(p))).fold(1e-9, f64::max)
        };
        for _ in 0..16 {
            let seen = seen(target);
            let distance = far_enough(&seen);
            // The target is moved so that opposite sides of the picture have the same free border.
            for axis in 0..2 {
                let at = |p: &[f64; 3]| p[axis] / (distance + p[2]).max(1e-9);
                let low = seen.iter().map(at).fold(f64::INFINITY, f64::min);
                let high = seen.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
                target = along(target, axes[axis], 0.5 * (low + high) * distance);
            }
        }
        let distance = far_enough(&seen(target));
        Camera {
            position: along(target, forward, -distance.max(1e-6)),
            axes,
            focus: 0.5 * height / HALF_HEIGHT,
            middle: [0.5 * width, 0.5 * height],
        }
    }

    /// The number of pixels per metre at the distance of a point.
    pub(crate) fn scale(&self, point: [f64; 3]) -> f64 {
        self.focus / self.turn(between(self.position, point))[2].max(1e-9)
    }

    /// The components of a direction to the right, upwards and forwards.
    pub(crate) fn turn(&self, direction: [f64; 3]) -> [f64; 3] {
        self.axes.map(|axis| dot(axis, direction))
    }

    /// The position on the screen of a point, unless it is behind the camera or not finite.
    pub(crate) fn see(&self, point: [f64; 3]) -> Option<Seen> {
        let [x, y, z] = self.turn(between(self.position, point));
        if !(z > 1e-9 && z.is_finite()) {
            return None;
        }
        let pixel = [self.middle[0] + self.focus * x / z, self.middle[1] - self.focus * y / z];
        let wide = pixel.iter().all(|value| value.abs() < 1e6);
        wide.then(|| Seen { pixel: pixel.map(|value| value as f32), inverse_distance: (1.0 / z) as f32 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::{BodyPicture, Picture};

    #[test]
    fn the_whole_view_is_seen() {
        let body = BodyPicture { positions: vec![[-1.0, 0.0, -2.0], [3.0, 1.0, 2.0]], ..Default::default() };
        let picture = Picture { dimension: 3, bodies: vec![body], ..Default::default() };
        let view = View::fit([&picture]).unwrap();
        let camera = Camera::new(&view, 800.0, 600.0);
        for point in [[-1.0, 0.0, -2.0], [3.0, 1.0, 2.0]] {
            let [x, y] = camera.see(point).unwrap().pixel;
            assert!((0.0..800.0).contains(&x) && (0.0..600.0).contains(&y), "{x} {y}");
        }
        assert!(camera.see(along(camera.position, camera.axes[2], -1.0)).is_none());
    }
}
