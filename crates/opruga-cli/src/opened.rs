//! Scenes of commands that have no options for reading them.

use crate::failure::Failure;
use crate::language::translation;
use crate::run::simd_from_environment;
use crate::source::{Source, Whole, overrides};
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, Registries};

/// A scene of a command that has no options for reading it.
pub(crate) struct Opened {
    pub(crate) source: Source,
    pub(crate) reading: scene::Options,
    pub(crate) options: Options,
    pub(crate) blueprint: AnyBlueprint,
    /// The names of the files that the scene names.
    pub(crate) files: Vec<String>,
}

/// Finds and reads a scene with overrides, and reports its notices unless the call is silent.
pub(crate) fn open(
    scene: &str,
    registries: &Registries,
    set: &[String],
    allow_outside: bool,
    quiet: bool,
) -> Result<Opened, Failure> {
    let source = Source::find(scene, registries)?;
    let reading = scene::Options {
        overrides: overrides(set)?,
        files: source.files.clone().allow_outside(allow_outside),
        ..scene::Options::default()
    };
    let options = Options { simd: simd_from_environment()?, ..Options::default() };
    let Whole { blueprint, notices, files } = source.read(&reading, &options)?;
    if !quiet {
        notices.iter().for_each(|notice| eprintln!("{}", notice.text(translation())));
    }
    Ok(Opened { source, reading, options, blueprint, files: files.into_keys().collect() })
}
