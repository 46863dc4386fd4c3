//! A step whose end is found together with the ends of other bodies.

use crate::error::StepError;
use crate::system::System;

/// A step of an implicit integrator whose end is still to be found. Forces balance where the sum of the incremental potential
/// Φ(u) of the body and the energy of the interactions between bodies is minimal. The displacements u [m] from the start of the
/// step hold the coordinates of one node after the other.
///
/// ```text
/// Φ = σ/2 |u − y|²_M + U(x₀ + u),   r = ∂Φ/∂u,   A ≈ ∂²Φ/∂u² without negative eigenvalues
/// ```
///
/// Obstacles hold nodes, and pins move nodes. The method `prescribed` returns how far these nodes still have to move. Equations
/// with the matrix A are solved in the free directions.
pub trait OpenStep<const D: usize>: Send {
    /// Ties a body without inertia (statics) to its present position by the first term of Φ, with y = u and the given σ [1/s²],
    /// from the next evaluation on. Bodies with inertia ignore this.
    fn stay(&mut self, _sigma: f64) {}
    /// The displacements u [m].
    fn displacements(&self) -> &[f64];
    /// The correction of u [m], which the search writes.
    fn correction(&mut self) -> &mut [f64];
    /// Evaluates forces at u plus a fraction of the correction.
    ///
    /// # Errors
    /// [`StepError`] if a model has no value there.
    fn evaluate(&mut self, system: &mut System<D>, part: f64) -> Result<(), StepError>;
    /// Φ and the size of its terms in the last evaluated state [J]; `None` if there is damping or a model without an energy.
    fn potential(&self, system: &System<D>) -> Option<[f64; 2]>;
    /// The rounding error of the terms of Φ that models compute [J].
    fn rounding(&self, system: &System<D>) -> f64;
    /// The part of r that is due to rounding of positions, as the root of the sum of squares [N]. This part is computed from the last derivatives, in
    /// the free directions only.
    fn rounding_of_forces(&self, system: &System<D>) -> f64;
    /// The residual r in the last evaluated state [N].
    fn residual(&self) -> &[f64];
    /// Adds a fraction of the correction to u.
    fn advance(&mut self, part: f64);
    /// Searches for the nodes that obstacles hold; returns whether the set of these nodes has changed.
    fn look(&mut self, system: &System<D>) -> bool;
    /// Assembles the derivatives in the last evaluated state and factors them in the free directions; returns whether that was possible. The
    /// derivatives are exact if `exact` is set and the exact ones are positive definite.
    fn factor(&mut self, system: &System<D>, exact: bool) -> bool;
    /// The mean diagonal entry of A at a node [N/m]; 0 if pins determine all of its axes.
    fn stiffness(&self, system: &System<D>, node: usize) -> f64;
    /// How far prescribed nodes still have to move [m].
    fn prescribed(&self) -> &[f64];
    /// Writes the right-hand side for the correction without the prescribed displacements, −(r + forces − friction) − A
    /// `prescribed`, in the free directions [N].
    fn right_side(&mut self, system: &System<D>, forces: &[f64], out: &mut [f64]);
    /// Computes y = A x.
    fn multiply(&self, system: &System<D>, x: &[f64], y: &mut [f64]);
    /// Projects a vector onto the free directions.
    fn filter(&self, x: &mut [f64]);
    /// Replaces x by A⁻¹ x in the free directions.
    fn solve(&self, x: &mut [f64]);
    /// Adapts the friction of obstacles to the forces that hold nodes. These forces are A times the correction, plus r, plus
    /// `forces`. Writes the change of the force on the nodes [N], or nothing if this force has settled to within the fraction
    /// `tolerance`.
    fn follow(&mut self, system: &System<D>, forces: &[f64], tolerance: f64, out: &mut [f64]) -> bool;
    /// The work that friction on obstacles and the forces that hold nodes do along the correction [J].
    fn given(&mut self) -> f64;
    /// Decides which nodes obstacles hold, and how they hold each one, in an iteration of a search. Returns whether this decision has changed. From a
    /// certain iteration on, it does not change any more.
    fn judge(&mut self, system: &System<D>, iteration: u32) -> bool;
    /// The correction below which the search ends [m].
    fn goal(&self) -> f64;
    /// The largest number of iterations, and whether a step that has not converged is then accepted.
    fn most_iterations(&self) -> (u32, bool);
    /// The largest number of halvings of a step whose search does not end.
    fn most_halvings(&self) -> u32;
    /// Ends the step at u. The forces of other bodies in `system.pushes` belong to this state. Records the iterations of the
    /// search, and whether the step was accepted without convergence.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the end.
    fn close(self: Box<Self>, system: &mut System<D>, iterations: u32, converged: bool) -> Result<(), StepError>;
}
