//! Stops time when a body explodes, while it can still be seen.

use super::Session;
use crate::report::Report;
use crate::shown::Severity;

impl Session {
    /// Stops time if a body has grown to many times its size, and offers a remedy.
    pub(super) fn stop_where_a_body_exploded(&mut self) {
        let Some(exploded) = self.engine.exploded() else { return };
        (self.playing, self.goal) = (false, None);
        self.pacing.rest();
        let offer = self.offer_after_a_failure(&exploded.body);
        self.report(Severity::Refused, Report::Exploded(exploded), offer);
    }
}
