//! Writes a recording frame by frame (`opruga run --record`), and opens recordings.

use crate::checkpoints::Calling;
use crate::errors::CallError;
use crate::failure::Failure;
use crate::source::Source;
use opruga::io::recording::{Asset, Header, Recording, RecordingError};
use opruga::io::safe_write::WriteError;
use opruga::io::{Files, SceneError};
use opruga::recordings::{Tape, states_apart};
use opruga::{AnyWorld, Registries};
use std::fs::File;
use std::path::Path;

/// The name of this program in recordings.
pub(crate) const PROGRAM: &str = concat!("opruga ", env!("CARGO_PKG_VERSION"));

/// Begins the recording of a run. The file exists, with its header and its first frame, before the run begins.
pub(crate) fn begin(
    path: &Path,
    force: bool,
    every: Option<u32>,
    source: &Source,
    calling: &Calling,
    world: &mut dyn AnyWorld,
) -> Result<Tape, WriteError> {
    let header = Header {
        program: PROGRAM.into(),
        name: source.name.clone(),
        file: source.file.clone(),
        scene: source.bytes.clone(),
        frame: world.scene().time().frame,
        every: every.map_or_else(|| states_apart(world), u64::from),
        overrides: calling.overrides.clone(),
        lenient: calling.lenient,
        allow_unstable: calling.allow_unstable,
        assets: calling.files.iter().map(|(name, bytes)| Asset { name: name.clone(), bytes: bytes.to_vec() }).collect(),
    };
    Tape::begin(path, force, &header, world)
}

/// Opens a recording for reading. The recording contains its scene.
pub(crate) fn open(path: &Path, registries: &Registries) -> Result<(Recording<File>, Source), Failure> {
    let refuse = |error: SceneError| Failure::Run(Box::new(SceneError { file: path.display().to_string(), ..error }));
    let about = std::fs::metadata(path).and_then(|about| Ok((about, File::open(path)?)));
    let (about, file) = about.map_err(|e| refuse(SceneError::from(&RecordingError::from(e))))?;
    if !about.is_file() {
        return Err(refuse(SceneError::of(CallError::NotARegularFile {})));
    }
    let recording = Recording::open(file).map_err(|error| refuse(SceneError::from(&error)))?;
    let header = recording.header();
    let file = format!("scene {} (in {})", header.name, path.display());
    let assets = header.assets.iter().map(|asset| (asset.name.clone(), asset.bytes.as_slice().into()));
    let (name, bytes, files) = (header.name.clone(), header.scene.clone(), Files::in_memory(assets));
    let source = Source { name, file, path: None, bytes, files, registries: registries.clone() };
    Ok((recording, source))
}
