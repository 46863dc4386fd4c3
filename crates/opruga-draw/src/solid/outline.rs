//! The line around the visible part of a body. The line lies entirely outside the region that the body covers.

use super::camera::Seen;
use super::raster::{Cover, SAMPLES, Screen, line_triangles};
use super::triangles;
use crate::image::Image;
use crate::picture::BodyPicture;

/// The samples that a body covers, whatever is in front of it, and the samples of the line around them.
struct Mask {
    width: usize,
    height: usize,
    covered: Vec<bool>,
}

impl Mask {
    /// The region that a body covers: its surface seen from either side, and its springs.
    fn new(screen: &Screen, body: &BodyPicture, seen: &[Option<Seen>], spring: f32) -> Mask {
        let (width, height) = (screen.width, screen.height);
        let mut mask = Mask { width, height, covered: vec![false; width * height] };
        let corners = |nodes: &[u32; 3]| -> Option<[Seen; 3]> {
            Some([seen[nodes[0] as usize]?, seen[nodes[1] as usize]?, seen[nodes[2] as usize]?])
        };
        triangles(body).iter().filter_map(corners).for_each(|corners| mask.cover(corners));
        for &[a, b] in &body.segments {
            if let (Some(from), Some(to)) = (seen[a as usize], seen[b as usize]) {
                line_triangles([from, to], spring).into_iter().for_each(|corners| mask.cover(corners));
            }
        }
        mask
    }

    fn cover(&mut self, corners: [Seen; 3]) {
        if let Some(cover) = Cover::new(corners, self.width, self.height) {
            cover.each(self.width, |index, _| self.covered[index] = true);
        }
    }

    /// The samples outside the covered region whose distance from it is at most a radius. These samples are found by drawing a disc around each
    /// border sample.
    fn around(&self, radius: f32) -> Vec<bool> {
        let mut around = vec![false; self.covered.len()];
        let reach = radius.floor().max(1.0) as isize;
        // For every row of a disc: the number of the row, and half of its width.
        let disc: Vec<(isize, usize)> = (-reach..=reach)
            .map(|y| (y, (radius * radius - (y * y) as f32).max(0.0).sqrt().floor() as usize))
            .collect();
        for row in 0..self.height {
            for column in 0..self.width {
                if !self.is_border(row, column) {
                    continue;
                }
                for &(y, half) in &disc {
                    let Some(row) = row.checked_add_signed(y).filter(|row| *row < self.height) else { continue };
                    let (from, to) = (column.saturating_sub(half), (column + half + 1).min(self.width));
                    around[row * self.width..][from..to].fill(true);
                }
            }
        }
        around.iter_mut().zip(&self.covered).for_each(|(around, covered)| *around &= !covered);
        around
    }

    /// Whether a sample is covered and has a neighbour that is not. The border of the picture does not count as a border of the body.
    fn is_border(&self, row: usize, column: usize) -> bool {
        let index = row * self.width + column;
        self.covered[index]
            && ((column > 0 && !self.covered[index - 1])
                || (column + 1 < self.width && !self.covered[index + 1])
                || (row > 0 && !self.covered[index - self.width])
                || (row + 1 < self.height && !self.covered[index + self.width]))
    }
}

/// Draws the line around a body over a finished picture. The width of the line is given in pixels, and the width of the springs as drawn is given in
/// samples.
pub(super) fn draw(
    image: &mut Image,
    screen: &Screen,
    (body, seen): (&BodyPicture, &[Option<Seen>]),
    colour: [u8; 3],
    (width, spring): (f32, f32),
) {
    let mask = Mask::new(screen, body, seen, spring);
    let around = mask.around(width * SAMPLES as f32);
    let columns = screen.width / SAMPLES;
    for (row, line) in image.pixels_mut().chunks_exact_mut(4 * columns).enumerate() {
        for (column, pixel) in line.chunks_exact_mut(4).enumerate() {
            let samples = (0..SAMPLES * SAMPLES)
                .map(|k| (SAMPLES * row + k / SAMPLES) * screen.width + SAMPLES * column + k % SAMPLES);
            let share = samples.filter(|index| around[*index]).count();
            if share > 0 {
                let share = share as f64 / (SAMPLES * SAMPLES) as f64;
                let below = [pixel[0], pixel[1], pixel[2]];
                pixel[..3].copy_from_slice(&crate::colour::mix(below, colour, share));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::picture::{BodyPicture, Facets, Picture};
    use crate::{View, draw_scene};

    const GREEN: [u8; 3] = [0, 255, 0];
    const SIZE: u32 = 200;

    /// Pictures of a body without a line around it and with one.
    fn pictures(body: &BodyPicture) -> [crate::Image; 2] {
        [None, Some(GREEN)].map(|outlined| {
            let bodies = vec![BodyPicture { outlined, colour: Some([180, 60, 60]), ..body.clone() }];
            let picture = Picture { dimension: 3, bodies, ..Picture::default() };
            let mut view = View::fit([&picture]).expect("a view");
            // Seen from this side, the sheets of the tests are one behind another.
            (view.azimuth, view.elevation) = (10.0, 20.0);
            draw_scene(&picture, &view, [255; 3], [SIZE, SIZE]).expect("a picture")
        })
    }

    /// A sheet folded twice into the shape of a Z. Seen from the front, its folds are inside the covered region.
    fn folded() -> BodyPicture {
        let profile = [[0.0, 0.0], [2.0, 0.4], [0.5, 0.9], [2.5, 1.4]];
        let positions = profile.iter().flat_map(|&[x, z]| [[x, 0.0, -z], [x, 1.5, -z]]).collect();
        let sides = [0, 2, 4].iter().flat_map(|&k: &u32| [[k, k + 2, k + 3], [k, k + 3, k + 1]]).collect();
        BodyPicture { positions, facets: Facets::Triangles(sides), ..BodyPicture::default() }
    }

    /// A rope of springs in space.
    fn rope() -> BodyPicture {
        let positions =
            (0..9).map(|k| [f64::from(k) * 0.25, (f64::from(k) * 0.7).sin(), 0.3 * f64::from(k % 3)]).collect();
        BodyPicture { positions, segments: (0..8).map(|k| [k, k + 1]).collect(), ..BodyPicture::default() }
    }

    #[test]
    fn the_line_lies_outside_the_body_and_all_around_it() {
        for body in [folded(), rope()] {
            let [plain, outlined] = pictures(&body);
            let empty = |x: u32, y: u32| plain.pixel(x, y) == [255; 3];
            let beside = |x: u32, y: u32| [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            let mut around = 0;
            for (x, y) in (2..SIZE - 2).flat_map(|y| (2..SIZE - 2).map(move |x| (x, y))) {
                // Pixels at the border are partly covered; a pixel surrounded by the body is inside.
                let within = (x - 2..=x + 2).all(|x| (y - 2..=y + 2).all(|y| !empty(x, y)));
                if within {
                    assert_eq!(plain.pixel(x, y), outlined.pixel(x, y), "({x}, {y}) is within");
                } else if empty(x, y) && beside(x, y).iter().any(|&(x, y)| !empty(x, y)) {
                    assert_ne!(outlined.pixel(x, y), [255; 3], "({x}, {y}) lies next to the body");
                    around += 1;
                }
            }
            assert!(around > 100, "a body is seen: {around}");
        }
    }

    #[test]
    fn the_line_is_nowhere_wider_than_it_should_be() {
        let [plain, outlined] = pictures(&folded());
        let at = |x: u32, y: u32| plain.pixel(x, y) != [255; 3];
        for (x, y) in (5..SIZE - 5).flat_map(|y| (5..SIZE - 5).map(move |x| (x, y))) {
            if outlined.pixel(x, y) != plain.pixel(x, y) {
                let close = (x - 3..=x + 3).any(|x| (y - 3..=y + 3).any(|y| at(x, y)));
                assert!(close, "({x}, {y}) lies farther than 3 pixels from the body");
            }
        }
    }
}
