//! Writes bodies as triangles directly into one mesh. The interface only has to copy this mesh, and its arrays are reused from picture to picture.

use super::detail::Detail;
use egui::epaint::{Vertex, WHITE_UV};
use egui::{Color32, Mesh, Painter, Pos2, Rect, Shape, Vec2};
use std::sync::Arc;

/// Points of a line that are closer together than this are merged [points of the screen]. `JOINED_HARD` applies if borders are hard, as they are with
/// many bodies.
const JOINED: f32 = 0.4;
const JOINED_HARD: f32 = 1.5;
/// A line with more points than this is searched for straight pieces. `BESIDE` is the largest deviation of points from a straight piece, and
/// `BESIDE_HARD` is this deviation for hard borders [points of the screen].
const LONG: usize = 256;
const BESIDE: f32 = 0.1;
const BESIDE_HARD: f32 = 0.4;
/// The largest difference of colours within a straight piece, on a scale of 255.
const ALIKE: u8 = 6;
/// The largest distance to which a corner of a line protrudes, as a multiple of half the width of the line.
const MOST_MITRE: f32 = 2.0;

fn vertex(pos: Pos2, color: Color32) -> Vertex {
    Vertex { pos, uv: WHITE_UV, color }
}

/// The direction of a vector on the screen. Coordinates are limited, so the square of a length neither overflows nor underflows.
fn unit(vector: Vec2) -> Vec2 {
    let long = vector.length_sq().sqrt();
    if long > 0.0 { vector / long } else { Vec2::ZERO }
}

/// A mesh under construction, and the mesh that was shown last.
#[derive(Debug, Default)]
pub(crate) struct Brush {
    mesh: Mesh,
    shown: Option<Arc<Mesh>>,
    /// The width of a soft border; 0 for hard ones [points of the screen].
    soft: f32,
    /// The visible area.
    screen: Option<Rect>,
    /// Workspace: the points of a line that are distinct on the screen.
    line: Vec<(Pos2, Color32)>,
    /// Workspace: the indices of those points that are needed.
    kept: Vec<u32>,
}

impl Brush {
    /// Begins a picture whose borders are `soft` points wide. Only the area `screen` is visible.
    pub(crate) fn begin(&mut self, soft: f32, screen: Rect) {
        self.screen = Some(screen);
        // The last mesh is no longer needed, so its arrays are reused.
        if let Some(Ok(mesh)) = self.shown.take().map(Arc::try_unwrap) {
            self.mesh = mesh;
        }
        self.mesh.clear();
        self.soft = soft;
    }

    /// Gives the picture to a painter.
    pub(crate) fn end(&mut self, painter: &Painter) {
        if !self.mesh.indices.is_empty() {
            let mesh = Arc::new(std::mem::take(&mut self.mesh));
            painter.add(Shape::Mesh(Arc::clone(&mesh)));
            self.shown = Some(mesh);
        }
    }

    fn corner(&mut self, pos: Pos2, color: Color32) {
        self.mesh.vertices.push(vertex(pos, color));
    }

    /// Adds triangles between points of these colours.
    pub(crate) fn fill(&mut self, points: impl Iterator<Item = (Pos2, Color32)>, triangles: &[[u32; 3]]) {
        let first = self.mesh.vertices.len() as u32;
        self.mesh.vertices.extend(points.map(|(pos, color)| vertex(pos, color)));
        self.mesh.indices.reserve(3 * triangles.len());
        triangles.iter().for_each(|[a, b, c]| self.mesh.indices.extend([first + a, first + b, first + c]));
    }

    /// Adds the triangles between the points of a line with the indices `from` and `to`. Every point has four corners, or two if borders are hard.
    fn band(&mut self, first: u32, from: u32, to: u32) {
        let rows = if self.soft > 0.0 { 4 } else { 2 };
        for row in 0..rows - 1 {
            let [a, b] = [from, to].map(|point| first + point * rows + row);
            self.mesh.indices.extend([a, a + 1, b, b, a + 1, b + 1]);
        }
    }

    /// Adds the corners on both sides of a point of a line. The length of `side` is the factor by which the width is stretched at this point.
    fn across(&mut self, at: Pos2, side: Vec2, width: f32, color: Color32) {
        let half = 0.5 * width;
        if self.soft > 0.0 {
            let (inner, outer) = ((half - 0.5 * self.soft).max(0.0), half + 0.5 * self.soft);
            let (inner, outer) = (side * inner, side * outer);
            self.mesh.vertices.extend([
                vertex(at + outer, Color32::TRANSPARENT),
                vertex(at + inner, color),
                vertex(at - inner, color),
                vertex(at - outer, Color32::TRANSPARENT),
            ]);
        } else {
            let side = side * half;
            self.mesh.vertices.extend([vertex(at + side, color), vertex(at - side, color)]);
        }
    }

    /// Adds a straight line whose colour changes from `a` to `b`.
    pub(crate) fn line(&mut self, [from, to]: [Pos2; 2], width: f32, [a, b]: [Color32; 2]) {
        let vector = to - from;
        let long = vector.length();
        if long <= 1e-3 {
            return;
        }
        let side = Vec2::new(-vector.y, vector.x) / long;
        let first = self.mesh.vertices.len() as u32;
        self.across(from, side, width, a);
        self.across(to, side, width, b);
        self.band(first, 0, 1);
    }

    /// Adds a closed line.
    pub(crate) fn ring(&mut self, points: impl Iterator<Item = (Pos2, Color32)>, width: f32) {
        let mut line = std::mem::take(&mut self.line);
        line.clear();
        let joined = if self.soft > 0.0 { JOINED } else { JOINED_HARD };
        let joined_squared = joined * joined;
        for point in points {
            if line.last().is_none_or(|last: &(Pos2, Color32)| (point.0 - last.0).length_sq() > joined_squared) {
                line.push(point);
            }
        }
        while line.len() > 1 && (line[line.len() - 1].0 - line[0].0).length_sq() <= joined_squared {
            line.pop();
        }
        if line.len() > LONG {
            let beside = if self.soft > 0.0 { BESIDE } else { BESIDE_HARD };
            let screen = self.screen.unwrap_or(Rect::EVERYTHING).expand(2.0 * width);
            let detail = Detail { merge_distance: joined, beside, colour: ALIKE, screen };
            detail.seen(line.iter().copied(), &mut self.kept);
            for (to, from) in self.kept.iter().enumerate() {
                line[to] = line[*from as usize];
            }
            line.truncate(self.kept.len());
        }
        match line[..] {
            [] => {}
            // The line is so small on the screen that it is only a point.
            [(at, color)] => self.disc(at, 0.5 * width, color),
            _ => self.around(&line, width),
        }
        self.line = line;
    }

    fn around(&mut self, line: &[(Pos2, Color32)], width: f32) {
        let first = self.mesh.vertices.len() as u32;
        let count = line.len();
        let rows = if self.soft > 0.0 { 4 } else { 2 };
        self.mesh.vertices.reserve(count * rows);
        self.mesh.indices.reserve(count * 6 * (rows - 1));
        let direction = |from: Pos2, to: Pos2| unit(to - from);
        let mut before = direction(line[count - 1].0, line[0].0);
        let next = line[1..].iter().chain([&line[0]]);
        for ((at, color), (next, _)) in line.iter().zip(next) {
            let after = direction(*at, *next);
            // The corners are along the bisector of the angle between both edges. Their distance keeps the width of the band.
            let sum = Vec2::new(-before.y - after.y, before.x + after.x);
            let square = sum.length_sq();
            let side = if square > 4.0 / (MOST_MITRE * MOST_MITRE) {
                sum * (2.0 / square)
            } else {
                Vec2::new(-after.y, after.x)
            };
            self.across(*at, side, width, *color);
            before = after;
        }
        for k in 0..count {
            self.band(first, k as u32, ((k + 1) % count) as u32);
        }
    }

    /// Adds a small filled circle.
    pub(crate) fn disc(&mut self, at: Pos2, radius: f32, color: Color32) {
        let first = self.mesh.vertices.len() as u32;
        let count: u32 = if self.soft > 0.0 { 10 } else { 4 };
        let inner = if self.soft > 0.0 { (radius - 0.5 * self.soft).max(0.2) } else { radius };
        self.corner(at, color);
        for k in 0..count {
            let direction = Vec2::angled(std::f32::consts::TAU * k as f32 / count as f32);
            self.corner(at + direction * inner, color);
            if self.soft > 0.0 {
                self.corner(at + direction * (radius + 0.5 * self.soft), Color32::TRANSPARENT);
            }
        }
        let rows = if self.soft > 0.0 { 2 } else { 1 };
        for k in 0..count {
            let [a, b] = [k, (k + 1) % count].map(|k| first + 1 + rows * k);
            self.mesh.indices.extend([first, a, b]);
            if rows == 2 {
                self.mesh.indices.extend([a, a + 1, b, b, a + 1, b + 1]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The total area of the triangles of a mesh, without those that are completely transparent.
    fn covered(mesh: &Mesh) -> f32 {
        let corner = |k: &u32| mesh.vertices[*k as usize].pos;
        let triangles = mesh.indices.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]);
        triangles.map(|[a, b, c]| 0.5 * ((b - a).x * (c - a).y - (b - a).y * (c - a).x).abs()).sum()
    }

    fn circle(count: usize, radius: f32) -> impl Iterator<Item = (Pos2, Color32)> {
        let at = move |k: usize| Vec2::angled(std::f32::consts::TAU * k as f32 / count as f32) * radius;
        (0..count).map(move |k| (Pos2::new(100.0, 100.0) + at(k), Color32::RED))
    }

    #[test]
    fn a_ring_covers_its_length_times_its_width_and_is_valid() {
        for soft in [0.0, 1.0] {
            let mut brush = Brush::default();
            brush.begin(soft, Rect::EVERYTHING);
            brush.ring(circle(200, 50.0), 4.0);
            assert!(brush.mesh.is_valid());
            let wanted = std::f32::consts::TAU * 50.0 * (4.0 + soft);
            let found = covered(&brush.mesh);
            assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
        }
    }

    #[test]
    fn points_that_the_screen_cannot_tell_apart_cost_nothing() {
        let mut brush = Brush::default();
        brush.begin(1.0, Rect::EVERYTHING);
        brush.ring(circle(100_000, 50.0), 2.0);
        let rough = 4 * 200;
        assert!(brush.mesh.vertices.len() < rough, "{}", brush.mesh.vertices.len());
        assert!((covered(&brush.mesh) / (std::f32::consts::TAU * 50.0 * 3.0) - 1.0).abs() < 1e-2);
    }

    #[test]
    fn corners_however_sharp_and_points_on_one_another_give_finite_triangles() {
        let mut brush = Brush::default();
        brush.begin(1.0, Rect::EVERYTHING);
        let at = |x: f32, y: f32| (Pos2::new(x, y), Color32::RED);
        brush.ring([at(0.0, 0.0), at(10.0, 0.0), at(0.0, 0.001), at(0.0, 0.0), at(0.0, 0.0)].into_iter(), 2.0);
        brush.ring([at(5.0, 5.0), at(5.0, 5.0)].into_iter(), 2.0);
        brush.line([Pos2::ZERO, Pos2::ZERO], 2.0, [Color32::RED; 2]);
        assert!(brush.mesh.is_valid() && !brush.mesh.is_empty());
        let near = |v: &Vertex| v.pos.x.abs() < 20.0 && v.pos.y.abs() < 20.0;
        assert!(brush.mesh.vertices.iter().all(near), "{:?}", brush.mesh.vertices);
    }

    #[test]
    fn the_arrays_of_a_picture_that_nobody_holds_any_more_are_used_again() {
        let mut brush = Brush::default();
        brush.begin(1.0, Rect::EVERYTHING);
        brush.ring(circle(64, 50.0), 2.0);
        let context = egui::Context::default();
        let painter = Painter::new(context, egui::LayerId::debug(), egui::Rect::EVERYTHING);
        let room = brush.mesh.vertices.capacity();
        brush.end(&painter);
        assert_eq!(brush.mesh.vertices.capacity(), 0);
        drop(painter);
        brush.begin(1.0, Rect::EVERYTHING);
        assert!(brush.mesh.vertices.is_empty() && brush.mesh.vertices.capacity() <= room);
    }
}
