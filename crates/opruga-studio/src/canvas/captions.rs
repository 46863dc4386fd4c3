//! Captions of two scenes that are shown side by side.

use super::look::Paper;
use crate::shown::Beside;
use crate::words::Language;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Stroke, Vec2};
use opruga::draw::format_value;
use std::sync::Arc;

/// The captions of two scenes: rectangle, text and colour.
pub(super) struct Captions(Vec<(Rect, Arc<Galley>, Color32)>);

impl Captions {
    /// The height [points] that is left free below a scene for captions and, above the captions, for the names of the lowest bodies. The first number
    /// is for scenes next to each other, the second for scenes one above the other.
    pub(super) const FOOT: [f32; 2] = [46.0, 32.0];

    /// Makes the captions: the differences of the second scene, the distance between the two, and why the second one has stopped. If the scenes are
    /// one above the other, the captions of the lower one are at its top, next to its legend, because it has no tools there.
    pub(super) fn of(
        painter: &Painter,
        paper: &Paper,
        [first, second]: [Rect; 2],
        legend: Option<Rect>,
        beside: &Beside,
        language: Language,
    ) -> Captions {
        let mut all = Vec::new();
        let below = second.top() > first.top();
        // Texts at the top leave space for the legend. Captions at the bottom do not reach it.
        let free = legend.map_or(second.right(), |legend| legend.left());
        let beside_legend = (free - second.left() - 30.0).max(40.0);
        let wrap_width = if below { beside_legend } else { (second.width() - 40.0).max(40.0) };
        let mut caption = |spot: Pos2, align: Align2, text: String, ink: Color32, wrap_width: f32| {
            let galley = painter.layout(text, FontId::proportional(12.5), ink, wrap_width);
            let text_rect = align.anchor_size(spot, galley.size());
            all.push((text_rect, galley, ink));
            text_rect
        };
        let low = |rect: Rect| rect.center_bottom() - Vec2::new(0.0, 8.0);
        caption(low(first), Align2::CENTER_BOTTOM, language.as_it_is().into(), paper.ink, wrap_width);
        let words: Vec<String> = beside.differences.iter().map(|difference| language.difference(difference)).collect();
        let words = if words.is_empty() { language.no_difference().into() } else { words.join(", ") };
        let far = match (beside.distances, beside.center) {
            (Some([mean, largest]), _) => {
                let [mean, largest] = [mean, largest].map(format_value);
                format!("\n{} {mean} m, {} {largest} m", language.mean_distance(), language.largest_distance())
            }
            // If the bodies have different nodes, the distance between the centres of mass replaces the distances between nodes.
            (None, Some(far)) => format!("\n{} {} m", language.center_distance(), format_value(far)),
            (None, None) => String::new(),
        };
        let high = second.left_top() + Vec2::new(14.0, 10.0);
        let (spot, align) = if below { (high, Align2::LEFT_TOP) } else { (low(second), Align2::CENTER_BOTTOM) };
        let summary = caption(spot, align, format!("{words}{far}"), paper.ink, wrap_width);
        if let Some(reason) = &beside.stopped {
            let text = format!("{}\n{}", language.right_stopped(), language.report(reason));
            let middle = Pos2::new(0.5 * (second.left() + free), second.top() + 70.0);
            let under = Pos2::new(summary.left(), summary.bottom() + 12.0);
            let (spot, align) = if below { (under, Align2::LEFT_TOP) } else { (middle, Align2::CENTER_TOP) };
            caption(spot, align, text, Color32::from_rgb(230, 110, 60), beside_legend);
        }
        Captions(all)
    }

    /// The rectangles that the captions occupy.
    pub(super) fn rects(&self) -> Vec<Rect> {
        self.0.iter().map(|(text_rect, ..)| ground(*text_rect)).collect()
    }

    /// Writes the captions, and draws the line between the two scenes.
    pub(super) fn paint(self, painter: &Painter, paper: &Paper, [first, second]: [Rect; 2]) {
        let border = Stroke::new(1.5, paper.solid_edge);
        if second.left() > first.left() {
            painter.vline(second.left(), second.y_range(), border);
        } else {
            painter.hline(second.x_range(), second.top(), border);
        }
        for (text_rect, galley, ink) in self.0 {
            painter.rect_filled(ground(text_rect), 5.0, paper.background.gamma_multiply(0.85));
            painter.galley(text_rect.min, galley, ink);
        }
    }
}

/// The background of a caption.
fn ground(text_rect: Rect) -> Rect {
    text_rect.expand2(Vec2::new(7.0, 4.0))
}
