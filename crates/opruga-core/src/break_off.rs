//! Requests to end a long step, or a long preparation of a model.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// A shared request to end a long step, made explicitly or by a time limit. Steps check the request, and so do preparations that take seconds. The
/// threads that compute share it with those that wait.
#[derive(Debug)]
pub struct BreakOff {
    asked: AtomicBool,
    /// The time on the clock at which the limit is reached [s], as the bits of an `f64`.
    latest: AtomicU64,
    clock: fn() -> f64,
    /// The fraction of a preparation that is done, as the bits of an `f64`; NaN if there is no preparation.
    prepared: AtomicU64,
}

impl Default for BreakOff {
    fn default() -> Self {
        BreakOff::with_clock(|| 0.0)
    }
}

impl BreakOff {
    /// Makes a request that can also have a time limit; `clock` returns the time [s].
    pub fn with_clock(clock: fn() -> f64) -> BreakOff {
        let (latest, prepared) = (f64::INFINITY.to_bits(), f64::NAN.to_bits());
        BreakOff {
            asked: AtomicBool::new(false),
            latest: AtomicU64::new(latest),
            clock,
            prepared: AtomicU64::new(prepared),
        }
    }

    /// Asks the present and all following computations to end, or withdraws the request.
    pub fn ask(&self, wanted: bool) {
        self.asked.store(wanted, Ordering::Relaxed);
    }

    /// Whether the end is requested.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// Sets a time limit of `seconds` from now; infinity means none.
    pub fn end_after(&self, seconds: f64) {
        self.latest.store(((self.clock)() + seconds).to_bits(), Ordering::Relaxed);
    }

    /// Reports that this fraction (0 to 1) of a preparation is done; `None` if there is no preparation.
    pub fn set_prepared(&self, share: Option<f64>) {
        self.prepared.store(share.unwrap_or(f64::NAN).to_bits(), Ordering::Relaxed);
    }

    /// The fraction of the present preparation that is done, 0 to 1.
    pub fn prepared(&self) -> Option<f64> {
        Some(f64::from_bits(self.prepared.load(Ordering::Relaxed))).filter(|share| !share.is_nan())
    }

    /// Whether the present computation must end.
    pub fn is_wanted(&self) -> bool {
        let latest = f64::from_bits(self.latest.load(Ordering::Relaxed));
        self.is_asked() || latest.is_finite() && (self.clock)() >= latest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_end_when_somebody_asks_or_when_it_is_time() {
        assert!(!BreakOff::default().is_wanted());
        static NOW: AtomicU64 = AtomicU64::new(0);
        let end = BreakOff::with_clock(|| NOW.load(Ordering::Relaxed) as f64);
        end.end_after(2.0);
        assert!(!end.is_wanted());
        NOW.store(2, Ordering::Relaxed);
        assert!(end.is_wanted() && !end.is_asked());
        end.end_after(f64::INFINITY);
        assert!(!end.is_wanted());
        end.ask(true);
        assert!(end.is_wanted() && end.is_asked());
        end.ask(false);
        assert!(!end.is_wanted());
    }

    #[test]
    fn a_preparation_shows_how_far_it_is_until_it_ends() {
        let watched = BreakOff::default();
        assert_eq!(watched.prepared(), None);
        watched.set_prepared(Some(0.25));
        assert_eq!(watched.prepared(), Some(0.25));
        watched.set_prepared(None);
        assert_eq!(watched.prepared(), None);
    }
}
