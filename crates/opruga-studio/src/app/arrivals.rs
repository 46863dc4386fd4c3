//! Files that were dropped on the window or chosen in a dialog.

use super::Studio;
use crate::hand::Arrived;
use crate::session::Request;
use crate::shape_file::Shape;
use crate::shown::Shown;
use egui::Ui;
use std::time::Duration;

/// How long a shape waits for the position of the pointer \[s\]. While a file is dragged over a window, systems do not report the position of the
/// pointer; they report it only after the file was dropped.
const PATIENCE: f64 = 0.3;

/// Shapes that wait for the position of the pointer, each with the time \[s\] since which it waits.
pub(super) type Waiting = Vec<(Shape, f64)>;

impl Studio {
    /// Opens dropped scenes; dropped shapes become bodies at the pointer.
    pub(super) fn dropped(&mut self, ui: &Ui, shown: &Shown, asks: &mut Vec<Request>) {
        let (now, pointer) = ui.input(|i| (i.time, i.pointer.latest_pos()));
        for arrived in self.hand.arrived(ui) {
            match arrived {
                Arrived::Request(Request::Take(shape, ..)) => self.landing.push((shape, now)),
                Arrived::Request(request) => asks.push(request),
                Arrived::Message(severity, report) => self.keeping.report(severity, report),
            }
        }
        // The body is made small enough that the rest of the scene remains visible.
        let size = opruga::draw::nice_length(0.3 * self.canvas.shorter_side(shown));
        let at = self.canvas.landing(shown, pointer);
        for (shape, since) in std::mem::take(&mut self.landing) {
            match pointer.is_some() || now - since > PATIENCE {
                true => asks.push(Request::Take(shape, at, size)),
                false => self.landing.push((shape, since)),
            }
        }
        if !self.landing.is_empty() {
            ui.ctx().request_repaint_after(Duration::from_millis(50));
        }
    }
}
