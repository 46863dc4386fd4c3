//! Drawings that flat bodies carry.

use super::Projection;
use crate::canvas::{Canvas, paint};
use crate::picture::AreaPicture;
use tiny_skia::{Path, PathBuilder};

/// The lines around an area as one path.
pub(super) fn path(area: &AreaPicture, projection: &Projection) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut from = 0;
    for &end in &area.ends {
        let line = &area.positions[from..end];
        from = end;
        // A line with a broken node has no place.
        if line.len() < 3 || line.iter().flatten().any(|x| !x.is_finite()) {
            continue;
        }
        let mut last = [f32::INFINITY; 2];
        for (number, &position) in line.iter().enumerate() {
            let point = projection.pixel(position);
            if number == 0 {
                builder.move_to(point[0], point[1]);
            } else if (point[0] - last[0]).abs() + (point[1] - last[1]).abs() < 0.3 {
                // Points which fall on the same pixel are one.
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

/// Fills the areas that have a colour of their own, one over another.
pub(super) fn draw(canvas: &mut Canvas, areas: &[AreaPicture], projection: &Projection) {
    for area in areas {
        if let (Some([red, green, blue, opacity]), Some(path)) = (area.colour, path(area, projection)) {
            canvas.fill(&path, &paint([red, green, blue], f64::from(opacity) / 255.0));
        }
    }
}
