//! Integrators of Opruga: one folder per integrator.

pub mod backward_euler;
pub mod bdf2;
pub mod equilibrium;
pub mod explicit_euler;
mod first_stage;
pub mod heun;
mod implicit;
pub mod implicit_midpoint;
pub mod newmark;
#[doc(hidden)]
pub mod refusals;
pub mod runge_kutta;
pub mod symplectic_euler;
pub mod verlet;

#[cfg(test)]
mod testing;

pub use implicit::holding::accelerations;

use core::any::Any;
use opruga_core::integrator::IntegratorKind;

/// Every integrator of this crate, in two or three dimensions.
pub fn all<const D: usize>() -> Vec<Box<dyn IntegratorKind<D>>> {
    let every: Box<dyn Any> = match D {
        2 => Box::new(of_the_plane()),
        3 => Box::new(of_space()),
        _ => return Vec::new(),
    };
    every.downcast().map_or_else(|_| Vec::new(), |integrators| *integrators)
}

// This is not generic, so that the integrators are compiled once, with this crate, and not again with every crate that uses
// them.
fn of_the_plane() -> Vec<Box<dyn IntegratorKind<2>>> {
    list()
}
fn of_space() -> Vec<Box<dyn IntegratorKind<3>>> {
    list()
}

fn list<const D: usize>() -> Vec<Box<dyn IntegratorKind<D>>> {
    vec![
        Box::new(symplectic_euler::SymplecticEulerKind),
        Box::new(explicit_euler::ExplicitEulerKind),
        Box::new(heun::HeunKind),
        Box::new(verlet::VerletKind),
        Box::new(runge_kutta::RungeKuttaKind),
        Box::new(backward_euler::BackwardEulerKind),
        Box::new(bdf2::Bdf2Kind),
        Box::new(implicit_midpoint::ImplicitMidpointKind),
        Box::new(newmark::NewmarkKind),
        Box::new(equilibrium::EquilibriumKind),
    ]
}
