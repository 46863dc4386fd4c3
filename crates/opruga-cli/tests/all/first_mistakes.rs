//! Mistakes of the first hour: the program reports them in readable sentences and numbers.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;

/// A scene of one body, with its shape and model, and space for more lines.
fn scene(dimension: u32, body: &str, more: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 0.1\nsubsteps = 20\n[integrator]\nkind = \"verlet\"\n\
         [[body]]\nname = \"it\"\nmass = 1\n{body}\n{more}"
    )
}

const RING: &str = "shape = { kind = \"ring\", radius = 0.5, vertices = 24, center = [0, 0.4] }\n\
                    models = [{ kind = \"mass_spring\", stiffness = 900.0, damping = 1.0 }]";
const FLOOR: &str = "[[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\n";

fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("s.toml"), text).expect("a file");
}

/// A body that begins inside an obstacle is reported with the obstacle, the depth and the displacement that frees it; that displacement works.
#[test]
fn a_body_that_begins_inside_an_obstacle_is_told_of() {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), &scene(2, RING, FLOOR));
    let output = opruga(folder.path(), &["check", "s.toml"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let all = printed(&output);
    let line = all.lines().find(|l| l.contains("contact.starts_inside")).unwrap_or_else(|| panic!("it is told: {all}"));
    assert!(line.contains("body `it` begins inside obstacle 0 (half_space)"), "{line}");
    assert!(
        line.contains(", up to 0.1 m deep (node ") && line.contains("a shift by (0, 0.1) m would free the body"),
        "{line}"
    );
    // The run reports it once, before it begins, and counts it.
    let output = opruga(folder.path(), &["run", "s.toml", "--no-pictures", "--out", "a"]);
    assert_eq!(said(&output).matches("contact.starts_inside").count(), 1, "{}", said(&output));
    assert!(said(&output).starts_with("warning[contact.starts_inside]"), "{}", said(&output));
    let found = summary(folder.path(), &["run", "s.toml", "--out", "b"]);
    assert_eq!(found["warnings"][0]["code"], "contact.starts_inside");
    // With --strict it is an error at the body.
    let strict = opruga(folder.path(), &["run", "s.toml", "--strict", "--out", "c"]);
    assert_eq!(code(&strict), 2);
    assert!(
        said(&strict).contains("s.toml:8:") && said(&strict).contains("error[contact.starts_inside]"),
        "{}",
        said(&strict)
    );
    let freed = opruga(folder.path(), &["check", "s.toml", "--strict", "--set", "body.it.position=[0, 0.1]"]);
    assert_eq!(code(&freed), 0, "{}", said(&freed));
    // Pinned nodes stay where they are, and copies are reported once.
    let held =
        opruga(folder.path(), &["check", "s.toml", "--strict", "--set", "body.it.pin=[{ select = { all = true } }]"]);
    assert_eq!(code(&held), 0, "{}", said(&held));
    let copies = printed(&opruga(
        folder.path(),
        &["check", "s.toml", "--set", "body.it.copies={ count = [1, 5], spacing = [2, -0.01] }"],
    ));
    assert_eq!(copies.matches("contact.starts_inside").count(), 1, "{copies}");
    assert!(
        copies.contains("`it[4]`") && copies.contains("up to 0.14 m deep") && copies.contains("(5 times)"),
        "{copies}"
    );
}

/// A pin that pulls a body through a wall ends the run with the line of the wall. A pin that pulls a body through another one ends it with the line of
/// the pin.
#[test]
fn what_is_led_through_an_obstacle_or_a_body_ends_the_run_at_a_line_of_the_scene() {
    let folder = tempfile::tempdir().expect("a folder");
    let block = |name: &str, x: f64, more: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2], corner = [{x:?}, 0] }}\n\
             models = [{{ kind = \"fem\", youngs_modulus = 1e4 }}]\n{more}"
        )
    };
    let head = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nsubsteps = 4\n[integrator]\nkind = \"backward_euler\"\n[contact]\n";
    let led = |select: &str| {
        format!(
            "density = 100\n[[body.pin]]\nselect = {{ {select} }}\naxes = \"xy\"\nmotion = [[0, 0, 0], [1, 4, 0]]\n"
        )
    };
    let wall = "[[collider]]\nkind = \"box\"\nmin = [1.5, -3.0]\nmax = [1.7, 3.0]\n";
    let through_wall = format!("{head}{}{wall}", block("a", 0.0, &led("side = \"right\"")));
    let through_body = format!("{head}{}{}", block("b", 1.5, "fixed = true\n"), block("a", 0.0, &led("all = true")));
    for (text, cause) in [(through_wall, "[[collider]]"), (through_body, "[[body.pin]]")] {
        write(folder.path(), &text);
        let output = opruga(folder.path(), &["run", "s.toml", "--no-pictures", "--out", "led", "--force"]);
        let line = text.lines().position(|line| line == cause).expect("the cause") + 1;
        assert_ne!(code(&output), 0, "{}", said(&output));
        assert!(said(&output).contains(&format!("s.toml:{line}:")), "{cause} in line {line}: {}", said(&output));
        assert!(said(&output).contains("error[contact.led_through]"), "{}", said(&output));
    }
}

/// The displacement frees a body from any obstacle: inside a box, in the corner of a room, across a ball, in a convex block.
#[test]
fn the_shift_out_of_an_obstacle_frees_the_body() {
    let folder = tempfile::tempdir().expect("a folder");
    for collider in [
        "kind = \"box\"\nmin = [-0.2, 0.0]\nmax = [3.0, 3.0]",
        "kind = \"box\"\nmin = [-5.0, -5.0]\nmax = [5.0, 5.0]",
        "kind = \"box\"\nmin = [-0.4, 0.0]\nmax = [3.0, 3.0]\ninside = true",
        "kind = \"ball\"\ncenter = [0.2, 0.0]\nradius = 0.3",
        "kind = \"ball\"\ncenter = [0.2, 0.0]\nradius = 0.8\ninside = true",
        "kind = \"capsule\"\na = [-3.0, 0.0]\nb = [3.0, 0.0]\nradius = 0.2\nthickness = 0.05",
        "kind = \"convex\"\npoints = [[-2.0, -1.0], [2.0, -1.0], [0.0, 0.3]]",
    ] {
        write(folder.path(), &scene(2, RING, &format!("[[collider]]\n{collider}\n")));
        let all = printed(&opruga(folder.path(), &["check", "s.toml"]));
        assert!(all.contains("contact.starts_inside"), "{collider}: {all}");
        let shift = all.split("a shift by (").nth(1).and_then(|t| t.split(')').next());
        let shift = shift.unwrap_or_else(|| panic!("{collider}: {all}"));
        let output =
            opruga(folder.path(), &["check", "s.toml", "--strict", "--set", &format!("body.it.position=[{shift}]")]);
        assert_eq!(code(&output), 0, "{collider}: {shift}: {}", said(&output));
    }
}

/// An error that an override has caused is reported for that override, otherwise for the field in question.
#[test]
fn an_override_that_a_model_refuses_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let body = "shape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\nsimplices = true\norder = 1\nmodels = [\n\
                {\n kind = \"fem\", material = \"neo_hookean\",\n youngs_modulus = 1e4,\n poissons_ratio = 0.3 }]";
    write(folder.path(), &scene(2, body, ""));
    for path in ["body.it.models.fem.poissons_ratio", "body.0.models.0.poissons_ratio"] {
        let set = format!("{path}=0.49");
        let output = opruga(folder.path(), &["check", "s.toml", "--set", &set]);
        assert_eq!(code(&output), 2);
        assert!(said(&output).starts_with(&format!("--set {set}: error[model.locking]")), "{}", said(&output));
    }
    let text = scene(2, &body.replace("= 0.3", "= 0.49"), "");
    write(folder.path(), &text);
    let line = text.lines().position(|l| l.contains("poissons_ratio")).expect("it is there") + 1;
    let output = opruga(folder.path(), &["check", "s.toml", "--set", "body.it.models.fem.youngs_modulus=1e5"]);
    assert!(said(&output).starts_with(&format!("s.toml:{line}:")), "{}", said(&output));
}

/// The error about a rotation says what is expected, with an example.
#[test]
fn a_rotation_that_is_none_is_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let cube = "shape = { kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1] }\nmodels = []\n";
    for wrong in ["90", "\"90 degrees\"", "[0, 1]", "[0, 0, 0, 1]"] {
        write(folder.path(), &scene(3, &format!("{cube}rotation = {wrong}"), ""));
        let output = opruga(folder.path(), &["check", "s.toml"]);
        assert_eq!(code(&output), 2, "{wrong}");
        for part in ["the axis multiplied by the angle about it in radians", "[0, 0, 1.5708] turns by 90° about z"] {
            assert!(said(&output).contains(part), "{wrong}: {}", said(&output));
        }
    }
    write(folder.path(), &scene(2, &format!("{RING}\nrotation = [0, 0, 1]"), ""));
    let output = opruga(folder.path(), &["check", "s.toml"]);
    assert!(said(&output).contains("the angle in radians, counter-clockwise"), "{}", said(&output));
}

/// The words suggested for an unknown one exist in the dimension of the scene, each once.
#[test]
fn words_of_the_other_dimension_are_not_offered() {
    let folder = tempfile::tempdir().expect("a folder");
    let cube = "shape = { kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1] }\nmodels = []";
    for (dimension, body, allowed) in [
        (2, RING, "half_space, box, ball, capsule, convex, polyline"),
        (3, cube, "half_space, box, ball, capsule, convex, triangle_mesh"),
    ] {
        write(folder.path(), &scene(dimension, body, "[[collider]]\nkind = \"sphere\"\nradius = 1\n"));
        let output = opruga(folder.path(), &["check", "s.toml"]);
        assert_eq!(code(&output), 2);
        let line = said(&output).lines().find(|line| line.contains("allowed")).map(String::from);
        assert_eq!(line, Some(format!("  = allowed: {allowed}")), "{}", said(&output));
    }
}

/// For a name that is similar to several scenes, the nearest of them are suggested, not the first.
#[test]
fn all_near_names_are_offered() {
    let folder = tempfile::tempdir().expect("a folder");
    let hint = |word: &str| {
        let output = opruga(folder.path(), &["run", word]);
        assert_eq!(code(&output), 4);
        said(&output).lines().find(|l| l.contains("hint")).unwrap_or_default().to_string()
    };
    let near = hint("ballon");
    // Both differ by two letters, one of them only from a part of its name.
    assert!(
        near.starts_with("  = hint: did you mean `balloon-press`, `balloons`") && near.contains("`ball`"),
        "{near}"
    );
    let near = hint("canti-lever");
    assert!(near.contains("`cantilever`") && near.contains("`cantilever-cube`"), "{near}");
    assert_eq!(hint("presures"), "  = hint: did you mean `pressures`?");
}

/// Times and energies in sentences have a readable number of digits, whatever the run does.
#[test]
fn numbers_of_messages_are_short() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = scene(
        2,
        RING,
        "[[command]]\ndo = \"set\"\nat = 0.05\npath = \"body.it.models.mass_spring.stiffness\"\nvalue = -1\n",
    );
    write(folder.path(), &text);
    // A step that diverges: energies of many digits.
    let arguments = [
        "run",
        "s.toml",
        "--allow-unstable",
        "--no-pictures",
        "--seconds",
        "3",
        "--out",
        "o",
        "--set",
        "time.substeps=1",
        "--set",
        "body.it.models.mass_spring.stiffness=4e4",
        "--set",
        "command=[]",
        "--set",
        "body.it.velocity=[1, 2]",
    ];
    let output = opruga(folder.path(), &arguments);
    let all = said(&output);
    for word in all.split(|c: char| !(c.is_ascii_digit() || c == '.')) {
        assert!(word.len() <= 12, "{word}: {all}");
    }
    // A command that is refused gives its time once.
    let late = scene(
        2,
        RING,
        "[[command]]\ndo = \"remove\"\nat = 0.05\nbody = \"it\"\n[[command]]\ndo = \"push\"\nat = 0.07\nuntil = 0.09\nbody = \"it\"\nselect = { all = true }\nforce = [1, 0]\n",
    );
    write(folder.path(), &late);
    let output = opruga(folder.path(), &["run", "s.toml", "--no-pictures", "--out", "p"]);
    assert!(said(&output).matches("t = ").count() <= 1, "{}", said(&output));
}

/// Frequencies are printed in readable form; a growing mode has an imaginary one.
#[test]
fn frequencies_are_read_by_people_and_an_unstable_mode_is_called_so() {
    let folder = tempfile::tempdir().expect("a folder");
    // Compressed springs in a row between two walls buckle sideways.
    let chain = "shape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 4 }\npin = [{ select = { nodes = [0, 4] } }]\n\
                 models = [{ kind = \"mass_spring\", stiffness = 900.0, rest_scale = 1.2 }]";
    write(folder.path(), &scene(2, chain, ""));
    let output = opruga(folder.path(), &["modes", "s.toml", "-n", "4", "--out", "o"]);
    let all = printed(&output);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(all.contains("unstable: grows as exp(") && all.contains(" i "), "{all}");
    assert!(!all.contains("e0") && !all.contains("0.0000"), "{all}");
    let rows: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("o/modes.json")).expect("a file")).expect("JSON");
    let (growth, square) = (&rows["rows"][0]["growth"], &rows["rows"][0]["omega_squared"]);
    assert!(
        square.as_f64().is_some_and(|s| s < 0.0 && (growth.as_f64().unwrap_or(0.0).powi(2) + s).abs() < 1e-6 * -s),
        "{rows}"
    );
    assert!(folder.path().join("o/modes.png").is_file());
    // Without a load nothing resists lateral displacements, and the rounding error of that is not a growing mode.
    let slack = ["modes", "s.toml", "-n", "4", "--out", "p", "--set", "body.it.models.mass_spring.rest_scale=1"];
    let output = opruga(folder.path(), &slack);
    let all = printed(&output);
    assert_eq!(code(&output), 0, "{}", said(&output));
    assert!(all.matches("nothing resists it").count() == 3 && !all.contains("unstable"), "{all}");
}

/// A run that takes minutes reports this after its first frames, with ways to make it shorter.
#[test]
fn a_long_run_says_how_long_it_will_take() {
    use std::io::{BufRead as _, BufReader};
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), &scene(2, RING, FLOOR));
    let call =
        ["run", "s.toml", "--no-pictures", "--seconds", "1e6", "--out", "o", "--set", "integrator=backward_euler"];
    let mut run = program(folder.path(), &call).spawn().expect("it runs");
    // It precedes the first of the progress lines, which come every ten seconds.
    let mut all = String::new();
    for line in BufReader::new(run.stderr.take().expect("its talk")).lines() {
        all += &(line.expect("text") + "\n");
        if all.contains("note[") || all.contains(" left") {
            break;
        }
    }
    run.kill().expect("it is killed");
    run.wait().expect("it ends");
    let line = all
        .lines()
        .find(|l| l.starts_with("note[run.takes_long]: the run will take about "))
        .unwrap_or_else(|| panic!("{all}"));
    for part in [
        " more (",
        " frames of ",
        "To shorten it: --set integrator.accuracy=real_time",
        "--set integrator=symplectic_euler --set time.substeps=",
    ] {
        assert!(line.contains(part), "{part}: {line}");
    }
}

/// An error of the world is located at the parameter that it is about, with its value, whatever the names of bodies are.
#[test]
fn what_a_world_refuses_is_shown_at_its_parameter_whatever_bodies_are_called() {
    let folder = tempfile::tempdir().expect("a folder");
    let grid = "shape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\nsimplices = true\norder = 1\n[[body.models]]\nkind = \"fem\"\n\
                material = \"neo_hookean\"\nyoungs_modulus = 1e3";
    let chain = "shape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 2 }\n[[body.models]]\nkind = \"mass_spring\"";
    let called = |text: String, name: &str| text.replace("\"it\"", &format!("\"{name}\""));
    let unstable = called(scene(2, RING, ""), "frame").replace("substeps = 20", "frame = 0.02\nsubsteps = 1");
    let loose = called(scene(2, &format!("{grid}\npoissons_ratio = 0.3"), ""), "mass").replace("verlet", "equilibrium");
    let rows = [
        (unstable, "step.unstable", "time.substeps", "substeps = 1", Some("0.02")),
        (loose, "static.rigid_modes", "body.mass", "[[body]]", None),
        (
            scene(2, &format!("{grid}\npoissons_ratio = 0.499"), ""),
            "model.locking",
            "body.it.models.fem.poissons_ratio",
            "poissons_ratio = 0.499",
            Some("0.499"),
        ),
        (
            scene(2, &format!("{chain}\nmodulus = 1e3"), ""),
            "model.no_area",
            "body.it.models.mass_spring",
            "modulus = 1e3",
            None,
        ),
        (
            scene(2, RING, "").replace("mass = 1", "mass = 1e-310"),
            "scene.range",
            "body.it.mass",
            "mass = 1e-310",
            Some("1e-310"),
        ),
    ];
    for (text, code, path, line, value) in rows {
        write(folder.path(), &text);
        let output = opruga(folder.path(), &["check", "s.toml", "--json"]);
        let error: Value = serde_json::from_slice(&output.stderr).unwrap_or_else(|_| panic!("{}", said(&output)));
        let number = text.lines().position(|written| written == line).map(|index| index + 1);
        assert_eq!(
            (error["code"].as_str(), error["path"].as_str(), error["line"].as_u64(), error["value"].as_str()),
            (Some(code), Some(path), number.map(|number| number as u64), value),
            "{error}"
        );
    }
}
