//! Chores of the workspace: `cargo xtask licences | goldens | gallery | bench | web | web-trial | web-measure`.
#![allow(clippy::disallowed_methods)] // no physics here

mod bench;
mod gallery;
mod goldens;
mod licences;
mod web;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.first().map(String::as_str) {
        Some("licences") => licences::check(),
        Some("goldens") => goldens::write(),
        Some("gallery") => gallery::run(&arguments[1..]),
        Some("bench") => bench::compare(),
        Some("web") => web::build(&arguments[1..]),
        Some("web-trial") => web::trial(&arguments[1..]),
        Some("web-measure") => web::measure(&arguments[1..]),
        _ => Err(
            "usage: cargo xtask licences | goldens | gallery [--check] [PICTURE …] | bench | web [--serve] [--port NUMBER] | \
                  web-trial [PROFILE] | web-measure [PICTURES]"
                .into(),
        ),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
