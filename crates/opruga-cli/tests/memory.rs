//! Memory: estimates compared with the memory of runs, and limits of the machine.
#![cfg(target_os = "linux")]

#[path = "all/common/mod.rs"]
mod common;

use common::*;
use opruga::Registry;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::world::memory::estimate;
use std::process::Command;

fn text(dimension: usize, integrator: &str, body: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1e-4\nframe = 1e-4\nsubsteps = 2\n\
         [integrator]\n{integrator}\n[[body]]\nname = \"b\"\nmass = 1000.0\n{body}\n"
    )
}

/// The estimated memory of a scene [bytes].
fn estimated(text: &str) -> f64 {
    let read = scene::read(text.as_bytes(), "s.toml", &opruga::catalogue(), &scene::Options::default());
    let estimated = match read.expect("a scene").0 {
        AnyBlueprint::Plane(blueprint) => estimate(&blueprint, &Registry::default()),
        AnyBlueprint::Space(blueprint) => estimate(&blueprint, &Registry::default()),
    };
    estimated.expect("an estimate")
}

/// The largest memory of a run of a scene, including the program [bytes].
fn taken(text: &str) -> f64 {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("s.toml"), text).expect("a file");
    let mut child =
        program(folder.path(), &["run", "s.toml", "--no-pictures", "--out", "o"]).spawn().expect("the program runs");
    let status = format!("/proc/{}/status", child.id());
    let mut most = 0.0;
    while child.try_wait().expect("a status").is_none() {
        let kilobytes = std::fs::read_to_string(&status).ok().and_then(|text| {
            text.lines()
                .find_map(|line| line.strip_prefix("VmHWM:")?.trim().strip_suffix("kB")?.trim().parse::<f64>().ok())
        });
        most = kilobytes.map_or(most, |kilobytes| 1024.0 * kilobytes);
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(code(&output), 0, "{}", said(&output));
    most
}

/// Every kind of mesh with explicit and implicit integrators, with a matrix, without one, and with a factor.
#[test]
fn estimates_are_within_thirty_percent_of_what_runs_take() {
    estimates_hold(4);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn estimates_are_within_thirty_percent_of_what_runs_take_whole_sweep() {
    estimates_hold(1);
}

/// One in `stride` of all rows.
fn estimates_hold(stride: usize) {
    let springs = "models = [{ kind = \"mass_spring\", stiffness = 1.0 }]";
    let solid = "models = [{ kind = \"fem\", youngs_modulus = 1e4 }]";
    let cloth = "models = [{ kind = \"mass_spring\", stiffness = 1.0 }, { kind = \"bending\", stiffness = 1e-6 }]";
    let ring = |n: u32| format!("shape = {{ kind = \"ring\", radius = 1.0, vertices = {n} }}\n{springs}");
    let sheet =
        |n: u32| format!("shape = {{ kind = \"sheet\", u = [1, 0, 0], v = [0, 0, 1], cells = [{n}, {n}] }}\n{cloth}");
    let plate = |n: u32, more: &str| {
        format!("shape = {{ kind = \"grid\", size = [1, 1], cells = [{n}, {n}] }}\n{more}\n{solid}")
    };
    let block = |n: u32, more: &str| {
        format!("shape = {{ kind = \"grid\", size = [1, 1, 1], cells = [{n}, {n}, {n}] }}\n{more}\n{solid}")
    };
    let (linear, quadratic) = ("simplices = true\norder = 1", "simplices = true\norder = 2");
    let explicit = "kind = \"symplectic_euler\"";
    let implicit = |more: &str| format!("kind = \"backward_euler\"\n{more}");
    let iterative = implicit("linear_solver = \"conjugate_gradients\"");
    let (direct, without_matrix) =
        (implicit("linear_solver = \"cholesky\""), implicit("linear_solver = \"matrix_free\""));
    let real_time = implicit("accuracy = \"real_time\"");
    let rows = [
        (2, explicit, ring(150_000)),
        (2, &direct, ring(60_000)),
        (3, explicit, sheet(300)),
        (3, &iterative, sheet(150)),
        (2, explicit, plate(300, linear)),
        (2, &direct, plate(150, "")),
        (2, &real_time, plate(80, quadratic)),
        (3, explicit, block(40, "")),
        (3, &iterative, block(22, "")),
        (3, &without_matrix, block(25, linear)),
        (3, &real_time, block(12, quadratic)),
        (3, &direct, block(12, linear)),
    ];
    // The memory of the program itself depends on its libraries and its profile: a ring of three points shows it.
    let program = taken(&text(2, explicit, &ring(3)));
    for (dimension, integrator, body) in rows.into_iter().step_by(stride) {
        let text = text(dimension, integrator, &body);
        let (estimated, taken) = (estimated(&text), taken(&text) - program);
        let ratio = estimated / taken;
        println!("{ratio:.2} {:.1} MB {integrator:?} {body:?}", 1e-6 * taken);
        assert!(
            taken > 1e7 && (0.7..1.3).contains(&ratio),
            "{estimated:.3e} of {taken:.3e}: {ratio:.2}\n{integrator}\n{body}"
        );
    }
}

/// A limit of the address space is a limit of the scene: the scene is refused with its location before the program runs out of memory.
#[test]
fn what_the_machine_does_not_give_is_refused_at_the_body() {
    let folder = tempfile::tempdir().expect("a folder");
    let body = "shape = { kind = \"grid\", size = [1, 1, 1], cells = [40, 40, 40] }\nmodels = [{ kind = \"fem\", youngs_modulus = 1e5 }]";
    std::fs::write(folder.path().join("s.toml"), text(3, "kind = \"backward_euler\"", body)).expect("a file");
    let call = format!("ulimit -v 500000; exec {} run s.toml --json --out o", env!("CARGO_BIN_EXE_opruga"));
    let output = Command::new("bash").args(["-c", &call]).current_dir(folder.path()).output().expect("a shell");
    let error: serde_json::Value = serde_json::from_slice(&output.stderr).expect("one JSON object");
    assert_eq!((code(&output), &error["code"]), (2, &"limit.memory".into()), "{error}");
    assert!(
        error["line"].is_number() && error["allowed"] == "at most 409600000 bytes" && error["hint"].is_string(),
        "{error}"
    );
    assert!(!folder.path().join("o").exists(), "nothing is made for a scene that is refused");
}
