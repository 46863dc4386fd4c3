//! Keyboard shortcuts.

use super::Studio;
use crate::canvas::Tool;
use crate::session::{Edit, Placed, Request};
use crate::shown::Shown;
use egui::{Key, Modifiers, Ui};

impl Studio {
    /// Handles the keys that no control uses.
    pub(super) fn shortcuts(&mut self, ui: &Ui, shown: &Shown, asks: &mut Vec<Request>) {
        if ui.ctx().text_edit_focused() {
            return;
        }
        // A slider or a button that has the focus uses some keys itself, but none together with Ctrl.
        let focused = ui.ctx().memory(|m| m.focused().is_some());
        let pressed = |modifiers: Modifiers, key: Key| {
            (modifiers.command || !focused) && ui.input_mut(|i| i.consume_key(modifiers, key))
        };
        if pressed(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z) || pressed(Modifiers::COMMAND, Key::Y) {
            asks.push(Request::Redo);
        }
        if pressed(Modifiers::COMMAND, Key::Z) {
            asks.push(Request::Undo);
        }
        if pressed(Modifiers::COMMAND, Key::S) {
            self.keeping.begin(crate::panels::keeping::What::Scene, &self.link, self.show);
        }
        if (self.help_open || self.gallery.open) && ui.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Escape)) {
            (self.help_open, self.gallery.open) = (false, false);
        }
        let selected = self.canvas.selected.clone();
        if let Some(name) = selected {
            let transform = |turned: f64, scaled: f64| {
                Request::Edit(Edit::Transform(name.clone(), Placed { moved: [0.0; 3], turned, scaled }))
            };
            let fifteen = 15f64.to_radians();
            if pressed(Modifiers::COMMAND, Key::D) {
                asks.push(Request::Edit(Edit::Duplicate(name.clone())));
            }
            if pressed(Modifiers::NONE, Key::Delete) {
                asks.push(Request::Edit(Edit::Delete(name.clone())));
                self.canvas.selected = None;
            }
            for (key, request) in [
                (Key::OpenBracket, transform(fifteen, 1.0)),
                (Key::CloseBracket, transform(-fifteen, 1.0)),
                (Key::Plus, transform(0.0, 1.1)),
                (Key::Minus, transform(0.0, 1.0 / 1.1)),
            ] {
                if pressed(Modifiers::NONE, key) {
                    asks.push(request);
                }
            }
        }
        // The space bar starts and stops time when it is released, unless the pointer has moved the view in the meantime. If the space bar is
        // released before the pointer, the canvas remembers the movement until the space bar is pressed again.
        let anew = |event: &egui::Event| {
            matches!(event, egui::Event::Key { key: Key::Space, pressed: true, repeat: false, .. })
        };
        if ui.input(|i| i.events.iter().any(anew)) {
            self.canvas.panned = false;
        }
        let let_go = !focused && ui.input(|i| i.key_released(Key::Space) && !i.pointer.any_down());
        if let_go && !std::mem::take(&mut self.canvas.panned) {
            asks.push(Request::Play(!shown.playing));
        }
        if pressed(Modifiers::NONE, Key::ArrowRight) {
            asks.push(Request::Step);
        }
        if pressed(Modifiers::NONE, Key::Home) {
            asks.push(Request::Reset);
        }
        let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
        for (key, tool) in keys.into_iter().zip(Tool::ALL) {
            if pressed(Modifiers::NONE, key) {
                self.canvas.tool = tool;
            }
        }
        if pressed(Modifiers::NONE, Key::F) {
            self.canvas.fit();
        }
        if pressed(Modifiers::NONE, Key::C) {
            self.canvas.focus(shown);
        }
        if pressed(Modifiers::NONE, Key::B) {
            asks.push(Request::Compare(shown.beside.is_none()));
        }
        if pressed(Modifiers::NONE, Key::P) {
            self.plots_open = !self.plots_open;
        }
        if pressed(Modifiers::NONE, Key::G) {
            self.gallery.open = !self.gallery.open;
        }
        if pressed(Modifiers::NONE, Key::Questionmark) || pressed(Modifiers::SHIFT, Key::Questionmark) {
            self.help_open = !self.help_open;
        }
    }
}
