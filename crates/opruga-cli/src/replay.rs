//! `opruga replay`: shows a recorded run again, exports it, or computes it again and compares the results.

use crate::arguments::Replay;
use crate::errors::{CallFault, CallRange, CallWarning, ResumeHint};
use crate::exports::{self, Tracks};
use crate::failure::print_warning;
use crate::failure::{Failure, print_data};
use crate::interrupt;
use crate::outputs::Outputs;
use crate::recorder::Recorder;
use crate::recordings;
use crate::run::{default_folder, simd_from_environment};
use crate::source::Source;
use crate::uses;
use core::ops::RangeInclusive;
use opruga::blueprint::AnyBlueprint;
use opruga::io::output_folder::{Existing, OutputFolder};
use opruga::io::outputs_apart::Use;
use opruga::io::recording::{Ending, Recording, RecordingError};
use opruga::io::series::{Format, write_pvd, write_vtk_series};
use opruga::io::tables::WarningSummary;
use opruga::io::{SceneError, scene};
use opruga::math::words::{counted, number};
use opruga::recordings::{Playback, TapeError};
use opruga::{AnyWorld, Options, Registries, Warning};
use serde_json::{Value, json};
use std::fs::File;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// Replays a recording.
pub(crate) fn replay(call: &Replay, registries: &Registries) -> Result<u8, Failure> {
    for (option, time) in [("--from", call.from), ("--to", call.to)] {
        if let Some(time) = time.filter(|time| !(0.0..=1e9).contains(time)) {
            return Err(Failure::range(option, time, CallRange::Between { least: 0.0, most: 1e9 }));
        }
    }
    if let Some(fps) = call.pictures.fps.filter(|fps| !(*fps > 0.0 && *fps <= 240.0)) {
        return Err(Failure::range("--fps", fps, CallRange::PositiveUpTo { most: 240.0 }));
    }
    let simd = simd_from_environment()?;
    let (recording, source) = recordings::open(&call.file, registries)?;
    if call.writes() || !call.verify {
        let mut uses = uses::of_file(Use::Recording {}, &call.file);
        uses.folder(&folder_of(call, &source), uses::replay_writes);
        uses::apart(&uses)?;
    }
    let frames = wanted_frames(call, &recording)?;
    let reported = oddities(&recording);
    if !call.json {
        reported.iter().for_each(print_warning);
    }
    let header = recording.header();
    let reading = scene::Options {
        lenient: header.lenient,
        overrides: header.overrides.clone(),
        files: source.files.clone(),
        ..scene::Options::default()
    };
    let options = Options {
        threads: call.threads.into(),
        simd,
        allow_unstable: header.allow_unstable,
        most_bytes: Some(reading.limits.memory_bytes),
        ..Options::default()
    };
    let blueprint = source.read(&reading, &options)?.blueprint;
    let length = header.frame;
    let job = Job { call, source: &source, reading, options, length, frames, reported };
    job.run(recording, blueprint)
}

/// The folder for the output.
fn folder_of(call: &Replay, source: &Source) -> PathBuf {
    call.out.clone().unwrap_or_else(|| default_folder(&format!("{}-replay", source.name)))
}

/// The error for a recording that cannot be replayed as requested.
fn refused(call: &Replay, error: SceneError) -> Failure {
    Failure::Run(Box::new(SceneError { file: call.file.display().to_string(), ..error }))
}

/// The frames from `--from` to `--to`. A damaged recording can only be replayed up to a time before the damage.
fn wanted_frames(call: &Replay, recording: &Recording<File>) -> Result<RangeInclusive<u64>, Failure> {
    let (frames, length) = (recording.frames(), recording.header().frame);
    let last = frames.end.checked_sub(1).filter(|last| *last >= frames.start);
    let time = |frame: u64| frame as f64 * length;
    if let Ending::Damaged(error) = recording.ending() {
        let before = last.filter(|last| call.to.is_none_or(|to| (to / length + 1e-9).floor() > *last as f64));
        if before.is_some() || last.is_none() {
            let hint = match last {
                Some(last) => ResumeHint::FramesBefore { time: time(last) },
                None => ResumeHint::NoFrameBefore {},
            };
            return Err(refused(call, SceneError::from(error).advice(hint)));
        }
    }
    let Some(last) = last else {
        let error = RecordingError::no_frame(0, &frames);
        return Err(refused(call, SceneError::from(&error).advice(ResumeHint::KilledAtStart {})));
    };
    let from = call.from.map_or(frames.start, |from| (from / length - 1e-9).ceil() as u64).max(frames.start);
    let to = call.to.map_or(last, |to| (to / length + 1e-9).floor() as u64).min(last);
    if from > to {
        let (from, to) = (call.from.unwrap_or(0.0), call.to.unwrap_or(time(last)));
        let (first, last) = (time(frames.start), time(last));
        return Err(Failure::call(CallFault::NoFrame { from, to, first, last, apart: length }));
    }
    Ok(from..=to)
}

/// The warnings about a recording.
fn oddities(recording: &Recording<File>) -> Vec<Warning> {
    let header = recording.header();
    let open = match recording.ending() {
        Ending::Open { lost } => {
            let frames = recording.frames();
            let until = frames.end.saturating_sub(1) as f64 * header.frame;
            Some(CallWarning::NoEnd { frames: frames.end - frames.start, until, lost: *lost })
        }
        _ => None,
    };
    let now = recordings::PROGRAM;
    let program = (header.program != now).then(|| CallWarning::OtherProgram { program: header.program.clone(), now });
    let changed = std::fs::read(&header.file).is_ok_and(|bytes| bytes != header.scene);
    let changed = changed.then(|| CallWarning::SceneChanged { file: header.file.clone() });
    [open, program, changed].into_iter().flatten().map(|about| Warning::new(about, 1)).collect()
}

/// Warnings as rows of a summary.
fn summaries<'w>(warnings: impl IntoIterator<Item = &'w Warning>) -> Vec<WarningSummary> {
    warnings.into_iter().map(WarningSummary::from).collect()
}

struct Job<'a> {
    call: &'a Replay,
    source: &'a Source,
    reading: scene::Options,
    options: Options,
    /// The length of a frame [s].
    length: f64,
    frames: RangeInclusive<u64>,
    reported: Vec<Warning>,
}

impl Job<'_> {
    fn run(self, recording: Recording<File>, mut blueprint: AnyBlueprint) -> Result<u8, Failure> {
        blueprint.rename(&self.source.name);
        let build = |blueprint| self.source.build(blueprint, &self.reading, &self.options);
        let stop = interrupt::asked_to_stop();
        let last = *self.frames.end();
        let play = |recording| Playback::of(recording, last).map_err(|error| self.failure(&error, last));
        if !self.call.verify {
            return self.show(&mut *build(blueprint)?, &mut play(recording)?, stop, None);
        }
        // A folder that is in use is reported before the work begins.
        let writes = self.call.writes();
        let folder = if writes { Some(self.folder()?) } else { None };
        let verified = self.verify(&mut *build(blueprint.clone())?, &mut play(recording)?, stop)?;
        let same = verified["pass"] == true;
        match folder.filter(|_| same) {
            Some(folder) => {
                // The recording is played from its first frame again, in a new world that does not depend on the one used for the comparison.
                let (again, _) = recordings::open(&self.call.file, &self.source.registries)?;
                self.show(&mut *build(blueprint)?, &mut play(again)?, stop, Some((folder, verified)))
            }
            None => {
                if self.call.json {
                    print_data(&format!("{verified}\n"))?;
                } else if writes {
                    eprintln!(
                        "the run differs from the recorded one, so nothing is written; without --verify, the output is written"
                    );
                }
                Ok(u8::from(!same))
            }
        }
    }

    /// Makes the failure for an error at a frame.
    fn failure(&self, error: &TapeError, frame: u64) -> Failure {
        match error {
            TapeError::World(error) => self.source.run_error(error, self.time(frame)),
            TapeError::Read(error) => refused(self.call, SceneError::from(error)),
            TapeError::Write(error) => Failure::Write(error.clone()),
        }
    }

    fn time(&self, frame: u64) -> f64 {
        frame as f64 * self.length
    }

    /// Computes every frame again, from the beginning of the scene or from the first requested frame. The hash of each frame is compared. If the
    /// state of a frame is kept, every number is compared too. Returns the result in the form that `--json` prints.
    fn verify(
        &self,
        world: &mut dyn AnyWorld,
        playback: &mut Playback<File>,
        stop: &AtomicBool,
    ) -> Result<Value, Failure> {
        let (first, last) = (*self.frames.start(), *self.frames.end());
        if first > 0 {
            playback.show(world, first).map_err(|error| self.failure(&error, first))?;
        }
        let mut different = None;
        let (mut compared, mut states) = (0u64, 0u64);
        for frame in first..=last {
            if stop.load(Ordering::Relaxed) {
                return Err(Failure::Interrupted);
            }
            if frame > first {
                playback.step(world, frame).map_err(|error| self.source.frame_error(&error, world, &self.reading))?;
            }
            compared += 1;
            let damaged = |error: RecordingError| self.failure(&TapeError::Read(error), frame);
            let (recorded, computed) = (playback.hash(frame).map_err(damaged)?, world.frame_hash());
            let mut same = recorded == computed;
            if playback.keeps(frame) {
                states += 1;
                same = same && playback.state(frame).map_err(damaged)? == world.snapshot();
            }
            if !same {
                different = Some((frame, recorded, computed));
                break;
            }
        }
        let hash = |hash: u64| format!("{hash:016x}");
        let time = |frame: u64| self.time(frame);
        let span = json!({"first": first, "last": last, "from": time(first), "to": time(last)});
        let Some((frame, recorded, computed)) = different else {
            let same = hash(world.state_hash());
            if !self.call.json {
                let count = counted(compared, "frame", "frames");
                let states = match states == compared {
                    true => "by their whole states".into(),
                    false => format!(
                        "by their hashes, {states} also by {}",
                        if states == 1 { "its state" } else { "their states" }
                    ),
                };
                eprintln!(
                    "{}: {count} computed again and compared {states}: the same, bit for bit; state hash {same}",
                    self.source.name
                );
            }
            return Ok(
                json!({"schema": 1, "scene": self.source.name, "frames": span, "compared": compared, "states": states, "pass": true,
                       "state_hash": same, "warnings": summaries(&self.reported)}),
            );
        };
        let time = time(frame);
        if !self.call.json {
            let what = match recorded == computed {
                true => "positions and velocities are the same, the rest of the state is not".to_string(),
                false => format!("its hash was {} and is {} now", hash(recorded), hash(computed)),
            };
            eprintln!("{}: frame {frame}, t = {} s, is the first that differs: {what}", self.source.name, number(time));
        }
        Ok(
            json!({"schema": 1, "scene": self.source.name, "frames": span, "compared": compared, "states": states, "pass": false,
                   "differs_at": {"frame": frame, "time": time, "recorded": hash(recorded), "computed": hash(computed)},
                   "warnings": summaries(&self.reported)}),
        )
    }

    /// Writes tables, pictures and exported frames from the recorded states and from the steps between them. If there was a comparison, also writes
    /// its result.
    fn show(
        &self,
        world: &mut dyn AnyWorld,
        playback: &mut Playback<File>,
        stop: &AtomicBool,
        verified: Option<(OutputFolder, Value)>,
    ) -> Result<u8, Failure> {
        let call = self.call;
        let (first, last) = (*self.frames.start(), *self.frames.end());
        playback.show(world, first).map_err(|error| self.failure(&error, first))?;
        let mut recorder = Recorder::new(world, call.wanted(), last - first)?;
        let (folder, verified) = match verified {
            Some((folder, verified)) => (folder, Some(verified)),
            None => (self.folder()?, None),
        };
        let all = [Format::Vtk, Format::Vtu, Format::Obj, Format::Ply];
        let formats: Vec<Format> = [call.vtk, call.vtu, call.obj, call.ply]
            .into_iter()
            .zip(all)
            .filter_map(|(wanted, format)| wanted.then_some(format))
            .collect();
        let mut files = vec!["diagnostics.csv".to_string()];
        let (mut series, mut collection) = (Vec::new(), Vec::new());
        let mut tracks = (call.gltf || call.pc2 || call.mdd).then(Tracks::default);
        for frame in first..=last {
            if stop.load(Ordering::Relaxed) {
                return Err(Failure::Interrupted);
            }
            // Moments within a frame are available only while it is computed, so it is computed even if its state is kept.
            let shown = if frame > first && recorder.looks_within && playback.keeps(frame) {
                playback.step(world, frame).map_err(TapeError::from)
            } else {
                playback.show(world, frame)
            };
            shown.map_err(|error| self.failure(&error, frame))?;
            recorder.record(world);
            if !frame.is_multiple_of(recorder.every) {
                continue;
            }
            for format in &formats {
                let name = format!("frame-{frame:06}.{}", format.ending());
                exports::frame(world, *format, &folder, &name)?;
                match format {
                    Format::Vtk => series.push((name.clone(), world.time())),
                    Format::Vtu => collection.push((name.clone(), world.time())),
                    Format::Obj | Format::Ply => {}
                }
                files.push(name);
            }
            if let Some(tracks) = &mut tracks {
                tracks.add(world)?;
            }
        }
        if !series.is_empty() {
            folder.write("frames.vtk.series", false, |out| write_vtk_series(out, &series))?;
            files.push("frames.vtk.series".into());
        }
        if !collection.is_empty() {
            folder.write("frames.pvd", false, |out| write_pvd(out, &collection))?;
            files.push("frames.pvd".into());
        }
        if let Some(tracks) = tracks {
            tracks.write(call, &folder, &self.source.name, &mut files)?;
        }
        recorder.finish(world);
        let thinned = recorder.thinned();
        if !call.json {
            thinned.iter().for_each(print_warning);
        }
        folder.write("diagnostics.csv", false, |out| recorder.table.write(out))?;
        let outputs = Outputs {
            folder: &folder,
            source: self.source,
            wall: 0.0,
            steps: 0,
            resumed_at: None,
            reported: Vec::new(),
            stop,
            stress: false,
        };
        if let Some(scenery) = &recorder.scenery {
            outputs.pictures(scenery, &recorder, &mut files)?;
        }
        if call.json {
            let (from, to) = (self.time(first), self.time(last));
            let warnings = summaries(self.reported.iter().chain(&thinned));
            let mut row = json!({"schema": 1, "scene": self.source.name, "warnings": warnings, "files": files,
                             "frames": {"first": first, "last": last, "from": from, "to": to},
                             "state_hash": format!("{:016x}", world.state_hash())});
            for (word, found) in verified.iter().flat_map(Value::as_object).flatten() {
                row[word] = found.clone();
            }
            print_data(&format!("{row}\n"))?;
        } else {
            outputs.print_paths();
        }
        Ok(0)
    }

    fn folder(&self) -> Result<OutputFolder, Failure> {
        let path = folder_of(self.call, self.source);
        let existing = if self.call.force { Existing::Replace } else { Existing::Refuse };
        Ok(OutputFolder::open(&path, existing)?)
    }
}
