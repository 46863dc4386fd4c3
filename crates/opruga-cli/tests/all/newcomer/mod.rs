//! The experience of a first-time user: wrong words, wrong order, wrong numbers.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
mod texts;
mod window;

use common::*;
use serde_json::Value;

/// A scene of one falling ring, with space for more lines.
fn scene(more: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.1\nsubsteps = 20\n[integrator]\nkind = \"verlet\"\n\
         [world]\ngravity = [0, -9.81]\n[[body]]\nname = \"ring\"\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 24 }}\n\
         mass = 1\nmodels = [{{ kind = \"mass_spring\", stiffness = 900.0, damping = 1.0 }}]\n{more}"
    )
}

#[test]
fn options_that_exclude_each_other_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let cases: [(&[&str], &str, &str); 5] = [
        (&["run", "ball", "--resume", "x"], "[SCENE]", "--resume"),
        (&["run", "--strict", "--lenient"], "--strict", "--lenient"),
        (&["check", "ball", "--strict", "--lenient"], "--strict", "--lenient"),
        (&["run", "--gif", "--no-pictures"], "--gif", "--no-pictures"),
        (&["run", "--arrows", "--no-pictures"], "--arrows", "--no-pictures"),
    ];
    for (arguments, one, other) in cases {
        let output = opruga(folder.path(), arguments);
        assert_eq!(code(&output), 2, "{arguments:?}");
        assert!(said(&output).contains(one) && said(&output).contains(other), "{}", said(&output));
        assert!(said(&output).contains("cannot be used with"), "{}", said(&output));
    }
    assert_eq!(contents(folder.path()), []);
}

/// `--seconds` is the end of a run, also of a resumed one; a checkpoint at the end or after it is an error.
#[test]
fn a_resumed_run_with_nothing_left_to_do_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let first = summary(folder.path(), &["run", "pressures", "--seconds", "0.5", "--out", "a"]);
    assert_eq!(first["resumed_at"], Value::Null);
    for (seconds, text) in [("0.5", "the run ends at 0.5 s"), ("0.2", "the run ends at 0.2 s")] {
        let output = opruga(folder.path(), &["run", "--resume", "a/checkpoint", "--seconds", seconds, "--out", "b"]);
        assert_eq!(code(&output), 2, "{}", said(&output));
        assert!(said(&output).contains("the checkpoint is at t = 0.5 s") && said(&output).contains(text));
        assert!(
            said(&output)
                .contains("= hint: --seconds is the simulated time at which the run ends; it must be above 0.5"),
            "{}",
            said(&output)
        );
        assert!(!folder.path().join("b").exists(), "nothing is written");
    }
    let rest = summary(folder.path(), &["run", "--resume", "a/checkpoint", "--seconds", "0.75", "--out", "c"]);
    assert_eq!((&rest["resumed_at"], &rest["time"]), (&0.5.into(), &0.75.into()));
    assert_eq!(rest["steps"], 15 * 40, "the steps of this run");
    let help = printed(&opruga(folder.path(), &["run", "--help"]));
    assert!(help.contains("The simulated time at which the run ends"), "{help}");
    // A run that has reached its end, that of the scene or another one, is not extended unless asked.
    std::fs::write(folder.path().join("s.toml"), scene("")).expect("a file");
    for end in [&[][..], &["--seconds", "0.05"]] {
        summary(folder.path(), &[&["run", "s.toml", "--out", "s", "--force"], end].concat());
        let output = opruga(folder.path(), &["run", "--resume", "s/checkpoint", "--out", "t"]);
        assert_eq!(code(&output), 2);
        assert!(said(&output).contains("nothing is left to do"), "{}", said(&output));
    }
    // More frames than can be counted are refused, whatever the source of the number.
    let output = opruga(folder.path(), &["run", "s.toml", "--seconds", "1e7", "--set", "time.frame=1e-6"]);
    assert_eq!(code(&output), 2);
    assert!(said(&output).contains("at most 1e12 frames"), "{}", said(&output));
}

/// Errors of the reader and of a world made from the rest are reported together, in the order of their lines.
#[test]
fn errors_of_fields_indices_and_models_come_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = scene(
        "pin = [{ select = { node = 99 } }]\n\
         [[body]]\nname = \"line\"\nshape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 3 }\nmass = 1\n\
         models = [\n  { kind = \"mass_spring\", stiffness = 9.0 },\n  { kind = \"pressure\", nRT = 1.0 },\n]\n\
         [[body]]\nname = \"stiff\"\nshape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 3 }\nmass = 1e-3\n\
         models = [{ kind = \"mass_spring\", stiffness = 9e6 }]\ncopies = { count = [50], spacing = [2] }\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 0]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = -1\n\
         [[probe]]\nname = \"p\"\nbody = \"ring\"\nselect = { node = 24 }\nrecord = [\"position\"]\n",
    );
    std::fs::write(folder.path().join("s.toml"), &text).expect("a file");
    let line = |word: &str| text.lines().position(|l| l.contains(word)).map(|k| (k + 1) as u64);
    for command in [&["check", "s.toml", "--json"][..], &["run", "s.toml", "--json", "--out", "o"]] {
        let output = opruga(folder.path(), command);
        assert_eq!(code(&output), 2, "{}", said(&output));
        let first: Value = serde_json::from_slice(&output.stderr).expect("JSON");
        let all = std::iter::once(&first).chain(first["more"].as_array().expect("a list"));
        let found: Vec<(&str, Option<u64>)> =
            all.map(|e| (e["code"].as_str().unwrap_or_default(), e["line"].as_u64())).collect();
        let expected = [
            ("step.unstable", line("substeps")),
            ("scene.range", line("node = 99")),
            ("model.open_surface", line("kind = \"pressure\"")),
            ("scene.length", line("copies")),
            ("scene.range", line("normal = [0, 0]")),
            ("scene.range", line("friction = -1")),
            ("scene.range", line("node = 24")),
        ];
        // The copies have an error of their own, so their stiffness is unknown.
        let expected: Vec<_> = expected.into_iter().filter(|e| e.0 != "step.unstable").collect();
        assert_eq!(found, expected);
    }
    // Once the copies are right, their step is checked: once, not fifty times.
    std::fs::write(folder.path().join("s.toml"), text.replace("spacing = [2]", "spacing = [2, 0]")).expect("a file");
    let output = opruga(folder.path(), &["check", "s.toml"]);
    assert_eq!(said(&output).matches("error[step.unstable]").count(), 1, "{}", said(&output));
    assert!(said(&output).ends_with("6 errors\n"), "{}", said(&output));
}

/// Too long a step is explained over several lines; its location is that of the step.
#[test]
fn an_unstable_step_is_explained_line_by_line() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), scene("").replace("substeps = 20", "substeps = 1")).expect("a file");
    let output = opruga(folder.path(), &["run", "s.toml", "--out", "o"]);
    assert_eq!(code(&output), 2);
    let text = said(&output);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 5, "{text}");
    assert_eq!(
        lines[0],
        "s.toml:5:12: error[step.unstable]: the step h = 0.0166667 s of `verlet` is unstable for body `ring`"
    );
    assert_eq!(lines[1], " 5 | substeps = 1");
    assert!(lines[3].starts_with("  = allowed: h <= ") && lines[3].contains("rad/s"), "{text}");
    assert!(lines[4].starts_with("  = hint: use substeps >= ") && lines[4].contains("--set time.substeps="), "{text}");
    assert!(lines.iter().all(|l| l.chars().count() < 120), "{text}");
    // The hint is right, and a value given by --set is not searched for in the file.
    let hint = lines[4].split("--set ").nth(1).and_then(|h| h.split(',').next()).expect("a hint");
    assert_eq!(code(&opruga(folder.path(), &["check", "s.toml", "--set", hint])), 0, "{hint}");
    let output = opruga(folder.path(), &["check", "s.toml", "--set", "time.substeps=2"]);
    assert!(said(&output).starts_with("--set time.substeps=2: error[step.unstable]"), "{}", said(&output));
    assert!(!folder.path().join("o").exists(), "no folder is made for a run that is refused");
}

#[test]
fn what_is_not_there_is_no_error_in_a_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("meine.toml"), scene("")).expect("a file");
    std::fs::write(folder.path().join("unser.toml"), scene("")).expect("a file");
    for name in ["ball", "unser"] {
        std::fs::create_dir(folder.path().join(name)).expect("a folder");
    }
    let cases: [(&[&str], i32, &str); 14] = [
        (&["run", "zebra"], 4, "= hint: scenes that come with the program: ball, ball-as-published, "),
        (&["run", "qqqqqqqqqqqqqqqqqqqqqqqq"], 4, "= hint: scenes that come with the program: ball, "),
        (&["check", "unser"], 4, "= hint: did you mean `unser.toml`?"),
        (&["run", "presures"], 4, "= hint: did you mean `pressures`?"),
        (&["check", "meine"], 4, "= hint: did you mean `meine.toml`?"),
        (&["check", "miene.toml"], 4, "= hint: did you mean `meine.toml`?"),
        (&["run", "--resume", "zebra"], 4, "= hint: a run writes it into its output folder"),
        (&["new", "nowhere/mine"], 4, "= hint: its parent folder is missing"),
        (&["new", ""], 2, "allowed: the name of a file"),
        (&["bench", "vertices", "--plot", "nowhere/speed.svg"], 4, "= hint: its parent folder is missing"),
        (&["bench", "vertices", "--only", "7"], 2, "--only is 7; allowed: 8, 16, 36, "),
        (&["bench", "vertices", "--only", "2x36"], 2, "100x36, 1000x36, 27778x36"),
        (
            &["check", "ball", "--set", "time.substeps=8,16"],
            2,
            "= hint: `opruga sweep` accepts lists (8,16,32) and ranges",
        ),
        (&["check", "ball", "--set", "body.ball.mass=0.5..4:log:7"], 2, "= hint: `opruga sweep` accepts lists"),
    ];
    for (arguments, exit, text) in cases {
        let output = opruga(folder.path(), arguments);
        assert_eq!(code(&output), exit, "{arguments:?}: {}", said(&output));
        assert!(said(&output).contains(text), "{arguments:?}: {}", said(&output));
        assert!(!said(&output).contains("in the scene"), "{arguments:?}: {}", said(&output));
    }
    // A folder with the name of a scene, such as its output, does not hide the scene.
    let output = opruga(folder.path(), &["check", "ball"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(printed(&output).starts_with("scene ball (built in): no errors\n"), "{}", printed(&output));
    let output = opruga(folder.path(), &["check", "ball", "--set", "time.substeps=1"]);
    assert!(!said(&output).contains("ball.toml"), "{}", said(&output));
    // A run writes its checkpoint to a folder; if the user names the folder, the message names the file.
    summary(folder.path(), &["run", "meine.toml", "--out", "o"]);
    let output = opruga(folder.path(), &["run", "--resume", "o"]);
    assert_eq!(code(&output), 4);
    assert!(said(&output).contains("= hint: did you mean `o/checkpoint`?"), "{}", said(&output));
}

#[test]
fn a_new_scene_replaces_an_old_one_only_with_force() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |arguments: &[&str]| opruga(folder.path(), arguments);
    assert_eq!(code(&at(&["new", "a.b"])), 0);
    let path = folder.path().join("a.b.toml");
    std::fs::write(&path, "years of work").expect("the file has the whole name");
    let refused = at(&["new", "a.b.toml"]);
    assert_eq!(code(&refused), 4);
    assert!(said(&refused).contains("= hint: --force replaces it"), "{}", said(&refused));
    assert_eq!(std::fs::read(&path).expect("a file"), b"years of work");
    assert_eq!(code(&at(&["new", "a.b", "--force"])), 0);
    assert_eq!(code(&at(&["check", "a.b.toml"])), 0);
    // The suggested command can be typed as it is.
    for (name, typed) in [("plain", "plain.toml"), ("two words", "'two words.toml'"), ("it's", "'it'\\''s.toml'")] {
        let output = at(&["new", name]);
        assert!(said(&output).contains(&format!("try `opruga run {typed}`")), "{}", said(&output));
    }
    let output = at(&["new", "--", "-x"]);
    assert!(said(&output).contains("try `opruga run ./-x.toml`"), "{}", said(&output));
    assert_eq!(code(&at(&["check", "./-x.toml"])), 0);
    let json = at(&["new", "a.b", "--json"]);
    let error: Value = serde_json::from_slice(&json.stderr).expect("JSON");
    assert_eq!(error["code"], "write.exists");
}

#[test]
fn every_kind_is_listed_once_with_its_dimensions() {
    let folder = tempfile::tempdir().expect("a folder");
    let list = printed(&opruga(folder.path(), &["list"]));
    let rows = |kind: &str| list.lines().filter(|l| l.split_whitespace().next() == Some(kind)).collect::<Vec<_>>();
    for (kind, dimensions) in
        [("half_space", "2D 3D"), ("capsule", "2D 3D"), ("triangle_mesh", "3D"), ("icosphere", "3D")]
    {
        let rows = rows(kind);
        assert_eq!(rows.len(), 1, "{rows:?}");
        let words: Vec<&str> = rows[0].split_whitespace().collect();
        assert!(words[1..].join(" ").starts_with(dimensions), "{rows:?}");
    }
    let json: Value = serde_json::from_slice(&opruga(folder.path(), &["list", "--json"]).stdout).expect("JSON");
    for section in ["models", "integrators", "shapes", "colliders"] {
        let kinds: Vec<&str> =
            json[section].as_array().expect("a list").iter().filter_map(|k| k["kind"].as_str()).collect();
        let mut once = kinds.clone();
        once.sort_unstable();
        once.dedup();
        assert_eq!(once.len(), kinds.len(), "{section}: {kinds:?}");
    }
    let collider = |kind: &str| {
        let all = json["colliders"].as_array().expect("a list").clone();
        all.into_iter().find(|c| c["kind"] == kind).expect("it is there")["dimensions"].clone()
    };
    assert_eq!(collider("half_space"), serde_json::json!([2, 3]));
    assert_eq!(collider("triangle_mesh"), serde_json::json!([3]));
}

#[test]
fn a_run_without_steps_claims_no_speed() {
    let folder = tempfile::tempdir().expect("a folder");
    let still = summary(folder.path(), &["run", "pressures", "--seconds", "0", "--out", "a"]);
    assert_eq!((&still["steps"], &still["nanoseconds_per_node_step"]), (&0.into(), &Value::Null));
    let output = opruga(folder.path(), &["run", "pressures", "--seconds", "0", "--out", "b", "--no-pictures"]);
    assert!(said(&output).contains("no steps") && !said(&output).contains("ns per"), "{}", said(&output));
    let moving = summary(folder.path(), &["run", "pressures", "--seconds", "0.1", "--out", "c"]);
    assert!(moving["nanoseconds_per_node_step"].as_f64().is_some_and(|ns| ns > 0.0));
}

/// Row 57: if a body would be stretched by more than its size under its own weight, its units are probably inconsistent.
#[test]
fn mixed_units_are_warned_of() {
    let folder = tempfile::tempdir().expect("a folder");
    // A ring of 1 m in millimetres, but not its density and gravity.
    let millimetres = scene("")
        .replace("radius = 0.5", "radius = 500.0")
        .replace("mass = 1\n", "density = 1000.0\nthickness = 1.0\n");
    let millimetres = millimetres.replace("substeps = 20", "substeps = 1");
    std::fs::write(folder.path().join("mm.toml"), &millimetres).expect("a file");
    std::fs::write(folder.path().join("m.toml"), scene("")).expect("a file");
    let found = summary(folder.path(), &["run", "mm.toml", "--out", "a"]);
    assert_eq!(found["warnings"][0]["code"], "units.sag", "{}", found["warnings"]);
    assert_eq!(summary(folder.path(), &["run", "m.toml", "--out", "b"])["warnings"], serde_json::json!([]));
    let output = opruga(folder.path(), &["run", "mm.toml", "--out", "c", "--no-pictures"]);
    assert!(said(&output).contains("warning[units.sag]: body `ring` of "), "{}", said(&output));
    assert!(!said(&output).contains("(1 times)"), "{}", said(&output));
    let strict = opruga(folder.path(), &["run", "mm.toml", "--out", "d", "--strict"]);
    assert_eq!(code(&strict), 2);
    assert!(said(&strict).contains("error[units.sag]"), "{}", said(&strict));
    // Without weight, or without anything that could sag, there is no warning.
    for set in ["world.gravity=[0, 0]", "body.ring.models=[]"] {
        assert_eq!(code(&opruga(folder.path(), &["check", "mm.toml", "--strict", "--set", set])), 0, "{set}");
    }
}

/// A rate that no film can have is reported before the run, not after it.
#[test]
fn a_film_that_cannot_be_is_refused_before_the_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let slow = ["run", "pressures", "--set", "time.seconds=2e9", "--fps", "1e-9", "--out", "o"];
    let output = opruga(folder.path(), &slow);
    assert_eq!(code(&output), 2, "{}", said(&output));
    assert!(
        said(&output).contains("--fps 0.000000001") && said(&output).contains("0.0001 to 10000"),
        "{}",
        said(&output)
    );
    assert!(!folder.path().join("o").exists());
    for fps in ["0", "-1", "nan", "inf", "1e9", "241"] {
        let output = opruga(folder.path(), &["run", "pressures", "--fps", fps]);
        assert_eq!(code(&output), 2, "{fps}: {}", said(&output));
        assert!(said(&output).contains("allowed: numbers above 0, at most 240"), "{fps}: {}", said(&output));
    }
    let output = opruga(folder.path(), &["run", "pressures", "--fps", "0.0002", "--seconds", "0.1", "--out", "o"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
}

/// There is one picture for a whole number of frames of the scene; if this gives another rate than requested, it is reported.
#[test]
fn a_rate_of_pictures_that_frames_do_not_have_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let said_of = |more: &[&str]| {
        let all = [&["run", "pressures", "--seconds", "0.1", "--out", "o", "--force"], more].concat();
        let output = opruga(folder.path(), &all);
        assert_eq!(code(&output), 0, "{}", said(&output));
        said(&output)
    };
    let told = said_of(&["--fps", "11.3"]);
    assert!(told.contains("note[pictures.rate]: there are 12 pictures per second, not 11.3 (--fps)"), "{told}");
    for more in [&["--fps", "12"][..], &[], &["--fps", "11.3", "--no-pictures"], &["--fps", "11.3", "--json"]] {
        assert!(!said_of(more).contains("pictures per second"), "{more:?}");
    }
}

/// Row 78: more threads than cores are one warning, and so is anything unusual in the scene. A run that fails names the folder of its output.
#[test]
fn warnings_are_told_once_and_failures_say_where_the_output_lies() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), scene("colour = \"red\"\n")).expect("a file");
    let output =
        opruga(folder.path(), &["run", "s.toml", "--lenient", "--threads", "256", "--no-pictures", "--out", "o"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    for code in ["warning[scene.unknown_field]", "warning[threads.above_cores]: 256 threads on "] {
        assert_eq!(said(&output).matches(code).count(), 1, "{}", said(&output));
    }
    let text = std::fs::read_to_string(folder.path().join("o/summary.json")).expect("a summary");
    assert!(text.contains("scene.unknown_field") && text.contains("threads.above_cores"), "{text}");
    let wild = ["run", "pressures", "--set", "time.substeps=1", "--allow-unstable", "--no-pictures", "--out", "w"];
    let output = opruga(folder.path(), &wild);
    assert_eq!(code(&output), 3);
    assert!(said(&output).contains("written to w/\n"), "{}", said(&output));
    // A command may make the step too long during the run; the message gives the time.
    let harden =
        "[[command]]\ndo = \"set\"\nat = 0.05\npath = \"body.ring.models.mass_spring.stiffness\"\nvalue = 9e9\n";
    std::fs::write(folder.path().join("h.toml"), scene(harden)).expect("a file");
    let output = opruga(folder.path(), &["run", "h.toml", "--no-pictures", "--out", "h"]);
    assert_eq!(code(&output), 2);
    let told = "h.toml:19:9: error[step.unstable]: at t = 0.05 s: the command `set`: the step h = ";
    assert!(said(&output).contains(told), "{}", said(&output));
    assert!(said(&output).contains("= hint: use another `value`, or substeps >= "), "{}", said(&output));
    assert!(said(&output).contains("written to h/\n"), "{}", said(&output));
    // Any other command that steps through the scene names the command as well.
    let timed = ["bench", "scene", "h.toml", "--frames", "9"];
    for call in [&["modes", "h.toml", "--after", "0.2", "--out", "m"][..], &timed] {
        let output = opruga(folder.path(), call);
        assert!(code(&output) == 2 && said(&output).contains(told), "{call:?}: {}", said(&output));
    }
}

/// If a command makes the step unstable, its line is reported, and the hint helps.
#[test]
fn a_command_that_makes_the_step_unstable_is_named_with_what_helps() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |text: &str, more: &[&str]| {
        std::fs::write(folder.path().join("s.toml"), scene(text)).expect("a file");
        opruga(folder.path(), &[&["run", "s.toml", "--no-pictures", "--out", "o", "--force"], more].concat())
    };
    let number_after = |all: &str, before: &str| {
        let rest = all.split(before).nth(1).unwrap_or_else(|| panic!("{before}: {all}"));
        rest.split(|c: char| !c.is_ascii_digit()).next().unwrap_or_default().to_string()
    };
    let coarse = "[[command]]\ndo = \"set\"\nat = 0.05\npath = \"time.substeps\"\nvalue = 1\n";
    let output = run(coarse, &[]);
    assert_eq!(code(&output), 2);
    let all = said(&output);
    assert!(all.contains("s.toml:19:9: error[step.unstable]: at t = 0.05 s: the command `set`: the step"), "{all}");
    let enough = number_after(&all, "= hint: use a `value` of ");
    let output = run(&coarse.replace("value = 1", &format!("value = {enough}")), &[]);
    assert_eq!(code(&output), 0, "{enough}: {}", said(&output));

    let hard = "[[command]]\nat = 0.05\ndo = \"add\"\nbody = { name = \"hard\", mass = 1, shape = { kind = \"ring\", radius = 0.5, \
                vertices = 24 }, models = [{ kind = \"mass_spring\", stiffness = 1e6 }] }\n";
    let output = run(hard, &[]);
    assert_eq!(code(&output), 2);
    let all = said(&output);
    assert!(all.contains("s.toml:17:6: error[step.unstable]: at t = 0.05 s: the command `add`: the step"), "{all}");
    assert!(
        all.contains("for body `hard`") && all.contains("= hint: use a softer or heavier body, or substeps >= "),
        "{all}"
    );
    let set = format!("time.substeps={}", number_after(&all, "--set time.substeps="));
    assert_eq!(code(&run(hard, &["--set", &set])), 0, "{set}");
    // An override remains in effect until a command sets the same parameter, so it is not offered then.
    let both = format!("{}{hard}", coarse.replace("value = 1", "value = 20"));
    let all = said(&run(&both, &[]));
    assert!(all.contains("an earlier command that sets substeps >= ") && !all.contains("--set"), "{all}");
}

#[test]
fn who_leaves_out_run_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for (word, hint) in [("ball", true), ("mine.toml", true), ("bananas", false)] {
        let output = opruga(folder.path(), &[word]);
        assert_eq!(code(&output), 2);
        assert_eq!(said(&output).contains(&format!("= hint: opruga run {word}")), hint, "{}", said(&output));
    }
}

/// With --json all output is JSON: errors of the call, warnings of the scene, and the result of a check.
#[test]
fn with_json_nothing_else_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = scene("colour = \"red\"\n");
    std::fs::write(folder.path().join("s.toml"), &text).expect("a file");
    let call: Value =
        serde_json::from_slice(&opruga(folder.path(), &["run", "--json", "--thread", "2"]).stderr).expect("JSON");
    assert!(call["code"] == "call" && call["message"].as_str().is_some_and(|m| m.contains("--thread")), "{call}");
    let output = opruga(folder.path(), &["run", "s.toml", "--lenient", "--json", "--no-pictures", "--out", "o"]);
    assert_eq!((code(&output), said(&output)), (0, String::new()));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(found["warnings"][0]["code"], "scene.unknown_field");
    let output = opruga(folder.path(), &["check", "s.toml", "--lenient", "--json"]);
    assert_eq!((code(&output), said(&output)), (0, String::new()));
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((&found["errors"], &found["nodes"], &found["warnings"][0]["line"]), (&0.into(), &24.into(), &15.into()));
}

#[test]
fn a_command_after_the_end_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let late = scene(
        "[[command]]\nat = 0.5\nuntil = 0.6\ndo = \"push\"\nbody = \"ring\"\nselect = { all = true }\nforce = [1, 0]\n",
    );
    std::fs::write(folder.path().join("s.toml"), late).expect("a file");
    let output = opruga(folder.path(), &["check", "s.toml"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(said(&output).contains("warning[command.never]: the command begins at 0.5 s, but the run ends at 0.1 s"));
    // A user who asks for a shorter run knows what is omitted.
    let output = opruga(folder.path(), &["check", "s.toml", "--set", "time.seconds=0.2"]);
    assert!(!said(&output).contains("command.never"), "{}", said(&output));
}

/// The first command of the README also works a second time, and does not change the first output.
#[test]
fn the_program_without_a_command_finds_a_folder_that_is_free() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir_all(folder.path().join("out/ball")).expect("a folder");
    std::fs::write(folder.path().join("out/ball/summary.json"), "mine").expect("a file");
    let output =
        program(folder.path(), &[]).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").output().expect("it runs");
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(folder.path().join("out/ball-2/strip.png").exists(), "{}", said(&output));
    assert_eq!(std::fs::read(folder.path().join("out/ball/summary.json")).expect("it is there"), b"mine");
}

/// Files that a run does not write itself do not stay among its output.
#[test]
fn pictures_of_an_earlier_run_go_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), scene("")).expect("a file");
    let names = |more: &[&str]| -> Vec<String> {
        let output = opruga(folder.path(), &[&["run", "s.toml", "--out", "o", "--force"], more].concat());
        assert_eq!(code(&output), 0, "{}", said(&output));
        contents(&folder.path().join("o")).into_iter().map(|(name, _)| name).collect()
    };
    assert!(names(&[]).contains(&"video.mp4".into()));
    let gif = names(&["--gif"]);
    assert!(gif.contains(&"video.gif".into()) && !gif.contains(&"video.mp4".into()), "{gif:?}");
    assert_eq!(names(&["--no-pictures"]), ["checkpoint", "diagnostics.csv", "final.csv", "summary.json"]);
}

/// `check --allow-unstable` accepts what `run --allow-unstable` accepts, with the same warning.
#[test]
fn a_step_above_the_limit_can_be_checked_as_it_is_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let call = ["check", "ball", "--set", "body.ball.models.mass_spring.stiffness=1e9", "--json"];
    let refused = opruga(folder.path(), &call);
    assert_eq!(code(&refused), 2);
    assert!(said(&refused).contains("step.unstable"), "{}", said(&refused));
    let taken = opruga(folder.path(), &[&call[..], &["--allow-unstable"]].concat());
    assert_eq!(code(&taken), 0, "{}", said(&taken));
    let found: Value = serde_json::from_slice(&taken.stdout).expect("JSON");
    assert!(
        found["warnings"].as_array().is_some_and(|all| all.iter().any(|w| w["code"] == "step.unstable")),
        "{found}"
    );
}
