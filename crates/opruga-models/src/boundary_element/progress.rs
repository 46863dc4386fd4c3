//! The progress of the preparation of a stiffness.

use super::refusals::Refusal;
use opruga_core::break_off::BreakOff;

/// The parts of a preparation, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// Integrals over all facets for each source.
    Integrals,
    /// The factors of G.
    Factors,
    /// G⁻¹ H, in groups of columns.
    Solutions,
    /// Forces, rigid motion, symmetric part.
    Symmetry,
    /// Negative eigenvalues.
    Signs,
}

/// Reports the fraction that is done and checks whether a stop was requested.
pub(super) struct Progress<'a> {
    break_off: &'a BreakOff,
    /// The relative costs of the parts. Their sum is arbitrary.
    costs: [f64; 5],
    part: Part,
    /// The fraction of the present part that is done.
    share: f64,
}

impl<'a> Progress<'a> {
    /// The progress of the preparation of a system with `rows` rows, at its start.
    pub(super) fn new(break_off: &'a BreakOff, rows: usize) -> Progress<'a> {
        let n = rows as f64;
        // The numbers of multiplications. Each pair of a source and a facet, which has nine entries, needs about 1500; the
        // other numbers are those of textbooks. Factorising and solving for many columns run at the speed of matrix products.
        // The other parts run at the speed of memory.
        let costs = [200.0 * n * n, n * n * n / 3.0, n * n * n, 40.0 * n * n, n * n * n / 6.0];
        Progress { break_off, costs, part: Part::Integrals, share: 0.0 }
    }
    /// Begins a part.
    pub(super) fn part(&mut self, part: Part) -> Result<(), Refusal> {
        (self.part, self.share) = (part, 0.0);
        self.step(0.0)
    }
    /// Adds a fraction to the progress of the present part.
    pub(super) fn step(&mut self, share: f64) -> Result<(), Refusal> {
        self.share += share;
        let part = self.part as usize;
        let done = self.costs[..part].iter().sum::<f64>() + self.share * self.costs[part];
        self.break_off.set_prepared(Some(done / self.costs.iter().sum::<f64>()));
        if self.break_off.is_asked() { Err(Refusal::Ended {}) } else { Ok(()) }
    }
}

impl Drop for Progress<'_> {
    fn drop(&mut self) {
        self.break_off.set_prepared(None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_grow_to_one_and_an_end_that_is_asked_for_comes() {
        let break_off = BreakOff::default();
        let mut progress = Progress::new(&break_off, 300);
        let mut last = 0.0;
        for part in [Part::Integrals, Part::Factors, Part::Solutions, Part::Symmetry, Part::Signs] {
            progress.part(part).expect("nobody asks");
            for _ in 0..4 {
                progress.step(0.25).expect("nobody asks");
                let share = break_off.prepared().expect("a preparation");
                assert!(share > last && share <= 1.0 + 1e-12, "{share} after {last}");
                last = share;
            }
        }
        assert!((last - 1.0).abs() < 1e-12);
        break_off.ask(true);
        assert_eq!(progress.step(0.0), Err(Refusal::Ended {}));
        drop(progress);
        assert_eq!(break_off.prepared(), None);
    }
}
