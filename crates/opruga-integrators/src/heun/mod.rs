//! # Heun's rule (explicit trapezoid)
//!
//! With y = (x, v) and k(y) = (v, a(x, v)):
//!
//! k₀ = k(y₀),  y₁ = y₀ + h k₀,  y = y₀ + ½h (k₀ + k(y₁)).
//!
//! Second order (also with damping), two forces per step; Butcher table `0 | ; 1 | 1 ; ½ ½`. The method is written so that no
//! slope is stored: x = x₀ + ½h (v₀ + v₁), v = v₀ + ½ ((v₁ − v₀) + h a₁).
//!
//! The stability function is R(z) = 1 + z + ½z². On the imaginary axis |R|² = 1 + ¼(hω)⁴: **no step is stable without
//! damping**, and energy grows by the fraction ¼ω⁴h³ per second (slowly: at hω = 0.1 by 2.5e-5 per step). An overdamped mode is
//! stable for h |μ| ≤ 2. Free fall is exact.
//!
//! Source: Heun 1900; Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.1.

#[cfg(test)]
mod tests;

use crate::first_stage::FirstStage;
use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::Parameter;
use opruga_core::system::{Stage, State, System, Update};
use opruga_math::{Pack, Strip, WIDTH, lanes};
use std::ops::Range;

/// The description of `heun`, which has no parameters.
pub const SPEC: Spec = Spec {
    kind: "heun",
    summary: "the explicit trapezoidal rule: second order; energy grows slowly",
    documentation: "y₁ = y₀ + h k(y₀), y = y₀ + ½h (k(y₀) + k(y₁)) with k = (v, a). The forces are evaluated twice per step. Without damping, no \
step is stable: the energy of a mode of angular frequency ω grows at the relative rate ¼ω⁴h³.",
    dimensions: &[2, 3],
    fields: &[],
    roles: &[],
};

/// The kind of integrator that scenes call `heun`.
#[derive(Debug)]
pub struct HeunKind;

/// The explicit trapezoidal rule.
#[derive(Clone, Copy, Debug)]
pub struct Heun;

impl<const D: usize> IntegratorKind<D> for HeunKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Heun))
    }
}

impl<const D: usize> Integrator<D> for Heun {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn work_columns(&self) -> usize {
        1
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // 1 + A + ½A² with A = h [[0, 1], [−ω², −c]].
        let (s, b) = (-h * omega * omega, -h * c);
        Amplification::new([[1.0 + 0.5 * h * s, h + 0.5 * h * b], [s + 0.5 * b * s, 1.0 + b + 0.5 * (s * h + b * b)]])
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        system.advance(Stage::Current, 0.0, 0.5 * h, None, &FirstStage { span: h })?;
        system.advance(Stage::Work(0), h, 0.5 * h, Some(h), &Trapezoid { h })?;
        system.finish_step(h);
        Ok(())
    }
}

/// y = y₀ + ½h (k₀ + k₁), where h k₀ is recovered from y₁ − y₀.
struct Trapezoid {
    h: f64,
}
impl<const D: usize> Update<D> for Trapezoid {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let (h, half, half_step) = (P::splat(self.h), P::splat(0.5), P::splat(0.5 * self.h));
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let v1 = Strip::<D>::new(&state.work[0][1].slices(), start, length);
        let mut x = state.x.strip_mut(start, length);
        let mut v = state.v.strip_mut(start, length);
        for k in (0..length).step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(k);
            let first = lanes!(P, d => v.load::<P>(d, k));
            let last = lanes!(P, d => v1.load::<P>(d, k));
            let position = lanes!(P, d => x.load::<P>(d, k) + (first[d] + last[d]) * half_step);
            let velocity = lanes!(P, d => first[d] + ((last[d] - first[d]) + force.load::<P>(d, k) * kick) * half);
            for d in 0..D {
                x.store(d, k, position[d]);
                v.store(d, k, velocity[d]);
            }
        }
    }
}
