//! Lines, shapes and text on an image.

use crate::image::Image;
use ab_glyph::{Font, FontRef, ScaleFont};
use std::sync::OnceLock;
use tiny_skia::{
    FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, PixmapMut, Rect, Stroke, StrokeDash, Transform,
};

/// The position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    /// The text starts at the point.
    Start,
    /// The text is centred on the point.
    Middle,
    /// The text ends at the point.
    End,
}

/// The font of all pictures, as an OpenType file: Inter, reduced to Latin, Greek and Cyrillic letters, digits and signs.
pub const FONT: &[u8] = include_bytes!("../font/inter-subset.otf");

fn font() -> &'static FontRef<'static> {
    static READ: OnceLock<FontRef<'static>> = OnceLock::new();
    READ.get_or_init(|| FontRef::try_from_slice(FONT).expect("the font of the crate is a font"))
}

/// The advance of a character. All digits have the same advance, so that a number keeps its width while it changes.
fn advance(sign: char, size: f32) -> f32 {
    let font = font().as_scaled(size * font_scale());
    let wide = if sign.is_ascii_digit() { '0' } else { sign };
    font.h_advance(font.glyph_id(wide))
}

/// The height of a line divided by the size of the letters. The library ab_glyph expects the height of a line.
fn font_scale() -> f32 {
    font().height_unscaled() / font().units_per_em().unwrap_or(1000.0)
}

/// The width of a text in pixels.
pub(crate) fn text_width(text: &str, size: f32) -> f32 {
    text.chars().map(|sign| advance(sign, size)).sum()
}

/// An image on which lines, shapes and text can be drawn.
pub(crate) struct Canvas<'a> {
    /// The pixels.
    pub(crate) pixmap: PixmapMut<'a>,
}

/// A paint of one colour.
pub(crate) fn paint(colour: [u8; 3], opacity: f64) -> Paint<'static> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(colour[0], colour[1], colour[2], (opacity * 255.0).round() as u8);
    paint
}

/// A path through points.
pub(crate) fn path_of(points: &[[f32; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for (index, point) in points.iter().enumerate() {
        if index == 0 {
            builder.move_to(point[0], point[1]);
        } else {
            builder.line_to(point[0], point[1]);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

impl<'a> Canvas<'a> {
    /// A canvas over an image.
    pub(crate) fn new(image: &'a mut Image) -> Canvas<'a> {
        let (width, height) = (image.width(), image.height());
        let pixmap =
            PixmapMut::from_bytes(image.pixels_mut(), width, height).expect("an image has four bytes for each pixel");
        Canvas { pixmap }
    }

    /// Fills a path; overlapping loops leave holes.
    pub(crate) fn fill(&mut self, path: &Path, paint: &Paint) {
        self.pixmap.fill_path(path, paint, FillRule::EvenOdd, Transform::identity(), None);
    }

    /// Fills everything that the loops of a path enclose, also where they overlap. All loops have the same orientation.
    pub(crate) fn fill_all(&mut self, path: &Path, paint: &Paint) {
        self.pixmap.fill_path(path, paint, FillRule::Winding, Transform::identity(), None);
    }

    /// Draws the line of a path with round ends and corners.
    pub(crate) fn stroke(&mut self, path: &Path, width: f32, paint: &Paint) {
        self.stroke_dashed(path, width, &[], paint);
    }

    /// Draws the line of a path with dashes, given as the lengths of dashes and gaps in turn.
    pub(crate) fn stroke_dashed(&mut self, path: &Path, width: f32, dashes: &[f32], paint: &Paint) {
        let stroke = Stroke {
            width,
            line_cap: if dashes.is_empty() { LineCap::Round } else { LineCap::Butt },
            line_join: LineJoin::Round,
            dash: if dashes.is_empty() { None } else { StrokeDash::new(dashes.to_vec(), 0.0) },
            ..Stroke::default()
        };
        self.pixmap.stroke_path(path, paint, &stroke, Transform::identity(), None);
    }

    /// Draws a line through points.
    pub(crate) fn line(&mut self, points: &[[f32; 2]], width: f32, colour: [u8; 3], opacity: f64) {
        if let Some(path) = path_of(points, false) {
            self.stroke(&path, width, &paint(colour, opacity));
        }
    }

    /// Fills a polygon.
    pub(crate) fn polygon(&mut self, points: &[[f32; 2]], colour: [u8; 3], opacity: f64) {
        if let Some(path) = path_of(points, true) {
            self.fill(&path, &paint(colour, opacity));
        }
    }

    /// Fills a disc.
    pub(crate) fn disc(&mut self, center: [f32; 2], radius: f32, colour: [u8; 3]) {
        if let Some(path) = PathBuilder::from_circle(center[0], center[1], radius) {
            self.fill(&path, &paint(colour, 1.0));
        }
    }

    /// Fills a rectangle (left, top, width, height) without anti-aliased edges.
    pub(crate) fn rectangle(&mut self, [left, top, width, height]: [f32; 4], colour: [u8; 3], opacity: f64) {
        if let Some(rectangle) = Rect::from_xywh(left, top, width, height) {
            let mut paint = paint(colour, opacity);
            paint.anti_alias = false;
            self.pixmap.fill_rect(rectangle, &paint, Transform::identity(), None);
        }
    }

    /// Draws the edge of a rectangle (left, top, width, height) with a line of one pixel.
    pub(crate) fn frame(&mut self, [left, top, width, height]: [f32; 4], colour: [u8; 3]) {
        let (left, top, width, height) = (left.round(), top.round(), width.round(), height.round());
        self.rectangle([left, top, width, 1.0], colour, 1.0);
        self.rectangle([left, top + height - 1.0, width, 1.0], colour, 1.0);
        self.rectangle([left, top, 1.0, height], colour, 1.0);
        self.rectangle([left + width - 1.0, top, 1.0, height], colour, 1.0);
    }

    /// Width and height in pixels.
    pub(crate) fn size(&self) -> [f32; 2] {
        [self.pixmap.width() as f32, self.pixmap.height() as f32]
    }

    /// Counts the pixels of a rectangle (left, top, width, height) whose colour visibly differs from the given one.
    pub(crate) fn differing(&self, [left, top, width, height]: [f32; 4], colour: [u8; 3]) -> usize {
        let [wide, tall] = self.size().map(|size| size as usize);
        let (columns, rows) = (
            left.max(0.0) as usize..((left + width).ceil().max(0.0) as usize).min(wide),
            top.max(0.0) as usize..((top + height).ceil().max(0.0) as usize).min(tall),
        );
        let bytes = self.pixmap.as_ref().data().to_vec();
        let other = |x: usize, y: usize| {
            let pixel = &bytes[4 * (y * wide + x)..][..3];
            pixel.iter().zip(&colour).any(|(a, b)| a.abs_diff(*b) > 20)
        };
        rows.map(|y| columns.clone().filter(|x| other(*x, y)).count()).sum()
    }

    /// Writes a text whose baseline passes through a point.
    pub(crate) fn text(&mut self, text: &str, point: [f32; 2], size: f32, anchor: Anchor, colour: [u8; 3]) {
        let shift = match anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * text_width(text, size),
            Anchor::End => -text_width(text, size),
        };
        let font = font();
        let scaled = font.as_scaled(size * font_scale());
        let mut x = point[0] + shift;
        for sign in text.chars() {
            let id = scaled.glyph_id(sign);
            let space = advance(sign, size);
            let inset = 0.5 * (space - scaled.h_advance(id));
            let origin = ab_glyph::point(x + inset, point[1].round());
            let glyph = id.with_scale_and_position(size * font_scale(), origin);
            if let Some(outline) = font.outline_glyph(glyph) {
                let bounds = outline.px_bounds();
                outline.draw(|column, row, coverage| {
                    self.blend(bounds.min.x as i32 + column as i32, bounds.min.y as i32 + row as i32, colour, coverage);
                });
            }
            x += space;
        }
    }

    /// Mixes a colour into a pixel.
    fn blend(&mut self, x: i32, y: i32, colour: [u8; 3], coverage: f32) {
        let (width, height) = (self.pixmap.width() as i32, self.pixmap.height() as i32);
        if x < 0 || y < 0 || x >= width || y >= height {
            return;
        }
        let offset = 4 * (y as usize * width as usize + x as usize);
        let bytes = self.pixmap.data_mut();
        for channel in 0..3 {
            let under = f32::from(bytes[offset + channel]);
            let over = f32::from(colour[channel]);
            bytes[offset + channel] = (under + (over - under) * coverage.clamp(0.0, 1.0)).round() as u8;
        }
    }
}
