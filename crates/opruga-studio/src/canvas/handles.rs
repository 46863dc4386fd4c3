//! The handles of a selected body, which rotate and scale it.

use super::Canvas;
use super::look::{Paper, RUBBER};
use super::tool::Tool;
use crate::session::{Edit, Placed, Request};
use crate::shown::Shown;
use egui::{Painter, Pos2, Rect, Stroke, StrokeKind, Vec2};
use opruga::draw::{BodyPicture, Facets};

/// The largest distance of a press from a handle [points].
const REACH: f32 = 12.0;
/// The distance of the box from the body [points]. `STALK` is the distance of the rotation handle from the box [points].
const MARGIN: f32 = 8.0;
const STALK: f32 = 24.0;
/// The rotation in space for each point of displacement of the pointer [rad].
const TURN: f32 = 0.01;
/// The smallest and the largest factor of one drag.
const FACTORS: [f32; 2] = [0.1, 10.0];

/// The action of a handle.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Turn,
    Scale,
}

/// A handle that the pointer has grabbed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct GrabbedHandle {
    kind: Kind,
    name: String,
    middle: Pos2,
    from: Pos2,
    now: Pos2,
    space: bool,
}

impl GrabbedHandle {
    pub(super) fn lead(&mut self, at: Pos2) {
        self.now = at;
    }

    /// The clockwise rotation on the screen [rad], and the factor by which the body is scaled.
    fn change(&self) -> (f32, f32) {
        let (a, b) = (self.from - self.middle, self.now - self.middle);
        match self.kind {
            Kind::Turn if self.space => (TURN * (self.now.x - self.from.x), 1.0),
            Kind::Turn => (b.angle() - a.angle(), 1.0),
            Kind::Scale => (0.0, (b.length() / a.length().max(1.0)).clamp(FACTORS[0], FACTORS[1])),
        }
    }

    /// The request when the handle is released.
    pub(super) fn edit(self, dimension: u8, y_down: bool) -> Option<Request> {
        let (turned, scaled) = self.change();
        // On the screen y points downwards, and in most worlds upwards, so the sign of the rotation changes.
        let turned = f64::from(turned) * if dimension == 2 && !y_down { -1.0 } else { 1.0 };
        let still = turned.abs() < 1e-3 && (scaled - 1.0).abs() < 1e-3;
        let placed = Placed { moved: [0.0; 3], turned, scaled: f64::from(scaled) };
        (!still).then(|| Request::Edit(Edit::Transform(self.name, placed)))
    }
}

/// The box around a body on the screen.
pub(super) struct Handles {
    name: String,
    around: Rect,
    space: bool,
}

impl Handles {
    fn spot(&self, kind: Kind) -> Pos2 {
        match kind {
            Kind::Turn => self.around.center_top() - Vec2::new(0.0, STALK),
            Kind::Scale => self.around.right_bottom(),
        }
    }

    /// The handle that a press grabs.
    pub(super) fn at(self, at: Pos2) -> Option<GrabbedHandle> {
        let kind = [Kind::Turn, Kind::Scale].into_iter().find(|kind| self.spot(*kind).distance(at) < REACH)?;
        let Handles { name, around, space } = self;
        Some(GrabbedHandle { kind, name, middle: around.center(), from: at, now: at, space })
    }

    /// Draws the box and its handles.
    pub(super) fn paint(&self, painter: &Painter, paper: &Paper) {
        painter.rect_stroke(self.around, 2.0, Stroke::new(1.0, paper.soft), StrokeKind::Outside);
        painter.line_segment([self.around.center_top(), self.spot(Kind::Turn)], Stroke::new(1.0, paper.soft));
        painter.circle(self.spot(Kind::Turn), 6.0, paper.background, Stroke::new(2.0, RUBBER));
        let square = Rect::from_center_size(self.spot(Kind::Scale), Vec2::splat(11.0));
        painter.rect(square, 2.0, paper.background, Stroke::new(2.0, RUBBER), StrokeKind::Middle);
    }
}

impl Canvas {
    /// The handles of the selected body, if the tool is the one that moves bodies.
    pub(super) fn handles(&self, shown: &Shown, rect: Rect) -> Option<Handles> {
        let name = self.selected.clone().filter(|_| self.tool == Tool::Shift)?;
        let index = shown.bodies.iter().position(|body| body.name == name)?;
        let lens = self.scales.as_ref().and_then(|scales| self.space.lens(scales, rect));
        let mut around = Rect::NOTHING;
        for point in &shown.picture.bodies.get(index)?.positions {
            if let Some(at) = self.project(lens.as_ref(), shown, rect, *point) {
                around.extend_with(at);
            }
        }
        // The box is moved into the visible area even if the body is not there.
        let around = around.expand(MARGIN).intersect(rect.shrink(16.0));
        (around.width() > 4.0 && around.height() > 4.0).then_some(Handles { name, around, space: shown.dimension == 3 })
    }
}

/// Draws a preview of a body: its present shape, rotated and scaled about the centre of its box.
pub(super) fn ghost(
    painter: &Painter,
    grabbed: &GrabbedHandle,
    body: &BodyPicture,
    project: &dyn Fn([f64; 3]) -> Option<Pos2>,
    paper: &Paper,
) {
    let (turned, scaled) = grabbed.change();
    let turn = egui::emath::Rot2::from_angle(if grabbed.space { 0.0 } else { turned });
    let lines: &[[u32; 2]] = match &body.facets {
        Facets::Edges(edges) if !edges.is_empty() => edges,
        _ => &body.segments,
    };
    let at = |node: u32| {
        let seen = project(body.positions[node as usize])?;
        Some(grabbed.middle + turn * ((seen - grabbed.middle) * scaled))
    };
    for [a, b] in lines.iter().take(4_000) {
        if let (Some(from), Some(to)) = (at(*a), at(*b)) {
            painter.line_segment([from, to], Stroke::new(1.2, paper.soft));
        }
    }
    let text = match grabbed.kind {
        Kind::Turn => format!("{:.0}°", f64::from(turned).to_degrees()),
        Kind::Scale => format!("× {scaled:.2}"),
    };
    let spot = grabbed.now + Vec2::new(14.0, -12.0);
    painter.text(spot, egui::Align2::LEFT_BOTTOM, text, egui::FontId::proportional(14.0), paper.ink);
}
