//! What can be said on the command line.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// Elastically deformable bodies: run a scene, look at what happened, measure it.
#[derive(Debug, Parser)]
#[command(name = "opruga", version, about, after_help = "Without a command, `opruga` runs the scene `ball`.")]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run a scene and write tables, pictures, a video and plots
    Run(Run),
    /// Read a scene and report all of its errors, without running it
    Check(Check),
    /// List models, integrators, shapes, colliders and the scenes that come with the program
    List {
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Write a commented scene NAME.toml to start from
    New {
        /// The name of the scene
        name: String,
    },
    /// Print the reference of the scene format (Markdown), made from what the models say of themselves
    Reference {
        /// Print the JSON Schema for editors instead
        #[arg(long)]
        schema: bool,
    },
    /// Measure speed
    Bench {
        #[command(subcommand)]
        what: Bench,
    },
}

#[derive(Debug, Subcommand)]
pub(crate) enum Bench {
    /// Rings of 8 to 1,048,576 vertices, and many of them: figure 4 of the thesis
    Vertices(BenchVertices),
}

#[derive(Args, Debug)]
pub(crate) struct BenchVertices {
    /// Threads
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: u16,
    /// Count the drawing of every frame too
    #[arg(long)]
    pub(crate) draw: bool,
    /// Print JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// The integrator
    #[arg(long, default_value = "symplectic_euler")]
    pub(crate) integrator: String,
    /// Only rows with this many vertices
    #[arg(long)]
    pub(crate) only: Option<usize>,
    /// Processor time spent on each row [s]
    #[arg(long, allow_negative_numbers = true, default_value_t = 1.0)]
    pub(crate) seconds: f64,
    /// Write the log–log plot to this SVG file
    #[arg(long)]
    pub(crate) plot: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Check {
    /// A scene file, or the name of a scene that comes with the program
    pub(crate) scene: String,
    /// Override a parameter: PATH=VALUE
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print an error as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// Warnings are errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Unknown fields are warnings
    #[arg(long)]
    pub(crate) lenient: bool,
    /// Shapes may be read from files outside of the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
}

#[derive(Args, Debug)]
pub(crate) struct Run {
    /// A scene file, or the name of a scene that comes with the program
    #[arg(default_value = "ball")]
    pub(crate) scene: String,
    /// How long to run, instead of what the scene says; 0 writes the state at the start [s]
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) seconds: Option<f64>,
    /// Frames of the animation for each second
    #[arg(long, allow_negative_numbers = true, default_value_t = 20.0)]
    pub(crate) fps: f64,
    /// The folder for the output [default: out/SCENE]
    #[arg(long)]
    pub(crate) out: Option<PathBuf>,
    /// Replace what is there
    #[arg(long)]
    pub(crate) force: bool,
    /// Threads
    #[arg(long, allow_negative_numbers = true, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=256))]
    pub(crate) threads: u16,
    /// Override a parameter: PATH=VALUE, such as time.substeps=64
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub(crate) set: Vec<String>,
    /// Print the summary, or an error, as JSON
    #[arg(long)]
    pub(crate) json: bool,
    /// No strip, video and plots
    #[arg(long)]
    pub(crate) no_pictures: bool,
    /// Write the animation as video.gif instead of video.mp4
    #[arg(long)]
    pub(crate) gif: bool,
    /// Go on from a checkpoint
    #[arg(long, value_name = "FILE")]
    pub(crate) resume: Option<PathBuf>,
    /// Run even if the step is above the stable limit
    #[arg(long)]
    pub(crate) allow_unstable: bool,
    /// Warnings are errors
    #[arg(long)]
    pub(crate) strict: bool,
    /// Unknown fields are warnings
    #[arg(long)]
    pub(crate) lenient: bool,
    /// Shapes may be read from files outside of the folder of the scene
    #[arg(long)]
    pub(crate) allow_outside: bool,
    /// Draw forces of the pressure and of the pointer
    #[arg(long)]
    pub(crate) arrows: bool,
}

impl Run {
    /// What `opruga` without a command does.
    pub(crate) fn default_scene() -> Run {
        match Arguments::parse_from(["opruga", "run"]).command {
            Some(Command::Run(run)) => run,
            _ => unreachable!("the command is `run`"),
        }
    }
}

impl Command {
    /// Whether errors are wanted as JSON.
    pub(crate) fn json(&self) -> bool {
        match self {
            Command::Run(run) => run.json,
            Command::Check(check) => check.json,
            Command::List { json } => *json,
            Command::Bench { what: Bench::Vertices(bench) } => bench.json,
            Command::New { .. } | Command::Reference { .. } => false,
        }
    }
}
