//! Earlier states to which a session can return. If they exceed their memory budget, every second state is dropped.

use crate::engine::State;

/// Snapshots by frame.
#[derive(Debug)]
pub struct Keyframes {
    kept: Vec<(u64, State)>,
    /// The number of frames between two keyframes.
    every: u64,
    bytes: usize,
    budget: usize,
}

/// The number of frames between two keyframes while memory allows.
const FIRST_INTERVAL: u64 = 10;

impl Keyframes {
    /// Makes an empty list of keyframes with a budget of this many bytes.
    pub fn new(budget: usize) -> Keyframes {
        Keyframes { kept: Vec::new(), every: FIRST_INTERVAL, bytes: 0, budget }
    }

    /// Whether the state of a frame with this number should be kept.
    pub fn wants(&self, frame: u64) -> bool {
        frame.is_multiple_of(self.every) && self.kept.last().is_none_or(|(last, _)| *last < frame)
    }

    /// Keeps a state. The first state is never dropped, because everything can be computed from it.
    pub fn keep(&mut self, frame: u64, state: impl Into<State>) {
        let state = state.into();
        self.bytes += state.bytes();
        self.kept.push((frame, state));
        while self.bytes > self.budget && self.kept.len() > 2 {
            self.every *= 2;
            let (every, first) = (self.every, self.kept[0].0);
            self.kept.retain(|(frame, _)| *frame == first || frame.is_multiple_of(every));
            self.bytes = self.kept.iter().map(|(_, state)| state.bytes()).sum();
        }
    }

    /// The latest kept state at or before a frame.
    pub fn before(&self, frame: u64) -> Option<(u64, &State)> {
        let index = self.kept.partition_point(|(kept, _)| *kept <= frame);
        index.checked_sub(1).map(|index| (self.kept[index].0, &self.kept[index].1))
    }

    /// Drops the states after a frame, because the run now continues differently.
    pub fn forget_after(&mut self, frame: u64) {
        self.kept.retain(|(kept, _)| *kept <= frame);
        self.bytes = self.kept.iter().map(|(_, state)| state.bytes()).sum();
    }

    /// The memory of the kept states [bytes].
    pub fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keyframes_stay_within_their_budget_and_cover_the_whole_past() {
        let mut keyframes = Keyframes::new(10_000);
        for frame in 0..5_000 {
            if keyframes.wants(frame) {
                keyframes.keep(frame, vec![0; 400]);
            }
        }
        assert!(keyframes.bytes() <= 10_000);
        let (mut last, mut gap) = (0, 0);
        for frame in 0..5_000 {
            let (kept, _) = keyframes.before(frame).expect("the first one is always there");
            gap = gap.max(frame - kept);
            last = last.max(kept);
        }
        assert!(gap <= 640 && last > 4_000, "{gap} {last}");
        keyframes.forget_after(100);
        assert!(keyframes.before(4_999).expect("one").0 <= 100);
        assert!(Keyframes::new(0).before(3).is_none());
    }

    #[test]
    fn one_state_larger_than_the_budget_is_kept_all_the_same() {
        let mut keyframes = Keyframes::new(100);
        keyframes.keep(0, vec![0; 1000]);
        keyframes.keep(10, vec![0; 1000]);
        assert_eq!(keyframes.before(25).map(|(frame, _)| frame), Some(10));
    }
}
