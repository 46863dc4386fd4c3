//! Fills triangles with colours that vary linearly between the corners.

use tiny_skia::{PixmapMut, PremultipliedColorU8};

/// A corner of a triangle: its pixel, and the fraction of the colour map for its scalar, from 0 to 1.
pub(crate) type Corner = ([f32; 2], f64);

/// Fills a triangle. The colours extend `reach` pixels beyond the edges of the triangle.
pub(crate) fn triangle(pixmap: &mut PixmapMut, corners: [Corner; 3], reach: f32, colour: &dyn Fn(f64) -> [u8; 3]) {
    let [a, b, c] = corners.map(|corner| corner.0);
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if !area.is_finite() || area.abs() < 1e-4 {
        return;
    }
    // The weight of a corner falls from 1 at the corner to 0 at the opposite side.
    let height = |p: [f32; 2], q: [f32; 2]| ((q[0] - p[0]).powi(2) + (q[1] - p[1]).powi(2)).sqrt() / area.abs();
    let slack = [height(b, c) * reach, height(c, a) * reach, height(a, b) * reach];
    let span = |axis: usize, limit: u32| {
        let low = a[axis].min(b[axis]).min(c[axis]) - reach;
        let high = a[axis].max(b[axis]).max(c[axis]) + reach;
        (low.floor().max(0.0) as u32, (high.ceil().max(0.0) as u32).min(limit))
    };
    let (width, limit) = (pixmap.width(), pixmap.height());
    let ((left, right), (top, bottom)) = (span(0, width), span(1, limit));
    let pixels = pixmap.pixels_mut();
    for row in top..bottom {
        for column in left..right {
            let point = [column as f32 + 0.5, row as f32 + 0.5];
            let share = |p: [f32; 2], q: [f32; 2]| {
                ((q[0] - p[0]) * (point[1] - p[1]) - (point[0] - p[0]) * (q[1] - p[1])) / area
            };
            let shares = [share(b, c), share(c, a), share(a, b)];
            if (0..3).all(|corner| shares[corner] >= -slack[corner]) {
                let fraction: f64 = (0..3).map(|corner| f64::from(shares[corner]) * corners[corner].1).sum();
                let [red, green, blue] = colour(fraction);
                if let Some(pixel) = PremultipliedColorU8::from_rgba(red, green, blue, 255) {
                    pixels[(row * width + column) as usize] = pixel;
                }
            }
        }
    }
}
