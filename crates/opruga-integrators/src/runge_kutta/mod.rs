//! # The classical Runge–Kutta rule
//!
//! With y = (x, v) and k(y) = (v, a(x, v)):
//!
//! ```text
//! k₀ = k(y₀)      y₁ = y₀ + ½h k₀            0 |
//! k₁ = k(y₁)      y₂ = y₀ + ½h k₁            ½ | ½
//! k₂ = k(y₂)      y₃ = y₀ +  h k₂            ½ | 0  ½
//! k₃ = k(y₃)                                 1 | 0  0  1
//! y  = y₀ + h/6 (k₀ + 2 k₁ + 2 k₂ + k₃)        | ⅙  ⅓  ⅓  ⅙
//! ```
//!
//! Fourth order (also with damping), four forces per step. The stability function is R(z) = 1 + z + z²/2 + z³/6 + z⁴/24. On the
//! imaginary axis |R|² = 1 − (hω)⁶/72 + (hω)⁸/576. Without damping, the method is therefore stable for h ω ≤ 2√2 = 2.828, and it
//! dissipates the fraction (hω)⁶/72 of the energy per step. A mode without stiffness is stable for h c ≤ 2.785. Free fall is
//! exact.
//!
//! **Slopes are not stored**: h a₀ = 2 (v₁ − v₀), h a₁ = 2 (v₂ − v₀), h a₂ = v₃ − v₀, and the slopes of x are the velocities of
//! the stages. So the end of the step is known as soon as y₃ is, except for the term h a₃/6; this end replaces y₂ in memory.
//! Two pairs of work columns are enough for four stages:
//!
//! ```text
//! stage   forces in   reads           writes
//! 1       current     x₀ v₀           work 0 ← y₁
//! 2       work 0      x₀ v₀ v₁        work 1 ← y₂
//! 3       work 1      x₀ v₀ v₁ v₂     work 0 ← y₃, work 1 ← end without a₃
//! 4       work 0      work 1          current ← end
//! ```
//!
//! Source: Kutta 1901; Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, II.1, table 1.2.

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

/// The description of `runge_kutta`, which has no parameters.
pub const SPEC: Spec = Spec {
    kind: "runge_kutta",
    summary: "fourth order: the classical Runge–Kutta method",
    documentation: "y = y₀ + h/6 (k₀ + 2 k₁ + 2 k₂ + k₃) with the slopes k = (v, a) at the start, twice in the middle and at the end. The forces are \
evaluated four times per step. Without damping, the integrator is stable if h ω ≤ 2.828 for the highest angular frequency ω; a step then removes the \
fraction (hω)⁶/72 of the energy of a mode.",
    dimensions: &[2, 3],
    fields: &[],
    roles: &[],
};

/// The kind of integrator that scenes call `runge_kutta`.
#[derive(Debug)]
pub struct RungeKuttaKind;

/// The classical fourth-order method.
#[derive(Clone, Copy, Debug)]
pub struct RungeKutta;

impl<const D: usize> IntegratorKind<D> for RungeKuttaKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(RungeKutta))
    }
}

impl<const D: usize> Integrator<D> for RungeKutta {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn work_columns(&self) -> usize {
        2
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // 1 + A (1 + A/2 (1 + A/3 (1 + A/4))) with A = h [[0, 1], [−ω², −c]].
        let (s, b) = (-h * omega * omega, -h * c);
        let mut r = [[1.0, 0.0], [0.0, 1.0]];
        for divisor in [4.0, 3.0, 2.0, 1.0] {
            let f = 1.0 / divisor;
            r = [
                [1.0 + f * h * r[1][0], f * h * r[1][1]],
                [f * (s * r[0][0] + b * r[1][0]), 1.0 + f * (s * r[0][1] + b * r[1][1])],
            ];
        }
        Amplification::new(r)
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        let (half, third, sixth) = (0.5 * h, h / 3.0, h / 6.0);
        system.advance(Stage::Current, 0.0, sixth, None, &FirstStage { span: half })?;
        system.advance(Stage::Work(0), half, third, None, &SecondStage { h })?;
        system.advance(Stage::Work(1), half, third, None, &ThirdStage { h })?;
        system.advance(Stage::Work(0), h, sixth, Some(h), &End { h })?;
        system.finish_step(h);
        Ok(())
    }
}

/// y₂ = y₀ + ½h k₁ into work 1.
struct SecondStage {
    h: f64,
}
impl<const D: usize> Update<D> for SecondStage {
    fn writes(&self) -> Stage {
        Stage::Work(1)
    }
    fn time(&self) -> f64 {
        0.5 * self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let half_step = P::splat(0.5 * self.h);
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let x0 = Strip::<D>::new(&state.x.slices(), start, length);
        let v0 = Strip::<D>::new(&state.v.slices(), start, length);
        let (first, second) = state.work.split_at_mut(1);
        let v1 = Strip::<D>::new(&first[0][1].slices(), start, length);
        let [x2, v2] = &mut second[0];
        let (mut x2, mut v2) = (x2.strip_mut(start, length), v2.strip_mut(start, length));
        for k in (0..length).step_by(WIDTH) {
            let kick = half_step * inverse_mass.load::<P>(k);
            let position = lanes!(P, d => x0.load::<P>(d, k) + v1.load::<P>(d, k) * half_step);
            let velocity = lanes!(P, d => v0.load::<P>(d, k) + force.load::<P>(d, k) * kick);
            for d in 0..D {
                x2.store(d, k, position[d]);
                v2.store(d, k, velocity[d]);
            }
        }
    }
}

/// Writes y₃ = y₀ + h k₂ to work 0, and the end of the step without the acceleration a₃ to work 1.
struct ThirdStage {
    h: f64,
}
impl<const D: usize> Update<D> for ThirdStage {
    fn writes(&self) -> Stage {
        Stage::Work(0)
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let (h, sixth, third) = (P::splat(self.h), P::splat(self.h / 6.0), P::splat(1.0 / 3.0));
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let x0 = Strip::<D>::new(&state.x.slices(), start, length);
        let v0 = Strip::<D>::new(&state.v.slices(), start, length);
        let (first, second) = state.work.split_at_mut(1);
        let [x3, v1] = &mut first[0];
        let [end, v2] = &mut second[0];
        let (mut x3, mut v1) = (x3.strip_mut(start, length), v1.strip_mut(start, length));
        let (mut end, mut v2) = (end.strip_mut(start, length), v2.strip_mut(start, length));
        for k in (0..length).step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(k);
            let position = lanes!(P, d => x0.load::<P>(d, k));
            let a = lanes!(P, d => v0.load::<P>(d, k));
            let b = lanes!(P, d => v1.load::<P>(d, k));
            let c = lanes!(P, d => v2.load::<P>(d, k));
            let change = lanes!(P, d => force.load::<P>(d, k) * kick);
            for d in 0..D {
                let last = a[d] + change[d];
                x3.store(d, k, position[d] + c[d] * h);
                v1.store(d, k, last);
                // x = x₀ + h/6 (v₀ + 2 v₁ + 2 v₂ + v₃).
                let middle = b[d] + c[d];
                end.store(d, k, position[d] + ((a[d] + last) + (middle + middle)) * sixth);
                // v = v₀ + ⅓ ((v₁ − v₀) + 2 (v₂ − v₀) + h a₂) + h/6 a₃: differences first, so that v₀ is not rounded.
                let again = c[d] - a[d];
                v2.store(d, k, a[d] + (((b[d] - a[d]) + change[d]) + (again + again)) * third);
            }
        }
    }
}

/// The end of the step, from work 1 and the last acceleration.
struct End {
    h: f64,
}
impl<const D: usize> Update<D> for End {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let sixth = P::splat(self.h / 6.0);
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let [end, almost] = &state.work[1];
        let end = Strip::<D>::new(&end.slices(), start, length);
        let almost = Strip::<D>::new(&almost.slices(), start, length);
        let mut x = state.x.strip_mut(start, length);
        let mut v = state.v.strip_mut(start, length);
        for k in (0..length).step_by(WIDTH) {
            let kick = sixth * inverse_mass.load::<P>(k);
            let position = lanes!(P, d => end.load::<P>(d, k));
            let velocity = lanes!(P, d => almost.load::<P>(d, k) + force.load::<P>(d, k) * kick);
            for d in 0..D {
                x.store(d, k, position[d]);
                v.store(d, k, velocity[d]);
            }
        }
    }
}
