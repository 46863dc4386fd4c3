//! `--watch`: repeats a command when the scene changes, whatever was wrong with it before.

#[path = "all/common/mod.rs"]
mod common;

use common::{code, opruga, program, said};
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};
use std::sync::mpsc;
use std::time::Duration;

/// A running program and the lines that it prints on stderr.
struct Watched {
    child: Child,
    lines: mpsc::Receiver<String>,
}

impl Watched {
    fn start(folder: &Path, arguments: &[&str]) -> Watched {
        let mut command = program(folder, arguments);
        let mut child = command.stdout(Stdio::null()).spawn().expect("it starts");
        let stderr = child.stderr.take().expect("a pipe");
        let (sender, lines) = mpsc::channel();
        std::thread::spawn(move || {
            BufReader::new(stderr).lines().map_while(Result::ok).for_each(|line| drop(sender.send(line)));
        });
        Watched { child, lines }
    }

    fn until(&self, word: &str) {
        let mut seen = Vec::new();
        while let Ok(line) = self.lines.recv_timeout(Duration::from_secs(30)) {
            if line.contains(word) {
                return;
            }
            seen.push(line);
        }
        panic!("it never says `{word}`: {seen:?}");
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn scene() -> String {
    opruga::scenes::find("ball").expect("a scene").to_string()
}

#[test]
fn check_goes_on_after_errors_and_tells_when_they_are_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, scene().replace("mass = 1.0", "mass = -1.0")).expect("a file");
    let watched = Watched::start(folder.path(), &["check", "mine.toml", "--watch"]);
    watched.until("scene.range");
    watched.until("waiting for changes");
    // An editor that replaces the file removes it for a moment.
    std::fs::remove_file(&path).expect("it goes");
    std::thread::sleep(Duration::from_millis(250));
    std::fs::write(&path, scene()).expect("a file");
    watched.until("has changed");
    watched.until("waiting for changes");
    std::fs::write(&path, scene().replace("ring", "rung")).expect("a file");
    watched.until("did you mean");
}

/// A scene that disappears is reported once, and the program waits for it; one that is only replaced is not reported.
#[test]
fn a_scene_that_vanishes_is_told_of_once_and_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, scene().replace("seconds = 8.0", "seconds = 0.1")).expect("a file");
    let watched = Watched::start(folder.path(), &["run", "mine.toml", "--watch", "--no-pictures", "--out=o"]);
    watched.until("waiting for changes");
    for seconds in ["0.2", "0.3"] {
        std::fs::remove_file(&path).expect("it goes");
        watched.until("mine.toml is gone; waiting for it to come back");
        // Once: nothing more is printed for longer than it took to print it.
        let more = watched.lines.recv_timeout(Duration::from_millis(1500));
        assert_eq!(more, Err(mpsc::RecvTimeoutError::Timeout));
        std::fs::write(&path, scene().replace("seconds = 8.0", &format!("seconds = {seconds}"))).expect("a file");
        watched.until("mine.toml has changed");
        watched.until("waiting for changes");
        let text = std::fs::read_to_string(folder.path().join("o/summary.json")).expect("a summary");
        let time = serde_json::from_str::<serde_json::Value>(&text).expect("JSON")["time"].as_f64();
        assert!(time.is_some_and(|time| (time - seconds.parse::<f64>().expect("a number")).abs() < 1e-9), "{time:?}");
    }
}

#[test]
fn a_file_that_the_scene_names_is_watched_even_where_it_is_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\n[integrator]\nkind = \"verlet\"\n[[body]]\n\
                 name = \"it\"\nmass = 1\nshape = { kind = \"svg\", file = \"s.svg\", spacing = 0.1, size = 1.0 }\n";
    std::fs::write(folder.path().join("mine.toml"), scene).expect("a file");
    let drawing = folder.path().join("s.svg");
    let watched = Watched::start(folder.path(), &["check", "mine.toml", "--watch"]);
    watched.until("read.failed");
    watched.until("waiting for changes to mine.toml and of 1 file that it names");
    std::fs::write(&drawing, "<svg xmlns='http://www.w3.org/2000/svg'><circle r='3'/></svg>").expect("a file");
    watched.until("s.svg has changed");
    watched.until("waiting for changes");
    std::fs::write(&drawing, "<svg xmlns='http://www.w3.org/2000/svg'><circle r='x'/></svg>").expect("a file");
    watched.until("s.svg has changed");
    watched.until("error[");
}

#[cfg(unix)]
#[test]
fn run_replaces_its_own_output_stops_what_a_change_overtakes_and_ends_with_ctrl_c() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("mine.toml");
    std::fs::write(&path, scene()).expect("a file");
    let call = ["run", "mine.toml", "--watch", "--no-pictures", "--out=o"];
    let mut watched = Watched::start(folder.path(), &call);
    watched.until("waiting for changes");
    let time = || {
        let text = std::fs::read_to_string(folder.path().join("o/summary.json")).expect("a summary");
        serde_json::from_str::<serde_json::Value>(&text).expect("JSON")["time"].as_f64().expect("a time")
    };
    assert!((time() - 8.0).abs() < 1e-9);
    // A run that would take an hour is stopped by the next change.
    std::fs::write(&path, scene().replace("seconds = 8.0", "seconds = 1e6")).expect("a file");
    watched.until("has changed");
    std::thread::sleep(Duration::from_millis(400));
    std::fs::write(&path, scene().replace("seconds = 8.0", "seconds = 2.0")).expect("a file");
    watched.until("has changed");
    watched.until("waiting for changes");
    assert!((time() - 2.0).abs() < 1e-9, "{}", time());
    let id = watched.child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &id]).status().expect("kill runs").success());
    assert_eq!(watched.child.wait().expect("it ends").code(), Some(130));
}

#[test]
fn a_scene_that_cannot_change_and_a_folder_of_somebody_else_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let built_in = opruga(folder.path(), &["run", "ball", "--watch"]);
    assert_eq!(code(&built_in), 2);
    assert!(said(&built_in).contains("never changes"), "{}", said(&built_in));
    let absent = opruga(folder.path(), &["check", "absent.toml", "--watch"]);
    assert_eq!(code(&absent), 4, "{}", said(&absent));
    std::fs::write(folder.path().join("mine.toml"), scene()).expect("a file");
    std::fs::create_dir(folder.path().join("o")).expect("a folder");
    std::fs::write(folder.path().join("o/thesis.txt"), "years of work").expect("a file");
    let watched = Watched::start(folder.path(), &["run", "mine.toml", "--watch", "--no-pictures", "--out=o"]);
    watched.until("write.exists");
    std::fs::write(folder.path().join("mine.toml"), scene() + "\n").expect("a file");
    watched.until("has changed");
    watched.until("write.exists");
    assert_eq!(std::fs::read_dir(folder.path().join("o")).expect("a folder").count(), 1);
}
