//! Checks whether the present tree computes the same bits as another commit on the same machine.
//!
//! Both are built, and both run every scene that is a file: the scenes that come with the program, and those of the benchmarks, of the sweeps and of
//! the fuzz corpus. The hash of every frame, every figure of `diagnostics.csv`, the end of the run, and every row of `opruga verify` are compared.
//! The results of a commit are kept below `target/same-results` and used again.
//!
//! Scenes that exist only in the code of tests, such as those of `crates/opruga/tests/torture`, are not run; `--also FOLDER` runs the scene files of
//! any folder.

mod comparison;
mod hashes;
mod sides;

use crate::workspace;
use comparison::{Difference, Outcome};
use sides::Side;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// The number of frames of every scene, without and with `--quick`.
const FRAMES: [u64; 2] = [120, 20];
/// The scenes of `--quick`: explicit and implicit integrators, gas, contact, cloth, solids, and statics with factorised solves.
const QUICK: [&str; 7] =
    ["ball", "integrators", "implicit-integrators", "two-chambers", "cloth-over-ball", "drawings", "hanging-chain"];
/// The family of `opruga verify` that `--quick` runs.
const QUICK_FAMILY: &str = "materials";

/// The requested comparison.
#[derive(Debug, PartialEq)]
struct Question {
    base: String,
    /// If scenes are named, only these are run, and no cases of `verify`.
    scenes: Vec<String>,
    frames: u64,
    quick: bool,
    /// Folders with further scenes, which both sides run.
    also: Vec<PathBuf>,
}

impl Question {
    fn read(arguments: &[String]) -> Result<Question, String> {
        let mut question =
            Question { base: String::new(), scenes: Vec::new(), frames: 0, quick: false, also: Vec::new() };
        let mut words = arguments.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("`{word}` wants a value"));
            match word.as_str() {
                "--quick" => question.quick = true,
                "--scenes" => question.scenes = value()?.split(',').map(String::from).collect(),
                "--also" => question.also.push(value()?.into()),
                "--frames" => {
                    let frames = value()?.parse().ok().filter(|frames| (1..=100_000).contains(frames));
                    question.frames = frames.ok_or("--frames wants a number from 1 to 100000")?;
                }
                _ if question.base.is_empty() => question.base.clone_from(word),
                _ => return Err(format!("`{word}` says nothing here: one commit is compared")),
            }
        }
        if question.base.is_empty() {
            return Err("same-results wants the commit to compare with, such as HEAD~1".into());
        }
        if question.frames == 0 {
            question.frames = FRAMES[usize::from(question.quick)];
        }
        Ok(question)
    }

    /// Whether a scene is requested.
    fn wants(&self, scene: &str) -> bool {
        match (&self.scenes[..], self.quick) {
            ([], false) => true,
            ([], true) => QUICK.contains(&scene),
            (some, _) => some.iter().any(|name| name == scene),
        }
    }
}

/// `cargo xtask same-results BASE …`.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    let question = Question::read(arguments)?;
    let folder = workspace::target()?.join("same-results");
    let base = Side::of_commit(&folder, &workspace::commit(&question.base)?)?;
    let present = Side::present(&folder)?;
    let scenes = [&base, &present].map(|side| scenes_of(&side.root, &question.also));
    let [base_scenes, present_scenes] = scenes;
    let sides = [(&base, base_scenes?), (&present, present_scenes?)];
    let names: BTreeSet<&String> = sides.iter().flat_map(|(_, scenes)| scenes.keys()).collect();
    let names: Vec<&String> = names.into_iter().filter(|name| question.wants(name)).collect();
    if let Some(unknown) = question.scenes.iter().find(|scene| !names.contains(scene)) {
        return Err(format!("neither side knows the scene `{unknown}`"));
    }
    let jobs = names
        .iter()
        .flat_map(|name| sides.iter().filter_map(move |(side, scenes)| Some((*side, *name, scenes.get(*name)?))));
    let outcomes = run_scenes(&jobs.collect::<Vec<_>>(), question.frames)?;
    let mut differences = Vec::new();
    for name in &names {
        let [then, now] = [&base, &present].map(|side| outcomes.get(&(side.name.as_str(), name.as_str())));
        match (then, now) {
            (Some(then), Some(now)) => {
                if let Some(ending) = then.early(now) {
                    eprintln!("{name} ends early on both sides: {ending}");
                }
                differences.extend(comparison::of_scene(name, then, now));
            }
            (then, now) => differences.push(Difference::unknown(name, [then.is_some(), now.is_some()])),
        }
    }
    let mut rows = 0;
    if question.scenes.is_empty() {
        let family = question.quick.then_some(QUICK_FAMILY);
        let [then, now] = [base.verify(family)?, present.verify(family)?];
        rows = now.len();
        differences.extend(comparison::of_rows(&then, &now));
    }
    if differences.is_empty() {
        println!("{} scenes × {} frames, {rows} verify rows: the same", names.len(), question.frames);
        return Ok(());
    }
    print!("{}", comparison::table(&differences, [&base.name, &present.name]));
    let subjects: BTreeSet<&str> = differences.iter().map(|difference| difference.subject.as_str()).collect();
    let scenes = names.iter().filter(|name| subjects.contains(name.as_str())).count();
    let cases = subjects.len() - scenes;
    Err(format!("{scenes} of {} scenes differ, and {cases} of {rows} verify rows", names.len()))
}

/// The scenes of a tree: the name of each, and the argument by which the program finds it. For a scene that comes with the program, the argument is
/// its name.
fn scenes_of(root: &Path, also: &[PathBuf]) -> Result<BTreeMap<String, String>, String> {
    let mut out = BTreeMap::new();
    let mut folders = vec![root.join("scenes")];
    folders.extend(["scenes/sweeps", "benches/scenes", "fuzz/corpus/scene_reader"].map(|folder| root.join(folder)));
    folders.extend(also.iter().cloned());
    for (number, folder) in folders.iter().enumerate() {
        if number > 0 && !folder.is_dir() && number < 4 {
            continue;
        }
        let folder = folder.canonicalize().map_err(|e| format!("{}: {e}", folder.display()))?;
        for path in workspace::entries(&folder)? {
            let Some(stem) = workspace::name(&path).strip_suffix(".toml").map(String::from) else { continue };
            let (name, call) = match number {
                0 => (stem.clone(), stem),
                _ => (format!("{}/{stem}", workspace::name(&folder)), path.display().to_string()),
            };
            out.insert(name, call);
        }
    }
    Ok(out)
}

/// Runs scenes in parallel, one on each processor. Returns the results by side and scene.
fn run_scenes<'a>(
    jobs: &[(&'a Side, &'a String, &'a String)],
    frames: u64,
) -> Result<BTreeMap<(&'a str, &'a str), Outcome>, String> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let outcomes = Mutex::new(Vec::new());
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..processors {
            scope.spawn(|| {
                while let Some((side, name, call)) = jobs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let begin = Instant::now();
                    let outcome = side.run(name, call, frames);
                    let number = done.fetch_add(1, Ordering::Relaxed) + 1;
                    let seconds = begin.elapsed().as_secs_f64();
                    eprintln!("[{number}/{}] {} {name}: {seconds:.1} s", jobs.len(), side.name);
                    let mut outcomes = outcomes.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    outcomes.push(outcome.map(|outcome| ((side.name.as_str(), name.as_str()), outcome)));
                }
            });
        }
    });
    outcomes.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(words: &str) -> Result<Question, String> {
        Question::read(&words.split_whitespace().map(String::from).collect::<Vec<_>>())
    }

    #[test]
    fn questions_are_read() {
        let question = asked("HEAD~1 --scenes ball,heart --frames 7 --also a/b").expect("a question");
        assert_eq!((question.base.as_str(), question.frames, question.quick), ("HEAD~1", 7, false));
        assert!(question.wants("heart") && !question.wants("fish"));
        assert_eq!(question.also, [PathBuf::from("a/b")]);
        let quick = asked("--quick abc").expect("a question");
        assert!(quick.frames == FRAMES[1] && quick.wants("ball") && !quick.wants("million-vertices"));
        assert!(asked("abc").is_ok_and(|all| all.frames == FRAMES[0] && all.wants("million-vertices")));
        for wrong in ["", "--quick", "a b", "a --frames", "a --frames 0", "a --frames x"] {
            assert!(asked(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn scenes_of_this_tree_are_found_in_all_their_folders() {
        let root = workspace::root().expect("a root");
        let scenes = scenes_of(&root, &[root.join("benches/scenes")]).expect("scenes");
        assert_eq!(scenes["ball"], "ball");
        for name in ["sweeps/thesis-4-3", "scenes/spot", "scene_reader/space"] {
            assert!(Path::new(&scenes[name]).is_file(), "{name}");
        }
        for name in QUICK {
            assert!(scenes.contains_key(name), "{name}");
        }
    }
}
