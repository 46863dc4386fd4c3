//! Messages about scenes that cannot be run are true and complete: they report no fault that a scene does not have, and every error has the value,
//! what is allowed and what would help.
#![allow(clippy::disallowed_methods)] // no physics here

use crate::common;
use common::*;
use serde_json::Value;
use std::path::Path;

fn write(folder: &Path, text: &str) {
    std::fs::write(folder.join("s.toml"), text).expect("a file");
}

/// The output of a command on the scene `text` for people, and its exit code.
fn told(text: &str, command: &[&str]) -> (i32, String) {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), text);
    let output = opruga(folder.path(), command);
    (code(&output), said(&output))
}

/// The first error of `opruga run --json` on the scene `text`.
fn error(text: &str) -> Value {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), text);
    let output = opruga(folder.path(), &["run", "s.toml", "--no-pictures", "--json", "--out", "o"]);
    assert_ne!(code(&output), 0, "it is refused: {text}");
    let last = said(&output);
    serde_json::from_str(last.lines().last().expect("a line")).unwrap_or_else(|e| panic!("{e}: {last}"))
}

/// A plane scene with an integrator, its bodies and everything else.
fn plane(integrator: &str, rest: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1.0\nframe = 1.0\nsubsteps = 1\n[world]\ngravity = [0.0, -9.81]\n\
         [integrator]\n{integrator}\n{rest}\n"
    )
}

const STATICS: &str = "kind = \"equilibrium\"";

/// A bar of finite elements with additional fields.
fn bar(name: &str, more: &str) -> String {
    format!(
        "[[body]]\nname = \"{name}\"\nshape = {{ kind = \"grid\", size = [1.0, 0.25], cells = [8, 2] }}\ndensity = 1000.0\n\
         models = [{{ kind = \"fem\", material = \"stable_neo_hookean\", youngs_modulus = 1e5, poissons_ratio = 0.4 }}]\n{more}\n"
    )
}

const LEFT: &str = "pin = [{ select = { side = \"left\" } }]";

/// An error in a load, a pin, an obstacle or a probe does not cause the message that nothing holds a pinned body. If nothing holds a body, this is
/// reported together with errors in parts of the scene that could not hold it.
#[test]
fn a_held_body_is_not_called_loose_because_of_another_error() {
    let load = "[[load]]\nkind = \"traction\"\nbody = \"b\"\nvalue = [0.0, 1.0]\nselect = { node = 12 }\n";
    let conflict = "pin = [{ select = { side = \"left\" }, motion = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]] }, \
                    { select = { side = \"left\" } }]";
    let probe = "[[probe]]\nname = \"p\"\nbody = \"nobody\"\nselect = { node = 1 }\nrecord = [\"position\"]\n";
    let misspelt = "[[colliders]]\nkind = \"half_space\"\npoint = [0.0, -0.2]\nnormal = [0.0, 1.0]\n";
    let floor = "[[collider]]\nkind = \"half_space\"\npoint = [0.0, -0.2]\nnormal = [0.0, 1.0]\n";
    let [no_floor, bad_floor] = ["[0.0, 0.0]", "[0.0, 1e-200]"].map(|normal| floor.replace("[0.0, 1.0]", normal));
    let stiff = bar("stiff", LEFT).replace("0.4", "0.7");
    for (rest, wanted) in [
        (bar("b", LEFT) + load, "scene.selects_nothing"),
        (bar("b", conflict), "scene.conflict"),
        (bar("b", &LEFT.replace("left", "lef")), "scene.unknown_word"),
        (bar("b", LEFT) + probe, "scene."),
        (bar("b", "") + misspelt, "scene.unknown_field"),
        (bar("b", "") + &no_floor, "error["),
        (bar("b", "") + &bad_floor, "collider.no_direction"),
        // The floor holds one body, while another has an error of its own.
        (bar("b", "") + &stiff + floor, "error["),
    ] {
        let (code, said) = told(&plane(STATICS, &rest), &["run", "s.toml", "--no-pictures", "--out", "o"]);
        assert!(code == 2 && said.contains(wanted), "{wanted}: {said}");
        assert!(!said.contains("static."), "{rest}: {said}");
    }
    let (code, said) = told(&plane(STATICS, &(bar("b", "") + probe)), &["check", "s.toml"]);
    assert!(code == 2 && said.contains("static.rigid_modes"), "{said}");
}

/// A square of St. Venant–Kirchhoff in plane stress is stretched to 1.5 times its length in eight steps. If a model refuses the whole displacement of
/// the pins at once, they are moved in parts. Without transverse stress, E_y = −ν E_x. Beyond √(1 + 1/ν), which is 1.795, no thickness satisfies
/// that; the model reports this, and its hint says how halving the steps helps.
#[test]
fn statics_follows_pins_as_far_as_a_model_goes_and_says_where_it_ends() {
    let square = "[[body]]\nname = \"b\"\nthickness = 0.5\nshape = { kind = \"grid\", size = [1.0, 1.0], cells = [2, 2] }\n\
                  simplices = true\norder = 2\ndensity = 1000.0\n\
                  models = [{ kind = \"fem\", material = \"st_venant_kirchhoff\", youngs_modulus = 1e5, poissons_ratio = 0.45, \
                  plane = \"stress\" }]\n\
                  pin = [{ select = { side = \"left\" }, axes = \"x\" }, { select = { side = \"bottom\" }, axes = \"y\" }, \
                  { select = { side = \"right\" }, axes = \"x\", motion = [[0.0, 0.0, 0.0], [1.0, 0.5, 0.0]] }]\n";
    let scene = |rule: &str| {
        let text = plane(&format!("{STATICS}\n{rule}"), square);
        text.replace("frame = 1.0", "frame = 0.125").replace("[0.0, -9.81]", "[0.0, 0.0]")
    };
    let refused = error(&scene("").replace("[1.0, 0.5, 0.0]", "[1.0, 0.9, 0.0]"));
    assert_eq!(refused["code"], "run.model");
    assert!(refused["message"].as_str().is_some_and(|message| message.contains("thickness")), "{refused}");
    let hint = refused["hint"].as_str().expect("a hint");
    assert!(hint.starts_with("use `when_not_converged = \"halve\"`") && !hint.contains("last good frame"), "{refused}");

    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), &scene(""));
    let found = summary(folder.path(), &["run", "s.toml", "--out", "o"]);
    assert!(!found["warnings"].to_string().contains("step.halved"), "{found}");
    let table = std::fs::read_to_string(folder.path().join("o/final.csv")).expect("a table");
    let places = table.lines().skip(1).map(|row| row.split(',').map(|x| x.parse().unwrap_or(f64::NAN)).collect());
    let places: Vec<Vec<f64>> = places.collect();
    let high = (1.0f64 - 0.45 * (1.5 * 1.5 - 1.0)).sqrt();
    let corner = places.iter().find(|row| row[2] > 1.499 && row[3] > 0.5).expect("the upper right corner");
    assert!((corner[2] - 1.5).abs() < 1e-12 && (corner[3] - high).abs() < 1e-8, "{corner:?}, not {high}");
}

/// A curve of equilibria follows the load. If there is none, this is reported, and not a failed iteration.
#[test]
fn a_curve_of_equilibria_without_a_load_is_said_to_have_none() {
    let text = plane(&format!("{STATICS}\narc_length = 0.01"), &bar("b", LEFT)).replace("[0.0, -9.81]", "[0.0, 0.0]");
    let error = error(&text);
    let message = error["message"].as_str().expect("a message");
    assert!(error["code"] == "run.model" && message.contains("no load acts on free nodes"), "{error}");
    assert!(!message.contains("converge") && error["allowed"] == "weight or loads", "{error}");
    assert!(error["hint"].as_str().is_some_and(|hint| hint.starts_with("without `arc_length`")), "{error}");
}

/// Errors of models and integrators contain what a program needs to repair the scene: the path of the field, the value, what is allowed and what
/// would help.
#[test]
fn errors_of_models_and_rules_have_path_value_allowed_and_hint() {
    let square = |order: &str, model: &str| {
        format!(
            "[[body]]\nname = \"b\"\nshape = {{ kind = \"grid\", size = [1.0, 1.0], cells = [2, 2] }}\n{order}density = 1.0\n\
             models = [{{ kind = \"fem\", {model} }}]\n{LEFT}\n"
        )
    };
    let (linear, verlet) = ("simplices = true\norder = 1\n", "kind = \"verlet\"");
    let soft = "youngs_modulus = 1.0";
    let newmark = "kind = \"newmark\"\naccuracy = \"real_time\"";
    let rows = [
        (STATICS, square(linear, &format!("{soft}, poissons_ratio = 0.49")), "model.locking", "poissons_ratio", "0.49"),
        (
            STATICS,
            square(linear, &format!("{soft}, plane = \"stress\", locking = \"nodal_volume\"")),
            "model.locking",
            "locking",
            "\"nodal_volume\"",
        ),
        (
            STATICS,
            square("", &format!("{soft}, material = \"mooney_rivlin\", poissons_ratio = 0.1, mooney_share = 0.2")),
            "model.not_convex",
            "mooney_share",
            "0.2",
        ),
        (
            STATICS,
            square("", &format!("{soft}, material = \"mooney_rivlin\", poissons_ratio = -0.5")),
            "model.not_convex",
            "poissons_ratio",
            "-0.5",
        ),
        (
            verlet,
            square("", &format!("{soft}, mass = \"consistent\"")),
            "integrator.mass_matrix",
            "mass",
            "\"consistent\"",
        ),
        (STATICS, square("", "youngs_modulus_of_cells = \"E\""), "model.no_values", "youngs_modulus_of_cells", "\"E\""),
    ];
    for (rule, body, code, field, value) in rows {
        let error = error(&plane(rule, &body));
        assert_eq!(error["code"], code, "{error}");
        assert_eq!(error["path"], format!("body.b.models.fem.{field}"), "{error}");
        assert_eq!(error["value"], value, "{error}");
        assert!(error["allowed"].is_string() && error["hint"].is_string() && error["line"].is_u64(), "{error}");
    }
    // For an integrator of the scene, and for the integrator of one body.
    for (text, path) in [
        (plane(newmark, &square("", soft)), "integrator.accuracy"),
        (
            plane(verlet, &square(&format!("integrator = {{ {} }}\n", newmark.replace('\n', ", ")), soft)),
            "body.b.integrator.accuracy",
        ),
    ] {
        let error = error(&text);
        assert_eq!(error["path"], path, "{error}");
        assert!(error["value"] == "\"real_time\"" && error["allowed"] == "\"exact\"", "{error}");
        assert!(error["message"].as_str().is_some_and(|said| said.contains("damps nothing")), "{error}");
    }
    // With a spectral radius below 1 it does damp, and is refused for another reason.
    let error = error(&plane(&format!("{newmark}\nspectral_radius = 0.5"), &square("", soft)));
    let said = error["message"].as_str().expect("a message");
    assert!(!said.contains("damps nothing") && said.contains("to the next step in its acceleration"), "{error}");
}

/// A value in a mesh that a material cannot have is an error in the mesh file.
#[test]
fn a_wrong_number_of_a_cell_is_one_of_the_mesh_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = "# vtk DataFile Version 3.0\ntwo squares\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n0 0 0 1 0 0 2 0 0 0 1 0 \
                1 1 0 2 1 0\nCELLS 2 10\n4 0 1 4 3\n4 1 2 5 4\nCELL_TYPES 2\n9\n9\nCELL_DATA 2\nSCALARS E double 1\nLOOKUP_TABLE \
                default\n1e5\n-2\n";
    std::fs::write(folder.path().join("two.vtk"), mesh).expect("a file");
    let body = "[[body]]\nname = \"b\"\nshape = { kind = \"mesh\", file = \"two.vtk\" }\ndensity = 1000.0\n\
                models = [{ kind = \"fem\", youngs_modulus_of_cells = \"E\" }]\npin = [{ select = { side = \"left\" } }]\n";
    write(folder.path(), &plane(STATICS, body));
    let output = opruga(folder.path(), &["run", "s.toml", "--no-pictures", "--json", "--out", "o"]);
    let error: Value = serde_json::from_str(said(&output).lines().last().expect("a line")).expect("an object");
    assert_eq!((code(&output), &error["code"]), (2, &Value::from("model.cell_value")), "{error}");
    assert_eq!((&error["file"], &error["value"]), (&Value::from("two.vtk"), &Value::from("-2")), "{error}");
    assert_eq!(error["path"], "body.b.models.fem.youngs_modulus_of_cells", "{error}");
    assert!(error["allowed"] == "a number > 0" && error["hint"].is_string(), "{error}");
}

/// Every free axis has its mode, and an invalid number of modes is refused.
#[test]
fn all_modes_of_a_body_are_found() {
    let text = plane("kind = \"backward_euler\"", &bar("b", "pin = [{ select = { side = \"left\" } }]"));
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), &text);
    let output = opruga(folder.path(), &["modes", "s.toml", "-n", "all", "--json", "--no-pictures", "--out", "o"]);
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let rows = found["rows"].as_array().expect("rows");
    let more = opruga(folder.path(), &["modes", "s.toml", "-n", "100000", "--json", "--no-pictures", "--out", "p"]);
    let more: Value = serde_json::from_slice(&more.stdout).expect("JSON");
    assert!(rows.len() > 10 && more["rows"] == found["rows"], "{}", rows.len());
    let squares: Vec<f64> = rows.iter().map(|row| row["omega_squared"].as_f64().expect("a number")).collect();
    assert!(squares.is_sorted() && squares[0] > 0.0, "{squares:?}");
    for wrong in ["0", "-1", "many"] {
        let output = opruga(folder.path(), &["modes", "s.toml", "-n", wrong, "--out", "q"]);
        assert!(output.status.code() == Some(2) && said(&output).contains("or `all`"), "{wrong}");
    }
}

/// A body that is pinned everywhere has no modes, which is reported instead of an empty table.
#[test]
fn a_body_that_is_held_everywhere_has_no_modes_and_is_said_to() {
    let text = plane("kind = \"backward_euler\"", &bar("b", "pin = [{ select = { all = true } }]"));
    let (code, said) = told(&text, &["modes", "s.toml", "--no-pictures", "--out", "o"]);
    assert!(code != 0 && said.contains("error[modes.all_held]") && said.contains("the body cannot vibrate"), "{said}");
    assert!(said.contains("= hint: choose another body, or use fewer pins"), "{said}");
}

/// The kind of an integrator or model is changed by another command, which the message names.
#[test]
fn the_command_that_changes_kinds_is_named_where_one_that_sets_cannot() {
    let rows = ["integrator.kind", "integrator", "body.b.integrator.kind", "body.b.models", "body.b.models.fem.kind"];
    for path in rows {
        let command = format!("[[command]]\ndo = \"set\"\nat = 0.5\npath = \"{path}\"\nvalue = 1\n");
        let text = plane("kind = \"verlet\"", &(bar("b", LEFT) + &command)).replace("frame = 1.0", "frame = 0.001");
        let error = error(&text);
        assert_eq!(error["code"], "scene.unknown_parameter", "{path}: {error}");
        assert!(error["hint"].as_str().is_some_and(|hint| hint.contains("do = \"change\"")), "{path}: {error}");
        assert!(error["allowed"].as_str().is_some_and(|allowed| !allowed.is_empty()), "{path}: {error}");
    }
}

/// Shapes whose volume would overflow, and outlines rotated so far that their nodes would coincide, are errors of the field with what is allowed, and
/// not a run that diverges.
#[test]
fn vast_shapes_and_angles_are_refused_at_their_field() {
    let springs = "mass = 1.0\nmodels = [{ kind = \"mass_spring\", stiffness = 100.0 }]\n";
    let gas = "mass = 1.0\nmodels = [{ kind = \"pressure\", nRT = 1.0 }]\n";
    let body = |shape: &str, more: &str| format!("[[body]]\nname = \"b\"\nshape = {{ {shape} }}\n{more}");
    let ring = "kind = \"ring\", vertices = 8";
    let ball = "kind = \"icosphere\", subdivisions = 1";
    let rows = [
        (2, body(&format!("{ring}, radius = 1e300"), springs), "shape.radius", "1e300"),
        (3, body(&format!("{ball}, radius = 1e150"), springs), "shape.radius", "1e150"),
        (3, body(&format!("{ball}, radius = 1e150"), gas), "shape.radius", "1e150"),
        (3, body(&format!("{ball}, radius = 1.0"), &format!("scale = 1e150\n{gas}")), "scale", "1e150"),
        (2, body(&format!("{ring}, radius = 1.0, start_angle = 1e20"), springs), "shape.start_angle", "1e20"),
        (
            2,
            body("kind = \"regular_polygon\", sides = 5, radius = 1.0, start_angle = -1e20", springs),
            "shape.start_angle",
            "-1e20",
        ),
    ];
    for (dimension, body, field, value) in rows {
        let text =
            plane("kind = \"backward_euler\"", &body).replace("dimension = 2", &format!("dimension = {dimension}"));
        let text = text.replace("gravity = [0.0, -9.81]\n", "");
        let error = error(&text);
        assert_eq!((&error["code"], &error["value"]), (&Value::from("scene.range"), &Value::from(value)), "{error}");
        assert_eq!(error["path"], format!("body.0.{field}"), "{error}");
        assert!(error["allowed"].is_string() && error["line"].is_u64(), "{error}");
    }
    // A large shape with a finite volume is accepted.
    for text in [
        body(&format!("{ring}, radius = 1e60"), springs),
        body(&format!("{ring}, radius = 1.0, start_angle = 1e6"), springs),
    ] {
        let (code, said) = told(&plane("kind = \"backward_euler\"", &text), &["check", "s.toml"]);
        assert_eq!(code, 0, "{said}");
    }
}

/// Three squares in a row, each with its own material by the names in a mesh file: a force of 6 N over 1 m lengthens them by 6 (1/100 + 1/200 +
/// 1/400) m. If one has no material, this is reported once, for all models together.
#[test]
fn materials_by_groups_of_a_mesh_file_stretch_in_series_and_a_missing_one_is_one_error() {
    let mesh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 1 \"soft\"\n2 2 \"firm\"\n2 3 \"hard\"\n$EndPhysicalNames\n\
                $Nodes\n8\n1 0 0 0\n2 1 0 0\n3 2 0 0\n4 3 0 0\n5 0 1 0\n6 1 1 0\n7 2 1 0\n8 3 1 0\n$EndNodes\n\
                $Elements\n3\n1 3 2 1 1 1 2 6 5\n2 3 2 2 2 2 3 7 6\n3 3 2 3 3 3 4 8 7\n$EndElements\n";
    let model = |(group, modulus): &(&str, f64)| {
        format!(
            "{{ kind = \"fem\", material = \"linear\", youngs_modulus = {modulus}, poissons_ratio = 0.0, cells = \"{group}\" }}"
        )
    };
    let scene = |materials: &[(&str, f64)]| {
        let models: Vec<String> = materials.iter().map(model).collect();
        let body = format!(
            "[[body]]\nname = \"b\"\ndensity = 1.0\nshape = {{ kind = \"mesh\", file = \"bar.msh\" }}\nmodels = [{}]\n\
             pin = [{{ select = {{ nodes = [0, 4] }} }}]\n\
             [[load]]\nkind = \"force\"\nbody = \"b\"\nselect = {{ nodes = [3, 7] }}\nvalue = [3.0, 0.0]\n",
            models.join(", ")
        );
        plane(STATICS, &body).replace("[0.0, -9.81]", "[0.0, 0.0]")
    };
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("bar.msh"), mesh).expect("a mesh");
    write(folder.path(), &scene(&[("soft", 100.0), ("firm", 200.0), ("hard", 400.0)]));
    summary(folder.path(), &["run", "s.toml", "--out", "o"]);
    let table = std::fs::read_to_string(folder.path().join("o/final.csv")).expect("a table");
    let end: f64 = table.lines().nth(4).and_then(|row| row.split(',').nth(2)).and_then(|x| x.parse().ok()).expect("x");
    assert!((end - 3.105).abs() < 1e-9, "{end}: {table}");

    write(folder.path(), &scene(&[("soft", 100.0), ("firm", 200.0)]));
    let said = said(&opruga(folder.path(), &["check", "s.toml"]));
    assert_eq!(said.matches("error[").count(), 1, "{said}");
    assert!(said.contains("1 of 3 cells are in none of the groups `soft`, `firm`"), "{said}");
}
