//! The inputs and outputs of every command that writes files: no output may replace an input or another output.

use crate::failure::Failure;
use crate::source::Source;
use opruga::io::Files;
use opruga::io::outputs_apart::{Use, Uses};
use std::path::Path;

/// The scene and the files that it names, as inputs.
pub(crate) fn of_scene<'n>(source: &Source, files: &Files, names: impl Iterator<Item = &'n String>) -> Uses {
    let mut uses = Uses::default();
    // The scene of a checkpoint or of a recording is inside it.
    if let Some(path) = &source.path {
        uses.input(Use::Scene { path: path.display().to_string() }, path);
    }
    for name in names {
        if let Some(path) = files.path_of(name) {
            uses.input(Use::NamedByScene { name: name.clone() }, &path);
        }
    }
    uses
}

/// A file that the call itself names, as an input.
pub(crate) fn of_file(what: Use, path: &Path) -> Uses {
    let mut uses = Uses::default();
    uses.input(what, path);
    uses
}

/// Refuses a call if its outputs are not separate files.
pub(crate) fn apart(uses: &Uses) -> Result<(), Failure> {
    Ok(uses.check()?)
}

/// Whether `opruga run` writes a file of this name to its folder.
pub(crate) fn run_writes(name: &str) -> bool {
    const NAMES: [&str; 10] = [
        "diagnostics.csv",
        "final.csv",
        "summary.json",
        "strip.png",
        "plots.svg",
        "video.mp4",
        "video.gif",
        crate::checkpoints::NAME,
        crate::checkpoints::PREVIOUS,
        "trial.opruga-trial",
    ];
    NAMES.contains(&name)
}

/// Whether `opruga replay` writes a file of this name to its folder: `frame-000012.vtk`, a point cache for every body, …
pub(crate) fn replay_writes(name: &str) -> bool {
    let ends = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    run_writes(name)
        || name.starts_with("frame-") && ends(&[".vtk", ".vtu", ".obj", ".ply"])
        || ["frames.vtk.series", "frames.pvd", "run.glb"].contains(&name)
        || ends(&[".pc2", ".mdd"])
}

/// Whether `opruga sweep` writes a file of this name to its folder.
pub(crate) fn sweep_writes(name: &str) -> bool {
    ["results.csv", "question.json", "summary.json"].contains(&name)
        || name.starts_with("plots") && name.ends_with(".svg")
}

/// Whether `opruga modes` writes a file of this name to its folder.
pub(crate) fn modes_writes(name: &str) -> bool {
    ["modes.csv", "modes.json", "modes.png"].contains(&name)
}
