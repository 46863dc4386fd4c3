//! The hint that shows where the bodies are when none of them is in sight.

use super::look::RUBBER;
use super::{Canvas, arrows};
use crate::shown::Shown;
use crate::words::Language;
use egui::{Align2, Button, Color32, Id, Order, Pos2, Rect, RichText, Stroke, Ui, Vec2};

/// The distance from the border of the free area to the tip of the arrow [points]. `ARROW` is the length of the arrow [points].
const BORDER: f32 = 8.0;
const ARROW: f32 = 26.0;

impl Canvas {
    /// The direction on the screen towards the nearest body; none if one is in sight, or if there are none.
    fn away(&self, shown: &Shown) -> Option<Vec2> {
        let rect = self.rect?;
        let right = self.other.zip(shown.beside.as_ref());
        let beside = right.is_some_and(|(other, beside)| !self.seen_in(other, &beside.right).is_empty());
        if beside || !self.seen_in(rect, shown).is_empty() {
            return None;
        }
        let offsets = shown.extents.iter().filter_map(|extent| {
            let [low, high] = extent.corners;
            self.offset_to(shown, rect, [0, 1, 2].map(|d| 0.5 * (low[d] + high[d])))
        });
        offsets.min_by(|a, b| a.length_sq().total_cmp(&b.length_sq()))
    }

    /// The offset on the screen from the centre of the view to a point. In space, this offset is measured perpendicular to the line of sight, because
    /// a point may be behind the camera.
    fn offset_to(&self, shown: &Shown, rect: Rect, point: [f64; 3]) -> Option<Vec2> {
        if shown.dimension != 3 {
            return Some(self.flat.to_screen(rect, point, shown.picture.y_down) - rect.center());
        }
        let (eye, scales) = (self.space.eye()?, self.scales.as_ref()?);
        let [right, up, _] = eye.axes(scales);
        let along = |axis: [f64; 3]| (0..3).map(|d| axis[d] * (point[d] - eye.target[d])).sum::<f64>() / eye.radius;
        Some(Vec2::new(along(right) as f32, -along(up) as f32))
    }

    /// Shows an arrow at the border if no body is in sight, and a button that shows all bodies again.
    pub(super) fn point_to_bodies(&mut self, ui: &Ui, shown: &Shown, legend: Option<Rect>, language: Language) {
        let (Some(offset), Some(rect)) = (self.away(shown), self.rect) else { return };
        // While a file is dragged over the window, another hint is shown.
        if !ui.input(|i| i.raw.hovered_files.is_empty()) {
            return;
        }
        let high = self.tools.map_or(rect.top(), |tools| tools.bottom());
        let text = RichText::new(language.away()).size(15.0).color(Color32::WHITE);
        let galley =
            ui.painter().layout_no_wrap(language.away().into(), egui::FontId::proportional(15.0), Color32::WHITE);
        let size = galley.size() + Vec2::new(22.0, 12.0);
        let mut free = Rect::from_min_max(Pos2::new(rect.left(), high), rect.max - Vec2::new(0.0, 32.0)).shrink(BORDER);
        // The hint is next to the legend, if there is space.
        if let Some(legend) = legend.filter(|legend| legend.left() - free.left() > size.x + 2.0 * ARROW + 8.0) {
            free.max.x = legend.left() - 4.0;
        }
        let (tip, middle) = tip_and_middle(free, offset, size);
        let bubble = Rect::from_center_size(middle, size);
        let area = egui::Area::new(Id::unique("where the bodies are"))
            .order(Order::Middle)
            .pivot(Align2::CENTER_CENTER)
            .fixed_pos(middle)
            .show(ui.ctx(), |ui| ui.add_sized(size, Button::new(text).fill(RUBBER).corner_radius(8)));
        if area.inner.clicked() {
            self.fit();
        }
        let ahead = if offset.length_sq() > 0.0 { offset.normalized() } else { Vec2::DOWN };
        arrows::arrow(&ui.painter_at(rect), tip - ARROW * ahead, tip, Stroke::new(4.0, RUBBER), 0.5 * ARROW);
        self.written.push(bubble.union(Rect::from_center_size(tip, Vec2::splat(ARROW))));
    }
}

/// Returns the tip of the arrow, which is at the border of the free area, and the centre of a bubble of this size behind the arrow.
fn tip_and_middle(free: Rect, offset: Vec2, size: Vec2) -> (Pos2, Pos2) {
    let ahead = if offset.length_sq() > 0.0 { offset.normalized() } else { Vec2::DOWN };
    let far = |half: Vec2| {
        let along = |half: f32, ahead: f32| if ahead == 0.0 { f32::MAX } else { (half / ahead).abs() };
        along(half.x, ahead.x).min(along(half.y, ahead.y))
    };
    let half_free = 0.5 * free.size().max(Vec2::ZERO);
    let tip = free.center() + far(half_free) * ahead;
    // The arrow is between the bubble and the border of the area.
    let back = 0.5 * size + Vec2::splat(ARROW + 2.0);
    let sideways = (ahead.x / half_free.x.max(1.0)).abs() > (ahead.y / half_free.y.max(1.0)).abs();
    let back =
        if sideways { Vec2::new(back.x * ahead.x.signum(), 0.0) } else { Vec2::new(0.0, back.y * ahead.y.signum()) };
    let half = (0.5 * size).min(half_free);
    (tip, (tip - back).clamp(free.min + half, free.max - half))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shown::Extent;

    #[test]
    fn the_arrow_points_to_the_bodies_and_its_bubble_is_in_sight() {
        let free = Rect::from_min_max(Pos2::new(8.0, 60.0), Pos2::new(392.0, 300.0));
        let size = Vec2::new(220.0, 30.0);
        for offset in
            [[900.0, 0.0], [-900.0, 20.0], [0.0, 1e5], [3.0, -5000.0], [-1e5, -1e5], [700.0, 690.0], [0.0, 0.0]]
        {
            let offset = Vec2::from(offset);
            let (tip, middle) = tip_and_middle(free, offset, size);
            let bubble = Rect::from_center_size(middle, size);
            assert!(free.expand(0.5).contains(tip) && free.contains_rect(bubble), "{offset:?}: {tip:?} {bubble:?}");
            assert!(!bubble.expand(ARROW).contains(tip), "{offset:?}: {tip:?} {bubble:?}");
            assert!((tip - middle).dot(offset) >= 0.0, "{offset:?}: {tip:?} {bubble:?}");
            let border = [tip.x - free.left(), free.right() - tip.x, tip.y - free.top(), free.bottom() - tip.y];
            assert!(border.iter().any(|far| far.abs() < 0.5), "{offset:?}: {tip:?}");
        }
    }

    #[test]
    fn where_the_bodies_are_is_said_only_while_none_is_in_sight() {
        let body = |x: f64| opruga::draw::BodyPicture {
            positions: vec![[x, 0.0, 0.0], [x + 1.0, 1.0, 0.0]],
            ..Default::default()
        };
        let shown = |xs: &[f64]| Shown {
            dimension: 2,
            extents: xs.iter().map(|x| Extent::of(&body(*x))).collect(),
            ..Default::default()
        };
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(600.0, 500.0));
        let canvas = Canvas { rect: Some(rect), ..Default::default() };
        assert_eq!(canvas.away(&shown(&[0.0])), None);
        assert_eq!(canvas.away(&shown(&[0.0, 50.0])), None, "one of them is seen");
        assert_eq!(canvas.away(&shown(&[])), None, "there is none");
        let offset = canvas.away(&shown(&[90.0, -40.0])).expect("they are out of sight");
        assert!(offset.x < 0.0 && offset.y.abs() < 0.1 * offset.x.abs(), "the nearest one: {offset:?}");
        // If the camera is very close to the body, the body covers the whole screen.
        let mut near = Canvas { rect: Some(rect), ..Default::default() };
        near.flat.zoom(1e4, rect, rect.center() + Vec2::new(50.0, -50.0), false);
        assert_eq!(near.away(&shown(&[0.0])), None);
    }
}
