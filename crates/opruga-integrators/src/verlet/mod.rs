//! # Velocity Verlet
//!
//! x₁ = x₀ + h v₀ + ½h² a₀,  v* = v₀ + h a₀,  a₁ = a(x₁, v*),  v₁ = v₀ + ½h (a₀ + a₁).
//!
//! Second order. Forces that depend on the velocity are evaluated at the end with the *predicted* velocity v*. Its error O(h²)
//! enters v₁ as O(h³), so the order stays 2 with damping. With the more usual half-kick velocity v₀ + ½h a₀, the order drops to
//! 1.
//!
//! Without damping it is the leapfrog method: it conserves the symplectic form, its energy stays within O(h²) for ever, and it is
//! stable for h ω < 2. With damping the stable region is smaller. A mode without stiffness is stable for h c < 2. Free fall is
//! exact.
//!
//! **Two forces per step.** Many programs save one force by reusing a₁ as the a₀ of the next step. Here a₁ is not reused, because
//! a₁ belongs to v* and not to v₁, and because obstacles, pins and commands move nodes between steps. Reusing a₁ would keep the
//! order, but the acceleration would become part of the state (of snapshots, hashes, merged islands), and the step would no
//! longer be a function of (x, v).
//!
//! Source: Swope et al. 1982; predicted velocity: Allen and Tildesley, *Computer Simulation of Liquids*, 3.2;
//! Hairer, Lubich, Wanner, *Geometric numerical integration illustrated by the Störmer–Verlet method*, 2003.

#[cfg(test)]
mod tests;

use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::Parameter;
use opruga_core::system::{Stage, State, System, Update};
use opruga_math::{Pack, Strip, WIDTH, lanes};
use std::ops::Range;

/// The description of `verlet`, which has no parameters.
pub const SPEC: Spec = Spec {
    kind: "verlet",
    summary: "second order, energy stays bounded: velocity Verlet, with damping forces at the predicted velocity",
    documentation: "x₁ = x₀ + h v₀ + ½h² a₀, v₁ = v₀ + ½h (a₀ + a(x₁, v₀ + h a₀)). The forces are evaluated twice per step. Without damping, the \
integrator is stable if h ω < 2 for the highest angular frequency ω.",
    dimensions: &[2, 3],
    fields: &[],
    roles: &[],
};

/// The kind of integrator that scenes call `verlet`.
#[derive(Debug)]
pub struct VerletKind;

/// Velocity Verlet with the predicted velocity in the forces at the end.
#[derive(Clone, Copy, Debug)]
pub struct Verlet;

impl<const D: usize> IntegratorKind<D> for VerletKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Verlet))
    }
}

impl<const D: usize> Integrator<D> for Verlet {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn makes_least_of_contact(&self) -> bool {
        true
    }
    fn work_columns(&self) -> usize {
        1
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        let square = omega * omega;
        // The effect of one step on x₀ = 1, v₀ = 0 and on x₀ = 0, v₀ = 1.
        let column = |x: f64, v: f64| {
            let a = -square * x - c * v;
            let end = x + h * (v + 0.5 * h * a);
            let b = -square * end - c * (v + h * a);
            [end, v + 0.5 * h * (a + b)]
        };
        let (of_x, of_v) = (column(1.0, 0.0), column(0.0, 1.0));
        Amplification::new([[of_x[0], of_v[0]], [of_x[1], of_v[1]]])
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        system.advance(Stage::Current, 0.0, 0.5 * h, None, &Drift { h })?;
        system.advance(Stage::Work(0), h, 0.5 * h, Some(h), &Kick { h })?;
        system.finish_step(h);
        Ok(())
    }
}

/// x₁ = x₀ + h v₀ + ½h² a₀ and the predicted velocity v* = v₀ + h a₀.
struct Drift {
    h: f64,
}
impl<const D: usize> Update<D> for Drift {
    fn writes(&self) -> Stage {
        Stage::Work(0)
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let (h, half) = (P::splat(self.h), P::splat(0.5));
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let x0 = Strip::<D>::new(&state.x.slices(), start, length);
        let v0 = Strip::<D>::new(&state.v.slices(), start, length);
        let [x1, predicted] = &mut state.work[0];
        let (mut x1, mut predicted) = (x1.strip_mut(start, length), predicted.strip_mut(start, length));
        for k in (0..length).step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(k);
            let velocity = lanes!(P, d => v0.load::<P>(d, k));
            let change = lanes!(P, d => force.load::<P>(d, k) * kick);
            let position = lanes!(P, d => x0.load::<P>(d, k) + (velocity[d] + change[d] * half) * h);
            for d in 0..D {
                x1.store(d, k, position[d]);
                predicted.store(d, k, velocity[d] + change[d]);
            }
        }
    }
}

/// v₁ = v₀ + ½h (a₀ + a₁), where h a₀ is recovered from v* − v₀.
struct Kick {
    h: f64,
}
impl<const D: usize> Update<D> for Kick {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.h
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let (h, half) = (P::splat(self.h), P::splat(0.5));
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let [x1, predicted] = &state.work[0];
        let x1 = Strip::<D>::new(&x1.slices(), start, length);
        let predicted = Strip::<D>::new(&predicted.slices(), start, length);
        let mut x = state.x.strip_mut(start, length);
        let mut v = state.v.strip_mut(start, length);
        for k in (0..length).step_by(WIDTH) {
            let kick = h * inverse_mass.load::<P>(k);
            let position = lanes!(P, d => x1.load::<P>(d, k));
            let old = lanes!(P, d => v.load::<P>(d, k));
            let change = lanes!(P, d => (predicted.load::<P>(d, k) - old[d]) + force.load::<P>(d, k) * kick);
            for d in 0..D {
                x.store(d, k, position[d]);
                v.store(d, k, old[d] + change[d] * half);
            }
        }
    }
}
