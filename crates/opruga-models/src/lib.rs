//! Models of Opruga: one folder per model, each with an energy and its derivatives.

pub mod as_published;
pub mod bending;
pub mod boundary_element;
pub mod drag;
pub mod fem;
pub mod finite_difference;
pub mod finite_volume;
pub mod mass_spring;
pub mod materials;
pub mod pressure;
pub mod shape_matching;
mod vectors;

use core::any::Any;
use opruga_core::potential::Model;

/// All messages of this crate, for tests of translations.
#[doc(hidden)]
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    mass_spring::Refusal::VARIANTS,
    pressure::Refusal::VARIANTS,
    bending::Refusal::VARIANTS,
    as_published::Refusal::VARIANTS,
    materials::Refusal::VARIANTS,
    fem::Simplices::VARIANTS,
    fem::Refusal::VARIANTS,
    boundary_element::Refusal::VARIANTS,
    boundary_element::NoSolution::VARIANTS,
    boundary_element::TurnedFacets::VARIANTS,
    shape_matching::Refusal::VARIANTS,
    shape_matching::MatchingWarning::VARIANTS,
    finite_volume::Refusal::VARIANTS,
    finite_difference::FiniteDifferenceError::VARIANTS,
    finite_difference::FiniteDifferenceWarning::VARIANTS,
    pressure::PressureWarning::VARIANTS,
];

/// Every model of this crate, in two or three dimensions.
pub fn all<const D: usize>() -> Vec<Box<dyn Model<D>>> {
    let every: Box<dyn Any> = match D {
        2 => Box::new(of_the_plane()),
        3 => Box::new(of_space()),
        _ => return Vec::new(),
    };
    every.downcast().map_or_else(|_| Vec::new(), |models| *models)
}

// This is not generic, so that the models are compiled once, with this crate, and not again with every crate that uses them.
fn of_the_plane() -> Vec<Box<dyn Model<2>>> {
    let mut models = list();
    models.push(Box::new(fem::FemModel));
    models.push(Box::new(finite_volume::FiniteVolumeModel));
    models
}
fn of_space() -> Vec<Box<dyn Model<3>>> {
    let mut models = list();
    models.push(Box::new(fem::FemModel));
    models.push(Box::new(finite_volume::FiniteVolumeModel));
    models
}

// Models with one source for both dimensions.
fn list<const D: usize>() -> Vec<Box<dyn Model<D>>> {
    vec![
        Box::new(mass_spring::MassSpring),
        Box::new(pressure::PressureModel),
        Box::new(bending::BendingModel),
        Box::new(drag::DragModel),
        Box::new(finite_difference::FiniteDifferenceModel),
        Box::new(boundary_element::BoundaryElementModel),
        Box::new(as_published::AsPublishedModel),
        Box::new(shape_matching::ShapeMatchingModel),
    ]
}
