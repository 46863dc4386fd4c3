//! # Verification
//!
//! This crate compares the engine with closed forms and published numbers through the public interface: the text of a scene, a world, its frames and
//! its readings. The crate does not access the internals of the engine.
//!
//! A [`Case`] defines, before it is run, the measured quantity, the expected value (a literal with its source, never a number of this engine), the
//! meshes or steps, the largest error on the finest one, and the order at which the error must fall. [`Case::run`] runs it and returns a [`Row`], and
//! [`run_all`] runs many cases at once. [`table`], [`to_json`], [`markdown`] and [`html`] show the rows, and [`plot`] draws one.
//!
//! ```
//! use opruga_verify::{Lab, cases};
//!
//! let case = cases().find(|case| case.name == "uniaxial-stress-neo-hookean").expect("a case");
//! let row = case.run(&Lab::default());
//! assert!(row.pass, "{row:?}");
//! ```
#![allow(clippy::disallowed_methods)] // sines and powers of closed forms, none of which the engine sees

mod bodies;
mod case;
mod cases;
mod lab;
mod plots;
mod report;
mod run;

pub use case::{Case, Check, Family, Over, Point, Row, Scale};
pub use cases::{LEFT_OUT, cases};
pub use lab::{Lab, Trouble};
pub use plots::plot;
pub use report::{html, markdown, overview, table, to_json};
pub use run::run_all;
