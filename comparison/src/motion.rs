//! Measures an oscillation: the depth of its first minimum, and its duration.

/// The first oscillation of a body that is released and falls.
#[derive(Clone, Copy, Debug)]
pub struct Swing {
    /// Depth of the first lowest point below the start [m].
    pub amplitude: f64,
    /// Time from the start to the first highest point after it [s].
    pub period: f64,
}

/// The results of a run.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Processor time of every frame [ms].
    pub milliseconds: Vec<f64>,
    /// Mean height of the free end at the start and after every frame [m].
    pub heights: Vec<f64>,
}

/// The free end counts as at rest if it moves by less than this fraction of its sag.
const STILL: f64 = 1e-4;

/// The number of frames at the end of a run in which the free end must be at rest.
const STILL_FRAMES: usize = 60;

impl Run {
    /// How far the free end is below its initial position after the last frame [m].
    pub fn sag(&self) -> f64 {
        self.heights[0] - self.heights[self.heights.len() - 1]
    }

    /// How far the free end is below its initial position at rest, averaged over its last frames [m]; none if it still moves.
    pub fn at_rest(&self) -> Option<f64> {
        let count = self.heights.len();
        let last = (count > STILL_FRAMES).then(|| &self.heights[count - STILL_FRAMES..])?;
        let sag = self.heights[0] - last.iter().sum::<f64>() / STILL_FRAMES as f64;
        let (low, high) = last.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| (l.min(*y), h.max(*y)));
        (high - low <= STILL * sag.abs()).then_some(sag)
    }

    /// Whether the free end has come to rest.
    pub fn is_still(&self) -> bool {
        self.at_rest().is_some()
    }

    /// The first oscillation, for frames of a given length; none if the end has not returned before the end of the run.
    pub fn swing(&self, frame: f64) -> Option<Swing> {
        let lowest = turn(&self.heights, 1, |before, here, after| here <= before && here < after)?;
        let highest = turn(&self.heights, lowest.0 + 1, |before, here, after| here >= before && here > after)?;
        Some(Swing { amplitude: self.heights[0] - lowest.2, period: highest.1 * frame })
    }

    /// The median time of a frame [ms].
    pub fn median(&self) -> f64 {
        let mut sorted = self.milliseconds.clone();
        sorted.sort_by(f64::total_cmp);
        sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
    }
}

/// Finds the first turning point among the samples from `from` on. Returns its index, and the time (in samples) and the height of the extremum of the
/// parabola through this sample and its neighbours.
fn turn(heights: &[f64], from: usize, is_turn: fn(f64, f64, f64) -> bool) -> Option<(usize, f64, f64)> {
    (from..heights.len().saturating_sub(1)).find_map(|k| {
        let (before, here, after) = (heights[k - 1], heights[k], heights[k + 1]);
        is_turn(before, here, after).then(|| {
            let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
            (k, k as f64 - slope / bend, here - 0.5 * slope * slope / bend)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::Run;

    #[test]
    fn the_swing_of_a_cosine_is_its_depth_and_period() {
        let heights: Vec<f64> = (0..40).map(|k| (0.31 * f64::from(k)).cos() * 0.5).collect();
        let run = Run { heights, milliseconds: vec![3.0, 1.0, 2.0] };
        let swing = run.swing(0.1).expect("a swing");
        assert!((swing.amplitude - 1.0).abs() < 2e-3, "{swing:?}");
        assert!((swing.period - 0.1 * 2.0 * std::f64::consts::PI / 0.31).abs() < 2e-3, "{swing:?}");
        assert!(!run.is_still() && run.median() == 2.0);
    }

    #[test]
    fn what_does_not_come_back_has_no_swing() {
        let run = Run { heights: (0..40).map(|k| -f64::from(k)).collect(), milliseconds: Vec::new() };
        assert!(run.swing(0.1).is_none() && run.sag() == 39.0);
        let heights = (0..100).map(|k| if k == 0 { 0.0 } else { -1.0 + 4e-5 * f64::from(k % 2) }).collect();
        let still = Run { heights, milliseconds: Vec::new() };
        assert!((still.at_rest().expect("at rest") - (1.0 - 2e-5)).abs() < 1e-12);
    }
}
