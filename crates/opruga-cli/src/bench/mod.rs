//! `opruga bench`: speed measured by the processor time of one thread, with the capabilities of the machine measured in the same run.

pub(crate) mod elements;
pub(crate) mod load;
pub(crate) mod record;
pub(crate) mod scene;
mod timed;
pub(crate) mod vertices;

use opruga::Simd;
use opruga::math::{WIDTH, calibration};

/// Processor time of this thread [s], or wall time if the system has no such clock.
pub(crate) fn processor_time() -> f64 {
    #[cfg(unix)]
    {
        seconds(rustix::time::ClockId::ThreadCPUTime)
    }
    #[cfg(not(unix))]
    {
        use std::sync::OnceLock;
        use std::time::Instant;
        static START: OnceLock<Instant> = OnceLock::new();
        START.get_or_init(Instant::now).elapsed().as_secs_f64()
    }
}

/// Processor time of all threads of this program [s], or processor time of this thread if the system has no such clock.
pub(crate) fn processor_time_of_all() -> f64 {
    #[cfg(unix)]
    {
        seconds(rustix::time::ClockId::ProcessCPUTime)
    }
    #[cfg(not(unix))]
    processor_time()
}

#[cfg(unix)]
fn seconds(clock: rustix::time::ClockId) -> f64 {
    let now = rustix::time::clock_gettime(clock);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

/// The median of some numbers.
pub(crate) fn median(numbers: &[f64]) -> f64 {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// The processor time of a piece of work: the best of several repetitions of at least 5 ms [s].
pub(crate) fn best(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut best = f64::INFINITY;
    let mut together = 1;
    let mut done = 0;
    while done < repetitions {
        let start = processor_time();
        for _ in 0..together {
            work();
        }
        let spent = processor_time() - start;
        if spent < 5e-3 && together < 1 << 30 {
            together *= 2;
            continue;
        }
        best = best.min(spent / together as f64);
        done += 1;
    }
    best
}

/// The capabilities of the machine, measured in the run with which they are printed.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub(crate) struct Machine {
    simd: &'static str,
    /// Multiplications and additions in registers, not fused [10⁹/s].
    operations: f64,
    /// a = b + s c over arrays of 32 MB each, counted as three numbers [10⁹ bytes/s].
    memory: f64,
}

impl Machine {
    pub(crate) fn measure(simd: Simd) -> Machine {
        let mut out = [0.0; WIDTH];
        let mut count = 0;
        let seconds = best(5, || count = calibration::products_and_sums(simd, std::hint::black_box(&mut out)));
        let operations = count as f64 / seconds * 1e-9;
        let (mut a, b, c) = (vec![0.0; 1 << 22], vec![1.0; 1 << 22], vec![2.0; 1 << 22]);
        let seconds = best(3, || count = calibration::triad(simd, std::hint::black_box(&mut a), &b, &c));
        let memory = count as f64 / seconds * 1e-9;
        Machine { simd: simd.name(), operations, memory }
    }
    pub(crate) fn sentence(&self) -> String {
        let Machine { simd, operations, memory } = self;
        format!(
            "this machine now: {simd}, {operations:.0}·10⁹ products and sums per second, {memory:.0} GB/s of memory"
        )
    }
}
