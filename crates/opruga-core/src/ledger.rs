//! The ledger of a system: the energy that entered and left it, and the work of solving its equations.

use opruga_math::{Lane, WIDTH};

/// The energy that entered and left the system since the ledger was last emptied [J], in eight partial sums each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work8 {
    /// Work of external forces, of moving obstacles and of pins.
    pub user: [f64; WIDTH],
    /// Energy that ramps, heating and leaks give to the gas.
    pub gas: [f64; WIDTH],
    /// Energy dissipated by damping.
    pub damping: [f64; WIDTH],
    /// Energy dissipated by friction.
    pub friction: [f64; WIDTH],
    /// Energy dissipated by impacts.
    pub contact: [f64; WIDTH],
    /// Energy that obstacles give by moving nodes back to the surface of the obstacle.
    pub correction: [f64; WIDTH],
    /// The dissipation by the integrator itself, without the change of the potential energy U: the recorded work of loads,
    /// minus the recorded damping, minus the work of the impulses of the integrator. Together with U₀ − U₁ over the same steps,
    /// the energy given to the gas and the corrections of obstacles, it is the energy that the integrator dissipates
    /// ([`crate::integrator::Integrator::measures_its_damping`]). U cancels in the sum over steps, so it is not needed between
    /// them.
    pub numerical: [f64; WIDTH],
    /// The number of times that a force was limited.
    pub limited_forces: u64,
    /// The number of times that a velocity was limited.
    pub limited_velocities: u64,
    /// The work of implicit integrators.
    pub solver: SolverWork,
}

/// The work of one account within a step of several stages [J], eight partial sums.
///
/// The work of damping and loads depends on velocities, which an integrator evaluates at its stages. These velocities do not include the effect of
/// obstacles: a node that lies on a floor falls within every stage and is at rest at the end of every step. A step that ends in contact therefore
/// uses its initial velocities, which contact has already changed. Over many steps, the sum is the trapezoidal rule except for its two ends.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct StepWork {
    /// The work with the velocities of all stages [J].
    counted: [f64; WIDTH],
    /// The power at the start of the step [W].
    at_start: [f64; WIDTH],
}

impl StepWork {
    /// Records the contribution of a stage: power [W] times its weight [s].
    #[inline]
    pub(crate) fn note(&mut self, power: &[f64; WIDTH], weight: f64, starts: bool) {
        for l in 0..WIDTH {
            self.counted[l] += weight * power[l];
            if starts {
                self.at_start[l] += power[l];
            }
        }
    }
    /// Replaces the work of the stages of a step by the power at its start times its length `h` [s]. Only the lanes whose bit
    /// in `lanes` is set change.
    pub(crate) fn count_by_start(&self, h: f64, lanes: u8, account: &mut [f64; WIDTH]) {
        for l in (0..WIDTH).filter(|l| lanes >> l & 1 == 1) {
            account[l] += h * self.at_start[l] - self.counted[l];
        }
    }
}

/// The work of implicit integrators since the ledger was last emptied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverWork {
    /// The number of systems of equations solved, one per step.
    pub steps: u64,
    /// The number of Newton iterations.
    pub iterations: u64,
    /// The number of iterations of the linear solver.
    pub linear_iterations: u64,
    /// The largest residual force on a node at the end of a step [N].
    pub residual: f64,
    /// The number of steps that were accepted without convergence.
    pub accepted: u64,
    /// The number of steps that were halved for lack of convergence.
    pub halved: u64,
    /// The largest number n of halvings of one step, whose shortest part is then 2⁻ⁿ of its length.
    pub deepest: u64,
    /// The number of steps of the real-time setting whose error may be larger than promised, because the budget was spent, or
    /// because the solver converged so slowly that the residual is a poor measure of the error.
    pub cut_off: u64,
    /// The largest residual at the end of a step counted in `cut_off`, as the distance by which it would move a node if only
    /// that node could move [m].
    pub left: f64,
    /// The number of steps that ended because forces balance within their rounding errors, although the residual would still
    /// move nodes visibly.
    pub estimated: u64,
    /// The largest displacement that the residual of a step counted in `estimated` would cause [m].
    pub error_estimate: f64,
    /// The number of steps in which forces due to rounding of positions exceeded the loads.
    pub conditioned: u64,
    /// The largest ratio of forces due to rounding of positions to the loads.
    pub conditioning: f64,
    /// How often a body that rested in a degenerate shape was displaced at random.
    pub disturbed: u64,
    /// How often a body counted in `disturbed` was still degenerate after its random displacement.
    pub stayed_degenerate: u64,
}

impl SolverWork {
    /// Adds the work of another system, or of another part of the run.
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
