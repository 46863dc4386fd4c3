//! What attracts attention at the end of a scene: shapes are looked at there, and where time stands still behind it.

use super::Session;
use crate::said::Said;
use crate::shown::{Severity, Shown};
use opruga::Warning;

/// What was told of so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Ends {
    /// What attracted attention at the start.
    early: Vec<Warning>,
    /// What is odd about the shapes, and the frame from which on.
    odd: Option<(u64, Vec<Warning>)>,
    /// What the person was told of at the end: once is enough.
    told: Vec<String>,
}

impl Ends {
    /// Nothing yet, of a scene that begins with this.
    pub(super) fn of(early: Vec<Warning>) -> Ends {
        Ends { early, ..Ends::default() }
    }

    /// Adds what is odd at the end to what attracts attention at a frame.
    pub(super) fn add(&self, shown: &mut Shown) {
        let odd = self.odd.iter().filter(|(since, _)| *since <= shown.frames).flat_map(|(_, list)| list);
        for warning in odd {
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
        let odd: Vec<Warning> = all.iter().filter(|w| !self.ends.early.contains(w)).cloned().collect();
        let refused = self.message.as_ref().is_some_and(|message| message.severity == Severity::Refused);
        // Numbers in it may differ when the end comes again: what was told is told by its code.
        let codes: Vec<String> = all.into_iter().map(|warning| warning.code.to_string()).collect();
        if !odd.is_empty() && !refused && self.ends.told != codes {
            let time = self.engine.time();
            self.tell(Severity::Told, Said::AtTheEnd(time, odd), None);
            self.ends.told = codes;
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
        self.ends.odd = Some((self.engine.frames(), all.clone()));
        all
    }
}
