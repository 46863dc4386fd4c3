//! Writes labels next to bodies: their names, and the hint for the first pull. Labels cover no other text.

use super::look::{Paper, RUBBER};
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2};

/// The largest number of bodies for which names avoid other bodies.
const FEW: usize = 64;

/// A body with a name: its rectangle on the screen, and the mean horizontal position of its nodes.
pub(super) struct Named<'a> {
    text: &'a str,
    rect: Rect,
    middle: f32,
}

impl<'a> Named<'a> {
    /// Makes a body with this name and with its nodes at these positions; none if the name is empty, or if no node is visible.
    pub(super) fn of(text: &'a str, spots: impl Iterator<Item = Pos2>) -> Option<Named<'a>> {
        let (mut rect, mut sum, mut count) = (Rect::NOTHING, 0.0, 0_u32);
        for spot in spots {
            rect.extend_with(spot);
            (sum, count) = (sum + spot.x, count + 1);
        }
        (count > 0 && !text.is_empty()).then(|| Named { text, rect, middle: sum / count as f32 })
    }
}

/// Writes the names of bodies below or next to them, but not over `taken` rectangles. Names for which there is no space are omitted.
pub(super) fn names(painter: &Painter, named: &[Named<'_>], paper: &Paper, taken: &[Rect]) {
    let mut taken = taken.to_vec();
    let compared = if named.len() <= FEW { named } else { &[] };
    for (index, body) in named.iter().enumerate() {
        let others = compared.iter().enumerate().filter(|(other, _)| *other != index);
        let others: Vec<Rect> = others.map(|(_, other)| other.rect).collect();
        let galley = painter.layout_no_wrap(body.text.to_string(), FontId::proportional(12.0), paper.ink);
        let Some(text_rect) = free(body.rect, body.middle, galley.size(), &taken, &others) else { continue };
        let ground = text_rect.expand2(Vec2::new(4.0, 1.0));
        taken.push(ground);
        painter.rect_filled(ground, 3.0, paper.background.gamma_multiply(0.6));
        painter.galley(text_rect.min, galley, paper.ink);
    }
}

/// Finds a free position for a name of this size. The function tries the positions below the body, also a little to the side, above it, beside it,
/// and a little farther away. This function prefers a position that covers no other body.
fn free(body: Rect, middle: f32, size: Vec2, taken: &[Rect], others: &[Rect]) -> Option<Rect> {
    let below = Align2::CENTER_TOP.anchor_size(Pos2::new(middle, body.bottom() + 6.0), size);
    let above = Align2::CENTER_BOTTOM.anchor_size(Pos2::new(middle, body.top() - 6.0), size);
    let right = Align2::LEFT_CENTER.anchor_size(body.right_center() + Vec2::new(8.0, 0.0), size);
    let left = Align2::RIGHT_CENTER.anchor_size(body.left_center() - Vec2::new(8.0, 0.0), size);
    let row = Vec2::new(0.0, size.y + 4.0);
    let aside = [0.25, -0.25, 0.5, -0.5].map(|share| below.translate(Vec2::new(share * size.x, 0.0)));
    let farther = [above, right, left, below.translate(row), above.translate(-row), below.translate(2.0 * row)];
    let free = |rect: &Rect| taken.iter().all(|other| !other.intersects(rect.expand2(Vec2::new(4.0, 1.0))));
    let mut candidates = std::iter::once(below).chain(aside).chain(farther).filter(free);
    let first = candidates.next()?;
    let off = |rect: &Rect| !others.iter().any(|other| other.intersects(*rect));
    Some(std::iter::once(first).chain(candidates).find(off).unwrap_or(first))
}

/// Draws the hint for the first pull, above a body.
pub(super) fn hint(painter: &Painter, top: Pos2, rect: Rect, tools: Option<Rect>, legend: Option<Rect>, text: &str) {
    // The hint is below the toolbar. If the body is out of sight, it is at the nearest border.
    let across = top.x.clamp(rect.left() + 50.0, (rect.right() - 50.0).max(rect.left() + 50.0));
    let highest = tools.map_or(rect.top(), |tools| tools.bottom()) + 54.0;
    let tip = Pos2::new(across, top.y.clamp(highest, rect.bottom().max(highest)) - 8.0);
    let galley = painter.layout_no_wrap(text.to_string(), FontId::proportional(15.0), Color32::WHITE);
    let size = galley.size() + Vec2::new(22.0, 12.0);
    let still = beside_legend(Rect::from_center_size(tip - Vec2::new(0.0, 26.0), size), legend);
    let beat = (painter.ctx().input(|i| i.time) * 3.0).sin() as f32 * 3.0;
    let bubble = still.translate(Vec2::new(0.0, beat));
    painter.rect_filled(bubble, 8.0, RUBBER);
    let foot = bubble.center_bottom();
    let arrow = vec![foot + Vec2::new(-7.0, -1.0), foot + Vec2::new(7.0, -1.0), foot + Vec2::new(0.0, 9.0)];
    painter.add(Shape::convex_polygon(arrow, RUBBER, Stroke::NONE));
    painter.galley(bubble.center() - 0.5 * galley.size(), galley, Color32::WHITE);
}

/// Moves the bubble to the left of the legend if it would overlap the legend.
fn beside_legend(bubble: Rect, legend: Option<Rect>) -> Rect {
    // The tested rectangle is larger than the bubble, because the bubble moves up and down, and has an arrow below it.
    let over = |legend: &Rect| legend.intersects(bubble.expand2(Vec2::new(4.0, 12.0)));
    let by = legend.filter(over).map_or(0.0, |legend| legend.left() - 6.0 - bubble.right());
    bubble.translate(Vec2::new(by, 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_bodies_that_lie_close_cover_neither_one_another_nor_the_legend() {
        let legend = Rect::from_min_max(Pos2::new(500.0, 20.0), Pos2::new(610.0, 125.0));
        let (size, mut taken) = (Vec2::new(40.0, 14.0), vec![legend]);
        let at = |x: f32| Rect::from_center_size(Pos2::new(x, 80.0), Vec2::new(40.0, 40.0));
        let first = free(at(300.0), 300.0, size, &taken, &[]).expect("room");
        assert!(first.top() > 100.0 && (first.center().x - 300.0).abs() < 0.1, "below, as long as nothing is there");
        taken.push(first);
        for middle in [310.0, 300.0, 320.0, 290.0, 495.0] {
            let place = free(at(middle), middle, size, &taken, &[]).expect("room");
            assert!(taken.iter().all(|other| !other.intersects(place)), "{middle}: {place:?} of {taken:?}");
            taken.push(place);
        }
        // If many names overlap, there is no space for another one.
        while let Some(place) = free(at(300.0), 300.0, size, &taken, &[]) {
            assert!(taken.len() < 12, "{taken:?}");
            taken.push(place);
        }
    }

    #[test]
    fn the_name_of_a_body_lies_over_no_other_body_where_it_can_be_beside_it() {
        let size = Vec2::new(80.0, 14.0);
        let at = |x: f32, y: f32| Rect::from_center_size(Pos2::new(x, y), Vec2::splat(22.0));
        let (body, above) = (at(220.0, 330.0), at(220.0, 288.0));
        // Something else is below the body, and another body is above it.
        let taken = [Rect::from_min_max(Pos2::new(130.0, 342.0), Pos2::new(320.0, 400.0))];
        let place = free(body, 220.0, size, &taken, &[above]).expect("room");
        assert!(!place.intersects(above) && !place.intersects(taken[0]), "{place:?}");
        // All positions are within a large body, so the name is written over this body.
        let around = at(220.0, 330.0).expand(300.0);
        let within = free(body, 220.0, size, &[], &[around]).expect("room");
        assert!(within.top() > body.bottom());
    }

    #[test]
    fn the_hint_keeps_away_from_the_legend() {
        let legend = Rect::from_min_max(Pos2::new(500.0, 20.0), Pos2::new(610.0, 220.0));
        let bubble = Rect::from_center_size(Pos2::new(505.0, 100.0), Vec2::new(90.0, 30.0));
        let place = beside_legend(bubble, Some(legend));
        assert!(!place.intersects(legend) && place.center().y == 100.0, "{place:?}");
        let far = bubble.translate(Vec2::new(-200.0, 0.0));
        assert_eq!((beside_legend(far, Some(legend)), beside_legend(bubble, None)), (far, bubble));
    }
}
