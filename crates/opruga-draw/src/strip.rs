//! A film strip: some frames of a run, side by side, with one scale.

use crate::canvas::{Anchor, Canvas};
use crate::colour::INK;
use crate::error::DrawError;
use crate::image::Image;
use crate::layout::{Layout, time_text};
use crate::picture::Picture;
use crate::view::View;

/// The size and the order of the panels of a film strip.
#[derive(Clone, Debug, PartialEq)]
pub struct StripStyle {
    /// The width of the whole strip in pixels.
    pub width: u32,
    /// The number of panels in a row.
    pub columns: usize,
    /// The height of a panel divided by its width; the view decides where this is absent.
    pub aspect: Option<f64>,
    /// The colour around and behind the scenes.
    pub background: [u8; 3],
    /// Whether the colours of the scalars are explained at the right.
    pub legend: bool,
}

impl Default for StripStyle {
    fn default() -> StripStyle {
        StripStyle { width: 1400, columns: 5, aspect: None, background: [255; 3], legend: true }
    }
}

/// The most that a panel is high, in pixels of a strip 1400 pixels wide.
const TALLEST: f32 = 560.0;

/// Picks up to `count` pictures at even distances, with the first and the last.
pub fn spread<T>(pictures: &[T], count: usize) -> Vec<&T> {
    let kept = count.min(pictures.len());
    (0..kept)
        .map(|place| {
            let last = pictures.len() - 1;
            &pictures[if kept == 1 { last } else { (place * last + (kept - 1) / 2) / (kept - 1) }]
        })
        .collect()
}

/// Draws pictures side by side in rows, with one view, one length scale and one legend for all.
pub fn strip(pictures: &[&Picture], view: &View, style: &StripStyle) -> Result<Image, DrawError> {
    let first = pictures.first().ok_or(DrawError::Empty("a film strip needs a picture"))?;
    let columns = style.columns.clamp(1, pictures.len());
    let rows = pictures.len().div_ceil(columns);
    let unit = (style.width as f32 / 1400.0).clamp(0.6, 6.0);
    let margin = (16.0 * unit).round();
    let head = if first.title.is_empty() { margin } else { 44.0 * unit };
    let foot = 44.0 * unit;
    let legend = Layout::legend_space(first, view, unit, style.legend);
    let gap = (10.0 * unit).round();
    let width = style.width as f32 - 2.0 * margin - legend;
    let aspect = style.aspect.unwrap_or_else(|| natural_aspect(view, first.dimension)) as f32;
    let room = ((width - gap * (columns as f32 - 1.0)) / columns as f32).floor();
    // Few panels are not larger than can be seen at once.
    let panel = room.min((TALLEST * unit / aspect).floor());
    if panel < 8.0 {
        return Err(DrawError::Size { width: panel.max(0.0) as u32, height: 0 });
    }
    let tall = (panel * aspect).round();
    let width = columns as f32 * (panel + gap) - gap;
    let line = (26.0 * unit).round();
    let height = head + rows as f32 * (tall + line) + (rows as f32 - 1.0) * 0.4 * gap + foot;
    let mut image = Image::new(style.width, height.round() as u32, style.background)?;
    let mut scale = None;
    let place = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        [margin + column as f32 * (panel + gap), (head + row as f32 * (tall + line + 0.4 * gap)).round()]
    };
    for (index, picture) in pictures.iter().enumerate() {
        let (scene, found) = crate::scene(picture, view, style.background, [panel as u32, tall as u32], 0.9 * unit)?;
        let [left, top] = place(index);
        image.paste(&scene, left as u32, top as u32);
        scale = found.or(scale);
    }
    let mut canvas = Canvas::new(&mut image);
    for (index, picture) in pictures.iter().enumerate() {
        let [left, top] = place(index);
        canvas.frame([left - 1.0, top - 1.0, panel + 2.0, tall + 2.0], crate::colour::FRAME);
        let point = [left + 0.5 * panel, top + tall + 19.0 * unit];
        canvas.text(&time_text(picture.time), point, 15.0 * unit, Anchor::Middle, INK);
    }
    canvas.text(&first.title, [margin, head - 16.0 * unit], 18.0 * unit, Anchor::Start, INK);
    let bottom = (head + rows as f32 * (tall + line) + (rows as f32 - 1.0) * 0.4 * gap).round();
    let layout = Layout { scene: [margin as u32, head as u32, width as u32, (bottom - head - line) as u32], unit };
    let base = bottom + 26.0 * unit;
    let end = match scale {
        Some(scale) => layout.scale_bar(&mut canvas, [margin, base], panel.max(120.0 * unit) * 2.0, scale),
        None => layout.squares(&mut canvas, [margin, base], first, view),
    };
    layout.arrow_names(&mut canvas, pictures, view, [end + 24.0 * unit, margin + width], base);
    if let (Some(legend), true) = (&first.legend, style.legend) {
        layout.legend(&mut canvas, legend, view, first);
    }
    Ok(image)
}

/// The height of a panel divided by its width which fits the view.
fn natural_aspect(view: &View, dimension: u8) -> f64 {
    let border = 0.08 * view.extent();
    let side = |axis: usize| view.high[axis] - view.low[axis] + border;
    let wide = if dimension == 3 { (side(0).powi(2) + side(2).powi(2)).sqrt() } else { side(0) };
    (side(1) / wide.max(1e-12)).clamp(0.4, 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn frames_are_spread_evenly_with_both_ends() {
        let frames: Vec<usize> = (0..11).collect();
        assert_eq!(spread(&frames, 3), vec![&0, &5, &10]);
        assert_eq!(spread(&frames, 99).len(), 11);
        assert_eq!(spread(&frames, 1), vec![&10]);
        assert!(spread::<usize>(&[], 4).is_empty());
    }
}
