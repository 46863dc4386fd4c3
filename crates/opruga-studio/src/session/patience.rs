//! How long a frame may take where nobody can ask for its end meanwhile, as on a page, which has one thread.

use super::{Request, Session};
use crate::report::Report;
use crate::shown::{Offer, Severity};
use opruga::BreakOff;
use std::sync::{Arc, OnceLock};
use web_time::Instant;

/// How many times as long a frame may take once a person says that it shall be waited for.
const MORE: f64 = 4.0;

/// Seconds since it was first asked.
fn seconds() -> f64 {
    static BEGIN: OnceLock<Instant> = OnceLock::new();
    BEGIN.get_or_init(Instant::now).elapsed().as_secs_f64()
}

/// What ends frames that take long, also by the time.
pub fn by_the_clock() -> Arc<BreakOff> {
    Arc::new(BreakOff::with_clock(seconds))
}

/// How long frames are waited for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// At first [s].
    first: f64,
    /// Now [s].
    pub(super) now: f64,
}

impl Patience {
    /// Frames are waited for without end.
    pub(super) const ENDLESS: Patience = Patience { first: f64::INFINITY, now: f64::INFINITY };

    /// That of a scene that was just opened.
    pub(super) fn anew(self) -> Patience {
        Patience { now: self.first, ..self }
    }
}

impl Session {
    /// What ends a frame that takes long.
    pub fn break_off(&self) -> Arc<BreakOff> {
        Arc::clone(&self.setting.options.break_off)
    }

    /// Ends frames that take longer than this [s] at the last good one, and asks the person whether they shall be waited for. The options
    /// must hold what [`by_the_clock`] gives.
    pub fn wait_for_frames(&mut self, seconds: f64) {
        self.patience = Patience { first: seconds, now: seconds };
    }

    /// A frame begins.
    pub(super) fn look_at_the_clock(&self) {
        self.setting.options.break_off.end_after(self.patience.now);
    }

    /// A frame was broken off on the way to what was asked for. Who asked for that has asked for something else; where it took too long,
    /// time stands and the person is asked.
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

    /// Waits longer, and does again what was broken off.
    pub(super) fn wait_longer(&mut self, seconds: f64) {
        self.patience.now = seconds;
        if let Some(request) = self.refused.take() {
            self.handle(request);
        }
    }
}
