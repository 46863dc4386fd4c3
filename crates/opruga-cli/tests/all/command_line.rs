//! The program as its users see it: files, exit codes, errors, interruption.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

#[test]
fn a_run_writes_every_file_and_its_summary_keeps_the_contract() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = opruga(folder.path(), &["run", "pressures", "--seconds", "0.5", "--out", "o", "--json"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("stdout is JSON");
    for key in [
        "schema",
        "scene",
        "dimension",
        "bodies",
        "nodes",
        "elements",
        "models",
        "integrator",
        "frame",
        "substeps",
        "h",
        "steps",
        "time",
        "wall_seconds",
        "nanoseconds_per_node_step",
        "simd",
        "threads",
        "reproducibility",
        "energy",
        "momentum",
        "state_hash",
        "warnings",
        "files",
    ] {
        assert!(summary.get(key).is_some(), "summary.json lacks {key}");
    }
    for key in [
        "kinetic",
        "elastic",
        "gas",
        "gravity",
        "work_user",
        "loss_damping",
        "loss_friction",
        "loss_contact",
        "loss_numerical",
        "loss_integrator",
        "closure",
    ] {
        assert!(summary["energy"][key].is_number(), "energy lacks {key}");
    }
    assert_eq!(summary["schema"], 1);
    assert_eq!(summary["nodes"], 144);
    assert_eq!(summary["state_hash"].as_str().expect("a text").len(), 16);
    for file in summary["files"].as_array().expect("a list") {
        let path = folder.path().join("o").join(file.as_str().expect("a name"));
        assert!(path.metadata().expect("the file is there").len() > 0, "{}", path.display());
    }
    let table = std::fs::read_to_string(folder.path().join("o/diagnostics.csv")).expect("a table");
    assert_eq!(table.lines().count(), 1 + 31, "a head, the start and thirty frames");
    let last = std::fs::read_to_string(folder.path().join("o/final.csv")).expect("a table");
    assert_eq!(last.lines().next(), Some("body,node,x,y,vx,vy"));
    assert_eq!(last.lines().count(), 1 + 144);
}

#[test]
fn a_run_writes_a_film() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |arguments: &[&str], out: &str| {
        let output = opruga(folder.path(), &[arguments, &["--out", out, "--json"]].concat());
        assert_eq!(code(&output), 0, "{}", said(&output));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("stdout is JSON");
        let files = summary["files"].as_array().expect("a list").clone();
        let films: Vec<&str> =
            files.iter().filter_map(Value::as_str).filter(|file| file.starts_with("video")).collect();
        assert_eq!(films.len(), 1, "{films:?}");
        (films[0].to_string(), std::fs::read(folder.path().join(out).join(films[0])).expect("a film"))
    };
    let (name, film) = run(&["run", "pressures", "--seconds", "0.2"], "a");
    assert_eq!((name.as_str(), &film[4..8]), ("video.mp4", b"ftyp".as_slice()));
    assert_eq!(run(&["run", "pressures", "--seconds", "0.2", "--threads", "2"], "b").1, film, "the same bytes");
    assert_eq!(run(&["run", "pressures", "--seconds", "0"], "c").0, "video.mp4", "of one frame");
    let (name, film) = run(&["run", "pressures", "--seconds", "0.2", "--gif"], "d");
    assert_eq!((name.as_str(), &film[..4]), ("video.gif", b"GIF8".as_slice()));
}

#[test]
fn zero_seconds_write_the_state_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = opruga(folder.path(), &["run", "pressures", "--seconds", "0", "--out", "o", "--no-pictures"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let last = std::fs::read_to_string(folder.path().join("o/final.csv")).expect("a table");
    let first = last.lines().nth(1).expect("a row");
    let cells: Vec<&str> = first.split(',').collect();
    assert_eq!(cells[0], "soft");
    assert_eq!(cells[2].parse::<f64>(), Ok(0.5), "node 0 starts on the right");
}

#[test]
fn a_resumed_run_ends_with_the_bits_of_an_uninterrupted_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let hash = |arguments: &[&str]| {
        let output = opruga(folder.path(), arguments);
        assert_eq!(code(&output), 0, "{}", said(&output));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("stdout is JSON");
        summary["state_hash"].as_str().expect("a text").to_string()
    };
    let set = "time.substeps=48";
    let whole = hash(&["run", "pressures", "--seconds", "1", "--out", "a", "--no-pictures", "--json", "--set", set]);
    hash(&["run", "pressures", "--seconds", "0.5", "--out", "b", "--no-pictures", "--json", "--set", set]);
    let resume = ["run", "--resume", "b/checkpoint", "--seconds", "1", "--out", "c", "--no-pictures", "--json"];
    assert_eq!(hash(&resume), whole);
    let threads = [
        "run",
        "--resume",
        "b/checkpoint",
        "--seconds",
        "1",
        "--out",
        "d",
        "--no-pictures",
        "--json",
        "--threads",
        "3",
    ];
    assert_eq!(hash(&threads), whole);
}

#[test]
fn errors_have_their_exit_codes_and_leave_old_files_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |arguments: &[&str]| opruga(folder.path(), arguments);
    std::fs::write(folder.path().join("bad.toml"), "format = \"opruga-1\"\ndimension = 2\nstifness = 3\n")
        .expect("a file");
    let bad = at(&["run", "bad.toml", "--out", "o"]);
    assert_eq!(code(&bad), 2);
    assert!(said(&bad).contains("bad.toml:3:1"), "{}", said(&bad));
    let json = at(&["check", "bad.toml", "--json"]);
    assert_eq!(code(&json), 2);
    let error: Value = serde_json::from_slice(&json.stderr).expect("stderr is JSON");
    for key in ["code", "message", "file", "line", "column", "path", "value", "allowed", "hint"] {
        assert!(error.get(key).is_some(), "the error lacks {key}");
    }
    // Missing parts of an error are null.
    for (arguments, absent) in [
        (&["run", "ball", "--fps", "-3", "--json"][..], &["file", "line", "column", "path", "value"][..]),
        (&["check", "bad.toml", "--json"], &[]),
    ] {
        let output = at(arguments);
        let error: Value = serde_json::from_slice(&output.stderr).expect("stderr is JSON");
        assert!(absent.iter().all(|key| error[key].is_null()), "{arguments:?}: {error}");
        assert!(error.as_object().expect("an object").values().all(|value| value != ""), "{arguments:?}: {error}");
    }
    assert_eq!(code(&at(&["run", "nothing-of-that-name"])), 4);
    assert!(said(&at(&["run", "presures"])).contains("did you mean `pressures`"));
    assert_eq!(code(&at(&["run", "--fps", "-3"])), 2);
    assert_eq!(code(&at(&["run", "--threads", "0"])), 2);
    assert_eq!(code(&at(&["run", "--threads", "257"])), 2);
    assert_eq!(code(&at(&["bananas"])), 2);
    assert_eq!(code(&at(&["--help"])), 0);
    assert_eq!(code(&at(&["--version"])), 0);

    assert_eq!(code(&at(&["run", "pressures", "--seconds", "0.1", "--out", "o", "--no-pictures"])), 0);
    let before = std::fs::read(folder.path().join("o/final.csv")).expect("a file");
    let again = at(&["run", "pressures", "--seconds", "0.2", "--out", "o", "--no-pictures"]);
    assert_eq!(code(&again), 4);
    assert!(said(&again).contains("--force"), "{}", said(&again));
    assert_eq!(std::fs::read(folder.path().join("o/final.csv")).expect("a file"), before);
    let unstable = at(&["run", "pressures", "--set", "time.substeps=1", "--out", "u", "--no-pictures"]);
    assert_eq!(code(&unstable), 2);
    assert!(said(&unstable).contains("substeps >="), "{}", said(&unstable));
    let diverged =
        at(&["run", "pressures", "--set", "time.substeps=1", "--out", "v", "--no-pictures", "--allow-unstable"]);
    assert_eq!(code(&diverged), 3);
    assert!(said(&diverged).contains("node"), "{}", said(&diverged));
}

#[test]
fn a_new_scene_runs_and_is_not_overwritten() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(code(&opruga(folder.path(), &["new", "mine"])), 0);
    assert_eq!(code(&opruga(folder.path(), &["check", "mine.toml"])), 0);
    assert_eq!(code(&opruga(folder.path(), &["new", "mine"])), 4);
    let run = opruga(folder.path(), &["run", "mine.toml", "--seconds", "0.2", "--out", "o"]);
    assert_eq!(code(&run), 0, "{}", said(&run));
}

#[test]
fn lists_and_references_are_data_on_stdout() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = opruga(folder.path(), &["list", "--json"]);
    let value: Value = serde_json::from_slice(&list.stdout).expect("JSON");
    let kinds = |section: &str| value[section].as_array().expect("a list").len();
    assert!(kinds("models") >= 2 && kinds("integrators") >= 5 && kinds("shapes") >= 7 && kinds("scenes") >= 10);
    let reference = printed(&opruga(folder.path(), &["reference"]));
    assert!(reference.contains("mass_spring") && reference.contains("nRT"));
    let schema = opruga(folder.path(), &["reference", "--schema"]);
    let schema: Value = serde_json::from_slice(&schema.stdout).expect("JSON");
    assert!(schema["$schema"].as_str().is_some_and(|s| s.contains("2020-12")));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut child = Command::new(env!("CARGO_BIN_EXE_opruga"))
        .arg("reference")
        .current_dir(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stdout.take());
    let status = child.wait_with_output().expect("it ends");
    assert_eq!(status.status.code(), Some(0));
    assert!(!said(&status).contains("panicked"));
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_closes_its_files_and_says_so() {
    for (scene, more) in [("thousand-balls", &["--no-pictures"][..]), ("ball", &[])] {
        let folder = tempfile::tempdir().expect("a folder");
        let child = Command::new(env!("CARGO_BIN_EXE_opruga"))
            .args(["run", scene, "--seconds", "100000", "--out", "o"])
            .args(more)
            .current_dir(folder.path())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program runs");
        std::thread::sleep(std::time::Duration::from_millis(1500));
        let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{}", said(&output));
        let there = |file: &str| folder.path().join("o").join(file).metadata().is_ok_and(|m| m.len() > 0);
        for file in ["summary.json", "final.csv", "diagnostics.csv", "checkpoint"] {
            assert!(there(file), "{scene}: {file}");
        }
        let pictured = more.is_empty();
        assert_eq!((there("strip.png"), there("video.mp4")), (pictured, false), "{scene}");
        assert_eq!(said(&output).contains("no video, because the run was interrupted"), pictured, "{}", said(&output));
    }
}

/// Starts work on frames of a million steps with 100,000 vertices, each of which takes minutes. Returns when a file of the work exists.
#[cfg(unix)]
fn in_a_long_frame(folder: &Path, arguments: &[&str], file: &str) -> std::process::Child {
    let child = Command::new(env!("CARGO_BIN_EXE_opruga"))
        .args(arguments)
        .args(["--out", "o"])
        .current_dir(folder)
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    while !folder.join("o").join(file).exists() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    child
}

#[cfg(unix)]
fn interrupt(child: &std::process::Child) {
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill runs");
}

#[cfg(unix)]
#[test]
fn a_signal_ends_a_long_frame_of_a_run_and_keeps_the_frames_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let call = ["run", "giant-ring", "--set", "time.substeps=1000000", "--no-pictures"];
    let child = in_a_long_frame(folder.path(), &call, "diagnostics.csv");
    interrupt(&child);
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(said(&output).contains("the files are closed"), "{}", said(&output));
    let summary = std::fs::read(folder.path().join("o/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_slice(&summary).expect("JSON");
    assert_eq!(summary["time"], 0.0, "the frame has not ended");
}

#[cfg(unix)]
#[test]
fn a_second_signal_ends_a_long_frame_of_a_sweep_at_once() {
    use std::io::{BufRead as _, BufReader};
    let call = ["sweep", "giant-ring", "--set", "time.substeps=1000000,2000000", "--metric=energy_drift"];
    // The first frame begins when the world is built, and nothing shows this.
    for seconds in [1, 2, 4, 8, 16] {
        let folder = tempfile::tempdir().expect("a folder");
        let mut child = in_a_long_frame(folder.path(), &call, "results.csv");
        std::thread::sleep(std::time::Duration::from_secs(seconds));
        interrupt(&child);
        let mut lines = BufReader::new(child.stderr.take().expect("piped")).lines().map_while(Result::ok);
        let goes_on = lines.any(|line| line.contains("a second interrupt"));
        interrupt(&child);
        assert_eq!(child.wait().expect("it ends").code(), Some(130));
        assert!(!lines.any(|line| line.contains("points are done")), "it has not waited for its step");
        if goes_on {
            return;
        }
    }
    panic!("it says that it goes on");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_of_writing() {
    let folder = tempfile::tempdir().expect("a folder");
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
    let output = Command::new(env!("CARGO_BIN_EXE_opruga"))
        .args(["reference"])
        .current_dir(folder.path())
        .stdout(full)
        .output()
        .expect("the program runs");
    assert_eq!(output.status.code(), Some(4), "{}", said(&output));
}

/// A kind that exists in the plane and in space occurs once: links to headings have one target, and a table matches one of the alternatives of the
/// schema.
#[test]
fn every_kind_stands_once_in_the_reference_and_in_the_schema() {
    let folder = tempfile::tempdir().expect("a folder");
    let reference = printed(&opruga(folder.path(), &["reference"]));
    let mut headings: Vec<&str> = reference.lines().filter(|line| line.starts_with('#')).collect();
    headings.sort_unstable();
    assert!(headings.windows(2).all(|pair| pair[0] != pair[1]), "{headings:?}");
    let half_space = reference.split("### Collider `kind = \"half_space\"`").nth(1).expect("an obstacle");
    let half_space = half_space.split("\n### ").next().expect("its section");
    assert!(!half_space.contains("D only"), "{half_space}");
    assert_eq!(half_space.matches("| `spin` (").count(), 2, "a number and a vector: {half_space}");

    fn alternatives(value: &Value, visit: &mut dyn FnMut(&[Value])) {
        match value {
            Value::Object(fields) => {
                if let Some(Value::Array(tables)) = fields.get("oneOf") {
                    visit(tables);
                }
                fields.values().for_each(|value| alternatives(value, visit));
            }
            Value::Array(items) => items.iter().for_each(|item| alternatives(item, visit)),
            _ => {}
        }
    }
    let schema: Value =
        serde_json::from_str(&printed(&opruga(folder.path(), &["reference", "--schema"]))).expect("JSON");
    let mut seen = 0;
    alternatives(&schema, &mut |tables| {
        let mut kinds: Vec<&str> = tables.iter().filter_map(|t| t["properties"]["kind"]["const"].as_str()).collect();
        seen += kinds.len();
        kinds.sort_unstable();
        assert!(kinds.windows(2).all(|pair| pair[0] != pair[1]), "{kinds:?}");
    });
    assert!(seen > 40, "{seen} kinds");
}

/// The pages of the scene format in `docs/` are what the program prints: `opruga reference > docs/scene-file.md` and
/// `opruga reference --schema > docs/scene.schema.json`.
#[test]
fn the_reference_in_the_documents_is_what_the_program_prints() {
    let documents = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    for (arguments, file) in [(&["reference"][..], "scene-file.md"), (&["reference", "--schema"], "scene.schema.json")]
    {
        let printed = opruga(&documents, arguments);
        assert!(printed.status.success());
        let kept = std::fs::read(documents.join(file)).expect("a page in docs/");
        assert!(
            printed.stdout == kept,
            "docs/{file} is out of date: write what `opruga {}` prints",
            arguments.join(" ")
        );
    }
}

#[test]
fn bodies_that_commands_add_have_columns_of_their_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.5\n[integrator]\nkind = \"verlet\"\n\
        [[body]]\nname = \"first\"\nmass = 1\nshape = { kind = \"ring\", radius = 0.5, vertices = 12 }\n\
        models = [{ kind = \"pressure\", nRT = 1.0 }]\n\
        [[command]]\ndo = \"add\"\nat = 0.2\nbody = { name = \"late\", mass = 1, position = [3, 0], integrator = \"heun\", \
        shape = { kind = \"ring\", radius = 1, vertices = 12 }, models = [{ kind = \"pressure\", nRT = 1.0 }] }\n\
        [[command]]\ndo = \"remove\"\nat = 0.4\nbody = \"late\"\n";
    std::fs::write(folder.path().join("s.toml"), scene).expect("a scene");
    let output = opruga(folder.path(), &["run", "s.toml", "--out", "o", "--no-pictures", "--json", "--allow-unstable"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let summary: Value = serde_json::from_slice(&output.stdout).expect("stdout is JSON");
    assert!(summary["energy"]["work_correction"].is_number());
    let table = std::fs::read_to_string(folder.path().join("o/diagnostics.csv")).expect("a table");
    let mut lines = table.lines();
    let head: Vec<&str> = lines.next().expect("a head").split(',').collect();
    let place = head.iter().position(|c| *c == "late.volume").expect("a column of its own");
    assert!(head.contains(&"first.volume") && head.contains(&"late.pressure") && head.contains(&"work_correction"));
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|c| c.parse().expect("a number")).collect();
        let there = (0.2..0.4).contains(&(cells[0] - 1.0 / 60.0 + 1e-9));
        assert_eq!(cells[place].is_finite(), there, "t = {}: {}", cells[0], cells[place]);
        assert!(!there || (cells[place] - 3.0).abs() < 1.0, "an area of nearly 3 m²");
    }
}

/// The fields of the scene's integrator that statics does not have are dropped, the others are kept.
#[test]
fn modes_about_the_equilibrium_keep_what_statics_understands() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\n[integrator]\nkind = \"bdf2\"\naccuracy = \"real_time\"\n\
        iterations = 1\nwhen_not_converged = \"halve\"\n[[body]]\nname = \"bar\"\nmass = 1.0\n\
        shape = { kind = \"line\", from = [0.0, 0.0], to = [1.0, 0.0], segments = 4 }\n\
        models = [{ kind = \"mass_spring\", stiffness = 100.0 }]\npin = [{ select = { nodes = [0, 4] } }]\n\
        [world]\ngravity = [0.0, -9.81]\n";
    std::fs::write(folder.path().join("bar.toml"), scene).expect("a file");
    let call = |set: &str| {
        opruga(
            folder.path(),
            &["modes", "bar.toml", "-n", "2", "--equilibrium", "--json", "--force", "--out", "o", "--set", set],
        )
    };
    // One iteration is not enough from the straight line to the hanging chain.
    let refused = call("integrator.iterations=1");
    assert!(code(&refused) != 0 && said(&refused).contains("did not converge in 1 iteration at"), "{}", said(&refused));
    let output = call("integrator.iterations=200");
    assert_eq!(code(&output), 0, "{}", said(&output));
}
