//! Shows the warnings at the end of a scene. Shapes are checked at the end, and whenever time is stopped after the end.

use super::Session;
use crate::report::Report;
use crate::shown::{Severity, Shown};
use opruga::Warning;

/// The warnings reported so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// The warnings at the start.
    early: Vec<Warning>,
    /// The warnings about the shapes, and the frame from which they apply.
    shape_warnings: Option<(u64, Vec<Warning>)>,
    /// The codes of the warnings that were last shown to the user at the end, so that the same warnings are not shown again.
    reported: Vec<String>,
}

impl Ends {
    /// The state before the end, for a scene with these warnings at its start.
    pub(super) fn of(early: Vec<Warning>) -> Ends {
        Ends { early, ..Ends::default() }
    }

    /// Adds the warnings at the end to the warnings of a frame.
    pub(super) fn add(&self, shown: &mut Shown) {
        let shape_warnings =
            self.shape_warnings.iter().filter(|(since, _)| *since <= shown.frames).flat_map(|(_, list)| list);
        for warning in shape_warnings {
            if !shown.warnings.iter().any(|other| other.code == warning.code) {
                shown.warnings.push(warning.clone());
            }
        }
    }
}

impl Session {
    /// Checks the shapes when the run reaches the end that it has on the command line, and shows the warnings that the command line would print.
    pub(super) fn look_at_the_end(&mut self) {
        if self.engine.frames() != self.engine.end() {
            return;
        }
        let all = self.look_at_shapes();
        let new_warnings: Vec<Warning> = all.iter().filter(|w| !self.ends.early.contains(w)).cloned().collect();
        let refused = self.message.as_ref().is_some_and(|message| message.severity == Severity::Refused);
        // Numbers in warnings may differ when the end is reached again, so reported warnings are recognised by their codes.
        let codes: Vec<String> = all.into_iter().map(|warning| warning.code.to_string()).collect();
        if !new_warnings.is_empty() && !refused && self.ends.reported != codes {
            let time = self.engine.time();
            self.report(Severity::Done, Report::AtTheEnd(time, new_warnings), None);
            self.ends.reported = codes;
        }
    }

    /// Checks the shapes if time is stopped after the end.
    pub(super) fn look_where_time_stands(&mut self) {
        if self.engine.frames() > self.engine.end() {
            self.look_at_shapes();
        }
    }

    /// Checks the shapes, and returns all present warnings.
    fn look_at_shapes(&mut self) -> Vec<Warning> {
        let all = self.engine.warnings_at_the_end();
        self.ends.shape_warnings = Some((self.engine.frames(), all.clone()));
        all
    }
}
