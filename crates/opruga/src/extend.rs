//! The parts of a custom model or integrator.

pub use opruga_core::error::{BuildError, StepError};
pub use opruga_core::history::{Channel, History, PerBody, PerNode};
pub use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
pub use opruga_core::potential::{
    Account, Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink, Views,
};
pub use opruga_core::spec::{Allowed, Default, Field, Spec, Value, Values};
pub use opruga_core::state::{Parameter, View};
pub use opruga_core::system::{Stage, State, System, Update};
pub use opruga_core::tile::Tile;
pub use opruga_math::{Pack, Simd};

use std::ops::Range;

/// An integrator that moves the coordinates to the end of the step one after another, each independently of the others. Such an integrator is short
/// to write, whereas the integrators of this library process eight numbers at a time.
#[derive(Clone, Copy, Debug)]
pub struct ByCoordinate<F> {
    /// The substep [s].
    pub h: f64,
    /// The map from the position x [m], the velocity v [m/s] and the acceleration a [m/s²] at the start of the step to x and v at its end.
    pub rule: F,
}

impl<const D: usize, F: Fn(f64, f64, f64) -> [f64; 2]> Update<D> for ByCoordinate<F> {
    fn writes(&self) -> Stage {
        Stage::Current
    }
    fn time(&self) -> f64 {
        self.h
    }
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>) {
        for place in range.clone() {
            let (mut x, mut v) = (state.x.at(place), state.v.at(place));
            for d in 0..D {
                let acceleration = force[d][place - range.start] * inverse_mass.at(place);
                [x[d], v[d]] = (self.rule)(x[d], v[d], acceleration);
            }
            state.x.set(place, x);
            state.v.set(place, v);
        }
    }
}
