//! A film strip: some frames of a run, side by side, with a common scale.

use crate::canvas::{Anchor, Canvas, text_width};
use crate::colour::INK;
use crate::error::{DrawError, Nothing};
use crate::image::Image;
use crate::layout::{Layout, time_texts};
use crate::picture::Picture;
use crate::view::View;

/// The size and the order of the panels of a film strip.
#[derive(Clone, Debug, PartialEq)]
pub struct StripStyle {
    /// The maximum width of the strip in pixels; a strip with few panels is narrower.
    pub width: u32,
    /// The number of panels in a row; if it is not given, it is chosen from the aspect ratio of the view.
    pub columns: Option<usize>,
    /// The ratio of height to width of a panel; if it is not given, that of the view.
    pub aspect: Option<f64>,
    /// The colour around and behind the scenes.
    pub background: [u8; 3],
    /// Whether the legend of the colours is drawn at the right.
    pub legend: bool,
}

impl Default for StripStyle {
    fn default() -> StripStyle {
        StripStyle { width: 1400, columns: None, aspect: None, background: [255; 3], legend: true }
    }
}

/// The maximum height of a panel, in pixels of a strip 1400 pixels wide.
const TALLEST: f32 = 560.0;

/// Selects up to `count` evenly spaced pictures, including the first and the last.
pub fn spread<T>(pictures: &[T], count: usize) -> Vec<&T> {
    let kept = count.min(pictures.len());
    (0..kept)
        .map(|index| {
            let last = pictures.len() - 1;
            &pictures[if kept == 1 { last } else { (index * last + (kept - 1) / 2) / (kept - 1) }]
        })
        .collect()
}

/// The ratio of height to width of a strip that suits readers best.
const BEST_SHAPE: f32 = 0.42;

/// The layout of the panels of a strip, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    /// The number of panels in a row.
    columns: usize,
    /// The number of rows.
    rows: usize,
    /// The width and the height of a panel.
    panel: [f32; 2],
    /// The free space between panels.
    gap: f32,
    /// The height of the text line below a panel.
    line: f32,
}

impl Grid {
    /// The grid of `count` panels in `columns` columns within a width.
    fn new(count: usize, columns: usize, aspect: f32, available_width: f32, unit: f32) -> Grid {
        let columns = columns.clamp(1, count.max(1));
        let rows = count.div_ceil(columns);
        // The number of columns is the smallest with which this number of rows is sufficient.
        let columns = count.div_ceil(rows.max(1)).max(1);
        let gap = (10.0 * unit).round();
        let wide = ((available_width - gap * (columns as f32 - 1.0)) / columns as f32).floor();
        // A few panels are kept small enough to be seen at once.
        let wide = wide.min((TALLEST * unit / aspect).floor());
        Grid { columns, rows, panel: [wide, (wide * aspect).round()], gap, line: (26.0 * unit).round() }
    }

    /// The width and the height of all panels with their text lines.
    fn size(&self) -> [f32; 2] {
        let (columns, rows) = (self.columns as f32, self.rows as f32);
        let wide = columns * (self.panel[0] + self.gap) - self.gap;
        [wide, rows * (self.panel[1] + self.line) + (rows - 1.0) * 0.4 * self.gap]
    }

    /// Returns the penalty of the grid. A good strip has a suitable shape, a complete last row, and bodies that are large enough. `body` is the
    /// larger side of a body as a fraction of the width of a panel.
    fn fault(&self, count: usize, available_width: f32, body: f32) -> f32 {
        let [wide, tall] = self.size();
        let empty = (self.columns * self.rows - count) as f32;
        let shape = (tall / (BEST_SHAPE * wide)).ln();
        let small = if body > 0.0 { (LARGE_ENOUGH / (body * self.panel[0]).max(1.0)).log2().max(0.0) } else { 0.0 };
        // Pages scroll vertically, so tall strips are easier to read than wide and low ones, up to a limit.
        let shape = shape.max(-2.0 * shape) * 0.5 + 1.5 * (shape - 0.8).max(0.0);
        shape + (available_width / wide).ln() + 0.2 * empty + SMALL_BODIES * small
    }

    /// The best grid for the given number of panels.
    fn best(count: usize, aspect: f32, available_width: f32, unit: f32, body: f32) -> Grid {
        let grids = (1..=6).map(|columns| Grid::new(count, columns, aspect, available_width, unit));
        let best = grids
            .min_by(|a, b| a.fault(count, available_width, body).total_cmp(&b.fault(count, available_width, body)));
        best.unwrap_or(Grid::new(count, 1, aspect, available_width, unit))
    }

    /// The upper left corner of a panel.
    fn corner(&self, index: usize, [left, top]: [f32; 2]) -> [f32; 2] {
        let (row, column) = (index / self.columns, index % self.columns);
        let down = row as f32 * (self.panel[1] + self.line + 0.4 * self.gap);
        [left + column as f32 * (self.panel[0] + self.gap), (top + down).round()]
    }
}

/// The minimum size in pixels of a body along its larger side, so that it is easy to see.
const LARGE_ENOUGH: f32 = 130.0;
/// The penalty of a strip whose bodies have half of the size `LARGE_ENOUGH`.
const SMALL_BODIES: f32 = 1.2;

/// The penalty for each panel by which a strip falls short of nine.
const MISSED: f32 = 0.12;

/// Returns the number of panels that gives the best strip of a view, at most `most`. This number is usually from nine to twelve, and smaller if the
/// bodies would otherwise be too small to be seen well.
pub fn best_count(view: &View, dimension: u8, most: usize) -> usize {
    let style = StripStyle::default();
    let (aspect, available_width) = (view.aspect(dimension) as f32, style.width as f32);
    let body = view.share_of_body(dimension) as f32;
    let fault = |count: usize| {
        // Strips with fewer than nine panels are penalised.
        let missed = MISSED * 9_usize.saturating_sub(count) as f32;
        Grid::best(count, aspect, available_width, 1.0, body).fault(count, available_width, body) + missed
    };
    (4..=12.min(most)).min_by(|a, b| fault(*a).total_cmp(&fault(*b))).unwrap_or(most)
}

/// Draws pictures side by side in rows, with a common view, length scale and legend, and the time below each.
pub fn strip(pictures: &[&Picture], view: &View, style: &StripStyle) -> Result<Image, DrawError> {
    let times: Vec<f64> = pictures.iter().map(|picture| picture.time).collect();
    // Pictures without a time are distinguished by their titles. The title of the first picture is written above all of them.
    let own =
        |picture: &&Picture| if picture.title == pictures[0].title { String::new() } else { picture.title.clone() };
    let moments = times.iter().all(|time| time.is_finite());
    let captions = if moments { time_texts(&times) } else { pictures.iter().map(own).collect() };
    captioned_strip(pictures, &captions, view, style)
}

/// Draws a strip with a given text below each picture.
pub fn captioned_strip(
    pictures: &[&Picture],
    captions: &[String],
    view: &View,
    style: &StripStyle,
) -> Result<Image, DrawError> {
    let first = pictures.first().ok_or(DrawError::Empty { nothing: Nothing::Picture })?;
    let unit = (style.width as f32 / 1400.0).clamp(0.6, 6.0);
    let margin = (16.0 * unit).round();
    let head = if first.title.is_empty() { margin } else { 44.0 * unit };
    let foot = 44.0 * unit + Layout::credit_space(&first.credit, unit);
    let legend = Layout::legend_space(first, view, unit, style.legend);
    let available_width = style.width as f32 - 2.0 * margin - legend;
    let aspect = style.aspect.unwrap_or_else(|| view.aspect(first.dimension)) as f32;
    let grid = match style.columns {
        Some(columns) => Grid::new(pictures.len(), columns, aspect, available_width, unit),
        None => Grid::best(pictures.len(), aspect, available_width, unit, view.share_of_body(first.dimension) as f32),
    };
    // Captions that are wider than their panels take several lines.
    let (mut grid, size, line) = (grid, 15.0 * unit, 18.0 * unit);
    let captions: Vec<Vec<String>> =
        captions.iter().take(pictures.len()).map(|text| lines_of(text, grid.panel[0], size)).collect();
    grid.line += line * captions.iter().map(|lines| lines.len().saturating_sub(1)).max().unwrap_or(0) as f32;
    let [panel, tall] = grid.panel;
    if panel < 8.0 {
        return Err(DrawError::Size { width: panel.max(0.0) as u32, height: 0 });
    }
    let [width, height] = grid.size();
    let title = 18.0 * unit;
    let needed = (width + legend).max(text_width(&first.title, title)).max(360.0 * unit);
    let whole = (needed + 2.0 * margin).ceil().min(style.width as f32);
    let mut image = Image::new(whole as u32, (head + height + foot).round() as u32, style.background)?;
    let mut scale = 1.0;
    for (index, picture) in pictures.iter().enumerate() {
        let (scene, found) = crate::scene(picture, view, style.background, [panel as u32, tall as u32], 0.9 * unit)?;
        let [left, top] = grid.corner(index, [margin, head]);
        image.paste(&scene, left as u32, top as u32);
        scale = found;
    }
    let mut canvas = Canvas::new(&mut image);
    for (index, lines) in captions.iter().enumerate() {
        let [left, top] = grid.corner(index, [margin, head]);
        canvas.frame([left - 1.0, top - 1.0, panel + 2.0, tall + 2.0], crate::colour::FRAME);
        for (number, text) in lines.iter().enumerate() {
            let point = [left + 0.5 * panel, top + tall + 19.0 * unit + line * number as f32];
            let fits = (panel + 0.8 * grid.gap) / text_width(text, size).max(1.0);
            canvas.text(text, point, size * fits.min(1.0), Anchor::Middle, INK);
        }
    }
    let fits = (whole - 2.0 * margin) / text_width(&first.title, title).max(1.0);
    canvas.text(&first.title, [margin, head - 16.0 * unit], title * fits.min(1.0), Anchor::Start, INK);
    let bottom = (head + height).round();
    let scene = [margin as u32, head as u32, width as u32, (bottom - head - grid.line) as u32];
    let layout = Layout { scene, unit };
    let bar = panel.max(120.0 * unit).min(0.45 * (whole - 2.0 * margin));
    let base = [margin, bottom + 26.0 * unit];
    layout.foot(&mut canvas, pictures, view, base, whole - 2.0 * margin, [0.48 * bar, scale as f32]);
    let last = [margin, head + height + foot - 12.0 * unit];
    layout.credit(&mut canvas, &first.credit, last, whole - 2.0 * margin);
    if let (Some(legend), true) = (view.legend(first), style.legend) {
        layout.legend(&mut canvas, legend, view, first);
    }
    Ok(image)
}

/// Breaks a text into lines that are no wider than a limit, unless a single word is wider.
fn lines_of(text: &str, width: f32, size: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if text_width(line, size) + text_width(" ", size) + text_width(word, size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_captions_take_several_lines() {
        let width = text_width("translation along", 15.0) + 1.0;
        let lines = lines_of("12: translation along (0.577, 0.577, 0.577)", width, 15.0);
        assert_eq!(lines.join(" "), "12: translation along (0.577, 0.577, 0.577)");
        assert!(lines.len() > 2 && lines.iter().all(|line| text_width(line, 15.0) <= width), "{lines:?}");
        assert_eq!(lines_of("t = 0.5 s", width, 15.0), ["t = 0.5 s"]);
        assert_eq!(lines_of("", width, 15.0), [""]);
    }

    #[test]
    fn nothing_is_cropped_at_the_border() {
        use crate::picture::{BodyPicture, Legend};
        for (dimension, size) in [(2, [1.0, 0.1]), (2, [1.0, 1.0]), (2, [0.1, 1.0]), (2, [7e-6, 9e-6]), (3, [2.0, 1.0])]
        {
            for count in [1, 2, 5, 10] {
                let positions = vec![[0.0; 3], [size[0], 0.0, 0.0], [size[0], size[1], 0.0]];
                let body = BodyPicture { scalar: vec![-123.456, 0.0, 1e5], positions, ..Default::default() };
                let legend = Legend { label: "strain".into(), unit: "%".into(), range: None, map: Default::default() };
                let picture = Picture {
                    dimension,
                    title: "a title".into(),
                    bodies: vec![body],
                    legend: Some(legend),
                    ..Default::default()
                };
                let view = View::fit([&picture]).expect("a view");
                let image = strip(&vec![&picture; count], &view, &StripStyle::default()).expect("a strip");
                let (width, height) = (image.width(), image.height());
                let mut border = (0..width)
                    .flat_map(|x| (0..4).map(move |y| [x, y]).chain((1..7).map(move |y| [x, height - y])))
                    .chain((0..height).flat_map(|y| (0..4).map(move |x| [x, y]).chain([[width - 1, y]])));
                let cut = border.find(|[x, y]| image.pixel(*x, *y) != [255; 3]);
                assert_eq!(cut, None, "{dimension} {size:?} {count} {width} {height}");
            }
        }
    }

    #[test]
    fn a_credit_stands_on_a_line_of_its_own_below_strips_and_in_every_frame_of_a_film() {
        use crate::picture::BodyPicture;
        let body = BodyPicture { positions: vec![[0.0; 3], [1.0, 1.0, 0.0]], ..Default::default() };
        let bare = Picture { bodies: vec![body], ..Default::default() };
        let credit = "Drawing: Twemoji, © Twitter, Inc and other contributors, CC-BY 4.0";
        let told = Picture { credit: credit.into(), ..bare.clone() };
        let view = View::fit([&bare]).expect("a view");
        for count in [1, 4, 10] {
            let strip =
                |picture: &Picture| strip(&vec![picture; count], &view, &StripStyle::default()).expect("a strip");
            let (without, with) = (strip(&bare), strip(&told));
            assert_eq!((with.width(), with.height()), (without.width(), without.height() + 18));
            let above = 4 * without.width() as usize * (without.height() as usize - 20);
            assert_eq!(with.pixels()[..above], without.pixels()[..above], "nothing else has moved");
            let inked = |image: &Image, from: u32| {
                let rows = from..image.height();
                rows.flat_map(|y| (0..image.width()).map(move |x| [x, y]))
                    .filter(|[x, y]| image.pixel(*x, *y)[0] < 200)
                    .count()
            };
            assert!(inked(&with, with.height() - 26) > 300 && inked(&without, without.height() - 8) == 0);
        }
        let style = crate::Style::film(&view, 2, 640);
        let film = |picture: &Picture| crate::draw(picture, &view, &style).expect("a frame");
        let (without, with) = (film(&bare), film(&told));
        assert_eq!((with.width(), with.height()), (without.width(), without.height()), "frames of one size");
        let last_rows = with.height() - 16..with.height();
        let written = |image: &Image| {
            let at = last_rows.clone().flat_map(|y| (0..image.width()).map(move |x| [x, y]));
            at.filter(|[x, y]| image.pixel(*x, *y)[0] < 200).count()
        };
        assert!(written(&with) > written(&without) + 150, "{} {}", written(&with), written(&without));
    }

    #[test]
    fn small_bodies_get_fewer_and_larger_panels() {
        use crate::picture::BodyPicture;
        // The number of panels, and the width of each.
        let crowd = |side: f64| {
            let body = |k: usize| {
                let [x, y] = [(k % 8) as f64, (k / 8) as f64];
                BodyPicture { positions: vec![[x, y, 0.0], [x + side, y + side, 0.0]], ..Default::default() }
            };
            let picture = Picture { bodies: (0..32).map(body).collect(), ..Default::default() };
            let view = View::fit([&picture]).expect("a view");
            let count = best_count(&view, 2, 200);
            let share = view.share_of_body(2) as f32;
            (count, Grid::best(count, view.aspect(2) as f32, 1400.0, 1.0, share).panel[0])
        };
        let (small, large) = (crowd(0.3), crowd(4.0));
        assert!(small.0 < large.0 && small.1 > 1.4 * large.1, "{small:?} {large:?}");
        let one = Picture {
            bodies: vec![BodyPicture { positions: vec![[0.0; 3], [1.0, 1.0, 0.0]], ..Default::default() }],
            ..Default::default()
        };
        let view = View::fit([&one]).expect("a view");
        assert!((9..=12).contains(&best_count(&view, 2, 200)));
        assert_eq!(best_count(&view, 2, 3), 3, "no more than there are");
    }

    #[test]
    fn a_strip_of_few_panels_leaves_nothing_blank() {
        use crate::picture::{BodyPicture, Legend};
        let body =
            BodyPicture { positions: vec![[0.0; 3], [1.0, 1.0, 0.0]], scalar: vec![0.0, 1.0], ..Default::default() };
        let legend = Legend { label: "strain".into(), unit: "%".into(), range: None, map: Default::default() };
        let picture = Picture { bodies: vec![body], legend: Some(legend), ..Default::default() };
        let view = View::fit([&picture]).expect("a view");
        for count in 1..=12 {
            let image = strip(&vec![&picture; count], &view, &StripStyle::default()).expect("a strip");
            let (width, height) = (image.width(), image.height());
            assert!(width <= StripStyle::default().width);
            let column = |x: &u32| (0..height).any(|y| image.pixel(*x, y) != [255; 3]);
            let blank = (0..width).rev().find(column).map_or(width, |last| width - 1 - last);
            assert!(blank < 60, "{count} panels: {blank} of {width} columns at the right are blank");
        }
    }

    #[test]
    fn no_row_is_shorter_than_it_must_be() {
        for count in 1..=20 {
            for columns in 1..=7 {
                let grid = Grid::new(count, columns, 0.7, 1400.0, 1.0);
                let places = grid.columns * grid.rows;
                assert!(places >= count && places - count < grid.rows, "{count} {grid:?}");
            }
        }
    }

    #[test]
    fn frames_are_spread_evenly_with_both_ends() {
        let frames: Vec<usize> = (0..11).collect();
        assert_eq!(spread(&frames, 3), vec![&0, &5, &10]);
        assert_eq!(spread(&frames, 99).len(), 11);
        assert_eq!(spread(&frames, 1), vec![&10]);
        assert!(spread::<usize>(&[], 4).is_empty());
    }
}
