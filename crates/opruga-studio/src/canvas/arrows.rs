//! Draws the arrows over a scene in the plane, and the legend of the arrows in both dimensions. The legend shows an arrow with a round value for each
//! kind.

use super::camera::Flat;
use super::look::{Look, Paper, colour, on_paper};
use crate::shown::Shown;
use crate::words::Language;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2};
use opruga::draw::{ArrowKind, arrow_colour, arrow_unit, format_value, nice_length};
use std::collections::BTreeMap;

/// The length of the longest arrow of each kind in the plane [points]. `LONG_NORMAL` is the length of unit normals [points].
const LONG: f64 = 60.0;
const LONG_NORMAL: f64 = 18.0;

/// The largest magnitude among the arrows of every visible kind. This magnitude grows at once and shrinks slowly, so that the scale can be read.
#[derive(Clone, Debug, Default)]
pub(crate) struct Longest(pub(crate) BTreeMap<ArrowKind, f64>);

impl Longest {
    /// Updates the lengths to the present arrows.
    pub(crate) fn follow(&mut self, shown: &Shown) {
        let right = shown.beside.iter().flat_map(|beside| &beside.right.picture.arrows);
        let mut now: BTreeMap<ArrowKind, f64> = BTreeMap::new();
        for arrow in shown.picture.arrows.iter().chain(right) {
            let entry = now.entry(arrow.kind).or_insert(0.0);
            *entry = entry.max(arrow.vector.iter().map(|c| c * c).sum::<f64>().sqrt());
        }
        for (kind, longest) in &mut now {
            let before = self.0.get(kind).copied().filter(|before| before > longest && *longest > 0.0);
            *longest = before.map_or(*longest, |before| before + 0.04 * (*longest - before));
        }
        self.0 = now;
    }

    /// The largest magnitude of a kind; none if it is zero.
    fn of(&self, kind: ArrowKind) -> Option<f64> {
        self.0.get(&kind).copied().filter(|longest| *longest > 0.0)
    }
}

/// The colour of a kind of arrow: the same as in pictures of the command line, but adjusted to be visible on the background.
fn ink(kind: ArrowKind, paper: &Paper) -> Color32 {
    match kind {
        ArrowKind::Force => paper.ink,
        kind => on_paper(colour(arrow_colour(kind)), paper),
    }
}

/// The length of the longest arrow of a kind in the plane [points].
fn long(kind: ArrowKind) -> f64 {
    if kind == ArrowKind::Normal { LONG_NORMAL } else { LONG }
}

/// Draws the arrows, each kind with a scale of its own.
pub(super) fn paint(look: &Look<'_>, flat: &Flat, longest: &Longest, project: &dyn Fn([f64; 3]) -> Pos2) {
    for mark in &look.shown.picture.arrows {
        let Some(most) = longest.of(mark.kind).filter(|_| mark.kind != ArrowKind::Pull) else { continue };
        let scale = flat.metres(long(mark.kind)) / most;
        let (from, to) = (project(mark.from), project([0, 1, 2].map(|d| mark.from[d] + scale * mark.vector[d])));
        if (to - from).length() >= 2.0 {
            arrow(look.painter, from, to, Stroke::new(1.5, ink(mark.kind, look.paper)), 6.0);
        }
    }
}

/// Draws a line with a head of this length.
pub(super) fn arrow(painter: &Painter, from: Pos2, to: Pos2, stroke: Stroke, long: f32) {
    let offset = to - from;
    painter.line_segment([from, to], stroke);
    let back = offset.normalized() * long.min(0.5 * offset.length());
    let side = Vec2::new(-back.y, back.x) * 0.45;
    let head = vec![to, to - back + side, to - back - side];
    painter.add(Shape::convex_polygon(head, stroke.color, Stroke::NONE));
}

/// The legend entry for a kind of arrow: the screen length of an arrow whose value is round, and the text beside it.
fn entry(look: &Look<'_>, kind: ArrowKind, most: f64, points: f64, words: Language) -> Option<(f32, String)> {
    if !(points > 0.0 && points.is_finite()) {
        return None;
    }
    let name = words.arrow(kind);
    if kind == ArrowKind::Normal {
        return Some((points as f32, name.into()));
    }
    // The value is limited, because an arrow could fill the whole window when the view is zoomed in.
    let value = nice_length(most * (0.3 * f64::from(look.rect.width()) / points).min(1.0));
    let unit = arrow_unit(kind, &look.shown.picture.length_unit);
    Some(((points * value / most) as f32, format!("{name} {} {unit}", format_value(value))))
}

/// Draws the legend of the arrows above the scale bar: for every visible kind, an arrow with a round value. In space, the arrows of the legend have
/// the length that they would have at the centre of the view; `points_of` is the length of the longest arrow there, in points of the screen. Returns
/// the rectangles of the rows.
pub(super) fn key(look: &Look<'_>, longest: &Longest, points_of: Option<f64>, words: Language) -> Vec<Rect> {
    let Look { painter, rect, paper, shown, .. } = *look;
    let base = rect.bottom()
        - if shown.dimension == 3 { 18.0 } else { 46.0 }
        - if shown.beside.is_some() { 40.0 } else { 0.0 };
    let rows: Vec<(ArrowKind, f32, String)> = longest
        .0
        .keys()
        .filter(|kind| **kind != ArrowKind::Pull)
        .filter_map(|kind| {
            let (long, text) = entry(look, *kind, longest.of(*kind)?, points_of.unwrap_or(long(*kind)), words)?;
            Some((*kind, long, text))
        })
        .collect();
    let wide = rows.iter().map(|(_, long, _)| *long).fold(0.0, f32::max);
    let mut grounds = Vec::new();
    for (row, (kind, long, text)) in rows.into_iter().enumerate() {
        let start = Pos2::new(rect.left() + 14.0, base - 17.0 * row as f32);
        let galley = painter.layout_no_wrap(text, FontId::proportional(12.0), paper.ink);
        let text_rect = Align2::LEFT_CENTER.anchor_size(start + Vec2::new(wide + 8.0, 0.0), galley.size());
        let ground = Rect::from_min_max(Pos2::new(start.x - 4.0, text_rect.top()), text_rect.max + Vec2::new(4.0, 0.0));
        painter.rect_filled(ground, 3.0, paper.background.gamma_multiply(0.7));
        arrow(painter, start, start + Vec2::new(long, 0.0), Stroke::new(1.5, ink(kind, paper)), 6.0);
        painter.galley(text_rect.min, galley, paper.ink);
        grounds.push(ground);
    }
    grounds
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::draw::{ArrowPicture, Picture};

    #[test]
    fn the_scale_of_arrows_follows_longer_ones_at_once_and_shorter_ones_slowly() {
        let seen = |long: f64| {
            let mark = |kind| ArrowPicture { kind, from: [0.0; 3], vector: [0.0, long, 0.0] };
            let arrows = if long < 0.0 { Vec::new() } else { vec![mark(ArrowKind::Velocity)] };
            Shown { picture: Picture { arrows, ..Default::default() }, ..Default::default() }
        };
        let mut longest = Longest::default();
        longest.follow(&seen(2.0));
        assert_eq!(longest.of(ArrowKind::Velocity), Some(2.0));
        longest.follow(&seen(5.0));
        assert_eq!(longest.of(ArrowKind::Velocity), Some(5.0));
        longest.follow(&seen(1.0));
        assert!(longest.of(ArrowKind::Velocity).is_some_and(|long| (4.0..5.0).contains(&long)));
        // A scene at rest has no scale for its arrows, and a kind that is no longer visible loses its scale.
        longest.follow(&seen(0.0));
        assert_eq!(longest.of(ArrowKind::Velocity), None);
        longest.follow(&seen(5.0));
        longest.follow(&seen(-1.0));
        assert!(longest.0.is_empty());
    }
}
