//! What an implicit rule says: which balance holds in the stage of a step, and what its end is.

use super::balance::Balance;
use super::workspace::Workspace;
use opruga_core::history::Channel;
use opruga_core::integrator::Amplification;
use opruga_core::system::System;

/// What makes one implicit rule differ from another.
pub(crate) trait Rule<const D: usize>: Copy + core::fmt::Debug + Send + Sync + 'static {
    /// The word that names it.
    const NAME: &'static str;
    /// Whether works are integrated by the trapezoidal rule over start and end, or by the value in the stage.
    const TRAPEZOID: bool;
    /// The same of the rule in the form in which a step was made.
    fn is_trapezoid(&self) -> bool {
        Self::TRAPEZOID
    }
    /// The same rule for a step in which obstacles hold nodes, if it is another one then: one that damps what is much faster
    /// than the step, which contact would stir up for ever.
    fn in_contact(self) -> Option<Self> {
        None
    }
    /// The rule instead of this one where a body in contact would gain energy by it.
    fn calmed(self) -> Option<Self> {
        None
    }
    /// The rule for a step in which other bodies push, or may push: one whose end is its stage and by whose velocity at the end the body
    /// got there, so that bodies that come to rest on one another stay at rest.
    fn pushed(self) -> Self {
        self
    }
    /// What it remembers from step to step.
    fn history(&self) -> Vec<Channel> {
        Vec::new()
    }
    /// What one step makes of the damped oscillator, as [`Integrator::amplification`].
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification;
    /// Works y, z out of the state and the history, both less x₀, and the numbers of the balance.
    fn begin(&self, system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance;
    /// Works displacement `u1` and velocity `v1` of the end out of the stage.
    fn end(&self, system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, h: f64);
    /// What a step after this one of the same length will add to the velocity of a coordinate out of what is remembered,
    /// besides the forces [m/s]: v₁ and this together change by h F/m in every step.
    fn remembered(&self, _workspace: &Workspace<D>, _k: usize, _h: f64) -> f64 {
        0.0
    }
    /// Moves the history on, after obstacles have had their say; `workspace.struck` names the nodes that met one.
    fn remember(&self, _system: &mut System<D>, _workspace: &Workspace<D>, _h: f64) {}
}
