//! The inputs from which the fuzz targets of recordings, checkpoints and sweeps start: made here, and compared with those in `fuzz/corpus`.
//! `OPRUGA_CORPUS=write cargo test -p opruga --test all fuzz_corpus::` writes them again after a change of format.

// The functions of the targets, which the fuzzer calls with other bytes.
#[path = "../../../../fuzz/src/lib.rs"]
#[allow(unreachable_pub, reason = "it is a crate of its own there")]
mod targets;

use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::checkpoint::Checkpoint;
use opruga::io::recording::{Asset, Ending, Header, Recording};
use opruga::io::scene;
use opruga::recordings::{Playback, Tape};
use opruga::sweep::{Question, head, line, read_rows};
use opruga::{Options, World, catalogue};
use std::collections::BTreeMap;
use std::io::Cursor;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A ring of five nodes, so that its states are short.
const SCENE: &str = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nsubsteps = 4\n[integrator]\nkind = \"symplectic_euler\"\n\
                     [[body]]\nname = \"ring\"\nmass = 1\nshape = { kind = \"ring\", radius = 0.5, vertices = 5 }\n\
                     models = [{ kind = \"mass_spring\", stiffness = 100.0 }]\n";

fn blueprint() -> Blueprint<2> {
    match scene::read(SCENE.as_bytes(), "ring.toml", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        _ => panic!("a scene of the plane"),
    }
}

fn world() -> World<2> {
    World::new(blueprint(), Options::default()).expect("a world")
}

/// A recording with one state every `every` frames and an action of a program.
fn recording(every: u64) -> Vec<u8> {
    let path = std::env::temp_dir().join(format!("opruga-corpus-{}-{every}", std::process::id()));
    let mut world = world();
    let header = Header {
        name: "ring".into(),
        file: "ring.toml".into(),
        scene: SCENE.into(),
        frame: world.blueprint().time.frame,
        every,
        overrides: vec![("time.substeps".into(), "4".into())],
        assets: vec![Asset { name: "a.bin".into(), bytes: vec![1, 2, 3] }],
        ..Header::default()
    };
    let mut tape = Tape::begin(&path, true, &header, &mut world).expect("a file");
    for frame in 0..7 {
        if frame == 2 {
            world.set("world.gravity", opruga::core::spec::Value::Numbers(vec![1.0, -5.0])).expect("set");
        }
        tape.step(&mut world).expect("a frame");
    }
    tape.finish(&mut world).expect("an end");
    let bytes = std::fs::read(&path).expect("the file");
    std::fs::remove_file(path).expect("the file");
    bytes
}

fn checkpoint() -> Vec<u8> {
    let mut world = world();
    world.frame().expect("a frame");
    let mut bytes = Vec::new();
    Checkpoint { scene: SCENE.into(), payload: world.snapshot() }.write(&mut bytes).expect("memory does not fail");
    bytes
}

fn question() -> Question {
    Question {
        schema: Question::SCHEMA,
        name: "ring".into(),
        file: "ring.toml".into(),
        set: vec!["body.ring.mass=1,2".into(), "time.seconds=0.1".into()],
        metrics: vec!["energy_drift".into()],
        each: false,
        sample: None,
        independent: false,
        seed: 1,
        allow_unstable: false,
        lenient: false,
        scene: SCENE.into(),
        files: BTreeMap::from([("a.bin".into(), Question::to_digits(&[1, 2, 3]))]),
    }
}

/// A question and its table, separated by a zero byte.
fn sweep_folder() -> Vec<u8> {
    let sweep = question().sweep(&opruga::Registries::default()).expect("a sweep");
    let points = sweep.points().expect("two points");
    let mut text = head(&sweep);
    for (number, point) in points.iter().enumerate() {
        let row = sweep.measure(number, point, None, &|| 0.0, &AtomicBool::new(false)).expect("nobody stops it");
        text += &line(&sweep, &row);
    }
    assert_eq!(read_rows(&sweep, &points, &text, "results.csv").expect("rows").len(), 2);
    [question().to_text().as_bytes(), b"\0", text.as_bytes()].concat()
}

#[test]
fn the_corpus_is_that_of_this_version() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let closed = recording(3);
    let files = [
        ("recording/every-state", recording(1)),
        ("recording/killed", closed[..closed.len() * 2 / 3].to_vec()),
        ("recording/one-in-three", closed),
        ("checkpoint/ring", checkpoint()),
        ("sweep_folder/ring", sweep_folder()),
    ];
    for (name, bytes) in files {
        let path = folder.join(name);
        if std::env::var_os("OPRUGA_CORPUS").is_some_and(|how| how == "write") {
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(&path, &bytes).expect("written");
        }
        assert!(
            std::fs::read(&path).is_ok_and(|there| there == bytes),
            "{name} is another one: see the head of this file"
        );
        // Each is read to its end by its target.
        match name.split_once('/').expect("a folder") {
            ("recording", kind) => {
                let recording = Recording::open(Cursor::new(&bytes[..])).expect("a recording");
                assert_eq!(matches!(recording.ending(), Ending::Closed), kind != "killed", "{name}");
                let last = recording.frames().end - 1;
                let mut playback = Playback::of(recording, last).expect("whole");
                let mut again = world();
                playback.show(&mut again, last).expect("the last frame");
                assert_eq!(playback.hash(last), Ok(again.frame_hash()), "{name}");
            }
            ("checkpoint", _) => {
                let read = Checkpoint::read(&bytes).expect("a checkpoint");
                world().restore(&read.payload).expect("its state");
            }
            (_, _) => {
                let end = bytes.iter().position(|byte| *byte == 0).expect("a zero");
                assert!(Question::read(&bytes[..end]).expect("a question").same(&question()));
            }
        }
    }
}

/// Every target has a function, a file that the fuzzer builds and a corpus to start from, and handles all of that.
#[test]
fn every_target_takes_its_corpus() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz");
    let names = |folder: &str| {
        let entries =
            std::fs::read_dir(fuzz.join(folder)).expect("a folder").map(|entry| entry.expect("an entry").path());
        let mut names: Vec<String> =
            entries.filter_map(|path| Some(path.file_stem()?.to_string_lossy().into_owned())).collect();
        names.sort();
        names
    };
    let known = targets::TARGETS.map(|(name, _)| name);
    assert_eq!(
        (names("fuzz_targets"), names("corpus")),
        (known.map(String::from).into(), known.map(String::from).into())
    );
    let manifest = std::fs::read_to_string(fuzz.join("Cargo.toml")).expect("a manifest");
    for (name, target) in targets::TARGETS {
        // The file contains only the call, which requires a nightly compiler; the called function is compiled here.
        let built = std::fs::read_to_string(fuzz.join(format!("fuzz_targets/{name}.rs"))).expect("a target");
        let code: Vec<&str> = built.lines().filter(|line| !line.is_empty() && !line.starts_with("//!")).collect();
        let call = format!("libfuzzer_sys::fuzz_target!(|bytes: &[u8]| opruga_fuzz::{name}(bytes));");
        assert_eq!(code, ["#![no_main]", &call]);
        assert!(manifest.contains(&format!("name = \"{name}\"\npath = \"fuzz_targets/{name}.rs\"")), "{manifest}");
        for file in std::fs::read_dir(fuzz.join("corpus").join(name)).expect("a corpus") {
            let bytes = std::fs::read(file.expect("an entry").path()).expect("a file");
            target(&bytes);
            // Truncated, as a fuzzer would do first.
            target(&bytes[..bytes.len() / 2]);
        }
    }
}
