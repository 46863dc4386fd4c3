//! Models of Opruga: one folder per model, each an energy and its derivatives.

pub mod as_published;
pub mod bending;
pub mod drag;
pub mod mass_spring;
pub mod pressure;

use opruga_core::potential::Model;

/// Every model of this crate.
pub fn all<const D: usize>() -> Vec<Box<dyn Model<D>>> {
    vec![
        Box::new(mass_spring::MassSpring),
        Box::new(pressure::PressureModel),
        Box::new(bending::BendingModel),
        Box::new(drag::DragModel),
        Box::new(as_published::AsPublishedModel),
    ]
}
