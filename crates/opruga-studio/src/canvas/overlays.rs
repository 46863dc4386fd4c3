//! What is drawn over the scene: pins, pulls with their force, what the hand is doing, the hint for the first pull.

use super::labels::{self, Named};
use super::look::{Look, Paper};
use super::pick::Under;
use super::tool::Tool;
use super::{Canvas, Doing, handles, plane};
use crate::shown::{Beside, Shown};
use crate::words::Language;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Stroke, Vec2};
use opruga::draw::{Lens, format_value};
use std::sync::Arc;

impl Canvas {
    /// The place of a point in the window; in space none behind the camera.
    pub(super) fn project(&self, lens: Option<&Lens>, shown: &Shown, rect: Rect, point: [f64; 3]) -> Option<Pos2> {
        if shown.dimension == 3 {
            let ([x, y], _) = lens?.see(point)?;
            Some(rect.min + Vec2::new(x as f32, y as f32))
        } else {
            Some(self.flat.to_screen(rect, point, shown.picture.y_down))
        }
    }

    /// Pins, pulls with their force, the outline that is drawn, the hint for the first pull; nothing is written where the legend is.
    pub(super) fn overlays(
        &self,
        look: &Look<'_>,
        under: Option<&Under>,
        legend: Option<Rect>,
        captions: &[Rect],
        language: Language,
    ) {
        let Look { painter, shown, rect, paper, .. } = *look;
        let lens = self.scales.as_ref().and_then(|scales| self.space.lens(scales, rect));
        let project = |point: [f64; 3]| self.project(lens.as_ref(), shown, rect, point);
        let handles = self.handles(shown, rect);
        if let (Some(under), Doing::Nothing) = (under, &self.doing)
            && let Some(at) = project(under.point)
        {
            painter.circle_stroke(at, 7.0, Stroke::new(1.5, paper.ink));
        }
        let taken: Vec<Rect> = legend.into_iter().chain(self.tools).chain(captions.iter().copied()).collect();
        if shown.dimension == 3 {
            let labelled = shown.picture.bodies.iter().filter(|body| !body.label.is_empty());
            let named =
                labelled.filter_map(|body| Named::of(&body.label, body.positions.iter().filter_map(|p| project(*p))));
            labels::names(painter, &named.collect::<Vec<_>>(), paper, &taken);
        }
        for (_, _, place) in &shown.pins {
            if let Some(at) = project(*place) {
                plane::pin(painter, at, paper);
            }
        }
        for [node, pointer, force] in &shown.pulls {
            if let (Some(from), Some(to)) = (project(*node), project(*pointer)) {
                plane::rubber(look, from, to, force, &taken);
            }
        }
        for [node, end, force] in &shown.pushes {
            if let (Some(from), Some(to)) = (project(*node), project(*end)) {
                plane::push(look, from, to, force, &taken);
            }
        }
        let body = |name: &str| {
            let place = shown.bodies.iter().position(|body| body.name == name)?;
            shown.picture.bodies.get(place)
        };
        match &self.doing {
            Doing::Nothing => {
                if let Some(handles) = handles {
                    handles.paint(painter, paper);
                }
            }
            Doing::Handling(held) => {
                if let Some(body) = self.selected.as_deref().and_then(body) {
                    handles::ghost(painter, held, body, &project, paper);
                }
            }
            Doing::Shifting(name, start, depth) => {
                if let Some(body) = body(name)
                    && let Some(now) = painter.ctx().input(|i| i.pointer.latest_pos())
                    && let Some(end) = self.point(shown, rect, now, *depth)
                {
                    let moved = [0, 1, 2].map(|d| end[d] - start[d]);
                    plane::ghost(painter, body, moved, &project, paper);
                }
            }
            Doing::Drawing(points) => {
                let line: Vec<Pos2> = points.iter().filter_map(|p| project([p[0], p[1], 0.0])).collect();
                if let (Some(first), Some(last)) = (line.first(), line.last()) {
                    painter.line_segment([*last, *first], Stroke::new(1.0, paper.soft));
                }
                painter.line(line, Stroke::new(2.0, plane::RUBBER));
            }
            _ => {}
        }
        if !self.pulled
            && self.rect == Some(rect)
            && self.tool == Tool::Pull
            && self.doing == Doing::Nothing
            // A file that is about to be dropped has a hint of its own.
            && painter.ctx().input(|i| i.raw.hovered_files.is_empty())
            // Where the scene itself pulls, its force is to be read.
            && shown.pulls.is_empty()
            && let Some(body) = shown.picture.bodies.first()
            && let Some(top) = body.positions.iter().filter_map(|p| project(*p)).min_by(|a, b| a.y.total_cmp(&b.y))
            // What is far out of sight cannot be dragged.
            && rect.expand(0.2 * rect.width()).contains(top)
        {
            labels::hint(painter, top, rect, self.tools, legend, language.drag_me());
        }
    }
}

/// What is written over two scenes: where, what, and in which colour.
pub(super) struct Captions(Vec<(Rect, Arc<Galley>, Color32)>);

impl Captions {
    /// The room below a scene for them, and for the names of its lowest bodies above them: next to one another, one above the other
    /// [points].
    pub(super) const FOOT: [f32; 2] = [46.0, 32.0];

    /// What the two scenes are, how far they are from one another, and why the second one has stopped. The lower one of two, which has
    /// no tools above it, has it there, beside its legend.
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
        // Beside the legend, which the lower ones do not reach where the scenes stand next to one another.
        let free = legend.map_or(second.right(), |legend| legend.left());
        let beside_legend = (free - second.left() - 30.0).max(40.0);
        let room = if below { beside_legend } else { (second.width() - 40.0).max(40.0) };
        let mut caption = |spot: Pos2, align: Align2, text: String, ink: Color32, room: f32| {
            let galley = painter.layout(text, FontId::proportional(12.5), ink, room);
            let place = align.anchor_size(spot, galley.size());
            all.push((place, galley, ink));
            place
        };
        let low = |rect: Rect| rect.center_bottom() - Vec2::new(0.0, 8.0);
        caption(low(first), Align2::CENTER_BOTTOM, language.as_it_is().into(), paper.ink, room);
        let words: Vec<String> = beside.differences.iter().map(|difference| language.difference(difference)).collect();
        let words = if words.is_empty() { language.no_difference().into() } else { words.join(", ") };
        let far = match (beside.distances, beside.center) {
            (Some([mean, largest]), _) => {
                let [mean, largest] = [mean, largest].map(format_value);
                format!("\n{} {mean} m, {} {largest} m", language.mean_distance(), language.largest_distance())
            }
            // Where the nodes are others, their distances are none.
            (None, Some(far)) => format!("\n{} {} m", language.center_distance(), format_value(far)),
            (None, None) => String::new(),
        };
        let high = second.left_top() + Vec2::new(14.0, 10.0);
        let (spot, align) = if below { (high, Align2::LEFT_TOP) } else { (low(second), Align2::CENTER_BOTTOM) };
        let told = caption(spot, align, format!("{words}{far}"), paper.ink, room);
        if let Some(reason) = &beside.stopped {
            let text = format!("{}\n{}", language.right_stopped(), language.detail(reason));
            let middle = Pos2::new(0.5 * (second.left() + free), second.top() + 70.0);
            let under = Pos2::new(told.left(), told.bottom() + 12.0);
            let (spot, align) = if below { (under, Align2::LEFT_TOP) } else { (middle, Align2::CENTER_TOP) };
            caption(spot, align, text, Color32::from_rgb(230, 110, 60), beside_legend);
        }
        Captions(all)
    }

    /// What they take.
    pub(super) fn places(&self) -> Vec<Rect> {
        self.0.iter().map(|(place, ..)| ground(*place)).collect()
    }

    /// Writes them, and draws the line between the two scenes.
    pub(super) fn paint(self, painter: &Painter, paper: &Paper, [first, second]: [Rect; 2]) {
        let border = Stroke::new(1.5, paper.solid_edge);
        if second.left() > first.left() {
            painter.vline(second.left(), second.y_range(), border);
        } else {
            painter.hline(second.x_range(), second.top(), border);
        }
        for (place, galley, ink) in self.0 {
            painter.rect_filled(ground(place), 5.0, paper.background.gamma_multiply(0.85));
            painter.galley(place.min, galley, ink);
        }
    }
}

/// What is behind a caption.
fn ground(place: Rect) -> Rect {
    place.expand2(Vec2::new(7.0, 4.0))
}
