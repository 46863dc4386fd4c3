//! # Symplectic Euler
//!
//! v₁ = v₀ + h a(x₀, v₀), x₁ = x₀ + h v₁ (the method of the thesis, section 2.4). First order. The method conserves the
//! symplectic form, so the error of the energy of an undamped system stays within O(h) for ever. The method is stable for
//! h ω < 2 without damping. With damping, which is evaluated at the old velocity, the method is stable for h < (2/ω)(√(1
//! + ζ²) − ζ).

#[cfg(test)]
mod tests;

use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Role, Spec, Values};
use opruga_core::state::Parameter;
use opruga_core::system::{Stage, State, System, Update};
use opruga_math::{Pack, Strip, WIDTH};
use std::ops::Range;

/// The description of `symplectic_euler`, which has no parameters.
pub const SPEC: Spec = Spec {
    kind: "symplectic_euler",
    summary: "first order, energy stays bounded: the integrator of the thesis",
    documentation: "v₁ = v₀ + h a(x₀, v₀), x₁ = x₀ + h v₁. The forces are evaluated once per step. Without damping, the integrator is stable if h ω \
< 2 for the highest angular frequency ω.",
    dimensions: &[2, 3],
    fields: &[],
    roles: &[Role::OfferedExplicit],
};

/// The kind of integrator that scenes call `symplectic_euler`.
#[derive(Debug)]
pub struct SymplecticEulerKind;

/// The rule v₁ = v₀ + h a₀, x₁ = x₀ + h v₁.
#[derive(Clone, Copy, Debug)]
pub struct SymplecticEuler;

impl<const D: usize> IntegratorKind<D> for SymplecticEulerKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(SymplecticEuler))
    }
}

impl<const D: usize> Integrator<D> for SymplecticEuler {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn kicks_by_first_force(&self) -> bool {
        true
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        let (k, d) = (-omega * omega * h, 1.0 - c * h);
        Amplification::new([[1.0 + h * k, h * d], [k, d]])
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
            for d in 0..D {
                let velocity = v.load::<P>(d, k) + force.load::<P>(d, k) * kick;
                v.store(d, k, velocity);
                x.store(d, k, x.load::<P>(d, k) + velocity * h);
            }
        }
    }
}
