//! Infinite floors and walls, and shadows on a floor.

use super::camera::{Camera, Seen, along, between, cross, dot, unit};
use super::raster::{Cover, Screen, line_triangles};
use crate::colour::mix;
use crate::view::View;

/// The two colours of the squares of a floor.
const SQUARES: [[u8; 3]; 2] = [[238, 240, 243], [224, 227, 232]];
/// The darkness of a shadow.
const SHADOW: f64 = 0.36;

/// A plane that faces the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// A point of the plane [m].
    pub(crate) point: [f64; 3],
    /// The direction out of the obstacle, of length one.
    pub(crate) normal: [f64; 3],
}

/// The samples of a screen that are in a shadow.
pub(crate) struct Shadow {
    /// The shade of each sample, from 0 to 255.
    shade: Vec<u8>,
    /// The first column and row with a shadow, and the column and row after the last ones.
    span: [usize; 4],
    /// The direction towards the light.
    light: [f64; 3],
    /// The plane on which the shadow falls.
    plane: Plane,
}

impl Plane {
    /// Whether the plane is a floor.
    pub(crate) fn is_floor(&self) -> bool {
        self.normal[1] > 0.6
    }

    /// The height of a point above the plane.
    fn height(&self, point: [f64; 3]) -> f64 {
        dot(self.normal, between(self.point, point))
    }
}

impl Shadow {
    /// An empty shadow.
    pub(crate) fn new(screen: &Screen, plane: Plane, light: [f64; 3]) -> Shadow {
        let span = [screen.width, 0, screen.height, 0];
        Shadow { shade: vec![0; screen.width * screen.height], span, light, plane }
    }

    /// The position on the screen of the shadow of a point.
    fn cast(&self, camera: &Camera, point: [f64; 3]) -> Option<Seen> {
        let height = self.plane.height(point).max(0.0);
        camera.see(along(point, self.light, -height / dot(self.light, self.plane.normal)))
    }

    /// Adds the shadow of a triangle.
    fn cover(&mut self, screen: &Screen, corners: [Seen; 3]) {
        let Some(cover) = Cover::new(corners, screen.width, screen.height) else { return };
        let span = cover.span();
        for side in [0, 2] {
            self.span[side] = self.span[side].min(span[side]);
            self.span[side + 1] = self.span[side + 1].max(span[side + 1]);
        }
        let shade = &mut self.shade;
        cover.each(screen.width, |index, _| shade[index] = 255);
    }

    /// Adds the shadows of triangles.
    pub(crate) fn triangles(
        &mut self,
        screen: &Screen,
        camera: &Camera,
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
    ) {
        let seen: Vec<Option<Seen>> = positions.iter().map(|&position| self.cast(camera, position)).collect();
        for triangle in triangles {
            if let [Some(a), Some(b), Some(c)] = triangle.map(|node| seen[node as usize]) {
                self.cover(screen, [a, b, c]);
            }
        }
    }

    /// Adds the shadow of a line with a width in samples.
    pub(crate) fn line(&mut self, screen: &Screen, camera: &Camera, ends: [[f64; 3]; 2], width: f32) {
        if let [Some(from), Some(to)] = ends.map(|end| self.cast(camera, end)) {
            line_triangles([from, to], width).into_iter().for_each(|corners| self.cover(screen, corners));
        }
    }

    /// Softens the edge of the shadow.
    pub(crate) fn soften(&mut self, screen: &Screen, radius: usize) {
        let grown = [
            self.span[0].saturating_sub(2 * radius),
            (self.span[1] + 2 * radius).min(screen.width),
            self.span[2].saturating_sub(2 * radius),
            (self.span[3] + 2 * radius).min(screen.height),
        ];
        let [left, right, top, bottom] = grown;
        if left >= right || top >= bottom || radius == 0 {
            return;
        }
        self.span = grown;
        let mut sums: Vec<u32> = Vec::new();
        for _ in 0..2 {
            for row in top..bottom {
                slide(&mut self.shade[row * screen.width + left..row * screen.width + right], radius, &mut sums);
            }
            let mut column = vec![0; bottom - top];
            for x in left..right {
                for (offset, value) in column.iter_mut().enumerate() {
                    *value = self.shade[(top + offset) * screen.width + x];
                }
                slide(&mut column, radius, &mut sums);
                for (offset, value) in column.iter().enumerate() {
                    self.shade[(top + offset) * screen.width + x] = *value;
                }
            }
        }
    }
}

/// Replaces each value by the mean of its neighbours up to a radius.
fn slide(values: &mut [u8], radius: usize, sums: &mut Vec<u32>) {
    sums.clear();
    sums.push(0);
    let mut sum = 0;
    for &value in values.iter() {
        sum += u32::from(value);
        sums.push(sum);
    }
    let count = values.len();
    let window = (2 * radius + 1) as u32;
    for (index, value) in values.iter_mut().enumerate() {
        let (first, last) = (index.saturating_sub(radius), (index + radius + 1).min(count));
        *value = ((sums[last] - sums[first]) / window) as u8;
    }
}

/// The number of the last step in which squares fade into the background.
const LAST_TONE: f64 = 255.0;

/// The colours of both kinds of squares as they fade into the background.
fn tones(background: [u8; 3], strength: f64) -> [[[u8; 3]; 256]; 2] {
    SQUARES.map(|square| {
        std::array::from_fn(|step| {
            let fade = 1.0 - step as f64 / LAST_TONE;
            mix(background, square, fade * fade * (3.0 - 2.0 * fade) * strength)
        })
    })
}

/// The largest integer not above a number. `floor` is not used, because it is a function call on machines without an instruction for it.
#[inline(always)]
fn below(number: f64) -> i64 {
    let whole = number as i64;
    whole - i64::from(number < whole as f64)
}

/// Draws a plane with squares that fade into the background with distance.
pub(crate) fn draw(
    screen: &mut Screen,
    background: [u8; 3],
    camera: &Camera,
    view: &View,
    plane: Plane,
    shadow: Option<&Shadow>,
) {
    let height = plane.height(camera.position);
    if height <= 1e-9 {
        return;
    }
    let extent = view.extent();
    let square = view.square();
    let first = unit(if plane.normal[0].abs() < 0.9 {
        along([1.0, 0.0, 0.0], plane.normal, -plane.normal[0])
    } else {
        along([0.0, 0.0, 1.0], plane.normal, -plane.normal[2])
    });
    let second = cross(plane.normal, first);
    let center = along(view.center(), plane.normal, -plane.height(view.center()));
    let middle = [dot(first, between(plane.point, center)), dot(second, between(plane.point, center))];
    let start = between(plane.point, camera.position);
    let start = [dot(first, start), dot(second, start)];
    let step = along([0.0; 3], camera.axes[0], 1.0 / camera.focus);
    let above = 1.0 / height;
    let sink = -dot(plane.normal, step);
    let (fade_from, fade_over) = (0.9 * extent, 2.4 * extent);
    let strength = if plane.is_floor() { 1.0 } else { 0.45 };
    let shadow = shadow.filter(|_| plane.is_floor());
    let tones = tones(background, strength);
    let (inner, outer) = (fade_from * fade_from, (fade_from + fade_over) * (fade_from + fade_over));
    let per_metre = 1.0 / square;
    for row in 0..screen.height {
        let up = (camera.middle[1] - row as f64 - 0.5) / camera.focus;
        let ray =
            along(along(camera.axes[2], camera.axes[1], up), camera.axes[0], (0.5 - camera.middle[0]) / camera.focus);
        let base = -dot(plane.normal, ray);
        let (ray_first, step_first) = (dot(first, ray), dot(first, step));
        let (ray_second, step_second) = (dot(second, ray), dot(second, step));
        for column in 0..screen.width {
            let x = column as f64;
            let fall = base + x * sink;
            if fall <= 1e-6 {
                continue;
            }
            let distance = height / fall;
            let u = start[0] + distance * (ray_first + x * step_first);
            let v = start[1] + distance * (ray_second + x * step_second);
            let away = (u - middle[0]) * (u - middle[0]) + (v - middle[1]) * (v - middle[1]);
            let index = row * screen.width + column;
            let inverse_distance = (fall * above) as f32;
            if away >= outer || inverse_distance <= screen.inverse_distances[index] {
                continue;
            }
            let fade = if away <= inner { 0.0 } else { (away.sqrt() - fade_from) / fade_over };
            let parity = below(u * per_metre).wrapping_add(below(v * per_metre)) & 1;
            let tone = tones[parity as usize][(fade * LAST_TONE) as usize & LAST_TONE as usize];
            let dark = shadow.map_or(0, |shadow| shadow.shade[index]);
            screen.colours[index] =
                if dark > 0 { mix(tone, [40, 46, 62], SHADOW * f64::from(dark) / 255.0) } else { tone };
            screen.inverse_distances[index] = inverse_distance * 0.9995;
        }
    }
}
