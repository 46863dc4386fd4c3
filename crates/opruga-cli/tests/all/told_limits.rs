//! Everything that is cut, omitted or chosen for the user is reported, with numbers.

use crate::common;

use common::{code, opruga, printed, program, said, summary};
use serde_json::Value;
use std::path::Path;

fn rows(folder: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(folder.join("diagnostics.csv")).expect("a table");
    text.lines().skip(1).map(|line| line.split(',').next().expect("a time").to_string()).collect()
}

fn warning<'w>(summary: &'w Value, code: &str) -> Option<&'w Value> {
    summary["warnings"].as_array().expect("a list").iter().find(|warning| warning["code"] == code)
}

#[test]
fn diagnostics_have_as_many_rows_as_are_asked_for_and_no_more_than_a_table_may_have_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let run = |out: &str, more: &[&str]| summary(at, &[&["run", "ball", "--out", out][..], more].concat());
    let all = run("all", &["--seconds=0.5"]);
    let every = run("every", &["--seconds=0.5", "--diagnostics-every=7"]);
    assert_eq!(all["state_hash"], every["state_hash"]);
    let whole = rows(&at.join("all"));
    let kept: Vec<String> =
        (0..whole.len()).filter(|k| k % 7 == 0 || k + 1 == whole.len()).map(|k| whole[k].clone()).collect();
    assert_eq!(rows(&at.join("every")), kept, "every seventh frame and the last one");
    assert!(warning(&every, "diagnostics.thinned").is_none(), "it was asked for");
    // A resumed run has the same rows as an uninterrupted one.
    let resumed = ["run", "--resume=every/checkpoint", "--seconds=1", "--diagnostics-every=7", "--out=on"];
    summary(at, &resumed);
    let uninterrupted = ["run", "ball", "--seconds=1", "--diagnostics-every=7", "--out=one"];
    summary(at, &uninterrupted);
    let (on, one) = (rows(&at.join("on")), rows(&at.join("one")));
    assert_eq!(on[0], whole[whole.len() - 1], "the state that it begins with");
    assert!(one.ends_with(&on[1..]), "{on:?} {one:?}");
    let bad = opruga(at, &["run", "ball", "--diagnostics-every=0"]);
    assert_eq!(code(&bad), 2, "{}", said(&bad));
    // More frames than fit: rows are omitted, which is reported before the run and counted after it.
    let scene = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.004\nframe = 1e-8\n[integrator]\nkind = \"explicit_euler\"\n";
    std::fs::write(at.join("short.toml"), scene).expect("a file");
    let output = opruga(at, &["run", "short.toml", "--no-pictures", "--out=short"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(said(&output).contains("warning[diagnostics.thinned]"), "{}", said(&output));
    let text = std::fs::read_to_string(at.join("short/summary.json")).expect("a summary");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let told = warning(&found, "diagnostics.thinned").expect("a warning");
    let shown = rows(&at.join("short")).len() as u64;
    assert_eq!(told["count"].as_u64().expect("a number") + shown, 400_001);
    assert!(std::fs::metadata(at.join("short/diagnostics.csv")).expect("a table").len() < 68_000_000);
}

/// The run itself would take minutes: the test ends it after the warning.
#[test]
fn pictures_that_need_more_memory_than_allowed_are_thinned_with_a_warning_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    // 60,000 pictures of 2,000 nodes with three numbers of four bytes are 1.44e9 bytes, above 2^30.
    let run = ["run", "ball", "--set", "body.0.shape.vertices=2000", "--set", "time.substeps=200", "--seconds=1000"];
    let mut child = program(folder.path(), &run).arg("--fps=60").spawn().expect("the program runs");
    let stderr = std::io::BufReader::new(child.stderr.take().expect("standard error"));
    let told = std::io::BufRead::lines(stderr).map_while(Result::ok).find(|line| line.contains("[pictures.thinned]"));
    child.kill().expect("the program still runs");
    child.wait().expect("it ends");
    let says =
        "warning[pictures.thinned]: pictures of 2000 nodes would need 1373 MiB, so only one frame in 2 has a picture";
    assert_eq!(told.as_deref(), Some(says));
}

#[test]
fn a_run_whose_last_frame_ends_elsewhere_than_asked_for_says_when() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |seconds: &str| opruga(folder.path(), &["run", "ball", "--no-pictures", "--force", "--seconds", seconds]);
    let output = run("0.04");
    assert!(
        said(&output).contains(
            "note[run.whole_frames]: a run consists of whole frames, so it ends at t = 0.05 s instead of 0.04 s"
        ),
        "{}",
        said(&output)
    );
    assert!(!said(&run("0.05")).contains("whole frames"));
    let croatian = ["run", "ball", "--no-pictures", "--force", "--seconds", "0.04", "--language", "hr"];
    let told = said(&opruga(folder.path(), &croatian));
    let says = "napomena[run.whole_frames]: sličice su cijele: računanje završava u t = 0.05 s, a ne u 0.04 s";
    assert!(told.contains(says), "{told}");
}

#[test]
fn a_sweep_whose_last_frames_end_elsewhere_than_asked_for_says_when() {
    let folder = tempfile::tempdir().expect("a folder");
    let sweep = |seconds: &str| {
        let call = [
            "sweep",
            "ball",
            "--set",
            "body.ball.mass=1,2",
            "--metric",
            "bounce_height",
            "--force",
            "--seconds",
            seconds,
        ];
        opruga(folder.path(), &call)
    };
    let output = sweep("0.04");
    let says = "note[run.whole_frames]: a run consists of whole frames, so it ends at t = 0.05 s instead of 0.04 s";
    assert!(said(&output).contains(says), "{}", said(&output));
    assert!(!said(&sweep("0.05")).contains("whole frames"));
}

#[test]
fn the_vector_instructions_that_run_are_those_that_the_summary_names() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |simd: &str| {
        let mut call = program(folder.path(), &["run", "ball", "--seconds=0.1", "--no-pictures", "--force", "--json"]);
        call.env("OPRUGA_SIMD", simd).output().expect("it runs")
    };
    for simd in ["scalar", "sse2", "avx2", "avx512"] {
        let output = run(simd);
        assert_eq!(code(&output), 0, "{simd}: {}", said(&output));
        let summary: Value = serde_json::from_str(&printed(&output)).expect("JSON");
        let other = warning(&summary, "simd.other");
        assert_eq!(other.is_none(), summary["simd"] == simd, "{simd}: {summary}");
        if let Some(other) = other {
            let used = summary["simd"].as_str().expect("a name");
            assert!(other["message"].as_str().is_some_and(|said| said.contains(used)), "{other}");
        }
    }
    for wrong in ["neon", "", "AVX2", "avx512 "] {
        assert_eq!(code(&run(wrong)), 2, "{wrong:?}");
    }
    let help = opruga(folder.path(), &["--help"]);
    assert!(printed(&help).contains("OPRUGA_SIMD=scalar|sse2|avx2|avx512"), "{}", printed(&help));
}

#[test]
fn errors_are_shown_up_to_fifty_and_counted_beyond_in_both_forms() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let keys: String = (0..600).map(|k| format!("k{k} = 1\n")).collect();
    std::fs::write(at.join("many.toml"), format!("format = \"opruga-1\"\ndimension = 2\n{keys}")).expect("a file");
    let people = said(&opruga(at, &["check", "many.toml"]));
    assert_eq!(people.matches("error[").count(), 51, "{people}");
    // 600 unknown fields, and the missing fields of the scene.
    assert!(
        people.contains("error[scene.more]: and 551 more") && people.trim_end().ends_with("601 errors"),
        "{people}"
    );
    let json: Value = serde_json::from_str(&said(&opruga(at, &["check", "many.toml", "--json"]))).expect("JSON");
    let more = json["more"].as_array().expect("a list");
    assert_eq!((more.len(), &more[49]["code"], &more[49]["value"]), (50, &"scene.more".into(), &"551".into()));
}

#[test]
fn a_deep_value_of_the_command_line_is_an_error_of_every_command() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    std::fs::write(at.join("in.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"><path d=\"M0 0H9V9Z\"/></svg>")
        .expect("a file");
    let deep = format!("={}", "[".repeat(10_000));
    let (gravity, path) = (format!("world.gravity{deep}"), format!("path{deep}"));
    let list = format!("world.gravity=[0,0],{}", "[".repeat(10_000));
    for call in [
        &["run", "ball", "--set", &gravity][..],
        &["check", "ball", "--set", &gravity],
        &["modes", "ball", "--set", &gravity],
        &["sweep", "ball", "--metric=energy_drift", "--set=time.substeps=8,16", "--set", &gravity],
        &["bench", "scene", "ball", "--set", &gravity],
        &["mesh", "in.svg", "--size=1", "--scale-to=3", "--set", &path],
    ] {
        let output = opruga(at, call);
        assert_eq!(code(&output), 2, "{:?}", &call[..2]);
        assert!(said(&output).contains("error[scene.depth]"), "{:?}: {:.300}", &call[..2], said(&output));
    }
    let output = opruga(at, &["sweep", "ball", "--metric=energy_drift", "--set", &list]);
    assert_eq!(output.status.code(), Some(2), "{:.300}", said(&output));
}

/// Free bodies have modes, whatever the integrator of the scene is.
#[test]
fn modes_of_a_free_body_do_not_ask_for_the_integrator_of_the_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let modes = |more: &[&str]| {
        let output = opruga(
            folder.path(),
            &[&["modes", "ball", "-n", "6", "--no-pictures", "--force", "--json"][..], more].concat(),
        );
        assert_eq!(code(&output), 0, "{}", said(&output));
        let found: Value = serde_json::from_str(&printed(&output)).expect("JSON");
        found["rows"].clone()
    };
    assert_eq!(modes(&["--set", "integrator=equilibrium"]), modes(&["--set", "integrator=backward_euler"]));
    // The search for the equilibrium is refused as before.
    let looked_for = opruga(folder.path(), &["modes", "ball", "--equilibrium", "--no-pictures", "--force"]);
    assert_ne!(code(&looked_for), 0);
}

/// Notes have codes: a scene without bodies has no pictures, and runs that share the machine are slower than a single one.
#[test]
fn what_is_worth_knowing_is_told_with_a_code() {
    let folder = tempfile::tempdir().expect("a folder");
    let empty = "format = \"opruga-1\"\ndimension = 2\nintegrator = \"verlet\"\n[time]\nseconds = 0.1\n";
    std::fs::write(folder.path().join("s.toml"), empty).expect("a file");
    let told = said(&opruga(folder.path(), &["run", "s.toml"]));
    assert!(told.contains("note[pictures.none]: no strip and no video: there is nothing to draw"), "{told}");
    let sweep = ["sweep", "ball", "--set", "body.ball.mass=1,2", "--metric", "nanoseconds_per_step"];
    let told = said(&opruga(folder.path(), &[&sweep[..], &["--seconds", "0.05", "--threads", "2"]].concat()));
    assert!(told.contains("note[threads.shared]: 2 runs shared the machine"), "{told}");
}
