//! The panels around the scene.

pub mod bars;
pub mod gallery;
pub mod keeping;
pub mod palette;
pub mod parameter;
pub mod plots;
pub mod properties;
pub mod status;
mod thumbnails;
