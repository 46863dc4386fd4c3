//! The scene on the screen, and what the pointer does there.

mod camera;
mod handles;
mod look;
mod outline;
mod overlays;
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
use egui::{PointerButton, Pos2, Rect, Sense, Ui, Vec2};
use look::{Look, Paper};
use opruga::draw::{ColliderPicture, View};
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
    /// A body is turned or scaled by one of its handles.
    Handling(handles::Held),
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
    /// Where the tools lie over it.
    pub tools: Option<Rect>,
    flat: Flat,
    space: space::Space,
    /// What draws the scene beside it.
    beside: space::Space,
    beside_fills: triangles::Fills,
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
    /// Whether it is on the scene that is only looked at.
    beside: bool,
}

impl Canvas {
    /// Whether pictures of space are still being drawn.
    pub fn is_drawing(&self) -> bool {
        self.space.is_drawing() || self.beside.is_drawing()
    }

    /// Shows everything again.
    pub fn fit(&mut self) {
        self.fitted = 0;
    }

    /// Shows the selected body alone.
    pub fn focus(&mut self, shown: &Shown) {
        let place = shown.bodies.iter().position(|body| Some(&body.name) == self.selected.as_ref());
        let Some(body) = place.and_then(|place| shown.picture.bodies.get(place)) else { return };
        let picture = opruga::draw::Picture { bodies: vec![body.clone()], ..opruga::draw::Picture::default() };
        let Ok(view) = View::fit([&opruga::draw::Picture { dimension: shown.dimension, ..picture }]) else { return };
        self.fitted_size = None;
        self.space.look_at_all(&view);
        if let Some(rect) = self.rect {
            self.flat.fit(&view, rect, self.tools);
        }
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
        let (whole, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "canvas"));
        // A window without any size, as a minimised one, shows nothing.
        if whole.width() < 4.0 || whole.height() < 4.0 || shown.dimension == 0 {
            return Vec::new();
        }
        let (rect, other) = halves(whole, shown.beside.is_some());
        self.rect = Some(rect);
        let paper = Paper::of(ui);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, paper.background);
        self.fit_if_new(shown, rect);
        self.fit_colours(shown);
        self.follow_names(shown);
        let mut asks = Vec::new();
        // What is beside is looked at; it moves with the view of the scene that is worked on.
        let within = |at: Pos2| match other {
            Some(other) if other.contains(at) => (at - other.min.to_vec2() + rect.min.to_vec2(), true),
            _ => (at, false),
        };
        let hover = response.hover_pos().map(within);
        self.navigate(ui, hover.map(|(at, _)| at), shown, rect);
        self.space.receive(ui);
        self.beside.receive(ui);
        // Pictures of space are a moment behind: what is pressed is what is seen.
        let seen = self.space.seen().filter(|seen| shown.dimension == 3 && seen.opened == shown.opened).cloned();
        let seen = seen.unwrap_or_else(|| Arc::clone(shown));
        let under = hover.filter(|(_, beside)| !beside).and_then(|(at, _)| self.under(&seen, rect, at));
        let beside = hover.is_some_and(|(_, beside)| beside);
        self.press(ui, &response, shown, rect, under.as_ref(), beside, &mut asks);
        let range = self.range.unwrap_or([0.0, 1.0]);
        let look = Look { painter: &painter, shown, rect, paper: &paper, range };
        self.paint(ui, &look, shown, false);
        self.overlays(&Look { shown: &seen, ..look }, under.as_ref(), language);
        if other.is_none() {
            plane::legend(&look, self.tools, language);
        }
        if let (Some(other), Some(beside)) = (other, &shown.beside) {
            let painter = ui.painter_at(other);
            painter.rect_filled(other, 0.0, paper.background);
            let look = Look { painter: &painter, shown: &beside.right, rect: other, paper: &paper, range };
            self.paint(ui, &look, &beside.right, true);
            plane::legend(&look, self.tools, language);
            overlays::captions(&look, &ui.painter_at(whole), rect, beside, language);
        }
        asks
    }

    /// Draws a scene; the second one has a painter of its own, and the eye of the first.
    fn paint(&mut self, ui: &Ui, look: &Look<'_>, shown: &Arc<Shown>, beside: bool) {
        let selected = self.selected.as_deref();
        if shown.dimension == 3 {
            let Some(scales) = &self.scales else { return };
            if beside {
                self.beside.share_eye(&self.space);
            }
            let space = if beside { &mut self.beside } else { &mut self.space };
            space.show(ui, look, shown, scales, selected);
        } else {
            let fills = if beside { &mut self.beside_fills } else { &mut self.fills };
            plane::paint(look, &self.flat, fills, selected);
        }
    }

    /// A body that was set down anew under another name stays selected.
    fn follow_names(&mut self, shown: &Shown) {
        let Some(selected) = &self.selected else { return };
        if shown.bodies.iter().any(|body| body.name == *selected) {
            return;
        }
        if let Some((_, new)) = shown.renamed.iter().rev().find(|(old, _)| old == selected) {
            self.selected = Some(new.clone());
        }
    }

    fn fit_if_new(&mut self, shown: &Shown, rect: Rect) {
        if self.fitted == shown.opened && self.scales.is_some() {
            // The view follows the window until somebody moves it.
            if let (Some(size), Some(view)) = (self.fitted_size, &self.scales)
                && size != rect.size()
            {
                self.flat.fit(view, rect, self.tools);
                self.fitted_size = Some(rect.size());
            }
            return;
        }
        self.fitted_size = Some(rect.size());
        let first = self.fitted != 0;
        self.fitted = shown.opened;
        let beside = shown.beside.iter().map(|beside| &beside.right.picture);
        self.scales = View::fit([&shown.picture].into_iter().chain(beside)).ok().map(|view| with_floors(view, shown));
        if let Some(view) = &self.scales {
            self.flat.fit(view, rect, self.tools);
            self.space.fit(view);
        }
        self.range = None;
        self.fills.forget();
        self.beside_fills.forget();
        if first {
            self.selected = None;
        }
        let only = (shown.bodies.len() == 1).then(|| shown.bodies[0].name.clone());
        self.selected = self.selected.take().or(only);
        self.doing = Doing::Nothing;
    }

    /// The ends of the colours follow what is there: at once outwards, slowly inwards.
    fn fit_colours(&mut self, shown: &Shown) {
        let beside = shown.beside.iter().flat_map(|beside| &beside.right.picture.bodies);
        let bodies = shown.picture.bodies.iter().chain(beside);
        let scalars = bodies.flat_map(|body| &body.scalar).filter(|s| s.is_finite());
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
    fn navigate(&mut self, ui: &Ui, at: Option<Pos2>, shown: &Shown, rect: Rect) {
        let Some(at) = at else { return };
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

    #[allow(clippy::too_many_arguments, reason = "all of them describe one press")]
    fn press(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        shown: &Shown,
        rect: Rect,
        under: Option<&Under>,
        beside: bool,
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
        let began = self.doing == Doing::Nothing && pressed.is_some() && response.contains_pointer();
        if let (true, Some(button)) = (began, pressed) {
            self.refused = None;
            let press = Press { button, at, rect, space: space_down, shift, beside };
            self.begin(press, shown, under, asks);
        }
        if response.double_clicked()
            && let Some(under) = under
        {
            match pin_under(shown, under) {
                Some((body, node, _)) => asks.push(Request::Unpin(body, node)),
                None if shown.dimension == 3 => self.space.look_at(under.point),
                None => {}
            }
        }
        // On a slow screen a press comes together with the way to it, which does not count.
        let delta = if began { Vec2::ZERO } else { ui.input(|i| i.pointer.delta()) };
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
            Doing::Turning => {
                let up =
                    |c: &ColliderPicture| matches!(c, ColliderPicture::HalfSpace { normal, .. } if normal[1] > 0.0);
                self.space.turn(delta, shown.picture.colliders.iter().any(up));
            }
            Doing::Shifting(..) => {}
            Doing::Handling(held) => held.lead(at),
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
        let Press { button, at, rect, space, shift, beside } = press;
        if button == PointerButton::Middle || space {
            self.panned = space;
            self.doing = Doing::Panning;
            return;
        }
        if self.tool == Tool::Shift
            && button == PointerButton::Primary
            && !beside
            && let Some(held) = self.handles(shown, rect).and_then(|handles| handles.at(at))
        {
            self.doing = Doing::Handling(held);
            return;
        }
        if self.tool == Tool::Draw && !beside && button == PointerButton::Primary {
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
        let pinned = pin_under(shown, under).map(|pin| pin.2);
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
            Doing::Handling(held) => asks.extend(held.edit(shown.dimension, shown.picture.y_down)),
            Doing::Drawing(points) => match pen::body(&points, self.flat.metres(6.0)) {
                Ok(table) => asks.push(Request::Edit(Edit::Add(table))),
                Err(why) => self.refused = Some(why),
            },
            _ => {}
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

/// The pin under the pointer, of a person or of the scene: body, node, place [m].
fn pin_under(shown: &Shown, under: &Under) -> Option<(usize, u32, [f64; 3])> {
    let own = shown.bodies.iter().position(|body| body.number == under.body);
    let own = own.and_then(|place| shown.picture.bodies.get(place));
    let of_scene = own.into_iter().flat_map(|body| {
        let place = |node: &u32| Some((under.body, *node, *body.positions.get(*node as usize)?));
        body.pinned.iter().filter_map(place)
    });
    shown.pins.iter().copied().chain(of_scene).find(|(body, _, place)| {
        let far: f64 = under.point.iter().zip(place).map(|(a, b)| (a - b) * (a - b)).sum();
        under.body == *body && far.sqrt() <= 3.0 * under.pixel * 6.0
    })
}

/// The part of the scene and that of the one beside it: next to one another, on a high window one above the other.
fn halves(whole: Rect, two: bool) -> (Rect, Option<Rect>) {
    if !two {
        return (whole, None);
    }
    let (first, second) = if whole.width() >= whole.height() {
        whole.split_left_right_at_fraction(0.5)
    } else {
        whole.split_top_bottom_at_fraction(0.5)
    };
    (first, Some(second))
}
