//! The first stage of the Runge–Kutta methods.

use opruga_core::state::Parameter;
use opruga_core::system::{Stage, State, Update};
use opruga_math::{Pack, Strip, WIDTH, lanes};
use std::ops::Range;

/// Computes y₁ = y₀ + s k₀ with k₀ = (v₀, a₀) from the current state, and writes it to the first work columns.
pub(crate) struct FirstStage {
    /// The time s [s] during which the state follows the slope k₀.
    pub(crate) span: f64,
}

impl<const D: usize> Update<D> for FirstStage {
    fn writes(&self) -> Stage {
        Stage::Work(0)
    }
    fn time(&self) -> f64 {
        self.span
    }
    #[inline(always)]
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        let span = P::splat(self.span);
        let (start, length) = (range.start, range.len());
        let force = Strip::<D>::new(force, 0, length);
        let inverse_mass = inverse_mass.strip(start, length);
        let x0 = Strip::<D>::new(&state.x.slices(), start, length);
        let v0 = Strip::<D>::new(&state.v.slices(), start, length);
        let [x1, v1] = &mut state.work[0];
        let (mut x1, mut v1) = (x1.strip_mut(start, length), v1.strip_mut(start, length));
        for k in (0..length).step_by(WIDTH) {
            let kick = span * inverse_mass.load::<P>(k);
            // All reads come before the first write, because a read after a write has to wait for it.
            let velocity = lanes!(P, d => v0.load::<P>(d, k));
            let position = lanes!(P, d => x0.load::<P>(d, k) + velocity[d] * span);
            let next = lanes!(P, d => velocity[d] + force.load::<P>(d, k) * kick);
            for d in 0..D {
                x1.store(d, k, position[d]);
                v1.store(d, k, next[d]);
            }
        }
    }
}
