//! `opruga run`: scene → world → frames → files.

use crate::arguments::Run;
use crate::failure::{Failure, print_data};
use crate::outputs::{Outputs, Recorder};
use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::Files;
use opruga::io::checkpoint::Checkpoint;
use opruga::io::safe_write::{Existing, OutputFolder};
use opruga::io::scene;
use opruga::{Options, Simd, World};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A scene's text and where it came from.
pub(crate) struct Source {
    pub(crate) name: String,
    pub(crate) file: String,
    pub(crate) text: String,
    /// Where the files are that it names.
    pub(crate) files: Files,
}

/// Finds a scene: a file, or one that comes with the program.
pub(crate) fn find_scene(name: &str) -> Result<Source, Failure> {
    let path = Path::new(name);
    if path.is_file() || name.contains(['/', '\\']) || name.ends_with(".toml") || path.exists() {
        let bytes = scene::bytes_of(path, &scene::Limits::default())
            .map_err(|e| Failure::Scene(vec![opruga::io::SceneError { file: path.display().to_string(), ..e }]))?;
        let stem = path.file_stem().map_or("scene".into(), |s| s.to_string_lossy().into_owned());
        // Bytes that are no UTF-8 are refused by the reader, with their place.
        return Ok(Source {
            name: stem,
            file: path.display().to_string(),
            text: String::from_utf8_lossy(&bytes).into_owned(),
            files: Files::beside(path),
        });
    }
    match opruga::scenes::find(name) {
        Some(text) => Ok(Source {
            name: name.into(),
            file: format!("{name}.toml"),
            text: text.into(),
            files: opruga::scenes::files(),
        }),
        None => {
            let hint =
                opruga::core::spec::nearest(name, opruga::scenes::names()).map(|n| format!("did you mean `{n}`?"));
            Err(Failure::Scene(vec![opruga::io::SceneError {
                file: name.to_string(),
                hint: hint.or(Some("`opruga list` shows the scenes that come with the program".into())),
                ..opruga::io::SceneError::new(
                    "read.failed",
                    "there is no such file, and no such scene comes with the program",
                )
            }]))
        }
    }
}

/// Splits `PATH=VALUE`.
pub(crate) fn overrides(set: &[String]) -> Result<Vec<(String, String)>, Failure> {
    let split = |s: &String| {
        s.split_once('=').map(|(p, v)| (p.trim().to_string(), v.trim().to_string())).ok_or_else(|| Failure::Call {
            message: format!("--set {s}: there is no `=`"),
            hint: Some("--set PATH=VALUE, such as --set time.substeps=64".into()),
        })
    };
    set.iter().map(split).collect()
}

/// Runs a scene.
pub(crate) fn run(call: &Run) -> Result<u8, Failure> {
    if call.seconds.is_some_and(|s| !(0.0..=1e9).contains(&s)) {
        return Err(Failure::call("--seconds: allowed are 0 to 1e9"));
    }
    if !(call.fps > 0.0 && call.fps <= 240.0) {
        return Err(Failure::call("--fps: allowed are numbers above 0 up to 240"));
    }
    let simd = simd_from_environment()?;
    let mut set = overrides(&call.set)?;
    let mut resumed = None;
    let source = match &call.resume {
        None => find_scene(&call.scene)?,
        Some(path) => {
            let file = path.display().to_string();
            let bytes = scene::bytes_of(path, &scene::Limits { file_bytes: 1 << 40, ..scene::Limits::default() })
                .map_err(|e| Failure::Scene(vec![opruga::io::SceneError { file: file.clone(), ..e }]))?;
            let refuse = |error| Failure::Checkpoint { error, file: file.clone() };
            let checkpoint = Checkpoint::read(&bytes).map_err(refuse)?;
            let saved = crate::outputs::SavedRun::read(&checkpoint.payload).ok_or_else(|| {
                Failure::call(format!("{file}: this checkpoint belongs to another version of the program"))
            })?;
            set.splice(0..0, saved.overrides.clone());
            let name = saved.name.clone();
            let files = Files::held(saved.files.clone());
            resumed = Some(saved);
            Source { file: format!("{name}.toml"), name, text: checkpoint.scene, files }
        }
    };
    let options = scene::Options {
        lenient: call.lenient,
        strict: call.strict,
        overrides: set.clone(),
        files: source.files.clone().allow_outside(call.allow_outside),
        ..scene::Options::default()
    };
    let reading = scene::read_whole(source.text.as_bytes(), &source.file, &opruga::catalogue(), &options)?;
    for notice in &reading.notices {
        eprintln!("{notice}");
    }
    let folder = match &call.out {
        Some(path) => path.clone(),
        None => {
            let parent = PathBuf::from("out");
            if !parent.exists() {
                let failed = |e: std::io::Error| Failure::Output(format!("the folder `out` cannot be made: {e}"));
                std::fs::create_dir(&parent).map_err(failed)?;
            }
            parent.join(&source.name)
        }
    };
    // A resumed run writes its own part only: it must not replace the part before it unasked.
    let existing = if call.force { Existing::Replace } else { Existing::Refuse };
    let folder = OutputFolder::open(&folder, existing)?;
    let world_options =
        Options { threads: call.threads.into(), simd, allow_unstable: call.allow_unstable, batches: true };
    let job = Job { call, source: &source, files: &reading.files, set: &set, folder, world_options, resumed };
    match reading.blueprint {
        AnyBlueprint::Plane(blueprint) => job.run(blueprint),
        AnyBlueprint::Space(blueprint) => job.run(blueprint),
    }
}

/// The vector instructions that `OPRUGA_SIMD` asks for.
pub(crate) fn simd_from_environment() -> Result<Option<Simd>, Failure> {
    match std::env::var("OPRUGA_SIMD") {
        Err(_) => Ok(None),
        Ok(name) => match Simd::named(&name) {
            Some(simd) => Ok(Some(simd)),
            None => Err(Failure::call(format!("OPRUGA_SIMD={name}: allowed are scalar, avx2, avx512"))),
        },
    }
}

struct Job<'a> {
    call: &'a Run,
    source: &'a Source,
    files: &'a BTreeMap<String, Arc<[u8]>>,
    set: &'a [(String, String)],
    folder: OutputFolder,
    world_options: Options,
    resumed: Option<crate::outputs::SavedRun>,
}

impl Job<'_> {
    fn run<const D: usize>(self, mut blueprint: Blueprint<D>) -> Result<u8, Failure> {
        if let Some(seconds) = self.call.seconds {
            blueprint.time.seconds = seconds;
        }
        blueprint.name.clone_from(&self.source.name);
        let seconds = blueprint.time.seconds;
        let frame = blueprint.time.frame;
        let file = self.source.file.clone();
        let world_error = |error| Failure::World { error, file: file.clone() };
        let mut world = World::new(blueprint, self.world_options.clone()).map_err(world_error)?;
        if let Some(saved) = &self.resumed {
            world.restore(&saved.snapshot).map_err(world_error)?;
        }
        let stop = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stop);
        // A second handler in the same process (tests) is no error: the first one stays.
        let _ = ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed));
        let frames = (seconds / frame - 1e-9).ceil().max(0.0) as u64;
        let bar = progress_bar(frames);
        let mut recorder = Recorder::new(&mut world, self.call, frames);
        let start = Instant::now();
        let first = world.frames();
        let mut failure = None;
        recorder.record(&mut world);
        while world.frames() < frames {
            if stop.load(Ordering::Relaxed) {
                failure = Some(Failure::Interrupted);
                break;
            }
            if let Err(error) = world.frame() {
                failure = Some(world_error(error));
                break;
            }
            recorder.record(&mut world);
            bar.set_position(world.frames());
            let wall = start.elapsed().as_secs_f64();
            if wall > 0.0 {
                let ratio = (world.frames() - first) as f64 * frame / wall;
                bar.set_message(format!("t = {:.2} s, {ratio:.1} × real time", world.time()));
            }
        }
        let wall = start.elapsed().as_secs_f64();
        bar.finish_and_clear();
        let outputs = Outputs {
            folder: &self.folder,
            source: self.source,
            files: self.files,
            set: self.set,
            wall,
            steps: (world.frames() - first) * u64::from(world.blueprint().time.substeps),
            stop: &stop,
        };
        // What was computed until a failure is written all the same: it shows how the failure came about.
        let summary = outputs.write(&mut world, recorder)?;
        if let Some(failure) = failure {
            return Err(failure);
        }
        if self.call.json {
            print_data(&format!("{summary}\n"))?;
        } else {
            outputs.talk(&world);
        }
        Ok(0)
    }
}

fn progress_bar(frames: u64) -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {msg}, {eta} left");
    indicatif::ProgressBar::new(frames).with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}
