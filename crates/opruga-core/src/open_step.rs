//! A step whose end is searched for together with the ends of other bodies.

use crate::error::StepError;
use crate::system::System;

/// A step of an implicit rule that has begun: forces balance where the incremental potential Φ(u) of the body and what acts between bodies
/// are least together. u [m] are displacements from the start of the step, the coordinates of one node after the other.
///
/// ```text
/// Φ = σ/2 |u − y|²_M + U(x₀ + u),   r = ∂Φ/∂u,   A ≈ ∂²Φ/∂u² without negative eigenvalues
/// ```
///
/// Obstacles hold nodes, and pins lead them: `prescribed` is how far these still have to go, and A is solved in the directions that are free.
pub trait OpenStep<const D: usize>: Send {
    /// Lets a body of statics stay where it is now by a part of its mass, y = u and σ [1/s²], from the next evaluation on. Bodies that move have inertia
    /// of their own, and take no note of it.
    fn stay(&mut self, _sigma: f64) {}
    /// u.
    fn displacements(&self) -> &[f64];
    /// The correction of u [m], which the search writes.
    fn correction(&mut self) -> &mut [f64];
    /// Evaluates forces at u and a part of the correction.
    ///
    /// # Errors
    /// [`StepError`] where a model has no meaning there.
    fn evaluate(&mut self, system: &mut System<D>, part: f64) -> Result<(), StepError>;
    /// Φ and the size of its parts where forces were evaluated last [J]; none where damping or a model without an energy takes part.
    fn potential(&self, system: &System<D>) -> Option<[f64; 2]>;
    /// What rounding makes of Φ by itself, in its models [J].
    fn rounding(&self, system: &System<D>) -> f64;
    /// What rounding of positions makes of r by itself, in the directions that are free and by the last derivatives: the root of the sum of squares [N].
    fn rounding_of_forces(&self, system: &System<D>) -> f64;
    /// r where forces were evaluated last [N].
    fn residual(&self) -> &[f64];
    /// Adds a part of the correction to u.
    fn advance(&mut self, part: f64);
    /// Looks which nodes obstacles hold; says whether that has changed.
    fn look(&mut self, system: &System<D>) -> bool;
    /// Takes the derivatives where forces were evaluated last, exact ones if these are asked for and positive definite, and factors them in the
    /// directions that are free; says whether that could be done.
    fn factor(&mut self, system: &System<D>, exact: bool) -> bool;
    /// The mean diagonal entry of A at a node [N/m]; 0 where a pin holds all of it.
    fn stiffness(&self, system: &System<D>, node: usize) -> f64;
    /// How far prescribed nodes still have to go [m].
    fn prescribed(&self) -> &[f64];
    /// −(r + forces − friction) − A `prescribed`, in the directions that are free: what the correction has to balance, besides what is prescribed
    /// [N]. Forces are those that other bodies will not take.
    fn right_side(&mut self, system: &System<D>, forces: &[f64], out: &mut [f64]);
    /// y = A x.
    fn multiply(&self, system: &System<D>, x: &[f64], y: &mut [f64]);
    /// Keeps what is free of a vector.
    fn filter(&self, x: &mut [f64]);
    /// x = A⁻¹ x in the directions that are free.
    fn solve(&self, x: &mut [f64]);
    /// Lets the friction of obstacles follow what holds nodes, A correction + r + forces; gives by what the force on the nodes has changed
    /// [N], or nothing where that is settled to `tolerance` of itself.
    fn follow(&mut self, system: &System<D>, forces: &[f64], tolerance: f64, out: &mut [f64]) -> bool;
    /// The work along the correction of friction on obstacles and of what holds nodes [J].
    fn given(&mut self) -> f64;
    /// Decides anew which nodes obstacles hold, and how; says whether that has changed.
    fn judge(&mut self, system: &System<D>) -> bool;
    /// The correction with which the search ends [m].
    fn goal(&self) -> f64;
    /// The most iterations, and whether a step that has not converged then counts.
    fn most_iterations(&self) -> (u32, bool);
    /// How often a step whose search does not end is halved at most.
    fn most_halvings(&self) -> u32;
    /// Ends the step with the pushes of other bodies in `system.pushes`, which belong to u; counts the iterations of the search, and a step that counts though
    /// the search has not converged.
    ///
    /// # Errors
    /// [`StepError`] where a model refuses the end.
    fn close(self: Box<Self>, system: &mut System<D>, iterations: u32, converged: bool) -> Result<(), StepError>;
}
