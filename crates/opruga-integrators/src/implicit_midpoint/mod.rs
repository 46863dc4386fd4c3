//! # The implicit midpoint rule
//!
//! M (v₁ − v₀) = h F((x₀ + x₁)/2, (x₁ − x₀)/h, t + h/2),  x₁ = x₀ + ½ h (v₀ + v₁).
//!
//! Second order, stable for every step size on linear systems, and symplectic: without damping the amplitude of a linear
//! oscillation stays constant at any h ω, and linear and angular momentum are conserved to the tolerance of the iteration.
//! Motion that is too fast for the step is not damped, but slowed down to half a period per step.
//!
//! The stage is the midpoint. A step of backward Euler with half the length leads to the midpoint, and the second half
//! extrapolates this motion in a straight line. If forces are linear, energy is conserved exactly. A stiff spring that rotates
//! within a step exchanges energy with its stretch, which limits the step in practice.
//!
//! In contact the vibration of a stiff body would never end, and friction would act on this vibration. Steps in which
//! obstacles hold nodes therefore have their stage at θ = 1/(1 + 0.9) instead of ½. In each step, the amplitude of motion much
//! faster than the step is multiplied by (1 − θ)/θ = 0.9, and the amplitude of an oscillation with small hω loses the fraction
//! (θ − ½) h²ω² (the θ-method; Hughes 1987, 8.2). Such a step may gain energy when stiff parts rotate far. A step that gains
//! energy is then made by backward Euler instead.
//!
//! Source: Hairer, Lubich, Wanner, *Geometric Numerical Integration*, II.1 and IV.2.

#[cfg(test)]
mod tests;

use crate::implicit::balance::Balance;
use crate::implicit::rule::Rule;
use crate::implicit::settings::fields;
use crate::implicit::step::Implicit;
use crate::implicit::theta::Theta;
use crate::implicit::workspace::Workspace;
use opruga_core::error::BuildError;
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::system::System;

/// The parameters of `implicit_midpoint`.
pub const SPEC: Spec = Spec {
    kind: "implicit_midpoint",
    summary: "implicit, second order, stable for every step size; conserves momentum, and the energy of linear systems",
    documentation: "M (v₁ − v₀) = h F in the middle of the step, x₁ = x₀ + ½ h (v₀ + v₁), solved by Newton's method. Without damping, amplitudes do \
not change; linear and angular momentum are conserved within the tolerance. While nodes touch obstacles, the amplitude of motion that is much faster \
than the step decreases by a tenth in each step, so that bodies come to rest. Bodies are not stepped in batches.",
    dimensions: &[2, 3],
    fields: fields!(of_time),
    roles: &[],
};

/// The kind of integrator that scenes call `implicit_midpoint`.
#[derive(Debug)]
pub struct ImplicitMidpointKind;

/// The implicit midpoint rule. In contact, its stage is a little later than the midpoint.
#[derive(Clone, Copy, Debug)]
pub struct ImplicitMidpoint(pub(crate) Theta);

impl<const D: usize> IntegratorKind<D> for ImplicitMidpointKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Implicit::new(SPEC.kind, ImplicitMidpoint(Theta::MIDDLE), values)?))
    }
}

impl<const D: usize> Rule<D> for ImplicitMidpoint {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = false;
    fn in_contact(self) -> Option<Self> {
        (self.0 == Theta::MIDDLE).then_some(ImplicitMidpoint(Theta::IN_CONTACT))
    }
    fn calmed(self) -> Option<Self> {
        (self.0 == Theta::IN_CONTACT).then_some(ImplicitMidpoint(Theta::END))
    }
    fn pushed(self) -> Self {
        ImplicitMidpoint(Theta::END)
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // The mean velocity w satisfies w (1 + θhc + θ²h²ω²) = v₀ − θhω² x₀, and v₁ = v₀ + (w − v₀)/θ.
        let (square, theta) = (omega * omega, self.0.value());
        let factor = 1.0 / (1.0 + theta * h * c + theta * theta * h * h * square);
        let (of_x, of_v) = (-theta * h * square * factor, factor);
        Amplification::new([[1.0 + h * of_x, h * of_v], [of_x / theta, 1.0 + (of_v - 1.0) / theta]])
    }
    fn begin(&self, _system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance {
        self.0.begin(workspace, h)
    }
    fn end(&self, _system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, _h: f64) {
        self.0.end(workspace, balance);
    }
}
