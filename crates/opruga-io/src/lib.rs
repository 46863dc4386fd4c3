//! Everything that Opruga reads and writes: scene files, whose errors are all reported at once, with their reference page and JSON Schema; tables;
//! checkpoints; and files that are never left half written.

#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

mod aside;
pub mod base64;
mod brackets;
mod budget;
mod canonical;
pub mod catalogue;
pub mod checkpoint;
mod document;
pub mod files;
mod limits;
mod machine;
pub mod meshes;
#[doc(hidden)]
pub mod messages;
pub mod output_folder;
pub mod outputs_apart;
pub mod overrides;
pub mod problem;
pub mod recording;
pub mod reference;
pub mod refusals;
mod regular_file;
mod rounding;
pub mod safe_write;
pub mod scene;
pub mod schema;
pub mod series;
pub mod shapes;
mod source;
pub mod tables;
pub mod template;
mod text_errors;
pub mod tracks;
pub mod write_faults;

pub use catalogue::Catalogue;
pub use files::Files;
pub use problem::{Notice, SceneError};
