//! What ends a step that takes long.

use core::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Whether a step that takes long shall end: because somebody asks for it, or because it is late by a clock. It is looked at within steps,
/// and shared by who computes and who waits.
#[derive(Debug)]
pub struct BreakOff {
    asked: AtomicBool,
    /// The bits of a moment of the clock [s].
    latest: AtomicU64,
    clock: fn() -> f64,
}

impl Default for BreakOff {
    fn default() -> Self {
        BreakOff::with_clock(|| 0.0)
    }
}

impl BreakOff {
    /// One that can end steps by the time as well: `clock` says what it is [s].
    pub fn with_clock(clock: fn() -> f64) -> BreakOff {
        BreakOff { asked: AtomicBool::new(false), latest: AtomicU64::new(f64::INFINITY.to_bits()), clock }
    }

    /// Asks for the end of what is computed and of all that follows, or no longer.
    pub fn ask(&self, wanted: bool) {
        self.asked.store(wanted, Ordering::Relaxed);
    }

    /// Whether somebody asks for the end.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed)
    }

    /// Ends what is computed so many seconds from now; infinitely many: never.
    pub fn end_after(&self, seconds: f64) {
        self.latest.store(((self.clock)() + seconds).to_bits(), Ordering::Relaxed);
    }

    /// Whether what is computed shall end.
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
}
