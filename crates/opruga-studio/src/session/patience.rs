//! Limits the computing time of a frame where a request cannot interrupt it, such as on a web page, which has only one thread.

use super::{Request, Session};
use crate::report::Report;
use crate::shown::{Offer, Severity};
use opruga::BreakOff;
use std::sync::{Arc, OnceLock};
use web_time::Instant;

/// The factor by which the limit grows when the user chooses to wait.
const MORE: f64 = 4.0;

/// Seconds since the first call.
fn seconds() -> f64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// Makes an interrupter of long frames that also watches the clock.
pub fn by_the_clock() -> Arc<BreakOff> {
    Arc::new(BreakOff::with_clock(seconds))
}

/// The time limit of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// The initial limit [s].
    first: f64,
    /// The present limit [s].
    pub(super) now: f64,
}

impl Patience {
    /// No limit.
    pub(super) const ENDLESS: Patience = Patience { first: f64::INFINITY, now: f64::INFINITY };

    /// Returns to the initial limit, for a scene that was just opened.
    pub(super) fn anew(self) -> Patience {
        Patience { now: self.first, ..self }
    }
}

impl Session {
    /// The interrupter of long frames.
    pub fn break_off(&self) -> Arc<BreakOff> {
        Arc::clone(&self.setting.options.break_off)
    }

    /// Sets a limit for frames [s]. A frame that takes longer is interrupted, the session returns to the previous frame, and the user is asked
    /// whether to wait. The options must contain the result of [`by_the_clock`].
    pub fn wait_for_frames(&mut self, seconds: f64) {
        self.patience = Patience { first: seconds, now: seconds };
    }

    /// Starts the clock of a frame.
    pub(super) fn look_at_the_clock(&self) {
        self.setting.options.break_off.end_after(self.patience.now);
    }

    /// Handles the interruption of a frame that was needed for a request. If another request interrupted the frame, that request is handled instead.
    /// If the frame took too long, time stops and the user is asked whether to wait.
    pub(super) fn broken_off(&mut self, wanted: Request) {
        if self.setting.options.break_off.is_asked() || self.patience.now.is_infinite() {
            return;
        }
        (self.playing, self.goal) = (false, None);
        self.pacing.rest();
        self.refused = Some(wanted);
        let offer = Offer::Wait(self.patience.now * MORE);
        self.report(Severity::Refused, Report::TakesLong(self.patience.now), Some(offer));
    }

    /// Waits longer, and repeats the interrupted request.
    pub(super) fn wait_longer(&mut self, seconds: f64) {
        self.patience.now = seconds;
        if let Some(request) = self.refused.take() {
            self.handle(request);
        }
    }
}
