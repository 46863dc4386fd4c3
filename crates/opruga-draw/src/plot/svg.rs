//! Writes plots as SVG text.

use super::scale::Scale;
use super::{Axis, Chart, Level, Line, Marker, Panel};
use crate::canvas::text_width;
use crate::colour::{INK, OKABE_ITO, SOFT_INK};
use std::fmt::Write;

/// The size of the letters of labels.
pub(super) const SIZE: f64 = 13.0;
/// The size of the letters of ticks.
pub(super) const TICK_SIZE: f64 = 12.0;
/// The height of a row of names above a panel.
const NAME_ROW: f64 = 20.0;
/// The free space between panels.
const GAP: f64 = 16.0;

/// The text of an SVG file.
#[derive(Default)]
pub(super) struct Svg {
    /// The text so far.
    text: String,
}

impl Svg {
    /// Adds an element.
    pub(super) fn add(&mut self, element: std::fmt::Arguments) {
        self.text.push_str("  ");
        let _ = self.text.write_fmt(element);
        self.text.push('\n');
    }

    /// Adds a line.
    pub(super) fn line(&mut self, [x1, y1, x2, y2]: [f64; 4], colour: [u8; 3], width: f64, dashes: &str) {
        let colour = hex(colour);
        let dashes = if dashes.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dashes}""#) };
        self.add(format_args!(
            r#"<line x1="{x1:.1}" y1="{y1:.1}" x2="{x2:.1}" y2="{y2:.1}" stroke="{colour}" stroke-width="{width}"{dashes}/>"#
        ));
    }

    /// Adds a text.
    pub(super) fn text(&mut self, text: &str, [x, y]: [f64; 2], size: f64, anchor: &str, colour: [u8; 3], more: &str) {
        let colour = hex(colour);
        let text = escape(text);
        self.add(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" font-size="{size}" text-anchor="{anchor}" fill="{colour}"{more}>{text}</text>"#
        ));
    }
}

/// A colour in the notation of SVG.
pub(super) fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// A text in which the special characters of XML are escaped.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for sign in text.chars() {
        match sign {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&apos;"),
            sign if sign.is_control() => out.push(' '),
            sign => out.push(sign),
        }
    }
    out
}

/// The width of a text.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    f64::from(text_width(text, size as f32))
}

/// The label of an axis with its unit.
pub(super) fn axis_text(axis: &Axis) -> String {
    match (axis.label.is_empty(), axis.unit.is_empty()) {
        (_, true) => axis.label.clone(),
        (true, false) => format!("[{}]", axis.unit),
        (false, false) => format!("{} [{}]", axis.label, axis.unit),
    }
}

/// The colour of a line.
fn colour_of(line: &Line, index: usize) -> [u8; 3] {
    line.colour.unwrap_or(OKABE_ITO[index % OKABE_ITO.len()])
}

/// Writes a plot.
pub(crate) fn write(chart: &Chart) -> String {
    let points = chart.panels.iter().flat_map(|panel| &panel.lines).flat_map(|line| &line.points);
    let margin = if chart.x.logarithmic { 0.04 } else { 0.0 };
    let x = Scale::fit(&chart.x, points.map(|point| point[0]), margin);
    let scales: Vec<Scale> = chart.panels.iter().map(fit_panel).collect();
    let tick_width = |(panel, scale): (&Panel, &Scale)| {
        let ticks = scale.ticks(tick_count(panel.height));
        ticks.iter().map(|tick| width_of(&tick.label, TICK_SIZE)).fold(0.0, f64::max)
    };
    let left = chart.panels.iter().zip(&scales).map(tick_width).fold(20.0, f64::max) + 44.0;
    let right = chart.width - 22.0;
    let mut y = if chart.title.is_empty() { 14.0 } else { 40.0 };
    let mut svg = Svg::default();
    if !chart.title.is_empty() {
        svg.text(&chart.title, [left, 25.0], 16.0, "start", INK, r#" font-weight="600""#);
    }
    for (index, (panel, scale)) in chart.panels.iter().zip(&scales).enumerate() {
        let rows = names(&mut svg, panel, [left, right], y);
        y += rows as f64 * NAME_ROW + if rows > 0 { 4.0 } else { 0.0 };
        let area = [left, y, right, y + panel.height];
        let last = index + 1 == chart.panels.len();
        draw_panel(&mut svg, panel, [&x, scale], area, index, last);
        y += panel.height + if last { 0.0 } else { GAP };
    }
    svg.text(&axis_text(&chart.x), [0.5 * (left + right), y + 42.0], SIZE, "middle", INK, "");
    document(svg, chart.width, y + 56.0, &chart.credit, left)
}

/// Makes a complete SVG file: a white background, the drawing, and below it a credit, whose lines are no wider than the file.
pub(super) fn document(mut svg: Svg, width: f64, mut height: f64, credit: &str, left: f64) -> String {
    if !credit.is_empty() {
        let size = TICK_SIZE * ((width - left - 8.0) / width_of(credit, TICK_SIZE).max(1.0)).min(1.0);
        svg.text(credit, [left, height + 4.0], size, "start", SOFT_INK, "");
        height += 18.0;
    }
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"Inter, Helvetica, Arial, sans-serif\">\n  \
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n{}</svg>\n",
        svg.text
    )
}

/// The number of ticks that fit along a height.
pub(super) fn tick_count(height: f64) -> usize {
    (height / 42.0).clamp(2.0, 10.0) as usize
}

/// The scale along y of a panel.
fn fit_panel(panel: &Panel) -> Scale {
    let values = panel.lines.iter().flat_map(|line| &line.points).map(|point| point[1]);
    let bands = panel.lines.iter().flat_map(|line| &line.band).flat_map(|[_, low, high]| [*low, *high]);
    Scale::fit(&panel.y, values.chain(bands).chain(panel.levels.iter().map(|level| level.value)), 0.07)
}

/// Lists the names of the lines above a panel, and returns the number of rows.
fn names(svg: &mut Svg, panel: &Panel, [left, right]: [f64; 2], top: f64) -> usize {
    let (mut x, mut rows) = (left, 0);
    for (index, line) in panel.lines.iter().enumerate().filter(|(_, line)| !line.name.is_empty()) {
        let width = 28.0 + width_of(&line.name, SIZE) * 1.06 + 18.0;
        if rows == 0 || x + width > right + 18.0 {
            rows += 1;
            x = left;
        }
        let y = top + NAME_ROW * (rows as f64 - 0.35);
        let colour = colour_of(line, index);
        svg.line([x, y - 4.5, x + 22.0, y - 4.5], colour, 2.0, if line.dashed { "6 4" } else { "" });
        if let Some(marker) = line.marker {
            draw_marker(svg, marker, [x + 11.0, y - 4.5], colour);
        }
        svg.text(&line.name, [x + 28.0, y], SIZE, "start", INK, "");
        x += width;
    }
    rows
}

/// Draws the axes and the lines of a panel.
fn draw_panel(svg: &mut Svg, panel: &Panel, [x, y]: [&Scale; 2], area: [f64; 4], index: usize, last: bool) {
    let [left, top, right, bottom] = area;
    let grid = [232, 234, 238];
    let at_x = |fraction: f64| left + fraction * (right - left);
    let at_y = |fraction: f64| bottom - fraction * (bottom - top);
    for tick in x.ticks(((right - left) / 80.0) as usize) {
        let Some(pixel) = x.fraction(tick.value).map(at_x) else {
            continue;
        };
        if !tick.label.is_empty() {
            svg.line([pixel, top, pixel, bottom], grid, 1.0, "");
            if last {
                svg.text(&tick.label, [pixel, bottom + 20.0], TICK_SIZE, "middle", INK, "");
            }
        }
        let length = if tick.label.is_empty() { 3.0 } else { 5.0 };
        svg.line([pixel, bottom, pixel, bottom + length], SOFT_INK, 1.0, "");
    }
    for tick in y.ticks(tick_count(panel.height)) {
        let Some(pixel) = y.fraction(tick.value).map(at_y) else {
            continue;
        };
        if !tick.label.is_empty() {
            svg.line([left, pixel, right, pixel], grid, 1.0, "");
            svg.text(&tick.label, [left - 9.0, pixel + 4.2], TICK_SIZE, "end", INK, "");
        }
        let length = if tick.label.is_empty() { 3.0 } else { 5.0 };
        svg.line([left - length, pixel, left, pixel], SOFT_INK, 1.0, "");
    }
    let (width, height) = (right - left, bottom - top);
    svg.add(format_args!(
        r#"<clipPath id="panel-{index}"><rect x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"/></clipPath>"#
    ));
    for level in &panel.levels {
        if let Some(pixel) = y.fraction(level.value).map(at_y) {
            svg.line([left, pixel, right, pixel], SOFT_INK, 1.4, "7 5");
        }
    }
    for (number, line) in panel.lines.iter().enumerate().filter(|(_, line)| !line.band.is_empty()) {
        let edge = |end: usize| {
            let pixel_of = move |point: &[f64; 3]| Some([at_x(x.fraction(point[0])?), at_y(y.fraction(point[end])?)]);
            thinned(line.band.iter().map(pixel_of))
        };
        // The border of the band runs forward along the upper values and back along the lower ones.
        let around = edge(2).into_iter().flatten().chain(edge(1).into_iter().flatten().rev());
        let points: Vec<String> = around.map(|[x, y]| format!("{x:.1},{y:.1}")).collect();
        let (points, colour) = (points.join(" "), hex(colour_of(line, number)));
        svg.add(format_args!(
            r#"<polygon points="{points}" fill="{colour}" fill-opacity="0.22" clip-path="url(#panel-{index})"/>"#
        ));
    }
    for (number, line) in panel.lines.iter().enumerate() {
        let colour = colour_of(line, number);
        let pixels = line.points.iter().map(|point| Some([at_x(x.fraction(point[0])?), at_y(y.fraction(point[1])?)]));
        let path = path_text(pixels);
        if !path.is_empty() {
            let dashes = if line.dashed { r#" stroke-dasharray="6 4""# } else { "" };
            let colour = hex(colour);
            svg.add(format_args!(
                r#"<path d="{path}" fill="none" stroke="{colour}" stroke-width="1.8" stroke-linejoin="round" stroke-linecap="round"{dashes} clip-path="url(#panel-{index})"/>"#
            ));
        }
        if let Some(marker) = line.marker {
            for point in &line.points {
                if let (Some(px), Some(py)) = (x.fraction(point[0]), y.fraction(point[1]))
                    && (-1e-9..=1.0 + 1e-9).contains(&px)
                    && (-1e-9..=1.0 + 1e-9).contains(&py)
                {
                    draw_marker(svg, marker, [at_x(px), at_y(py)], colour);
                }
            }
        }
    }
    for level in &panel.levels {
        level_label(svg, panel, level, [x, y], area);
    }
    svg.line([left, top, left, bottom], SOFT_INK, 1.0, "");
    svg.line([left, bottom, right, bottom], SOFT_INK, 1.0, "");
    let middle = 0.5 * (top + bottom);
    let turn = format!(r#" transform="rotate(-90 16 {middle:.1})""#);
    svg.text(&axis_text(&panel.y), [16.0, middle], SIZE, "middle", INK, &turn);
}

/// Writes the meaning of a level above or below its line, at the end of the line that is farthest from the other lines of the panel.
fn level_label(svg: &mut Svg, panel: &Panel, level: &Level, [x, y]: [&Scale; 2], area: [f64; 4]) {
    let [left, top, right, bottom] = area;
    let Some(fraction) = y.fraction(level.value) else { return };
    let line = bottom - fraction * (bottom - top);
    let width = width_of(&level.label, TICK_SIZE);
    let points = panel.lines.iter().flat_map(|line| &line.points);
    let pixels: Vec<[f64; 2]> = points
        .filter_map(|point| {
            Some([left + x.fraction(point[0])? * (right - left), bottom - y.fraction(point[1])? * (bottom - top)])
        })
        .collect();
    let candidates = [(true, -11.0), (true, 11.0), (false, -11.0), (false, 11.0)].map(|(at_end, shift)| {
        let middle = [if at_end { right - 6.0 - 0.5 * width } else { left + 8.0 + 0.5 * width }, line + shift];
        let gap = |point: &[f64; 2]| {
            let aside = ((point[0] - middle[0]).abs() - 0.5 * width).max(0.0);
            (aside * aside + (point[1] - middle[1]).powi(2)).sqrt()
        };
        let inside = if middle[1] < top + 6.0 || middle[1] > bottom - 6.0 { 0.0 } else { 1.0 };
        (middle, inside * pixels.iter().map(gap).fold(60.0, f64::min))
    });
    let best = candidates.into_iter().reduce(|best, next| if next.1 > best.1 + 1.0 { next } else { best });
    if let Some((middle, _)) = best {
        let halo = r##" stroke="#ffffff" stroke-width="4" stroke-linejoin="round" paint-order="stroke""##;
        svg.text(&level.label, [middle[0], middle[1] + 4.2], TICK_SIZE, "middle", SOFT_INK, halo);
    }
}

/// Draws the marker of a point.
fn draw_marker(svg: &mut Svg, marker: Marker, [x, y]: [f64; 2], colour: [u8; 3]) {
    let colour = hex(colour);
    let corners: &[[f64; 2]] = match marker {
        Marker::Circle => {
            return svg.add(format_args!(
                r##"<circle cx="{x:.1}" cy="{y:.1}" r="4" fill="{colour}" stroke="#ffffff" stroke-width="1"/>"##
            ));
        }
        Marker::Square => &[[-3.6, -3.6], [3.6, -3.6], [3.6, 3.6], [-3.6, 3.6]],
        Marker::Triangle => &[[0.0, -4.8], [4.6, 3.4], [-4.6, 3.4]],
        Marker::Diamond => &[[0.0, -5.0], [5.0, 0.0], [0.0, 5.0], [-5.0, 0.0]],
    };
    let points: Vec<String> =
        corners.iter().map(|corner| format!("{:.1},{:.1}", x + corner[0], y + corner[1])).collect();
    let points = points.join(" ");
    svg.add(format_args!(r##"<polygon points="{points}" fill="{colour}" stroke="#ffffff" stroke-width="1"/>"##));
}

/// Returns the pieces of a line between its gaps. Of the points in the same half pixel, only the ends and the extremes are kept. A line that
/// oscillates faster than pixels can show therefore still fills the full height of its oscillation.
fn thinned(points: impl Iterator<Item = Option<[f64; 2]>>) -> Vec<Vec<[f64; 2]>> {
    let mut pieces = vec![Vec::new()];
    let mut column: Vec<[f64; 2]> = Vec::new();
    let flush = |column: &mut Vec<[f64; 2]>, piece: &mut Vec<[f64; 2]>| {
        let last = column.len().saturating_sub(1);
        let by_height = |a: &usize, b: &usize| column[*a][1].total_cmp(&column[*b][1]);
        let low = (0..column.len()).min_by(by_height).unwrap_or(0);
        let high = (0..column.len()).max_by(by_height).unwrap_or(0);
        let mut kept = vec![0, low, high, last];
        kept.sort_unstable();
        kept.dedup();
        piece.extend(kept.iter().filter_map(|&index| column.get(index)).map(|p| p.map(|v| v.clamp(-1e5, 1e5))));
        column.clear();
    };
    for point in points {
        let current = pieces.len() - 1;
        match point {
            Some(point) => {
                if column.first().is_some_and(|first| (first[0] - point[0]).abs() > 0.5) {
                    flush(&mut column, &mut pieces[current]);
                }
                column.push(point);
            }
            None => {
                flush(&mut column, &mut pieces[current]);
                pieces.push(Vec::new());
            }
        }
    }
    let current = pieces.len() - 1;
    flush(&mut column, &mut pieces[current]);
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// The commands of a path.
fn path_text(points: impl Iterator<Item = Option<[f64; 2]>>) -> String {
    let mut path = String::new();
    for piece in thinned(points) {
        for (index, [x, y]) in piece.into_iter().enumerate() {
            let _ = write!(path, "{}{x:.1} {y:.1}", if index > 0 { "L" } else { "M" });
        }
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_credit_stands_on_a_line_of_its_own_within_the_plot() {
        let height =
            |text: &str| text.split("height=\"").nth(1).and_then(|rest| rest.split('"').next()?.parse::<f64>().ok());
        let line = Line { points: vec![[0.0, 0.0], [1.0, 1.0]], ..Line::default() };
        let bare = Chart { panels: vec![Panel { lines: vec![line], ..Panel::default() }], ..Chart::default() };
        let long = "Drawing: Twemoji, © Twitter, Inc and other contributors, CC-BY 4.0, ".repeat(3);
        for credit in ["Spot: Keenan Crane, public domain", &long] {
            let told = Chart { credit: credit.into(), ..bare.clone() }.to_svg().unwrap();
            let line = told.lines().find(|line| line.contains(credit)).expect("the credit");
            let size: f64 =
                line.split("font-size=\"").nth(1).and_then(|rest| rest.split('"').next()?.parse().ok()).unwrap();
            assert!(width_of(credit, size) < bare.width && size <= TICK_SIZE, "{line}");
            assert_eq!(height(&told), height(&bare.to_svg().unwrap()).map(|height| height + 18.0));
        }
    }

    #[test]
    fn names_are_escaped() {
        let line = Line { name: "a < b & \"c\"".to_string(), points: vec![[0.0, 0.0], [1.0, 1.0]], ..Line::default() };
        let chart = Chart { panels: vec![Panel { lines: vec![line], ..Panel::default() }], ..Chart::default() };
        let text = chart.to_svg().unwrap();
        assert!(text.contains("a &lt; b &amp; &quot;c&quot;"));
        assert!(text.starts_with("<svg ") && text.ends_with("</svg>\n"));
    }

    #[test]
    fn a_point_which_is_not_finite_makes_a_gap() {
        let points = [Some([0.0, 0.0]), Some([1.0, 2.0]), None, Some([3.0, 1.0])];
        assert_eq!(path_text(points.into_iter()), "M0.0 0.0L1.0 2.0M3.0 1.0");
    }

    #[test]
    fn long_lines_are_thinned() {
        let points = (0..100_000).map(|index| Some([f64::from(index) * 0.005, f64::from(index % 7)]));
        let commands = path_text(points).matches('L').count();
        assert!(commands > 1000 && commands < 5000, "{commands}");
    }

    #[test]
    fn a_fast_swing_fills_the_height_through_which_it_swings() {
        // The line oscillates forty times in each pixel.
        let swing =
            |index: u32| Some([f64::from(index) / 160.0, (f64::from(index) * std::f64::consts::FRAC_PI_2).sin()]);
        for piece in thinned((0..16_000).map(swing)) {
            for pair in piece.windows(6) {
                let heights = pair.iter().map(|point| point[1]);
                let (low, high) = heights.fold((1.0_f64, -1.0_f64), |(l, h), y| (l.min(y), h.max(y)));
                assert!(low < -0.99 && high > 0.99, "{low} {high}");
            }
        }
    }

    #[test]
    fn a_band_is_drawn_behind_its_line_and_seen_by_the_scale() {
        let line = Line {
            points: vec![[0.0, 1.0], [1.0, 1.0]],
            band: vec![[0.0, -5.0, 9.0], [1.0, 0.0, 2.0]],
            ..Line::default()
        };
        let panel = Panel { lines: vec![line], ..Panel::default() };
        assert!(fit_panel(&panel).low < -5.0 && fit_panel(&panel).high > 9.0);
        let text = Chart { panels: vec![panel], ..Chart::default() }.to_svg().unwrap();
        let (band, path) = (text.find("<polygon").expect("a band"), text.find("<path").expect("a line"));
        assert!(band < path);
    }
}
