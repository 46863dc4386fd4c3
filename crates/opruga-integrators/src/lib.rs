//! Integrators of Opruga: one folder per rule.

pub mod symplectic_euler;

use opruga_core::integrator::IntegratorKind;

/// Every integrator of this crate.
pub fn all<const D: usize>() -> Vec<Box<dyn IntegratorKind<D>>> {
    vec![Box::new(symplectic_euler::SymplecticEulerKind)]
}
