//! Makes the data that the interface shows of a session.

use super::Session;
use super::titles::Titles;
use crate::differences::Difference;
use crate::report::Report;
use crate::shown::{Pace, Shown};
use opruga::core::spec::Values;
use std::sync::Arc;

impl Session {
    /// Returns everything that the interface shows of the present moment.
    pub fn shown(&mut self) -> Shown {
        let mut shown = self.engine.shown(&self.show);
        self.ends.add(&mut shown);
        shown.hash = self.show.hash.then(|| self.engine.hash());
        shown.name.clone_from(&self.document.name);
        shown.latest = self.latest;
        shown.goal = self.goal.filter(|goal| *goal > self.engine.frames()).map(|goal| self.time_of(goal));
        shown.playing = self.playing;
        shown.speed = self.speed;
        shown.pace = Pace { ratio: self.pacing.ratio(), frame_cost: self.pacing.cost() };
        shown.undo = self.undo.last().map(|past| past.label.clone()).or_else(|| self.opening());
        shown.redo = self.redo.last().map(|past| past.label.clone());
        shown.message.clone_from(&self.message);
        shown.opened = self.opened;
        shown.replaced = self.replaced;
        shown.resets = self.resets;
        shown.recorded = self.document.commands().saturating_sub(self.own_commands);
        shown.recorded_until = self.recorded_until();
        shown.samples = Arc::clone(&self.samples);
        shown.kept_bytes = self.keyframes.bytes();
        let here = |body, node| self.engine.position(body, node);
        self.show_hand(&mut shown.pulls, &here);
        shown.pushes = self.push_shown(&here).into_iter().collect();
        let pins = self.pins_shown();
        let titles = self.titles();
        if let Some(stopped) = shown.beside.as_mut().and_then(|beside| beside.stopped.as_mut()) {
            *stopped = titles.in_report(stopped.clone());
        }
        if let Some(right) = shown.beside.as_mut().and_then(|beside| Arc::get_mut(&mut beside.right)) {
            give_titles(right, &titles);
            let there = |(body, node, _): &(usize, u32, [f64; 3])| {
                Some((*body, *node, self.engine.position_beside(*body, *node)?))
            };
            right.pins = pins.iter().filter_map(there).collect();
            let there = |body, node| self.engine.position_beside(body, node);
            self.show_hand(&mut right.pulls, &there);
            right.pushes = self.push_shown(&there).into_iter().collect();
            for body in right.bodies.iter_mut().take(if shown.bodies.len() <= 64 { 64 } else { 0 }) {
                body.shape = self.shape_beside(&body.name, usize::from(shown.dimension));
            }
        }
        shown.pins = pins;
        shown.renamed.clone_from(&self.renamed);
        shown.newest.clone_from(&self.newest);
        give_titles(&mut shown, &titles);
        if shown.bodies.len() <= 64 {
            for body in &mut shown.bodies {
                body.shape = self.document.shape(&body.name, usize::from(shown.dimension));
            }
        }
        shown
    }

    /// The names under which the user knows the existing bodies.
    fn titles(&self) -> Titles {
        // The names are needed only if bodies were renamed. If there are many bodies, single ones have no labels, and no names are replaced.
        let present = if self.renamed.is_empty() { Vec::new() } else { self.engine.names() };
        if present.len() > 64 { Titles::default() } else { Titles::new(self.renamed.clone(), present) }
    }

    /// Replaces the names in a report by the names under which the user knows the bodies.
    pub(super) fn titled(&self, report: Report) -> Report {
        self.titles().in_report(report)
    }

    /// The shape of a body in the scene on the right, without fields that are not plain values.
    fn shape_beside(&self, name: &str, dimension: usize) -> Option<Values> {
        let mut values = self.document.shape(name, dimension)?;
        for difference in self.differences.iter().flatten() {
            if let Difference::Shape(body, field, value) = difference
                && body == name
            {
                // The scene on the right was built with this value, so it is allowed.
                let _ = values.set(values.spec(), field, value.clone(), dimension);
            }
        }
        Some(values)
    }
}

/// Gives bodies that replace others the names of the originals, also in messages.
fn give_titles(shown: &mut Shown, titles: &Titles) {
    if titles.is_empty() {
        return;
    }
    for (index, body) in shown.bodies.iter_mut().enumerate() {
        let title = titles.of(&body.name);
        if title == body.name {
            continue;
        }
        body.title = title.to_string();
        let label = shown.picture.bodies.get_mut(index).map(|seen| &mut seen.label);
        if let Some(label) = label.filter(|label| **label == body.name) {
            label.clone_from(&body.title);
        }
    }
    shown.warnings = std::mem::take(&mut shown.warnings).into_iter().map(|w| titles.in_warning(w)).collect();
}
