//! The rounding of coordinates in files is reported or refused with a number, in every format with numbers of 4 bytes.

use crate::common;
use common::cube::{CORNERS, base64, gltf, stl_bytes, triangles};
use common::shapes::{space, surface};
use opruga_io::SceneError;

/// The message about a cube of side 2 at this distance from the origin: the code of an error or of a warning, and its value.
type Told = Option<(bool, String)>;

fn told<T>(read: Result<(T, Vec<opruga_io::Notice>), Vec<SceneError>>) -> Told {
    let (errors, refused) = match read {
        Ok((_, notices)) => (notices.into_iter().map(|notice| notice.about).collect(), false),
        Err(errors) => (errors, true),
    };
    let error = errors.into_iter().find(|error| error.code == "mesh.rounded")?;
    println!("{error}");
    assert!(!error.file.is_empty() && error.allowed.is_some() && error.hint.is_some());
    Some((refused, error.value.expect("a figure")))
}

fn corners(far: f32) -> Vec<[f32; 3]> {
    CORNERS.iter().map(|c| [c[0] as f32 + far, c[1] as f32, c[2] as f32]).collect()
}

fn text(far: f64, between: &str) -> String {
    CORNERS.iter().map(|[x, y, z]| format!("{} {y} {z}{between}", x + far)).collect()
}

fn stl(far: f32) -> Told {
    let mut bytes = stl_bytes();
    for (k, triangle) in triangles().iter().enumerate() {
        for (corner, number) in triangle.iter().enumerate() {
            let at = 84 + 50 * k + 12 + 12 * corner;
            bytes[at..at + 4].copy_from_slice(&corners(far)[*number][0].to_le_bytes());
        }
    }
    told(surface("a.stl", &bytes))
}

fn ply(far: f64, kind: &str) -> Told {
    let faces: String = triangles().iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n")).collect();
    let head = format!(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty {kind} x\nproperty {kind} y\nproperty {kind} z\nelement face 12\nproperty list uchar int \
         vertex_indices\nend_header\n"
    );
    told(surface("a.ply", (head + &text(far, "\n") + &faces).as_bytes()))
}

fn of_gltf(far: f32) -> Told {
    let mut buffer: Vec<u8> = corners(far).iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    buffer.extend(triangles().iter().flatten().flat_map(|c| (*c as u16).to_le_bytes()));
    told(surface("a.gltf", gltf(&format!("\"uri\":\"data:;base64,{}\",", base64(&buffer))).as_bytes()))
}

const CUBE: &str = "0 1 2 3 4 5 6 7";

fn vtk(far: f64, kind: &str) -> Told {
    let points = text(far, "\n");
    let file = format!(
        "# vtk DataFile Version 3.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 {kind}\n{points}CELLS 1 9\n8 {CUBE}\nCELL_TYPES 1\n12\n"
    );
    told(space("kind = \"mesh\", file = \"a.vtk\"", &[("a.vtk", file.as_bytes())]))
}

fn vtu(far: f64, kind: &str) -> Told {
    let file = format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"8\" NumberOfCells=\"1\"><Points><DataArray type=\"{kind}\">{}\
         </DataArray></Points><Cells><DataArray type=\"Int8\" Name=\"connectivity\">{CUBE}</DataArray><DataArray type=\"Int8\" Name=\"offsets\">8\
         </DataArray><DataArray type=\"Int8\" Name=\"types\">12</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>\n",
        text(far, " ")
    );
    told(space("kind = \"mesh\", file = \"a.vtu\"", &[("a.vtu", file.as_bytes())]))
}

#[test]
fn single_precision_far_from_the_origin_is_told_and_refused_in_every_format() {
    type Moved = fn(f64) -> Told;
    let single: [(&str, Moved); 5] = [
        ("stl", |far| stl(far as f32)),
        ("ply", |far| ply(far, "float")),
        ("gltf", |far| of_gltf(far as f32)),
        ("vtk", |far| vtk(far, "float")),
        ("vtu", |far| vtu(far, "Float32")),
    ];
    for (format, told) in single {
        assert_eq!(told(1e3), None, "{format}");
        // Numbers are 1/128 apart at 1e5, and 1 apart at 1e7; the diagonals of squares make the mean edge a little longer than 2.
        let (refused, part) = told(1e5).unwrap_or_else(|| panic!("{format} says nothing"));
        let part: f64 = part.parse().expect("a number");
        assert!(!refused && (0.0014..=0.002).contains(&part), "{format}: {part}");
        assert!(told(1e7).is_some_and(|(refused, _)| refused), "{format}");
    }
}

#[test]
fn double_precision_keeps_what_single_precision_loses() {
    for (format, told) in [
        ("ply", ply as fn(f64, &str) -> Told),
        ("vtk", vtk),
        ("vtu", |far, kind| vtu(far, if kind == "double" { "Float64" } else { kind })),
    ] {
        assert_eq!(told(1e7, "double"), None, "{format}");
        assert!(told(1e16, "double").is_some_and(|(refused, _)| refused), "{format}");
    }
}

#[test]
fn a_cube_that_the_file_has_made_smaller_is_refused() {
    // It was 1.3 m wide.
    let errors = surface("a.stl", include_bytes!("../data/faults/stl-f32-offset-1e7.stl")).expect_err("another cube");
    assert_eq!(errors[0].code, "mesh.rounded");
    assert!(errors[0].message.contains("0.5 m") && errors[0].message.contains("4 bytes"), "{}", errors[0]);
    // At the origin, as a text without normals, it is read as it is.
    let (cube, notices) = surface("a.stl", include_bytes!("../data/faults/cube.stl")).expect("a cube");
    assert!(notices.is_empty() && (cube.enclosed_volume() - 1.0).abs() < 1e-12);
}
