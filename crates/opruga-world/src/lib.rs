//! Worlds of Opruga: bodies, obstacles, time, commands and what can be read of them.

mod any_scene;
mod any_world;
pub mod blueprint;
mod body_bytes;
mod body_view;
mod build;
mod bytes;
mod carried;
mod changes;
mod commands;
mod compiled_once;
mod crushed;
pub mod error;
mod frame_hash;
mod inputs;
mod inverted;
mod island;
pub mod ledger;
mod loads;
mod looks;
pub mod memory;
pub mod modes;
mod node_states;
mod other_balances;
mod pin_ways;
mod plausible;
mod population;
mod problems;
mod programs;
mod readings;
mod rebuild;
pub mod registry;
mod scene_delta;
pub mod schema;
pub mod selection;
pub mod shapes;
mod slender;
mod slots;
mod snapshot;
mod stability;
mod turned;
pub mod validity;
mod world;

pub use any_scene::{AnyBody, AnyScene};
pub use any_world::{AnyWorld, Strided, Vectors};
pub use body_view::BodyView;
pub use error::WorldError;
pub use inputs::Input;
pub use ledger::{Energy, Momentum};
pub use loads::ForceLaw;
pub use node_states::NodeState;
pub use opruga_core::break_off::BreakOff;
/// What the laws of the finite elements say at one deformation gradient.
pub mod law {
    pub use opruga_models::fem::{SPEC, own_fields};
    pub use opruga_models::materials::{AtPoint, NAMES, in_plane, in_space};
}
pub use registry::Registry;
pub use slots::BodyHandle;
pub use world::{Options, Warning, World};
