//! The position of the scene within an image, and the text around it.

use crate::canvas::{Anchor, Canvas, text_width};
use crate::colour::{FRAME, INK, SOFT_INK};
use crate::marks::{arrow_colour, arrow_name, arrow_unit};
use crate::picture::{ArrowKind, ColliderPicture, Legend, Picture};
use crate::ticks::{format_tick, format_value, nice_length, nice_ticks};
use crate::view::View;

/// The size of an image, and the text around the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Style {
    /// The width in pixels.
    pub width: u32,
    /// The height in pixels.
    pub height: u32,
    /// The colour around and behind the scene.
    pub background: [u8; 3],
    /// Whether the title and the time are written above the scene.
    pub header: bool,
    /// Whether the length scale and the names of the arrows are written below the scene.
    pub footer: bool,
    /// Whether the legend of the colours is drawn at the right.
    pub legend: bool,
}

impl Default for Style {
    fn default() -> Style {
        Style { width: 800, height: 600, background: [255; 3], header: true, footer: true, legend: true }
    }
}

impl Style {
    /// The style of a film whose frames have the aspect ratio of the view, in a size suitable for viewers.
    pub fn film(view: &View, dimension: u8, longest: u32) -> Style {
        // The approximate space beside and above a scene.
        let (beside, above) = (90.0, 78.0);
        let (longest, aspect) = (f64::from(longest), view.aspect(dimension));
        let tall = ((longest - beside) * aspect + above).clamp(0.45 * longest, 0.75 * longest);
        let wide = ((tall - above) / aspect + beside).clamp(0.6 * longest, longest);
        // Videos store one colour for two pixels, so sides must be even.
        let even = |side: f64| 2 * (0.5 * side).round() as u32;
        Style { width: even(wide), height: even(tall), ..Style::default() }
    }
}

/// The position of each part of an image, in pixels.
pub(crate) struct Layout {
    /// The left, the top, the width and the height of the scene.
    pub(crate) scene: [u32; 4],
    /// The size of text and lines outside the scene, relative to an image of 600 pixels.
    pub(crate) unit: f32,
}

impl Layout {
    /// Divides an image into its parts.
    pub(crate) fn new(picture: &Picture, view: &View, style: &Style) -> Layout {
        let unit = Layout::unit(style);
        let margin = 14.0 * unit;
        let top = if style.header { 38.0 * unit } else { margin };
        let bottom = if style.footer { 40.0 * unit } else { margin };
        let bottom = bottom + Layout::credit_space(&picture.credit, unit);
        let right = margin + Layout::legend_space(picture, view, unit, style.legend);
        let (width, height) = (style.width as f32, style.height as f32);
        let scene = [margin, top, (width - margin - right).max(8.0), (height - top - bottom).max(8.0)];
        Layout { scene: scene.map(|value| value.round() as u32), unit }
    }

    /// The height of the credit line at the bottom, if there is one.
    pub(crate) fn credit_space(credit: &str, unit: f32) -> f32 {
        if credit.is_empty() { 0.0 } else { 18.0 * unit }
    }

    /// Writes the credit on its own line, in smaller letters if it would not fit.
    pub(crate) fn credit(&self, canvas: &mut Canvas, credit: &str, [left, base]: [f32; 2], space: f32) {
        let size = 11.5 * self.unit;
        let fits = (space / text_width(credit, size).max(1.0)).min(1.0);
        canvas.text(credit, [left, base], size * fits, Anchor::Start, SOFT_INK);
    }

    /// The width of the legend, if there is one and it is requested.
    pub(crate) fn legend_space(picture: &Picture, view: &View, unit: f32, wanted: bool) -> f32 {
        match view.legend(picture) {
            Some(legend) if wanted => legend_width(legend, view.range(picture), unit),
            _ => 0.0,
        }
    }

    /// The size of texts and lines, relative to an image of 600 pixels.
    pub(crate) fn unit(style: &Style) -> f32 {
        (style.width.min(style.height) as f32 / 600.0).clamp(0.7, 8.0)
    }

    /// Writes everything around the scene; `scale` is the number of pixels per metre.
    pub(crate) fn annotate(&self, canvas: &mut Canvas, picture: &Picture, view: &View, style: &Style, scale: f64) {
        let [left, top, width, height] = self.scene.map(|value| value as f32);
        let unit = self.unit;
        canvas.frame([left - 1.0, top - 1.0, width + 2.0, height + 2.0], FRAME);
        if style.header {
            let base = top - 12.0 * unit;
            let time = time_text(picture.time);
            canvas.text(&time, [left + width, base], 15.0 * unit, Anchor::End, INK);
            let space = width - text_width(&time, 15.0 * unit) - 20.0 * unit;
            let wish = 15.0 * unit;
            let size = wish * (space / text_width(&picture.title, wish).max(1.0)).clamp(0.5, 1.0);
            canvas.text(&picture.title, [left, base], size, Anchor::Start, INK);
        }
        if style.footer {
            let base = top + height + 26.0 * unit;
            self.foot(canvas, &[picture], view, [left, base], width, [0.24 * width, scale as f32]);
        }
        let base = style.height as f32 - 9.0 * unit;
        self.credit(canvas, &picture.credit, [left, base], style.width as f32 - 2.0 * left);
        if let (Some(legend), true) = (view.legend(picture), style.legend) {
            self.legend(canvas, legend, view, picture);
        }
    }

    /// Writes the line below a scene: the length scale at the left, the arrows at the right. `bar` contains the maximum length of the scale bar in
    /// pixels and the number of pixels per metre.
    pub(crate) fn foot(
        &self,
        canvas: &mut Canvas,
        pictures: &[&Picture],
        view: &View,
        [left, base]: [f32; 2],
        width: f32,
        [bar, scale]: [f32; 2],
    ) {
        let first = pictures[0];
        let floored = first.colliders.iter().any(|c| matches!(c, ColliderPicture::HalfSpace { .. }));
        let mut end = if first.dimension == 3 && floored {
            self.squares(canvas, [left, base], first, view)
        } else {
            // In space, the scale bar is valid at the centre of the scene, perpendicular to the line of sight.
            self.scale_bar(canvas, [left, base], f64::from(bar), f64::from(scale), &first.length_unit)
        };
        if view.y_down {
            let (start, size) = (end + 24.0 * self.unit, 13.0 * self.unit);
            let text = "y counts downwards";
            if start + text_width(text, size) < left + width {
                canvas.text(text, [start, base], size, Anchor::Start, SOFT_INK);
                end = start + text_width(text, size);
            }
        }
        self.arrow_scales(canvas, pictures, view, [end + 24.0 * self.unit, left + width], base, f64::from(scale));
    }

    /// Draws a bar of a round length, and returns the position where its text ends.
    fn scale_bar(&self, canvas: &mut Canvas, [left, base]: [f32; 2], most: f64, scale: f64, length_unit: &str) -> f32 {
        let unit = self.unit;
        let length = nice_length(most / scale);
        let bar = (length * scale) as f32;
        let middle = base - 5.0 * unit;
        let thick = (1.5 * unit).max(1.0);
        canvas.rectangle([left, middle - 0.5 * thick, bar, thick], INK, 1.0);
        for end in [left, left + bar - thick] {
            canvas.rectangle([end, middle - 4.0 * unit, thick, 8.0 * unit], INK, 1.0);
        }
        let text = length_text(length, length_unit);
        canvas.text(&text, [left + bar + 8.0 * unit, base], 14.0 * unit, Anchor::Start, INK);
        left + bar + 8.0 * unit + text_width(&text, 14.0 * unit)
    }

    /// Writes the size of the squares of a floor in three dimensions, and returns the position where the text ends.
    fn squares(&self, canvas: &mut Canvas, [left, base]: [f32; 2], picture: &Picture, view: &View) -> f32 {
        let size = 14.0 * self.unit;
        let text = format!("squares of {}", length_text(view.square(), &picture.length_unit));
        canvas.text(&text, [left, base], size, Anchor::Start, INK);
        left + text_width(&text, size)
    }

    /// Draws an arrow with a round value for each kind of arrow, beginning at the right end of the line.
    fn arrow_scales(
        &self,
        canvas: &mut Canvas,
        pictures: &[&Picture],
        view: &View,
        [from, to]: [f32; 2],
        base: f32,
        scale: f64,
    ) {
        let (unit, size) = (self.unit, 13.0 * self.unit);
        let length_unit = &pictures[0].length_unit;
        // For each kind of arrow: its text, the length of its arrow, and the width of both together, in pixels.
        let entries = |most: f32| -> Vec<(ArrowKind, String, f32, f32)> {
            let drawn = |kind| pictures.iter().any(|picture| picture.arrows.iter().any(|arrow| arrow.kind == kind));
            let entry = |(&kind, &longest): (&ArrowKind, &f64)| {
                let pixels = view.arrow_scale(kind) * scale;
                if !drawn(kind) || longest <= 0.0 || pixels <= 0.0 {
                    return None;
                }
                let value = nice_length((f64::from(most) / pixels).min(longest));
                let long = (value * pixels) as f32;
                let text = match kind {
                    // All normals have length one.
                    ArrowKind::Normal => arrow_name(kind).into(),
                    kind => {
                        format!("{} {} {}", arrow_name(kind), format_value(value), arrow_unit(kind, length_unit))
                    }
                };
                let wide = text_width(&text, size) + 8.0 * unit + long;
                (long >= 5.0 * unit).then_some((kind, text, long, wide))
            };
            view.longest.iter().rev().filter_map(entry).collect()
        };
        let gap = 20.0 * unit;
        let total_width =
            |entries: &[(ArrowKind, String, f32, f32)]| entries.iter().map(|(.., wide)| wide + gap).sum::<f32>();
        // The longest arrows with which all entries fit are chosen.
        let lengths = [70.0, 45.0, 30.0, 20.0].map(|most| most * unit);
        let whole = lengths.into_iter().map(entries).find(|entries| total_width(entries) - gap <= to - from);
        let mut end = to;
        for (kind, text, long, wide) in whole.unwrap_or_else(|| entries(lengths[3])) {
            let start = end - wide;
            if start < from {
                continue;
            }
            canvas.text(&text, [end, base], size, Anchor::End, INK);
            let middle = base - 4.5 * unit;
            let ends = [[start, middle], [start + long, middle]];
            crate::marks::arrow(canvas, ends, 1.8 * unit, arrow_colour(kind), false);
            end = start - gap;
        }
    }

    /// Draws the colour bar with its values.
    pub(crate) fn legend(&self, canvas: &mut Canvas, legend: &Legend, view: &View, picture: &Picture) {
        let unit = self.unit;
        let range = view.range(picture);
        let [left, top, width, height] = self.scene.map(|value| value as f32);
        let start = (left + width + 16.0 * unit).round();
        let size = 13.0 * unit;
        let lines = legend_lines(legend);
        for (index, line) in lines.iter().enumerate() {
            let base = top + 12.0 * unit + 17.0 * unit * index as f32;
            canvas.text(line, [start, base], size, Anchor::Start, INK);
        }
        let bar_top = (top + 17.0 * unit * lines.len() as f32 + 14.0 * unit).round();
        let bar = [start, bar_top, (14.0 * unit).round(), (top + height - bar_top).min(300.0 * unit).round()];
        let rows = bar[3] as u32;
        for row in 0..rows {
            let fraction = 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
            canvas.rectangle([bar[0], bar[1] + row as f32, bar[2], 1.0], legend.map.colour(fraction), 1.0);
        }
        if legend.range.is_none() {
            // A pointed end of the bar shows that a few scalars are beyond this end.
            let ends = [(bar[1] + bar[3], 1.0, 0.0), (bar[1], -1.0, 1.0)];
            for (&(end, outwards, fraction), _) in ends.iter().zip(view.strays).filter(|(_, strays)| *strays) {
                let tip = [bar[0] + 0.5 * bar[2], end + outwards * 7.0 * unit];
                let corners = [[bar[0], end], [bar[0] + bar[2], end], tip];
                canvas.polygon(&corners, legend.map.colour(fraction), 1.0);
            }
        }
        let ticks = nice_ticks(range[0], range[1], 5);
        let step = if ticks.len() > 1 { ticks[1] - ticks[0] } else { range[0].abs() };
        for tick in ticks {
            let y = (bar[1] + bar[3] * (1.0 - View::fraction(range, tick) as f32)).clamp(bar[1], bar[1] + bar[3] - 1.0);
            canvas.rectangle([bar[0] + bar[2], y.round(), (4.0 * unit).round(), 1.0], SOFT_INK, 1.0);
            let point = [bar[0] + bar[2] + 7.0 * unit, y + 4.5 * unit];
            canvas.text(&format_tick(tick, step), point, 12.0 * unit, Anchor::Start, INK);
        }
    }
}

/// The label and the unit of a legend, on one or two lines.
fn legend_lines(legend: &Legend) -> Vec<String> {
    let mut lines = vec![legend.label.clone()];
    if !legend.unit.is_empty() {
        lines.push(format!("[{}]", legend.unit));
    }
    lines
}

/// The width of a legend.
fn legend_width(legend: &Legend, range: [f64; 2], unit: f32) -> f32 {
    let ticks = nice_ticks(range[0], range[1], 5);
    let step = if ticks.len() > 1 { ticks[1] - ticks[0] } else { range[0].abs() };
    let values = ticks.iter().map(|&tick| 21.0 * unit + text_width(&format_tick(tick, step), 12.0 * unit));
    let lines = legend_lines(legend).into_iter().map(|line| text_width(&line, 13.0 * unit));
    values.chain(lines).fold(0.0, f32::max) + 16.0 * unit
}

/// A time as text, with three decimals.
fn time_text(time: f64) -> String {
    if !time.is_finite() {
        return String::new();
    }
    if time.abs() >= 100.0 { format!("t = {time:.1} s") } else { format!("t = {time:.3} s") }
}

/// Times as texts. All times have the number of decimals that the longest of them needs, but at most three.
pub(crate) fn time_texts(times: &[f64]) -> Vec<String> {
    let exact = |digits: i32| {
        let scale = 10_f64.powi(digits);
        times.iter().all(|time| (time * scale - (time * scale).round()).abs() < 1e-6 * scale)
    };
    let digits = (1..3).find(|&digits| exact(digits)).unwrap_or(3) as usize;
    times.iter().map(|time| format!("t = {time:.digits$} s")).collect()
}

/// A length as text. If the unit is the metre, small lengths are given in millimetres.
fn length_text(length: f64, unit: &str) -> String {
    if unit == "m" && length < 0.0099 {
        format!("{} mm", format_value(length * 1e3))
    } else {
        format!("{} {unit}", format_value(length))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_the_digits_they_need() {
        assert_eq!(time_texts(&[0.0, 0.95, 8.0]), ["t = 0.00 s", "t = 0.95 s", "t = 8.00 s"]);
        assert_eq!(time_texts(&[0.0, 1.776]), ["t = 0.000 s", "t = 1.776 s"]);
        assert_eq!(time_texts(&[2.0]), ["t = 2.0 s"]);
        assert_eq!((time_text(2.0).as_str(), time_text(f64::NAN).as_str()), ("t = 2.000 s", ""));
        assert_eq!(time_texts(&[1.0 / 3.0]), ["t = 0.333 s"]);
    }

    #[test]
    fn lengths_are_told_in_the_unit_of_the_scene() {
        assert_eq!(length_text(0.005, "m"), "5 mm");
        assert_eq!(length_text(100.0, "px"), "100 px");
        assert_eq!(length_text(0.001, "px"), "0.001 px");
    }
}
