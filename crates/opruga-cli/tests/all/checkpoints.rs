//! Intermediate checkpoints: a run that is killed, stopped or kept from writing at any moment can be resumed with the same bits. The numbers are rows
//! of the torture list.
#![cfg(unix)]
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

const LONG: [&str; 5] = ["run", "pressures", "--seconds", "4", "--no-pictures"];

fn hash(summary: &Value) -> String {
    summary["state_hash"].as_str().expect("a text").into()
}

fn resume(folder: &Path, checkpoint: &str, seconds: &str, out: &str) -> Value {
    let arguments = ["run", "--resume", checkpoint, "--seconds", seconds, "--out", out, "--force"];
    summary(folder, &[&arguments[..], &["--checkpoint-every", "0"]].concat())
}

/// A run that lasts until it is ended, and writes checkpoints to `o` every few milliseconds.
fn endless(folder: &Path) -> Child {
    let arguments =
        ["run", "pressures", "--seconds", "1e6", "--no-pictures", "--out", "o", "--checkpoint-every", "0.01"];
    program(folder, &arguments).spawn().expect("the program runs")
}

/// Rows 79 to 81: killed at any moment, even while a checkpoint is written, a run leaves an intact checkpoint and the previous one. Resumed from
/// either, it gives the same bits as an uninterrupted run. The table extends to the checkpoint.
#[test]
fn a_run_that_is_killed_goes_on_from_a_whole_checkpoint() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let whole = hash(&summary(folder, &["run", "pressures", "--seconds", "4", "--out", "whole"]));
    let (mut on_the_way, mut previous) = (0, 0);
    for round in 0..20u64 {
        let _ = std::fs::remove_dir_all(folder.join("o"));
        let arguments = [&LONG[..], &["--out", "o", "--checkpoint-every", "0.0001"]].concat();
        let mut child = program(folder, &arguments).spawn().expect("the program runs");
        let checkpoint = folder.join("o/checkpoint");
        until("no checkpoint is written", || checkpoint.exists());
        if round % 2 == 1 {
            // However slow the machine is, half of the runs have written two checkpoints.
            until("no second checkpoint is written", || folder.join("o/checkpoint.previous").exists());
        }
        // Microseconds, spread irregularly over the run.
        std::thread::sleep(Duration::from_micros(round.wrapping_mul(7_919_777) % 60_000));
        let _ = child.kill();
        child.wait().expect("it ends");
        for name in ["checkpoint", "checkpoint.previous"] {
            let path = format!("o/{name}");
            if !folder.join(&path).exists() {
                assert_ne!(name, "checkpoint", "round {round}: the checkpoint is lost");
                continue;
            }
            let output = opruga(folder, &["run", "--resume", &path, "--seconds", "0", "--out", "x"]);
            if said(&output).contains("the checkpoint is at t = 4 s") {
                continue; // it was faster than the signal
            }
            previous += u32::from(name != "checkpoint");
            let rest = resume(folder, &path, "4", "rest");
            assert_eq!(hash(&rest), whole, "round {round}, {name}");
            let time = rest["resumed_at"].as_f64().expect("a time");
            on_the_way += u32::from(time > 0.0 && time < 4.0);
            let table = std::fs::read_to_string(folder.join("o/diagnostics.csv")).expect("a table");
            let last = table.lines().last().and_then(|row| row.split(',').next()?.parse::<f64>().ok());
            assert!(
                table.ends_with('\n') && last.is_some_and(|last| last > time - 1e-9),
                "round {round}: {last:?}, {time}"
            );
        }
    }
    assert!(on_the_way >= 8 && previous >= 4, "{on_the_way} checkpoints on the way, {previous} older ones");
    // Files that were left half written are removed by the next run.
    summary(folder, &[&LONG[..3], &["0", "--out", "o", "--force"]].concat());
    let names: Vec<String> = contents(&folder.join("o")).into_iter().map(|f| f.0).collect();
    assert_eq!(names, ["checkpoint", "diagnostics.csv", "final.csv", "summary.json"]);
}

/// A run that is killed long before its first checkpoint leaves the header of its table; the table of an earlier run stays as long as its checkpoint
/// does.
#[test]
fn a_run_has_the_head_of_its_table_from_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let arguments = ["run", "pressures", "--seconds", "1e6", "--no-pictures", "--out", "o"];
    let killed = |more: &[&str], ready: &dyn Fn() -> bool| {
        let mut child = program(folder, &[&arguments[..], more].concat()).spawn().expect("the program runs");
        until("it begins", ready);
        child.kill().expect("it runs");
        child.wait().expect("it ends");
    };
    let table = || std::fs::read_to_string(folder.join("o/diagnostics.csv")).unwrap_or_default();
    killed(&[], &|| table().contains('\n'));
    let text = table();
    assert!(text.starts_with("time,kinetic,") && text.lines().nth(1).is_some_and(|row| row.starts_with('0')), "{text}");
    summary(folder, &["run", "pressures", "--seconds", "0.2", "--out", "o", "--force"]);
    let before = contents(&folder.join("o"));
    killed(&["--force", "--record", "r"], &|| folder.join("r").exists());
    let after = contents(&folder.join("o"));
    assert!(before.iter().all(|file| after.contains(file)), "the earlier run is whole");
}

/// A run is resumed with the arguments with which it was started: its end, the changes of the scene, and the permissions.
#[test]
fn a_killed_run_is_resumed_as_it_was_called() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let text = String::from_utf8(opruga(folder, &["new", "mine", "--force"]).stderr).expect("text");
    assert!(text.contains("mine.toml"), "{text}");
    let path = folder.join("mine.toml");
    let text = std::fs::read_to_string(&path).expect("a scene");
    std::fs::write(&path, text.replace("seed = 1 ", "sede = 1 ")).expect("a file");
    // Slightly above the stated limit, which has a margin to the true one.
    let check = opruga(folder, &["check", "mine.toml", "--lenient", "--json"]);
    let check: Value = serde_json::from_slice(&check.stdout).expect("JSON");
    let limit = check["stability"][0]["largest_stable_step"].as_f64().expect("a limit");
    let frame = format!("time.frame={}", 1.005 * limit * 32.0);
    // So long that it is killed before its end even on a busy machine.
    let call = ["run", "mine.toml", "--lenient", "--seconds", "20", "--set", &frame, "--allow-unstable"];
    let unstable = opruga(folder, &[&call[..7], &["--out", "u"]].concat());
    assert!(said(&unstable).contains("error[step.unstable]"), "{}", said(&unstable));
    let whole = summary(folder, &[&call[..], &["--out", "whole"]].concat());
    let arguments = [&call[..], &["--no-pictures", "--out", "o", "--checkpoint-every", "0.0001"]].concat();
    let mut child = program(folder, &arguments).spawn().expect("the program runs");
    until("no checkpoint is written", || folder.join("o/checkpoint").exists());
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    // Neither the file nor the options are needed any more.
    std::fs::remove_file(&path).expect("a file");
    let rest = summary(folder, &["run", "--resume", "o/checkpoint", "--out", "rest"]);
    assert_eq!((hash(&rest), &rest["time"], &rest["h"]), (hash(&whole), &whole["time"], &whole["h"]));
}

/// Row 82: a damaged, missing or foreign checkpoint is refused, and the previous one is offered if it is intact.
#[test]
fn a_damaged_checkpoint_offers_the_one_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let mut child = endless(folder);
    until("no older checkpoint is kept", || folder.join("o/checkpoint.previous").exists());
    child.kill().expect("it runs");
    child.wait().expect("it ends");
    let path = folder.join("o/checkpoint");
    let good = std::fs::read(&path).expect("a checkpoint");
    let flipped: Vec<u8> = good.iter().enumerate().map(|(k, b)| if k == good.len() / 2 { b ^ 1 } else { *b }).collect();
    let refused = |offered: bool, code_expected: i32| {
        let output = opruga(folder, &["run", "--resume", "o/checkpoint", "--seconds", "1e5", "--out", "x"]);
        assert_eq!(code(&output), code_expected, "{}", said(&output));
        let offer = "= hint: the checkpoint before it is complete, at t = ";
        assert_eq!(said(&output).contains(offer), offered, "{}", said(&output));
        assert_eq!(said(&output).contains("--resume o/checkpoint.previous"), offered, "{}", said(&output));
        assert!(!folder.join("x").exists());
    };
    for bytes in [flipped, good[..good.len() - 1].to_vec(), b"notes".to_vec()] {
        // The file is removed first: its name and that of the previous checkpoint may mean the same file for a moment.
        std::fs::remove_file(&path).expect("a file");
        std::fs::write(&path, &bytes).expect("a file");
        refused(true, 2);
    }
    std::fs::remove_file(&path).expect("a file");
    refused(true, 4);
    // The offer is valid; the message gives six digits of the time, which is that of a frame.
    let output = opruga(folder, &["run", "--resume", "o/checkpoint", "--out", "x"]);
    let time: f64 = said(&output)
        .split("at t = ")
        .nth(1)
        .and_then(|rest| rest.split(' ').next()?.parse().ok())
        .unwrap_or_else(|| panic!("{}", said(&output)));
    let rest = resume(folder, "o/checkpoint.previous", &format!("{}", time + 0.1), "x");
    assert!(
        rest["resumed_at"].as_f64().is_some_and(|t| (t * 60.0 - (time * 60.0).round()).abs() < 1e-9),
        "{time}: {}",
        rest["resumed_at"]
    );
}

/// A run that is resumed in its own folder keeps the checkpoint from which it was resumed; a different run removes those of other runs.
#[test]
fn the_older_checkpoint_is_of_the_same_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let names = || -> Vec<String> { contents(&folder.join("o")).into_iter().map(|f| f.0).collect() };
    let with_older = |names: Vec<String>| names.iter().any(|n| n == "checkpoint.previous");
    summary(folder, &["run", "pressures", "--seconds", "0.1", "--out", "o"]);
    assert!(!with_older(names()));
    let longer = resume(folder, "o/checkpoint", "0.2", "o");
    assert!(with_older(names()));
    assert!(longer["files"].as_array().expect("a list").contains(&"checkpoint.previous".into()));
    // Resuming from the older one, as offered, does not replace it by the newer one.
    let again = resume(folder, "o/checkpoint.previous", "0.2", "o");
    assert_eq!(hash(&again), hash(&longer));
    assert!((again["resumed_at"].as_f64().expect("a time") - 0.1).abs() < 1e-12);
    assert_eq!(hash(&resume(folder, "o/checkpoint.previous", "0.2", "p")), hash(&longer));
    summary(folder, &["run", "ball", "--seconds", "0.1", "--out", "o", "--force"]);
    assert!(!with_older(names()));
}

/// Rows 83 and 91: an intermediate checkpoint that cannot be written is reported and counted; the run continues, and the next one succeeds.
#[test]
fn a_checkpoint_that_cannot_be_written_does_not_end_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let child = endless(folder);
    let checkpoint = folder.join("o/checkpoint");
    until("no checkpoint is written", || checkpoint.is_file());
    // A folder has the name of the checkpoint until writing a checkpoint has failed.
    until("the place is never free", || {
        let _ = std::fs::remove_file(&checkpoint);
        std::fs::create_dir(&checkpoint).is_ok()
    });
    std::thread::sleep(Duration::from_millis(200));
    std::fs::remove_dir(&checkpoint).expect("a folder");
    until("no checkpoint is written again", || checkpoint.is_file());
    signal(&child, "INT");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    assert!(
        said(&output).contains("warning[checkpoint.failed]: no checkpoint was written at t = "),
        "{}",
        said(&output)
    );
    let text = std::fs::read(folder.join("o/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_slice(&text).expect("JSON");
    let warning = &summary["warnings"][0];
    assert_eq!(warning["code"], "checkpoint.failed");
    assert!(warning["count"].as_u64().is_some_and(|n| n >= 1), "{warning}");
}

/// Row 88: a clock that jumps, here because the process is stopped as on a sleeping laptop, changes neither the simulated time nor any bits. The
/// interval of the checkpoints does not change them either.
#[test]
fn a_run_that_is_put_to_sleep_computes_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let awake = summary(folder, &["run", "thousand-balls", "--seconds", "1.5", "--out", "a"]);
    let arguments = ["run", "thousand-balls", "--seconds", "1.5", "--out", "b", "--no-pictures", "--json"];
    let child = program(folder, &[&arguments[..], &["--checkpoint-every", "0.01"]].concat()).spawn().expect("it runs");
    until("the run does not begin", || folder.join("b/checkpoint").exists());
    signal(&child, "STOP");
    let asleep = Instant::now();
    std::thread::sleep(Duration::from_millis(400));
    signal(&child, "CONT");
    let asleep = asleep.elapsed().as_secs_f64();
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let slept: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert!(
        slept["wall_seconds"].as_f64() >= Some(0.9 * asleep),
        "it was stopped while it ran: {}",
        slept["wall_seconds"]
    );
    for key in ["time", "steps", "state_hash", "energy"] {
        assert_eq!(awake[key], slept[key], "{key}");
    }
}
