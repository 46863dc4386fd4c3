//! Numbers in a scene that make sums or masses overflow or vanish are refused at their line, and JSON never has `null` for a number.

use std::path::PathBuf;
use std::process::{Command, Output};

/// A ring that falls onto a floor.
fn scene(gravity: &str, body: &str, more: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 0.05\nsubsteps = 16\n[world]\ngravity = {gravity}\n[integrator]\n\
         kind = \"verlet\"\n[[body]]\nname = \"b\"\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 12, center = [0.0, 2.0] }}\n\
         {body}\nmodels = [ {{ kind = \"mass_spring\", stiffness = 100.0, damping = 0.1 }} ]\n[[collider]]\nkind = \"half_space\"\n\
         point = [0.0, 0.0]\nnormal = [0.0, 1.0]\n{more}"
    )
}

fn run(name: &str, text: &str) -> Output {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("numbers-beyond-all").join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("scene.toml");
    std::fs::write(&file, text).expect("a scene");
    let mut program = Command::new(env!("CARGO_BIN_EXE_opruga"));
    program.args(["run", "--json", "--force", "--no-pictures", "--out"]).arg(folder.join("out")).arg(&file);
    program.output().expect("the program")
}

/// The error of a run, with the text of the line that it names.
fn refused(name: &str, text: &str) -> (serde_json::Value, String) {
    let output = run(name, text);
    let said = String::from_utf8_lossy(&output.stderr).to_string();
    assert_eq!(output.status.code(), Some(2), "{name}: {said}");
    let error: serde_json::Value =
        said.lines().find_map(|line| serde_json::from_str(line).ok()).unwrap_or_else(|| panic!("{name}: {said}"));
    let line = error["line"].as_u64().unwrap_or_else(|| panic!("{name}: {error}")) as usize;
    (error, text.lines().nth(line - 1).expect("a line").to_string())
}

#[test]
fn masses_and_weights_beyond_all_numbers_are_refused_at_their_line() {
    let usual = "[0.0, -9.81]";
    for (name, gravity, body, line) in [
        ("mass too small", usual, "mass = 5e-324", "mass = 5e-324"),
        ("node mass too small", usual, "node_mass = 1e-310", "node_mass = 1e-310"),
        ("density too small", usual, "density = 1e-320\nthickness = 0.5", "density = 1e-320"),
        ("too thin", usual, "density = 1.0\nthickness = 1e-300", "thickness = 1e-300"),
        ("mass too large", usual, "mass = 1.7e308", "mass = 1.7e308"),
        ("weight too large", "[0.0, -1e308]", "mass = 1.0", "gravity = [0.0, -1e308]"),
    ] {
        let (error, found) = refused(name, &scene(gravity, body, ""));
        assert_eq!((error["code"].as_str(), found.as_str()), (Some("scene.range"), line), "{name}: {error}");
        assert!(error["allowed"].is_string(), "{name}: {error}");
    }
}

/// Sums may overflow later although every state is finite; here because of a load.
#[test]
fn sums_that_overflow_in_a_run_stop_it() {
    let load = "[[load]]\nkind = \"force\"\nbody = \"b\"\nselect = { all = true }\nvalue = [1e307, 0.0]\ncurve = [[0.02, 0.0], [0.021, 1.0]]\n";
    let output = run("overflow", &scene("[0.0, -9.81]", "mass = 1e300", load));
    let said = String::from_utf8_lossy(&output.stderr).to_string();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("run.overflow"), "{said}");
}

#[test]
fn large_and_small_numbers_that_have_a_place_run_with_finite_sums() {
    for (name, gravity, body) in [
        ("light", "[0.0, -9.81]", "mass = 1e-290"),
        ("heavy", "[0.0, -9.81]", "mass = 1e150"),
        ("still", "[0.0, 0.0]", "mass = 1.0"),
    ] {
        let text = scene(gravity, body, "").replace("stiffness = 100.0, damping = 0.1", "stiffness = 1e-290");
        let output = run(name, &text);
        let said = String::from_utf8_lossy(&output.stdout).to_string();
        assert_eq!(output.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        let summary: serde_json::Value = serde_json::from_str(&said).expect("a summary");
        for part in ["energy", "momentum"] {
            assert!(!summary[part].to_string().contains("null"), "{name}: {summary}");
        }
    }
}

/// A seed is a whole number: a decimal point would not help.
#[test]
fn hints_are_of_the_field_they_are_for() {
    let text = format!("seed = 9007199254740993\n{}", scene("[0.0, -9.81]", "mass = 1.0", ""));
    let (error, line) = refused("seed", &text);
    assert_eq!((error["code"].as_str(), line.as_str()), (Some("scene.range"), "seed = 9007199254740993"));
    assert!(error["hint"].is_null() && error["allowed"] == "a whole number from 0 to 9007199254740992", "{error}");
    let text = scene("[0.0, -9.81]", "mass = 9007199254740993", "");
    assert!(refused("mass", &text).0["hint"].as_str().is_some_and(|hint| hint.contains("decimal point")));
}

/// A direction is valid even if the squares of its components overflow or underflow.
#[test]
fn normals_of_any_length_are_directions() {
    let hash = |normal: &str| {
        let text =
            scene("[0.0, -9.81]", "mass = 1.0", "").replace("normal = [0.0, 1.0]", &format!("normal = {normal}"));
        let output = run(&format!("normal {normal}"), &text);
        assert_eq!(output.status.code(), Some(0), "{normal}: {}", String::from_utf8_lossy(&output.stderr));
        let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a summary");
        summary["state_hash"].clone()
    };
    let expected = hash("[1.0, 1.0]");
    for normal in ["[1e300, 1e300]", "[1.7e308, 1.7e308]", "[1e-140, 1e-140]"] {
        assert_eq!(hash(normal), expected, "{normal}");
    }
}
