//! Obstacles in two dimensions.

use super::Projection;
use crate::canvas::{Canvas, paint, path_of};
use crate::colour::{OBSTACLE, OBSTACLE_EDGE};
use crate::picture::ColliderPicture;
use tiny_skia::{PathBuilder, Rect};

/// Draws one obstacle.
pub(crate) fn draw(canvas: &mut Canvas, collider: &ColliderPicture, projection: &Projection, unit: f32) {
    let edge = 1.6 * unit;
    match collider {
        ColliderPicture::HalfSpace { point, normal } => half_space(canvas, *point, *normal, projection, unit),
        ColliderPicture::Box { min, max, inside } => {
            let (a, b) = (projection.pixel(*min), projection.pixel(*max));
            let (top, bottom) = (a[1].min(b[1]), a[1].max(b[1]));
            let corners = [[a[0], top], [b[0], top], [b[0], bottom], [a[0], bottom]];
            if *inside { container(canvas, corners, projection, unit) } else { block(canvas, &corners, edge) }
        }
        ColliderPicture::Ball { center, radius } => {
            let center = projection.pixel(*center);
            if let Some(path) = PathBuilder::from_circle(center[0], center[1], (radius * projection.scale) as f32) {
                canvas.fill(&path, &paint(OBSTACLE, 1.0));
                canvas.stroke(&path, edge, &paint(OBSTACLE_EDGE, 1.0));
            }
        }
        ColliderPicture::Capsule { a, b, radius } => {
            let points = [projection.pixel(*a), projection.pixel(*b)];
            let width = (2.0 * radius * projection.scale) as f32;
            canvas.line(&points, width + edge, OBSTACLE_EDGE, 1.0);
            canvas.line(&points, (width - edge).max(0.1), OBSTACLE, 1.0);
        }
        ColliderPicture::Polygon(points) => {
            let points: Vec<[f32; 2]> = points.iter().map(|&point| projection.pixel(point)).collect();
            block(canvas, &points, edge);
        }
        ColliderPicture::Polyline(points) => {
            let points: Vec<[f32; 2]> = points.iter().map(|&point| projection.pixel(point)).collect();
            canvas.line(&points, 2.0 * edge, OBSTACLE_EDGE, 1.0);
        }
        ColliderPicture::Mesh { positions, triangles } => {
            for triangle in triangles {
                let corners = triangle.map(|node| positions.get(node as usize).copied().unwrap_or([0.0; 3]));
                let corners = corners.map(|corner| projection.pixel(corner));
                block(canvas, &corners, 0.5 * edge);
            }
        }
    }
}

/// Fills a polygon and draws its edge.
fn block(canvas: &mut Canvas, points: &[[f32; 2]], edge: f32) {
    if let Some(path) = path_of(points, true) {
        canvas.fill(&path, &paint(OBSTACLE, 1.0));
        canvas.stroke(&path, edge, &paint(OBSTACLE_EDGE, 1.0));
    }
}

/// Draws the walls of a container.
fn container(canvas: &mut Canvas, corners: [[f32; 2]; 4], projection: &Projection, unit: f32) {
    let mut builder = PathBuilder::new();
    if let Some(all) = Rect::from_xywh(-1.0, -1.0, projection.size[0] + 2.0, projection.size[1] + 2.0) {
        builder.push_rect(all);
    }
    builder.move_to(corners[0][0], corners[0][1]);
    corners[1..].iter().for_each(|corner| builder.line_to(corner[0], corner[1]));
    builder.close();
    if let Some(path) = builder.finish() {
        canvas.fill(&path, &paint(OBSTACLE, 1.0));
    }
    for side in 0..4 {
        hatched(canvas, corners[side], corners[(side + 1) % 4], unit);
    }
}

/// Draws a half space: a fill, a surface, and short strokes below the surface.
fn half_space(canvas: &mut Canvas, point: [f64; 3], normal: [f64; 3], projection: &Projection, unit: f32) {
    let length = (normal[0] * normal[0] + normal[1] * normal[1]).sqrt();
    if length <= 0.0 || !length.is_finite() {
        return;
    }
    let base = projection.pixel(point);
    let up = [(normal[0] / length) as f32, (projection.down * normal[1] / length) as f32];
    let [width, height] = projection.size;
    let screen = [[-2.0, -2.0], [width + 2.0, -2.0], [width + 2.0, height + 2.0], [-2.0, height + 2.0]];
    let height_of = |corner: [f32; 2]| (corner[0] - base[0]) * up[0] + (corner[1] - base[1]) * up[1];
    let mut solid = Vec::new();
    let mut surface = Vec::new();
    for side in 0..4 {
        let (from, to) = (screen[side], screen[(side + 1) % 4]);
        let (a, b) = (height_of(from), height_of(to));
        if a <= 0.0 {
            solid.push(from);
        }
        if (a <= 0.0) != (b <= 0.0) {
            let share = a / (a - b);
            let cut = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            solid.push(cut);
            surface.push(cut);
        }
    }
    canvas.polygon(&solid, OBSTACLE, 1.0);
    if let [first, second] = surface[..] {
        // The free side is to the right of the line, and the solid to its left.
        let turn = (second[0] - first[0]) * up[1] - (second[1] - first[1]) * up[0];
        let (from, to) = if turn > 0.0 { (first, second) } else { (second, first) };
        hatched(canvas, from, to, unit);
    }
}

/// Draws a line with short slanted strokes on its left side, as seen by someone who walks along the line.
fn hatched(canvas: &mut Canvas, from: [f32; 2], to: [f32; 2], unit: f32) {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = (along[0] * along[0] + along[1] * along[1]).sqrt();
    if !(length.is_finite() && length > 1.0) {
        return;
    }
    let direction = [along[0] / length, along[1] / length];
    let away = [direction[1], -direction[0]];
    let (step, depth) = (11.0 * unit, 9.0 * unit);
    let mut distance = 0.5 * step;
    let mut builder = PathBuilder::new();
    while distance < length {
        let start = [from[0] + distance * direction[0], from[1] + distance * direction[1]];
        builder.move_to(start[0], start[1]);
        builder.line_to(
            start[0] + depth * (away[0] - 0.8 * direction[0]),
            start[1] + depth * (away[1] - 0.8 * direction[1]),
        );
        distance += step;
    }
    if let Some(path) = builder.finish() {
        canvas.stroke(&path, 0.9 * unit, &paint(OBSTACLE_EDGE, 0.7));
    }
    canvas.line(&[from, to], 1.8 * unit, OBSTACLE_EDGE, 1.0);
}
