//! The balance of a stage, and the result of an iteration for it.

/// The balance of a stage: σ M (u − y) = F(x₀ + u, β (u − z)) at a time after the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// The factor of the mass [1/s²].
    pub(crate) sigma: f64,
    /// The factor of displacements in velocities [1/s].
    pub(crate) beta: f64,
    /// The position of the stage, as a fraction of the step.
    pub(crate) theta: f64,
    /// The time of the stage after the start of the step [s].
    pub(crate) time: f64,
    /// The length of the step [s].
    pub(crate) h: f64,
    /// The fraction at which the weight and the loads act.
    pub(crate) load: f64,
    /// The change of momentum due to a force that acts only in this stage, in units of force times h. `impulse` is the change
    /// in this step. `echo` is the change that the rule will add in later steps from its memory.
    pub(crate) impulse: f64,
    pub(crate) echo: f64,
}

/// The outcome of the iteration.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    pub(crate) iterations: u32,
    pub(crate) products: u32,
    /// The largest displacement of a node in the last iteration [m].
    pub(crate) correction: f64,
    pub(crate) converged: bool,
    /// How far the residual would still move a node [m]. It is zero unless the residual consists of rounding errors and that
    /// distance is large.
    pub(crate) error_estimate: f64,
    /// The ratio of the forces due to rounding of positions to the loads, or zero if this ratio is not needed.
    pub(crate) conditioning: f64,
    /// If the iteration did not converge, three effects of rounding: the rounding of positions [m], the largest rounding of a
    /// force [N], and the displacement of a node due to such a force [m].
    pub(crate) floor: [f64; 3],
    /// Whether the residual may have created energy.
    pub(crate) doubtful: bool,
}
