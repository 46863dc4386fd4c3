//! `--watch`: doing again what was asked for whenever the scene file changes, until Ctrl-C.

use crate::arguments::{Check, Run};
use crate::failure::Failure;
use crate::source::Source;
use crate::{interrupt, reports};
use opruga::io::problem::visible;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// How often the file is looked at.
const EVERY: Duration = Duration::from_millis(100);
/// How many looks in a row must show the same file: editors write in several steps.
const SETTLED: u32 = 2;

/// Runs a scene, and again whenever it changes if that is asked for.
pub(crate) fn run(call: &Run) -> Result<u8, Failure> {
    if !call.watch {
        return crate::run::run(call);
    }
    let mut call = call.clone();
    let scene = call.scene.clone().unwrap_or_else(|| "ball".into());
    again_and_again(&scene, call.json, || {
        let outcome = crate::run::run(&call);
        // What stands in the folder from now on is ours, and may be replaced. A refusal leaves it somebody else's.
        if matches!(outcome, Ok(_) | Err(Failure::Run(_) | Failure::Interrupted)) {
            call.force = true;
        }
        outcome
    })
}

/// Checks a scene, and again whenever it changes if that is asked for.
pub(crate) fn check(call: &Check) -> Result<u8, Failure> {
    if !call.watch {
        return reports::check(call);
    }
    again_and_again(&call.scene, call.json, || reports::check(call))
}

/// Works now and after every change of the scene file; work that the change overtakes is stopped. Errors are told, and the
/// next change is waited for.
fn again_and_again(scene: &str, json: bool, mut work: impl FnMut() -> Result<u8, Failure>) -> Result<u8, Failure> {
    let path = Path::new(scene);
    if !path.is_file() {
        // A file that is missing is told as ever.
        Source::find(scene)?;
        return Err(Failure::Call {
            message: format!("`{}` comes with the program and never changes: --watch needs a file", visible(scene)),
            hint: Some("`opruga new NAME` writes one".into()),
        });
    }
    interrupt::asked_to_stop();
    loop {
        let stamp = Stamp::of(path);
        let outcome = std::thread::scope(|scope| {
            let watcher = scope.spawn(|| wait_for_change(path, stamp));
            let outcome = work();
            match &outcome {
                Err(Failure::ClosedPipe) => interrupt::stop_work(),
                // Stopped by the change.
                Err(Failure::Interrupted) => {}
                Err(failure) => failure.print(json),
                Ok(_) => {}
            }
            if !json && !interrupt::asked_to_end() && !watcher.is_finished() {
                eprintln!("waiting for changes of {}; Ctrl-C ends", visible(scene));
            }
            let changed = watcher.join().unwrap_or(false);
            if changed { Ok(()) } else { Err(outcome.err().unwrap_or(Failure::Interrupted)) }
        });
        match outcome {
            Ok(()) => interrupt::begin_work(),
            Err(Failure::ClosedPipe) => return Err(Failure::ClosedPipe),
            Err(_) => return Err(Failure::Interrupted),
        }
        if !json {
            eprintln!("{} has changed", visible(scene));
        }
    }
}

/// Returns true once the file is another one than it was and stays so for a while; the work at hand is stopped then.
/// Returns false when that work was stopped by somebody else.
fn wait_for_change(path: &Path, before: Option<Stamp>) -> bool {
    let stop = interrupt::asked_to_stop();
    let (mut last, mut same) = (None, 0);
    while !stop.load(std::sync::atomic::Ordering::Relaxed) {
        std::thread::sleep(EVERY);
        let now = Stamp::of(path);
        same = if now == last { same + 1 } else { 0 };
        last = now;
        // A file that is not there is being replaced.
        if now.is_some() && now != before && same >= SETTLED {
            interrupt::stop_work();
            return !interrupt::asked_to_end();
        }
    }
    false
}

/// What tells one state of a file from another.
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
