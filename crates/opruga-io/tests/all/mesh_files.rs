//! Mesh files of other programs: the contents of good ones, and the locations of errors in bad ones.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use opruga_io::SceneError;
use opruga_io::meshes::{Mending, read};
use opruga_mesh::Mesh;
use std::path::PathBuf;
use std::sync::Arc;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data/meshes")
}

fn bytes(name: &str) -> Vec<u8> {
    std::fs::read(folder().join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

type Outcome<const D: usize> = Result<(Mesh<D>, Vec<SceneError>), SceneError>;

/// The body in a file with these contents; a second file is taken from the folder.
fn body<const D: usize>(name: &str, bytes: &[u8], mending: Mending) -> Outcome<D> {
    read(name, bytes, &mut |other| Ok(Arc::from(std::fs::read(folder().join(other)).expect("beside it"))))?
        .assemble(mending)
}

fn good<const D: usize>(name: &str) -> Mesh<D> {
    let (mesh, notices) = body::<D>(name, &bytes(name), Mending::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(notices, [], "{name}");
    assert_eq!(mesh.check(), [], "{name}");
    mesh
}

#[track_caller]
fn close(computed: f64, expected: f64) {
    assert!((computed - expected).abs() <= 1e-9 * (1.0 + expected.abs()), "{computed} is not {expected}");
}

/// Nodes, cells and volume of files with meshes in space.
#[test]
fn files_of_space_hold_what_their_authors_meshed() {
    for (name, nodes, cells, volume) in [
        ("mujoco/cube_22_ascii_vol_gmshApp.msh", 14, 24, 1.0),
        ("mujoco/cube_22_binary_vol_gmshApp.msh", 14, 24, 1.0),
        ("mujoco/cube_41_ascii_vol_gmshApp.msh", 14, 24, 1.0),
        ("mujoco/cube_41_binary_vol_gmshApp.msh", 14, 24, 1.0),
        ("fenris/cube_tet4_24.msh", 14, 24, 1.0),
        ("fenris/cube_tet10_24.msh", 63, 24, 1.0),
        ("polyfem/22_ascii.msh", 8, 5, 5.0 / 6.0),
        ("polyfem/22_binary.msh", 8, 5, 5.0 / 6.0),
        ("polyfem/41_ascii.msh", 8, 5, 5.0 / 6.0),
        ("polyfem/41_binary.msh", 8, 5, 5.0 / 6.0),
        ("polyfem/cube-hex.msh", 8, 1, 1.0),
        ("gaia/Beam.1.ele", 58, 116, 33.50146),
        ("gaia/Beam.1.node", 58, 116, 33.50146),
        ("gaia/Beam.1.vtk", 58, 116, 33.50146),
        ("mfem/beam-tet.mesh", 36, 48, 8.0),
        ("mfem/beam-tet.vtk", 36, 48, 8.0),
        ("mfem/ref-tetrahedron.mesh", 4, 1, 1.0 / 6.0),
    ] {
        let mesh = good::<3>(name);
        assert_eq!((mesh.nodes(), mesh.cells.len()), (nodes, cells), "{name}");
        close(mesh.measure().unwrap().value(), volume);
        close(mesh.enclosed_volume(), volume);
    }
    // One sphere of radius 1 with 30 tetrahedra: the curved one of second order is much closer to 4π/3.
    let exact = 4.0 / 3.0 * std::f64::consts::PI;
    let volume = |name| good::<3>(name).measure().unwrap().value() / exact;
    assert!(volume("polyfem/P1.msh") < 0.7 && (volume("polyfem/P2.msh") - 1.0).abs() < 0.02);
    assert_eq!(good::<3>("polyfem/P2.msh").cells.quadratic_tetrahedra.len(), 30);
}

#[test]
fn files_of_the_plane_hold_what_their_authors_meshed() {
    for (name, nodes, cells, area) in [
        ("fenris/rectangle_tri3_110.msh", 70, 110, 0.5),
        ("mfem/beam-tri.mesh", 18, 16, 8.0),
        ("mfem/beam-tri.vtk", 18, 16, 8.0),
        ("mfem/square_in_square.msh", 13, 16, 4.0),
    ] {
        let mesh = good::<2>(name);
        assert_eq!((mesh.nodes(), mesh.cells.len()), (nodes, cells), "{name}");
        close(mesh.measure().unwrap().value(), area);
    }
}

/// One cube in four files, another in four: the same numbers in all versions and encodings.
#[test]
fn versions_and_codings_give_the_same_mesh() {
    let same = |names: [&str; 4]| {
        let first = good::<3>(names[0]);
        names.iter().for_each(|name| assert_eq!(good::<3>(name), first, "{name}"));
        first
    };
    let cube = same(
        ["22_ascii", "22_binary", "41_ascii", "41_binary"]
            .map(|v| format!("mujoco/cube_{v}_vol_gmshApp.msh"))
            .each_ref()
            .map(String::as_str),
    );
    assert_eq!(cube.positions[0], [-0.5, -0.5, 0.0], "nodes in the order of the file");
    assert_eq!(cube.cells.tetrahedra[0], [9, 8, 11, 10]);
    let names = ["polyfem/22_ascii.msh", "polyfem/22_binary.msh", "polyfem/41_ascii.msh", "polyfem/41_binary.msh"];
    // Version 4.1 lists nodes by entity, so their order differs.
    let [a, b, c, d] = names.map(good::<3>);
    assert_eq!((&a, &c), (&b, &d));
    for mesh in [a, c] {
        assert_eq!(mesh.cell_groups["volume 2"], [1, 2, 3]);
        assert_eq!(mesh.cell_groups["volume 3"], [4]);
    }
    assert_eq!(good::<3>("gaia/Beam.1.ele"), good::<3>("gaia/Beam.1.vtk"));
}

#[test]
fn named_parts_become_groups_and_scalars_values() {
    let beam = good::<3>("mfem/beam-tet.mesh");
    let far = |name: &str| beam.groups[name].iter().map(|node| beam.positions[*node as usize][0]).collect::<Vec<f64>>();
    assert_eq!((far("boundary 1"), far("boundary 2")), (vec![0.0; 4], vec![8.0; 4]), "the ends of the beam");
    assert_eq!(beam.cell_groups["attribute 1"], (0..24).collect::<Vec<u32>>());
    let values = &good::<3>("mfem/beam-tet.vtk").cell_values["material"];
    assert_eq!(values[..], [[1.0; 24], [2.0; 24]].concat());
    let square = good::<2>("mfem/square_in_square.msh");
    assert!(square.groups["curve 1"].iter().all(|node| square.positions[*node as usize][1] == -1.0));
    assert_eq!(square.cell_groups["surface 2"].len() + square.cell_groups["surface 1"].len(), 16);
}

/// A plane Gmsh file with many optional parts.
const RICH: &str = "$MeshFormat\r\n2.2 0 8\r\n$EndMeshFormat\r\n$Comments\r\nby hand\r\n$EndComments\r\n$PhysicalNames\n2\n1 7 \"the floor\"\n2 3 \"steel\"\n$EndPhysicalNames\n$Nodes\n5\n1000000000 0 0 0\n7 1 0 0\n3 1 1 0\n44 0 1 0\n5 0.5 -0.25 0\n$EndNodes\n$Elements\n4\n9 15 2 0 1 7\n1 1 2 7 1 1000000000 7\n2 2 2 3 1 1000000000 7 3\n8 2 2 0 1 1000000000 3 44\n$EndElements\n$ElementData\n1\n\"density\"\n1\n0.0\n3\n0\n1\n2\n8 2.5\n2 -1e3\n$EndElementData\n";

#[test]
fn sparse_numbers_names_comments_and_values_are_read() {
    let leave_out = Mending { leave_out_unreferenced: true, ..Mending::default() };
    let (mesh, notices) = body::<2>("rich.msh", RICH.as_bytes(), leave_out).unwrap();
    assert_eq!(notices.iter().map(|n| n.code).collect::<Vec<_>>(), ["mesh.unreferenced"]);
    assert_eq!(mesh.cells.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!((&mesh.groups["the floor"][..], &mesh.groups["steel"][..]), (&[0, 1][..], &[0, 1, 2][..]));
    assert_eq!(mesh.cell_groups["steel"], [0]);
    assert_eq!(mesh.cell_values["density"], [-1e3, 2.5]);
    let error = body::<2>("rich.msh", RICH.as_bytes(), Mending::default()).unwrap_err();
    assert_eq!((error.code, error.line, error.value.as_deref()), ("mesh.unreferenced", Some(18), Some("5")));
}

#[test]
fn the_bytes_of_other_processors_are_read() {
    let mut file = b"$MeshFormat\n2.2 1 8\n".to_vec();
    file.extend(1i32.to_be_bytes());
    file.extend(b"\n$EndMeshFormat\n$Nodes\n3\n");
    for (number, x, y) in [(1i32, 0.0f64, 0.0f64), (2, 2.0, 0.0), (3, 0.0, 1.0)] {
        file.extend(number.to_be_bytes());
        [x, y, 0.0].iter().for_each(|x| file.extend(x.to_be_bytes()));
    }
    file.extend(b"\n$EndNodes\n$Elements\n1\n");
    [2i32, 1, 2, 1, 0, 5, 1, 2, 3].iter().for_each(|x| file.extend(x.to_be_bytes()));
    file.extend(b"\n$EndElements\n");
    let (mesh, _) = body::<2>("a.msh", &file, Mending::default()).unwrap();
    close(mesh.measure().unwrap().value(), 1.0);
}

/// Version 4.1 may give the coordinates of nodes on their curve or surface; physical groups belong to entities.
#[test]
fn parametric_nodes_are_read() {
    let file = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 4 \"plate\"\n$EndPhysicalNames\n$Entities\n0 1 1 0\n1 0 0 0 1 0 0 1 -9 0\n1 0 0 0 1 1 0 1 4 1 1\n$EndEntities\n$Nodes\n2 3 1 3\n1 1 1 2\n1\n2\n0 0 0 0\n1 0 0 1\n2 1 1 1\n3\n0 1 0 0.25 0.5\n$EndNodes\n$Elements\n2 2 1 2\n1 1 1 1\n1 1 2\n2 1 2 1\n2 1 2 3\n$EndElements\n";
    let (mesh, _) = body::<2>("a.msh", file.as_bytes(), Mending::default()).unwrap();
    assert_eq!(mesh.positions, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    assert_eq!((&mesh.groups["plate"][..], &mesh.groups["curve 9"][..]), (&[0, 1, 2][..], &[0, 1][..]));
}

#[test]
fn malformed_files_of_others_are_refused_with_their_line() {
    for (name, line, code) in [
        ("22_ascii_missing_element", 46, "msh.syntax"),
        ("22_ascii_missing_node", 19, "msh.syntax"),
        ("22_ascii_missing_num_nodes", 5, "msh.syntax"),
        ("41_ascii_missing_element", 66, "msh.syntax"),
        ("41_ascii_missing_node", 38, "msh.syntax"),
        ("41_ascii_missing_node_header", 13, "msh.syntax"),
    ] {
        let name = format!("mujoco/malformed_cube_{name}.msh");
        let error = body::<3>(&name, &bytes(&name), Mending::default()).unwrap_err();
        println!("{error}");
        assert_eq!((error.line, error.code), (Some(line), code), "{name}: {error}");
        assert!(error.value.is_some() && error.allowed.is_some() && error.file == name);
    }
    for (name, code, place) in [
        ("mfem/mobius-strip.mesh", "mfem.curved", Some(58)),
        ("polyfem/P4.msh", "mesh.unsupported_element", None),
        ("mujoco/cube_22_ascii_surf_gmshApp.msh", "mesh.dimension", Some(23)),
    ] {
        let error = body::<3>(name, &bytes(name), Mending::default()).unwrap_err();
        assert_eq!((error.code, error.line), (code, place), "{error}");
    }
    // A curved mesh is refused, with what can be read instead.
    let curved = body::<3>("mfem/mobius-strip.mesh", &bytes("mfem/mobius-strip.mesh"), Mending::default()).unwrap_err();
    assert_eq!(curved.allowed.as_deref(), Some("`vertices` with coordinates"));
    assert!(curved.hint.is_some_and(|hint| hint.contains("Gmsh and VTK")));
}

/// Every truncation of every good Gmsh file is refused, with a line of text files or a byte of binary files.
#[test]
fn every_truncation_of_good_gmsh_files_is_refused_with_its_place() {
    let mut files: Vec<(String, Vec<u8>)> =
        vec![("rich.msh".to_string(), RICH.split("$ElementData").next().unwrap().as_bytes().to_vec())];
    for part in ["mujoco", "fenris", "polyfem", "mfem"] {
        for entry in std::fs::read_dir(folder().join(part)).unwrap() {
            let name = format!("{part}/{}", entry.unwrap().file_name().to_str().unwrap());
            if name.ends_with(".msh") && !name.contains("malformed") && !name.contains("P4") {
                let bytes = bytes(&name);
                files.push((name, bytes));
            }
        }
    }
    assert_eq!(files.len(), 21);
    for (name, bytes) in files {
        let mut refuse = |_: &str| -> Result<Arc<[u8]>, SceneError> { panic!("no other file") };
        assert!(read(&name, &bytes, &mut refuse).is_ok(), "{name}");
        // After the last word there is only an empty line.
        for end in 0..bytes.trim_ascii_end().len() {
            let error = match read(&name, &bytes[..end], &mut refuse) {
                Err(error) => error,
                Ok(_) => panic!("{name} is read though only {end} bytes are there"),
            };
            let binary = bytes.windows(5).take(30).any(|w| w == b" 1 8\n");
            let told = error.line.is_some() || binary && error.byte.is_some();
            assert!(told && !error.file.is_empty() && error.value.is_some(), "{name}, {end} bytes: {error}");
        }
    }
}

/// Truncated files of other formats are refused as well, unless the mesh is complete.
#[test]
fn truncations_of_other_files_are_refused_or_whole() {
    for name in [
        "gaia/Beam.1.vtk",
        "mfem/beam-tet.vtk",
        "mfem/beam-tet.mesh",
        "mfem/ref-tetrahedron.mesh",
        "gaia/Beam.1.ele",
        "gaia/Beam.1.node",
    ] {
        let (bytes, whole) = (bytes(name), good::<3>(name));
        let mut refused = 0;
        for end in 0..bytes.len() {
            match body::<3>(name, &bytes[..end], Mending::default()) {
                Ok((mesh, _)) => {
                    assert_eq!((&mesh.cells, &mesh.facets), (&whole.cells, &whole.facets), "{name}, {end} bytes");
                    // A last number that has lost digits cannot be distinguished from another one.
                    let all = mesh.positions.iter().zip(&whole.positions);
                    assert!(all.filter(|(p, q)| p != q).count() <= 1, "{name}, {end} bytes");
                }
                Err(error) => {
                    refused += 1;
                    assert!(error.line.is_some() || error.code == "mesh.empty", "{name}, {end} bytes: {error}");
                }
            }
        }
        assert!(refused * 10 > bytes.len() * 4, "{name}: {refused} of {}", bytes.len());
    }
}

/// Two triangles in Gmsh 2.2, with lines of elements and more nodes.
fn plate(more: &str, elements: &[&str]) -> String {
    let nodes = 4 + more.lines().count();
    let list: String = elements.iter().enumerate().map(|(k, e)| format!("{} {e}\n", k + 1)).collect();
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{nodes}\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n{more}$EndNodes\n$Elements\n{}\n{list}$EndElements\n",
        elements.len()
    )
}

#[test]
fn what_no_body_can_be_made_of_is_refused_with_its_line() {
    const TWO: [&str; 2] = ["2 0 1 2 3", "2 0 1 3 4"];
    for (file, code, line, value) in [
        (plate("", &[TWO[0], "2 0 1 4 3"]), "mesh.inverted", 14, "-5e-1"),
        (plate("", &["2 0 2 1 3", "2 0 1 4 3"]), "mesh.inverted", 13, "-5e-1"),
        (plate("5 0.5 0.5 0\n", &[TWO[0], TWO[1], "2 0 1 5 3"]), "mesh.degenerate_element", 16, "0e0"),
        (plate("5 2 2 0\n", &TWO), "mesh.unreferenced", 10, "5"),
        (plate("5 2 2 1\n", &[TWO[0], TWO[1], "2 0 2 5 3"]), "mesh.dimension", 10, "1"),
        (plate("3 2 2 0\n", &TWO), "mesh.duplicate_node", 10, "3"),
        (plate("", &[TWO[0], TWO[1], "2 0 3 4 1"]), "mesh.duplicate_element", 15, "3"),
        (plate("", &[TWO[0], TWO[1], "2 0 3 4 3"]), "mesh.degenerate_element", 15, "3"),
        (plate("", &[TWO[0], "2 0 1 3 9"]), "mesh.index", 14, "9"),
        (plate("5 2 2 0\n", &[TWO[0], TWO[1], "1 0 3 5"]), "mesh.mixed_dimension", 16, "3"),
        (plate("", &["6 0 1 2 3 4 1 2"]), "mesh.unsupported_element", 13, "6"),
        (plate("", &["10 0 1 2 3 4 1 2 3 4 1"]), "mesh.unsupported_element", 13, "10"),
        (plate("", &["777 0 1"]), "mesh.unsupported_element", 13, "777"),
        (plate("5 1,5 0 0\n", &TWO), "msh.syntax", 10, "1,5"),
        (plate("5 nan 0 0\n", &TWO), "scene.not_finite", 10, "NaN"),
        (plate("5 1e400 0 0\n", &TWO), "scene.not_finite", 10, "inf"),
        (plate("5 0 0 0 0\n", &TWO), "msh.syntax", 10, "0"),
        (plate("", &["15 0 1"]), "mesh.dimension", 13, "point"),
        (plate("", &TWO).replace("$Nodes\n4", "$Nodes\n4294967295"), "msh.size", 5, "4294967295"),
        (plate("", &TWO).replace("2.2 0", "4 0"), "msh.version", 2, "4"),
        (plate("", &TWO).replace("$EndNodes", "$EndNode"), "msh.syntax", 10, "$EndNode"),
        (plate("", &TWO) + "$Elements\n", "msh.syntax", 16, "$Elements"),
        (plate("", &TWO) + "$Periodic\n1\n", "msh.syntax", 16, "$Periodic"),
        (plate("", &TWO) + "$NodeData\n1\n", "msh.syntax", 17, "end of file"),
    ] {
        let error = body::<2>("a.msh", file.as_bytes(), Mending::default()).map(|_| file.clone()).unwrap_err();
        println!("{error}");
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
        assert!(error.allowed.is_some() || error.hint.is_some(), "{error}");
    }
    // Two elements with the same number, and numbers beyond the announced ones.
    let modern = |nodes: &str, elements: &str| {
        format!(
            "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 4 {nodes}\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n$EndNodes\n\
             $Elements\n1 2 {elements}\n2 1 2 2\n7 1 2 3\n8 1 3 4\n$EndElements\n"
        )
    };
    let good = modern("1 4", "7 8");
    assert_eq!(body::<2>("a.msh", good.as_bytes(), Mending::default()).expect("a plate").0.cells.len(), 2);
    for (file, code, line, value) in [
        (plate("", &TWO).replace("\n2 2 0 1 3 4", "\n1 2 0 1 3 4"), "mesh.duplicate_element", 14, "1"),
        (good.replace("\n8 1 3 4", "\n7 1 3 4"), "mesh.duplicate_element", 20, "7"),
        (modern("1 3", "7 8"), "msh.size", 5, "1, 3"),
        (modern("2 4", "7 8"), "msh.size", 5, "2, 4"),
        (modern("1 4", "1 2"), "msh.size", 17, "1, 2"),
    ] {
        let error = body::<2>("a.msh", file.as_bytes(), Mending::default()).map(|_| file.clone()).unwrap_err();
        println!("{error}");
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
    }
    let error = body::<2>("cube.msh", &bytes("mujoco/cube_22_ascii_vol_gmshApp.msh"), Mending::default()).unwrap_err();
    assert_eq!((error.code, error.line), ("mesh.dimension", Some(23)), "{error}");
    // Three tetrahedra at one face.
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n6 0 0 -1\n$EndNodes\n$Elements\n3\n1 4 0 1 2 3 4\n2 4 0 1 2 3 5\n3 4 0 1 3 2 6\n$EndElements\n";
    let error = body::<3>("a.msh", file.as_bytes(), Mending::default()).unwrap_err();
    assert_eq!((error.code, error.line), ("mesh.non_manifold", Some(17)), "{error}");
}

#[test]
fn inverted_cells_are_turned_on_request_and_counted() {
    let turn = Mending { turn_inverted: true, ..Mending::default() };
    let file = plate("", &["2 0 1 2 3", "2 0 1 4 3"]);
    let (mesh, notices) = body::<2>("a.msh", file.as_bytes(), turn).unwrap();
    assert_eq!((notices[0].code, notices[0].value.as_deref()), ("mesh.flipped", Some("1")));
    assert_eq!(mesh.check(), []);
    // A quadratic triangle that folds at a corner stays refused: flipping it would not help.
    let file = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.9 0 0\n5 0.5 0.5 0\n6 0 0.5 0\n$EndNodes\n$Elements\n1\n1 9 0 1 2 3 4 5 6\n$EndElements\n";
    let error = body::<2>("a.msh", file.as_bytes(), turn).unwrap_err();
    assert_eq!(error.code, "mesh.inverted");
    assert!(error.message.contains("folds over itself"), "{error}");
}

#[test]
fn medit_references_and_its_end_are_read() {
    let file = "MeshVersionFormatted 2\n# by hand\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 5\n0 0 1 5\nTriangles 1\n1 3 2 9\nTetrahedra\n1\n1 2 3 4 2\nCorners 1\n1\nEnd\n";
    let (mesh, notices) = body::<3>("a.mesh", file.as_bytes(), Mending::default()).unwrap();
    assert_eq!(notices.len(), 1, "corners are left out, and counted");
    let names: Vec<&str> = mesh.groups.keys().map(String::as_str).collect();
    assert_eq!(names, ["tetrahedron 2", "triangle 9", "vertex 5"]);
    assert_eq!(mesh.groups["vertex 5"], [2, 3]);
    assert_eq!(mesh.cell_groups["tetrahedron 2"], [0]);
    for end in 0..file.trim_end().len() {
        assert!(body::<3>("a.mesh", &file.as_bytes()[..end], Mending::default()).is_err(), "{end} bytes");
    }
    for (from, to, code, line) in [
        ("1 2 3 4 2", "1 2 3 5 2", "mesh.index", 14),
        ("1 2 3 4 2", "1 2 3 0 2", "mesh.index", 14),
        ("Tetrahedra", "Prisms", "mesh.unsupported_element", 12),
        ("Dimension 3", "Dimension 4", "medit.syntax", 3),
        ("End", "End of it", "medit.syntax", 17),
        ("MeshVersion", "Mesh", "mesh.format", 1),
    ] {
        let error = body::<3>("a.mesh", file.replace(from, to).as_bytes(), Mending::default()).unwrap_err();
        assert_eq!((error.code, error.line), (code, Some(line)), "{error}");
    }
}
