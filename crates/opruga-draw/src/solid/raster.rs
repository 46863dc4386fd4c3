//! Fills triangles on a screen of samples. The nearest sample is visible; four samples make a pixel.

use super::camera::Seen;
use crate::error::DrawError;
use crate::image::Image;

/// The number of samples along each side of a pixel.
pub(crate) const SAMPLES: usize = 2;

/// A screen of samples with colours and distances.
pub(crate) struct Screen {
    /// The number of samples in a row.
    pub(crate) width: usize,
    /// The number of rows of samples.
    pub(crate) height: usize,
    /// The colours.
    pub(crate) colours: Vec<[u8; 3]>,
    /// The inverse distances; 0 is infinitely far.
    pub(crate) inverse_distances: Vec<f32>,
}

/// The samples that a triangle covers.
pub(crate) struct Cover {
    /// The corners.
    corners: [Seen; 3],
    /// One divided by twice the area.
    inverse: f32,
    /// The first column and row, and the column and row after the last ones.
    span: [usize; 4],
}

impl Cover {
    /// The samples of a triangle on a screen; none if it covers no sample.
    pub(crate) fn new(corners: [Seen; 3], width: usize, height: usize) -> Option<Cover> {
        let [a, b, c] = corners.map(|corner| corner.pixel);
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
        if !area.is_finite() || area == 0.0 {
            return None;
        }
        let span = |axis: usize, limit: usize| {
            let low = a[axis].min(b[axis]).min(c[axis]);
            let high = a[axis].max(b[axis]).max(c[axis]);
            // A sample is at the centre of its cell.
            let first = (low - 0.5).ceil().max(0.0) as usize;
            let last = ((high - 0.5).floor() + 1.0).max(0.0) as usize;
            [first, last.min(limit)]
        };
        let ([left, right], [top, bottom]) = (span(0, width), span(1, height));
        (left < right && top < bottom).then_some(Cover {
            corners,
            inverse: 1.0 / area,
            span: [left, right, top, bottom],
        })
    }

    /// The first column and row of the samples, and the column and row after the last ones.
    pub(crate) fn span(&self) -> [usize; 4] {
        self.span
    }

    /// Calls a function with the index of each sample and the weights of the corners at this sample.
    #[inline(always)]
    pub(crate) fn each(&self, width: usize, mut call: impl FnMut(usize, [f32; 3])) {
        let [a, b, c] = self.corners.map(|corner| corner.pixel);
        let [left, right, top, bottom] = self.span;
        let edge = |p: [f32; 2], q: [f32; 2]| [(p[1] - q[1]) * self.inverse, (q[0] - p[0]) * self.inverse];
        let (step_a, step_b) = (edge(b, c), edge(c, a));
        for row in top..bottom {
            let y = row as f32 + 0.5;
            let row_a = (y - b[1]) * step_a[1];
            let row_b = (y - c[1]) * step_b[1];
            let mut inside = false;
            for column in left..right {
                let x = column as f32 + 0.5;
                let share_a = row_a + (x - b[0]) * step_a[0];
                let share_b = row_b + (x - c[0]) * step_b[0];
                let share_c = 1.0 - share_a - share_b;
                if share_a >= 0.0 && share_b >= 0.0 && share_c >= 0.0 {
                    inside = true;
                    call(row * width + column, [share_a, share_b, share_c]);
                } else if inside {
                    break;
                }
            }
        }
    }
}

impl Screen {
    /// An empty screen for an image of the given size in pixels.
    pub(crate) fn new(width: u32, height: u32, background: [u8; 3]) -> Screen {
        let (width, height) = (width as usize * SAMPLES, height as usize * SAMPLES);
        Screen {
            width,
            height,
            colours: vec![background; width * height],
            inverse_distances: vec![0.0; width * height],
        }
    }

    /// Fills a triangle; `colour` returns the colour of a sample from the perspective-correct weights of the corners.
    #[inline(always)]
    pub(crate) fn triangle(&mut self, corners: [Seen; 3], colour: impl Fn([f32; 3]) -> [u8; 3]) {
        let Some(cover) = Cover::new(corners, self.width, self.height) else { return };
        let inverses = corners.map(|corner| corner.inverse_distance);
        let (depths, colours) = (&mut self.inverse_distances, &mut self.colours);
        cover.each(self.width, |index, shares| {
            let weights = [shares[0] * inverses[0], shares[1] * inverses[1], shares[2] * inverses[2]];
            let depth = weights[0] + weights[1] + weights[2];
            if depth > depths[index] {
                depths[index] = depth;
                let whole = 1.0 / depth;
                colours[index] = colour(weights.map(|weight| weight * whole));
            }
        });
    }

    /// Draws a line with a width in samples. The line is moved slightly towards the camera, so that it is visible on a surface.
    pub(crate) fn line(&mut self, ends: [Seen; 2], width: f32, colours: [[u8; 3]; 2]) {
        for corners in line_triangles(ends, width) {
            let corners = corners.map(|corner| Seen { inverse_distance: corner.inverse_distance * 1.004, ..corner });
            let whole = colours[0] == colours[1];
            let first = |corner: Seen| {
                let distance =
                    |end: Seen| (corner.pixel[0] - end.pixel[0]).powi(2) + (corner.pixel[1] - end.pixel[1]).powi(2);
                f64::from(u8::from(distance(ends[0]) > distance(ends[1])))
            };
            let shares = corners.map(first);
            self.triangle(corners, |weights| {
                if whole {
                    return colours[0];
                }
                let share = (0..3).map(|corner| f64::from(weights[corner]) * shares[corner]).sum();
                crate::colour::mix(colours[0], colours[1], share)
            });
        }
    }

    /// Draws a disc with a radius in samples, moved slightly towards the camera.
    pub(crate) fn disc(&mut self, center: Seen, radius: f32, colour: [u8; 3]) {
        let [x, y] = center.pixel;
        let span = |middle: f32, limit: usize| {
            let low = (middle - radius - 0.5).ceil().max(0.0) as usize;
            low..((middle + radius + 0.5).floor().max(0.0) as usize).min(limit)
        };
        for row in span(y, self.height) {
            for column in span(x, self.width) {
                let far = (column as f32 + 0.5 - x).powi(2) + (row as f32 + 0.5 - y).powi(2);
                let index = row * self.width + column;
                if far <= radius * radius && center.inverse_distance * 1.006 > self.inverse_distances[index] {
                    self.inverse_distances[index] = center.inverse_distance * 1.006;
                    self.colours[index] = colour;
                }
            }
        }
    }

    /// The image whose pixels are the means of their samples.
    pub(crate) fn image(&self) -> Result<Image, DrawError> {
        let (width, height) = (self.width / SAMPLES, self.height / SAMPLES);
        let mut image = Image::new(width as u32, height as u32, [0; 3])?;
        for (row, line) in image.pixels_mut().chunks_exact_mut(4 * width).enumerate() {
            let upper = &self.colours[2 * row * self.width..][..self.width];
            let lower = &self.colours[(2 * row + 1) * self.width..][..self.width];
            for ((pixel, upper), lower) in
                line.chunks_exact_mut(4).zip(upper.chunks_exact(2)).zip(lower.chunks_exact(2))
            {
                for channel in 0..3 {
                    let sum: u16 = [upper[0], upper[1], lower[0], lower[1]].iter().map(|c| u16::from(c[channel])).sum();
                    pixel[channel] = ((sum + 2) / 4) as u8;
                }
            }
        }
        Ok(image)
    }
}

/// The two triangles of a line with a width.
pub(crate) fn line_triangles([from, to]: [Seen; 2], width: f32) -> [[Seen; 3]; 2] {
    let (x, y) = (to.pixel[0] - from.pixel[0], to.pixel[1] - from.pixel[1]);
    let length = (x * x + y * y).sqrt().max(1e-6);
    let side = [-0.5 * width * y / length, 0.5 * width * x / length];
    let shift = |end: Seen, sign: f32| Seen {
        pixel: [end.pixel[0] + sign * side[0], end.pixel[1] + sign * side[1]],
        inverse_distance: end.inverse_distance,
    };
    let corners = [shift(from, 1.0), shift(to, 1.0), shift(to, -1.0), shift(from, -1.0)];
    [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle over the left upper half of the screen.
    fn corners(inverse_distance: f32) -> [Seen; 3] {
        [[0.0, 0.0], [40.0, 0.0], [0.0, 40.0]].map(|pixel| Seen { pixel, inverse_distance })
    }

    #[test]
    fn the_nearer_triangle_wins_in_any_order() {
        for order in [[1.0, 2.0], [2.0, 1.0]] {
            let mut screen = Screen::new(20, 20, [255; 3]);
            for inverse_distance in order {
                screen.triangle(corners(inverse_distance), |_| [if inverse_distance > 1.5 { 200 } else { 10 }, 0, 0]);
            }
            let image = screen.image().unwrap();
            assert_eq!(image.pixel(3, 3), [200, 0, 0]);
            assert_eq!(image.pixel(18, 18), [255; 3]);
        }
    }

    #[test]
    fn neighbours_leave_no_gap() {
        let mut screen = Screen::new(20, 20, [255; 3]);
        screen.triangle(corners(1.0), |_| [0; 3]);
        let other = [[40.0, 0.0], [40.0, 40.0], [0.0, 40.0]].map(|pixel| Seen { pixel, inverse_distance: 1.0 });
        screen.triangle(other, |_| [0; 3]);
        assert!(screen.colours.iter().all(|colour| *colour == [0; 3]));
    }
}
