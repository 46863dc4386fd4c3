//! # Backward Euler
//!
//! x₁ = x₀ + h v₁,  M (v₁ − v₀) = h F(x₁, v₁, t₁).
//!
//! First order, stable for every step size. The end of the step is the minimum of the incremental potential Φ(x) = |x − x₀ − h
//! v₀|²_M / 2h² + U(x) (Martin et al. 2011), so a step always has a solution.
//!
//! Backward Euler damps. In each step, the amplitude of an oscillation is multiplied by 1/√(1 + h²ω²), which is 0.995 at hω =
//! 0.1 and 0.1 at hω = 10. This damping is a numerical error and not physics, but it makes the integrator forgiving: motion
//! that is too fast for the step dies out at once, and slow motion remains. Equilibrium is exact: if the forces balance,
//! nothing moves, whatever h is. In free fall the position is −½ g t² (1 + h/t).
//!
//! Source: Baraff and Witkin 1998; Hairer and Wanner, *Solving Ordinary Differential Equations II*, IV.3.

#[cfg(test)]
mod tests;

use crate::implicit::balance::Balance;
use crate::implicit::rule::Rule;
use crate::implicit::settings::fields;
use crate::implicit::step::Implicit;
use crate::implicit::workspace::Workspace;
use opruga_core::error::BuildError;
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Role, Spec, Values};
use opruga_core::system::System;

/// The parameters of `backward_euler`.
pub const SPEC: Spec = Spec {
    kind: "backward_euler",
    summary: "implicit, first order, stable for every step size; damps fast motion",
    documentation: "x₁ = x₀ + h v₁, M (v₁ − v₀) = h F(x₁, v₁), solved by Newton's method. In each step, the amplitude of an oscillation is \
multiplied by 1/√(1 + h²ω²); this damping is an error of the integrator, not physics. With `accuracy = \"exact\"`, the equations hold within \
`tolerance`; with `accuracy = \"real_time\"`, the step has a fixed budget. Contact with obstacles is a part of the solution: bodies come to rest on \
them and stick or slip by Coulomb's law. Bodies are not stepped in batches.",
    dimensions: &[2, 3],
    fields: fields!(of_time),
    roles: &[Role::OfferedImplicit],
};

/// The kind of integrator that scenes call `backward_euler`.
#[derive(Debug)]
pub struct BackwardEulerKind;

/// The integrator x₁ = x₀ + h v₁, M (v₁ − v₀) = h F(x₁, v₁, t₁).
#[derive(Clone, Copy, Debug)]
pub struct BackwardEuler;

impl<const D: usize> IntegratorKind<D> for BackwardEulerKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Implicit::new(SPEC.kind, BackwardEuler, values)?))
    }
}

impl<const D: usize> Rule<D> for BackwardEuler {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = false;
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // v₁ (1 + h c + h²ω²) = v₀ − h ω² x₀.
        let square = omega * omega;
        let factor = 1.0 / (1.0 + h * c + h * h * square);
        let (of_x, of_v) = (-h * square * factor, factor);
        Amplification::new([[1.0 + h * of_x, h * of_v], [of_x, of_v]])
    }
    fn begin(&self, _system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance {
        for (y, v) in workspace.y.iter_mut().zip(&workspace.v0) {
            *y = h * v;
        }
        workspace.z.fill(0.0);
        Balance { sigma: 1.0 / (h * h), beta: 1.0 / h, theta: 1.0, time: h, h, load: 1.0, impulse: 1.0, echo: 0.0 }
    }
    fn end(&self, _system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, _h: f64) {
        for k in 0..workspace.u.len() {
            workspace.u1[k] = workspace.u[k];
            workspace.v1[k] = balance.beta * workspace.u[k];
        }
    }
}
