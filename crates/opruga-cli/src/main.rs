//! The program `opruga`: runs scenes, checks them, lists what there is, measures speed.
#![allow(clippy::disallowed_methods)] // no physics here

mod arguments;
mod bench;
mod failure;
mod outputs;
mod plots;
mod recorder;
mod reports;
mod run;

use arguments::{Arguments, Command};
use clap::Parser;
use failure::Failure;
use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            let _ = error.print();
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    let command = arguments.command.unwrap_or_else(|| Command::Run(arguments::Run::default_scene()));
    let json = command.json();
    let outcome = match &command {
        Command::Run(run) => run::run(run),
        Command::Check(check) => reports::check(check),
        Command::List { json } => reports::list(*json),
        Command::New { name } => reports::new(name),
        Command::Reference { schema } => reports::reference(*schema),
        Command::Bench { what } => reports::bench(what),
    };
    match outcome {
        Ok(code) => ExitCode::from(code),
        Err(Failure::ClosedPipe) => ExitCode::SUCCESS,
        Err(failure) => {
            failure.print(json);
            ExitCode::from(failure.exit_code())
        }
    }
}
