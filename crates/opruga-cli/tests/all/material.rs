//! `opruga material`: the results of a law at one deformation gradient.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::{code, opruga, printed, said};
use serde_json::Value;
use std::path::Path;

fn told(arguments: &[&str]) -> Value {
    let output = opruga(Path::new("."), &[&["material"], arguments, &["--json"]].concat());
    assert_eq!(code(&output), 0, "{arguments:?}: {}", said(&output));
    serde_json::from_slice(&output.stdout).expect("stdout is JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{found} {expected}");
}

#[test]
fn energy_stress_and_tangent_of_hookes_law_are_those_of_the_textbook() {
    let (e, nu, strain) = (1e3, 0.25, 0.1);
    let (mu, lambda) = (e / (2.0 * (1.0 + nu)), e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)));
    let space = told(&["linear", "--F", "1.1,0,0,0,1,0,0,0,1", "--E", "1000", "--nu", "0.25"]);
    close(number(&space["energy_density"]), (mu + 0.5 * lambda) * strain * strain);
    close(number(&space["stress"][0][0]), (2.0 * mu + lambda) * strain);
    close(number(&space["stress"][1][1]), lambda * strain);
    close(number(&space["tangent"][0][0]), 2.0 * mu + lambda);
    close(number(&space["tangent"][0][4]), lambda);
    close(number(&space["tangent"][1][3]), mu);
    assert_eq!((space["setting"].as_str(), space["stretch_across"].as_f64()), (Some("space"), None));
    // A plate is softer in plane stress: E/(1 − ν²), and its thickness decreases by ν/(1 − ν) of the strain.
    let plate = told(&["linear", "--F", "[[1.1, 0], [0, 1]]", "--E", "1e3", "--nu", "0.25", "--plane", "stress"]);
    close(number(&plate["stress"][0][0]), e / (1.0 - nu * nu) * strain);
    close(number(&plate["tangent"][0][0]), e / (1.0 - nu * nu));
    close(number(&plate["stretch_across"]), 1.0 - nu / (1.0 - nu) * strain);
    let slice = told(&["linear", "--F", "1.1,0,0,1", "--E", "1e3", "--nu", "0.25"]);
    close(number(&slice["stress"][0][0]), (2.0 * mu + lambda) * strain);
    close(number(&slice["volume_ratio"]), 1.1);
}

#[test]
fn the_stress_is_the_slope_of_the_energy_and_the_tangent_that_of_the_stress() {
    let f = [1.2, 0.1, -0.05, 0.02, 0.9, 0.15, 0.1, -0.08, 1.05];
    let step = 1e-6;
    for name in ["stable_neo_hookean", "mooney_rivlin", "corotated"] {
        let at = |f: &[f64]| {
            let words: Vec<String> = f.iter().map(f64::to_string).collect();
            told(&[name, "--F", &words.join(",")])
        };
        let here = at(&f);
        for k in [0, 5] {
            let (mut ahead, mut behind) = (f, f);
            ahead[k] += step;
            behind[k] -= step;
            let (ahead, behind) = (at(&ahead), at(&behind));
            let slope = |of: &dyn Fn(&Value) -> f64| (of(&ahead) - of(&behind)) / (2.0 * step);
            let stress = number(&here["stress"][k / 3][k % 3]);
            assert!((slope(&|v| number(&v["energy_density"])) - stress).abs() < 1e-8, "{name}");
            for row in 0..9 {
                let found = slope(&|v| number(&v["stress"][row / 3][row % 3]));
                assert!((found - number(&here["tangent"][row][k])).abs() < 1e-7, "{name} {row} {k}");
            }
        }
    }
}

#[test]
fn people_read_the_parameters_and_both_tables() {
    let output = opruga(Path::new("."), &["material", "mooney_rivlin", "--F", "1,0,0,1", "--set", "mooney_share=0.1"]);
    assert_eq!(code(&output), 0, "{}", said(&output));
    let text = printed(&output);
    for part in [
        "`mooney_rivlin`, plane strain: E = 1 Pa, ν = 0.3",
        "mooney_share = 0.1",
        "J = 1\n",
        "ψ = ",
        "P = ∂ψ/∂F",
        "∂P/∂F",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    // Headers and rows of the tangent.
    assert_eq!(text.lines().filter(|line| line.trim_start().starts_with("xy ")).count(), 1, "{text}");
}

#[test]
fn what_makes_no_sense_is_refused_with_what_is_allowed() {
    let rows: [(&[&str], &str, &str); 10] = [
        (&["neo_hokean", "--F", "1,0,0,1"], "scene.unknown_name", "did you mean `neo_hookean`?"),
        (&["neo_hookean", "--F", "1,0,1"], "material.gradient", "4 finite numbers (2D) or 9 (3D)"),
        (&["neo_hookean", "--F", "1,0,zero,1"], "material.gradient", "`zero`"),
        (&["neo_hookean", "--F", "1,0,nan,1"], "material.gradient", "`nan`"),
        (&["neo_hookean", "--F", "1,0,0,1", "--E", "-1"], "scene.range", "a number > 0"),
        (&["neo_hookean", "--F", "1,0,0,1", "--nu", "0.5"], "scene.range", "< 0.5"),
        (
            &["neo_hookean", "--F", "1,0,0,1", "--set", "mooney_share=0.1"],
            "scene.unknown_field",
            "the law has only E and ν",
        ),
        (&["mooney_rivlin", "--F", "1,0,0,1", "--set", "mooney_share=0.9"], "model.not_convex", "at most 0.7"),
        (&["linear", "--F", "1,0,0,0,1,0,0,0,1", "--plane", "stress"], "scene.dimension", "4 numbers"),
        // For an inverted plate, no thickness makes the transverse stress zero.
        (
            &["stable_neo_hookean", "--F", "-1,0,0,1", "--plane", "stress", "--nu", "0.45"],
            "model.no_value",
            "det F > 0",
        ),
    ];
    for (arguments, wanted, part) in rows {
        let plain = opruga(Path::new("."), &[&["material"], arguments].concat());
        assert_eq!(code(&plain), 2, "{arguments:?}: {}{}", printed(&plain), said(&plain));
        assert!(said(&plain).contains(wanted) && said(&plain).contains(part), "{arguments:?}: {}", said(&plain));
        let json = opruga(Path::new("."), &[&["material"], arguments, &["--json"]].concat());
        let object: Value = serde_json::from_slice(&json.stderr).expect("an error object");
        assert_eq!(object["code"], wanted, "{arguments:?}");
    }
}
