//! A body that explodes stops time while something of it can still be seen.

use super::Session;
use crate::report::Report;
use crate::shown::Severity;

impl Session {
    /// Stops time where a body has grown beyond every measure of the scene, and offers what would help.
    pub(super) fn stop_where_a_body_exploded(&mut self) {
        let Some(exploded) = self.engine.exploded() else { return };
        (self.playing, self.goal) = (false, None);
        self.pacing.rest();
        let offer = self.offer_after_a_failure(&exploded.body);
        self.report(Severity::Refused, Report::Exploded(exploded), offer);
    }
}
