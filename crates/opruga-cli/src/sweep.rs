//! `opruga sweep`: several runs of one scene at a time, a table that grows row by row, and its evaluation.

mod findings;

use crate::arguments::Sweep as Call;
use crate::bench::processor_time;
use crate::errors::{CallError, CallNote, CallRange};
use crate::failure::print_note;
use crate::failure::{Failure, print_data};
use crate::interrupt;
use crate::run::{default_folder, simd_from_environment};
use crate::source::{Source, argument};
use crate::uses;
use findings::Found;
use opruga::io::SceneError;
use opruga::io::output_folder::{Existing, OutputFolder};
use opruga::io::safe_write::WriteError;
use opruga::math::words::counted;
use opruga::sweep::errors::SweepError;
use opruga::sweep::{Metric, Question, Row, Status, Sweep, head, line, plots, read_rows};
use opruga::{Registries, Simd, sweep::Point};
use std::fs::{File, OpenOptions};
use std::io::{IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

const QUESTION: &str = "question.json";
const TABLE: &str = "results.csv";

/// Runs a sweep, or the rest of an interrupted one.
pub(crate) fn sweep(call: &Call, registries: &Registries) -> Result<u8, Failure> {
    let simd = simd_from_environment()?;
    let (question, path) = match &call.resume {
        Some(path) => (asked(path)?.ok_or_else(|| no_sweep(path))?, path.clone()),
        None => question_of(call, registries)?,
    };
    let sweep = question.sweep(registries)?;
    let points = sweep.points()?;
    let folder = folder_of(&question, &path, call.force)?;
    let known = known_rows(&folder, &sweep, &points)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = call.threads.map_or(cores.min(256), usize::from);
    let SceneInfo { length_unit, credit, ends } = scene_info(&sweep);
    if !call.json {
        ends.iter().for_each(print_note);
    }
    let work = Work { sweep: &sweep, points: &points, folder: &folder, threads, simd };
    let start = Instant::now();
    let rows = work.all(known)?;
    let mut files = vec![TABLE.to_string(), QUESTION.into()];
    match plots(&sweep, &rows, &length_unit, &credit) {
        Ok(plots) => {
            for (name, text) in plots {
                folder.write(&name, true, |out| out.write_all(text.as_bytes()))?;
                files.push(name);
            }
        }
        Err(nothing @ opruga::draw::DrawError::Empty { .. }) => {
            print_note(&CallNote::NoPlots { cause: nothing.into() });
        }
        Err(error) => return Err(error.into()),
    }
    files.push("summary.json".into());
    let found = Found { sweep: &sweep, rows: &rows, length_unit: &length_unit };
    let mut summary = found.to_json();
    summary["threads"] = threads.into();
    summary["simd"] = simd.unwrap_or_else(Simd::best).name().into();
    summary["wall_seconds"] = start.elapsed().as_secs_f64().into();
    summary["files"] = files.into();
    let text = serde_json::to_string_pretty(&summary).unwrap_or_default();
    folder.write("summary.json", true, |out| writeln!(out, "{text}"))?;
    if call.json {
        print_data(&format!("{text}\n"))?;
    } else {
        print_data(&found.to_string())?;
        if threads > 1 && sweep.metrics.iter().any(Metric::is_timing) {
            print_note(&CallNote::SharedMachine { threads });
        }
        eprintln!("written to {}", folder.path("").display());
    }
    Ok(exit_code(&rows))
}

/// The exit code that the worst point would have had as a separate run. All other points are complete.
fn exit_code(rows: &[Row]) -> u8 {
    let code = |row: &Row| match &row.status {
        Status::Done => 0,
        Status::Failed(code) if code.starts_with("run.") => 3,
        Status::Failed(_) => 2,
    };
    rows.iter().map(code).max().unwrap_or(0)
}

/// Properties of the scene that are common to all runs of a sweep.
struct SceneInfo {
    /// The name of the unit of length of the scene.
    length_unit: String,
    /// The authors of the drawings in the scene.
    credit: String,
    /// The note that runs end at another time than requested. There is no note if that time differs between the runs.
    ends: Option<CallNote>,
}

fn scene_info(sweep: &Sweep) -> SceneInfo {
    let options = opruga::io::scene::Options {
        lenient: sweep.lenient,
        overrides: sweep.fixed.clone(),
        files: sweep.files.clone(),
        ..opruga::io::scene::Options::default()
    };
    match opruga::io::scene::read(
        sweep.text.as_bytes(),
        &sweep.file,
        &opruga::catalogue_of(&sweep.registries),
        &options,
    ) {
        Ok((blueprint, _)) => {
            let scene = blueprint.scene();
            let time = scene.time();
            let varies = sweep.axes.iter().any(|axis| axis.path.starts_with("time."));
            let ends = crate::run::whole_frames(time.frames(), time.frame, time.seconds).filter(|_| !varies);
            SceneInfo { length_unit: scene.length_unit().into(), credit: scene.credit().into(), ends }
        }
        Err(_) => SceneInfo { length_unit: "m".into(), credit: String::new(), ends: None },
    }
}

fn no_sweep(path: &Path) -> Failure {
    let shown = path.display().to_string();
    Failure::Scene(vec![SceneError { file: shown, ..SceneError::of(CallError::NoSweep { file: QUESTION }) }])
}

/// The question that a call asks, with the contents of all files that the scene names, and the folder for the answer.
fn question_of(call: &Call, registries: &Registries) -> Result<(Question, PathBuf), Failure> {
    if let Some(seconds) = call.seconds.filter(|s| !(0.0..=1e9).contains(s)) {
        return Err(Failure::range("--seconds", seconds, CallRange::Between { least: 0.0, most: 1e9 }));
    }
    let source = Source::find(call.scene.as_deref().unwrap_or_default(), registries)?;
    let scene = String::from_utf8(source.bytes.clone()).map_err(|_| {
        // The reader reports the location.
        let nothing = opruga::io::scene::Options::default();
        Failure::Scene(source.survey(&nothing).errors)
    })?;
    // The files belong to the question, so a sweep is resumed with the files with which it began.
    let options = opruga::io::scene::Options {
        lenient: true,
        files: source.files.clone().allow_outside(call.allow_outside),
        ..opruga::io::scene::Options::default()
    };
    let reading = source.survey(&options);
    if !reading.unread.is_empty() {
        return Err(Failure::Scene(reading.errors));
    }
    let named = reading.files;
    let path = call.out.clone().unwrap_or_else(|| default_folder(&format!("{}-sweep", source.name)));
    let mut uses = uses::of_scene(&source, &options.files, named.keys());
    uses.folder(&path, uses::sweep_writes);
    uses::apart(&uses)?;
    let mut set = call.set.clone();
    set.extend(call.seconds.map(|seconds| format!("time.seconds={seconds}")));
    let question = Question {
        schema: Question::SCHEMA,
        name: source.name,
        file: source.file,
        set,
        metrics: call.metrics.clone(),
        each: call.each,
        sample: call.sample,
        independent: call.independent,
        seed: call.seed,
        allow_unstable: call.allow_unstable,
        lenient: call.lenient,
        scene,
        files: named.into_iter().map(|(name, bytes)| (name, Question::to_digits(&bytes))).collect(),
    };
    Ok((question, path))
}

/// The question of the sweep in a folder, or `None` if the folder contains no sweep.
fn asked(folder: &Path) -> Result<Option<Question>, Failure> {
    let path = folder.join(QUESTION);
    if !path.exists() {
        return Ok(None);
    }
    let refuse = |error: SceneError| Failure::Scene(vec![SceneError { file: path.display().to_string(), ..error }]);
    let bytes = opruga::io::scene::bytes_of(&path, &opruga::io::scene::Limits::default()).map_err(refuse)?;
    Question::read(&bytes).map(Some).map_err(refuse)
}

/// The locked folder of this question: a new one, or one that contains a part of the answer.
fn folder_of(question: &Question, path: &Path, force: bool) -> Result<OutputFolder, Failure> {
    let before = if force { None } else { asked(path)? };
    let existing = if force || before.is_some() { Existing::Replace } else { Existing::Refuse };
    if let Some(before) = before.as_ref().filter(|before| !question.same(before)) {
        let difference = question.difference(before);
        return Err(Failure::Write(WriteError::of(path, SweepError::OtherQuestion { difference })));
    }
    let folder = OutputFolder::open(path, existing)?;
    if before.is_none() {
        // The old answer is removed before the new question is written.
        for name in [TABLE, "summary.json"] {
            folder.remove(name)?;
        }
        folder.write(QUESTION, true, |out| writeln!(out, "{}", question.to_text()))?;
    }
    Ok(folder)
}

/// The rows that already exist in the folder.
fn known_rows(folder: &OutputFolder, sweep: &Sweep, points: &[Point]) -> Result<Vec<Row>, Failure> {
    let path = folder.path(TABLE);
    let shown = path.display().to_string();
    let refuse = |error: SceneError| Failure::Scene(vec![SceneError { file: shown.clone(), ..error }]);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(e) => return Err(refuse(SceneError::of(CallError::FileUnreadable { reason: e.to_string() }))),
    };
    read_rows(sweep, points, &text, &shown).map_err(Failure::Scene)
}

struct Work<'a> {
    sweep: &'a Sweep,
    points: &'a [Point],
    folder: &'a OutputFolder,
    threads: usize,
    simd: Option<Simd>,
}

/// The data that the threads share.
struct Shared {
    table: File,
    rows: Vec<Row>,
    failure: Option<Failure>,
}

impl Work<'_> {
    /// Measures every point that has no row yet. Each row is on the disk before the next point of its thread begins. At the end the table is sorted.
    fn all(&self, known: Vec<Row>) -> Result<Vec<Row>, Failure> {
        self.write_table(&known)?;
        let path = self.folder.path(TABLE);
        let table = OpenOptions::new().append(true).open(&path).map_err(|e| self.lost(&path, &e))?;
        let missing: Vec<usize> = {
            let mut there = vec![false; self.points.len()];
            known.iter().for_each(|row| there[row.number] = true);
            (0..there.len()).filter(|number| !there[*number]).collect()
        };
        if !known.is_empty() && !missing.is_empty() {
            eprintln!("{} of {} are already done", known.len(), counted(self.points.len() as u64, "point", "points"));
        }
        let bar = progress_bar(self.points.len());
        bar.set_position(known.len() as u64);
        bar.reset_eta();
        let stop = interrupt::asked_to_stop();
        let shared = Mutex::new(Shared { table, rows: known, failure: None });
        let next = AtomicUsize::new(0);
        let lock = || shared.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let worker = || {
            while let Some(number) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                if stop.load(Ordering::Relaxed) {
                    return;
                }
                let point = &self.points[*number];
                let Some(row) = self.sweep.measure(*number, point, self.simd, &processor_time, stop) else { return };
                let mut shared = lock();
                if shared.failure.is_some() {
                    return;
                }
                let written =
                    shared.table.write_all(line(self.sweep, &row).as_bytes()).and_then(|()| shared.table.sync_data());
                if let Err(error) = written {
                    shared.failure = Some(self.lost(&path, &error));
                    return;
                }
                shared.rows.push(row);
                bar.inc(1);
            }
        };
        std::thread::scope(|scope| {
            (0..self.threads.min(missing.len())).for_each(|_| {
                scope.spawn(worker);
            });
        });
        bar.finish_and_clear();
        let Shared { mut rows, failure, .. } = shared.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(failure) = failure {
            return Err(failure);
        }
        rows.sort_by_key(|row| row.number);
        if rows.len() < self.points.len() {
            let folder = argument(&self.folder.path("").display().to_string());
            eprintln!(
                "{} of {} points are done; `opruga sweep --resume {folder}` continues",
                rows.len(),
                self.points.len()
            );
            return Err(Failure::Interrupted);
        }
        self.write_table(&rows)?;
        Ok(rows)
    }

    fn write_table(&self, rows: &[Row]) -> Result<(), Failure> {
        self.folder.write(TABLE, true, |out| {
            out.write_all(head(self.sweep).as_bytes())?;
            rows.iter().try_for_each(|row| out.write_all(line(self.sweep, row).as_bytes()))
        })?;
        Ok(())
    }

    fn lost(&self, path: &Path, error: &std::io::Error) -> Failure {
        Failure::Write(WriteError::of(path, SweepError::RowNotWritten { reason: error.to_string() }))
    }
}

fn progress_bar(points: usize) -> indicatif::ProgressBar {
    if !std::io::stderr().is_terminal() {
        return indicatif::ProgressBar::hidden();
    }
    let style = indicatif::ProgressStyle::with_template("{bar:40} {pos}/{len} points, {eta} left");
    indicatif::ProgressBar::new(points as u64)
        .with_style(style.unwrap_or_else(|_| indicatif::ProgressStyle::default_bar()))
}
