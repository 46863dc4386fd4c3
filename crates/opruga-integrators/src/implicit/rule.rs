//! The definition of an implicit integrator: the balance in the stage of a step, and the end of the step.

use super::balance::Balance;
use super::workspace::Workspace;
use opruga_core::history::Channel;
use opruga_core::integrator::Amplification;
use opruga_core::system::System;

/// The part in which implicit integrators differ.
pub(crate) trait Rule<const D: usize>: Copy + core::fmt::Debug + Send + Sync + 'static {
    /// The name of the integrator.
    const NAME: &'static str;
    /// Whether work is the mean of the values at start and end (the trapezoidal rule) instead of the value in the stage.
    const TRAPEZOID: bool;
    /// Whether the form of the rule that made a step computes work by the trapezoidal rule.
    fn is_trapezoid(&self) -> bool {
        Self::TRAPEZOID
    }
    /// The rule for a step in which obstacles hold nodes, if that rule differs from this one. The rule in contact damps
    /// motion that is much faster than the step, which contact would otherwise excite for ever.
    fn in_contact(self) -> Option<Self> {
        None
    }
    /// The rule that replaces this one if a body in contact would gain energy.
    fn calmed(self) -> Option<Self> {
        None
    }
    /// The rule for a step in which other bodies push, or may push. The end of the step is its stage, and the body reaches it
    /// with the velocity at the end. Bodies that come to rest on one another therefore remain at rest.
    fn pushed(self) -> Self {
        self
    }
    /// The data that the rule remembers from step to step.
    fn history(&self) -> Vec<Channel> {
        Vec::new()
    }
    /// The effect of one step on the damped oscillator, as described at [`Integrator::amplification`].
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification;
    /// Computes y, z from the state and the history, both relative to x₀, and the numbers of the balance.
    fn begin(&self, system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance;
    /// Computes displacement `u1` and velocity `v1` at the end from the stage.
    fn end(&self, system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, h: f64);
    /// The velocity that the memory will add to a coordinate in the next step [m/s], in addition to the effect of forces, if
    /// that step has the same length. The sum of v₁ and this velocity changes by h F/m in every step.
    fn remembered(&self, _workspace: &Workspace<D>, _k: usize, _h: f64) -> f64 {
        0.0
    }
    /// Updates the history, after obstacles have acted. `workspace.struck` lists the nodes that met an obstacle.
    fn remember(&self, _system: &mut System<D>, _workspace: &Workspace<D>, _h: f64) {}
}
