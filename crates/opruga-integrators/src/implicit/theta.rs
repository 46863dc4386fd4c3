//! The θ-method: M (v₁ − v₀) = h F at θ of the way from x₀ to x₁ = x₀ + h w, with w = (1 − θ) v₀ + θ v₁.
//!
//! θ = ½ is the implicit midpoint rule, θ = 1 backward Euler. What is much faster than the step falls by the factor (1 − θ)/θ in
//! a step, an oscillation with small hω by (θ − ½) h²ω² (Hughes 1987, 8.2).

use super::balance::Balance;
use super::workspace::Workspace;

/// Where the stage is, as a part of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Theta(f64);

/// The factor by which what is much faster than a step falls in a step with contact, under rules that else damp nothing.
const RADIUS_IN_CONTACT: f64 = 0.9;

impl Theta {
    /// The implicit midpoint rule.
    pub(crate) const MIDDLE: Theta = Theta(0.5);
    /// For steps in which obstacles hold nodes: the tremor of a stiff body would never end there, and friction would act on it.
    pub(crate) const IN_CONTACT: Theta = Theta(1.0 / (1.0 + RADIUS_IN_CONTACT));
    /// Backward Euler, which takes energy from everything.
    pub(crate) const END: Theta = Theta(1.0);

    pub(crate) fn value(self) -> f64 {
        self.0
    }

    /// Works y, z out of the state.
    pub(crate) fn begin<const D: usize>(self, workspace: &mut Workspace<D>, h: f64) -> Balance {
        let span = self.0 * h;
        for (y, v) in workspace.y.iter_mut().zip(&workspace.v0) {
            *y = span * v;
        }
        workspace.z.fill(0.0);
        let sigma = 1.0 / (span * span);
        Balance { sigma, beta: 1.0 / span, theta: self.0, time: span, h, load: 1.0, impulse: 1.0, echo: 0.0 }
    }

    /// Works the end of the step out of the stage.
    pub(crate) fn end<const D: usize>(self, workspace: &mut Workspace<D>, balance: &Balance) {
        for k in 0..workspace.u.len() {
            workspace.u1[k] = workspace.u[k] / self.0;
            workspace.v1[k] = workspace.v0[k] + (balance.beta * workspace.u[k] - workspace.v0[k]) / self.0;
        }
    }
}
