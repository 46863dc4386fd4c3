//! Mesh files that contradict themselves: each is refused with its file, its line and the impossible value.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use opruga_io::SceneError;
use opruga_io::meshes::{Mending, read};
use opruga_mesh::Mesh;
use std::sync::Arc;

type Outcome = Result<(Mesh<3>, Vec<SceneError>), SceneError>;

/// The body in a file with these contents, which needs no other file.
fn body(name: &str, text: &str) -> Outcome {
    let mut open = |_: &str| -> Result<Arc<[u8]>, SceneError> { panic!("no other file") };
    read(name, text.as_bytes(), &mut open)?.assemble(Mending::default())
}

/// Two tetrahedra in each format.
const VTK: &str = "# vtk DataFile Version 3.0\nby hand\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\nCELL_DATA 2\nSCALARS E double 1\nLOOKUP_TABLE default\n1 2\n";
const VTU: &str = "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">\n<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3 1 2 3 4</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\">4 8</DataArray>\n<DataArray type=\"UInt8\" Name=\"types\">10 10</DataArray></Cells>\n<CellData><DataArray type=\"Float64\" Name=\"E\">1 2</DataArray></CellData>\n</Piece></UnstructuredGrid></VTKFile>\n";
const MSH: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 0 0\n$EndEntities\n$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n$Elements\n1 2 1 2\n3 1 4 2\n1 1 2 3 4\n2 2 3 4 5\n$EndElements\n";
const MFEM: &str = "MFEM mesh v1.0\n\ndimension\n3\n\nelements\n2\n1 4 0 1 2 3\n2 4 1 2 3 4\n\nboundary\n1\n3 2 0 2 1\n\nvertices\n5\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n";
const MEDIT: &str = "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\nTetrahedra\n2\n1 2 3 4 1\n2 3 4 5 2\nEnd\n";
const NODE: &str = "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n";
const ELE: &str = "2 4 0\n1 1 2 3 4\n2 2 3 4 5\n";

/// Values of elements in a Gmsh file.
fn element_data(first: &str, second: &str) -> String {
    format!("$ElementData\n1\n\"E\"\n1\n0\n3\n0\n1\n2\n{first}\n{second}\n$EndElementData\n")
}

/// Contradictions within a file: in repeated parts, in parts of numbers, or in numbers that their types cannot represent.
#[test]
#[expect(clippy::too_many_lines, reason = "a table: one row for every contradiction")]
fn files_that_contradict_themselves_are_refused_with_their_line_and_value() {
    let offsets = VTK.replace(
        "CELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\n",
        "CELLS 3 8\nOFFSETS vtktypeint64\n0 4 8\nCONNECTIVITY vtktypeint64\n0 1 2 3\n1 2 3 4\n",
    );
    let real = offsets.replace("vtktypeint64", "double");
    let steps = format!("{MSH}{}{}", element_data("1 5", "2 6"), element_data("1 50", "2 60"));
    let marked = MFEM.replace("v1.0", "v1.3") + "mfem_mesh_end\n";
    for (name, file) in [
        ("a.vtk", VTK),
        ("a.vtk", &offsets),
        ("a.vtk", &real),
        ("a.vtu", VTU),
        ("a.msh", MSH),
        ("a.msh", &steps),
        ("a.mesh", MFEM),
        ("a.mesh", &marked),
        ("a.mesh", MEDIT),
    ] {
        let (mesh, notices) = body(name, file).unwrap_or_else(|e| panic!("{e}"));
        let volume = mesh.measure().unwrap().value();
        assert!((volume - 0.5).abs() < 1e-12, "{volume}");
        // Later steps do not silently replace the first.
        let told: Vec<&str> = notices.iter().map(|notice| &notice.message[..]).collect();
        assert_eq!(told, if file == steps { vec!["1 later step is left out of the values `E`"] } else { vec![] });
        assert!(file != steps || mesh.cell_values["E"] == [5.0, 6.0]);
    }
    let bytes = |what: &str, point: &str| {
        VTK.replace("5 double", &format!("5 {what}")).replace("\n1 1 1\n", &format!("\n{point}\n"))
    };
    let before = |at: &str, more: &str| MSH.replace(at, &format!("{more}{at}"));
    let names = "$PhysicalNames\n2\n3 1 \"a\"\n3 1 \"b\"\n$EndPhysicalNames\n";
    let entities = "$Entities\n0 0 0 0\n$EndEntities\n";
    let twice = |section: &str| format!("{MFEM}{section}\n");
    for (name, file, code, line, value) in [
        ("a.vtk", VTK.replace("CELL_D", "CELLS 1 5\n4 0 1 2 3\nCELL_D"), "vtk.syntax", 17, "CELLS"),
        ("a.vtk", VTK.replace("CELL_D", "POINTS 1 double\n0 0 0\nCELL_D"), "vtk.syntax", 17, "POINTS"),
        ("a.vtk", VTK.replace("CELL_D", "CELL_TYPES 2\n10\n10\nCELL_D"), "vtk.syntax", 17, "CELL_TYPES"),
        ("a.vtk", format!("{VTK}SCALARS E double 1\nLOOKUP_TABLE default\n3 4\n"), "vtk.syntax", 21, "E"),
        ("a.vtk", VTK.replace("4 1 2 3 4", "4 1 2 3 -1"), "mesh.index", 13, "-1"),
        ("a.vtk", VTK.replace("4 1 2 3 4", "4 1 2 3 4.5"), "vtk.syntax", 13, "4.5"),
        ("a.vtk", VTK.replace("CELLS 2", "CELLS 3"), "vtk.size", 11, "3"),
        ("a.vtk", VTK.replace("10\n10\n", "10\n-10\n"), "mesh.unsupported_element", 16, "-10"),
        ("a.vtk", bytes("unsigned_char", "300 1 1"), "vtk.syntax", 10, "300"),
        ("a.vtk", bytes("unsigned_char", "1 -7 1"), "vtk.syntax", 10, "-7"),
        ("a.vtk", bytes("float", "1 1e39 1"), "vtk.syntax", 10, "1e39"),
        ("a.vtk", offsets.replace("\n0 4 8", "\n1 4 8"), "vtk.size", 13, "1"),
        ("a.vtk", offsets.replace("\n0 4 8", "\n0 4 7"), "vtk.size", 13, "7"),
        ("a.vtk", offsets.replace("\n0 4 8", "\n0 4 9"), "vtk.size", 13, "9"),
        ("a.vtk", offsets.replace("\n0 4 8", "\n0 9 8"), "vtk.size", 13, "9"),
        ("a.vtk", real.replace("\n0 4 8", "\n0 4.5 8"), "vtk.syntax", 13, "4.5"),
        ("a.vtk", real.replace("\n0 1 2 3", "\n0 1 2 3.7"), "vtk.syntax", 15, "3.7"),
        ("a.vtu", VTU.replace("2 3 4<", "2 3.9 4<"), "vtu.syntax", 3, "3.9"),
        (
            "a.vtu",
            VTU.replace("Int64\" Name=\"c", "Float64\" Name=\"c").replace("2 3 4<", "2 3.9 4<"),
            "vtu.syntax",
            3,
            "3.9",
        ),
        ("a.vtu", VTU.replace(">4 8<", ">4.5 8<"), "vtu.syntax", 4, "4.5"),
        ("a.vtu", VTU.replace(">10 10<", ">10 10.9<"), "vtu.syntax", 5, "10.9"),
        ("a.vtu", VTU.replace(">10 10<", ">10 300<"), "vtu.syntax", 5, "300"),
        ("a.vtu", VTU.replace("2 3 4<", "2 3 -1<"), "mesh.index", 3, "-1"),
        ("a.vtu", VTU.replace("2 3 4<", "2 3 9<"), "mesh.index", 3, "9"),
        ("a.vtu", VTU.replace("<Cells>", "<Points></Points><Cells>"), "vtu.syntax", 3, "<Points>"),
        (
            "a.vtu",
            VTU.replace("</Cells>", "<DataArray Name=\"connectivity\"/></Cells>"),
            "vtu.syntax",
            5,
            "connectivity",
        ),
        (
            "a.vtu",
            VTU.replace("</CellD", "<DataArray type=\"Int8\" Name=\"E\">3 4</DataArray></CellD"),
            "vtu.syntax",
            6,
            "E",
        ),
        ("a.vtu", VTU.replace("Components=\"3\"", "Components=\"2\""), "vtu.syntax", 2, "2"),
        ("a.vtu", VTU.replace("LittleEndian", "Middle"), "vtu.syntax", 1, "Middle"),
        ("a.msh", MSH.replace("\n3 1 4 2", "\n9 1 4 2"), "msh.syntax", 24, "9"),
        ("a.msh", MSH.replace("\n3 1 4 2", "\n-3 1 4 2"), "msh.syntax", 24, "-3"),
        ("a.msh", MSH.replace("\n3 1 4 2", "\n2 1 4 2"), "msh.syntax", 24, "2"),
        ("a.msh", MSH.replace("\n3 1 4 2", "\n3 77 4 2"), "mesh.index", 24, "77"),
        ("a.msh", MSH.replace("1\n1 0 0 0 1 1 1 0 0", "2\n1 0 0 0 1 1 1 0 0\n1 0 0 0 1 1 1 0 0"), "msh.syntax", 7, "1"),
        ("a.msh", before("$Nodes", entities), "msh.syntax", 8, "$Entities"),
        ("a.msh", before("$Entities", names), "msh.syntax", 7, "1"),
        ("a.msh", format!("{MSH}{names}"), "msh.syntax", 28, "$PhysicalNames"),
        ("a.msh", format!("{MSH}{}", element_data("1 5", "1 6")), "mesh.duplicate_element", 38, "1"),
        ("a.mesh", MFEM.replace("dimension\n3", "dimension\n2"), "mesh.mixed_dimension", 8, "4"),
        ("a.mesh", MFEM.replace("dimension\n3", "dimension\n1"), "mesh.mixed_dimension", 8, "4"),
        ("a.mesh", MFEM.replace("dimension\n3\n", ""), "mfem.syntax", 4, "elements"),
        ("a.mesh", MFEM.replace("dimension\n3\n", "dimension\n3\ndimension\n2\n"), "mfem.syntax", 5, "dimension"),
        ("a.mesh", MFEM.replace("3 2 0 2 1", "3 4 0 1 2 3"), "mesh.mixed_dimension", 13, "4"),
        ("a.mesh", twice("elements"), "mfem.syntax", 23, "elements"),
        ("a.mesh", twice("boundary"), "mfem.syntax", 23, "boundary"),
        ("a.mesh", twice("vertices"), "mfem.syntax", 23, "vertices"),
        ("a.mesh", MFEM.replace("5\n3\n", "5\n2\n"), "mfem.syntax", 17, "2"),
        ("a.mesh", MFEM.replace("elements\n2\n1 4 0 1 2 3\n2 4 1 2 3 4\n", ""), "mfem.syntax", 18, "end of file"),
        ("a.mesh", MFEM.replace("v1.0", "v1.3"), "mfem.syntax", 22, "end of file"),
        ("a.mesh", twice("mfem_mesh_end\nvertices"), "mfem.syntax", 24, "vertices"),
        ("a.mesh", MEDIT.replace("Formatted 2", "Formatted 9"), "medit.version", 1, "9"),
        ("a.mesh", MEDIT.replace("Tetra", "Dimension 2\nTetra"), "medit.syntax", 10, "Dimension"),
        ("a.mesh", MEDIT.replace("Tetrahedra", "TetrahedraP2"), "mesh.unsupported_element", 10, "TetrahedraP2"),
        ("a.mesh", MEDIT.replace("End", "Tetrahedra\n0\nEnd"), "medit.syntax", 14, "Tetrahedra"),
    ] {
        let error = body(name, &file).map(|_| file.clone()).unwrap_err();
        println!("{error}");
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
        assert!(error.allowed.is_some() || error.hint.is_some(), "{error}");
    }
}

/// Whichever of the two TetGen files is named, an error points at the file that contains the fault.
#[test]
fn errors_of_tetgen_point_at_the_file_of_the_nodes_or_of_the_elements() {
    for (node, ele, code, file, line, value) in [
        (NODE.into(), ELE.replace("\n2 2", "\n1 2"), "tetgen.syntax", "a.ele", 3, "1"),
        (NODE.into(), ELE.replace("\n2 2", "\n7 2"), "tetgen.syntax", "a.ele", 3, "7"),
        (NODE.into(), ELE.replace("2 3 4 5", "3 2 4 5"), "mesh.inverted", "a.ele", 3, "-3.333333333333333e-1"),
        (NODE.replace("5 3 0 0", "6 3 0 0") + "6 9 9 9\n", ELE.into(), "mesh.unreferenced", "a.node", 7, "6"),
        (NODE.replace("5 1 1 1", "5 1 1 nan"), ELE.into(), "scene.not_finite", "a.node", 6, "NaN"),
    ] {
        let files = [("a.node", node), ("a.ele", ele)];
        for name in ["a.node", "a.ele"] {
            let bytes = |name: &str| files.iter().find(|file| file.0 == name).expect("one of them").1.as_bytes();
            let refused = read(name, bytes(name), &mut |other| Ok(Arc::from(bytes(other))))
                .and_then(|file| file.assemble::<3>(Mending::default()));
            let error = refused.map(|_| name).unwrap_err();
            println!("{error}");
            let place = (error.code, error.file.as_str(), error.line, error.value.as_deref());
            assert_eq!(place, (code, file, Some(line), Some(value)), "{error}");
        }
    }
}

/// A text without an end mark that stops within its last line is refused, even if the truncated number looks complete.
#[test]
fn texts_cut_off_within_their_last_number_are_refused_with_its_line() {
    let mfem = MFEM.replace("1 1 1\n", "1 1 1.75\n");
    let vtk = VTK.replace("1 2\n", "1000.0\n125.75\n");
    let attributes =
        ELE.replace("2 4 0", "2 4 1").replace("1 2 3 4\n", "1 2 3 4 7.5\n").replace("3 4 5\n", "3 4 5 125.5\n");
    let coordinates = NODE.replace("1 1 1\n", "1 1 1.75\n");
    // The file, the other TetGen file, and the number that is truncated.
    for (name, whole, other, number) in [
        ("a.mesh", &mfem[..], "", "1.75"),
        ("a.mfem", &mfem, "", "1.75"),
        ("a.vtk", &vtk, "", "125.75"),
        ("a.node", &coordinates, ELE, "1.75"),
        ("a.ele", ELE, NODE, "5"),
        ("a.ele", &attributes, NODE, "125.5"),
    ] {
        let outcome = |text: &str| -> Outcome {
            let mut open = |_: &str| -> Result<Arc<[u8]>, SceneError> { Ok(Arc::from(other.as_bytes())) };
            read(name, text.as_bytes(), &mut open)?.assemble(Mending::default())
        };
        outcome(whole).unwrap_or_else(|e| panic!("{name}: {e}"));
        outcome(&whole.replace('\n', "\r\n")).unwrap_or_else(|e| panic!("{name}: {e}"));
        for kept in 1..=number.len() {
            let text = &whole[..whole.len() - 1 - number.len() + kept];
            let error = outcome(text).expect_err(&number[..kept]);
            assert_eq!(
                error.message, "the file ends in the middle of its last line, possibly in a number",
                "{name} {kept}"
            );
            assert_eq!(
                (error.line, error.value.as_deref()),
                (Some(whole.lines().count()), Some(&number[..kept])),
                "{name}"
            );
            let hint = error.hint.unwrap_or_default();
            assert!(hint.starts_with("if the file is complete, end its last line with a line break"), "{hint}");
        }
    }
    // Marks show that a file is complete, and so does a comment after the last number.
    for (name, text) in [
        ("a.mesh", MFEM.replace("v1.0", "v1.3") + "mfem_mesh_end"),
        ("a.mesh", MFEM.trim_end().to_string() + " # the last"),
        ("a.mesh", MEDIT.trim_end().to_string()),
        ("a.msh", MSH.trim_end().to_string()),
        ("a.vtu", VTU.trim_end().to_string()),
    ] {
        body(name, &text).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// The lowest and the highest number announced for nodes and elements must be those that occur; numbers between may be missing.
#[test]
fn promised_numbers_of_gmsh_are_those_that_are_there() {
    let error = body("a.msh", include_str!("../data/faults/largest-tag.msh")).expect_err("100 is not there");
    assert_eq!((error.code, error.line, error.value.as_deref()), ("msh.size", Some(9), Some("1, 100")));
    assert_eq!(error.allowed.as_deref(), Some("1, 14"));
    let sparse = MSH.replace("1 5 1 5\n", "1 5 1 1000000000\n").replace("3\n4\n5\n", "3\n7\n1000000000\n");
    let sparse = sparse.replace("1 1 2 3 4\n2 2 3 4 5\n", "1 1 2 3 7\n2 2 3 7 1000000000\n");
    assert!((body("a.msh", &sparse).expect("sparse").0.measure().expect("a volume").value() - 0.5).abs() < 1e-12);
    for (good, bad, line) in [("1 5 1 5\n", "1 5 0 5\n", 9), ("1 2 1 2\n", "1 2 1 3\n", 23)] {
        let error = body("a.msh", &MSH.replace(good, bad)).expect_err("other numbers");
        assert_eq!((error.code, error.line), ("msh.size", Some(line)), "{error}");
    }
}
