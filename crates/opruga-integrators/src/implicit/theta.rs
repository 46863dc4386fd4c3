//! The θ-method: M (v₁ − v₀) = h F at the fraction θ between x₀ and x₁ = x₀ + h w, with w = (1 − θ) v₀ + θ v₁.
//!
//! θ = ½ is the implicit midpoint rule, θ = 1 is backward Euler. In a step, the amplitude of motion much faster than the step
//! is multiplied by (1 − θ)/θ, and the amplitude of an oscillation with small hω loses the fraction (θ − ½) h²ω² (Hughes
//! 1987, 8.2).

use super::balance::Balance;
use super::workspace::Workspace;

/// The position of the stage, as a fraction of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Theta(f64);

/// For rules that otherwise damp nothing: the factor by which a step with contact multiplies the amplitude of motion that is
/// much faster than the step.
const RADIUS_IN_CONTACT: f64 = 0.9;

impl Theta {
    /// The implicit midpoint rule.
    pub(crate) const MIDDLE: Theta = Theta(0.5);
    /// The rule for steps in which obstacles hold nodes. Without this rule, the vibration of a stiff body in contact would
    /// never end, and friction would act on this vibration.
    pub(crate) const IN_CONTACT: Theta = Theta(1.0 / (1.0 + RADIUS_IN_CONTACT));
    /// Backward Euler, which dissipates energy from all motion.
    pub(crate) const END: Theta = Theta(1.0);

    pub(crate) fn value(self) -> f64 {
        self.0
    }

    /// Computes y and z from the state.
    pub(crate) fn begin<const D: usize>(self, workspace: &mut Workspace<D>, h: f64) -> Balance {
        let span = self.0 * h;
        for (y, v) in workspace.y.iter_mut().zip(&workspace.v0) {
            *y = span * v;
        }
        workspace.z.fill(0.0);
        let sigma = 1.0 / (span * span);
        Balance { sigma, beta: 1.0 / span, theta: self.0, time: span, h, load: 1.0, impulse: 1.0, echo: 0.0 }
    }

    /// Computes the end of the step from the stage.
    pub(crate) fn end<const D: usize>(self, workspace: &mut Workspace<D>, balance: &Balance) {
        for k in 0..workspace.u.len() {
            workspace.u1[k] = workspace.u[k] / self.0;
            workspace.v1[k] = workspace.v0[k] + (balance.beta * workspace.u[k] - workspace.v0[k]) / self.0;
        }
    }
}
