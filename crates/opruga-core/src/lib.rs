//! The language of Opruga: what models, integrators and obstacles are to one another.

pub mod accumulator;
mod advance;
pub mod break_off;
pub mod check;
pub mod contacts;
pub mod dense;
mod dense_part;
pub mod error;
pub mod history;
mod implicit;
pub mod inertia;
pub mod integrator;
mod ledger;
mod lending;
pub mod memory;
pub mod pair;
mod pinned_motion;
mod pins;
pub mod potential;
pub mod spec;
pub mod stability;
pub mod state;
pub mod stencil;
pub mod system;
pub mod threads;
pub mod tile;
mod workspace;
