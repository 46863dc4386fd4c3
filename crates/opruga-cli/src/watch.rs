//! `--watch`: repeats a command whenever the scene or a file that it names changes, until Ctrl-C.

use crate::arguments::{Check, Run};
use crate::errors::CallFault;
use crate::failure::Failure;
use crate::source::Source;
use crate::{interrupt, reports};
use opruga::Registries;
use opruga::io::problem::visible;
use opruga::io::scene;
use opruga::math::words::counted;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// The interval at which the files are checked.
const EVERY: Duration = Duration::from_millis(100);
/// The number of consecutive checks that must show the same files, because editors write in several steps.
const SETTLED: u32 = 2;
/// A missing file counts as removed after this many checks. Until then, a program may just be replacing it.
const GONE: u32 = 5;

/// Runs a scene. With `--watch`, runs it again whenever it changes.
pub(crate) fn run(call: &Run, registries: &Registries) -> Result<u8, Failure> {
    if !call.watch {
        return crate::run::run(call, registries);
    }
    let mut call = call.clone();
    let scene = call.scene.clone().unwrap_or_else(|| "ball".into());
    again_and_again(&scene, registries, call.allow_outside, call.json, || {
        let outcome = crate::run::run(&call, registries);
        // From now on the files in the folder belong to this call and may be replaced. After a refusal they may belong to
        // someone else.
        if matches!(outcome, Ok(_) | Err(Failure::Run(_) | Failure::Interrupted)) {
            call.force = true;
        }
        outcome
    })
}

/// Checks a scene. With `--watch`, checks it again whenever it changes.
pub(crate) fn check(call: &Check, registries: &Registries) -> Result<u8, Failure> {
    if !call.watch {
        return reports::check(call, registries);
    }
    again_and_again(&call.scene, registries, call.allow_outside, call.json, || reports::check(call, registries))
}

/// Does the work now and after every change of the scene or of a file that it names. Work that is still running at a change is stopped. After an
/// error, reports the error and waits for the next change.
fn again_and_again(
    scene: &str,
    registries: &Registries,
    outside: bool,
    json: bool,
    mut work: impl FnMut() -> Result<u8, Failure>,
) -> Result<u8, Failure> {
    let path = Path::new(scene);
    if !path.is_file() {
        // A missing file is reported as usual.
        Source::find(scene, registries)?;
        return Err(Failure::call(CallFault::NeverChanges { scene: visible(scene) }));
    }
    interrupt::asked_to_stop();
    loop {
        // The state of the scene is taken before its files are searched for, so a change during the search counts.
        let stamp = Stamp::of(path);
        let (files, mut stamps) = named_files(scene, registries, outside);
        stamps[0] = stamp;
        let (outcome, changed) = std::thread::scope(|scope| {
            let watcher = scope.spawn(|| wait_for_change(&files, &stamps, json));
            let outcome = work();
            match &outcome {
                Err(Failure::ClosedPipe) => interrupt::stop_work(),
                // The change has stopped the work.
                Err(Failure::Interrupted) => {}
                Err(failure) => failure.print(json),
                Ok(_) => {}
            }
            if !json && !interrupt::asked_to_end() && !watcher.is_finished() {
                let more = match files.len() {
                    1 => String::new(),
                    n => format!(" and of {}", counted(n as u64 - 1, "file that it names", "files that it names")),
                };
                eprintln!("waiting for changes to {}{more}; Ctrl-C ends", visible(scene));
            }
            (outcome, watcher.join().ok().flatten())
        });
        let Some(changed) = changed else {
            return Err(match outcome {
                Err(Failure::ClosedPipe) => Failure::ClosedPipe,
                _ => Failure::Interrupted,
            });
        };
        interrupt::begin_work();
        if !json {
            eprintln!("{} has changed", visible(&files[changed].display().to_string()));
        }
    }
}

/// The scene file and the files that it names, whether they exist or not, with their states.
fn named_files(scene: &str, registries: &Registries, outside: bool) -> (Vec<PathBuf>, Vec<Option<Stamp>>) {
    let mut files = vec![PathBuf::from(scene)];
    if let Ok(source) = Source::find(scene, registries) {
        let scene_files = source.files.clone().allow_outside(outside);
        let options = scene::Options { lenient: true, files: scene_files.clone(), ..scene::Options::default() };
        let reading = source.survey(&options);
        files.extend(reading.files.keys().chain(&reading.unread).filter_map(|name| scene_files.path_of(name)));
    }
    let stamps = files.iter().map(|file| Stamp::of(file)).collect();
    (files, stamps)
}

/// Waits until a file differs from its former state and all files have stayed the same for a while. Then stops the present work and returns the index
/// of the file. Returns `None` if the work was stopped for another reason. A file that disappears and does not come back is reported once.
fn wait_for_change(files: &[PathBuf], before: &[Option<Stamp>], json: bool) -> Option<usize> {
    let stop = interrupt::asked_to_stop();
    let (mut last, mut same) = (Vec::new(), 0);
    // For every file that existed, the number of checks for which it has been missing.
    let mut missing = vec![0u32; files.len()];
    while !stop.load(std::sync::atomic::Ordering::Relaxed) {
        std::thread::sleep(EVERY);
        let now: Vec<Option<Stamp>> = files.iter().map(|file| Stamp::of(file)).collect();
        same = if now == last { same + 1 } else { 0 };
        for (k, file) in files.iter().enumerate() {
            let gone =
                now[k].is_none() && (before[k].is_some() || last.get(k).is_some_and(Option::is_some) || missing[k] > 0);
            missing[k] = if gone { missing[k].saturating_add(1) } else { 0 };
            if missing[k] == GONE && !json {
                eprintln!("{} is gone; waiting for it to come back", visible(&file.display().to_string()));
            }
        }
        // A missing file is being replaced.
        let changed = (0..files.len()).find(|k| now[*k].is_some() && now[*k] != before[*k]);
        if let Some(changed) = changed.filter(|_| now[0].is_some() && same >= SETTLED) {
            interrupt::stop_work();
            return (!interrupt::asked_to_end()).then_some(changed);
        }
        last = now;
    }
    None
}

/// The properties that distinguish states of a file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stamp {
    bytes: u64,
    changed: Option<SystemTime>,
}

impl Stamp {
    fn of(path: &Path) -> Option<Stamp> {
        let about = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
        Some(Stamp { bytes: about.len(), changed: about.modified().ok() })
    }
}
