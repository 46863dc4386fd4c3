//! # Explicit Euler
//!
//! x₁ = x₀ + h v₀,  v₁ = v₀ + h a(x₀, v₀) (Euler 1768). First order, one force per step.
//!
//! On x″ = −ω²x − c x′ the step multiplies (x, v) by
//!
//! ```text
//! |   1       h    |
//! | −h ω²  1 − h c |
//! ```
//!
//! whose eigenvalues are 1 + h μ with μ² + c μ + ω² = 0. Without damping their modulus is √(1 + h²ω²): **no step is stable**,
//! and energy grows by the fraction ω²h per second. A mode with damping is stable for h ≤ c/ω² (if it still oscillates) or h ≤
//! 2/|μ| (if it does not). Free fall is too slow: y = −g h² n(n − 1)/2 after n steps.
//!
//! The method serves for comparison. [`crate::symplectic_euler`] costs the same and conserves the energy.

#[cfg(test)]
mod tests;

use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::Parameter;
use opruga_core::system::{Stage, State, System, Update};
use opruga_math::{Pack, Strip, WIDTH, lanes};
use std::ops::Range;

/// The description of `explicit_euler`, which has no parameters.
pub const SPEC: Spec = Spec {
    kind: "explicit_euler",
    summary: "first order, energy grows; for comparison only",
    documentation: "x₁ = x₀ + h v₀, v₁ = v₀ + h a(x₀, v₀). The forces are evaluated once per step. Without damping, no step is stable: the energy of \
a mode of angular frequency ω grows at the relative rate ω²h.",
    dimensions: &[2, 3],
    fields: &[],
    roles: &[],
};

/// The kind of integrator that scenes call `explicit_euler`.
#[derive(Debug)]
pub struct ExplicitEulerKind;

/// The rule x₁ = x₀ + h v₀, v₁ = v₀ + h a₀.
#[derive(Clone, Copy, Debug)]
pub struct ExplicitEuler;

impl<const D: usize> IntegratorKind<D> for ExplicitEulerKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(ExplicitEuler))
    }
}

impl<const D: usize> Integrator<D> for ExplicitEuler {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn kicks_by_first_force(&self) -> bool {
        true
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        Amplification::new([[1.0, h], [-omega * omega * h, 1.0 - c * h]])
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        system.advance(Stage::Current, 0.0, h, Some(h), &Rule { h })?;
        system.finish_step(h);
        Ok(())
    }
}

struct Rule {
    h: f64,
}
impl<const D: usize> Update<D> for Rule {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let h = P::splat(self.h);
        let length = range.len();
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(range.start, length);
        let mut x = state.x.strip_mut(range.start, length);
        let mut v = state.v.strip_mut(range.start, length);
        for k in (0..length).step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(k);
            // All reads come before the first write, because a read after a write has to wait for it.
            let velocity = lanes!(P, d => v.load::<P>(d, k));
            let position = lanes!(P, d => x.load::<P>(d, k) + velocity[d] * h);
            let next = lanes!(P, d => velocity[d] + force.load::<P>(d, k) * kick);
            for d in 0..D {
                x.store(d, k, position[d]);
                v.store(d, k, next[d]);
            }
        }
    }
}
