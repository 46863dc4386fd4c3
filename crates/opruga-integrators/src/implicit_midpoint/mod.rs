//! # The implicit midpoint rule
//!
//! M (v₁ − v₀) = h F((x₀ + x₁)/2, (x₁ − x₀)/h, t + h/2),  x₁ = x₀ + ½ h (v₀ + v₁).
//!
//! Second order, stable for every step on linear systems, symplectic: without damping the amplitude of a linear oscillation
//! stays as it is, at any h ω, and linear and angular momentum are kept to the tolerance of the iteration. What is too fast
//! for the step is not damped but slowed down to half a turn in a step.
//!
//! The stage is the middle: a step of backward Euler of half the length, from which the second half goes on in a straight
//! line. Energy is kept exactly where forces are linear; a stiff spring that turns within a step exchanges energy with its
//! stretch, which bounds the step in practice.
//!
//! Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, II.1 and IV.2.

#[cfg(test)]
mod tests;

use crate::implicit::newton::Balance;
use crate::implicit::room::Room;
use crate::implicit::settings::FIELDS;
use crate::implicit::step::{Implicit, Rule};
use opruga_core::error::BuildError;
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::system::System;

/// The parameters.
pub const SPEC: Spec = Spec {
    kind: "implicit_midpoint",
    summary: "implicit, second order, stable for every step; keeps momentum, and energy of linear systems",
    documentation: "M (v₁ − v₀) = h F in the middle of the step, x₁ = x₀ + ½ h (v₀ + v₁), solved by Newton's method. Without \
damping amplitudes stay as they are; linear and angular momentum are kept to the tolerance. One body an island.",
    dimensions: &[2, 3],
    fields: FIELDS,
};

/// The kind `implicit_midpoint`.
#[derive(Debug)]
pub struct ImplicitMidpointKind;

/// The implicit midpoint rule.
#[derive(Clone, Copy, Debug)]
pub struct ImplicitMidpoint;

impl<const D: usize> IntegratorKind<D> for ImplicitMidpointKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Implicit::new(SPEC.kind, ImplicitMidpoint, values)?))
    }
}

impl<const D: usize> Rule<D> for ImplicitMidpoint {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = false;
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // The mean velocity w obeys w (1 + ½hc + ¼h²ω²) = v₀ − ½hω² x₀.
        let square = omega * omega;
        let factor = 1.0 / (1.0 + 0.5 * h * c + 0.25 * h * h * square);
        let (of_x, of_v) = (-0.5 * h * square * factor, factor);
        Amplification::new([[1.0 + h * of_x, h * of_v], [2.0 * of_x, 2.0 * of_v - 1.0]])
    }
    fn begin(&self, _system: &System<D>, room: &mut Room<D>, h: f64) -> Balance {
        for (y, v) in room.y.iter_mut().zip(&room.v0) {
            *y = 0.5 * h * v;
        }
        room.z.fill(0.0);
        Balance { sigma: 4.0 / (h * h), beta: 2.0 / h, theta: 0.5, time: 0.5 * h, h, load: 1.0, impulse: 1.0 }
    }
    fn end(&self, _system: &System<D>, room: &mut Room<D>, balance: &Balance, _h: f64) {
        for k in 0..room.u.len() {
            room.u1[k] = 2.0 * room.u[k];
            room.v1[k] = 2.0 * (balance.beta * room.u[k]) - room.v0[k];
        }
    }
}
