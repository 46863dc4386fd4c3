//! External faults and the guarantees of the program: exit codes, texts, and that nothing old is lost. The numbers are rows of the torture list:
//! 16–18 sizes, 49–58 parameters, 79–88 files and signals.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

const SHORT: [&str; 6] = ["run", "pressures", "--seconds", "0.1", "--no-pictures", "--out"];

/// A run that lasts until it is ended; returns once it is stepping.
fn endless(folder: &Path, more: &[&str]) -> Child {
    let arguments = [&["run", "thousand-balls", "--seconds", "1e6", "--no-pictures"], more].concat();
    let child = program(folder, &arguments).spawn().expect("the program runs");
    let out = more.iter().position(|m| *m == "--out").map(|k| folder.join(more[k + 1])).expect("--out");
    let start = Instant::now();
    while !out.join(".opruga-lock").exists() {
        assert!(start.elapsed() < Duration::from_secs(30), "the run does not begin");
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_millis(700));
    child
}

/// Rows 79 and 80: if a run is killed, earlier files stay intact, and the next run needs no cleaning up.
#[cfg(unix)]
#[test]
fn kill_9_leaves_old_files_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["o"]].concat())), 0);
    let before = contents(&folder.path().join("o"));
    for _ in 0..3 {
        let mut child = endless(folder.path(), &["--out", "o", "--force"]);
        signal(&child, "KILL");
        child.wait().expect("it ends");
        assert_eq!(contents(&folder.path().join("o")), before);
    }
    // A resumed run does not replace the files that it was resumed from, unless asked to.
    let resumed = ["run", "--resume", "o/checkpoint", "--seconds", "0.2", "--no-pictures", "--out", "o"];
    assert_eq!(code(&opruga(folder.path(), &resumed)), 4);
    assert_eq!(contents(&folder.path().join("o")), before);
    let output = opruga(folder.path(), &[&resumed[..], &["--force"]].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
}

/// Row 82: a damaged checkpoint is refused with its name; the folder stays as it was.
#[test]
fn damaged_checkpoints_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["o"]].concat())), 0);
    let good = std::fs::read(folder.path().join("o/checkpoint")).expect("a checkpoint");
    let bad = folder.path().join("bad");
    let cases: Vec<(Vec<u8>, &str)> = vec![
        (good[..good.len() / 2].to_vec(), "error[checkpoint."),
        (
            good.iter().enumerate().map(|(k, b)| if k == good.len() / 3 { b ^ 4 } else { *b }).collect(),
            "error[checkpoint.",
        ),
        (b"PK\x03\x04 this is an archive".to_vec(), "error[checkpoint."),
        (Vec::new(), "error[checkpoint."),
    ];
    let before = contents(&folder.path().join("o"));
    for (bytes, text) in cases {
        std::fs::write(&bad, &bytes).expect("a file");
        let output = opruga(folder.path(), &["run", "--resume", "bad", "--out", "o", "--no-pictures"]);
        assert_eq!(code(&output), 2, "{}", said(&output));
        assert!(said(&output).starts_with("bad: ") && said(&output).contains(text), "{}", said(&output));
        assert_eq!(contents(&folder.path().join("o")), before);
    }
    for (path, text) in [("nowhere", "error[read.failed]"), (".", "error[read.not_regular_file]")] {
        let output = opruga(folder.path(), &["run", "--resume", path, "--out", "p", "--no-pictures"]);
        assert_eq!(code(&output), 4, "{}", said(&output));
        assert!(said(&output).contains(text), "{}", said(&output));
    }
}

/// Row 83: the disk is full at any file, simulated by a limit of file sizes.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_half_file() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["o"]].concat())), 0);
    let before = contents(&folder.path().join("o"));
    let longer = ["run", "pressures", "--seconds", "0.3", "--no-pictures", "--out"];
    assert_eq!(code(&opruga(folder.path(), &[&longer[..], &["whole"]].concat())), 0);
    let after = contents(&folder.path().join("whole"));
    for kilobytes in [0, 1, 2, 4, 8] {
        let call =
            format!("ulimit -f {kilobytes}; exec {} {} o --force", env!("CARGO_BIN_EXE_opruga"), longer.join(" "));
        let output = Command::new("bash").args(["-c", &call]).current_dir(folder.path()).output().expect("a shell");
        assert_eq!(code(&output), 4, "{kilobytes}: {}", said(&output));
        assert!(said(&output).contains("error[write."), "{}", said(&output));
        assert!(!said(&output).contains("panicked"), "{}", said(&output));
        // Every name is a complete file, no temporary file is left, and files of two runs are never mixed.
        let now = contents(&folder.path().join("o"));
        assert!(!now.is_empty());
        let names: Vec<&str> = now.iter().map(|file| file.0.as_str()).collect();
        let of = |run: &[(String, Vec<u8>)]| now.iter().all(|file| run.contains(file));
        assert!(now == before || of(&after), "{kilobytes}: {names:?} are neither the old run's nor the new one's");
    }
    // A device that is full, if the system has one.
    if Path::new("/dev/full").exists() {
        for arguments in [&["reference"][..], &["list"], &["list", "--json"], &["--help"]] {
            let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
            let output = program(folder.path(), arguments).stdout(full).output().expect("the program runs");
            assert!([0, 4].contains(&code(&output)) && !said(&output).contains("panicked"), "{arguments:?}");
        }
        let full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a full device");
        let arguments = ["run", "pressures", "--seconds", "0.1", "--no-pictures", "--json", "--out", "full"];
        let output = program(folder.path(), &arguments).stdout(full).output().expect("the program runs");
        assert_eq!(code(&output), 4, "{}", said(&output));
        assert!(folder.path().join("full/summary.json").exists(), "the files are there all the same");
    }
}

/// Row 84: paths that cannot be written are found before the run, within a second for a scene that would take hours.
#[test]
fn bad_output_paths_are_found_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("file"), b"x").expect("a file");
    let long = "x".repeat(300);
    let mut cases = vec![
        ("file", "this is a file, not a folder"),
        ("file/out", "error[write.folder]"),
        (long.as_str(), "error[write.folder]"),
    ];
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).expect("a folder");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).expect("permissions");
    }
    // A user who may write everywhere (root) is not stopped by permissions.
    let trial = locked.join("trial");
    if std::fs::write(&trial, b"x").is_err() {
        cases.push(("locked", "error[write.folder]"));
        cases.push(("locked/out", "error[write.folder]"));
    } else {
        let _ = std::fs::remove_file(trial);
    }
    if Path::new("/proc/self").exists() {
        cases.push(("/proc/opruga", "error[write.folder]"));
    }
    for (path, text) in cases {
        let start = Instant::now();
        let output =
            opruga(folder.path(), &["run", "thousand-balls", "--seconds", "1e6", "--no-pictures", "--out", path]);
        assert_eq!(code(&output), 4, "{path}: {}", said(&output));
        assert!(said(&output).contains(text), "{path}: {}", said(&output));
        assert!(start.elapsed() < Duration::from_secs(5), "{path}");
    }
}

/// Row 85: without --force, all existing files stay, and the message explains how to continue.
#[test]
fn old_output_is_not_replaced_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["o"]].concat())), 0);
    let before = contents(&folder.path().join("o"));
    let output = opruga(folder.path(), &[&SHORT[..], &["o"]].concat());
    assert_eq!(code(&output), 4);
    assert_eq!(
        said(&output),
        "o: error[write.exists]: the folder already contains 4 files, among them checkpoint\n  \
         = hint: use --force to replace them, or choose another folder\n"
    );
    assert_eq!(contents(&folder.path().join("o")), before);
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["o", "--force"]].concat())), 0);
    // A foreign file in the folder is not our output, but it belongs to somebody.
    std::fs::create_dir(folder.path().join("p")).expect("a folder");
    std::fs::write(folder.path().join("p/thesis.tex"), b"years of work").expect("a file");
    let output = opruga(folder.path(), &[&SHORT[..], &["p"]].concat());
    assert_eq!(code(&output), 4);
    assert!(said(&output).contains("already contains thesis.tex"), "{}", said(&output));
    assert_eq!(contents(&folder.path().join("p")).len(), 1, "nothing of ours is left beside it");
    assert_eq!(code(&opruga(folder.path(), &[&SHORT[..], &["p", "--force"]].concat())), 0);
    assert_eq!(std::fs::read(folder.path().join("p/thesis.tex")).expect("still there"), b"years of work");
}

/// Rows 86 and 87: two runs in one folder; SIGINT, SIGTERM and SIGHUP close the files, also of a resumed run.
#[cfg(unix)]
#[test]
fn signals_close_the_files_and_a_folder_has_one_writer() {
    let folder = tempfile::tempdir().expect("a folder");
    for name in ["INT", "TERM", "HUP"] {
        let child = endless(folder.path(), &["--out", name]);
        let second = opruga(folder.path(), &[&SHORT[..], &[name]].concat());
        assert_eq!(code(&second), 4);
        assert!(
            said(&second).contains("error[write.locked]: another process is writing into this folder"),
            "{}",
            said(&second)
        );
        signal(&child, name);
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{name}: {}", said(&output));
        assert!(said(&output).contains("interrupted; the files are closed"), "{}", said(&output));
        for file in ["summary.json", "final.csv", "diagnostics.csv", "checkpoint"] {
            assert!(folder.path().join(name).join(file).metadata().is_ok_and(|m| m.len() > 0), "{name}: {file}");
        }
        let summary = std::fs::read(folder.path().join(name).join("summary.json")).expect("a summary");
        let summary: Value = serde_json::from_slice(&summary).expect("JSON");
        let time = summary["time"].as_f64().expect("a time");
        assert!(time > 0.0);
        let (checkpoint, end) = (format!("{name}/checkpoint"), format!("{}", time + 0.05));
        let resume =
            ["run", "--resume", &checkpoint, "--seconds", &end, "--no-pictures", "--json", "--out", "r", "--force"];
        let output = opruga(folder.path(), &resume);
        assert_eq!(code(&output), 0, "{}", said(&output));
    }
}

/// Row 87: the reader closes the pipe.
#[test]
fn closed_pipes_are_no_failure() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: [&[&str]; 5] = [
        &["reference"],
        &["reference", "--schema"],
        &["list"],
        &["list", "--json"],
        &["run", "pressures", "--seconds", "0.1", "--no-pictures", "--json", "--out", "o"],
    ];
    for arguments in cases {
        let mut child = program(folder.path(), arguments).spawn().expect("the program runs");
        drop(child.stdout.take());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", said(&output));
        assert!(!said(&output).contains("panicked"), "{}", said(&output));
    }
    // Messages that nobody reads.
    let mut child = program(folder.path(), &["run", "presures"]).spawn().expect("the program runs");
    drop(child.stderr.take());
    assert_eq!(child.wait().expect("it ends").code(), Some(4));
}

/// Rows 4, 9 and 18: the cost of a scene is reported before anything is allocated: at once, and with little memory.
#[test]
fn limits_are_checked_before_memory_is_taken() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = |body: &str| {
        format!(
            "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n\
             [[body]]\nname = \"b\"\nmass = 1\n{body}\n"
        )
    };
    let cases = [
        (scene("shape = { kind = \"ring\", radius = 1, vertices = 1000000000000 }"), "`vertices` is 1000000000000"),
        (scene("shape = { kind = \"ring\", radius = 1, vertices = 4000000000 }"), "b.toml:10:"),
        (
            scene(
                "shape = { kind = \"ring\", radius = 1, vertices = 1000000 }\ncopies = { count = [1000, 1000], spacing = [1, 1] }",
            ),
            "error[limit.nodes]: the scene has 1000000000000 nodes or more",
        ),
        (
            scene(
                "shape = { kind = \"ring\", radius = 1, vertices = 50000 }\ncopies = { count = [3000], spacing = [1, 1] }",
            ),
            "error[limit.memory]: the scene would need at least about 18028000000 bytes",
        ),
        (
            scene(
                "shape = { kind = \"ring\", radius = 1, vertices = 8 }\ncopies = { count = [4000000000, 4000000000], spacing = [1, 1] }",
            ),
            "error[limit.bodies]: the scene has 16000000000000000000 bodies or more",
        ),
        (scene("shape = { kind = \"grid\", size = [1, 1], cells = [4000000000, 4000000000] }"), "b.toml:10:"),
        (
            scene("shape = { kind = \"icosphere\", radius = 1, subdivisions = 2, filling = \"tetrahedra\", spacing = 1e-9 }")
                .replace("dimension = 2", "dimension = 3"),
            "error[limit.nodes]: the scene has 8e27 nodes or more",
        ),
    ];
    for (text, expected) in cases {
        std::fs::write(folder.path().join("b.toml"), &text).expect("a file");
        let start = Instant::now();
        // Only 1 GiB of address space is available.
        let output = if cfg!(target_os = "linux") {
            let call = format!("ulimit -v 1048576; exec {} run b.toml --out o", env!("CARGO_BIN_EXE_opruga"));
            Command::new("bash").args(["-c", &call]).current_dir(folder.path()).output().expect("a shell")
        } else {
            opruga(folder.path(), &["run", "b.toml", "--out", "o"])
        };
        assert_eq!(code(&output), 2, "{}", said(&output));
        assert!(said(&output).contains(expected), "{}", said(&output));
        assert!(said(&output).contains("= allowed: "), "{}", said(&output));
        assert!(start.elapsed() < Duration::from_secs(5));
        assert!(!folder.path().join("o").exists(), "nothing is made for a scene that is refused");
    }
}

/// Rows 49, 50, 56 and invalid calls: exit code 2 and the text.
#[test]
fn calls_that_make_no_sense_are_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |set: &'static str| vec!["run", "pressures", "--no-pictures", "--out", "o", "--set", set];
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (run("time.frame=0"), "error[scene.range]: `frame` is 0"),
        (run("time.frame=1e-18"), "time would not advance"),
        (
            run("time.frame=1e6"),
            "error[step.unstable]: the step h = 25000 s of `symplectic_euler` is unstable for body `soft`",
        ),
        // The number of substeps that it would need is too large to be offered.
        (
            run("time.frame=1e6"),
            "= hint: a frame has at most 1000000 substeps: use a shorter frame, a softer or heavier body, or another integrator",
        ),
        (run("time.substeps=1"), "error[step.unstable]: the step h = 0.0166667 s"),
        (run("time.seconds=1e300"), "error[scene.range]"),
        (run("world.gravity=[0, nan]"), "error[scene.not_finite]"),
        (run("world.gravity=[0]"), "error[scene.length]"),
        (
            run("body.soft.models.mass_spring.stiffness=1e300"),
            "error[step.not_finite]: body `soft`: stability: the forces",
        ),
        (run("body.soft.models.pressure.nRT=-1"), "= allowed: a number >= 0"),
        (run("body.soft.models.pressure.gamma=0.9"), "error[scene.range]: `gamma` is 0.9"),
        (run("body.sof.mass=1"), "= hint: did you mean `soft`?"),
        (run("mass"), "error[set.syntax]: `mass` is not an override"),
        (vec!["run", "pressures", "--seconds", "nan"], "--seconds"),
        (vec!["run", "pressures", "--seconds", "1e99"], "allowed: 0 to 1e9"),
        (vec!["run", "--threads", "-1"], "error: invalid value '-1' for '--threads <THREADS>': -1 is not in 1..=256"),
        (vec!["run", "--seconds", "-1"], "error: --seconds is -1; allowed: 0 to 1e9"),
        (vec!["run", "--fps", "-1"], "error: --fps is -1; allowed: numbers above 0, at most 240"),
        (vec!["run", "--thread", "2"], "--threads"),
        (vec!["bench", "vertices", "--threads", "1000"], "1000"),
    ];
    for (arguments, text) in cases {
        let start = Instant::now();
        let output = opruga(folder.path(), &arguments);
        assert_eq!(code(&output), 2, "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(text), "{arguments:?}: {}", said(&output));
        assert!(!said(&output).contains("panicked") && start.elapsed() < Duration::from_secs(10), "{arguments:?}");
        assert!(!folder.path().join("o").join("summary.json").exists());
    }
}

/// If bodies are removed or added later, the columns of the others stay where they are, to the end of the table.
#[test]
fn columns_stay_apart_when_bodies_come_and_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let ring = "shape = { kind = \"ring\", radius = 0.5, vertices = 12 }\nmass = 1\n";
    let text = format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.2\n[integrator]\nkind = \"verlet\"\n\
         [[body]]\nname = \"a\"\n{ring}models = [{{ kind = \"pressure\", nRT = 1.0 }}]\n\
         [[body]]\nname = \"b\"\n{ring}position = [5, 0]\nmodels = [{{ kind = \"pressure\", nRT = 2.0 }}]\n\
         [[command]]\ndo = \"remove\"\nat = 0.05\nbody = \"a\"\n[[command]]\ndo = \"remove\"\nat = 0.15\nbody = \"b\"\n\
         [[command]]\ndo = \"add\"\nat = 0.1\nbody = {{ name = \"c\", shape = {{ kind = \"ring\", radius = 1, vertices = 8 }}, mass = 1, \
         models = [{{ kind = \"pressure\", nRT = 3.0 }}], position = [9, 9] }}\n\
         [[probe]]\nname = \"p\"\nbody = \"a\"\nrecord = [\"position\"]\n[[probe]]\nname = \"q\"\nbody = \"b\"\nrecord = [\"position\"]\n"
    );
    std::fs::write(folder.path().join("s.toml"), text).expect("a file");
    let output = opruga(folder.path(), &["run", "s.toml", "--out", "o"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let table = std::fs::read_to_string(folder.path().join("o/diagnostics.csv")).expect("a table");
    let rows: Vec<Vec<&str>> = table.lines().map(|l| l.split(',').collect()).collect();
    let column =
        |name: &str| rows[0].iter().position(|c| *c == name).unwrap_or_else(|| panic!("{name}: {:?}", rows[0]));
    let number = |row: usize, name: &str| rows[row][column(name)].parse::<f64>().unwrap_or(f64::NAN);
    assert!(rows.iter().all(|r| r.len() == rows[0].len()));
    assert_eq!(rows.len(), 1 + 13);
    assert!(number(1, "p.x").abs() < 1e-9 && (number(1, "q.x") - 5.0).abs() < 1e-9);
    // From 0.05 s on `a` does not exist, from 0.15 s on `b` exists.
    let (middle, last) = (8, 13);
    assert!(number(middle, "p.x").is_nan() && (number(middle, "q.x") - 5.0).abs() < 1e-9);
    assert!(number(middle, "a.volume").is_nan() && number(middle, "b.volume") > 0.7);
    assert!(number(last, "q.x").is_nan() && number(last, "b.volume").is_nan());
}

/// Row 88: the length of a run and its results are determined by the scene, not by a clock; row 81 with commands that change the scene during the
/// run, through the checkpoint.
#[test]
fn a_resumed_run_knows_what_commands_have_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nsubsteps = 40\n[integrator]\nkind = \"verlet\"\n\
         [world]\ngravity = [0, -9.81]\n[[body]]\nname = \"a\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 24 }\nmass = 1\n\
         models = [{ kind = \"mass_spring\", stiffness = 900.0, damping = 1.0 }, { kind = \"pressure\", nRT = 20.0 }]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, -1]\nnormal = [0, 1]\n\
         [[command]]\ndo = \"set\"\nat = 0.2\npath = \"body.a.models.pressure.nRT\"\nvalue = 45\n\
         [[command]]\ndo = \"set\"\nat = 0.3\npath = \"collider.0.friction\"\nvalue = 0.7\n\
         [[command]]\ndo = \"add\"\nat = 0.4\nbody = { name = \"c\", shape = { kind = \"ring\", radius = 0.3, vertices = 8 }, mass = 1, \
         models = [{ kind = \"mass_spring\", stiffness = 100.0 }], position = [2, 0], velocity = [1, 0] }\n";
    std::fs::write(folder.path().join("s.toml"), text).expect("a file");
    let hash = |arguments: &[&str]| {
        let output = opruga(folder.path(), &[arguments, &["--no-pictures", "--json"]].concat());
        assert_eq!(code(&output), 0, "{}", said(&output));
        let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        summary["state_hash"].as_str().expect("a text").to_string()
    };
    let whole = hash(&["run", "s.toml", "--out", "w"]);
    for (k, at) in ["0.1", "0.25", "0.35", "0.6"].into_iter().enumerate() {
        let (half, rest) = (format!("h{k}"), format!("r{k}"));
        hash(&["run", "s.toml", "--seconds", at, "--out", &half]);
        let checkpoint = format!("{half}/checkpoint");
        let threads = ["1", "2", "3", "8"][k];
        let resumed = hash(&["run", "--resume", &checkpoint, "--seconds", "1", "--threads", threads, "--out", &rest]);
        assert_eq!(resumed, whole, "interrupted at {at} s");
    }
}

/// Row 17: a scene without bodies, and one that loses all of them, run with pictures; time passes, and the energy is zero.
#[test]
fn scenes_without_bodies_run() {
    let folder = tempfile::tempdir().expect("a folder");
    for dimension in [2, 3] {
        let head = format!(
            "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 0.2\n[integrator]\nkind = \"verlet\"\n"
        );
        let shape = if dimension == 2 {
            "{ kind = \"ring\", radius = 1, vertices = 8 }"
        } else {
            "{ kind = \"icosphere\", radius = 1, subdivisions = 1 }"
        };
        let lost = format!(
            "{head}[[body]]\nname = \"b\"\nmass = 1\nshape = {shape}\nmodels = [{{ kind = \"pressure\", nRT = 1.0 }}]\n\
             [[command]]\ndo = \"remove\"\nat = 0.1\nbody = \"b\"\n"
        );
        for (name, text) in [("none", &head), ("lost", &lost)] {
            let (file, out) = (format!("{name}{dimension}.toml"), format!("{name}{dimension}"));
            std::fs::write(folder.path().join(&file), text).expect("a file");
            let output = opruga(folder.path(), &["run", &file, "--out", &out, "--json"]);
            assert_eq!(code(&output), 0, "{file}: {}", said(&output));
            let summary: Value = serde_json::from_slice(&output.stdout).expect("JSON");
            assert_eq!((&summary["bodies"], &summary["energy"]["kinetic"]), (&0.into(), &0.0.into()));
            assert!((summary["time"].as_f64().expect("a time") - 0.2).abs() < 1e-9);
            let resume = format!("{out}/checkpoint");
            let resumed =
                opruga(folder.path(), &["run", "--resume", &resume, "--seconds", "0.3", "--out", &out, "--force"]);
            assert_eq!(code(&resumed), 0, "{file}: {}", said(&resumed));
        }
    }
}

/// Rows 84 and 112: names that are not UTF-8, and streams that are closed from the start.
#[cfg(target_os = "linux")]
#[test]
fn odd_names_and_closed_streams() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().expect("a folder");
    let odd = std::ffi::OsStr::from_bytes(b"caf\xe9");
    let output = program(folder.path(), &SHORT).arg(odd).output().expect("the program runs");
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(folder.path().join(odd).join("summary.json").exists());
    let output = program(folder.path(), &["run"]).arg(odd).output().expect("the program runs");
    assert_eq!(code(&output), 2, "{}", said(&output));
    assert!(!said(&output).contains("panicked"));
    for (streams, expected) in [(">&-", 0), ("2>&-", 0), (">&- 2>&- <&-", 0)] {
        let call = format!("exec {} list {streams}", env!("CARGO_BIN_EXE_opruga"));
        let output = Command::new("bash").args(["-c", &call]).current_dir(folder.path()).output().expect("a shell");
        assert!([expected, 4].contains(&code(&output)), "{streams}: {}", said(&output));
        assert!(!said(&output).contains("panicked"), "{streams}: {}", said(&output));
    }
    for name in ["-", "--", "-x", "a\nb", "\u{202e}evil", "con.", ".."] {
        let output = opruga(folder.path(), &["check", "--json", "--", name]);
        assert!([2, 4].contains(&code(&output)), "{name:?}: {}", said(&output));
        let error: Value = serde_json::from_slice(&output.stderr).unwrap_or_else(|e| panic!("{name:?}: {e}"));
        assert!(error["code"].as_str().is_some_and(|c| c.starts_with("read.")), "{error}");
        let output = opruga(folder.path(), &["check", "--", name]);
        assert!(!said(&output).contains('\u{202e}') && !said(&output).contains("a\nb"), "{:?}", said(&output));
    }
}
