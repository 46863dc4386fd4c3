//! Makes simulated time follow the clock. If the simulation is too slow, simulated time slows down, and the ratio is reported.

use std::time::Duration;

/// The longest delay that the simulation makes up for [s], so that it does not jump after a pause of ten minutes.
const LONGEST: f64 = 0.1;
/// The weight of the latest frame in the mean computing time of a frame.
const FRESH: f64 = 0.1;
/// The time constant of the displayed ratio [s]; older values hardly count.
const MEMORY: f64 = 0.3;

/// The simulated time that is still due.
#[derive(Clone, Debug)]
pub struct Pacing {
    owed: f64,
    /// The ratio of recent simulated time to the requested one.
    ratio: f64,
    /// The recent mean computing time of a frame [s].
    cost: f64,
}

impl Default for Pacing {
    fn default() -> Pacing {
        Pacing { owed: 0.0, ratio: 1.0, cost: 0.0 }
    }
}

impl Pacing {
    /// Forgets the time that is due, after a pause or a jump in time.
    pub fn rest(&mut self) {
        self.owed = 0.0;
    }

    /// Computes the frames that are due after some real time. `speed` is the number of simulated seconds per second, and `length` is the length of a
    /// frame [s]. `frame` computes one frame and returns how long this took, or an error. No further frame begins after `budget` is spent.
    ///
    /// # Errors
    /// The errors of `frame`; in this case no time remains due.
    pub fn run<E>(
        &mut self,
        elapsed: Duration,
        speed: f64,
        length: f64,
        budget: Duration,
        mut frame: impl FnMut() -> Result<Duration, E>,
    ) -> Result<u32, E> {
        let real = elapsed.as_secs_f64().min(LONGEST);
        self.owed += real * speed;
        let (mut done, mut spent) = (0, Duration::ZERO);
        while self.owed >= length && (done == 0 || spent < budget) {
            match frame() {
                Ok(took) => {
                    spent += took;
                    self.cost += FRESH * (took.as_secs_f64() - self.cost);
                }
                Err(error) => {
                    self.rest();
                    return Err(error);
                }
            }
            self.owed -= length;
            done += 1;
        }
        // A delay of more than one frame is dropped, so simulated time slows down.
        let lost = (self.owed - length).max(0.0);
        self.owed -= lost;
        // If the previous picture was long ago, the time beyond the longest delay did not become due. This time is lost, too.
        let passed = elapsed.as_secs_f64();
        let asked = passed * speed;
        if asked > 0.0 {
            let now = ((real * speed - lost) / asked).clamp(0.0, 1.0);
            self.ratio += (1.0 - (-passed / MEMORY).exp()) * (now - self.ratio);
        }
        Ok(done)
    }

    /// The ratio of recent simulated time to the requested one: 1 if the simulation keeps up.
    pub fn ratio(&self) -> f64 {
        self.ratio
    }

    /// The recent mean computing time of a frame [s].
    pub fn cost(&self) -> f64 {
        self.cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn took(milliseconds: u64) -> impl FnMut() -> Result<Duration, ()> {
        move || Ok(Duration::from_millis(milliseconds))
    }

    const FRAME: f64 = 1.0 / 60.0;

    /// Returns the number of frames in ten seconds, for a rate of calls and a computing time per frame.
    fn ten_seconds(calls_per_second: u32, milliseconds: u64) -> (u32, Pacing) {
        let (mut pacing, mut frames) = (Pacing::default(), 0);
        let mut real = Duration::ZERO;
        while real < Duration::from_secs(10) {
            let step = Duration::from_secs_f64(1.0 / f64::from(calls_per_second));
            let done = pacing.run(step, 1.0, FRAME, Duration::from_millis(12), took(milliseconds)).expect("frames");
            frames += done;
            // A call lasts as long as its frames.
            real += step.max(Duration::from_millis(milliseconds * u64::from(done)));
        }
        (frames, pacing)
    }

    #[test]
    fn simulated_time_follows_the_clock_at_every_rate_of_the_screen() {
        for rate in [30, 60, 144, 1000] {
            let (frames, pacing) = ten_seconds(rate, 0);
            assert!((598..=602).contains(&frames), "{frames} frames at {rate} Hz");
            assert!((pacing.ratio() - 1.0).abs() < 0.05);
        }
    }

    #[test]
    fn ten_hidden_minutes_are_not_made_up_for() {
        let mut pacing = Pacing::default();
        let done = pacing.run(Duration::from_secs(600), 1.0, FRAME, Duration::from_secs(9), took(0)).expect("frames");
        assert!(done <= 6, "{done}");
    }

    #[test]
    fn a_simulation_that_cannot_keep_up_slows_down_and_says_by_how_much() {
        let mut pacing = Pacing::default();
        for _ in 0..200 {
            // There is a call every 50 ms. Each call computes one frame, which takes 60 ms, so simulated time passes at about a third of real time.
            let budget = Duration::from_millis(12);
            let done = pacing.run(Duration::from_millis(50), 1.0, FRAME, budget, took(60)).expect("frames");
            assert_eq!(done, 1, "no spiral");
        }
        assert!((pacing.ratio() - 1.0 / 3.0).abs() < 0.05, "{}", pacing.ratio());
        assert!((pacing.cost() - 0.06).abs() < 1e-3);
    }

    #[test]
    fn what_is_told_of_a_slow_window_and_of_another_speed_is_what_has_passed() {
        // There is a picture every 350 ms, with one frame each.
        let mut pacing = Pacing::default();
        let mut simulated = 0.0;
        for _ in 0..40 {
            let done = pacing.run(Duration::from_millis(350), 1.0, FRAME, Duration::from_millis(8), took(300));
            simulated += FRAME * f64::from(done.expect("frames"));
        }
        assert!((pacing.ratio() - simulated / (40.0 * 0.35)).abs() < 1e-3, "{}", pacing.ratio());
        for speed in [0.25, 3.0] {
            let mut pacing = Pacing::default();
            for _ in 0..600 {
                pacing
                    .run(Duration::from_millis(16), speed, FRAME, Duration::from_millis(12), took(0))
                    .expect("frames");
            }
            assert!((pacing.ratio() - 1.0).abs() < 1e-9, "{speed}: {}", pacing.ratio());
        }
    }

    #[test]
    fn an_error_ends_the_frames_and_nothing_is_owed() {
        let mut pacing = Pacing::default();
        assert_eq!(
            pacing.run(Duration::from_millis(100), 1.0, FRAME, Duration::from_secs(1), || Err("bad")),
            Err("bad")
        );
        assert_eq!(pacing.run(Duration::ZERO, 1.0, FRAME, Duration::from_secs(1), took(1)), Ok(0));
    }
}
