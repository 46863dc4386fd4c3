//! The scene on the screen, and the actions of the pointer on it.

mod arrows;
mod away;
mod brush;
mod camera;
mod captions;
mod detail;
mod fitting;
mod handles;
mod labels;
mod legend;
mod look;
mod outlines;
mod overlays;
mod pen;
mod pick;
mod plane;
mod pressing;
mod space;
mod tool;

use crate::session::Request;
use crate::shown::{Show, Shown};
use crate::words::Language;
use camera::{Flat, halves};
use captions::Captions;
use egui::{Pos2, Rect, Sense, Ui, Vec2};
use look::{Look, Paper};
use opruga::draw::View;
use pick::Under;
use std::sync::Arc;
pub use tool::Tool;

/// The present action of the pointer.
#[derive(Clone, Debug, Default, PartialEq)]
enum Doing {
    #[default]
    Nothing,
    /// The pointer holds a body. In space, the held point is at this distance [m] behind the point in the centre of the view. A push also gives the
    /// point at which the pointer was pressed and the grabbed point of the body [m].
    Holding(f64, Option<[[f64; 3]; 2]>),
    /// The view is moved.
    Panning,
    /// The view is rotated.
    Turning,
    /// The body with this name is moved, beginning at this point of the world. In space, the point is at this distance [m] behind the point in the
    /// centre of the view.
    Shifting(String, [f64; 3], f64),
    /// A body is rotated or scaled by one of its handles.
    Handling(handles::GrabbedHandle),
    /// An outline is drawn.
    Drawing(Vec<[f64; 2]>),
}

/// The part of the window that shows the scene.
#[derive(Debug, Default)]
pub struct Canvas {
    /// The action of a press of the pointer.
    pub tool: Tool,
    /// The body that was pressed last.
    pub selected: Option<String>,
    /// The last body that was added or copied.
    newest: Option<(u64, String)>,
    /// The rectangle of the scene in the window.
    rect: Option<Rect>,
    /// The rectangle of the tools over the scene.
    pub tools: Option<Rect>,
    /// The quantities and marks that the user wants to see.
    pub wanted: Show,
    /// The rectangles of legends and captions.
    written: Vec<Rect>,
    /// The rectangle of the scene beside this one.
    other: Option<Rect>,
    /// The largest magnitude among the arrows of every kind.
    arrows: arrows::Longest,
    flat: Flat,
    space: space::Space,
    /// The renderer of the scene beside this one.
    beside: space::Space,
    kept_beside: plane::Kept,
    scales: Option<View>,
    /// The lowest and the highest corner of the scene when the view was fitted [m].
    first: [[f64; 3]; 2],
    fitted: u64,
    /// The number of replacements of the state up to the previous picture ([`Shown::replaced`]).
    replaced: u64,
    /// The number of resets to the start up to the previous picture.
    resets: u64,
    /// The number of the message of a body that has exploded, while there is one.
    exploded: Option<u64>,
    /// The number of the message of the last motion that has failed.
    failed: Option<u64>,
    /// Whether the view was fitted to a failed motion whose bodies are far away.
    far: bool,
    /// The size of the window for which the scene was fitted; none after the user has moved the view.
    fitted_size: Option<Vec2>,
    doing: Doing,
    /// A pull that begins as soon as the pointer moves or time passes.
    waiting: Option<pressing::Waiting>,
    /// The offset from the pointer to the corresponding point on the left side.
    offset: Vec2,
    kept: plane::Kept,
    /// The range of the colours.
    range: Option<[f64; 2]>,
    /// Whether the user has already pulled, so that no hint is needed.
    pub pulled: bool,
    /// The reason why the last outline was refused.
    pub refused: Option<&'static str>,
    /// Whether the view was moved while the space bar was held. The space bar then does not start or stop time when it is released.
    pub panned: bool,
}

impl Canvas {
    /// Whether pictures in space are still being drawn.
    pub fn is_drawing(&self) -> bool {
        self.space.is_drawing() || self.beside.is_drawing()
    }

    /// Causes all pictures to be uploaded again after their device was lost.
    #[cfg(target_arch = "wasm32")]
    pub fn forget_textures(&mut self) {
        self.space.forget_texture();
        self.beside.forget_texture();
    }

    /// Shows everything again.
    pub fn fit(&mut self) {
        self.fitted = 0;
    }

    /// Shows the selected body alone.
    pub fn focus(&mut self, shown: &Shown) {
        let index = shown.bodies.iter().position(|body| Some(&body.name) == self.selected.as_ref());
        let Some(body) = index.and_then(|index| shown.picture.bodies.get(index)) else { return };
        let picture = opruga::draw::Picture { bodies: vec![body.clone()], ..opruga::draw::Picture::default() };
        let Ok(view) = View::fit([&opruga::draw::Picture { dimension: shown.dimension, ..picture }]) else { return };
        self.fitted_size = None;
        if let Some(rect) = self.rect {
            self.space.look_at_all(&view, rect.size());
            self.flat.fit(&view, rect, self.tools);
        }
    }

    /// The position of new bodies [m]: that of the pointer if it is on the scene, otherwise the centre of the view.
    pub fn landing(&self, shown: &Shown, pointer: Option<Pos2>) -> [f64; 3] {
        let left = self.rect.zip(pointer).filter(|(rect, at)| rect.contains(*at));
        // The scene beside it has the same view.
        let right = self.other.zip(self.rect).zip(pointer).filter(|((other, _), at)| other.contains(*at));
        let right = right.map(|((other, rect), at)| (rect, at - other.min.to_vec2() + rect.min.to_vec2()));
        let point = left.or(right).and_then(|(rect, at)| self.point(shown, rect, at, 0.0));
        point.unwrap_or_else(|| self.middle(shown))
    }

    /// The centre of the view [m].
    fn middle(&self, shown: &Shown) -> [f64; 3] {
        if shown.dimension == 3 { self.space.eye().map_or([0.0; 3], |eye| eye.target) } else { self.flat.middle() }
    }

    /// The shorter side of the view [m].
    pub fn shorter_side(&self, shown: &Shown) -> f64 {
        let side = self.rect.map_or(600.0, |rect| f64::from(rect.width().min(rect.height())));
        if shown.dimension == 3 { self.space.eye().map_or(2.0, |eye| eye.radius) } else { self.flat.metres(side) }
    }

    /// The position in the window of a point of the scene.
    pub fn on_screen(&self, shown: &Shown, point: [f64; 3]) -> Option<Pos2> {
        let rect = self.rect?;
        if shown.dimension == 3 {
            let ([x, y], _) = self.space.lens(self.scales.as_ref()?, rect)?.see(point)?;
            return Some(rect.min + Vec2::new(x as f32, y as f32));
        }
        Some(self.flat.to_screen(rect, point, shown.picture.y_down))
    }

    /// The rectangles of the bodies and the legend, which no message may cover.
    pub fn covered(&self, shown: &Shown) -> Vec<Rect> {
        let left = self.rect.into_iter().flat_map(|rect| self.seen_in(rect, shown));
        let right = self.other.zip(shown.beside.as_ref());
        let right = right.into_iter().flat_map(|(other, beside)| self.seen_in(other, &beside.right));
        left.chain(right).chain(self.written.iter().copied()).collect()
    }

    /// The rectangles of the bodies within a part of the window. Bodies out of sight have no rectangle.
    fn seen_in(&self, part: Rect, shown: &Shown) -> Vec<Rect> {
        let by = self.rect.map_or(Vec2::ZERO, |rect| part.min - rect.min);
        let of = |extent: &crate::shown::Extent| {
            let corner = |k: usize| [0, 1, 2].map(|d| extent.corners[k >> d & 1][d]);
            let corners: Vec<Pos2> = (0..8).filter_map(|k| self.on_screen(shown, corner(k))).collect();
            Rect::from_points(&corners).translate(by).intersect(part)
        };
        // A rectangle may have no width, like that of a chain that hangs straight down.
        let there = |seen: &Rect| seen.width() >= 0.0 && seen.height() >= 0.0;
        shown.extents.iter().map(of).filter(there).collect()
    }

    /// Shows a scene in the remaining area, and returns the requests of the pointer.
    pub fn show(&mut self, ui: &mut Ui, shown: &Arc<Shown>, language: Language) -> Vec<Request> {
        let (whole, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Canvas, true, "canvas"));
        // A window of zero size, such as a minimised one, shows nothing.
        if whole.width() < 4.0 || whole.height() < 4.0 || shown.dimension == 0 {
            return Vec::new();
        }
        let (rect, other) = halves(whole, shown.beside.is_some());
        if self.other.is_some() != other.is_some() {
            // The area was halved or doubled, so the view is fitted again: to everything as it is now or, if a body has exploded, to the first view.
            match (self.exploded, &mut self.scales) {
                (Some(_), Some(view)) => {
                    [view.low, view.high] = self.first;
                    self.fitted_size = Some(Vec2::ZERO);
                }
                _ => self.fit(),
            }
        }
        let below = other.is_some_and(|other| other.top() > rect.top());
        self.flat.foot = if other.is_some() { Captions::FOOT[usize::from(below)] } else { 0.0 };
        (self.rect, self.other) = (Some(rect), other);
        let paper = Paper::of(ui);
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, paper.background);
        self.fit_if_new(shown, rect);
        self.fit_colours(shown);
        let mut asks = Vec::new();
        // The scene beside this one has no view of its own. Its view moves with that of the main scene.
        let within = |at: Pos2| match other {
            Some(other) if other.contains(at) => (at - other.min.to_vec2() + rect.min.to_vec2(), true),
            _ => (at, false),
        };
        let hover = response.hover_pos().map(|at| pressing::pressed_at(ui).unwrap_or(at)).map(within);
        self.navigate(ui, hover.map(|(at, _)| at), shown, rect);
        self.space.receive(ui);
        self.beside.receive(ui);
        // Pictures in space are slightly delayed, so a press acts on the picture that the user sees.
        let seen = self.space.seen().filter(|seen| shown.dimension == 3 && seen.opened == shown.opened).cloned();
        // Before the first picture is finished, no marks are drawn.
        let is_seen = shown.dimension != 3 || seen.is_some();
        let seen = seen.unwrap_or_else(|| Arc::clone(shown));
        let beside = hover.is_some_and(|(_, beside)| beside);
        let right = shown.beside.as_ref().map(|beside| &beside.right);
        let seen_right = self.beside.seen().filter(|seen| shown.dimension == 3 && seen.dimension == 3).cloned();
        let seen_right = seen_right.or(right.cloned()).filter(|_| right.is_some());
        let hovered = if beside { seen_right.as_ref() } else { Some(&seen) };
        let under = hover.zip(hovered).and_then(|((at, _), seen)| self.under(seen, rect, at));
        let offset = other.filter(|_| beside).map(|other| rect.min - other.min);
        let hovered = hovered.cloned();
        self.press(ui, &response, shown, hovered.as_deref(), rect, under.as_ref(), offset, &mut asks);
        let range = self.range.unwrap_or([0.0, 1.0]);
        let look = Look { painter: &painter, shown, rect, paper: &paper, show: self.wanted, range };
        // Two scenes side by side have the same range of colours, and the legend is in the second scene.
        let taken = if other.is_none() { legend::bounds(&look, self.tools, language) } else { None };
        self.written = taken.into_iter().collect();
        let pair = other.zip(shown.beside.as_ref());
        let both = ui.painter_at(whole);
        let mut of_right = None;
        let captions = pair.map(|(other, beside)| {
            of_right = legend::bounds(&Look { shown: &beside.right, rect: other, ..look }, self.tools, language);
            Captions::of(&both, &paper, [rect, other], of_right, beside, language)
        });
        let captioned = captions.as_ref().map(Captions::rects).unwrap_or_default();
        self.written.extend(of_right.iter().chain(&captioned));
        self.arrows.follow(shown);
        self.paint(ui, &look, shown, false, &self.written.clone());
        plane::credit(&look);
        if is_seen {
            let rows = arrows::key(&look, &self.arrows, self.points_of_arrows(shown, rect), language);
            self.written.extend(rows);
        }
        if taken.is_some() {
            legend::paint(&look, self.tools, language);
        } else if other.is_none() && is_seen {
            legend::explain_absence(&look, self.tools, language);
        }
        if is_seen {
            let under = under.as_ref().filter(|_| !beside);
            self.overlays(&Look { shown: &seen, ..look }, under, taken, &captioned, language);
        }
        let on_right = beside;
        if let (Some((other, beside)), Some(captions)) = (pair, captions) {
            let painter = ui.painter_at(other);
            painter.rect_filled(other, 0.0, paper.background);
            let look = Look { painter: &painter, shown: &beside.right, rect: other, ..look };
            self.paint(ui, &look, &beside.right, true, &self.written.clone());
            let seen = seen_right.as_ref().unwrap_or(&beside.right);
            legend::paint(&look, self.tools, language);
            if shown.dimension != 3 || self.beside.seen().is_some() {
                let under = under.as_ref().filter(|_| on_right);
                self.overlays(&Look { shown: seen, ..look }, under, of_right, &captioned, language);
            }
            captions.paint(&both, &paper, [rect, other]);
        }
        if is_seen && self.doing == Doing::Nothing {
            self.point_to_bodies(ui, shown, taken, language);
        }
        asks
    }

    /// Draws a scene. The second scene has its own renderer, with the camera of the first. Names do not cover the rectangles `written`.
    fn paint(&mut self, ui: &Ui, look: &Look<'_>, shown: &Arc<Shown>, beside: bool, written: &[Rect]) {
        let selected = self.selected.as_deref();
        if shown.dimension == 3 {
            let Some(scales) = &self.scales else { return };
            if beside {
                self.beside.share_eye(&self.space);
            }
            let space = if beside { &mut self.beside } else { &mut self.space };
            space.show(ui, look, shown, scales, (selected, &self.arrows));
        } else {
            let kept = if beside { &mut self.kept_beside } else { &mut self.kept };
            let taken: Vec<Rect> = written.iter().copied().chain(self.tools).collect();
            plane::paint(look, &self.flat, kept, selected, &taken, &self.arrows);
            // Both sides have the same view.
            if !beside {
                plane::scale_bar(look, &self.flat);
            }
        }
    }

    /// Keeps a body selected if it was replaced under another name, or if this replacement was undone. A body that is added or copied becomes
    /// selected.
    pub(crate) fn follow_names(&mut self, shown: &Shown) {
        if self.newest != shown.newest {
            self.newest.clone_from(&shown.newest);
            let newest = shown.newest.as_ref().map(|(_, name)| name);
            if let Some(body) = shown.bodies.iter().find(|body| Some(&body.name) == newest) {
                self.selected = Some(body.name.clone());
            }
        }
        let there = |name: &String| shown.bodies.iter().any(|body| body.name == *name);
        let Some(selected) = self.selected.as_ref().filter(|selected| !there(selected)) else { return };
        // The names that replaced a name, or were replaced by it, are followed one by one, the latest first.
        let mut names = vec![selected.clone()];
        let mut index = 0;
        while let Some(name) = names.get(index).cloned() {
            let later = shown.renamed.iter().rev().filter(|(old, _)| *old == name).map(|(_, new)| new);
            let earlier = shown.renamed.iter().rev().filter(|(_, new)| *new == name).map(|(old, _)| old);
            for other in later.chain(earlier) {
                if !names.contains(other) {
                    names.push(other.clone());
                }
            }
            index += 1;
        }
        let only = || (shown.bodies.len() == 1).then(|| shown.bodies[0].name.clone());
        if let Some(name) = names.into_iter().find(there).or_else(only) {
            self.selected = Some(name);
        }
    }

    /// Forgets the range of the colours, because another quantity has another range.
    pub fn forget_colours(&mut self) {
        self.range = None;
    }

    /// The length on the screen of the longest arrow of each kind [points], in space at the point in the centre of the view; none in the plane.
    fn points_of_arrows(&self, shown: &Shown, rect: Rect) -> Option<f64> {
        let (eye, scales) = (self.space.eye()?, self.scales.as_ref()?);
        let side = f64::from(rect.width().min(rect.height()));
        (shown.dimension == 3).then(|| 0.5 * side * scales.arrow / eye.radius)
    }

    fn under(&self, shown: &Shown, rect: Rect, at: Pos2) -> Option<Under> {
        if shown.dimension == 3 {
            let lens = self.space.lens(self.scales.as_ref()?, rect)?;
            pick::in_space(shown, &lens, rect, at)
        } else {
            pick::in_plane(shown, &self.flat, rect, at)
        }
    }

    /// Converts a distance from the camera to a distance behind the point in the centre of the view. In the plane, the distance does not change.
    fn behind(&self, rect: Rect, distance: f64) -> f64 {
        let looked_at = self.scales.as_ref().and_then(|scales| self.space.distance(scales, rect));
        distance - looked_at.unwrap_or(0.0)
    }

    /// The point of the world under the pointer. In space, it is at the distance `depth` behind the point in the centre of the view.
    fn point(&self, shown: &Shown, rect: Rect, at: Pos2, depth: f64) -> Option<[f64; 3]> {
        if shown.dimension == 3 {
            let scales = self.scales.as_ref()?;
            let pixel = at - rect.min;
            let distance = depth + self.space.distance(scales, rect)?;
            Some(self.space.lens(scales, rect)?.point([f64::from(pixel.x), f64::from(pixel.y)], distance))
        } else {
            let [x, y] = self.flat.to_world(rect, at, shown.picture.y_down);
            Some([x, y, 0.0])
        }
    }
}
