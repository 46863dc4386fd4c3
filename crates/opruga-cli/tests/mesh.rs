//! `opruga mesh` as its users meet it: surfaces and drawings filled, meshes told of and written in other formats.
#![allow(clippy::disallowed_methods)] // no physics here

use std::path::Path;
use std::process::{Command, Output};

fn opruga(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_opruga")).args(arguments).current_dir(folder).output().expect("the program runs")
}

fn code(output: &Output) -> i32 {
    output.status.code().expect("an exit code")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(output: &Output) -> serde_json::Value {
    assert_eq!(code(output), 0, "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let shapes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/shapes");
    for name in ["spot.obj", "heart.svg"] {
        std::fs::copy(shapes.join(name), folder.path().join(name)).expect("a shape");
    }
    folder
}

#[test]
fn a_surface_becomes_tetrahedra_with_a_picture_and_goes_from_format_to_format() {
    let folder = folder();
    let run = |arguments: &[&str]| opruga(folder.path(), arguments);
    let row = json(&run(&["mesh", "spot.obj", "--size", "0.15", "-o", "spot.msh", "--json"]));
    let number = |row: &serde_json::Value, key: &str| row[key].as_f64().expect("a number");
    assert!((0.66..0.72).contains(&number(&row, "measure")), "{row}");
    assert!(number(&row, "smallest_angle") > 10.7 && number(&row, "largest_angle") < 164.8, "{row}");
    assert_eq!((row["inverted"].as_u64(), row["dimension"].as_u64()), (Some(0), Some(3)));
    assert_eq!(row["files"], serde_json::json!(["spot.msh", "spot.png"]));
    let png = std::fs::read(folder.path().join("spot.png")).expect("a picture");
    assert!(png.starts_with(b"\x89PNG") && png.len() > 20_000);

    // What was written is not replaced; through all formats it stays the same mesh.
    assert_eq!(code(&run(&["mesh", "spot.obj", "--size", "0.15", "-o", "spot.msh"])), 4);
    let mut from = "spot.msh".to_string();
    for ending in ["vtk", "vtu", "mesh", "mfem", "node", "msh"] {
        let to = format!("again.{ending}");
        let again = json(&run(&["mesh", &from, "-o", &to, "--json", "--force"]));
        for key in ["nodes", "cells", "measure", "smallest_angle", "largest_angle"] {
            assert_eq!(again[key], row[key], "{key} of {to}");
        }
        from = to;
    }
    let quadratic = json(&run(&["mesh", "again.msh", "--order", "2", "-o", "second.vtu", "--json"]));
    assert_eq!(quadratic["cells"]["quadratic tetrahedron"], row["cells"]["tetrahedron"]);

    let output = run(&["mesh", "again.msh"]);
    let said = text(&output.stdout);
    assert!(said.contains("0 inverted") && said.contains("angles between faces"), "{said}");
}

#[test]
fn a_drawing_becomes_triangles() {
    let folder = folder();
    let call = ["mesh", "heart.svg", "--size", "0.05", "--scale-to", "1", "-o", "heart.vtk", "--json"];
    let row = json(&opruga(folder.path(), &call));
    assert!(row["smallest_angle"].as_f64().expect("a number") >= 24.9, "{row}");
    assert!(folder.path().join("heart.png").is_file());
}

#[test]
fn calls_that_make_no_sense_and_bad_files_are_told_with_what_would_help() {
    let folder = folder();
    std::fs::write(folder.path().join("cut.msh"), "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n").expect("a file");
    std::fs::write(folder.path().join("box.mesh"), "MFEM mesh v1.0\ndimension\n3\n").expect("a file");
    for (arguments, exit, said) in [
        (&["mesh", "spot.obj"][..], 2, "--size"),
        (&["mesh", "heart.svg", "--size", "0.1"], 2, "--scale-to"),
        (&["mesh", "spot.obj", "--size", "-1"], 2, "numbers above 0"),
        (&["mesh", "spot.obj", "--size", "9"], 2, "no tetrahedron fits"),
        (&["mesh", "spot.obj", "--size", "1e-9"], 2, "nodes"),
        (&["mesh", "spot.obj", "--size", "0.2", "-o", "spot.exe"], 2, ".msh (Gmsh 4.1)"),
        (&["mesh", "cut.msh"], 2, "cut.msh:5:"),
        (&["mesh", "box.mesh"], 2, "box.mesh:3:"),
        (&["mesh", "none.msh"], 4, "none.msh"),
        (&["mesh", "none.obj", "--size", "1"], 4, "none.obj"),
    ] {
        let output = opruga(folder.path(), arguments);
        let told = text(&output.stderr);
        assert_eq!(code(&output), exit, "{arguments:?}: {told}");
        assert!(told.contains(said), "{arguments:?}: {told}");
    }
}
