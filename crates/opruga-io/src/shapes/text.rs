//! Texts: the outlines of the letters of a font.

use super::Problem;
use super::composite;
use super::curves::Curves;
use super::drawing::Drawing;
use super::drawing_errors::LetterError;
use crate::budget::{EXPANSION, LimitHint, POINTS};
use crate::problem::{SceneError, visible};
use opruga_core::spec::Values;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Scripts whose letters join, change or run from right to left, and marks that are placed on letters: ranges of characters.
const SHAPED: [(char, char); 18] = [
    ('\u{0300}', '\u{036f}'),
    ('\u{0590}', '\u{109f}'),
    ('\u{1100}', '\u{11ff}'),
    ('\u{1700}', '\u{1cff}'),
    ('\u{1dc0}', '\u{1dff}'),
    ('\u{200b}', '\u{200f}'),
    ('\u{202a}', '\u{202e}'),
    ('\u{2060}', '\u{206f}'),
    ('\u{20d0}', '\u{20ff}'),
    ('\u{a800}', '\u{abff}'),
    ('\u{fb1d}', '\u{fdff}'),
    ('\u{fe00}', '\u{fe0f}'),
    ('\u{fe20}', '\u{fe2f}'),
    ('\u{fe70}', '\u{fefe}'),
    ('\u{10800}', '\u{11fff}'),
    ('\u{1e800}', '\u{1efff}'),
    ('\u{1f3fb}', '\u{1f3ff}'),
    ('\u{e0000}', '\u{e0fff}'),
];

/// The pen of a font, relative to the origin of a letter.
struct Pen {
    curves: Curves,
    from: f64,
    /// Where the contour began.
    start: [f64; 2],
}

impl Pen {
    fn point(&self, x: f32, y: f32) -> [f64; 2] {
        [self.from + f64::from(x), f64::from(y)]
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.start = self.point(x, y);
        self.curves.move_to(self.start);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        self.curves.line_to(self.point(x, y));
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.curves.quadratic_to(self.point(x1, y1), self.point(x, y));
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.curves.cubic_to(self.point(x1, y1), self.point(x2, y2), self.point(x, y));
    }
    fn close(&mut self) {
        self.curves.line_to(self.start);
    }
}

/// Reads the letters of `text` from an OpenType or TrueType font, each as one part, placed on one line with the kerning of the table `kern`.
///
/// # Errors
/// `font.syntax` for a file that is not a font, `font.no_glyph` for a letter that the font lacks, `font.script` for a letter of a script that is not
/// written letter by letter from left to right, `shape.no_area` for a text without outlines.
pub(super) fn read<'a>(file: &str, bytes: &[u8], shape: &Values) -> Result<Drawing<'a>, Problem> {
    let named = |error: SceneError| Problem::from(SceneError { file: file.to_string(), ..error });
    let face = Face::parse(bytes, 0)
        .map_err(|e| named(SceneError::of(LetterError::Font { reason: e.to_string(), bytes: bytes.len() })))?;
    let text = shape.text("text").unwrap_or("");
    let mut pen = Pen { curves: Curves::default(), from: 0.0, start: [0.0; 2] };
    let mut last: Option<GlyphId> = None;
    let (mut read, mut points) = (0u64, 0u64);
    for (part, letter) in text.chars().enumerate() {
        let refuse = |error: LetterError| Problem::new("text", SceneError::of(error));
        let shown = || visible(&letter.to_string());
        if letter.is_control() {
            return Err(refuse(LetterError::NoLetter { letter: shown() }));
        }
        if SHAPED.iter().any(|(from, to)| (*from..=*to).contains(&letter)) {
            return Err(refuse(LetterError::Script { letter: shown() }));
        }
        let Some(glyph) = face.glyph_index(letter) else {
            return Err(refuse(LetterError::NoGlyph { font: visible(file), letter: shown() }));
        };
        if let Some(last) = last {
            let tables = face.tables().kern.iter().flat_map(|kern| kern.subtables);
            let kerning = tables.filter(|t| t.horizontal && !t.variable).find_map(|t| t.glyphs_kerning(last, glyph));
            pen.from += f64::from(kerning.unwrap_or(0));
        }
        let mut own = Pen { curves: Curves::of_part(part as u32), from: pen.from, start: [0.0; 2] };
        read = read.saturating_add(composite::bytes(&face, glyph));
        EXPANSION.check(read).map_err(|e| Problem::new("text", e.advice(LimitHint::Letters)))?;
        // Spaces have no outline.
        let _ = face.outline_glyph(glyph, &mut own);
        points += own.curves.points() as u64;
        POINTS.check(points).map_err(|e| Problem::new("text", e))?;
        pen.curves.append(own.curves, &super::curves::IDENTITY);
        pen.from += f64::from(face.glyph_hor_advance(glyph).unwrap_or(0));
        last = Some(glyph);
    }
    if pen.curves.extent() <= 0.0 {
        let empty = text.is_empty();
        let error = if empty { LetterError::EmptyText {} } else { LetterError::NoLetters { text: visible(text) } };
        return Err(Problem::new("text", SceneError::of(error)));
    }
    let (spans, painted, rules, notices) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    Ok(Drawing { curves: pen.curves, y_down: false, source: None, spans, painted, rules, notices })
}
