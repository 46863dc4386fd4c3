//! A camera that rotates freely around a point, for scenes that the user rotates. Also draws a scene without a title, a legend or scales.

use crate::error::DrawError;
use crate::image::Image;
use crate::picture::Picture;
use crate::solid::camera::{Camera, along, axes, dot};
use crate::view::View;

/// A camera that looks at a point from a direction, and shows a ball around that point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The point at which the camera looks [m].
    pub target: [f64; 3],
    /// The radius [m] of the ball that fills the smaller side of the picture.
    pub radius: f64,
    /// The angle around the y axis, from z towards x [degrees].
    pub azimuth: f64,
    /// The angle above the horizon [degrees].
    pub elevation: f64,
}

impl Eye {
    /// Makes an eye that sees the whole content of a view.
    pub fn of(view: &View) -> Eye {
        let half: [f64; 3] = std::array::from_fn(|axis| 0.5 * (view.high[axis] - view.low[axis]));
        let radius = (0.75 * dot(half, half).sqrt()).max(1e-9);
        Eye { target: view.center(), radius, azimuth: view.azimuth, elevation: view.elevation }
    }

    /// Makes the view of this eye, with the scales of another view.
    pub fn view(&self, scales: &View) -> View {
        let mut view = View {
            low: self.target.map(|c| c - self.radius),
            high: self.target.map(|c| c + self.radius),
            azimuth: self.azimuth,
            elevation: self.elevation,
            ..scales.clone()
        };
        // The camera must see the ends of a cross in the plane of the picture. Because the cross rotates with the eye, the distance of the camera
        // does not change.
        let [right, up, _] = axes(&view);
        let ends = [(right, 1.0), (right, -1.0), (up, 1.0), (up, -1.0)];
        view.points = ends.map(|(axis, sign)| along(self.target, axis, sign * self.radius)).to_vec();
        view
    }

    /// The directions to the right, upwards and forwards.
    pub fn axes(&self, scales: &View) -> [[f64; 3]; 3] {
        axes(&self.view(scales))
    }

    /// The lens that maps points to pixels of a picture of this size.
    pub fn lens(&self, scales: &View, [width, height]: [f64; 2]) -> Lens {
        Lens(Camera::new(&self.view(scales), width.max(1.0), height.max(1.0)))
    }
}

/// The mapping from points in space to pixels of a picture, and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens(Camera);

impl Lens {
    /// The pixel of a point and its distance along the camera axis [m]; none behind the camera.
    pub fn see(&self, point: [f64; 3]) -> Option<([f64; 2], f64)> {
        let seen = self.0.see(point)?;
        Some((seen.pixel.map(f64::from), 1.0 / f64::from(seen.inverse_distance)))
    }

    /// The point behind a pixel, at a distance [m] along the camera axis.
    pub fn point(&self, pixel: [f64; 2], distance: f64) -> [f64; 3] {
        let [right, up, forward] = self.0.axes;
        let share = [0, 1].map(|axis| (pixel[axis] - self.0.middle[axis]) / self.0.focus * distance);
        along(along(along(self.0.position, forward, distance), right, share[0]), up, -share[1])
    }
}

/// Draws the scene of a picture without a title, a legend or scales around it.
///
/// # Errors
/// [`DrawError`] for a picture with inconsistent lists, or a size that no image can have.
pub fn scene(picture: &Picture, view: &View, background: [u8; 3], size: [u32; 2]) -> Result<Image, DrawError> {
    Image::new(size[0], size[1], background)?;
    let unit = (size[0].min(size[1]) as f32 / 600.0).clamp(0.7, 8.0);
    crate::scene(picture, view, background, size, unit).map(|(image, _)| image)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::BodyPicture;

    #[test]
    fn a_point_comes_back_from_its_pixel_and_the_distance_stays_while_the_eye_turns() {
        let body = BodyPicture { positions: vec![[-1.0, 0.0, -2.0], [3.0, 1.0, 2.0]], ..Default::default() };
        let picture = Picture { dimension: 3, bodies: vec![body], ..Default::default() };
        let view = View::fit([&picture]).unwrap();
        let mut eye = Eye::of(&view);
        let mut distances = Vec::new();
        for turn in [0.0, 40.0, 170.0] {
            eye.azimuth = turn;
            let lens = eye.lens(&view, [800.0, 600.0]);
            let (pixel, distance) = lens.see([0.4, 0.2, -0.3]).unwrap();
            let back = lens.point(pixel, distance);
            let far = [0.4, 0.2, -0.3].iter().zip(back).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(far < 1e-4, "{back:?}");
            let (middle, distance) = lens.see(eye.target).unwrap();
            assert!((middle[0] - 400.0).abs() < 1e-3 && (middle[1] - 300.0).abs() < 1e-3, "{middle:?}");
            distances.push(distance);
        }
        assert!(distances.iter().all(|d| (d - distances[0]).abs() < 1e-4), "{distances:?}");
    }
}
