//! Integrators of Opruga: one folder per rule.

pub mod explicit_euler;
mod first_stage;
pub mod heun;
pub mod runge_kutta;
pub mod symplectic_euler;
pub mod verlet;

#[cfg(test)]
mod testing;

use opruga_core::integrator::IntegratorKind;

/// Every integrator of this crate.
pub fn all<const D: usize>() -> Vec<Box<dyn IntegratorKind<D>>> {
    vec![
        Box::new(symplectic_euler::SymplecticEulerKind),
        Box::new(explicit_euler::ExplicitEulerKind),
        Box::new(heun::HeunKind),
        Box::new(verlet::VerletKind),
        Box::new(runge_kutta::RungeKuttaKind),
    ]
}
