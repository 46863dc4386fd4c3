//! `opruga run`: scene → world → frames → files.

use crate::arguments::Run;
use crate::checkpoints::{self, Calling, Keeper, SavedRun};
use crate::errors::{CallFault, CallNote, CallRange, CallWarning, CheckFault};
use crate::failure::{Failure, print_data, print_note, print_warning};
use crate::forecast::{Forecast, duration};
use crate::interrupt;
use crate::language::translation;
use crate::outputs::{Outputs, print_late_warnings};
use crate::preparation::watched;
use crate::recorder::Recorder;
use crate::recordings;
use crate::source::{Source, Whole, overrides};
use crate::uses;
use opruga::blueprint::AnyBlueprint;
use opruga::io::output_folder::{Existing, OutputFolder};
use opruga::io::outputs_apart::Use;
use opruga::io::safe_write::WriteError;
use opruga::io::scene;
use opruga::math::words::rounded;
use opruga::recordings::TapeHint;
use opruga::world::error::Crossing;
use opruga::{AnyWorld, Options, Registries, Simd, Warning};
use std::collections::BTreeMap;
use std::io::IsTerminal as _;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Runs a scene.
pub(crate) fn run(call: &Run, registries: &Registries) -> Result<u8, Failure> {
    if let Some(seconds) = call.seconds.filter(|s| !(0.0..=1e9).contains(s)) {
        return Err(Failure::range("--seconds", seconds, CallRange::Between { least: 0.0, most: 1e9 }));
    }
    if let Some(fps) = call.pictures.fps.filter(|fps| !(*fps > 0.0 && *fps <= 240.0)) {
        return Err(Failure::range("--fps", fps, CallRange::PositiveUpTo { most: 240.0 }));
    }
    if !(0.0..=1e9).contains(&call.checkpoint_every) {
        return Err(Failure::range(
            "--checkpoint-every",
            call.checkpoint_every,
            CallRange::Between { least: 0.0, most: 1e9 },
        ));
    }
    let simd = simd_from_environment()?;
    let mut set = overrides(&call.set)?;
    if let Some(seconds) = call.seconds {
        // A checkpoint stores the requested end of the run together with everything else that was set.
        set.push(("time.seconds".into(), seconds.to_string()));
    }
    let (source, resumed) = match &call.resume {
        None => (Source::find(call.scene.as_deref().unwrap_or("ball"), registries)?, None),
        Some(path) => {
            let (saved, source) = checkpoints::open(path, registries)?;
            set.splice(0..0, saved.calling.overrides.clone());
            (source, Some(saved))
        }
    };
    let calling = |of: fn(&Calling) -> bool| resumed.as_ref().is_some_and(|saved| of(&saved.calling));
    let lenient = call.lenient || calling(|saved| saved.lenient) && !call.strict;
    let allow_unstable = call.allow_unstable || calling(|saved| saved.allow_unstable);
    let reading = scene::Options {
        lenient,
        strict: call.strict,
        overrides: set.clone(),
        files: source.files.clone().allow_outside(call.allow_outside),
        ..scene::Options::default()
    };
    let most_bytes = Some(reading.limits.memory_bytes);
    let world = Options { threads: call.threads.into(), simd, allow_unstable, most_bytes, ..Options::default() };
    let Whole { blueprint, notices, files } = source.read(&reading, &world)?;
    outputs_apart(call, &source, &reading, &files.keys().collect::<Vec<_>>())?;
    if !call.json {
        notices.iter().for_each(|notice| eprintln!("{}", notice.text(translation())));
    }
    let cores = std::thread::available_parallelism().map_or(usize::MAX, usize::from);
    let above = (world.threads > cores).then_some(CallWarning::AboveCores { threads: world.threads, cores });
    let of_call: Vec<Warning> = other_simd().into_iter().chain(above).map(|about| Warning::new(about, 1)).collect();
    if !call.json {
        of_call.iter().for_each(print_warning);
    }
    let reported = notices.into_iter().map(Warning::from).chain(of_call).collect();
    let job = Job { call, source: &source, reading, files, world, reported, resumed };
    job.run(blueprint)
}

/// The interval of progress lines if there is no terminal for a bar [s].
const TALK_EVERY: f64 = 10.0;

/// The folder for the output of a call that does not name one: the result of [`default_folder`], or the first of `name-2`, `name-3`, … that is still
/// empty.
pub(crate) fn fresh_folder(name: &str) -> PathBuf {
    let first = default_folder(name);
    let used = |path: &PathBuf| path.exists() && !std::fs::read_dir(path).is_ok_and(|mut files| files.next().is_none());
    let next = (2..).map(|number| first.with_file_name(format!("{name}-{number}")));
    std::iter::once(first.clone()).chain(next).find(|path| !used(path)).unwrap_or(first)
}

/// The default folder for output.
pub(crate) fn default_folder(name: &str) -> PathBuf {
    PathBuf::from("out").join(name)
}

/// The folder for the output.
fn folder_of(call: &Run, source: &Source) -> PathBuf {
    call.out.clone().unwrap_or_else(|| default_folder(&source.name))
}

/// Refuses a call if one of its outputs would replace an input or another output.
fn outputs_apart(call: &Run, source: &Source, reading: &scene::Options, files: &[&String]) -> Result<(), Failure> {
    let folder = folder_of(call, source);
    let mut uses = uses::of_scene(source, &reading.files, files.iter().copied());
    uses.folder(&folder, uses::run_writes);
    call.record.iter().for_each(|path| uses.output("--record", path));
    uses::apart(&uses)?;
    let Some(checkpoint) = &call.resume else { return Ok(()) };
    // A run may be resumed in its own folder, where its checkpoints follow one another.
    let own = [checkpoints::NAME, checkpoints::PREVIOUS].map(|name| folder.join(name).canonicalize().ok());
    let own = checkpoint.canonicalize().is_ok_and(|path| own.contains(&Some(path)));
    let mut uses = uses::of_file(Use::Checkpoint {}, checkpoint);
    uses.folder(&folder, move |name| {
        uses::run_writes(name) && !(own && [checkpoints::NAME, checkpoints::PREVIOUS].contains(&name))
    });
    call.record.iter().for_each(|path| uses.output("--record", path));
    uses::apart(&uses)
}

/// Opens the folder for the output, locked and known to be writable.
fn output_folder(call: &Run, source: &Source) -> Result<OutputFolder, Failure> {
    let folder = folder_of(call, source);
    // A resumed run writes only its own part, and must not replace the previous part unless this is requested.
    let existing = if call.force { Existing::Replace } else { Existing::Refuse };
    Ok(OutputFolder::open(&folder, existing)?)
}

/// The vector instructions requested by `OPRUGA_SIMD`.
pub(crate) fn simd_from_environment() -> Result<Option<Simd>, Failure> {
    match std::env::var("OPRUGA_SIMD") {
        Err(_) => Ok(None),
        Ok(name) => match Simd::named(&name) {
            Some(simd) => Ok(Some(simd)),
            None => Err(Failure::call(CallFault::NoInstructions { name: opruga::io::problem::visible(&name) })),
        },
    }
}

/// The warning that the kernels use other vector instructions than `OPRUGA_SIMD` names.
fn other_simd() -> Option<CallWarning> {
    let asked = std::env::var("OPRUGA_SIMD").ok()?;
    let used = Simd::named(&asked)?.name();
    match asked.as_str() {
        same if same == used => None,
        "scalar" => Some(CallWarning::NeverScalar { used }),
        _ => Some(CallWarning::InstructionsLacking { asked, used }),
    }
}

/// The note that a run ends at another time than requested, because frames are complete.
pub(crate) fn whole_frames(frames: u64, frame: f64, seconds: f64) -> Option<CallNote> {
    let reached = frames as f64 * frame;
    // Differences due to rounding do not count.
    let apart = (reached - seconds).abs() > 1e-6 * frame;
    apart.then_some(CallNote::WholeFrames { reached, asked: seconds, frames, frame })
}

struct Job<'a> {
    call: &'a Run,
    source: &'a Source,
    reading: scene::Options,
    /// The files that the scene names.
    files: BTreeMap<String, Arc<[u8]>>,
    world: Options,
    /// Warnings so far.
    reported: Vec<Warning>,
    resumed: Option<SavedRun>,
}

impl Job<'_> {
    fn run(self, mut blueprint: AnyBlueprint) -> Result<u8, Failure> {
        let (call, source) = (self.call, self.source);
        blueprint.rename(&source.name);
        let time = blueprint.scene().time();
        let (seconds, frame, frames) = (time.seconds, time.frame, time.frames());
        if let Some(saved) = self.resumed.as_ref().filter(|saved| saved.frames >= frames) {
            return Err(at_the_end(saved, seconds));
        }
        let mut world = source.build(blueprint, &self.reading, &self.world)?;
        if let Some(saved) = &self.resumed {
            world.restore(&saved.snapshot).map_err(|error| source.run_error(&error, saved.time))?;
        }
        let mut recorder = Recorder::new(&mut *world, call.wanted(), frames)?;
        // From now on, even before the first file is written, a signal ends the run with complete files.
        let stop = interrupt::asked_to_stop();
        let folder = output_folder(call, source)?;
        let calling = Calling {
            overrides: self.reading.overrides.clone(),
            lenient: self.reading.lenient,
            allow_unstable: self.world.allow_unstable,
            files: self.files,
        };
        let recorded = call.record.as_deref();
        let every = call.record_every;
        let tape = recorded.map(|path| recordings::begin(path, call.force, every, source, &calling, &mut *world));
        let mut tape = tape.transpose()?;
        let mut keeper = Keeper::new(&folder, source, calling, call.checkpoint_every, call.resume.as_deref());
        // Warnings known from the start are reported before the run, the others after it.
        let early = world.warnings();
        if !call.json {
            early.iter().for_each(print_warning);
            whole_frames(frames, frame, seconds).iter().for_each(print_note);
            recorder.thinned().iter().for_each(print_warning);
        }
        let first = world.frames();
        let mut progress = Progress::new(frames, first, call.json);
        let (mut failure, mut looked_at) = (None, false);
        // The time for collecting data is not part of the time of the steps.
        let mut looking = recorder.record(&mut *world);
        keeper.begin(&recorder.table)?;
        if call.check_contact {
            failure = crossed(&*world);
        }
        // A request to stop ends a long frame too; the world is then at its last good frame.
        watched(&self.world.break_off, || {
            while failure.is_none() && world.frames() < frames {
                if stop.load(Ordering::Relaxed) {
                    failure = Some(Failure::Interrupted);
                    break;
                }
                if let Err(error) = world.frame() {
                    failure = Some(source.frame_error(&error, &*world, &self.reading));
                    break;
                }
                looked_at = looked_at || world.look_at_steps_again();
                world.warn_of_missing_contact();
                if call.check_contact {
                    failure = crossed(&*world);
                }
                let untaped = tape.as_mut().and_then(|tape| tape.push(&mut *world).err()).map(unrecorded);
                if failure.is_none() {
                    failure = untaped;
                }
                looking += recorder.record(&mut *world);
                if let Some(failed) = keeper.write_if_due(&*world, &recorder.table) {
                    progress.bar.suspend(|| print_warning(&failed));
                }
                progress.after_frame(&*world, frame);
            }
        });
        recorder.finish(&mut *world);
        let taped = tape.and_then(|tape| tape.finish(&mut *world).err()).map(unrecorded);
        failure = failure.or(taped);
        let wall = (progress.start.elapsed() - looking).as_secs_f64();
        progress.bar.finish_and_clear();
        let outputs = Outputs {
            folder: &folder,
            source,
            wall,
            steps: (world.frames() - first) * u64::from(time.substeps),
            resumed_at: self.resumed.as_ref().map(|saved| saved.time),
            reported: self.reported.into_iter().chain(keeper.warning()).chain(recorder.thinned()).collect(),
            stop,
            stress: call.stress,
        };
        // The results up to a failure are written too, because they show how the failure came about.
        let summary = outputs.write(&*world, recorder, &mut keeper)?;
        if let Some(failure) = failure {
            // Warnings often say why a run failed.
            if !call.json {
                print_late_warnings(&*world, &early);
                outputs.print_paths();
            }
            return Err(failure);
        }
        if call.json {
            print_data(&format!("{summary}\n"))?;
        } else {
            outputs.talk(&*world, &early);
        }
        Ok(0)
    }
}

/// The progress of a run on the terminal.
struct Progress {
    bar: indicatif::ProgressBar,
    forecast: Forecast,
    start: Instant,
    /// The frames at the beginning and at the end of this part of the run.
    first: u64,
    frames: u64,
    quiet: bool,
    /// The time, from the start, at which the last line was written [s].
    last_line: f64,
}

impl Progress {
    fn new(frames: u64, first: u64, quiet: bool) -> Progress {
        let (bar, forecast, start) = (progress_bar(frames), Forecast::default(), Instant::now());
        Progress { bar, forecast, start, first, frames, quiet, last_line: 0.0 }
    }

    /// Shows the progress of the run: on the bar, or in occasional lines if there is no bar.
    fn after_frame(&mut self, world: &dyn AnyWorld, frame: f64) {
        self.bar.set_position(world.frames());
        let wall = self.start.elapsed().as_secs_f64();
        if wall <= 0.0 {
            return;
        }
        let (done, left) = (world.frames() - self.first, self.frames - world.frames());
        let ratio = rounded(done as f64 * frame / wall, 2);
        self.bar.set_message(format!("t = {:.2} s, {ratio} × real time", world.time()));
        if self.quiet {
            return;
        }
        if let Some(forecast) = self.forecast.of(world, done, left, wall) {
            self.bar.suspend(|| print_note(&forecast));
            self.last_line = wall;
        }
        if self.bar.is_hidden() && wall - self.last_line >= TALK_EVERY {
            self.last_line = wall;
            eprintln!(
                "{}/{} frames, t = {:.2} s, {ratio} × real time, {} left",
                world.frames(),
                self.frames,
                world.time(),
                duration(wall * left as f64 / done.max(1) as f64)
            );
        }
    }
}

/// The failure if the recording cannot continue. The run ends, and its state is kept so that the run can be resumed elsewhere.
fn unrecorded(error: WriteError) -> Failure {
    Failure::Write(error.advice(TapeHint::RunEnded))
}

/// The failure if nothing remains to be computed, because the checkpoint is at the end of the run or after it.
fn at_the_end(saved: &SavedRun, seconds: f64) -> Failure {
    Failure::call(CallFault::NothingLeft { time: saved.time, end: seconds })
}

fn progress_bar(frames: u64) -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("{wide_bar} {pos}/{len} frames, {msg}, {eta} left");
    indicatif::ProgressBar::new(frames)
        .with_message("t = 0 s")
        .with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}

/// The failure if surfaces of the world cross.
fn crossed(world: &dyn AnyWorld) -> Option<Failure> {
    let found = world.crossed_surfaces();
    let name = |body: usize| world.scene().body(body).map_or("", |body| body.name()).to_owned();
    let crossing = Crossing::of(found.first()?, name);
    Some(Failure::Check(match (world.time(), found.len()) {
        (time, 1) => CheckFault::Crossed { time, crossing },
        (time, pairs) => CheckFault::CrossedByPairs { time, crossing, pairs },
    }))
}
