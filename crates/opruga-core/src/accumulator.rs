//! Real time: the number of frames of the simulation that are due when a display shows its next picture.
//!
//! The simulation always advances by whole frames of one length, whatever the rate of the display. The same amount of real time therefore gives the
//! same number of substeps, and the same bits, at 30, 60, 144 or 1000 pictures per second. Time that does not fill a frame is kept for the next
//! picture, and nothing is lost by rounding.

/// The number of attoseconds in a second. This unit is so small that the conversion hardly rounds an `f64` number of seconds
/// below 1000.
const ATTOSECONDS: f64 = 1e18;

/// The longest real time that one call counts [s]. A longer pause counts as this time.
const LONGEST: f64 = 1e6;

/// Collects real time and hands it out in frames.
///
/// A frame may be handed out up to a thousandth of its length early. Otherwise, a display whose period (such as 1/60 s) is not a whole number of
/// units of time would sometimes be one frame behind. Time handed out early is subtracted later, so there is no drift.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accumulator {
    /// The length of a frame [as].
    frame: i128,
    /// The largest number of frames per call.
    cap: u32,
    /// The time that has not been handed out yet [as]; from −1/1000 of a frame to less than a frame.
    waiting: i128,
    /// The time that was not simulated [as].
    dropped: i128,
}

/// The frames that are due after some real time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Due {
    /// The number of frames to simulate now.
    pub frames: u32,
    /// Time beyond the cap that will not be simulated [s]: the simulation falls behind the clock by this much.
    pub dropped: f64,
}

impl Accumulator {
    /// Makes an accumulator for frames of this length [s] that hands out at most `cap_frames` at once.
    ///
    /// The cap keeps a simulation that is slower than real time from falling behind ever further. Returns `None` if the length is
    /// not between a nanosecond and 1e6 seconds.
    pub fn new(frame: f64, cap_frames: u32) -> Option<Accumulator> {
        let length = (1e-9..=LONGEST).contains(&frame).then(|| attoseconds(frame))?;
        Some(Accumulator { frame: length, cap: cap_frames, waiting: 0, dropped: 0 })
    }

    /// Adds elapsed real time [s] and returns how many frames are due. Negative numbers and NaN count as zero.
    pub fn advance(&mut self, elapsed: f64) -> Due {
        self.waiting += if elapsed > 0.0 { attoseconds(elapsed) } else { 0 };
        let due = ((self.waiting + self.frame / 1000) / self.frame).max(0);
        self.waiting -= due * self.frame;
        // Whole frames beyond the cap are dropped; the fraction of a frame is kept.
        let frames = due.min(i128::from(self.cap));
        let dropped = (due - frames) * self.frame;
        self.dropped += dropped;
        Due { frames: frames as u32, dropped: dropped as f64 / ATTOSECONDS }
    }

    /// The position of the clock within the next frame, 0 to 1, for a display that interpolates between two frames.
    pub fn fraction(&self) -> f64 {
        (self.waiting.max(0) as f64) / (self.frame as f64)
    }

    /// The total time that was dropped [s].
    pub fn dropped(&self) -> f64 {
        self.dropped as f64 / ATTOSECONDS
    }

    /// Discards the time not yet handed out, after a pause.
    pub fn reset(&mut self) {
        self.waiting = 0;
    }
}

/// Converts seconds to whole attoseconds.
fn attoseconds(seconds: f64) -> i128 {
    let seconds = if seconds < LONGEST { seconds } else { LONGEST };
    (seconds * ATTOSECONDS).round() as i128
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of frames of 1/60 s that are due after the given number of pictures at the given rate.
    fn frames(rate: u32, pictures: u32) -> u32 {
        let mut accumulator = Accumulator::new(1.0 / 60.0, 100).unwrap();
        (0..pictures).map(|_| accumulator.advance(1.0 / f64::from(rate)).frames).sum()
    }

    #[test]
    fn every_display_rate_gives_the_same_frames() {
        for rate in [1, 24, 30, 50, 59, 60, 72, 75, 90, 120, 144, 165, 240, 1000, 7919] {
            assert_eq!(frames(rate, rate * 10), 600, "{rate} Hz, 10 s");
        }
        for rate in [30, 60, 144, 1000] {
            assert_eq!(frames(rate, rate * 3600), 216_000, "{rate} Hz, 1 h");
        }
    }

    #[test]
    fn uneven_pictures_neither_lose_nor_gain_time() {
        let mut accumulator = Accumulator::new(0.01, 1000).unwrap();
        let (mut total, mut frames, mut random) = (0.0, 0, 1u64);
        for _ in 0..100_000 {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let elapsed = (random >> 40) as f64 * 1e-9;
            total += elapsed;
            frames += accumulator.advance(elapsed).frames;
        }
        let left = total - f64::from(frames) * 0.01;
        assert!((left - accumulator.fraction() * 0.01).abs() < 1e-8, "{left}");
    }

    #[test]
    fn a_cap_drops_whole_frames_and_says_so() {
        let mut accumulator = Accumulator::new(0.25, 3).unwrap();
        assert_eq!(accumulator.advance(0.3), Due { frames: 1, dropped: 0.0 });
        assert_eq!(accumulator.fraction(), 0.2);
        // 2.05 s are pending: eight frames, of which five are dropped.
        assert_eq!(accumulator.advance(2.0), Due { frames: 3, dropped: 1.25 });
        assert_eq!(accumulator.dropped(), 1.25);
        assert_eq!(accumulator.advance(0.2), Due { frames: 1, dropped: 0.0 });
    }

    #[test]
    fn odd_times_are_harmless() {
        let mut accumulator = Accumulator::new(0.25, 2).unwrap();
        for elapsed in [f64::NAN, f64::NEG_INFINITY, -1.0, 0.0, -0.0, 1e-300] {
            assert_eq!(accumulator.advance(elapsed), Due { frames: 0, dropped: 0.0 });
        }
        let due = accumulator.advance(f64::INFINITY);
        assert_eq!((due.frames, due.dropped), (2, 999_999.5));
        for frame in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-12] {
            assert!(Accumulator::new(frame, 1).is_none(), "{frame}");
        }
    }
}
