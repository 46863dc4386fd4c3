//! Opruga Studio: a window on a running scene, in which the user pulls bodies, draws new ones and changes their physics.
//!
//! [`session`] is the complete studio without a window. The other modules display the session and send requests to it.
// This crate computes no physics but only pictures and times, which may differ in the last bit between machines.
#![allow(clippy::disallowed_methods)]

pub mod differences;
pub mod document;
pub mod engine;
pub mod exploded;
pub mod keyframes;
pub mod pacing;
pub mod pair;
pub mod report;
pub mod samples;
pub mod session;
pub mod shown;

pub mod app;
pub mod canvas;
pub mod dropping;
mod hand;
pub mod handing;
pub mod measure;
mod normals;
pub mod panels;
pub mod preferences;
#[cfg(not(target_arch = "wasm32"))]
pub mod rescue;
pub mod runner;
pub mod setting;
pub mod shape_file;
pub mod share;
pub mod start_errors;
mod taps;
pub mod theme;
pub mod view_errors;
#[cfg(not(target_arch = "wasm32"))]
pub mod wanted;
#[cfg(not(target_arch = "wasm32"))]
pub mod watch;
pub mod words;
pub mod work;

#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(target_arch = "wasm32")]
pub mod page;
