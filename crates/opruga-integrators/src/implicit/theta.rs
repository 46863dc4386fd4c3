//! The θ-method: M (v₁ − v₀) = h F at θ of the way from x₀ to x₁ = x₀ + h w, with w = (1 − θ) v₀ + θ v₁.
//!
//! θ = ½ is the implicit midpoint rule, θ = 1 backward Euler. What is much faster than the step falls by the factor (1 − θ)/θ in
//! a step, an oscillation with small hω by (θ − ½) h²ω² (Hughes 1987, 8.2).

use super::balance::Balance;
use super::room::Room;

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
    pub(crate) fn begin<const D: usize>(self, room: &mut Room<D>, h: f64) -> Balance {
        let span = self.0 * h;
        for (y, v) in room.y.iter_mut().zip(&room.v0) {
            *y = span * v;
        }
        room.z.fill(0.0);
        let sigma = 1.0 / (span * span);
        Balance { sigma, beta: 1.0 / span, theta: self.0, time: span, h, load: 1.0, impulse: 1.0, echo: 0.0 }
    }

    /// Works the end of the step out of the stage.
    pub(crate) fn end<const D: usize>(self, room: &mut Room<D>, balance: &Balance) {
        for k in 0..room.u.len() {
            room.u1[k] = room.u[k] / self.0;
            room.v1[k] = room.v0[k] + (balance.beta * room.u[k] - room.v0[k]) / self.0;
        }
    }
}
