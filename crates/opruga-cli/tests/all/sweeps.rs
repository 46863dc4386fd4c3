//! `opruga sweep` as a program: the same table for any number of threads and after a kill, and its errors.

use crate::common;

use common::{code, contents, opruga, printed, program, said, until};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// Twelve short runs of the ball.
const CALL: [&str; 11] = [
    "sweep",
    "ball",
    "--set",
    "collider.0.restitution=0..1:4",
    "--set",
    "body.ball.mass=0.5,1,2",
    "--metric",
    "bounce_height",
    "--metric",
    "top.y.min",
    "--seconds=1",
];

fn table(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("results.csv")).expect("a table")
}

fn swept(folder: &Path, more: &[&str]) {
    let output = opruga(folder, &[&CALL, more].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
}

/// Sweeps the ball over stiffnesses, some of which are refused, in the folder `o`; asserts the exit code.
fn swept_over_stiffness(values: &str, exit: i32, more: &[&str]) -> (tempfile::TempDir, Output) {
    let folder = tempfile::tempdir().expect("a folder");
    let set = format!("--set=body.ball.models.mass_spring.stiffness={values}");
    let output = opruga(folder.path(), &[&["sweep", "ball", &set, "--metric=energy_drift", "--out=o"], more].concat());
    assert_eq!(code(&output), exit, "{}", said(&output));
    (folder, output)
}

#[test]
fn any_number_of_threads_gives_the_same_table_and_the_same_plots() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    swept(at, &["--threads=1", "--out=one"]);
    swept(at, &["--threads=2", "--out=two"]);
    swept(at, &["--threads=5", "--out=five"]);
    let one = table(&at.join("one"));
    assert_eq!(one.lines().count(), 13);
    assert!(
        one.starts_with(
            "point,collider.0.restitution,body.ball.mass,status,bounce_height,top.y.min,message,checksum\n"
        )
    );
    for other in ["two", "five"] {
        assert_eq!(table(&at.join(other)), one);
        let plot = |folder: &str| std::fs::read(at.join(folder).join("plots.svg")).expect("a plot");
        assert_eq!(plot(other), plot("one"));
    }
}

#[test]
fn a_sweep_that_was_stopped_anywhere_goes_on_to_the_same_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    swept(at, &["--threads=1", "--out=whole"]);
    let whole = table(&at.join("whole"));
    // As a kill leaves it: some rows, in any order, the last one truncated.
    let lines: Vec<&str> = whole.lines().collect();
    let torn = format!("{}\n{}\n{}\n{}", lines[0], lines[7], lines[2], &lines[5][..9]);
    for again in ["question", "folder"] {
        std::fs::create_dir(at.join("part")).expect("a folder");
        std::fs::copy(at.join("whole/question.json"), at.join("part/question.json")).expect("a copy");
        std::fs::write(at.join("part/results.csv"), &torn).expect("a file");
        let output = match again {
            "question" => opruga(at, &[&CALL[..], &["--out=part"]].concat()),
            _ => opruga(at, &["sweep", "--resume=part"]),
        };
        assert_eq!(code(&output), 0, "{}", said(&output));
        assert!(said(&output).contains("2 of 12 points are already done"), "{}", said(&output));
        assert_eq!(table(&at.join("part")), whole);
        std::fs::remove_dir_all(at.join("part")).expect("it goes");
    }
}

#[test]
fn a_killed_sweep_has_every_row_that_was_done_and_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let long = ["--set=time.substeps=256", "--threads=2", "--out=killed"];
    let mut child = program(at, &[&CALL[..], &long].concat()).spawn().expect("it starts");
    let rows = || std::fs::read_to_string(at.join("killed/results.csv")).map_or(0, |text| text.lines().count());
    until("two rows are written", || rows() > 2);
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    let before = rows();
    let output = opruga(at, &[&CALL[..], &long].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(before < 3 || said(&output).contains("are already done") || before == 13);
    swept(at, &["--set=time.substeps=256", "--out=whole"]);
    assert_eq!(table(&at.join("killed")), table(&at.join("whole")));
}

#[test]
fn another_question_a_foreign_folder_and_a_damaged_table_are_refused_and_left_as_they_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    swept(at, &["--out=done"]);
    let before = contents(&at.join("done"));
    let refused = |arguments: &[&str], exit: i32, word: &str| {
        let output = opruga(at, arguments);
        assert_eq!(code(&output), exit, "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(word), "{arguments:?}: {}", said(&output));
    };
    refused(&[&CALL[..], &["--metric=energy_drift", "--out=done"]].concat(), 4, "a different sweep: --metric");
    refused(&[&CALL[..], &["--set=world.drag=1", "--out=done"]].concat(), 4, "a different sweep: --set");
    assert_eq!(contents(&at.join("done")), before);
    std::fs::create_dir(at.join("foreign")).expect("a folder");
    std::fs::write(at.join("foreign/thesis.txt"), "years of work").expect("a file");
    refused(&[&CALL[..], &["--out=foreign"]].concat(), 4, "write.exists");
    refused(&["sweep", "--resume=foreign"], 4, "there is no sweep");
    assert_eq!(contents(&at.join("foreign")).len(), 1);
    std::fs::write(at.join("done/results.csv"), "point,what\n1,2\n").expect("a file");
    refused(&[&CALL[..], &["--out=done"]].concat(), 2, "sweep.damaged");
    assert_eq!(table(&at.join("done")), "point,what\n1,2\n");
    swept(at, &["--out=done", "--force"]);
    assert_eq!(table(&at.join("done")).lines().count(), 13);
}

#[test]
fn a_row_that_was_changed_by_hand_is_no_result() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    swept(at, &["--out=o"]);
    let whole = table(&at.join("o"));
    let line = whole.lines().nth(4).expect("a row");
    let cells: Vec<&str> = line.split(',').collect();
    let changed = whole.replace(line, &line.replace(cells[4], "1.0000000000000000e0"));
    assert_ne!(changed, whole);
    std::fs::write(at.join("o/results.csv"), &changed).expect("a file");
    for call in [&["sweep", "--resume=o"][..], &[&CALL[..], &["--out=o"]].concat()] {
        let output = opruga(at, call);
        assert_eq!(code(&output), 2, "{}", said(&output));
        assert!(said(&output).contains("results.csv:5:1: error[sweep.changed_row]"), "{}", said(&output));
        assert_eq!(table(&at.join("o")), changed, "it is left as it is");
    }
    // Without its line the point is computed again.
    std::fs::write(at.join("o/results.csv"), whole.replace(&format!("{line}\n"), "")).expect("a file");
    let output = opruga(at, &["sweep", "--resume=o"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert_eq!(table(&at.join("o")), whole);
}

#[test]
fn bad_calls_are_refused_before_anything_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arguments, word) in [
        (vec!["sweep", "ball", "--metric=energy_drift", "--out=o"], "no parameter varies"),
        (vec!["sweep", "ball", "--set=body.ball.mass=1,2", "--out=o"], "the sweep measures nothing"),
        (vec!["sweep", "ball", "--set=body.ball.mass=1,2", "--metric=bounce_hight", "--out=o"], "did you mean"),
        (
            vec!["sweep", "ball", "--set=body.ball.mass=1..2", "--metric=energy_drift", "--out=o"],
            "does not give the number of values",
        ),
        (
            vec!["sweep", "ball", "--set=body.ball.mass=1..2", "--sample=0", "--metric=energy_drift", "--out=o"],
            "a sample of 0 points is empty\n  = allowed: 1 to 1000000\n  = hint: for example --sample 20",
        ),
        (vec!["sweep", "ball", "--set=body.bell.mass=1,2", "--metric=energy_drift", "--out=o"], "set.path"),
        (vec!["sweep", "bell", "--set=body.ball.mass=1,2", "--metric=energy_drift", "--out=o"], "no such file"),
    ] {
        let output = opruga(folder.path(), &arguments);
        assert!(matches!(code(&output), 2 | 4), "{arguments:?}");
        assert!(said(&output).contains(word), "{arguments:?}: {}", said(&output));
        assert!(!folder.path().join("o").exists(), "{arguments:?}");
    }
}

#[test]
fn a_failed_point_is_counted_and_the_others_are_run() {
    // The exit code is that of a run of that point: an unstable step is an invalid call.
    let (folder, output) = swept_over_stiffness("100,1e9", 2, &["--seconds=0.1", "--json"]);
    assert_eq!(
        code(&opruga(folder.path(), &["sweep", "--resume=o"])),
        2,
        "nothing is left to do, and a point has failed"
    );
    let summary: Value = serde_json::from_str(&printed(&output)).expect("JSON");
    assert_eq!((&summary["points"], &summary["done"]), (&2.into(), &1.into()));
    assert_eq!(summary["failed"][0]["code"], "step.unstable");
    assert_eq!(summary["metrics"][0]["lowest"]["at"]["body.ball.models.mass_spring.stiffness"], "100");
    assert!(table(&folder.path().join("o")).lines().nth(2).is_some_and(|row| row.starts_with("1,1e9,step.unstable,,")));
}

/// If a run diverges, the exit code is 3, whatever else was refused; every other point has its row.
#[test]
fn a_point_that_diverges_is_told_by_the_exit_code() {
    let (folder, _) = swept_over_stiffness("100,-1,1e9", 3, &["--seconds=0.5", "--allow-unstable"]);
    let table = table(&folder.path().join("o"));
    for (row, word, what) in [
        (1, "0,100,done,", ""),
        (2, "1,-1,scene.range,", "`stiffness` is -1; allowed: "),
        (3, "2,1e9,run.diverged,", "diverged"),
    ] {
        let line = table.lines().nth(row).unwrap_or_default();
        assert!(line.starts_with(word) && line.contains(what), "{table}");
    }
}

#[test]
fn the_sweep_of_the_thesis_runs_as_its_scene_says() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/sweeps");
    let text = std::fs::read_to_string(scenes.join("thesis-4-3.toml")).expect("the scene");
    let said_there = text.lines().skip_while(|line| !line.contains("opruga sweep")).take_while(|l| l.starts_with('#'));
    let call: String = said_there.map(|line| line.trim_start_matches('#').trim_end_matches('\\')).collect();
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("thesis-4-3.toml"), &text).expect("a file");
    let mut words: Vec<&str> = call.split_whitespace().skip(1).collect();
    words[1] = "thesis-4-3.toml";
    // The points and the folder, which is made with its parent, are those of the scene; the time is not.
    let words: Vec<&str> = words.into_iter().chain(["--seconds=0.02", "--json"]).collect();
    let output = opruga(folder.path(), &words);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let summary: Value = serde_json::from_str(&printed(&output)).expect("JSON");
    assert_eq!(summary["parameters"].as_array().map(Vec::len), Some(4));
    assert_eq!(summary["done"], summary["points"], "{summary}");
    assert!(folder.path().join("out/thesis-4-3/results.csv").exists());
}

/// A scene in a folder of its own with its drawing in the parent folder: the sweep stores the file, and is resumed without it.
#[test]
fn a_scene_with_a_file_is_swept_and_goes_on_where_the_file_is_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    std::fs::create_dir(folder.join("scenes")).expect("a folder");
    let heart = opruga::scenes::find("heart").expect("a scene").replace("shapes/heart.svg", "../heart.svg");
    std::fs::write(folder.join("scenes/mine.toml"), heart).expect("a file");
    let drawing = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/heart.svg");
    std::fs::copy(drawing, folder.join("heart.svg")).expect("a drawing");
    let call = [
        "sweep",
        "scenes/mine.toml",
        "--set=body.jelly.models.mass_spring.stiffness=1000,1500",
        "--metric=settling_time",
        "--metric=equilibrium_radius.balloon",
        "--seconds=0.2",
        "--out=s",
    ];
    let output = opruga(folder, &call);
    assert!(code(&output) == 2 && said(&output).contains("shape.outside"), "{}", said(&output));
    let output = opruga(folder, &[&call[..], &["--allow-outside"]].concat());
    assert_eq!(code(&output), 0, "{}", said(&output));
    let whole = table(&folder.join("s"));
    assert_eq!(whole.lines().count(), 3, "{whole}");
    let plots = std::fs::read_to_string(folder.join("s/plots.svg")).expect("plots");
    assert!(plots.contains("Twemoji") && plots.contains("CC-BY 4.0"), "whose drawing it is");
    // A part of the table is lost, and so is the drawing.
    let kept: String = whole.lines().take(2).map(|line| format!("{line}\n")).collect();
    std::fs::write(folder.join("s/results.csv"), kept).expect("a file");
    std::fs::remove_file(folder.join("heart.svg")).expect("it goes");
    let output = opruga(folder, &["sweep", "--resume", "s"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert_eq!(table(&folder.join("s")), whole);
}
