//! What is written beside bodies: their names, and the hint for the first pull. Nothing of it covers anything else that is written.

use super::look::Paper;
use super::plane::RUBBER;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2};

/// The name of a body, below it or where else there is room beside it; where it is written is taken then. In a throng without
/// room it is not written.
pub(super) fn label(painter: &Painter, text: &str, spots: &[Pos2], paper: &Paper, taken: &mut Vec<Rect>) {
    let height = |a: &&Pos2, b: &&Pos2| a.y.total_cmp(&b.y);
    let ends = spots.iter().max_by(height).zip(spots.iter().min_by(height));
    let Some((low, high)) = ends.filter(|_| !text.is_empty()) else { return };
    let middle = spots.iter().map(|p| p.x).sum::<f32>() / spots.len() as f32;
    let galley = painter.layout_no_wrap(text.to_string(), FontId::proportional(12.0), paper.ink);
    let Some(place) = free([low.y, high.y], middle, galley.size(), taken) else { return };
    let ground = place.expand2(Vec2::new(4.0, 1.0));
    taken.push(ground);
    painter.rect_filled(ground, 3.0, paper.background.gamma_multiply(0.6));
    painter.galley(place.min, galley, paper.ink);
}

/// Where there is room for a name of this size: below a body that reaches from `low` up to `high`, above it, or a little farther.
fn free([low, high]: [f32; 2], middle: f32, size: Vec2, taken: &[Rect]) -> Option<Rect> {
    let below = Align2::CENTER_TOP.anchor_size(Pos2::new(middle, low + 6.0), size);
    let above = Align2::CENTER_BOTTOM.anchor_size(Pos2::new(middle, high - 6.0), size);
    let row = Vec2::new(0.0, size.y + 4.0);
    let places = [below, above, below.translate(row), above.translate(-row), below.translate(2.0 * row)];
    let free = |place: &Rect| taken.iter().all(|other| !other.intersects(place.expand2(Vec2::new(4.0, 1.0))));
    places.into_iter().find(free)
}

/// The hint for the first pull, above a body.
pub(super) fn hint(painter: &Painter, top: Pos2, rect: Rect, tools: Option<Rect>, legend: Option<Rect>, text: &str) {
    // Below the toolbar, and where the body is out of sight, at the border next to it.
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

/// The bubble, to the left of the legend where it would lie on that.
fn beside_legend(bubble: Rect, legend: Option<Rect>) -> Rect {
    // It moves up and down, and has an arrow below.
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
        let first = free([100.0, 60.0], 300.0, size, &taken).expect("room");
        assert!(first.top() > 100.0 && (first.center().x - 300.0).abs() < 0.1, "below, as long as nothing is there");
        taken.push(first);
        for middle in [310.0, 300.0, 320.0, 290.0, 495.0] {
            let place = free([100.0, 60.0], middle, size, &taken).expect("room");
            assert!(taken.iter().all(|other| !other.intersects(place)), "{middle}: {place:?} of {taken:?}");
            taken.push(place);
        }
        // Where five lie over one another there is no room for a sixth.
        assert_eq!(free([100.0, 60.0], 300.0, size, &taken), None);
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
