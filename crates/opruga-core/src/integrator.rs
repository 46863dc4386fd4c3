//! What an integrator is to a world: it moves a system on by one substep, and knows its own stability.

use crate::error::{BuildError, StepError};
use crate::potential::Views;
use crate::spec::{Spec, Values};
use crate::system::System;
use core::fmt::Debug;

/// A rule that moves a system from time t to t + h.
pub trait Integrator<const D: usize>: Send + Sync + Debug {
    /// The word that names it.
    fn name(&self) -> &'static str;
    /// What it asks of every model; checked when a world is built.
    fn needs(&self) -> Views {
        Views::default()
    }
    /// How many pairs of columns (x, v) it uses within a step.
    fn work_columns(&self) -> usize {
        0
    }
    /// The matrix that takes (x, v) to the next step on the damped oscillator x″ = −ω²x − c x′.
    ///
    /// Its spectral radius is at most 1 where the step h is stable. The state is scaled as (x, v), not (ωx, v).
    fn amplification(&self, omega: f64, c: f64, h: f64) -> [[f64; 2]; 2];
    /// Makes one substep of h [s].
    ///
    /// # Errors
    /// [`StepError`] where a model refuses.
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError>;
}

/// A kind of integrator that scenes can name.
pub trait IntegratorKind<const D: usize>: Send + Sync {
    /// Its parameters and documentation.
    fn spec(&self) -> &'static Spec;
    /// Builds it.
    ///
    /// # Errors
    /// [`BuildError`] where a combination of parameters has no meaning.
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError>;
}

/// The largest absolute eigenvalue of a real 2×2 matrix.
pub fn spectral_radius(m: [[f64; 2]; 2]) -> f64 {
    let half_trace = 0.5 * (m[0][0] + m[1][1]);
    let determinant = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    // Written so that nothing cancels for a matrix close to the unit matrix.
    let half_difference = 0.5 * (m[0][0] - m[1][1]);
    let discriminant = half_difference * half_difference + m[0][1] * m[1][0];
    if discriminant < 0.0 { determinant.sqrt() } else { half_trace.abs() + discriminant.sqrt() }
}
