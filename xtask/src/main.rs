//! Chores of the workspace: `cargo xtask licences | goldens | bench`.
#![allow(clippy::disallowed_methods)] // no physics here

mod bench;
mod goldens;
mod licences;

use std::process::ExitCode;

fn main() -> ExitCode {
    let outcome = match std::env::args().nth(1).as_deref() {
        Some("licences") => licences::check(),
        Some("goldens") => goldens::write(),
        Some("bench") => bench::compare(),
        _ => Err("usage: cargo xtask licences | goldens | bench".into()),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
