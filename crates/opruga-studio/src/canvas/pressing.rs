//! The actions of the pointer on the scene.

use super::pick::Under;
use super::{Canvas, Doing, Tool, pen};
use crate::session::{Edit, Grip, Placed, Request};
use crate::shown::Shown;
use egui::{PointerButton, Pos2, Rect, Ui, Vec2};
use opruga::draw::ColliderPicture;

/// A press of the pointer.
#[derive(Clone, Copy)]
struct Press {
    button: PointerButton,
    at: Pos2,
    /// The rectangle of the scene.
    rect: Rect,
    /// Whether the space bar is held.
    space: bool,
    shift: bool,
    /// Whether the press is on the scene beside the main one.
    beside: bool,
}

/// A pull that has had no effect yet. While time is stopped, a press without movement only selects a body, so that it does not delete what was
/// recorded after this moment.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    grab: Request,
    at: Pos2,
    frames: u64,
}

impl Waiting {
    /// Whether the pointer has moved or time has passed since the press.
    fn is_over(&self, shown: &Shown, at: Pos2) -> bool {
        (at - self.at).length() > 2.0 || shown.playing || shown.frames != self.frames
    }
}

/// The position at which a button was pressed since the previous picture. On a slow screen, the pointer may have moved on since then.
pub(super) fn pressed_at(ui: &Ui) -> Option<Pos2> {
    let press = |event: &egui::Event| match event {
        egui::Event::PointerButton { pos, pressed: true, .. } => Some(*pos),
        _ => None,
    };
    ui.input(|i| i.events.iter().rev().find_map(press))
}

/// The path of the pointer since the previous picture. If the press `began` since then, the path begins with the press. If the button was released,
/// the path ends with the release. On a slow screen, many positions arrive with one picture.
fn path(events: &[egui::Event], began: bool) -> Vec<Pos2> {
    use egui::Event::{PointerButton as Button, PointerMoved};
    let (mut path, mut down) = (Vec::new(), !began);
    for event in events {
        match event {
            Button { pos, button: PointerButton::Primary, pressed: true, .. } => (path, down) = (vec![*pos], true),
            Button { pos, button: PointerButton::Primary, pressed: false, .. } if down => {
                path.push(*pos);
                break;
            }
            PointerMoved(pos) if down => path.push(*pos),
            _ => {}
        }
    }
    path
}

impl Canvas {
    /// Handles the wheel, pinching, and dragging of the view.
    pub(super) fn navigate(&mut self, ui: &Ui, at: Option<Pos2>, shown: &Shown, rect: Rect) {
        let Some(latest) = at else { return };
        let at = pressed_at(ui).filter(|_| self.doing == Doing::Nothing).unwrap_or(latest);
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
    pub(super) fn press(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        shown: &Shown,
        hovered: Option<&Shown>,
        rect: Rect,
        under: Option<&Under>,
        offset: Option<Vec2>,
        asks: &mut Vec<Request>,
    ) {
        let (space_down, shift, pressed, at, down) = ui.input(|i| {
            let buttons = [PointerButton::Primary, PointerButton::Secondary, PointerButton::Middle];
            let pressed = buttons.into_iter().find(|b| i.pointer.button_pressed(*b));
            (i.key_down(egui::Key::Space), i.modifiers.shift, pressed, i.pointer.latest_pos(), i.pointer.any_down())
        });
        let Some(latest) = at else { return };
        let at = pressed_at(ui).filter(|_| self.doing == Doing::Nothing).unwrap_or(latest);
        // Two fingers move the view, so anything that the first finger has grabbed is released.
        if ui.input(|i| i.multi_touch().is_some()) {
            if let Doing::Holding(..) = std::mem::take(&mut self.doing) {
                asks.push(Request::Release);
            }
            return;
        }
        let began = self.doing == Doing::Nothing && pressed.is_some() && response.contains_pointer();
        // An action that begins on the right side is converted to positions on the left side, wherever the pointer then moves.
        if self.doing == Doing::Nothing {
            self.offset = offset.unwrap_or_default();
        }
        let (at, beside) = (at + self.offset, offset.is_some());
        let pin = under.zip(hovered).and_then(|(under, seen)| pin_under(seen, under, !beside));
        if let (true, Some(button)) = (began, pressed) {
            self.refused = None;
            let press = Press { button, at, rect, space: space_down, shift, beside };
            self.begin(press, shown, under, pin, asks);
        }
        if response.double_clicked()
            && let Some(under) = under
        {
            match pin {
                Some((body, node, _)) => asks.push(Request::Unpin(body, node)),
                None if shown.dimension == 3 => self.space.look_at(under.point),
                None => {}
            }
        }
        let holds = matches!(self.doing, Doing::Holding(..));
        if self.waiting.as_ref().is_some_and(|waiting| !holds || waiting.is_over(shown, at)) {
            asks.extend(self.waiting.take().filter(|_| holds).map(|waiting| waiting.grab));
        }
        // On a slow screen, a press arrives together with the movement before it, which is ignored.
        let delta = if began { Vec2::ZERO } else { ui.input(|i| i.pointer.delta()) };
        match &mut self.doing {
            Doing::Nothing => {}
            Doing::Holding(depth, push) => {
                let (depth, push) = (*depth, *push);
                if let Some(point) = self.point(shown, rect, at, depth).filter(|_| self.waiting.is_none()) {
                    asks.push(Request::Lead(match push {
                        Some([pressed, hold]) => [0, 1, 2].map(|d| hold[d] + (point[d] - pressed[d])),
                        None => point,
                    }));
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
            Doing::Handling(grabbed) => grabbed.lead(at),
            Doing::Drawing(points) => {
                for at in ui.input(|i| path(&i.events, began)) {
                    let point = self.flat.to_world(rect, at + self.offset, shown.picture.y_down);
                    if points.last().is_none_or(|last| *last != point) {
                        points.push(point);
                    }
                }
            }
        }
        if !down {
            self.end(shown, rect, latest + self.offset, asks);
        }
    }

    fn begin(
        &mut self,
        press: Press,
        shown: &Shown,
        under: Option<&Under>,
        pin: Option<(usize, u32, [f64; 3])>,
        asks: &mut Vec<Request>,
    ) {
        let Press { button, at, rect, space, shift, beside } = press;
        if button == PointerButton::Middle || space {
            self.panned = space;
            self.doing = Doing::Panning;
            return;
        }
        if self.tool == Tool::Shift
            && button == PointerButton::Primary
            && !beside
            && let Some(grabbed) = self.handles(shown, rect).and_then(|handles| handles.at(at))
        {
            self.doing = Doing::Handling(grabbed);
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
            // Away from all bodies, dragging moves the view in the plane and rotates it in space.
            self.doing = if shown.dimension == 3 { Doing::Turning } else { Doing::Panning };
            return;
        };
        self.selected = Some(under.name.clone());
        let depth = self.behind(rect, under.distance);
        let grip = match (button, shift, self.tool) {
            (PointerButton::Secondary, ..) => Grip::Push,
            (_, true, _) | (_, _, Tool::Pin) => Grip::Pin,
            (_, _, Tool::Push) => Grip::Push,
            // The bodies have the same initial positions in both scenes and can be moved only in the left one.
            (_, _, Tool::Shift) if beside => return,
            (_, _, Tool::Shift) => {
                let start = self.point(shown, rect, at, depth).unwrap_or(under.point);
                self.doing = Doing::Shifting(under.name.clone(), start, depth);
                return;
            }
            _ => Grip::Pull,
        };
        self.pulled |= grip == Grip::Pull;
        // A pinned node is grabbed at the position of its pin, so that the session finds the same node.
        let pinned = pin.filter(|_| grip == Grip::Pin).map(|pin| {
            let of_left = shown.pins.iter().find(|left| (left.0, left.1) == (pin.0, pin.1));
            of_left.map_or(pin.2, |left| left.2)
        });
        let grab = match (pinned, beside) {
            (Some(point), _) => Request::Grab(grip, under.body, point),
            (None, true) => Request::GrabBeside(grip, under.body, under.point),
            (None, false) => Request::Grab(grip, under.body, under.point),
        };
        if grip == Grip::Pull && !shown.playing {
            self.waiting = Some(Waiting { grab, at, frames: shown.frames });
        } else {
            asks.push(grab);
        }
        // A push begins without force although the pointer is a little away from the node, so the point of the press is stored. A pulled node,
        // however, moves to the pointer.
        let pressed = self.point(shown, rect, at, depth).filter(|_| grip == Grip::Push);
        self.doing = Doing::Holding(depth, pressed.map(|pressed| [pressed, under.point]));
    }

    fn end(&mut self, shown: &Shown, rect: Rect, at: Pos2, asks: &mut Vec<Request>) {
        let waited = self.waiting.take().is_some();
        match std::mem::take(&mut self.doing) {
            Doing::Holding(..) if waited => {}
            Doing::Holding(..) => asks.push(Request::Release),
            Doing::Shifting(name, start, depth) => {
                if let Some(end) = self.point(shown, rect, at, depth) {
                    let moved = [0, 1, 2].map(|d| end[d] - start[d]);
                    if moved.iter().any(|d| d.abs() > 1e-9) {
                        asks.push(Request::Edit(Edit::Transform(name, Placed { moved, turned: 0.0, scaled: 1.0 })));
                    }
                }
            }
            Doing::Handling(grabbed) => asks.extend(grabbed.edit(shown.dimension, shown.picture.y_down)),
            Doing::Drawing(points) => match pen::body(&points, self.flat.metres(6.0)) {
                Ok(table) => asks.push(Request::Edit(Edit::Add(table))),
                Err(why) => self.refused = Some(why),
            },
            _ => {}
        }
    }
}

/// Finds the pin under the pointer: its body, its node and its position [m]. The pin was set by the user or, if `own_nodes` is set, by the scene.
/// `own_nodes` is true if the nodes of the picture are those of the world to which requests refer.
fn pin_under(shown: &Shown, under: &Under, own_nodes: bool) -> Option<(usize, u32, [f64; 3])> {
    let own = shown.bodies.iter().position(|body| body.number == under.body);
    let own = own.and_then(|index| shown.picture.bodies.get(index));
    let of_scene = own.into_iter().filter(|_| own_nodes).flat_map(|body| {
        let pin = |node: &u32| Some((under.body, *node, *body.positions.get(*node as usize)?));
        body.pinned.iter().filter_map(pin)
    });
    shown.pins.iter().copied().chain(of_scene).find(|(body, _, point)| {
        let far: f64 = under.point.iter().zip(point).map(|(a, b)| (a - b) * (a - b)).sum();
        under.body == *body && far.sqrt() <= 3.0 * under.pixel * 6.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Event, Modifiers, pos2};

    #[test]
    fn every_position_of_the_pointer_while_it_is_pressed_counts() {
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let [a, b, c, d] = [pos2(0.0, 0.0), pos2(9.0, 0.0), pos2(9.0, 9.0), pos2(0.0, 9.0)];
        let whole =
            [Event::PointerMoved(d), button(a, true), Event::PointerMoved(b), Event::PointerMoved(c), button(d, false)];
        assert_eq!(path(&whole, true), [a, b, c, d]);
        // First a picture between press and release, then the picture with the release, after which the pointer moves on.
        assert_eq!(path(&whole[2..4], false), [b, c]);
        assert_eq!(path(&[Event::PointerMoved(b), button(c, false), Event::PointerMoved(d)], false), [b, c]);
        assert!(path(&[], false).is_empty());
    }
}
