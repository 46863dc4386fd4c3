//! Unusual surfaces that are accepted, and the shipped surfaces of other projects.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::shapes::{space, surface};
use opruga_io::SceneError;

const SQUARES: [[usize; 4]; 6] = [[1, 4, 3, 2], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];

/// A cube with its lowest corner at a given position: vertices as OBJ.
fn vertices(low: f64, side: f64) -> String {
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        .map(|corner| corner.map(|x| (low + side * f64::from(x)).to_string()).join(" "))
        .map(|place| format!("v {place}\n"))
        .concat()
}

fn faces(first: usize) -> String {
    SQUARES.map(|corners| format!("f {}\n", corners.map(|c| (c + first).to_string()).join(" "))).concat()
}

fn told(file: &str, text: &str) -> Vec<(&'static str, Option<String>)> {
    let (_, notices) = surface(file, text.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
    notices.into_iter().map(|notice| (notice.about.code, notice.about.value)).collect()
}

fn refused(text: &str, more: &str) -> SceneError {
    let shape = format!("kind = \"surface\", file = \"a.obj\"{more}");
    space(&shape, &[("a.obj", text.as_bytes())]).expect_err("refused").remove(0)
}

/// Torture list, row 31: gas would leak from one cube into the other. A `\\` at the end of a line continues a statement, with either line end;
/// comments end with their line.
#[test]
fn statements_of_obj_go_on_in_the_next_line() {
    let text = format!("{}{}", vertices(0.0, 1.0), faces(0));
    let whole = surface("a.obj", text.as_bytes()).expect("a cube").0;
    for (from, to) in [
        ("f 1 4 3 2\n", "f 1 4 \\\n 3 2\n"),
        ("f 1 4 3 2\n", "f 1\\\r\n4\\\r\n3\\\r\n2\r\n"),
        ("f 1 4 3 2\n", "f \\\n\\\n1 4 3 2\n"),
        ("v 1 0 0\n", "v 1 \\\n0 0\n"),
        ("f 1 4 3 2\n", "# this is no statement \\\nf 1 4 3 2\n"),
        ("f 1 4 3 2\n", "f 1 4 \\\n3 2 # and this \\\n"),
        ("f 4 1 5 8\n", "f 4 1 5 8\\"),
    ] {
        let changed = text.replace(from, to);
        assert_ne!(changed, text, "{from}");
        assert_eq!(surface("a.obj", changed.as_bytes()).unwrap_or_else(|e| panic!("{to}: {}", e[0])).0, whole, "{to}");
    }
    // Errors are located at their word.
    let error = refused(&text.replace("f 1 4 3 2\n", "f 1 4 \\\n x 2\n"), "");
    assert_eq!((error.code, error.line, error.value.as_deref()), ("obj.syntax", Some(10), Some("x")));
    let error = refused(&text.replace("f 1 4 3 2\n", "f 1 4 \\ 3 2\n"), "");
    assert_eq!((error.code, error.value.as_deref()), ("obj.syntax", Some("\\")));
}

/// Keywords of STL in capitals, and bytes beyond the length that a GLB declares.
#[test]
fn words_of_stl_are_read_in_any_case_and_a_glb_is_as_long_as_it_says() {
    let text = common::cube::stl_text();
    let lower = surface("a.stl", text.as_bytes()).expect("a cube").0;
    for changed in
        [text.to_uppercase().replace("E0", "e0"), text.replace("solid", "Solid"), format!(" \n{}", text.to_uppercase())]
    {
        assert_ne!(changed, text);
        assert_eq!(surface("a.stl", changed.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0])).0, lower);
    }
    let mut long = common::cube::glb();
    let length = long.len();
    long.extend([0; 4]);
    let error = surface("a.glb", &long).expect_err("too long").remove(0);
    assert_eq!((error.code, error.value), ("gltf.size", Some(length.to_string())));
    assert!(
        error.hint.as_deref().is_some_and(|hint| hint.contains("remove the 4 bytes at the end")),
        "{:?}",
        error.hint
    );
}

#[test]
fn cubes_that_share_a_vertex_are_refused_with_its_place() {
    let own = format!("{}{}{}{}", vertices(0.0, 1.0), vertices(1.0, 1.0), faces(0), faces(8));
    let error = refused(&own, ", weld = 0");
    assert_eq!((error.code, error.value.as_deref()), ("mesh.non_manifold", Some("1")), "{error}");
    assert!(error.message.contains("(1, 1, 1)") && error.line.is_some() && error.hint.is_some(), "{error}");
    let apart = format!("{}{}{}{}", vertices(0.0, 1.0), vertices(1.5, 1.0), faces(0), faces(8));
    assert_eq!(told("a.obj", &apart), []);
}

/// Row 22: corners may name something that comes later, but not something that never comes.
#[test]
fn faces_name_texture_places_and_normals_that_are_there() {
    let face =
        |corner: &str| format!("{}f 1{corner} 4{corner} 3{corner} 2{corner}\n{}", vertices(0.0, 1.0), &faces(0)[10..]);
    for corner in ["/9", "/9/", "//9", "/1/9", "/-2"] {
        let text = format!("{}vt 0 0\nvn 0 0 1\n", face(corner));
        let error = refused(&text, "");
        assert_eq!((error.code, error.line), ("mesh.index", Some(9)), "{corner}: {error}");
        assert_eq!(error.value, Some(format!("1{corner}")), "{error}");
    }
    for corner in ["/0", "/x", "/1/1/1", "//y"] {
        assert_eq!(refused(&face(corner), "").code, "obj.syntax", "{corner}");
    }
    assert_eq!(told("a.obj", &format!("{}vt 0 0\nvn 0 0 1\n", face("/1/1"))), []);
    assert_eq!(told("a.obj", &format!("vt 0 0\n{}", face("/-1"))), []);
}

#[test]
fn weights_of_vertices_and_large_units_are_told() {
    let weighed = format!("{}{}", vertices(0.0, 1.0).replace("v 1 1 1\n", "v 1 1 1 2.0\n"), faces(0));
    assert_eq!(told("a.obj", &weighed), [("obj.weight", Some("1".into()))]);
    let plain = format!("{}{}", vertices(0.0, 1.0).replace("v 1 1 1\n", "v 1 1 1 1.0\n"), faces(0));
    assert_eq!(told("a.obj", &plain), []);
    let coloured = format!("{}{}", vertices(0.0, 1.0).replace("v 1 1 1\n", "v 1 1 1 0.5 0.5 0.5\n"), faces(0));
    assert_eq!(told("a.obj", &coloured), []);
    for (side, unit) in [(1000.0, Some("millimetres")), (1e-6, Some("kilometres")), (50.0, None)] {
        let text = format!("{}{}", vertices(0.0, side), faces(0));
        let (_, notices) = surface("a.obj", text.as_bytes()).expect("a cube");
        let hint = notices.first().and_then(|notice| notice.about.hint.clone());
        assert_eq!(hint.is_some(), unit.is_some(), "{side}");
        assert!(unit.is_none_or(|unit| hint.is_some_and(|hint| hint.contains(unit))), "{side}");
    }
    // No unit explains a size like this.
    let (_, notices) = surface("a.obj", format!("{}{}", vertices(0.0, 1e30), faces(0)).as_bytes()).expect("a cube");
    let hint = notices[0].about.hint.as_deref().unwrap_or("");
    assert!(notices[0].about.code == "mesh.scale" && hint.contains("`size`") && !hint.contains("metres"), "{hint}");
}

#[test]
fn normals_of_stl_that_say_otherwise_are_counted() {
    let text = |normal: &str| {
        let facet = |[a, b, c]: [&str; 3]| {
            format!("facet normal {normal}\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet\n")
        };
        let (o, x, y, z) = ("0 0 0", "1 0 0", "0 1 0", "0 0 1");
        let all = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
        format!("solid a\n{all}endsolid a\n")
    };
    assert_eq!(told("a.stl", &text("0 0 0")), []);
    assert_eq!(told("a.stl", &text("nan nan nan")), [("stl.normal", Some("4".into()))]);
    // Three sides face in the negative directions of the axes, the fourth along (1, 1, 1).
    assert_eq!(told("a.stl", &text("1 1 1")), [("stl.normal", Some("3".into()))]);
    assert_eq!(told("a.stl", &text("-1 -1 -1")), [("stl.normal", Some("1".into()))]);
    let mut bytes = vec![0u8; 80];
    bytes.extend(4u32.to_le_bytes());
    let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for triangle in [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] {
        let normal = [f32::NAN, 0.0, 0.0];
        bytes.extend(normal.iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend(triangle.iter().flat_map(|c: &usize| corners[*c]).flat_map(|x: f32| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let (_, notices) = surface("a.stl", &bytes).expect("a tetrahedron");
    let told: Vec<_> = notices.into_iter().map(|notice| (notice.about.code, notice.about.value)).collect();
    assert_eq!(told, [("stl.normal", Some("4".to_string()))]);
}

#[test]
fn surfaces_that_are_shipped_have_their_volumes() {
    let cube = include_bytes!("../../../../scenes/shapes/cube.obj");
    let cube_5 = include_bytes!("../../../../scenes/shapes/cube_5.obj");
    let sphere = include_bytes!("../../../../scenes/shapes/sphere.obj");
    let torus = include_bytes!("../../../../scenes/shapes/torus.obj");
    // Balls and tubes with straight edges enclose a little less than 4/3 π and 2 π² R r² = π² / 2.
    let (ball, tube) = (4.188_790_204_786_391, 4.934_802_200_544_679);
    for (name, bytes, nodes, volume, near, euler) in [
        ("cube", &cube[..], 8, 1.0, 1e-12, 2),
        ("cube_5", &cube_5[..], 152, 1.0, 1e-12, 2),
        ("sphere", &sphere[..], 382, ball, 0.03, 2),
        ("torus", &torus[..], 400, tube, 0.04, 0),
    ] {
        let (mesh, notices) = surface("a.obj", bytes).unwrap_or_else(|e| panic!("{name}: {}", e[0]));
        assert!(notices.is_empty(), "{name}: {}", notices[0]);
        assert_eq!((mesh.nodes(), mesh.euler_characteristic()), (nodes, euler), "{name}");
        let off = mesh.enclosed_volume() / volume - 1.0;
        assert!(off.abs() < near && off < 1e-12, "{name}: {}", mesh.enclosed_volume());
        assert_eq!(mesh.components().expect("closed").len(), 1, "{name}");
    }
}

/// The lengths in the README, and coarser ones: the shape is preserved, or an error says that it would not be.
#[test]
fn spot_is_remeshed_where_the_length_keeps_its_shape() {
    let spot = include_bytes!("../../../../scenes/shapes/spot.obj");
    let of = |length: f64| {
        space(&format!("kind = \"surface\", file = \"a.obj\", size = 1.5, remesh = {length}"), &[("a.obj", spot)])
    };
    for length in [0.045, 0.05, 0.1] {
        let (mesh, _) = of(length).unwrap_or_else(|e| panic!("{length}: {}", e[0]));
        assert_eq!((mesh.euler_characteristic(), mesh.crossing_facets().pairs.len()), (2, 0), "{length}");
    }
    let error = &of(0.3).expect_err("its legs vanish")[0];
    assert!(error.code == "scene.shape" && error.message.contains("of its original volume"), "{error}");
    assert!(error.hint.as_deref().is_some_and(|hint| hint.contains("remesh")), "{error}");
}

/// Tetrahedra cut off sharp edges. The loss is reported with numbers and with a spacing that avoids it, and is refused if it is large; this holds for
/// surfaces from files and for generated ones.
#[test]
fn what_tetrahedra_lose_of_the_volume_is_told_and_refused_where_it_is_much() {
    let (file, cube) = ("kind = \"surface\", file = \"a.obj\"", format!("{}{}", vertices(0.0, 1.0), faces(0)));
    for (shape, whole) in [(file, 1.0), ("kind = \"box\", size = [1.2, 1, 0.8], cells = [1, 1, 1]", 0.96)] {
        let of = |spacing: f64| {
            let shape = format!("{shape}, filling = \"tetrahedra\", spacing = {spacing}");
            space(&shape, &[("a.obj", cube.as_bytes())])
        };
        let (mut told, mut refused) = (0, 0);
        for spacing in [0.08, 0.13, 0.2, 0.28, 0.35, 0.45, 0.55, 0.65, 0.8] {
            let (mesh, notices) = match of(spacing) {
                Ok(made) => made,
                Err(errors) => {
                    let message = &errors[0].message;
                    assert!(errors[0].code == "scene.shape", "{spacing}: {}", errors[0]);
                    refused += usize::from(message.contains("of the volume"));
                    continue;
                }
            };
            let kept = mesh.measure().expect("a volume").value() / whole;
            assert!((kept - 1.0).abs() <= 0.25, "{spacing}: {kept}");
            assert_eq!(notices.len(), usize::from((kept - 1.0).abs() > 0.05), "{spacing}: {kept}");
            let Some(notice) = notices.first() else { continue };
            told += 1;
            let value: f64 = notice.about.value.as_deref().and_then(|v| v.parse().ok()).expect("a number");
            assert!(notice.about.code == "shape.lost_volume" && (value - kept).abs() < 1e-3, "{notice}");
            assert!(
                notice.about.message.contains(" m³ (") && notice.about.message.ends_with(" m³ are lost"),
                "{notice}"
            );
            let hint = notice.about.hint.as_deref().and_then(|hint| hint.split(['=', '`']).nth(2)).expect("a spacing");
            assert!(of(hint.trim().parse().expect("a number")).expect("a filling").1.is_empty(), "{hint}");
        }
        assert!(told > 0 && refused > 0, "{shape}: {told} told, {refused} refused");
    }
}
