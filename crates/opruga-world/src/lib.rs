//! Worlds of Opruga: bodies, obstacles, time, commands and what can be read of them.

pub mod blueprint;
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
pub mod modes;
mod other_balances;
mod plausible;
mod population;
mod problems;
mod readings;
mod rebuild;
pub mod registry;
pub mod schema;
pub mod selection;
pub mod shapes;
mod snapshot;
mod stability;
mod world;

pub use error::WorldError;
pub use inputs::Input;
pub use ledger::{Energy, Momentum};
pub use loads::ForceLaw;
pub use registry::Registry;
pub use world::{BodyHandle, Options, Warning, World};
