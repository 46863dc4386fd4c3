//! Every test of this crate that does not need its own process, in one program that is linked once.

#[macro_use]
mod support;

mod as_published;
mod bad_bodies;
mod bending;
mod boundary_element;
mod closed_forms;
mod conformance;
mod curves_in_order;
mod drag;
mod fem;
mod fem_boxes;
mod fem_clamped;
mod fem_closed_forms;
mod fem_heat;
mod fem_membrane;
mod fem_refusals;
mod finite_difference;
mod finite_volume;
mod invariance;
mod shape_matching;
#[path = "support/sparse.rs"]
mod sparse;
mod steps;
