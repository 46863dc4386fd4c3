//! Recorded runs: killed, damaged, replayed, exported, computed again. The numbers are rows of the torture list.
#![cfg(unix)]
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("no JSON: {}", said(output)))
}

fn verified(folder: &Path, more: &[&str]) -> Value {
    let output = opruga(folder, &[&["replay", "r", "--verify", "--json"], more].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
    let row = json(&output);
    assert_eq!(row["pass"], true);
    row
}

/// Without computing a step, a recording gives the pictures and tables of its run again, byte by byte. Computed again, also on other threads and from
/// the middle, every frame is the same. The scene is not needed any more.
#[test]
fn a_replay_gives_the_files_of_its_run_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let text = printed(&opruga(folder, &["new", "mine", "--json"]));
    assert!(text.is_empty());
    let run = ["run", "mine.toml", "--seconds", "0.5", "--set", "time.substeps=40", "--out", "o", "--record", "r"];
    let output = opruga(folder, &[&run[..], &["--json"]].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
    let summary = json(&output);
    // Row 90: the scene changes, which is reported; then it is deleted.
    std::fs::write(folder.join("mine.toml"), "else").expect("a file");
    let row = verified(folder, &[]);
    assert_eq!(row["state_hash"], summary["state_hash"]);
    assert_eq!(row["warnings"][0]["code"], "scene.changed");
    std::fs::remove_file(folder.join("mine.toml")).expect("a file");
    assert_eq!(
        verified(folder, &["--from", "0.2", "--to", "0.3", "--threads", "2"])["warnings"],
        serde_json::json!([])
    );

    let output = opruga(
        folder,
        &["replay", "r", "--out", "again", "--vtk", "--vtu", "--obj", "--ply", "--gltf", "--pc2", "--mdd"],
    );
    assert_eq!(code(&output), 0, "{}", said(&output));
    for name in ["strip.png", "video.mp4", "plots.svg", "diagnostics.csv"] {
        let of = |run: &str| std::fs::read(folder.join(run).join(name)).expect("a file");
        assert!(of("again") == of("o"), "{name} is another one");
    }
    let names: Vec<String> = contents(&folder.join("again")).into_iter().map(|f| f.0).collect();
    for ending in ["vtk", "vtu", "obj", "ply"] {
        let count = names.iter().filter(|n| n.starts_with("frame-") && n.ends_with(ending)).count();
        assert_eq!(count, 11, "20 pictures a second for half a second and one at the start: {names:?}");
    }
    let pvd = std::fs::read_to_string(folder.join("again/frames.pvd")).expect("a list");
    assert_eq!(pvd.matches("<DataSet timestep=").count(), 11);
    assert!(pvd.contains("timestep=\"5e-1\" part=\"0\" file=\"frame-000030.vtu\""), "{pvd}");
    for ending in ["glb", "pc2", "mdd"] {
        assert!(names.iter().any(|name| name.ends_with(ending)), "{ending}: {names:?}");
    }
    // The last exported frame has the positions of the end of the run.
    let last = std::fs::read_to_string(folder.join("again/frame-000030.obj")).expect("a file");
    let table = std::fs::read_to_string(folder.join("o/final.csv")).expect("a table");
    let number = |text: &str| text.parse::<f64>().expect("a number").to_bits();
    let exported: Vec<u64> = last
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .flat_map(|line| line.split(' ').take(2).map(number).collect::<Vec<_>>())
        .collect();
    let reached: Vec<u64> =
        table.lines().skip(1).flat_map(|row| row.split(',').skip(2).take(2).map(number).collect::<Vec<_>>()).collect();
    assert!(!exported.is_empty() && exported == reached);
}

/// One call compares every frame and writes the files of the run again; if the run differs, nothing is written, and no folder is made.
#[test]
fn a_replay_compares_and_writes_in_one_call() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let run = ["run", "pressures", "--seconds=0.3", "--out=o", "--record=r", "--record-every=4", "--json"];
    let output = opruga(folder, &run);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let summary = json(&output);
    let row = verified(folder, &["--out=again", "--obj"]);
    assert_eq!(row["state_hash"], summary["state_hash"]);
    assert_eq!(
        (row["compared"].as_u64(), row["states"].as_u64(), row["pass"].as_bool()),
        (Some(19), Some(6), Some(true))
    );
    assert!(row["files"].as_array().is_some_and(|files| files.iter().any(|file| file == "frame-000018.obj")), "{row}");
    for name in ["strip.png", "video.mp4", "plots.svg", "diagnostics.csv"] {
        let of = |run: &str| std::fs::read(folder.join(run).join(name)).expect("a file");
        assert!(of("again") == of("o"), "{name} is another one");
    }
    // A folder that is not free is reported before the work, and is not changed.
    let output = opruga(folder, &["replay", "r", "--verify", "--out=o"]);
    assert_eq!(code(&output), 4, "{}", said(&output));
    assert!(said(&output).contains("write.exists") && !said(&output).contains("computed again"), "{}", said(&output));
    let output = opruga(folder, &["replay", "r", "--verify", "--out=part", "--no-pictures", "--from=0.1", "--to=0.2"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(said(&output).contains("7 frames computed again and compared") && said(&output).contains("part"));
    assert_eq!(std::fs::read_to_string(folder.join("part/diagnostics.csv")).expect("a table").lines().count(), 8);
    tampered(folder, "hash", Some(13), None);
    let output = opruga(folder, &["replay", "hash", "--verify", "--out=wrong"]);
    assert_eq!(code(&output), 1, "{}", said(&output));
    assert!(said(&output).contains("frame 13,") && said(&output).contains("nothing is written"), "{}", said(&output));
    assert!(!folder.join("wrong").exists() || contents(&folder.join("wrong")).is_empty());
}

/// The recording `r` with one change: the hash of a frame, or a byte of a state.
fn tampered(folder: &Path, name: &str, wrong_hash: Option<u64>, wrong_state: Option<u64>) {
    use opruga::io::recording::{Recording, RecordingFile};
    let mut recording = Recording::open(std::fs::File::open(folder.join("r")).expect("a file")).expect("a recording");
    let mut file = RecordingFile::create(&folder.join(name), false, recording.header()).expect("a file");
    for frame in recording.frames() {
        let hash = recording.hash(frame).expect("a hash") ^ u64::from(wrong_hash == Some(frame));
        if recording.kept(frame) == Ok(frame) {
            let mut state = recording.read(frame).expect("a state").to_vec();
            let last = state.len() - 1;
            state[last] ^= u8::from(wrong_state == Some(frame));
            file.keep(frame, hash, |out| out.extend(state)).expect("written");
        } else {
            file.push(frame, hash).expect("written");
        }
    }
    file.finish().expect("an end");
}

/// Frames without kept states are compared, too: a recording that differs only in one of them is detected at that frame.
#[test]
fn a_frame_between_two_states_that_differs_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    summary(folder, &["run", "pressures", "--seconds=1", "--out=o", "--record=r", "--record-every=20"]);
    let row = verified(folder, &[]);
    assert_eq!((row["compared"].as_u64(), row["states"].as_u64()), (Some(61), Some(4)), "{row}");
    for (name, hash, state, frame) in
        [("same", None, None, 0), ("hash", Some(33), None, 33), ("state", None, Some(40), 40)]
    {
        tampered(folder, name, hash, state);
        let output = opruga(folder, &["replay", name, "--verify", "--json"]);
        let row = json(&output);
        assert_eq!((code(&output), row["pass"] == true), if frame == 0 { (0, true) } else { (1, false) }, "{row}");
        if frame > 0 {
            assert_eq!(row["differs_at"]["frame"], frame, "{row}");
            let text = said(&opruga(folder, &["replay", name, "--verify"]));
            assert!(text.contains(&format!("frame {frame},")) && text.contains("is the first that differs"), "{text}");
        }
    }
}

/// Parent folders of every output are made; if that fails, none is left behind.
#[test]
fn folders_around_outputs_are_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    summary(folder, &["run", "pressures", "--seconds=0.1", "--out=a/b/o", "--record=c/d/r"]);
    let output = opruga(folder, &["replay", "c/d/r", "--no-pictures", "--out=e/f/g"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(folder.join("a/b/o/summary.json").exists() && folder.join("e/f/g/diagnostics.csv").exists());
    std::fs::write(folder.join("file"), "x").expect("a file");
    let long = format!("new/{}", "x".repeat(300));
    for (option, path) in [("--out", "file/b/o"), ("--record", "file/d/r"), ("--out", &long)] {
        let output = opruga(folder, &["run", "pressures", "--seconds=0.1", "--no-pictures", option, path]);
        assert_eq!(code(&output), 4, "{}", said(&output));
        assert!(
            said(&output).contains("cannot be created") || said(&output).contains("error[write."),
            "{}",
            said(&output)
        );
        assert!(!folder.join("new").exists());
    }
}

/// Bodies that are added and removed, pulls, and parameters that are set are all part of the states. A run resumed from a checkpoint records the
/// rest.
#[test]
fn commands_and_resumed_runs_are_verified_too() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    summary(folder, &["run", "pressures", "--seconds", "0.2", "--out", "o"]);
    summary(folder, &["run", "--resume", "o/checkpoint", "--seconds", "0.5", "--out", "p", "--record", "r"]);
    let row = verified(folder, &[]);
    assert!(row["frames"]["first"].as_u64() > Some(0), "{row}");
    // Neither a file of the scene nor the scene itself is needed any more.
    let heart = opruga::scenes::find("heart").expect("a scene");
    std::fs::create_dir(folder.join("shapes")).expect("a folder");
    let drawing = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/heart.svg");
    std::fs::copy(drawing, folder.join("shapes/heart.svg")).expect("a drawing");
    std::fs::write(folder.join("mine.toml"), heart).expect("a scene");
    let run = summary(folder, &["run", "mine.toml", "--seconds", "0.4", "--out", "h", "--record", "r", "--force"]);
    std::fs::remove_dir_all(folder.join("shapes")).expect("it goes");
    std::fs::remove_file(folder.join("mine.toml")).expect("it goes");
    assert_eq!(verified(folder, &[])["state_hash"], run["state_hash"]);
    let shown = opruga(folder, &["replay", "r", "--no-pictures", "--json", "--out", "i"]);
    assert_eq!((code(&shown), &json(&shown)["state_hash"]), (0, &run["state_hash"]), "{}", said(&shown));
    // `ball` is pulled by a pointer.
    summary(folder, &["run", "ball", "--seconds", "4", "--out", "q", "--record", "r", "--force"]);
    verified(folder, &[]);
}

/// Rows 79 and 87: killed or interrupted at any moment, a run leaves a recording whose frames are intact and right.
#[test]
fn a_run_that_is_killed_leaves_its_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let mut most = 0;
    let rounds = 20u64;
    for round in 0..rounds {
        let arguments =
            ["run", "pressures", "--seconds", "1e5", "--no-pictures", "--out", "o", "--force", "--record", "r"];
        let _ = std::fs::remove_file(folder.join("r"));
        let mut child = program(folder, &arguments).spawn().expect("the program runs");
        until("no recording begins", || folder.join("r").exists());
        std::thread::sleep(Duration::from_micros(60_000 + round * 7_919_777 % 140_000));
        signal(&child, if round < rounds - 2 { "KILL" } else { "INT" });
        child.wait().expect("it ends");
        let output = opruga(folder, &["replay", "r", "--verify", "--json", "--to", "0.5"]);
        if code(&output) != 0 {
            assert!(said(&output).contains("recording.no_frame"), "{round}: {}", said(&output));
            continue;
        }
        let row = json(&output);
        let killed = row["warnings"].as_array().is_some_and(|w| w.iter().any(|w| w["code"] == "recording.open"));
        assert!(row["pass"] == true && killed == (round < rounds - 2), "{round}: {row}");
        most = most.max(row["frames"]["last"].as_u64().expect("a number"));
    }
    assert!(most >= 5, "frames reach the file on the way: {most}");
}

/// Rows 82 to 85: damage, other files and full disks are errors with their location; nothing old is lost.
#[test]
fn faults_of_recordings_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let run = ["run", "pressures", "--seconds", "0.5", "--no-pictures", "--out", "o", "--record", "r"];
    assert_eq!(code(&opruga(folder, &run)), 0);
    let good = std::fs::read(folder.join("r")).expect("a recording");
    let refused = |arguments: &[&str], expected: i32, text: &str| {
        let output = opruga(folder, arguments);
        assert_eq!(code(&output), expected, "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(text), "{arguments:?}: {}", said(&output));
    };
    let again = ["run", "pressures", "--seconds", "0.5", "--no-pictures", "--out", "p", "--record", "r"];
    refused(&again, 4, "error[write.exists]");
    assert!(std::fs::read(folder.join("r")).expect("a recording") == good);
    for place in [30, good.len() / 2, good.len() - 30, good.len() - 3] {
        let mut bad = good.clone();
        bad[place] ^= 4;
        std::fs::write(folder.join("bad"), bad).expect("a file");
        refused(&["replay", "bad", "--verify"], 2, "bad: error[recording.damaged]");
    }
    // A recording cannot be written to a full device, and a device is never replaced by one.
    if Path::new("/dev/full").exists() {
        refused(
            &["run", "pressures", "--no-pictures", "--out", "q", "--record", "/dev/full", "--force"],
            4,
            "error[write.",
        );
        assert!(!Path::new("/dev/full").is_file());
    }
    // The end is damaged, but the beginning can be replayed.
    assert_eq!(code(&opruga(folder, &["replay", "bad", "--verify", "--to", "0.1"])), 0);
    std::fs::write(folder.join("bad"), "notes").expect("a file");
    refused(&["replay", "bad"], 2, "error[recording.not_one]");
    refused(&["replay", "nowhere"], 4, "error[read.failed]");
    refused(&["replay", "."], 4, "error[read.not_regular_file]");
    refused(&["replay", "r", "--from", "9"], 2, "there is no frame from 9 s");
    refused(&["replay", "r", "--to", "nan"], 2, "--to is NaN; allowed: 0 to 1e9");
    refused(&["replay", "r", "--fps", "0"], 2, "--fps is 0");
    if Path::new("/dev/full").exists() {
        refused(&[&run[..5], &["--out", "f", "--record", "/dev/full", "--force"]].concat(), 4, "not a regular file");
    }
    // The disk becomes full during the run: the run ends with an error, and its state is kept.
    let call = format!(
        "ulimit -f 64; exec {} run pressures --no-pictures --out full --record s --record-every 1",
        env!("CARGO_BIN_EXE_opruga"),
    );
    let output = Command::new("bash").args(["-c", &call]).current_dir(folder).output().expect("a shell");
    assert_eq!(code(&output), 4, "{}", said(&output));
    assert!(said(&output).contains("s: error[write.failed]: writing stopped after 65536 bytes"), "{}", said(&output));
    assert!(said(&output).contains("--resume continues"), "{}", said(&output));
    assert!(folder.join("full/checkpoint").exists());
    refused(&["replay", "s", "--verify"], 0, "warning[recording.open]");
}

/// A file that is not a recording is refused before a window opens; without a screen the hint suggests `replay`.
#[test]
fn a_recording_is_viewed_in_a_window_only() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = ["run", "ball", "--seconds", "0.1", "--no-pictures", "--out", "o", "--record", "a.rec"];
    assert_eq!(code(&opruga(folder.path(), &run)), 0);
    let view = |file: &str| {
        let mut call = program(folder.path(), &["view", file]);
        call.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().expect("it runs")
    };
    for (file, exit, text) in [("o/summary.json", 2, "error["), ("none.rec", 4, "error[read.failed]")] {
        let output = view(file);
        assert_eq!(code(&output), exit, "{}", said(&output));
        assert!(said(&output).contains(text), "{}", said(&output));
    }
    if cfg!(target_os = "linux") {
        let output = view("a.rec");
        assert_eq!(code(&output), 2);
        assert!(said(&output).contains("= hint: `opruga replay a.rec` writes its pictures"), "{}", said(&output));
    }
}
