//! Checkpoints of a run: their contents, when they are written, and which earlier checkpoint replaces a damaged one.

use crate::errors::{CallError, CallWarning, ResumeHint};
use crate::failure::Failure;
use crate::source::{Source, argument};
use opruga::io::checkpoint::{Checkpoint, CheckpointError};
use opruga::io::output_folder::OutputFolder;
use opruga::io::problem::Around;
use opruga::io::safe_write::WriteError;
use opruga::io::scene;
use opruga::io::tables::NumberTable;
use opruga::io::{Files, SceneError};
use opruga::math::message::AnyMessage;
use opruga::{AnyWorld, Registries, Warning};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The file of the newest checkpoint of a run.
pub(crate) const NAME: &str = "checkpoint";
/// The file of the previous checkpoint.
pub(crate) const PREVIOUS: &str = "checkpoint.previous";

/// The table of a run.
const TABLE: &str = "diagnostics.csv";
/// The files that a run writes at its end.
const LAST: [&str; 6] = ["summary.json", "final.csv", "strip.png", "plots.svg", "video.mp4", "video.gif"];

/// The format of the payload. Another format belongs to another version of the program.
const FORM: &str = "run 3";

/// The arguments of a run on which its continuation depends.
#[derive(Clone, Default)]
pub(crate) struct Calling {
    /// The changes of the scene by `--set` and `--seconds`.
    pub(crate) overrides: Vec<(String, String)>,
    /// Whether unknown fields are warnings.
    pub(crate) lenient: bool,
    /// Whether a step above the stable limit is a warning.
    pub(crate) allow_unstable: bool,
    /// The files that the scene names.
    pub(crate) files: BTreeMap<String, Arc<[u8]>>,
}

/// The payload of a checkpoint: the snapshot and the arguments of the run.
pub(crate) struct SavedRun {
    pub(crate) name: String,
    pub(crate) calling: Calling,
    /// The number of frames since the start.
    pub(crate) frames: u64,
    /// Simulated time [s].
    pub(crate) time: f64,
    pub(crate) snapshot: Vec<u8>,
}

impl SavedRun {
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut part = |bytes: &[u8]| {
            out.extend((bytes.len() as u64).to_le_bytes());
            out.extend(bytes);
        };
        part(FORM.as_bytes());
        part(self.name.as_bytes());
        let Calling { overrides, lenient, allow_unstable, files } = &self.calling;
        part(overrides.len().to_string().as_bytes());
        for (path, value) in overrides {
            part(path.as_bytes());
            part(value.as_bytes());
        }
        part(files.len().to_string().as_bytes());
        for (name, bytes) in files {
            part(name.as_bytes());
            part(bytes);
        }
        out.extend([u8::from(*lenient), u8::from(*allow_unstable)]);
        out.extend(self.frames.to_le_bytes());
        out.extend(self.time.to_le_bytes());
        out.extend(&self.snapshot);
        out
    }

    /// Reads a payload. Returns `None` if the payload has another format.
    fn read(mut bytes: &[u8]) -> Option<SavedRun> {
        let mut part = || {
            let (length, rest) = bytes.split_first_chunk::<8>()?;
            let (part, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            bytes = rest;
            Some(part)
        };
        let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
        if part()? != FORM.as_bytes() {
            return None;
        }
        let name = text(part()?)?;
        let count: usize = text(part()?)?.parse().ok()?;
        let mut overrides = Vec::new();
        for _ in 0..count {
            overrides.push((text(part()?)?, text(part()?)?));
        }
        let count: usize = text(part()?)?.parse().ok()?;
        let mut files = BTreeMap::new();
        for _ in 0..count {
            files.insert(text(part()?)?, Arc::from(part()?));
        }
        let ([lenient, allow_unstable], bytes) = bytes.split_first_chunk::<2>()?;
        let calling = Calling { overrides, lenient: *lenient == 1, allow_unstable: *allow_unstable == 1, files };
        let (frames, bytes) = bytes.split_first_chunk::<8>()?;
        let (time, snapshot) = bytes.split_first_chunk::<8>()?;
        let (frames, time) = (u64::from_le_bytes(*frames), f64::from_le_bytes(*time));
        Some(SavedRun { name, calling, frames, time, snapshot: snapshot.to_vec() })
    }
}

/// Reads a checkpoint: the progress of the run, and its scene.
///
/// If the checkpoint is damaged or missing, the error names the previous checkpoint, provided that the latter is intact.
pub(crate) fn open(path: &Path, registries: &Registries) -> Result<(SavedRun, Source), Failure> {
    let error = match read(path, registries) {
        Ok(whole) => return Ok(whole),
        Err(error) => SceneError { file: path.display().to_string(), ..*error },
    };
    let (inside, older) = (path.join(NAME), previous(path));
    let error = if inside.is_file() {
        error.advice(Around::Nearest { word: inside.display().to_string() })
    } else if let Ok((run, _)) = read(&older, registries) {
        error.advice(ResumeHint::CheckpointBefore { time: run.time, file: argument(&older.display().to_string()) })
    } else if error.code == "read.failed" {
        error.advice(ResumeHint::InOutput {})
    } else {
        error.advice(ResumeHint::NoneBeside {})
    };
    Err(Failure::Run(Box::new(error)))
}

fn previous(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".previous");
    PathBuf::from(name)
}

fn read(path: &Path, registries: &Registries) -> Result<(SavedRun, Source), Box<SceneError>> {
    let limits = scene::Limits { file_bytes: 1 << 40, ..scene::Limits::default() };
    let bytes = scene::bytes_of(path, &limits)?;
    let checkpoint = Checkpoint::read(&bytes).map_err(|e: CheckpointError| SceneError::from(&e))?;
    let run = SavedRun::read(&checkpoint.payload).ok_or_else(|| SceneError::of(CallError::OtherVersion {}))?;
    let file = format!("scene {} (in {})", run.name, path.display());
    let files = Files::in_memory(run.calling.files.clone());
    let (name, bytes, registries) = (run.name.clone(), checkpoint.scene.into_bytes(), registries.clone());
    let source = Source { name, file, path: None, bytes, files, registries };
    Ok((run, source))
}

/// What happens to an existing checkpoint when a run writes its first one.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Older {
    /// The checkpoint belongs to this run: it is kept as the previous one.
    Keep,
    /// The checkpoint belongs to this run, but the run was resumed from the previous checkpoint, which therefore stays.
    Leave,
    /// The checkpoint belongs to another run: this checkpoint and the previous one are removed.
    Remove,
}

/// Writes the checkpoints of a run.
pub(crate) struct Keeper<'a> {
    folder: &'a OutputFolder,
    source: &'a Source,
    calling: Calling,
    /// The time between checkpoints, or `None` if the only checkpoint is written at the end.
    every: Option<Duration>,
    next: Option<Instant>,
    older: Older,
    /// Whether this run has written a checkpoint.
    begun: bool,
    /// The number of intermediate checkpoints that could not be written, and the reason why the last of them could not be written.
    failed: Option<(u64, AnyMessage)>,
}

impl<'a> Keeper<'a> {
    /// Makes a keeper that writes a checkpoint after each such interval of wall-clock time [s]. If the interval is 0, it writes only one, at the end.
    pub(crate) fn new(
        folder: &'a OutputFolder,
        source: &'a Source,
        calling: Calling,
        seconds: f64,
        resumed: Option<&Path>,
    ) -> Keeper<'a> {
        let is = |name: &str| {
            let real = |path: &Path| path.canonicalize().ok();
            resumed.and_then(real).is_some_and(|path| Some(path) == real(&folder.path(name)))
        };
        let older = if is(NAME) {
            Older::Keep
        } else if is(PREVIOUS) {
            Older::Leave
        } else {
            Older::Remove
        };
        let every = (seconds > 0.0).then(|| Duration::from_secs_f64(seconds));
        let next = every.map(|every| Instant::now() + every);
        Keeper { folder, source, calling, every, next, older, begun: false, failed: None }
    }

    /// Writes the header of the table and its first row, so that the folder shows the columns even if the run has just begun or was killed before its
    /// first checkpoint. The table of an earlier run stays as long as its checkpoint does.
    pub(crate) fn begin(&self, table: &NumberTable) -> Result<(), WriteError> {
        match self.folder.path(TABLE).exists() {
            true => Ok(()),
            false => self.folder.write(TABLE, false, |out| table.write(out)).map(|_| ()),
        }
    }

    /// Writes the table so far and a checkpoint if one is due. A failure is reported and counted but does not end the run, because the next
    /// checkpoint may succeed.
    pub(crate) fn write_if_due(&mut self, world: &dyn AnyWorld, table: &NumberTable) -> Option<Warning> {
        let start = self.next.filter(|next| Instant::now() >= *next).map(|_| Instant::now())?;
        let written = self.write(world, table);
        let took = start.elapsed();
        // Even for large worlds on slow disks, at least half of the time is spent on the run.
        self.next = self.every.map(|every| Instant::now() + every.max(took));
        let error = written.err()?;
        let count = self.failed.as_ref().map_or(0, |f| f.0) + 1;
        self.failed = Some((count, error.about.clone()));
        let path = error.path.display().to_string();
        Some(Warning::new(CallWarning::NoCheckpoint { time: world.time(), path, cause: error.about }, 1))
    }

    /// Writes the table so far and a checkpoint. The previous checkpoint is kept under its second name. Returns the names of the files that then
    /// exist. At the first call, the files of an earlier run are removed, because they would look like files of this run. If the call fails, no file
    /// is changed.
    pub(crate) fn write(&mut self, world: &dyn AnyWorld, table: &NumberTable) -> Result<Vec<String>, WriteError> {
        let saved = SavedRun {
            name: self.source.name.clone(),
            calling: self.calling.clone(),
            frames: world.frames(),
            time: world.time(),
            snapshot: world.snapshot(),
        };
        let checkpoint = Checkpoint { scene: self.source.text().into(), payload: saved.to_bytes() };
        let folder = self.folder;
        let previous = match self.older {
            Older::Keep => folder.path(NAME).exists(),
            Older::Leave => true,
            Older::Remove => false,
        };
        let mut together = folder.together();
        together.write(TABLE, |out| table.write(out))?;
        match self.older {
            Older::Keep => together.write_keeping(NAME, PREVIOUS, |out| checkpoint.write(out))?,
            Older::Leave | Older::Remove => together.write(NAME, |out| checkpoint.write(out))?,
        }
        if self.older == Older::Remove {
            together.remove(PREVIOUS);
        }
        if !self.begun {
            LAST.iter().for_each(|name| together.remove(name));
        }
        together.finish()?;
        self.begun = true;
        self.older = Older::Keep;
        let names = [TABLE, NAME].into_iter().chain(previous.then_some(PREVIOUS));
        Ok(names.map(String::from).collect())
    }

    /// The failures so far, for the summary.
    pub(crate) fn warning(&self) -> Option<Warning> {
        let (count, cause) = self.failed.clone()?;
        Some(Warning::new(CallWarning::CheckpointFailed { cause }, count))
    }
}
