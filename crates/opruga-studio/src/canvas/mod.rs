//! The scene on the screen, and what the pointer does there.

mod camera;
mod look;
mod pen;
mod pick;
mod plane;
mod space;
mod tool;
mod triangles;

use crate::session::{Edit, Grip, Placed, Request};
use crate::shown::Shown;
use crate::words::Language;
use camera::Flat;
use egui::{PointerButton, Pos2, Rect, Sense, Stroke, Ui, Vec2};
use look::{Look, Paper};
use opruga::draw::View;
use pick::Under;
use std::sync::Arc;
pub use tool::Tool;

/// What the pointer is doing.
#[derive(Clone, Debug, Default, PartialEq)]
enum Doing {
    #[default]
    Nothing,
    /// A body is held; in space at this distance from the camera [m].
    Holding(f64),
    /// The view moves along.
    Panning,
    /// The view turns.
    Turning,
    /// A body is taken elsewhere, from this point of the world.
    Shifting(String, [f64; 3], f64),
    /// An outline is drawn.
    Drawing(Vec<[f64; 2]>),
}

/// The part of the window where the scene is.
#[derive(Debug, Default)]
pub struct Canvas {
    /// What a press does.
    pub tool: Tool,
    /// The body that was pressed last.
    pub selected: Option<String>,
    /// Where it is in the window.
    rect: Option<Rect>,
    flat: Flat,
    space: space::Space,
    scales: Option<View>,
    fitted: u64,
    /// The size of the window for which the scene was fitted; none once somebody has moved the view.
    fitted_size: Option<Vec2>,
    doing: Doing,
    fills: triangles::Fills,
    /// The ends of the colours.
    range: Option<[f64; 2]>,
    /// Whether a person has pulled already: then no hint is needed.
    pub pulled: bool,
    /// Why an outline was refused, until the next one.
    pub refused: Option<&'static str>,
    /// Whether the space bar has taken the view along since it was pressed: then it does not let time pass.
    pub panned: bool,
}

/// A press of the pointer.
#[derive(Clone, Copy)]
struct Press {
    button: PointerButton,
    at: Pos2,
    /// Where the scene is.
    rect: Rect,
    /// Whether the space bar is held.
    space: bool,
    shift: bool,
}

impl Canvas {
    /// Whether pictures of space are still being drawn.
    pub fn is_drawing(&self) -> bool {
        self.space.is_drawing()
    }

    /// Shows everything again.
    pub fn fit(&mut self) {
        self.fitted = 0;
    }

    /// The middle of what is seen [m]: where new bodies are put.
    pub fn middle(&self, shown: &Shown) -> [f64; 3] {
        if shown.dimension == 3 { self.space.eye().map_or([0.0; 3], |eye| eye.target) } else { self.flat.middle() }
    }

    /// Where a point of the scene is in the window.
    pub fn on_screen(&self, shown: &Shown, point: [f64; 3]) -> Option<Pos2> {
        let rect = self.rect?;
        if shown.dimension == 3 {
            let ([x, y], _) = self.space.lens(self.scales.as_ref()?, rect)?.see(point)?;
            return Some(rect.min + Vec2::new(x as f32, y as f32));
        }
        Some(self.flat.to_screen(rect, point, shown.picture.y_down))
    }

    /// Shows a scene in all the room that is left, and says what the pointer asks for.
    pub fn show(&mut self, ui: &mut Ui, shown: &Arc<Shown>, language: Language) -> Vec<Request> {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "canvas"));
        // A window without any size, as a minimised one, shows nothing.
        if rect.width() < 2.0 || rect.height() < 2.0 || shown.dimension == 0 {
            return Vec::new();
        }
        self.rect = Some(rect);
        let paper = Paper::of(ui);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, paper.background);
        self.fit_if_new(shown, rect);
        self.fit_colours(shown);
        let mut asks = Vec::new();
        self.navigate(ui, &response, shown, rect);
        let under = response.hover_pos().and_then(|at| self.under(shown, rect, at));
        self.press(ui, &response, shown, rect, under.as_ref(), &mut asks);
        let range = self.range.unwrap_or([0.0, 1.0]);
        let look = Look { painter: &painter, shown, rect, paper: &paper, range };
        if shown.dimension == 3 {
            if let Some(scales) = &self.scales {
                self.space.show(ui, &look, shown, scales);
            }
        } else {
            plane::paint(&look, &self.flat, &mut self.fills, self.selected.as_deref());
        }
        self.overlays(&look, under.as_ref(), language);
        plane::legend(&look);
        asks
    }

    fn fit_if_new(&mut self, shown: &Shown, rect: Rect) {
        if self.fitted == shown.opened && self.scales.is_some() {
            // The view follows the window until somebody moves it.
            if let (Some(size), Some(view)) = (self.fitted_size, &self.scales)
                && size != rect.size()
            {
                self.flat.fit(view, rect);
                self.fitted_size = Some(rect.size());
            }
            return;
        }
        self.fitted_size = Some(rect.size());
        let first = self.fitted != 0;
        self.fitted = shown.opened;
        self.scales = View::fit([&shown.picture]).ok().map(|view| with_floors(view, shown));
        if let Some(view) = &self.scales {
            self.flat.fit(view, rect);
            self.space.fit(view);
        }
        self.range = None;
        self.fills.forget();
        if first {
            self.selected = None;
        }
        let only = (shown.bodies.len() == 1).then(|| shown.bodies[0].name.clone());
        self.selected = self.selected.take().or(only);
        self.doing = Doing::Nothing;
    }

    /// The ends of the colours follow what is there: at once outwards, slowly inwards.
    fn fit_colours(&mut self, shown: &Shown) {
        let scalars = shown.picture.bodies.iter().flat_map(|body| &body.scalar).filter(|s| s.is_finite());
        let (low, high) = scalars.fold((f64::MAX, f64::MIN), |(a, b), s| (a.min(*s), b.max(*s)));
        if low > high {
            return;
        }
        // What is nearly nothing is not spread over all colours.
        let least = match shown.picture.legend.as_ref().map_or("", |legend| &legend.unit) {
            "%" | "Pa" => 1.0,
            _ => 0.01,
        };
        let least = f64::max(least, 1e-3 * low.abs().max(high.abs()));
        let now = [low, high.max(low + least)];
        let slowly = |old: f64, new: f64| old + 0.01 * (new - old);
        self.range = Some(match self.range {
            Some([a, b]) if a <= now[1] && b >= now[0] => [
                if now[0] < a { now[0] } else { slowly(a, now[0]) },
                if now[1] > b { now[1] } else { slowly(b, now[1]) },
            ],
            _ => now,
        });
    }

    /// Forgets the ends of the colours: another quantity has others.
    pub fn forget_colours(&mut self) {
        self.range = None;
    }

    fn under(&self, shown: &Shown, rect: Rect, at: Pos2) -> Option<Under> {
        if shown.dimension == 3 {
            let lens = self.space.lens(self.scales.as_ref()?, rect)?;
            pick::in_space(shown, &lens, rect, at)
        } else {
            pick::in_plane(shown, &self.flat, rect, at)
        }
    }

    /// The point of the world under the pointer; in space at a distance from the camera.
    fn point(&self, shown: &Shown, rect: Rect, at: Pos2, distance: f64) -> Option<[f64; 3]> {
        if shown.dimension == 3 {
            let lens = self.space.lens(self.scales.as_ref()?, rect)?;
            let pixel = at - rect.min;
            Some(lens.point([f64::from(pixel.x), f64::from(pixel.y)], distance))
        } else {
            let [x, y] = self.flat.to_world(rect, at, shown.picture.y_down);
            Some([x, y, 0.0])
        }
    }

    /// Wheel, pinch, and dragging of the view.
    fn navigate(&mut self, ui: &Ui, response: &egui::Response, shown: &Shown, rect: Rect) {
        let Some(at) = response.hover_pos() else { return };
        let (scroll, pinch, touch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta(), i.multi_touch()));
        let at = touch.map_or(at, |touch| touch.center_pos);
        let factor = f64::from((scroll * 0.004).exp() * pinch);
        if factor != 1.0 {
            self.fitted_size = None;
            if shown.dimension == 3 {
                self.space.zoom(factor)
            } else {
                self.flat.zoom(factor, rect, at, shown.picture.y_down)
            }
        }
        if let Some(touch) = touch {
            self.pan(shown, rect, touch.translation_delta);
        }
    }

    fn pan(&mut self, shown: &Shown, rect: Rect, delta: Vec2) {
        if delta != Vec2::ZERO {
            self.fitted_size = None;
        }
        if shown.dimension == 3 {
            if let Some(scales) = &self.scales {
                self.space.pan(scales, rect, delta);
            }
        } else {
            self.flat.pan(delta, shown.picture.y_down);
        }
    }

    fn press(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        shown: &Shown,
        rect: Rect,
        under: Option<&Under>,
        asks: &mut Vec<Request>,
    ) {
        let (space_down, shift, pressed, at, down) = ui.input(|i| {
            let buttons = [PointerButton::Primary, PointerButton::Secondary, PointerButton::Middle];
            let pressed = buttons.into_iter().find(|b| i.pointer.button_pressed(*b));
            (i.key_down(egui::Key::Space), i.modifiers.shift, pressed, i.pointer.latest_pos(), i.pointer.any_down())
        });
        let Some(at) = at else { return };
        // Two fingers move the view: what the first of them took hold of is let go.
        if ui.input(|i| i.multi_touch().is_some()) {
            if let Doing::Holding(_) = std::mem::take(&mut self.doing) {
                asks.push(Request::Release);
            }
            return;
        }
        if self.doing == Doing::Nothing
            && let Some(button) = pressed
            && response.contains_pointer()
        {
            self.refused = None;
            let press = Press { button, at, rect, space: space_down, shift };
            self.begin(press, shown, under, asks);
        }
        if response.double_clicked()
            && let Some(under) = under
        {
            match shown.pins.iter().find(|pin| near_pin(under, pin)) {
                Some((body, node, _)) => asks.push(Request::Unpin(*body, *node)),
                None if shown.dimension == 3 => self.space.look_at(under.point),
                None => {}
            }
        }
        let delta = ui.input(|i| i.pointer.delta());
        match &mut self.doing {
            Doing::Nothing => {}
            Doing::Holding(distance) => {
                let distance = *distance;
                if let Some(point) = self.point(shown, rect, at, distance) {
                    asks.push(Request::Lead(point));
                }
                ui.ctx().request_repaint();
            }
            Doing::Panning => self.pan(shown, rect, delta),
            Doing::Turning => self.space.turn(delta),
            Doing::Shifting(..) => {}
            Doing::Drawing(points) => {
                let point = self.flat.to_world(rect, at, shown.picture.y_down);
                if points.last().is_none_or(|last| *last != point) {
                    points.push(point);
                }
            }
        }
        if !down {
            self.end(shown, rect, at, asks);
        }
    }

    fn begin(&mut self, press: Press, shown: &Shown, under: Option<&Under>, asks: &mut Vec<Request>) {
        let Press { button, at, rect, space, shift } = press;
        if button == PointerButton::Middle || space {
            self.panned = space;
            self.doing = Doing::Panning;
            return;
        }
        if self.tool == Tool::Draw && button == PointerButton::Primary {
            if shown.dimension == 2 {
                self.doing = Doing::Drawing(Vec::new());
            } else {
                self.refused = Some("only_plane");
            }
            return;
        }
        let Some(under) = under else {
            // Beside all bodies the view is taken along, in space it turns.
            self.doing = if shown.dimension == 3 { Doing::Turning } else { Doing::Panning };
            return;
        };
        self.selected = Some(under.name.clone());
        let grip = match (button, shift, self.tool) {
            (PointerButton::Secondary, ..) => Grip::Push,
            (_, true, _) | (_, _, Tool::Pin) => Grip::Pin,
            (_, _, Tool::Push) => Grip::Push,
            (_, _, Tool::Shift) => {
                let start = self.point(shown, rect, at, under.distance).unwrap_or(under.point);
                self.doing = Doing::Shifting(under.name.clone(), start, under.distance);
                return;
            }
            _ => Grip::Pull,
        };
        self.pulled |= grip == Grip::Pull;
        // What is pinned is taken by its own place, so that the same node is found again.
        let pinned = shown.pins.iter().find(|pin| near_pin(under, pin)).map(|pin| pin.2);
        asks.push(Request::Grab(grip, under.body, pinned.filter(|_| grip == Grip::Pin).unwrap_or(under.point)));
        self.doing = Doing::Holding(under.distance);
    }

    fn end(&mut self, shown: &Shown, rect: Rect, at: Pos2, asks: &mut Vec<Request>) {
        match std::mem::take(&mut self.doing) {
            Doing::Holding(_) => asks.push(Request::Release),
            Doing::Shifting(name, start, distance) => {
                if let Some(end) = self.point(shown, rect, at, distance) {
                    let moved = [0, 1, 2].map(|d| end[d] - start[d]);
                    if moved.iter().any(|d| d.abs() > 1e-9) {
                        asks.push(Request::Edit(Edit::Place(name, Placed { moved, turned: 0.0, scaled: 1.0 })));
                    }
                }
            }
            Doing::Drawing(points) => match pen::body(&points, self.flat.metres(6.0)) {
                Ok(table) => asks.push(Request::Edit(Edit::Add(table))),
                Err(why) => self.refused = Some(why),
            },
            _ => {}
        }
    }

    /// Pins, pulls with their force, the outline that is drawn, the hint for the first pull.
    fn overlays(&self, look: &Look<'_>, under: Option<&Under>, language: Language) {
        let Look { painter, shown, rect, paper, .. } = *look;
        let lens = self.scales.as_ref().and_then(|scales| self.space.lens(scales, rect));
        let project = |point: [f64; 3]| -> Option<Pos2> {
            if shown.dimension == 3 {
                let ([x, y], _) = lens.as_ref()?.see(point)?;
                Some(rect.min + Vec2::new(x as f32, y as f32))
            } else {
                Some(self.flat.to_screen(rect, point, shown.picture.y_down))
            }
        };
        if let (Some(under), Doing::Nothing) = (under, &self.doing)
            && let Some(at) = project(under.point)
        {
            painter.circle_stroke(at, 7.0, Stroke::new(1.5, paper.ink));
        }
        if shown.dimension == 3 {
            for body in shown.picture.bodies.iter().filter(|body| !body.label.is_empty()) {
                let spots: Vec<Pos2> = body.positions.iter().filter_map(|p| project(*p)).collect();
                plane::label(painter, &body.label, &spots, paper);
            }
        }
        for (_, _, place) in &shown.pins {
            if let Some(at) = project(*place) {
                plane::pin(painter, at, paper);
            }
        }
        for [node, pointer, force] in &shown.pulls {
            if let (Some(from), Some(to)) = (project(*node), project(*pointer)) {
                plane::rubber(painter, from, to, force, paper);
            }
        }
        if let Doing::Shifting(name, start, distance) = &self.doing
            && let Some(place) = shown.bodies.iter().position(|body| body.name == *name)
            && let Some(now) = painter.ctx().input(|i| i.pointer.latest_pos())
            && let Some(end) = self.point(shown, rect, now, *distance)
        {
            let moved = [0, 1, 2].map(|d| end[d] - start[d]);
            plane::ghost(painter, &shown.picture.bodies[place], moved, &project, paper);
        }
        if let Doing::Drawing(points) = &self.doing {
            let line: Vec<Pos2> = points.iter().filter_map(|p| project([p[0], p[1], 0.0])).collect();
            if let (Some(first), Some(last)) = (line.first(), line.last()) {
                painter.line_segment([*last, *first], Stroke::new(1.0, paper.soft));
            }
            painter.line(line, Stroke::new(2.0, plane::RUBBER));
        }
        if !self.pulled
            && self.tool == Tool::Pull
            && self.doing == Doing::Nothing
            && let Some(body) = shown.picture.bodies.first()
            && let Some(top) = body.positions.iter().filter_map(|p| project(*p)).min_by(|a, b| a.y.total_cmp(&b.y))
        {
            plane::hint(painter, top, rect, language.drag_me());
        }
    }
}

/// A view with the floors and walls that bodies may come to: at the start they are often far above them.
fn with_floors(mut view: View, shown: &Shown) -> View {
    let center = view.center();
    let size = view.extent();
    for collider in &shown.picture.colliders {
        let opruga::draw::ColliderPicture::HalfSpace { point, normal } = collider else { continue };
        let long = normal.iter().map(|n| n * n).sum::<f64>();
        let height = (0..3).map(|d| normal[d] * (center[d] - point[d])).sum::<f64>() / long.max(1e-300);
        let foot = [0, 1, 2].map(|d| center[d] - height * normal[d]);
        // A floor far away would make everything small.
        if foot.iter().zip(&center).all(|(a, b)| (a - b).abs() < 8.0 * size) {
            for d in 0..3 {
                view.low[d] = view.low[d].min(foot[d] - 0.05 * size);
                view.high[d] = view.high[d].max(foot[d] + 0.05 * size);
            }
        }
    }
    if shown.dimension == 2 {
        (view.low[2], view.high[2]) = (0.0, 0.0);
    }
    view
}

fn near_pin(under: &Under, pin: &(usize, u32, [f64; 3])) -> bool {
    let far: f64 = under.point.iter().zip(&pin.2).map(|(a, b)| (a - b) * (a - b)).sum();
    under.body == pin.0 && far.sqrt() <= 3.0 * under.pixel * 6.0
}
