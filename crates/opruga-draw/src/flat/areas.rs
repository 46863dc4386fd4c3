//! Drawings that flat bodies carry.

use super::Projection;
use crate::canvas::{Canvas, paint};
use crate::picture::AreaPicture;
use tiny_skia::{Paint, Path, PathBuilder};

/// The width in pixels of the line around a painted area.
const HAIRLINE: f32 = 0.5;

/// The lines around an area as one path.
pub(super) fn path(area: &AreaPicture, projection: &Projection) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut from = 0;
    for &end in &area.ends {
        let line = &area.positions[from..end];
        from = end;
        // A line with a point that is not finite cannot be drawn.
        if line.len() < 3 || line.iter().flatten().any(|x| !x.is_finite()) {
            continue;
        }
        let mut last = [f32::INFINITY; 2];
        for (number, &position) in line.iter().enumerate() {
            let point = projection.pixel(position);
            if number == 0 {
                builder.move_to(point[0], point[1]);
            } else if (point[0] - last[0]).abs() + (point[1] - last[1]).abs() < 0.3 {
                // Points on the same pixel count as one.
                continue;
            } else {
                builder.line_to(point[0], point[1]);
            }
            last = point;
        }
        builder.close();
    }
    builder.finish()
}

/// The region that an area covers, as a path of its triangles, which all have the same orientation. If a body is folded, the lines around the area
/// overlap and would leave a hole. The triangles have no hole, because they cover the overlap twice.
fn covered(area: &AreaPicture, projection: &Projection) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for triangle in &area.triangles {
        let corners = triangle.map(|point| area.positions[point as usize]);
        if corners.iter().flatten().any(|x| !x.is_finite()) {
            continue;
        }
        let [a, mut b, mut c] = corners.map(|corner| projection.pixel(corner));
        if (b[0] - a[0]) * (c[1] - a[1]) < (c[0] - a[0]) * (b[1] - a[1]) {
            (b, c) = (c, b);
        }
        builder.move_to(a[0], a[1]);
        builder.line_to(b[0], b[1]);
        builder.line_to(c[0], c[1]);
        builder.close();
    }
    builder.finish()
}

/// Fills an area with a paint.
pub(super) fn fill(canvas: &mut Canvas, area: &AreaPicture, projection: &Projection, paint: &Paint) {
    match covered(area, projection) {
        Some(covered) => canvas.fill_all(&covered, paint),
        None => path(area, projection).iter().for_each(|path| canvas.fill(path, paint)),
    }
}

/// Fills the areas that have their own colour, one over another.
pub(super) fn draw(canvas: &mut Canvas, areas: &[AreaPicture], projection: &Projection) {
    for area in areas {
        if let Some([red, green, blue, opacity]) = area.colour {
            let paint = paint([red, green, blue], f64::from(opacity) / 255.0);
            fill(canvas, area, projection, &paint);
            // A thin line keeps an area visible even if it is squeezed to nothing.
            if let (255, Some(lines)) = (opacity, path(area, projection)) {
                canvas.stroke(&lines, HAIRLINE, &paint);
            }
        }
    }
}
