//! Models of Opruga: one folder per model, each an energy and its derivatives.

pub mod mass_spring;
pub mod pressure;

use opruga_core::potential::Model;

/// Every model of this crate.
pub fn all<const D: usize>() -> Vec<Box<dyn Model<D>>> {
    vec![Box::new(mass_spring::MassSpring), Box::new(pressure::PressureModel)]
}
