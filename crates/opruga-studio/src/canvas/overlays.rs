//! What is drawn over the scene: pins, pulls with their force, what the hand is doing, the hint for the first pull.

use super::look::Look;
use super::pick::Under;
use super::tool::Tool;
use super::{Canvas, Doing, handles, labels, plane};
use crate::shown::{Beside, Shown};
use crate::words::Language;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2};
use opruga::draw::{Lens, format_value};

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
    pub(super) fn overlays(&self, look: &Look<'_>, under: Option<&Under>, legend: Option<Rect>, language: Language) {
        let Look { painter, shown, rect, paper, .. } = *look;
        let lens = self.scales.as_ref().and_then(|scales| self.space.lens(scales, rect));
        let project = |point: [f64; 3]| self.project(lens.as_ref(), shown, rect, point);
        let handles = self.handles(shown, rect);
        if let (Some(under), Doing::Nothing) = (under, &self.doing)
            && let Some(at) = project(under.point)
        {
            painter.circle_stroke(at, 7.0, Stroke::new(1.5, paper.ink));
        }
        let taken: Vec<Rect> = legend.into_iter().chain(self.tools).collect();
        if shown.dimension == 3 {
            let mut names = taken.clone();
            for body in shown.picture.bodies.iter().filter(|body| !body.label.is_empty()) {
                let spots: Vec<Pos2> = body.positions.iter().filter_map(|p| project(*p)).collect();
                labels::label(painter, &body.label, &spots, paper, &mut names);
            }
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
            Doing::Shifting(name, start, distance) => {
                if let Some(body) = body(name)
                    && let Some(now) = painter.ctx().input(|i| i.pointer.latest_pos())
                    && let Some(end) = self.point(shown, rect, now, *distance)
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

/// What the two scenes are, how far they are from one another, and why the second one has stopped.
pub(super) fn captions(look: &Look<'_>, whole: &Painter, first: Rect, beside: &Beside, language: Language) {
    let Look { rect, paper, .. } = *look;
    let border = Stroke::new(1.5, paper.solid_edge);
    if rect.left() > first.left() {
        whole.vline(rect.left(), rect.y_range(), border);
    } else {
        whole.hline(rect.x_range(), rect.top(), border);
    }
    let caption = |spot: Pos2, align: Align2, text: String, ink: Color32, width: f32| {
        let galley = whole.layout(text, FontId::proportional(12.5), ink, width);
        let place = align.anchor_size(spot, galley.size());
        whole.rect_filled(place.expand2(Vec2::new(7.0, 4.0)), 5.0, paper.background.gamma_multiply(0.85));
        whole.galley(place.min, galley, ink);
    };
    let room = (rect.width() - 40.0).max(40.0);
    let low = |rect: Rect| rect.center_bottom() - Vec2::new(0.0, 12.0);
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
    caption(low(rect), Align2::CENTER_BOTTOM, format!("{words}{far}"), paper.ink, room);
    if let Some(reason) = &beside.stopped {
        let text = format!("{}\n{}", language.right_stopped(), language.detail(reason));
        caption(
            rect.center_top() + Vec2::new(0.0, 70.0),
            Align2::CENTER_TOP,
            text,
            Color32::from_rgb(230, 110, 60),
            room,
        );
    }
}
