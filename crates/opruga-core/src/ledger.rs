//! The account of a system: what went into and out of its energy, and what solving its equations took.

use opruga_math::{Lane, WIDTH};

/// What went into and out of the energy since the ledger was last emptied [J]; eight partial sums each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work8 {
    /// Work of forces from outside, of moving obstacles and of pins.
    pub user: [f64; WIDTH],
    /// Energy given to the gas by ramps, heating and leaks.
    pub gas: [f64; WIDTH],
    /// Energy taken by damping.
    pub damping: [f64; WIDTH],
    /// Energy taken by friction.
    pub friction: [f64; WIDTH],
    /// Energy taken by impacts.
    pub contact: [f64; WIDTH],
    /// Energy given by obstacles that put nodes back on their surface.
    pub correction: [f64; WIDTH],
    /// What a rule takes by itself, but for what the potential energy U gave: loads less damping as they were entered, less the
    /// work of the impulses of the rule. With U₀ − U₁ over the same steps, and what the gas was given and obstacles corrected, it is
    /// the energy that the rule dissipates ([`crate::integrator::Integrator::measures_its_damping`]). U falls out of the sum over steps,
    /// so nobody needs to know it between them.
    pub numerical: [f64; WIDTH],
    /// How often a force was limited.
    pub limited_forces: u64,
    /// How often a velocity was limited.
    pub limited_velocities: u64,
    /// What implicit integrators did.
    pub solver: SolverWork,
}

/// Work of one account within a step of several stages [J], eight partial sums.
///
/// Damping and loads work by velocities, which an integrator asks at its stages. It does not know there what an obstacle will
/// leave of them: a node that lies on a floor falls within every stage and stands at the end of every step. A step
/// that ends in contact therefore counts by the velocities that it begins with, which contact has seen. Over many steps
/// that is the trapezoidal rule but for its two ends.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepWork {
    /// By the velocities of all stages, as it was counted [J].
    counted: [f64; WIDTH],
    /// Power at the beginning of the step [W].
    at_start: [f64; WIDTH],
}

impl StepWork {
    /// Notes what a stage has counted: power [W] times its weight [s].
    #[inline]
    pub(crate) fn note(&mut self, power: &[f64; WIDTH], weight: f64, starts: bool) {
        for l in 0..WIDTH {
            self.counted[l] += weight * power[l];
            if starts {
                self.at_start[l] += power[l];
            }
        }
    }
    /// Lets the step of `h` [s] count by its beginning in some lanes, a bit each.
    pub(crate) fn count_by_start(&self, h: f64, lanes: u8, account: &mut [f64; WIDTH]) {
        for l in (0..WIDTH).filter(|l| lanes >> l & 1 == 1) {
            account[l] += h * self.at_start[l] - self.counted[l];
        }
    }
}

/// What implicit integrators did since the ledger was last emptied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverWork {
    /// Systems of equations that were solved, one a step.
    pub steps: u64,
    /// Iterations of Newton.
    pub iterations: u64,
    /// Iterations of the linear solver.
    pub linear_iterations: u64,
    /// The largest force out of balance on a node at the end of a step [N].
    pub residual: f64,
    /// Steps that were accepted though they had not converged.
    pub accepted: u64,
    /// Steps that were halved since they had not converged.
    pub halved: u64,
    /// How often one step was halved at most: its shortest part is 2⁻ⁿ of it.
    pub deepest: u64,
    /// Steps of the real-time setting that may be worse than it promises: a budget that was spent, or equations so slow to solve
    /// that what is left says little.
    pub cut_off: u64,
    /// What was left out of balance at the end of such a step at most, as the way that it would move nodes if each stood
    /// alone [m].
    pub left: f64,
    /// Steps that ended where forces balance to their rounding, though what is left of them would still move nodes visibly.
    pub estimated: u64,
    /// By how much at most it would [m].
    pub error_estimate: f64,
    /// Steps in which forces that rounding of positions makes were larger than the loads.
    pub conditioned: u64,
    /// How many times at most they were as large.
    pub conditioning: f64,
    /// How often a body that rested in a degenerate shape was displaced at random.
    pub disturbed: u64,
    /// How often that was in vain.
    pub stayed_degenerate: u64,
}

impl SolverWork {
    /// Adds what was done elsewhere or later.
    pub fn add(&mut self, other: &SolverWork) {
        self.steps += other.steps;
        self.iterations += other.iterations;
        self.linear_iterations += other.linear_iterations;
        self.residual = other.residual.larger(self.residual);
        self.accepted += other.accepted;
        self.halved += other.halved;
        self.deepest = self.deepest.max(other.deepest);
        self.cut_off += other.cut_off;
        self.left = other.left.larger(self.left);
        self.estimated += other.estimated;
        self.error_estimate = other.error_estimate.larger(self.error_estimate);
        self.conditioned += other.conditioned;
        self.conditioning = other.conditioning.larger(self.conditioning);
        self.disturbed += other.disturbed;
        self.stayed_degenerate += other.stayed_degenerate;
    }
}
