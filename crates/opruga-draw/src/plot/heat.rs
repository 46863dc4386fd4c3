//! Maps of a quantity over two others, as SVG text.

use super::scale::Scale;
use super::svg::{SIZE, Svg, TICK_SIZE, axis_text, document, hex, tick_count, width_of};
use super::{HeatMap, HeatPanel};
use crate::colour::{ColourMap, INK, SOFT_INK};
use crate::ticks::format_tick;
use std::collections::BTreeMap;

/// The size of the letters in cells.
const CELL_SIZE: f64 = 11.0;
/// The colour of a cell without a number.
const NOTHING: [u8; 3] = [226, 228, 232];
/// The space to the right of the cells, for the colour bar and its ticks.
const BAR_SPACE: f64 = 96.0;

/// Writes a map.
pub(super) fn write(map: &HeatMap) -> String {
    let labels = map.y.iter().map(|label| width_of(label, TICK_SIZE)).fold(20.0, f64::max);
    let (left, right) = (labels + 44.0, map.width - BAR_SPACE);
    let cell = [(right - left) / map.x.len() as f64, (300.0 / map.y.len() as f64).clamp(12.0, 40.0)];
    let height = cell[1] * map.y.len() as f64;
    let mut svg = Svg::default();
    let mut y = if map.title.is_empty() { 8.0 } else { 34.0 };
    if !map.title.is_empty() {
        svg.text(&map.title, [left, 25.0], 16.0, "start", INK, r#" font-weight="600""#);
    }
    let first = y + 28.0;
    for (index, panel) in map.panels.iter().enumerate() {
        svg.text(&axis_text(&panel.scale), [left, y + 18.0], SIZE, "start", INK, "");
        y += 28.0;
        draw_panel(&mut svg, map, panel, [left, y, right, y + height], cell);
        y += height;
        if index + 1 == map.panels.len() {
            column_labels(&mut svg, map, left, y, cell[0]);
        } else {
            y += 12.0;
        }
    }
    svg.text(&map.x_label, [0.5 * (left + right), y + 42.0], SIZE, "middle", INK, "");
    // All panels have the same rows, so they share one title for the rows, which is no longer than their total height.
    let middle = 0.5 * (first + y);
    let turn = format!(r#" transform="rotate(-90 16 {middle:.1})""#);
    let size = SIZE * ((y - first) / width_of(&map.y_label, SIZE).max(1.0)).min(1.0);
    svg.text(&map.y_label, [16.0, middle], size, "middle", INK, &turn);
    y += 56.0;
    let marks = [
        (map.panels.iter().any(|panel| !panel.failed.is_empty()), "× the run failed"),
        (map.panels.iter().any(|panel| cell_indices(map).any(|at| mark(panel, at) == Some("–"))), "– no such number"),
    ];
    let notes: Vec<&str> = marks.iter().filter(|(seen, _)| *seen).map(|(_, note)| *note).collect();
    if !notes.is_empty() {
        svg.text(&notes.join("    "), [left, y + 4.0], TICK_SIZE, "start", SOFT_INK, "");
        y += 18.0;
    }
    document(svg, map.width, y, &map.credit, left)
}

/// All cells, as column and row.
fn cell_indices(map: &HeatMap) -> impl Iterator<Item = [usize; 2]> {
    let (columns, rows) = (map.x.len(), map.y.len());
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row]))
}

/// The value of a cell, if it has one.
fn value(panel: &HeatPanel, [column, row]: [usize; 2]) -> Option<f64> {
    panel.values.get(row).and_then(|values| values.get(column)).copied().filter(|value| value.is_finite())
}

/// The mark in a cell without a value.
fn mark(panel: &HeatPanel, at: [usize; 2]) -> Option<&'static str> {
    match value(panel, at) {
        Some(_) => None,
        None if panel.failed.contains(&at) => Some("×"),
        None => Some("–"),
    }
}

/// The texts in the cells: numbers with three digits, or with more if cells of different colours would otherwise have the same text.
fn texts(map: &HeatMap, panel: &HeatPanel, scale: &Scale) -> Vec<([usize; 2], Option<String>)> {
    let cells: Vec<([usize; 2], Option<f64>)> = cell_indices(map).map(|at| (at, value(panel, at))).collect();
    let largest = cells.iter().filter_map(|cell| cell.1).fold(0.0, |most: f64, value| most.max(value.abs()));
    let step = |of: f64, digits: i32| 10_f64.powi((of.log10() + 1e-9).floor() as i32 + 1 - digits);
    let written = |digits: i32| -> Vec<Option<String>> {
        let text = |value: f64| match (scale.logarithmic, value == 0.0 || largest == 0.0) {
            (_, true) => "0".to_string(),
            (true, _) => format_tick(value, step(value.abs(), digits)),
            (false, _) => format_tick(value, step(largest, digits)),
        };
        cells.iter().map(|cell| cell.1.map(text)).collect()
    };
    let distinguishes = |texts: &[Option<String>]| {
        let mut seen: BTreeMap<&str, [u8; 3]> = BTreeMap::new();
        cells.iter().zip(texts).filter_map(|(cell, text)| Some((cell.1?, text.as_deref()?))).all(|(value, text)| {
            let colour = scale.fraction(value).map_or(NOTHING, |fraction| ColourMap::Viridis.colour(fraction));
            *seen.entry(text).or_insert(colour) == colour || alike(seen[text], colour)
        })
    };
    let texts = (3..9).map(written).find(|texts| distinguishes(texts)).unwrap_or_else(|| written(9));
    cells.into_iter().map(|cell| cell.0).zip(texts).collect()
}

/// Whether two colours are hard to distinguish.
fn alike(a: [u8; 3], b: [u8; 3]) -> bool {
    a.iter().zip(&b).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>() < 24
}

/// Draws the cells, the labels of the rows and the colour bar.
fn draw_panel(svg: &mut Svg, map: &HeatMap, panel: &HeatPanel, area: [f64; 4], cell: [f64; 2]) {
    let [left, top, right, bottom] = area;
    let scale = Scale::fit(&panel.scale, cell_indices(map).filter_map(|at| value(panel, at)), 0.0);
    let texts = texts(map, panel, &scale);
    let widest = texts.iter().flat_map(|(_, text)| text).map(|text| width_of(text, CELL_SIZE)).fold(0.0, f64::max);
    let readable = widest + 4.0 < cell[0] && cell[1] > 15.0;
    for (at, text) in texts {
        // The first row is the lowest.
        let corner = [left + at[0] as f64 * cell[0], bottom - (at[1] + 1) as f64 * cell[1]];
        let colour = value(panel, at).and_then(|value| scale.fraction(value));
        let colour = colour.map_or(NOTHING, |fraction| ColourMap::Viridis.colour(fraction));
        rectangle(svg, corner, cell, colour);
        let text = mark(panel, at).map(String::from).or(text.filter(|_| readable));
        let middle = [corner[0] + 0.5 * cell[0], corner[1] + 0.5 * cell[1] + 4.0];
        if let Some(text) = text {
            svg.text(&text, middle, CELL_SIZE, "middle", ink_on(colour), "");
        }
    }
    let every = (15.0 / cell[1]).ceil() as usize;
    for (row, label) in map.y.iter().enumerate().step_by(every.max(1)) {
        let middle = bottom - (row as f64 + 0.5) * cell[1];
        svg.text(label, [left - 9.0, middle + 4.2], TICK_SIZE, "end", INK, "");
    }
    if cell_indices(map).any(|at| value(panel, at).is_some()) {
        colour_bar(svg, &scale, [right + 14.0, top, right + 30.0, bottom]);
    }
}

/// Draws the colours of a scale from low to high, with ticks at their right.
fn colour_bar(svg: &mut Svg, scale: &Scale, [left, top, right, bottom]: [f64; 4]) {
    let strips = 64;
    let strip = (bottom - top) / f64::from(strips);
    for number in 0..strips {
        let colour = ColourMap::Viridis.colour((f64::from(number) + 0.5) / f64::from(strips));
        // Each strip overlaps the one above it, so that no seam is visible.
        let reach = if number + 1 < strips { 0.6 } else { 0.0 };
        let corner = [left, bottom - f64::from(number + 1) * strip - reach];
        rectangle(svg, corner, [right - left, strip + reach], colour);
    }
    for tick in scale.ticks(tick_count(bottom - top)) {
        if let Some(fraction) = scale.fraction(tick.value).filter(|_| !tick.label.is_empty()) {
            let y = bottom - fraction * (bottom - top);
            svg.line([right, y, right + 5.0, y], SOFT_INK, 1.0, "");
            svg.text(&tick.label, [right + 9.0, y + 4.2], TICK_SIZE, "start", INK, "");
        }
    }
}

/// Writes the labels of the columns, as many as fit.
fn column_labels(svg: &mut Svg, map: &HeatMap, left: f64, y: f64, cell: f64) {
    let widest = map.x.iter().map(|label| width_of(label, TICK_SIZE)).fold(1.0, f64::max);
    let every = ((widest + 8.0) / cell).ceil().max(1.0) as usize;
    for (column, label) in map.x.iter().enumerate().step_by(every) {
        let middle = left + (column as f64 + 0.5) * cell;
        svg.text(label, [middle, y + 18.0], TICK_SIZE, "middle", INK, "");
    }
}

/// Draws a rectangle without an outline.
fn rectangle(svg: &mut Svg, [x, y]: [f64; 2], [width, height]: [f64; 2], colour: [u8; 3]) {
    let colour = hex(colour);
    svg.add(format_args!(
        r#"<rect x="{x:.2}" y="{y:.2}" width="{width:.2}" height="{height:.2}" fill="{colour}" shape-rendering="crispEdges"/>"#
    ));
}

/// The colour of letters on a background colour: light on dark, dark on light.
fn ink_on([red, green, blue]: [u8; 3]) -> [u8; 3] {
    let light = 0.2126 * f64::from(red) + 0.7152 * f64::from(green) + 0.0722 * f64::from(blue);
    if light < 130.0 { [255; 3] } else { INK }
}

#[cfg(test)]
mod tests {
    use super::super::Axis;
    use super::*;

    fn map() -> HeatMap {
        HeatMap {
            title: "a < b".into(),
            x_label: "x".into(),
            x: vec!["1".into(), "2".into(), "3".into()],
            y_label: "y".into(),
            y: vec!["low".into(), "high".into()],
            panels: vec![HeatPanel {
                scale: Axis::linear("height", "m"),
                values: vec![vec![1.0, 2.0, 3.0], vec![4.0, f64::NAN, f64::NAN]],
                failed: vec![[1, 1]],
            }],
            ..HeatMap::default()
        }
    }

    #[test]
    fn the_least_value_is_violet_the_largest_yellow_and_the_first_row_below() {
        let text = map().to_svg().expect("a map");
        let cell = |colour: &str| {
            let rect = text.lines().find(|l| l.contains("<rect x") && l.contains(colour)).expect("a cell");
            let of = |name: &str| -> f64 {
                let from = rect.find(&format!(" {name}=\"")).expect("an attribute") + name.len() + 3;
                rect[from..].split('"').next().expect("a number").parse().expect("a number")
            };
            [of("x"), of("y")]
        };
        let (least, largest) = (cell("#440154"), cell("#fde725"));
        assert_eq!(least[0], largest[0], "both stand in the first column");
        assert!(least[1] > largest[1], "SVG counts y downwards");
    }

    #[test]
    fn cells_without_a_number_say_why() {
        let text = map().to_svg().expect("a map");
        assert_eq!(text.matches(">×<").count(), 1);
        assert_eq!(text.matches(">–<").count(), 1);
        assert!(text.contains("× the run failed") && text.contains("– no such number"));
        assert!(text.contains("a &lt; b") && text.contains("height [m]"));
        let mut whole = map();
        whole.panels[0] = HeatPanel { values: vec![vec![1.0; 3]; 2], failed: Vec::new(), ..whole.panels[0].clone() };
        assert!(!whole.to_svg().expect("a map").contains("failed"));
    }

    /// The texts in cells.
    fn cell_texts(map: &HeatMap) -> Vec<String> {
        let scale = Scale::fit(&map.panels[0].scale, cell_indices(map).filter_map(|at| value(&map.panels[0], at)), 0.0);
        texts(map, &map.panels[0], &scale).into_iter().filter_map(|(_, text)| text).collect()
    }

    #[test]
    fn cells_of_other_colours_bear_other_numbers() {
        let mut close = map();
        close.panels[0].values = vec![vec![2.5001, 2.5002, 2.5003], vec![2.5004, 2.5005, 2.5006]];
        close.panels[0].failed.clear();
        assert_eq!(cell_texts(&close), ["2.5001", "2.5002", "2.5003", "2.5004", "2.5005", "2.5006"]);
        close.panels[0].values = vec![vec![2.5; 3]; 2];
        assert_eq!(cell_texts(&close), ["2.50"; 6], "one colour, and no digits that say nothing");
        close.panels[0].values = vec![vec![1e-3, 1e-2, 0.1], vec![1.0, 10.0, 123.4]];
        close.panels[0].scale.logarithmic = true;
        assert_eq!(cell_texts(&close)[5], "123");
        assert!(cell_texts(&close)[0].starts_with("0.001"));
    }

    #[test]
    fn all_maps_together_have_one_title_of_their_rows() {
        let mut five = map();
        five.y_label = "a long word that is higher than one map".into();
        five.panels = vec![five.panels[0].clone(); 5];
        let text = five.to_svg().expect("a map");
        assert_eq!(text.matches("a long word").count(), 1);
    }

    #[test]
    fn a_map_without_cells_is_refused() {
        assert!(HeatMap { x: Vec::new(), ..map() }.to_svg().is_err());
        assert!(HeatMap { panels: Vec::new(), ..map() }.to_svg().is_err());
    }
}
