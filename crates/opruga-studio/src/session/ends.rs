//! What attracts attention at the end of a scene: shapes are looked at there, and where time stands still behind it.

use super::Session;
use crate::report::Report;
use crate::shown::{Severity, Shown};
use opruga::Warning;

/// What was reported so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// What attracted attention at the start.
    early: Vec<Warning>,
    /// The warnings about the shapes, and the frame from which on.
    shape_warnings: Option<(u64, Vec<Warning>)>,
    /// The codes of what was reported to the person at the end: once is enough.
    reported: Vec<String>,
}

impl Ends {
    /// Nothing yet, of a scene that begins with this.
    pub(super) fn of(early: Vec<Warning>) -> Ends {
        Ends { early, ..Ends::default() }
    }

    /// Adds the warnings at the end to what attracts attention at a frame.
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
    /// Looks at the shapes where the scene ends for the command line, and says what the command line would say there.
    pub(super) fn look_at_the_end(&mut self) {
        if self.engine.frames() != self.engine.end() {
            return;
        }
        let all = self.look_at_shapes();
        let new_warnings: Vec<Warning> = all.iter().filter(|w| !self.ends.early.contains(w)).cloned().collect();
        let refused = self.message.as_ref().is_some_and(|message| message.severity == Severity::Refused);
        // Numbers in it may differ when the end comes again: what was reported is recognised by its code.
        let codes: Vec<String> = all.into_iter().map(|warning| warning.code.to_string()).collect();
        if !new_warnings.is_empty() && !refused && self.ends.reported != codes {
            let time = self.engine.time();
            self.report(Severity::Done, Report::AtTheEnd(time, new_warnings), None);
            self.ends.reported = codes;
        }
    }

    /// Looks at the shapes where time stands still behind the end.
    pub(super) fn look_where_time_stands(&mut self) {
        if self.engine.frames() > self.engine.end() {
            self.look_at_shapes();
        }
    }

    /// Everything that attracts attention now.
    fn look_at_shapes(&mut self) -> Vec<Warning> {
        let all = self.engine.warnings_at_the_end();
        self.ends.shape_warnings = Some((self.engine.frames(), all.clone()));
        all
    }
}
