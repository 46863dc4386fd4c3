//! `opruga mesh` as its users see it: surfaces and drawings filled, meshes described and converted to other formats.
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
    assert_eq!(row["files"], serde_json::json!(["spot.msh", "spot.msh.png"]));
    let png = std::fs::read(folder.path().join("spot.msh.png")).expect("a picture");
    assert!(png.starts_with(b"\x89PNG") && png.len() > 20_000);

    // An existing output is not replaced; through all formats the mesh stays the same.
    assert_eq!(code(&run(&["mesh", "spot.obj", "--size", "0.15", "-o", "spot.msh"])), 4);
    // All files of a call or none: if a picture is in the way, no mesh is written.
    std::fs::write(folder.path().join("other.vtk.png"), "mine").expect("a file");
    let refused = run(&["mesh", "spot.msh", "-o", "other.vtk"]);
    assert_eq!(code(&refused), 4, "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("other.vtk.png"), "{}", text(&refused.stderr));
    assert!(!folder.path().join("other.vtk").exists());
    // The second format of a mesh is written next to the first, each with its picture.
    let beside = json(&run(&["mesh", "spot.msh", "-o", "spot.vtk", "--json"]));
    assert_eq!(beside["files"], serde_json::json!(["spot.vtk", "spot.vtk.png"]));
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
    assert!(folder.path().join("heart.vtk.png").is_file());
}

/// The call can choose the same parts of a file as a scene: a layer and a feature of a map, an element of a drawing, a text in a font.
#[test]
fn parts_of_files_are_chosen_as_in_scenes() {
    let folder = folder();
    let shapes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/shapes");
    for name in ["countries-110m.json", "inter-black-subset.otf"] {
        std::fs::copy(shapes.join(name), folder.path().join(name)).expect("a shape");
    }
    let two = "<svg xmlns=\"http://www.w3.org/2000/svg\"><rect id=\"a\" width=\"4\" height=\"4\"/><rect id=\"b\" x=\"9\" width=\"2\" height=\"1\"/></svg>";
    std::fs::write(folder.path().join("two.svg"), two).expect("a file");
    let measure = |file: &str, set: &[&str]| {
        let mut call = vec!["mesh", file, "--size", "0.02", "--scale-to", "1", "--json"];
        set.iter().for_each(|set| call.extend(["--set", set]));
        let row = json(&opruga(folder.path(), &call));
        row["measure"].as_f64().expect("an area")
    };
    assert!((measure("two.svg", &["path=b"]) - 0.5).abs() < 1e-9);
    assert!((measure("two.svg", &["path=a"]) - 1.0).abs() < 1e-9);
    // The areas that the scenes of these shapes have, up to the details that their spacing omits.
    let near = |found: f64, wanted: f64| assert!((found / wanted - 1.0).abs() < 0.02, "{found}, not {wanted}");
    near(measure("countries-110m.json", &["layer=countries", "feature=Italy"]), 0.23453);
    near(measure("countries-110m.json", &["layer=countries", "feature=\"South Africa\""]), 0.47180);
    let word = json(&opruga(
        folder.path(),
        &["mesh", "inter-black-subset.otf", "--size", "0.01", "--scale-to", "1", "--set", "text=OPRUGA", "--json"],
    ));
    near(word["measure"].as_f64().expect("an area"), 0.09967);
    // A map with several layers requires a choice, and the message uses the terms of the call.
    let told = opruga(folder.path(), &["mesh", "countries-110m.json", "--size", "0.02", "--scale-to", "1"]);
    let said = text(&told.stderr);
    assert!(code(&told) == 2 && said.contains("name one with --set layer=…") && said.contains("countries"), "{said}");
}

/// The volume that tetrahedra cut off a surface is reported with numbers and with a size that avoids it; a large loss is an error.
#[test]
fn a_filling_that_loses_volume_is_told_and_refused_where_it_is_much() {
    let folder = folder();
    let run = |size: &str| opruga(folder.path(), &["mesh", "spot.obj", "--scale-to", "1.5", "--size", size]);
    let (fine, coarse, crude) = (run("0.1"), run("0.25"), run("0.6"));
    assert_eq!((code(&fine), text(&fine.stderr).contains("lost")), (0, false), "{}", text(&fine.stderr));
    let said = text(&coarse.stderr);
    assert!(code(&coarse) == 0 && said.contains("warning[shape.lost_volume]") && said.contains("m³ ("), "{said}");
    let works = said.split("--size ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a size").to_string();
    assert!(!text(&run(&works).stderr).contains("lost"), "{works}");
    let said = text(&crude.stderr);
    assert!(code(&crude) == 2 && said.contains("of the volume"), "{said}");
}

#[test]
fn calls_that_make_no_sense_and_bad_files_are_told_with_what_would_help() {
    let folder = folder();
    std::fs::write(folder.path().join("cut.msh"), "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1\n").expect("a file");
    std::fs::write(folder.path().join("box.mesh"), "MFEM mesh v1.0\ndimension\n3\n").expect("a file");
    // Words of a file are quoted as they are, even if fields of shapes have the same names.
    let facet = "solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nv";
    std::fs::write(folder.path().join("k.stl"), facet).expect("a file");
    let empty = "MFEM mesh v1.0\ndimension\n3\nboundary\n1\n3 2 0 2 1\nvertices\n3\n3\n0 0 0\n1 0 0\n0 1 0\n";
    std::fs::write(folder.path().join("empty.mesh"), empty).expect("a file");
    std::fs::write(folder.path().join("t.node"), "4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n").expect("a file");
    std::fs::write(folder.path().join("t.ele"), "2 4 0\n1 1 2 3 4\n1 1 2 3 4\n").expect("a file");
    for (arguments, exit, said) in [
        (&["mesh", "k.stl", "--size", "0.1"][..], 2, "`v` does not belong here"),
        (&["mesh", "empty.mesh"], 2, "the file ends where `elements` should follow"),
        (&["mesh", "t.node"], 2, "t.ele:3:1"),
        (&["mesh", "spot.obj"], 2, "--size"),
        (&["mesh", "heart.svg", "--size", "0.1"], 2, "--scale-to"),
        (&["mesh", "spot.obj", "--size", "-1"], 2, "numbers above 0"),
        (&["mesh", "spot.obj", "--size", "9"], 2, "no tetrahedron fits"),
        (&["mesh", "spot.obj", "--size", "1e-9"], 2, "nodes"),
        (&["mesh", "spot.obj", "--size", "0.2", "-o", "spot.exe"], 2, ".msh (Gmsh 4.1)"),
        (&["mesh", "cut.msh"], 2, "cut.msh:5:"),
        (&["mesh", "box.mesh"], 2, "box.mesh:3:"),
        (&["mesh", "none.msh"], 4, "none.msh"),
        (&["mesh", "letters.ttf"], 2, "--set text=opruga"),
        (&["mesh", "heart.svg", "--size", "0.1", "--scale-to", "1", "--set", "path=haert"], 2, "`haert`"),
        (&["mesh", "heart.svg", "--size", "0.1", "--scale-to", "1", "--set", "feature=a"], 2, "--set feature=a"),
        (&["mesh", "heart.svg", "--size", "0.1", "--scale-to", "1", "--set", "path"], 2, "PATH=VALUE"),
        (&["mesh", "scene.toml"], 2, "`opruga check`"),
        (&["mesh", "picture.jpg"], 2, "files that can be read end in .obj, "),
        (&["mesh", "none.obj", "--size", "1"], 4, "none.obj"),
    ] {
        let output = opruga(folder.path(), arguments);
        let told = text(&output.stderr);
        assert_eq!(code(&output), exit, "{arguments:?}: {told}");
        assert!(told.contains(said), "{arguments:?}: {told}");
    }
}

/// Errors of the command refer to the file and its options, not to a scene that does not exist.
#[test]
fn errors_of_mesh_speak_of_the_call() {
    let folder = folder();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    let svg = |inner: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n{inner}\n</svg>\n");
    write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 2 3 4\n");
    let circle = |r: f64| format!("M{r} 0 A{r} {r} 0 1 1 -{r} 0 A{r} {r} 0 1 1 {r} 0 Z");
    write("thin.svg", &svg(&format!("<path d=\"{} {}\"/>", circle(10.0), circle(9.9))));
    write("strokes.svg", &svg("<path d=\"M0 0 L5 0\"/>"));
    for (call, place, said) in [
        (&["mesh", "spot.obj", "--size", "9"][..], "--size 9: error[", "no tetrahedron fits"),
        (&["mesh", "spot.obj", "--size", "1e-9"], "--size 0.000000001: error[limit.", "the mesh would have"),
        (&["mesh", "open.obj", "--size", "0.1"], "open.obj: error[mesh.open]", "--set open="),
        (&["mesh", "strokes.svg", "--size", "0.1", "--scale-to", "1"], "strokes.svg: error[shape.no_area]", ""),
        (
            &["mesh", "thin.svg", "--size", "0.3", "--scale-to", "1"],
            "--size 0.3: error[shape.spacing]",
            "a smaller --size",
        ),
    ] {
        let output = opruga(folder.path(), call);
        let told = text(&output.stderr);
        assert_eq!(code(&output), 2, "{call:?}: {told}");
        assert!(told.contains(place) && told.contains(said), "{call:?}: {told}");
        assert!(!told.contains("[[body]]") && !told.contains("opruga mesh:") && !told.contains("`spacing`"), "{told}");
    }
    for (call, said) in [
        (&["mesh", "spot.obj", "--size", "1e-9"][..], "mreža bi imala "),
        (&["mesh", "open.obj", "--size", "0.1"], "savjet: --set open=cap zatvara je, --set open=sheet "),
        (&["mesh", "thin.svg", "--size", "0.3", "--scale-to", "1"], "savjet: uzmi manji --size, veći --scale-to, "),
    ] {
        let told = text(&opruga(folder.path(), &[call, &["--language", "hr"]].concat()).stderr);
        assert!(told.contains(said) && !told.contains("in a scene"), "{call:?}: {told}");
    }
}

/// `--strict`: a notice about the file, or a part that the format cannot represent, is an error, and nothing is written; this does not apply to what
/// the call itself asks for.
#[test]
fn warnings_are_errors_where_the_call_says_so() {
    let folder = folder();
    let drawing = |inside: &str| format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n{inside}\n</svg>\n");
    std::fs::write(folder.path().join("open.svg"), drawing("<path d=\"M0 0 L4 0 L4 4\"/>")).expect("a file");
    let boxes = "<rect width=\"4\" height=\"4\"/><rect x=\"2\" y=\"2\" width=\"4\" height=\"4\"/>";
    std::fs::write(folder.path().join("two.svg"), drawing(boxes)).expect("a file");
    let run = |file: &str, more: &[&str]| {
        opruga(folder.path(), &[&["mesh", file, "--size", "0.1", "--scale-to", "1"], more].concat())
    };
    let warned = run("open.svg", &["-o", "open.msh"]);
    assert!(code(&warned) == 0 && text(&warned.stderr).contains("warning[svg.open_path]"), "{}", text(&warned.stderr));
    let refused = run("open.svg", &["-o", "strict.msh", "--strict"]);
    let said = text(&refused.stderr);
    assert!(code(&refused) == 2 && said.contains("error[svg.open_path]: 1 open path"), "{said}");
    assert!(said.contains("open.svg") && !folder.path().join("strict.msh").exists(), "{said}");
    assert!(!folder.path().join("strict.msh.png").exists());
    for file in ["heart.svg", "two.svg"] {
        let output = run(file, &["--strict"]);
        assert_eq!(code(&output), 0, "{file}: {}", text(&output.stderr));
    }
    // Lost volume of tetrahedra is included.
    let coarse = opruga(folder.path(), &["mesh", "spot.obj", "--size", "0.25", "--scale-to", "1.5", "--strict"]);
    assert!(
        code(&coarse) == 2 && text(&coarse.stderr).contains("error[shape.lost_volume]"),
        "{}",
        text(&coarse.stderr)
    );
}

/// Overlapping areas of a drawing are united, and their number is reported; the error about an outline that crosses itself has a location.
#[test]
fn overlapping_areas_are_united_with_a_message() {
    let folder = folder();
    let write = |name: &str, inner: &str| {
        let text = format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n{inner}\n</svg>\n");
        std::fs::write(folder.path().join(name), text).expect("a file");
    };
    let boxes = "<rect width=\"4\" height=\"4\"/>\n<rect x=\"2\" y=\"2\" width=\"4\" height=\"4\"/>\n";
    write("two.svg", &format!("{boxes}<rect x=\"8\" width=\"2\" height=\"2\"/>"));
    write("apart.svg", "<rect width=\"4\" height=\"4\"/>\n<rect x=\"8\" width=\"2\" height=\"2\"/>");
    write("bow.svg", "<path d=\"M0 0 L4 4 L4 0 L0 4 Z\"/>");
    write("open.svg", "<path d=\"M0 0 L4 0 L4 4\"/>");
    let mesh = |name: &str| opruga(folder.path(), &["mesh", name, "--size", "0.1", "--scale-to", "1"]);
    let united = text(&mesh("two.svg").stderr);
    assert!(
        united.contains("note[shape.overlap]: 2 outlines cross, cover or touch others or themselves: "),
        "{united}"
    );
    assert!(united.contains("2 outlines are left"), "{united}");
    let apart = mesh("apart.svg");
    assert_eq!((code(&apart), text(&apart.stderr)), (0, String::new()));
    let open = text(&mesh("open.svg").stderr);
    assert!(open.contains("1 open path is closed by a straight line"), "{open}");
    // The halves of a bow tie meet in a point, where they are separated; a scene that allows no crossing refuses it.
    let bow = text(&mesh("bow.svg").stderr);
    assert!(bow.contains("1 outline crosses, covers or touches others or itself: "), "{bow}");
    assert!(bow.contains("2 outlines are left"), "{bow}");
    let scene = "format = \"opruga-1\"\ndimension = 2\nintegrator = \"verlet\"\n[time]\nseconds = 1\n[[body]]\nname = \"b\"\nmass = 1\n\
                 shape = { kind = \"svg\", file = \"FILE\", spacing = 0.1, size = 1 }\n";
    for (file, what, more) in [
        ("bow.svg", "error[shape.crossing]: an outline crosses or touches itself near (2, 2)", ""),
        ("two.svg", "two outlines cross or touch near (4, 2)", "overlap = \"union\""),
    ] {
        std::fs::write(folder.path().join("s.toml"), scene.replace("FILE", file)).expect("a file");
        let told = text(&opruga(folder.path(), &["check", "s.toml"]).stderr);
        assert!(told.contains(&format!("{file}:")) && told.contains(what) && told.contains(more), "{told}");
    }
    std::fs::write(folder.path().join("s.toml"), scene.replace("FILE\"", "two.svg\", overlap = \"union\""))
        .expect("a file");
    let told = text(&opruga(folder.path(), &["check", "s.toml"]).stderr);
    assert!(told.contains("2 outlines cross, cover or touch others or themselves: `overlap = \"union\"`"), "{told}");
}
