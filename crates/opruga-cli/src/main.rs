//! The program `opruga`: runs scenes, checks them, lists what is available, measures speed.
#![allow(clippy::disallowed_methods)] // no physics here

mod arguments;
mod bench;
mod checkpoints;
mod errors;
mod exports;
mod failure;
mod forecast;
mod interrupt;
mod language;
mod material;
mod mesh;
mod modes;
mod opened;
mod outputs;
mod plots;
mod preparation;
mod recorder;
mod recordings;
mod replay;
mod reports;
mod run;
mod source;
mod studio;
mod sweep;
mod uses;
mod verify;
mod watch;

use arguments::{Arguments, Command};
use clap::Parser;
use errors::CallFault;
use failure::Failure;
use opruga::Registries;
use std::process::ExitCode;

fn main() -> ExitCode {
    interrupt::outlive_the_limit_on_files();
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) if error.use_stderr() && std::env::args_os().any(|word| word == "--json") => {
            // A user who asks for JSON gets all errors as JSON, including those of the call.
            let text = error.to_string();
            let text = text.trim_start_matches("error: ").split("\n\n").next().unwrap_or_default().to_string();
            let failure = Failure::call(CallFault::Arguments { text });
            failure.print(true);
            return ExitCode::from(failure.exit_code());
        }
        Err(error) => {
            let _ = error.print();
            if let Some(scene) = scene_without_run(&error) {
                eprintln!("  = hint: opruga run {scene}");
            }
            return ExitCode::from(if error.use_stderr() { 2 } else { 0 });
        }
    };
    language::choose(arguments.language);
    let json = arguments.command.as_ref().is_some_and(Command::json);
    // Everything that a scene can name is created here and passed on.
    let registries = Registries::default();
    let outcome = match &arguments.command {
        None => studio::first(&registries),
        Some(command) => run_command(command, &registries),
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

/// Executes a command, with the models and integrators that its scenes can name.
fn run_command(command: &Command, registries: &Registries) -> Result<u8, Failure> {
    match command {
        Command::Run(run) => watch::run(run, registries),
        Command::Studio { scene } => studio::studio(scene.as_deref()),
        Command::View { recording } => studio::view(recording, registries),
        Command::Modes(call) => modes::modes(call, registries),
        Command::Mesh(call) => mesh::mesh(call),
        Command::Material(call) => material::material(call),
        Command::Check(check) => watch::check(check, registries),
        Command::Sweep(call) => sweep::sweep(call, registries),
        Command::Replay(replay) => replay::replay(replay, registries),
        Command::List { json } => reports::list(*json, registries),
        Command::New { name, force, .. } => reports::new(name, *force),
        Command::Reference { schema } => reports::reference(*schema, registries),
        Command::Bench { what } => reports::bench(what, registries),
        Command::Verify(call) => verify::verify(call, registries),
    }
}

/// The scene that the user wants to run, if `run` was omitted.
fn scene_without_run(error: &clap::Error) -> Option<String> {
    use clap::error::{ContextKind, ContextValue};
    match error.get(ContextKind::InvalidSubcommand) {
        Some(ContextValue::String(word)) if word.ends_with(".toml") || opruga::scenes::find(word).is_some() => {
            Some(opruga::io::problem::visible(word))
        }
        _ => None,
    }
}
