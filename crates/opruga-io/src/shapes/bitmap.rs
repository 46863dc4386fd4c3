//! Pictures: contours along which a quantity of the pixels crosses a threshold.
//!
//! Values belong to the centres of pixels. Between centres they are linear along the grid lines, so contours are finer than pixels (marching
//! squares). If two opposite corners of a square are inside, their mean decides whether they are connected. Everything outside the picture counts as
//! outside.

use super::curves::Curves;
use super::drawing::Drawing;
use super::drawing_errors::LetterError;
use crate::budget::{LimitHint, OUTLINES, PIXELS, POINTS};
use crate::problem::{SceneError, visible};
use opruga_core::spec::Values;
use opruga_math::message::Setting;

/// Reads a PNG picture.
///
/// # Errors
/// `png.syntax`, `limit.pixels` before the pixels are read, `limit.outlines`, `limit.points`, `shape.no_area` if no pixel is inside.
pub(super) fn read<'a>(bytes: &[u8], shape: &Values) -> Result<Drawing<'a>, SceneError> {
    let inside = shape.text("inside").unwrap_or("dark");
    let threshold = shape.number("threshold").unwrap_or(0.5);
    let mut lines = Lines::new(threshold);
    let most = pixels(bytes, inside, |row| lines.row(row))?;
    let mut curves = Curves::default();
    let (contours, points) = lines.contours(&mut curves);
    OUTLINES.check(contours).and(POINTS.check(points)).map_err(|e| e.advice(LimitHint::Picture))?;
    if f64::from(most) <= threshold {
        let (inside, most) = (inside.to_string(), format!("{most:.3}"));
        let [lower, choice] = ["threshold", "inside"].map(Setting::named);
        return Err(SceneError::of(LetterError::NoPixel { inside, most, threshold, lower, choice }));
    }
    let (spans, painted, rules, notices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    Ok(Drawing { curves, y_down: true, source: None, spans, painted, rules, notices })
}

/// Passes on the values of the pixels, from 0 to 1, row by row, with a border of zeros on all sides; returns the largest value.
fn pixels(
    bytes: &[u8],
    inside: &str,
    mut take: impl FnMut(&[f32]) -> Result<(), SceneError>,
) -> Result<f32, SceneError> {
    let refuse = |e: png::DecodingError| {
        SceneError::of(LetterError::Png { reason: visible(&e.to_string()), bytes: bytes.len() })
    };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    decoder.set_limits(png::Limits { bytes: 1 << 30 });
    let mut reader = decoder.read_info().map_err(refuse)?;
    let (w, h) = (reader.info().width, reader.info().height);
    PIXELS.check(u64::from(w) * u64::from(h)).map_err(|e| e.value(format!("{w}×{h}")))?;
    let samples = reader.output_color_type().0.samples();
    let width = w as usize + 2;
    let (mut values, mut most) = (vec![0.0f32; width], 0.0f32);
    take(&values)?;
    let mut row = |data: &[u8]| {
        for (value, pixel) in values[1..].iter_mut().zip(data.chunks_exact(samples)).take(w as usize) {
            let part = |k: usize| f32::from(pixel.get(k).copied().unwrap_or(255)) / 255.0;
            // Luma of ITU-R BT.601, on a white background for dark shapes and on a black one for bright shapes.
            let (luma, alpha) = match samples {
                1 => (part(0), 1.0),
                2 => (part(0), part(1)),
                3 => (0.299 * part(0) + 0.587 * part(1) + 0.114 * part(2), 1.0),
                _ => (0.299 * part(0) + 0.587 * part(1) + 0.114 * part(2), part(3)),
            };
            *value = match inside {
                "opaque" => alpha,
                "bright" => luma * alpha,
                _ => (1.0 - luma) * alpha,
            };
            most = if *value > most { *value } else { most };
        }
        take(&values)
    };
    if reader.info().interlaced {
        // The rows of interlaced pictures come in seven passes, so all of them must be in memory.
        let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
        let info = reader.next_frame(&mut data).map_err(refuse)?;
        data.chunks_exact(info.line_size).take(h as usize).try_for_each(&mut row)?;
    } else {
        for _ in 0..h {
            let Some(data) = reader.next_row().map_err(refuse)? else { break };
            row(data.data())?;
        }
    }
    take(&vec![0.0; width])?;
    Ok(most)
}

/// Contours, which are built while rows are read: the steps from one grid line to the next, with their points.
struct Lines {
    threshold: f64,
    /// The previous row, and the number of rows so far.
    above: Vec<f32>,
    rows: usize,
    /// The grid line at which the step starts, the grid line at which it ends, and the point where the contour crosses the first of them.
    steps: Vec<(u64, u64, [f64; 2])>,
}

impl Lines {
    fn new(threshold: f64) -> Lines {
        Lines { threshold, above: Vec::new(), rows: 0, steps: Vec::new() }
    }

    /// Adds the next row.
    fn row(&mut self, below: &[f32]) -> Result<(), SceneError> {
        if self.rows > 0 {
            let above = std::mem::take(&mut self.above);
            self.squares(&above, below);
            self.above = above;
        }
        self.above.clear();
        self.above.extend(below);
        self.rows += 1;
        // A contour has at most one step on every side of a pixel.
        POINTS.check(self.steps.len() as u64)
    }

    /// The squares between two rows of pixels. The inside is to the left of each step if y points upwards.
    fn squares(&mut self, above: &[f32], below: &[f32]) {
        let (w, y, threshold) = (above.len(), self.rows - 1, self.threshold);
        let inside = |value: f32| f64::from(value) > threshold;
        // Numbers of grid lines: 2·corner for the line to the right of a corner, 2·corner + 1 for the line below it.
        let line = |x: usize, y: usize, down: usize| 2 * (y * w + x) as u64 + down as u64;
        let crossing = |a: f32, b: f32| (threshold - f64::from(a)) / (f64::from(b) - f64::from(a));
        for x in 0..w - 1 {
            let values = [above[x], above[x + 1], below[x + 1], below[x]];
            // A border of zeros must be outside, whatever the threshold is.
            let code = values.iter().enumerate().map(|(k, value)| usize::from(inside(*value)) << k).sum::<usize>();
            if code == 0 || code == 15 {
                continue;
            }
            let (top, bottom, left, right) = (line(x, y, 0), line(x, y + 1, 0), line(x, y, 1), line(x + 1, y, 1));
            let mut go = |from: u64, to: u64| {
                let (fx, fy) = (x as f64, y as f64);
                let point = match from {
                    _ if from == top => [fx + crossing(values[0], values[1]), fy],
                    _ if from == bottom => [fx + crossing(values[3], values[2]), (y + 1) as f64],
                    _ if from == left => [fx, fy + crossing(values[0], values[3])],
                    _ => [(x + 1) as f64, fy + crossing(values[1], values[2])],
                };
                self.steps.push((from, to, point));
            };
            // Seen with y downwards, the inside is to the right of each step.
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
                _ => {
                    let [a, b, c, d] = values.map(f64::from);
                    let mean = 0.25 * (a + b + c + d);
                    let joined = mean > threshold;
                    // The second value is true if the two steps cut off corners 0 and 2, and false if they cut off corners 1 and 3.
                    let pairs = match (code == 5, (code == 5) != joined) {
                        (true, true) => [(left, top), (right, bottom)],
                        (false, true) => [(top, left), (bottom, right)],
                        (true, false) => [(left, bottom), (right, top)],
                        (false, false) => [(top, right), (bottom, left)],
                    };
                    pairs.into_iter().for_each(|(a, b)| go(a, b));
                }
            }
        }
    }

    /// Draws the closed contours, beginning with the lowest grid lines; returns the numbers of contours and points. If there are too many contours or
    /// points, they are only counted.
    fn contours(mut self, curves: &mut Curves) -> (u64, u64) {
        self.steps.sort_unstable_by_key(|step| step.0);
        let (mut contours, points) = (0, self.steps.len() as u64);
        let mut taken = vec![false; self.steps.len()];
        let mut contour = Vec::new();
        for start in 0..self.steps.len() {
            contour.clear();
            let mut at = start;
            while !std::mem::replace(&mut taken[at], true) {
                let (_, to, point) = self.steps[at];
                contour.push(point);
                let Ok(next) = self.steps.binary_search_by_key(&to, |step| step.0) else { break };
                at = next;
            }
            if contour.is_empty() {
                continue;
            }
            contours += 1;
            if contours <= OUTLINES.most {
                curves.polygon(&contour);
            }
        }
        (contours, points)
    }
}
