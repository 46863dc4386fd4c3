//! # Verification
//!
//! The engine against closed forms and published numbers, by the way that every user goes: the text of a scene, a world,
//! its frames, its readings. Nothing here looks into the engine.
//!
//! A [`Case`] says, before it is run, what is measured, which value is expected (a literal with its source, never a
//! number of ours), at which meshes or steps, how large the error may be on the finest and at which order it must fall.
//! [`Case::run`] makes a [`Row`] of it; [`run_all`] does so for many at once; [`table`], [`to_json`], [`markdown`] and
//! [`html`] show them, [`plot`] draws one.
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
