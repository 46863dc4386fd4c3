//! Draws over the scene: pins, pulls with their forces, the action of the pointer, and the hint for the first pull.

use super::labels::{self, Named};
use super::look::{Look, RUBBER};
use super::pick::Under;
use super::tool::Tool;
use super::{Canvas, Doing, handles, plane};
use crate::shown::Shown;
use crate::words::Language;
use egui::{Pos2, Rect, Stroke, Vec2};
use opruga::draw::Lens;

impl Canvas {
    /// The position of a point in the window; in space, none for points behind the camera.
    pub(super) fn project(&self, lens: Option<&Lens>, shown: &Shown, rect: Rect, point: [f64; 3]) -> Option<Pos2> {
        if shown.dimension == 3 {
            let ([x, y], _) = lens?.see(point)?;
            Some(rect.min + Vec2::new(x as f32, y as f32))
        } else {
            Some(self.flat.to_screen(rect, point, shown.picture.y_down))
        }
    }

    /// Draws pins, pulls with their forces, the outline that the user is drawing, and the hint for the first pull. No text covers the legend.
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
        for (_, _, point) in &shown.pins {
            if let Some(at) = project(*point) {
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
            let index = shown.bodies.iter().position(|body| body.name == name)?;
            shown.picture.bodies.get(index)
        };
        match &self.doing {
            Doing::Nothing => {
                if let Some(handles) = handles {
                    handles.paint(painter, paper);
                }
            }
            Doing::Handling(grabbed) => {
                if let Some(body) = self.selected.as_deref().and_then(body) {
                    handles::ghost(painter, grabbed, body, &project, paper);
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
                painter.line(line, Stroke::new(2.0, RUBBER));
            }
            _ => {}
        }
        if !self.pulled
            && self.rect == Some(rect)
            && self.tool == Tool::Pull
            && self.doing == Doing::Nothing
            // While a file is dragged over the window, another hint is shown.
            && painter.ctx().input(|i| i.raw.hovered_files.is_empty())
            // If the scene itself contains a pull, its force is shown instead of the hint.
            && shown.pulls.is_empty()
            && let Some(body) = shown.picture.bodies.first()
            && let Some(top) = body.positions.iter().filter_map(|p| project(*p)).min_by(|a, b| a.y.total_cmp(&b.y))
            // A body far out of sight cannot be dragged.
            && rect.expand(0.2 * rect.width()).contains(top)
        {
            labels::hint(painter, top, rect, self.tools, legend, language.drag_me());
        }
    }
}
