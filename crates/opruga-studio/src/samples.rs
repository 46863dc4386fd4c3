//! The curves of a run: numbers for each frame, within a memory limit. If they exceed the limit, every second frame is dropped.

use opruga::core::potential::Reading;
use std::sync::Arc;

/// The memory limit of the samples [bytes].
const MOST_BYTES: usize = 16 << 20;
/// The largest number of samples. No window is wide enough to distinguish more.
const MOST: usize = 8_192;

/// The numbers of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Frames since the start.
    pub frame: u64,
    /// The time [s].
    pub time: f64,
    /// Kinetic energy, elastic energy, energy of the gas, potential energy of gravity, work, losses, numerical damping, and error of the integrator
    /// [J].
    pub energy: [f64; 8],
    /// The momentum [kg m/s].
    pub momentum: [f64; 3],
    /// The recent computing time of a frame [ms].
    pub cost: f64,
    /// Differences of the two sides: the mean and the largest distance between corresponding nodes, the distance between the centres of mass, and the
    /// differences in volume and in energy, right minus left; NaN if the sides cannot be compared.
    pub beside: Option<[f64; 5]>,
    /// The readings of the models of bodies, by the index of the body; empty if there are many bodies.
    pub readings: Vec<(usize, Arc<[Reading]>)>,
}

impl Sample {
    /// The readings of the models of a body.
    pub fn readings_of(&self, body: usize) -> &[Reading] {
        self.readings.iter().find(|(number, _)| *number == body).map_or(&[], |(_, readings)| readings)
    }

    fn bytes(&self) -> usize {
        let readings = |(_, list): &(usize, Arc<[Reading]>)| 40 + size_of_val::<[Reading]>(list);
        size_of::<Sample>() + self.readings.iter().map(readings).sum::<usize>()
    }
}

/// Samples in the order of their frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    kept: Vec<Sample>,
    /// The number of frames between two samples.
    every: u64,
    bytes: usize,
}

impl Default for Samples {
    fn default() -> Samples {
        Samples { kept: Vec::new(), every: 1, bytes: 0 }
    }
}

impl Samples {
    /// Whether a frame should be sampled: its number fits the present interval, and it has no sample yet.
    pub fn wants(&self, frame: u64) -> bool {
        frame.is_multiple_of(self.every) && self.kept.binary_search_by_key(&frame, |sample| sample.frame).is_err()
    }

    /// Adds a sample in the order of its frame.
    pub fn keep(&mut self, sample: Sample) {
        let index = self.kept.partition_point(|other| other.frame < sample.frame);
        self.bytes += sample.bytes();
        self.kept.insert(index, sample);
        while (self.kept.len() > MOST || self.bytes > MOST_BYTES) && self.kept.len() > 2 {
            self.every *= 2;
            self.kept.retain(|sample| sample.frame.is_multiple_of(self.every));
            self.bytes = self.kept.iter().map(Sample::bytes).sum();
        }
    }

    /// Drops the samples after a frame, because the run now continues differently.
    pub fn forget_after(&mut self, frame: u64) {
        self.kept.retain(|sample| sample.frame <= frame);
        self.bytes = self.kept.iter().map(Sample::bytes).sum();
    }

    /// The samples, divided into runs without gaps. Between two runs the values are unknown.
    pub fn runs(&self) -> impl Iterator<Item = &[Sample]> {
        self.kept.chunk_by(|a, b| b.frame - a.frame <= self.every)
    }

    /// All samples.
    pub fn all(&self) -> &[Sample] {
        &self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(frame: u64) -> Sample {
        Sample { frame, time: frame as f64, ..Sample::default() }
    }

    #[test]
    fn samples_stay_within_their_bounds_and_cover_the_whole_past_without_gaps() {
        let mut samples = Samples::default();
        for frame in 0..50_000 {
            if samples.wants(frame) {
                samples.keep(sample(frame));
            }
        }
        assert!((MOST / 2..=MOST).contains(&samples.all().len()), "{}", samples.all().len());
        assert_eq!(samples.runs().count(), 1);
        let ends = [samples.all().first(), samples.all().last()].map(|end| end.expect("samples").frame);
        assert!(ends[0] == 0 && ends[1] > 49_980, "{ends:?}");
        // The readings of bodies count as well.
        let reading: Arc<[Reading]> = vec![("pressure".into(), 1.0); 1000].into();
        let mut heavy = Samples::default();
        for frame in 0..2_000 {
            if heavy.wants(frame) {
                heavy.keep(Sample { readings: vec![(0, Arc::clone(&reading))], ..sample(frame) });
            }
        }
        assert!(heavy.bytes <= MOST_BYTES && heavy.all().len() > 200, "{}", heavy.all().len());
        assert_eq!(heavy.runs().count(), 1);
    }

    #[test]
    fn where_nothing_was_sampled_there_is_a_gap_until_it_is() {
        let mut samples = Samples::default();
        (0..10).chain(20..30).for_each(|frame| samples.keep(sample(frame)));
        let ends = |samples: &Samples| -> Vec<[u64; 2]> {
            samples.runs().map(|run| [run[0].frame, run[run.len() - 1].frame]).collect()
        };
        assert_eq!(ends(&samples), [[0, 9], [20, 29]]);
        assert!(samples.wants(15) && !samples.wants(25));
        (10..20).for_each(|frame| samples.keep(sample(frame)));
        assert_eq!(ends(&samples), [[0, 29]]);
        samples.forget_after(12);
        assert_eq!(ends(&samples), [[0, 12]]);
        assert!(Samples::default().runs().next().is_none());
    }
}
