//! `opruga run --stress`: stress, von Mises stress and J of every node in `final.csv`; `--set` into velocity fields.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::{code, opruga, said};

const SCENE: &str = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nframe = 1.0\nsubsteps = 1\n[integrator]\nkind = \"equilibrium\"\n\
    [[body]]\nname = \"bar\"\nshape = { kind = \"grid\", size = [2, 1], cells = [4, 2] }\nmass = 1\n\
    models = [{ kind = \"fem\", material = \"linear\", youngs_modulus = 1e4, poissons_ratio = 0.25, plane = \"stress\" }]\n\
    pin = [{ select = { side = \"left\" }, axes = \"x\" }, { select = { side = \"bottom\" }, axes = \"y\" }]\n\
    [[load]]\nkind = \"traction\"\nbody = \"bar\"\nselect = { side = \"right\" }\nvalue = [100, 0]\n";

#[test]
fn final_csv_has_the_stress_of_every_node_on_request() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bar.toml"), SCENE).expect("a scene");
    let run = |out: &str, more: &[&str]| {
        let output = opruga(folder.path(), &[&["run", "bar.toml", "--no-pictures", "--out", out], more].concat());
        assert_eq!(code(&output), 0, "{}", said(&output));
        std::fs::read_to_string(folder.path().join(out).join("final.csv")).expect("a table")
    };
    let plain = run("plain", &[]);
    assert!(plain.starts_with("body,node,x,y,vx,vy\n"), "{plain}");
    let table = run("stress", &["--stress"]);
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("body,node,x,y,vx,vy,sxx,syy,szz,sxy,von_mises,volume_ratio"));
    // The other columns are unchanged, with all their digits.
    for (own, other) in table.lines().zip(plain.lines()) {
        assert!(own.starts_with(other), "{own}\n{other}");
    }
    // A bar under tension: σxx = 100 Pa and nothing else, J = (1 + ε)(1 − νε)².
    let strain = 100.0 / 1e4;
    let ratio = (1.0 + strain) * (1.0 - 0.25 * strain) * (1.0 - 0.25 * strain);
    for line in lines {
        let numbers: Vec<f64> = line.split(',').skip(6).map(|x| x.parse().expect("a number")).collect();
        for (found, wanted) in numbers.iter().zip([100.0, 0.0, 0.0, 0.0, 100.0, ratio]) {
            assert!((found - wanted).abs() < 1e-6, "{line}");
        }
    }
    // Bodies without finite elements have no numbers.
    let springs =
        opruga(folder.path(), &["run", "ball", "--seconds", "0", "--no-pictures", "--out", "ball", "--stress"]);
    assert_eq!(code(&springs), 0, "{}", said(&springs));
    let table = std::fs::read_to_string(folder.path().join("ball/final.csv")).expect("a table");
    assert!(table.lines().nth(1).is_some_and(|line| line.ends_with("NaN,NaN,NaN,NaN,NaN,NaN")), "{table}");
}

#[test]
fn overrides_reach_into_the_velocity_of_a_body() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bar.toml"), SCENE.replace("equilibrium", "backward_euler")).expect("a scene");
    let output = opruga(
        folder.path(),
        &[
            "run",
            "bar.toml",
            "--no-pictures",
            "--seconds",
            "0",
            "--out",
            "o",
            "--set",
            "body.bar.velocity.gradient=[[0, 0], [0.5, 0]]",
        ],
    );
    assert_eq!(code(&output), 0, "{}", said(&output));
    let table = std::fs::read_to_string(folder.path().join("o/final.csv")).expect("a table");
    for line in table.lines().skip(1) {
        let numbers: Vec<f64> = line.split(',').skip(2).map(|x| x.parse().expect("a number")).collect();
        assert!((numbers[3] - 0.5 * (numbers[0] - 1.0)).abs() < 1e-12 && numbers[2] == 0.0, "{line}");
    }
    let wrong = opruga(folder.path(), &["check", "bar.toml", "--set", "body.bar.velocity.gradient=[[1]]"]);
    assert_eq!(code(&wrong), 2, "{}", said(&wrong));
}
