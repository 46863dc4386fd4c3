//! Pictures: contours where a quantity of the pixels crosses a threshold.
//!
//! Values lie at the middles of pixels; between them they are linear along the lines of the grid, so contours are finer than pixels (marching squares).
//! Where two opposite corners of a square are inside, their mean says whether they are joined. Around the picture nothing is inside.

use super::curves::Curves;
use super::drawing::Drawing;
use crate::problem::{SceneError, visible};
use opruga_core::spec::Values;

/// The largest number of pixels.
const MOST_PIXELS: u64 = 1 << 26;

/// Reads a PNG picture.
///
/// # Errors
/// `png.syntax`, `shape.too_large` before the pixels are read, `shape.no_area` where none of them is inside.
pub(super) fn read<'a>(bytes: &[u8], shape: &Values) -> Result<Drawing<'a>, SceneError> {
    let inside = shape.text("inside").unwrap_or("dark");
    let grid = pixels(bytes, inside)?;
    let threshold = shape.number("threshold").unwrap_or(0.5);
    let mut curves = Curves::default();
    for contour in contours(&grid, threshold) {
        curves.polygon(&contour);
    }
    let most = grid.values.iter().fold(0.0, |most: f32, x| if *x > most { *x } else { most });
    if f64::from(most) <= threshold {
        let error = SceneError::new("shape.no_area", format!("no pixel is more {inside} than the threshold"));
        let error = error.value(format!("at most {most:.3}")).allowed(format!("pixels above {threshold}"));
        return Err(error.hint("take a smaller `threshold`, or another `inside`: dark, bright or opaque"));
    }
    let (places, painted, rules, notices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    Ok(Drawing { curves, y_down: true, source: None, places, painted, rules, notices })
}

/// Values from 0 to 1, with a border of zeros.
struct Grid {
    width: usize,
    height: usize,
    values: Vec<f32>,
}

fn pixels(bytes: &[u8], inside: &str) -> Result<Grid, SceneError> {
    let refuse = |e: png::DecodingError| {
        let error =
            SceneError::new("png.syntax", format!("this is no PNG that can be read: {}", visible(&e.to_string())));
        error.value(format!("{} bytes", bytes.len())).allowed("a picture in PNG")
    };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    decoder.set_limits(png::Limits { bytes: 1 << 30 });
    let mut reader = decoder.read_info().map_err(refuse)?;
    let (w, h) = (reader.info().width, reader.info().height);
    if u64::from(w) * u64::from(h) > MOST_PIXELS {
        let error = SceneError::new("shape.too_large", format!("the picture has {w}×{h} pixels"));
        return Err(error.value(format!("{w}×{h}")).allowed(format!("at most {MOST_PIXELS} pixels")));
    }
    let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
    let info = reader.next_frame(&mut data).map_err(refuse)?;
    let samples = info.color_type.samples();
    let (width, height) = (w as usize + 2, h as usize + 2);
    let mut grid = Grid { width, height, values: vec![0.0; width * height] };
    for (y, row) in data.chunks_exact(info.line_size).take(h as usize).enumerate() {
        for (x, pixel) in row.chunks_exact(samples).take(w as usize).enumerate() {
            let part = |k: usize| f32::from(pixel.get(k).copied().unwrap_or(255)) / 255.0;
            // Luma of ITU-R BT.601, over white for dark shapes and over black for bright ones.
            let (luma, alpha) = match samples {
                1 => (part(0), 1.0),
                2 => (part(0), part(1)),
                3 => (0.299 * part(0) + 0.587 * part(1) + 0.114 * part(2), 1.0),
                _ => (0.299 * part(0) + 0.587 * part(1) + 0.114 * part(2), part(3)),
            };
            grid.values[(y + 1) * width + x + 1] = match inside {
                "opaque" => alpha,
                "bright" => luma * alpha,
                _ => (1.0 - luma) * alpha,
            };
        }
    }
    Ok(grid)
}

/// Closed contours with the inside to their left, where y counts upwards.
fn contours(grid: &Grid, threshold: f64) -> Vec<Vec<[f64; 2]>> {
    let (w, h) = (grid.width, grid.height);
    let value = |x: usize, y: usize| f64::from(grid.values[y * w + x]);
    // A border of zeros must lie outside, whatever the threshold is.
    let is_in = |x: usize, y: usize| value(x, y) > threshold;
    // Lines of the grid by number: 2·corner to the right of it, 2·corner + 1 below it.
    let line = |x: usize, y: usize, down: usize| 2 * (y * w + x) + down;
    let mut next: Vec<u32> = vec![u32::MAX; 2 * w * h];
    for y in 0..h - 1 {
        for x in 0..w - 1 {
            let (top, bottom, left, right) = (line(x, y, 0), line(x, y + 1, 0), line(x, y, 1), line(x + 1, y, 1));
            let corners = [is_in(x, y), is_in(x + 1, y), is_in(x + 1, y + 1), is_in(x, y + 1)];
            let code = corners.iter().enumerate().map(|(k, inside)| usize::from(*inside) << k).sum::<usize>();
            let mut go = |from: usize, to: usize| next[from] = to as u32;
            // Seen with y down, the inside lies to the right of each step.
            match code {
                1 => go(left, top),
                2 => go(top, right),
                4 => go(right, bottom),
                8 => go(bottom, left),
                3 => go(left, right),
                6 => go(top, bottom),
                12 => go(right, left),
                9 => go(bottom, top),
                14 => go(top, left),
                13 => go(right, top),
                11 => go(bottom, right),
                7 => go(left, bottom),
                5 | 10 => {
                    let mean = 0.25 * (value(x, y) + value(x + 1, y) + value(x + 1, y + 1) + value(x, y + 1));
                    let joined = mean > threshold;
                    if (code == 5) != joined {
                        // Corners 0 and 2 apart, or corners 1 and 3 joined.
                        let pairs =
                            if code == 5 { [(left, top), (right, bottom)] } else { [(top, left), (bottom, right)] };
                        pairs.into_iter().for_each(|(a, b)| go(a, b));
                    } else {
                        let pairs =
                            if code == 5 { [(left, bottom), (right, top)] } else { [(top, right), (bottom, left)] };
                        pairs.into_iter().for_each(|(a, b)| go(a, b));
                    }
                }
                _ => {}
            }
        }
    }
    let place = |line: usize| {
        let (corner, down) = (line / 2, line % 2);
        let (x, y) = (corner % w, corner / w);
        let (a, b) = (value(x, y), if down == 1 { value(x, y + 1) } else { value(x + 1, y) });
        let t = (threshold - a) / (b - a);
        if down == 1 { [x as f64, y as f64 + t] } else { [x as f64 + t, y as f64] }
    };
    let mut found = Vec::new();
    for start in 0..next.len() {
        let mut contour = Vec::new();
        let mut at = start;
        while next[at] != u32::MAX {
            contour.push(place(at));
            at = std::mem::replace(&mut next[at], u32::MAX) as usize;
        }
        if !contour.is_empty() {
            found.push(contour);
        }
    }
    found
}
