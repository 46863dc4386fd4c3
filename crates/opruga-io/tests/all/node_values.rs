//! Values of nodes in files of other programs: every format keeps them with their nodes, or reports the location of errors.
#![allow(clippy::result_large_err, reason = "errors are rare, and say much")]

use opruga_io::SceneError;
use opruga_io::meshes::{Mending, read};
use opruga_mesh::Mesh;
use std::sync::Arc;

fn body<const D: usize>(name: &str, bytes: &[u8]) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
    let mut open = |_: &str| -> Result<Arc<[u8]>, SceneError> { panic!("no other file") };
    read(name, bytes, &mut open)?.assemble(Mending { leave_out_unreferenced: true, ..Mending::default() })
}

/// A triangle and a node without cells, with unordered numbers, in Gmsh 2.2, followed by values of nodes.
fn gmsh(values: &str) -> String {
    format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n70 0 0 0\n3 5 5 0\n44 1 0 0\n5 0 1 0\n$EndNodes\n\
         $Elements\n1\n1 2 0 70 44 5\n$EndElements\n{values}"
    )
}

fn node_data(name: &str, components: usize, rows: &[&str]) -> String {
    let rows_of = rows.join("\n");
    format!("$NodeData\n1\n\"{name}\"\n1\n0\n3\n0\n{components}\n{}\n{rows_of}\n$EndNodeData\n", rows.len())
}

#[test]
fn gmsh_keeps_values_with_their_nodes_whatever_the_numbers() {
    let rows = ["5 0.1 0.2 0.3", "3 9 9 9", "70 1 2 3", "44 -1 -2e-3 4"];
    let text = gmsh(&(node_data("wind speed", 3, &rows) + &node_data("T", 1, &["44 20", "70 10"])));
    let (mesh, notices) = body::<2>("a.msh", text.as_bytes()).unwrap();
    assert_eq!(notices.iter().map(|n| n.code).collect::<Vec<_>>(), ["mesh.unreferenced"]);
    // The node that no cell uses is dropped with its values.
    let wind = &mesh.node_values["wind speed"];
    assert_eq!((wind.components, &wind.values[..]), (3, &[1.0, 2.0, 3.0, -1.0, -2e-3, 4.0, 0.1, 0.2, 0.3][..]));
    let warm = &mesh.node_values["T"].values;
    assert!(warm[..2] == [10.0, 20.0] && warm[2].is_nan(), "a node without a value has none: {warm:?}");
    // Tensors are not used, nor are later steps.
    let text = gmsh(
        &(node_data("s", 9, &["5 1 2 3 4 5 6 7 8 9"]) + &node_data("T", 1, &["5 1"]) + &node_data("T", 1, &["5 2"])),
    );
    let (mesh, notices) = body::<2>("a.msh", text.as_bytes()).unwrap();
    let told: Vec<&str> = notices.iter().map(|n| n.message.as_str()).collect();
    assert!(told[0].contains("9 components") && told[1].contains("1 later step"), "{told:?}");
    assert_eq!(mesh.node_values.keys().collect::<Vec<_>>(), ["T"]);
    assert_eq!(mesh.node_values["T"].values[2], 1.0);
}

#[test]
fn gmsh_keeps_values_of_nodes_in_binary() {
    for big in [false, true] {
        let whole = |x: i32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        let real = |x: f64| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        let mut file = b"$MeshFormat\n2.2 1 8\n".to_vec();
        file.extend(whole(1));
        file.extend(b"\n$EndMeshFormat\n$Nodes\n3\n");
        for (number, x, y) in [(1, 0.0, 0.0), (2, 2.0, 0.0), (3, 0.0, 1.0)] {
            file.extend(whole(number));
            [x, y, 0.0].iter().for_each(|x| file.extend(real(*x)));
        }
        file.extend(b"\n$EndNodes\n$Elements\n1\n");
        [2, 1, 2, 1, 0, 5, 1, 2, 3].iter().for_each(|x| file.extend(whole(*x)));
        file.extend(b"\n$EndElements\n$NodeData\n1\n\"v\"\n1\n0\n3\n0\n3\n3\n");
        for number in [3, 1, 2] {
            file.extend(whole(number));
            (0..3).for_each(|k| file.extend(real(f64::from(10 * number + k))));
        }
        file.extend(b"\n$EndNodeData\n");
        let (mesh, notices) = body::<2>("a.msh", &file).unwrap();
        assert_eq!(notices, []);
        assert_eq!(mesh.node_values["v"].values, [10.0, 11.0, 12.0, 20.0, 21.0, 22.0, 30.0, 31.0, 32.0]);
    }
}

#[test]
fn values_of_nodes_that_gmsh_files_get_wrong_are_refused_with_their_line() {
    for (data, code, line, value) in [
        (node_data("v", 3, &["5 1 2 3", "9 1 2 3"]), "mesh.index", 25, "9"),
        (node_data("v", 3, &["5 1 2 3", "5 1 2 3"]), "mesh.duplicate_node", 25, "5"),
        (node_data("v", 3, &["5 1 nan 3"]), "scene.not_finite", 24, "NaN"),
        (node_data("v", 3, &["5 1 2 fast"]), "msh.syntax", 24, "fast"),
        (node_data("v", 3, &["5 1 2"]), "msh.syntax", 25, "$EndNodeData"),
        (node_data("v", 2, &["5 1 2 3"]), "msh.syntax", 24, "3"),
        (node_data("v", 3, &["5 1 2 3"]).replace("\n3\n1\n", "\n3\n100\n"), "msh.size", 23, "100"),
    ] {
        let error = body::<2>("a.msh", gmsh(&data).as_bytes()).map(|_| data.clone()).unwrap_err();
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
        assert!(error.file == "a.msh" && error.allowed.is_some(), "{error}");
    }
}

/// A tetrahedron in VTK, with further text after the types of cells.
fn vtk(more: &str) -> String {
    format!(
        "# vtk DataFile Version 3.0\nmade by hand\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n\
         CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n{more}"
    )
}

#[test]
fn vtk_keeps_values_of_points() {
    let text = vtk(
        "CELL_DATA 1\nSCALARS E double 1\nLOOKUP_TABLE default\n5\nPOINT_DATA 4\nVECTORS velocity%20of%20flow float\n\
         1 2 3 4 5 6 7 8 9 10 11 12.5\nSCALARS T double\nLOOKUP_TABLE default\n1 2 3 4\nFIELD more 1\nflat 2 4 double\n0 1 2 3 4 5 6 7\n",
    );
    let (mesh, notices) = body::<3>("a.vtk", text.as_bytes()).unwrap();
    assert_eq!(notices, []);
    let of = |name: &str| (mesh.node_values[name].components, mesh.node_values[name].values.clone());
    let numbers: Vec<f64> = (1..12).map(f64::from).chain([12.5]).collect();
    assert_eq!(of("velocity of flow"), (3, numbers));
    assert_eq!(of("T"), (1, vec![1.0, 2.0, 3.0, 4.0]));
    assert_eq!(of("flat"), (2, (0..8).map(f64::from).collect()));
    assert_eq!(mesh.cell_values["E"], [5.0]);
    for (more, code, line, value) in [
        ("POINT_DATA 3\nVECTORS v double\n1 2 3 4 5 6 7 8 9\n", "vtk.size", 11, "3"),
        ("POINT_DATA 4\nVECTORS v double\n1 2 3 4 5 6 7 8 9 10 11 nan\n", "scene.not_finite", 13, "NaN"),
        ("POINT_DATA 4\nVECTORS v double\n1 2 3 4 5 6 7 8 9 10 11\nSCALARS T double\n", "vtk.syntax", 14, "SCALARS"),
        ("POINT_DATA 4\nFIELD a 1\nv 3 3 double\n1 2 3 4 5 6 7 8 9\n", "vtk.size", 13, "3"),
        ("POINT_DATA 4\nSCALARS v int\n1 2 3 4\nSCALARS v int\n1 2 3 4\n", "vtk.syntax", 14, "v"),
    ] {
        let error = body::<3>("a.vtk", vtk(more).as_bytes()).map(|_| more).unwrap_err();
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
        assert!(error.file == "a.vtk" && error.allowed.is_some(), "{error}");
    }
}

/// A piece of one tetrahedron, with values of points.
fn piece(values: &str) -> String {
    format!(
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>\n\
         <Cells><DataArray type=\"Int8\" Name=\"connectivity\">0 1 2 3</DataArray><DataArray type=\"Int8\" Name=\"offsets\">4</DataArray><DataArray \
         type=\"Int8\" Name=\"types\">10</DataArray></Cells>\n<PointData>\n{values}\n</PointData></Piece>\n"
    )
}

fn vtu(pieces: &str) -> String {
    format!("<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid>\n{pieces}</UnstructuredGrid></VTKFile>")
}

fn array(name: &str, components: &str, numbers: &str) -> String {
    format!("<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\">{numbers}</DataArray>")
}

const TWELVE: &str = "1 2 3 4 5 6 7 8 9 10 11 12";

#[test]
fn vtk_xml_keeps_values_of_points() {
    // In two pieces: the first lacks one quantity and the second another; texts and tensors cannot be stored.
    let words = "<DataArray type=\"String\" Name=\"names\" NumberOfComponents=\"1\">65 0</DataArray>";
    let tensors = array("stress", "9", &"0 ".repeat(36));
    let first = piece(&(array("v", "3", TWELVE) + words + &tensors));
    let second = piece(&(array("T", "1", "1 2 3 nan") + &array("v", "3", TWELVE)));
    let (mesh, notices) = body::<3>("a.vtu", vtu(&(first + &second.replace("0 0 0 1", "5 0 0 6"))).as_bytes()).unwrap();
    assert_eq!(notices.len(), 2, "{notices:?}");
    let numbers: Vec<f64> = (1..13).map(f64::from).collect();
    assert_eq!(
        (mesh.node_values["v"].components, &mesh.node_values["v"].values),
        (3, &[&numbers[..], &numbers].concat())
    );
    let warm = &mesh.node_values["T"].values;
    assert_eq!((warm.len(), warm.iter().filter(|x| x.is_nan()).count(), &warm[4..7]), (8, 5, &[1.0, 2.0, 3.0][..]));
    for (pieces, code, line, value) in [
        (piece(&array("v", "3", "1 2 3")), "vtu.size", 5, "3"),
        (piece(&array("v", "3", &TWELVE.replace('7', "x"))), "vtu.syntax", 5, "x"),
        (piece(&(array("v", "1", "1 2 3 4") + "\n" + &array("v", "3", TWELVE))), "vtu.syntax", 6, "v"),
        (piece(&array("v", "1", "1 2 3 4")) + &piece(&array("v", "3", TWELVE)), "mesh.components", 10, "3"),
    ] {
        let error = body::<3>("a.vtu", vtu(&pieces).as_bytes()).map(|_| pieces.clone()).unwrap_err();
        assert_eq!((error.code, error.line, error.value.as_deref()), (code, Some(line), Some(value)), "{error}");
        assert!(error.file == "a.vtu" && error.allowed.is_some(), "{error}");
    }
}

/// Names of values that few nodes have are counted like those of cells.
#[test]
fn values_of_nodes_have_the_budget_of_values() {
    let nodes: String = (0..5_000).map(|k| format!("{} {} {} 0\n", k + 3, k % 71, k / 71 + 1)).collect();
    let head = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5002\n1 0 0 0\n2 1 0 0\n{nodes}$EndNodes\n$Elements\n1\n1 2 0 1 2 3\n$EndElements\n"
    );
    let data: String = (0..2_500).map(|k| format!("$NodeData\n1\n\"v{k}\"\n0\n3\n0\n3\n0\n$EndNodeData\n")).collect();
    let error = body::<2>("a.msh", (head + &data).as_bytes()).map(|_| ()).unwrap_err();
    assert_eq!(
        (error.code, error.allowed.as_deref()),
        ("limit.values", Some("at most 33554432 values or memberships in groups"))
    );
    assert!(error.line.is_some(), "{error}");
    let second = |k: usize| piece(&array(&format!("v{k}"), "3", TWELVE)).replace("0 0 0 1", &format!("{k} 0 0 {k}.5"));
    let pieces: String = (0..2_000).map(second).collect();
    let error = body::<3>("a.vtu", vtu(&pieces).as_bytes()).map(|_| ()).unwrap_err();
    assert_eq!(error.code, "limit.values", "{error}");
}
