//! Every scene that comes with the library ends with the bits in `scenes/golden.txt`, for any number of threads and any vector instructions of this
//! processor. The test uses the best instructions with 3 threads. The other configurations are the best instructions with 1 and 8 threads, and the
//! other instructions with 3. The sweep uses one of them for every scene, in turn; all of them for every scene take four times as long (`cargo test
//! -p opruga --test all -- --ignored in_all_ways`). The first frames are recorded and played back.
//!
//! `cargo xtask goldens` writes the hashes again (it uses all configurations with `OPRUGA_GOLDENS=write`); the numbers of frames are written by hand.
//! A changed hash is a changed result: the commit must give its reason.

use crate::recordings::first_frames_are_replayed;
use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::scene;
use opruga::{Options, Simd, World, catalogue, scenes};
use std::fmt::Write as _;
use std::path::PathBuf;

/// One line of the file.
struct Golden {
    scene: String,
    frames: u64,
    hash: String,
}

/// The number of frames of a scene that the file does not contain yet.
const FRAMES: u64 = 20;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

/// The comment at the beginning of the file, and its lines.
fn file() -> (String, Vec<Golden>) {
    let text = std::fs::read_to_string(folder().join("golden.txt")).expect("scenes/golden.txt");
    let head = text.lines().filter(|l| l.starts_with('#')).map(|l| format!("{l}\n")).collect();
    let lines = text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty());
    let golden = |line: &str| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [scene, frames, hash] = words[..] else { panic!("scenes/golden.txt: `{line}` is no scene, frames, hash") };
        Golden { scene: scene.into(), frames: frames.parse().expect("frames are a number"), hash: hash.into() }
    };
    (head, lines.map(golden).collect())
}

/// Replaces the hash of a scene whose bits are the same only on processors of one class.
const OF_A_CLASS: &str = "this_cpu_class";

/// The hash of the state after some frames, the first of which are replayed if a name is given; a scene without a guarantee for every processor is
/// marked.
fn hash<const D: usize>(blueprint: &Blueprint<D>, frames: u64, options: &Options, replay: Option<&str>) -> String {
    let new = || World::new(blueprint.clone(), options.clone()).expect("a world");
    let mut world = new();
    let recorded = replay.map_or(0, |name| first_frames_are_replayed(name, &mut world, new, frames as usize));
    for _ in recorded..frames {
        world.frame().expect("a frame");
    }
    let mark = if world.same_bits_everywhere() { String::new() } else { format!("{OF_A_CLASS}:") };
    format!("{mark}{:016x}", world.state_hash())
}

/// The entry of the file for a hash.
fn written(found: &str) -> &str {
    if found.starts_with(OF_A_CLASS) { OF_A_CLASS } else { found }
}

fn hash_of_any(blueprint: &AnyBlueprint, frames: u64, options: &Options, replay: Option<&str>) -> String {
    match blueprint {
        AnyBlueprint::Plane(blueprint) => hash(blueprint, frames, options, replay),
        AnyBlueprint::Space(blueprint) => hash(blueprint, frames, options, replay),
    }
}

#[test]
fn every_scene_file_comes_with_the_library() {
    let mut files: Vec<String> = std::fs::read_dir(folder())
        .expect("the folder of scenes")
        .filter_map(|entry| Some(entry.ok()?.file_name().to_str()?.strip_suffix(".toml")?.to_string()))
        .collect();
    let mut names: Vec<String> = scenes::names().map(String::from).collect();
    files.sort();
    names.sort();
    assert_eq!(files, names, "scenes/*.toml and crates/opruga/src/scenes.rs");
}

#[test]
fn every_scene_ends_with_its_golden_hash_and_its_recording_replays_it() {
    compare(&|_| vec![(Simd::best(), 3)], true);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn every_scene_ends_with_its_golden_hash_whole_sweep() {
    let ways = other_ways();
    compare(&|scene| vec![ways[scene % ways.len()]], false);
}

#[test]
#[ignore = "four times as long as the sweep: cargo test -p opruga --test all -- --ignored in_all_ways"]
fn every_scene_ends_with_its_golden_hash_in_all_ways() {
    compare(&|_| other_ways(), false);
}

/// Configurations of instructions and threads other than that of the test. The distribution of work over threads does not depend on the instructions.
fn other_ways() -> Vec<(Simd, usize)> {
    let best = |simd: &Simd| simd.name() == Simd::best().name();
    let others = Simd::available().into_iter().filter(|simd| !best(simd)).map(|simd| (simd, 3));
    others.chain([1, 8].map(|threads| (Simd::best(), threads))).collect()
}

/// Runs every scene in the configurations for its number.
fn compare(ways_of: &dyn Fn(usize) -> Vec<(Simd, usize)>, replay: bool) {
    let write = std::env::var("OPRUGA_GOLDENS").is_ok_and(|w| w == "write");
    let (head, golden) = file();
    let (mut text, mut wrong) = (head, Vec::new());
    for (number, name) in scenes::names().enumerate() {
        let known = golden.iter().find(|g| g.scene == name);
        let frames = known.map_or(FRAMES, |g| g.frames);
        let source = scenes::find(name).expect("a scene of the library");
        let reading = scene::Options { files: scenes::files(), ..scene::Options::default() };
        let read = scene::read(source.as_bytes(), &format!("{name}.toml"), &catalogue(), &reading);
        let (blueprint, notices) = read.unwrap_or_else(|errors| panic!("{}", errors[0]));
        // Warnings are errors here, except those about things that a scene asks for.
        assert!(notices.iter().all(|n| n.about.code == "shape.dropped"), "{name}: {}", notices[0]);
        let start = std::time::Instant::now();
        let mut first = String::new();
        for (simd, threads) in ways_of(number) {
            let options = Options { threads, simd: Some(simd), ..Options::default() };
            let found = hash_of_any(&blueprint, frames, &options, replay.then_some(name));
            if first.is_empty() {
                first.clone_from(&found);
            }
            let wanted = if write { written(&first) } else { known.map_or("no hash", |g| g.hash.as_str()) };
            if written(&found) != wanted || found != first {
                let simd = simd.name();
                wrong.push(format!("{name} after {frames} frames, {threads} threads, {simd}: {found}, not {wanted}"));
            }
        }
        println!("{name}: {:.2} s", start.elapsed().as_secs_f64());
        let _ = writeln!(text, "{name} {frames} {}", written(&first));
    }
    assert!(wrong.is_empty(), "results have changed (see the head of this file):\n{}", wrong.join("\n"));
    if write {
        std::fs::write(folder().join("golden.txt"), text).expect("scenes/golden.txt can be written");
        return;
    }
    for line in &golden {
        assert!(scenes::find(&line.scene).is_some(), "scenes/golden.txt names `{}`, which is no scene", line.scene);
    }
}
