//! The balance of a stage, and what an iteration that looks for it reports.

/// The balance of a stage: σ M (u − y) = F(x₀ + u, β (u − z)) at a time after the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// The factor of the mass [1/s²].
    pub(crate) sigma: f64,
    /// The factor of displacements in velocities [1/s].
    pub(crate) beta: f64,
    /// Which part of the way to the end of the step the stage is.
    pub(crate) theta: f64,
    /// The time of the stage after the start of the step [s].
    pub(crate) time: f64,
    /// The length of the step [s].
    pub(crate) h: f64,
    /// The part of the weight and of the loads that acts.
    pub(crate) load: f64,
    /// The change of momentum in the step by a force that acts in this stage alone, in units of force times h, and what the rule
    /// will still add to it out of what it remembers.
    pub(crate) impulse: f64,
    pub(crate) echo: f64,
}

/// How the iteration ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    pub(crate) iterations: u32,
    pub(crate) products: u32,
    /// The largest displacement of a node in the last iteration [m].
    pub(crate) correction: f64,
    pub(crate) converged: bool,
    /// What is left of the forces would still move a node by [m], where it is rounding and that is much.
    pub(crate) error_estimate: f64,
    /// The forces that rounding of positions makes, over the loads, where they matter.
    pub(crate) conditioning: f64,
    /// The rounding of positions [m], the largest of a force [N] and what that would move a node by [m], where it did not converge.
    pub(crate) floor: [f64; 3],
    /// Whether what is left may have made energy.
    pub(crate) doubtful: bool,
}
