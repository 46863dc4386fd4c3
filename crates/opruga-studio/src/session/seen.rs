//! What there is to see of a session.

use super::Session;
use crate::differences::Difference;
use crate::shown::{Pace, Shown};
use opruga::core::spec::Values;
use std::sync::Arc;

impl Session {
    /// Everything that there is to see now.
    pub fn shown(&mut self) -> Shown {
        let mut shown = self.engine.shown(&self.show);
        shown.name.clone_from(&self.document.name);
        shown.latest = self.latest;
        shown.playing = self.playing;
        shown.speed = self.speed;
        shown.pace = Pace { ratio: self.pacing.ratio(), frame_cost: self.pacing.cost() };
        shown.undo = self.undo.last().map(|past| past.label.clone()).or_else(|| self.opening());
        shown.redo = self.redo.last().map(|past| past.label.clone());
        shown.message.clone_from(&self.message);
        shown.opened = self.opened;
        shown.recorded = self.document.commands().saturating_sub(self.own_commands);
        shown.recorded_until = self.recorded_until();
        shown.kept_bytes = self.keyframes.bytes();
        let pins = self.pins_shown();
        if let Some(right) = shown.beside.as_mut().and_then(|beside| Arc::get_mut(&mut beside.right)) {
            let there = |(body, node, _): &(usize, u32, [f64; 3])| {
                Some((*body, *node, self.engine.position_beside(*body, *node)?))
            };
            right.pins = pins.iter().filter_map(there).collect();
            for body in right.bodies.iter_mut().take(if shown.bodies.len() <= 64 { 64 } else { 0 }) {
                body.shape = self.shape_beside(&body.name, usize::from(shown.dimension));
            }
        }
        shown.pins = pins;
        shown.renamed.clone_from(&self.renamed);
        self.give_titles(&mut shown);
        if shown.bodies.len() <= 64 {
            for body in &mut shown.bodies {
                body.shape = self.document.shape(&body.name, usize::from(shown.dimension));
            }
        }
        shown
    }

    /// Bodies that were set down anew keep the name of the body they were, unless there is another one of that name.
    fn give_titles(&self, shown: &mut Shown) {
        if self.renamed.is_empty() || shown.bodies.len() > 64 {
            return;
        }
        let taken: Vec<String> = shown.bodies.iter().map(|body| body.name.clone()).collect();
        for (place, body) in shown.bodies.iter_mut().enumerate() {
            let mut title = &body.name;
            // From the last that was renamed to the first: after an undo the same names may go round in a circle.
            for (old, new) in self.renamed.iter().rev() {
                if new == title {
                    title = old;
                }
            }
            if *title == body.name || taken.contains(title) {
                continue;
            }
            body.title = title.clone();
            let label = shown.picture.bodies.get_mut(place).map(|seen| &mut seen.label);
            if let Some(label) = label.filter(|label| **label == body.name) {
                label.clone_from(&body.title);
            }
        }
    }

    /// The shape of a body in the scene beside it, as far as its fields are plain values.
    fn shape_beside(&self, name: &str, dimension: usize) -> Option<Values> {
        let mut values = self.document.shape(name, dimension)?;
        for difference in self.differences.iter().flatten() {
            if let Difference::Shape(body, field, value) = difference
                && body == name
                && let Some(spec) = opruga::shapes::all().into_iter().find(|spec| spec.kind == values.kind())
            {
                // A value that the scene on the right was built with is allowed.
                let _ = values.set(spec, field, value.clone(), dimension);
            }
        }
        Some(values)
    }
}
