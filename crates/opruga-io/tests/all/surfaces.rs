//! Surfaces from files: the same body from every format, and the errors of bad files (torture list, section 2). Bodies made from good files:
//! surface_bodies.rs.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::cube::*;
use common::shapes::{space, surface};

#[test]
fn every_format_gives_the_same_cube() {
    let data = gltf(&format!("\"uri\":\"data:application/octet-stream;base64,{}\",", base64(&buffer())));
    let files: [(&str, Vec<u8>); 8] = [
        ("a.obj", obj().into_bytes()),
        ("text.stl", stl_text().into_bytes()),
        ("bytes.STL", stl_bytes()),
        ("ascii.ply", ply("ascii")),
        ("little.ply", ply("binary_little_endian")),
        ("big.ply", ply("binary_big_endian")),
        ("data.gltf", data.into_bytes()),
        ("a.glb", glb()),
    ];
    for (name, bytes) in files {
        let (mesh, notices) = surface(name, &bytes).unwrap_or_else(|e| panic!("{}", e[0]));
        is_cube(&mesh);
        assert!(notices.is_empty(), "{name}: {}", notices[0]);
    }
    let outside = gltf("\"uri\":\"cube.bin\",");
    let files: [(&str, &[u8]); 2] = [("m/a.gltf", outside.as_bytes()), ("m/cube.bin", &buffer())];
    is_cube(&space("kind = \"surface\", file = \"m/a.gltf\"", &files).expect("with its buffer").0);
}

/// Contents of a file besides triangles that a body cannot have: the change of the cube, the notice, its count.
#[test]
fn what_surfaces_cannot_have_is_left_out_and_counted() {
    let cube = gltf(&format!("\"uri\":\"data:;base64,{}\",", base64(&buffer())));
    let turned = cube.replace("\"nodes\":[0]}", "\"nodes\":[0]},{\"nodes\":[]},{}");
    let skinned = cube.replace("\"mesh\":0,", "\"mesh\":0,\"skin\":0,\"weights\":[0.5],");
    let morphed = cube.replace("\"indices\":1}", "\"indices\":1,\"targets\":[{\"POSITION\":0},{\"POSITION\":0}]}");
    let animated = cube.replace("\"scene\":0", "\"scene\":0,\"animations\":[{\"channels\":[]},{\"channels\":[]},{}]");
    let elements = |format: &str, bytes: &[u8]| {
        let (plain, header) =
            (ply(format), "element edge 2\nproperty short a\nelement none 0\nproperty int b\nend_header\n");
        let end = plain.windows(11).position(|w| w == b"end_header\n").expect("a header");
        [&plain[..end], header.as_bytes(), &plain[end + 11..], bytes].concat()
    };
    for (name, bytes, code, count) in [
        ("scenes.gltf", turned.into_bytes(), "gltf.scenes", "2"),
        ("skin.gltf", skinned.into_bytes(), "gltf.skin", "1"),
        ("morph.gltf", morphed.into_bytes(), "gltf.morph", "1"),
        ("animation.gltf", animated.into_bytes(), "gltf.animation", "3"),
        ("text.ply", elements("ascii", b"7\n8\n"), "ply.element", "2"),
        ("little.ply", elements("binary_little_endian", &[7, 0, 8, 0]), "ply.element", "2"),
    ] {
        let (mesh, notices) = surface(name, &bytes).unwrap_or_else(|e| panic!("{name}: {}", e[0]));
        is_cube(&mesh);
        let told: Vec<_> = notices.iter().map(|n| (n.about.code, n.about.value.as_deref())).collect();
        assert_eq!(told, [(code, Some(count))], "{name}");
    }
}

#[test]
fn named_parts_are_groups() {
    let (mesh, _) = surface("a.obj", obj().as_bytes()).expect("a cube");
    assert_eq!(mesh.groups["cube"], (0..8).collect::<Vec<u32>>());
    assert!(surface("a.glb", &glb()).expect("a cube").0.groups.contains_key("cube"));
}

/// A prism over a counter-clockwise outline, one unit high. Its lids are faces with all corners of the outline; the lower one begins at corner
/// `from`.
fn prism(outline: &[[f64; 2]], from: usize) -> String {
    let (n, mut text) = (outline.len(), String::new());
    for z in [0, 1] {
        outline.iter().for_each(|[x, y]| text += &format!("v {x} {y} {z}\n"));
    }
    let lid = |k: usize| (from + k) % n;
    text += &format!("f{}\n", (0..n).rev().map(|k| format!(" {}", 1 + lid(k))).collect::<String>());
    text += &format!("f{}\n", (0..n).map(|k| format!(" {}", 1 + n + k)).collect::<String>());
    (0..n).for_each(|k| text += &format!("f {} {} {} {}\n", k + 1, (k + 1) % n + 1, n + (k + 1) % n + 1, n + k + 1));
    text
}

/// Row 25: concave faces, beginning at every corner. No triangle is outside the face or reversed, and their areas sum to that of the face.
#[test]
fn polygons_are_cut_inside_and_concave_and_bent_ones_counted() {
    let dart = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.7, 1.0]];
    let corner = vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let star: Vec<[f64; 2]> = (0..10)
        .map(|k| {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / 10.0).sin_cos();
            [1.0, 0.4].map(|r| [r * c, r * s])[k as usize % 2]
        })
        .collect();
    let of_star = 2.0 * (std::f64::consts::PI / 5.0).sin();
    for (outline, area) in [(&dart, 1.3), (&corner, 4.0), (&star, of_star)] {
        for from in 0..outline.len() {
            let text = prism(outline, from);
            let (mesh, notices) = surface("a.obj", text.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
            assert!((mesh.enclosed_volume() - area).abs() < 1e-12, "{}, not {area}", mesh.enclosed_volume());
            let whole: f64 = (0..2)
                .map(|lid| {
                    let flat = mesh
                        .facets
                        .iter()
                        .filter(|f| f.iter().all(|n| mesh.positions[*n as usize][2] == (2 * lid - 1) as f64 * 0.5));
                    flat.map(|f| {
                        let [a, b, c] = f.map(|n| mesh.positions[n as usize]);
                        let doubled = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                        assert!(doubled * (2 * lid - 1) as f64 > 0.0, "a triangle is turned");
                        0.5 * doubled.abs()
                    })
                    .sum::<f64>()
                })
                .sum();
            assert!((whole - 2.0 * area).abs() < 1e-12, "{whole}, not twice {area}");
            // Both lids, and nothing else: no triangle had to be flipped afterwards.
            let told: Vec<_> = notices.iter().map(|n| (n.about.code, n.about.value.as_deref())).collect();
            assert_eq!(told, [("mesh.concave_face", Some("2"))]);
            let faces = outline.len() + 2;
            assert!(
                notices[0].about.message.starts_with(&format!("2 of {faces} faces with more than three")),
                "{}",
                notices[0]
            );
        }
    }
    // Indices that count from the end have the same meaning.
    let text = prism(&dart, 0);
    let relative = text.replace("f 4 3 2 1", "f -5 -6 -7 -8").replace("f 5 6 7 8", "f -4 -3 -2 -1");
    assert_ne!(text, relative);
    let mesh = |text: &str| surface("a.obj", text.as_bytes()).expect("a prism").0;
    assert_eq!(mesh(&relative), mesh(&text));
    // The same faces in PLY.
    let lists = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let places =
        text.lines().filter_map(|line| line.strip_prefix("v ")).map(|place| format!("{place}\n")).collect::<String>();
    let faces = lists.map(|list| format!("4 {}\n", list.map(|k| k.to_string()).join(" "))).concat();
    let header = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    let (from_ply, notices) = surface("a.ply", format!("{header}{places}{faces}").as_bytes()).expect("a prism");
    assert_eq!((from_ply.facets.len(), notices[0].about.code), (12, "mesh.concave_face"));
    assert!((from_ply.enclosed_volume() - 1.3).abs() < 1e-12);
    // A cube with two opposite corners of its upper side lifted: that side is bent, by half of the lift over its size.
    let lifted = |by: f64| {
        let up = 1.0 + by;
        obj().replace("v 1 1\t1\r", &format!("v 1 1 {up}")).replace("v -1 -1\t1\r", &format!("v -1 -1 {up}"))
    };
    assert_eq!(lifted(0.4).matches("1.4").count(), 2);
    let (_, notices) = surface("a.obj", lifted(0.4).as_bytes()).expect("a bent cube");
    let told: Vec<_> = notices.iter().map(|n| (n.about.code, n.about.value.as_deref())).collect();
    assert_eq!(told, [("mesh.bent_face", Some("1"))], "{}", notices[0]);
    assert!(
        notices[0].about.message.contains("is not flat (with a deviation of up to 0.1 of their size)"),
        "{}",
        notices[0]
    );
    assert!(surface("a.obj", lifted(0.01).as_bytes()).expect("a cube").1.is_empty());
    let error = refused("a.obj", lifted(3.0).as_bytes());
    assert!(error.code == "mesh.degenerate_face" && error.line.is_some(), "{error}");
    assert!(
        error.message.starts_with(
            "a face is far from flat: the distance of a corner from its plane is 0.5 of the size of the face"
        ),
        "{error}"
    );
}

/// Rows 22, 24, 25, 26, 30, 31, 33, 37, 38 in OBJ: the change of the cube, the code, the line, the value.
#[test]
fn bad_obj_files_are_refused_with_their_line() {
    let first = "f 1/1 4//1 3/1/1 2";
    for (from, to, code, line) in [
        (first, "f 0 1 2", "mesh.index", Some(11)),
        (first, "f 1 2 9", "mesh.index", Some(11)),
        (first, "f 1 2 -9", "mesh.index", Some(11)),
        (first, "f 1 2 2147483648", "mesh.index", Some(11)),
        (first, "f 1 2 18446744073709551616", "obj.syntax", Some(11)),
        (first, "f 1 2", "mesh.degenerate_face", Some(11)),
        (first, "f", "mesh.degenerate_face", Some(11)),
        (first, "f 1 2 2", "mesh.degenerate_face", Some(11)),
        (first, "f 1 3 2 4", "mesh.degenerate_face", Some(11)),
        (first, "f a b c", "obj.syntax", Some(11)),
        (first, "face 1 2 3", "obj.syntax", Some(11)),
        ("v -1 -1\t-1", "v -1,0 -1 -1", "shape.number", Some(3)),
        ("v -1 -1\t-1", "v -1 -1", "obj.syntax", Some(3)),
        ("v -1 -1\t-1", "v -1 -1 -1 0.5 0.5", "obj.syntax", Some(3)),
        ("v -1 -1\t-1", "v nan 0 0", "scene.not_finite", Some(3)),
        ("v -1 -1\t-1", "v 1e999 0 0", "scene.not_finite", Some(3)),
        ("v -1 -1\t-1", "v one 0 0", "shape.number", Some(3)),
        ("v -1 -1\t-1", "v 1 -1 -1", "mesh.degenerate_face", Some(11)),
        (first, "f 1 4 3 2\nf 2 4 3", "mesh.duplicate_element", Some(12)),
        (first, "f 1 4 3 2\nf 1 2 7", "mesh.non_manifold", None),
    ] {
        let text = obj().replace(from, to);
        assert_ne!(text, obj());
        let error = refused("a.obj", text.as_bytes());
        // A quadrilateral may be divided along either diagonal: a repeated triangle is found as one error or the other.
        let twice = code == "mesh.duplicate_element" && error.code == "mesh.non_manifold";
        assert!(error.code == code || twice, "{to}: {error}");
        if !twice && line.is_some() {
            assert_eq!(error.line, line, "{to}: {error}");
        }
        assert!(error.file == "a.obj" && error.value.is_some(), "{to}: {error}");
    }
    assert_eq!(refused("a.obj", b"").code, "mesh.empty");
    assert_eq!(refused("a.obj", b"v 0 0 0\n").code, "mesh.empty");
    assert_eq!(refused("a.obj", b"v 0 0 0\n\xff\n").code, "shape.encoding");
    assert_eq!(refused("a.off", b"OFF").code, "shape.format");
    let flat = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 4 2 1\nf 4 3 2\n";
    assert_eq!(refused("a.obj", flat.as_bytes()).code, "mesh.dimension");
    let huge = obj().replace("1", "1e300");
    assert!(surface("a.obj", huge.as_bytes()).is_err());
    let mut band = String::new();
    for k in 0..8 {
        let angle = std::f64::consts::TAU * f64::from(k) / 8.0;
        for side in [-0.3, 0.3] {
            let r = 1.0 + side * (0.5 * angle).cos();
            band += &format!("v {} {} {}\n", r * angle.cos(), r * angle.sin(), side * (0.5 * angle).sin());
        }
    }
    for k in 0..8 {
        let (a, b) = (2 * k + 1, 2 * k + 2);
        let (c, d) = if k == 7 { (2, 1) } else { (a + 2, b + 2) };
        band += &format!("f {a} {b} {c}\nf {b} {d} {c}\n");
    }
    assert_eq!(refused("a.obj", band.as_bytes()).code, "mesh.non_orientable");
}

/// Row 23: headers that announce more than the file contains are refused before anything is allocated.
#[test]
fn sizes_are_compared_before_memory_is_asked_for() {
    let mut stl = stl_bytes();
    stl[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    stl[0] = b'x';
    let error = refused("a.stl", &stl);
    assert_eq!((error.code, error.value.as_deref()), ("stl.size", Some("684")));
    assert!(error.message.contains("4294967295") && error.message.contains("byte 80"), "{error}");
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let text = ply(format);
        let at = text.windows(6).position(|w| w == b"face 6").expect("a count");
        let mut huge = text[..at].to_vec();
        huge.extend(b"face 4294967295");
        huge.extend(&text[at + 6..]);
        let error = refused("a.ply", &huge);
        assert_eq!((error.code, error.value.as_deref()), ("ply.size", Some("4294967295")), "{error}");
    }
    let huge = gltf("\"uri\":\"data:;base64,AAAA\",").replace("\"count\":8,", "\"count\":18446744073709551615,");
    assert_eq!(refused("a.gltf", huge.as_bytes()).code, "gltf.size");
    let mut long = glb();
    long[8] = 0;
    assert_eq!(refused("a.glb", &long).code, "gltf.size");
}

#[test]
fn files_that_are_cut_off_anywhere_are_refused() {
    // A text may lack its last line end, and the name after `endsolid`.
    for (name, bytes, spare) in [
        ("a.stl", stl_bytes(), 0),
        ("a.stl", stl_text().into_bytes(), 6),
        ("a.ply", ply("ascii"), 1),
        ("a.ply", ply("binary_little_endian"), 0),
        ("a.ply", ply("binary_big_endian"), 0),
        ("a.glb", glb(), 0),
    ] {
        for end in 0..bytes.len() - spare {
            match surface(name, &bytes[..end]) {
                Ok(_) => panic!("{name} of {end} bytes"),
                Err(errors) => {
                    assert!(errors[0].file == name && errors[0].value.is_some(), "{end}: {}", errors[0]);
                }
            }
        }
    }
}

#[test]
fn bad_stl_and_ply_files_are_refused_with_their_place() {
    for (from, to, code, line) in [
        ("outer loop", "outer lop", "stl.syntax", 3),
        ("endloop", "vertex 0 0 0", "stl.syntax", 7),
        ("  vertex -1e0 -1 -1\n", "", "stl.syntax", 6),
        ("vertex -1e0 -1 -1", "vertex -1,0 -1 -1", "shape.number", 4),
        ("vertex -1e0 -1 -1", "vertex -1 -1", "stl.syntax", 4),
        ("vertex -1e0 -1 -1", "vertex inf -1 -1", "scene.not_finite", 4),
    ] {
        let text = stl_text().replacen(from, to, 1);
        let error = refused("a.stl", text.as_bytes());
        assert_eq!((error.code, error.line), (code, Some(line)), "{to}: {error}");
    }
    let mut nan = stl_bytes();
    nan[84 + 50 + 16..84 + 50 + 20].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = refused("a.stl", &nan);
    assert!(error.code == "scene.not_finite" && error.to_string().contains("byte 150"), "{error}");
    let text = String::from_utf8(ply("ascii")).expect("a text");
    for (from, to, code, line) in [
        ("ply\n", "plx\n", "ply.syntax", Some(1)),
        ("format ascii 1.0", "format ebcdic 1.0", "ply.syntax", Some(2)),
        ("element vertex 8", "element vertex many", "ply.syntax", Some(4)),
        ("property float x", "property quad x", "ply.syntax", Some(6)),
        ("property float x", "property float u", "ply.syntax", None),
        ("list uchar int", "list float int", "ply.syntax", Some(10)),
        ("4 0 3 2 1", "4 0 3 2 8", "mesh.index", Some(20)),
        ("4 0 3 2 1", "4 0 3 2 -1", "mesh.index", Some(20)),
        ("4 0 3 2 1", "2 0 3", "mesh.degenerate_face", Some(20)),
        ("4 0 3 2 1", "400 0 3 2 1", "ply.size", Some(20)),
        ("255 1 1 1", "255 1 1 x", "shape.number", Some(18)),
        ("255 1 1 1", "255 1 nan 1", "scene.not_finite", Some(18)),
        ("4 3 0 4 7\n", "4 3 0 4 7\n8\n", "ply.size", Some(25)),
        ("4 3 0 4 7\n", "4 3 0 4 7", "ply.syntax", Some(25)),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let error = refused("a.ply", changed.as_bytes());
        assert_eq!(error.code, code, "{to}: {error}");
        assert!(line.is_none() || error.line == line, "{to}: {error}");
        assert!(error.file == "a.ply" && error.value.is_some(), "{error}");
    }
}

#[test]
fn bad_gltf_files_are_refused_with_their_place() {
    let text = gltf(&format!("\"uri\":\"data:;base64,{}\",", base64(&buffer())));
    is_cube(&surface("a.gltf", text.as_bytes()).expect("a cube").0);
    for (from, to, code) in [
        ("\"2.0\"", "\"1.0\"", "gltf.version"),
        ("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]", "gltf.unsupported"),
        ("\"children\":[1]", "\"children\":[0]", "gltf.tree"),
        ("\"children\":[1]", "\"children\":[7]", "gltf.index"),
        ("\"mesh\":0", "\"mesh\":3", "gltf.index"),
        ("\"POSITION\":0", "\"NORMAL\":0", "gltf.syntax"),
        ("\"POSITION\":0", "\"POSITION\":1", "gltf.syntax"),
        ("\"indices\":1", "\"indices\":1,\"mode\":5", "gltf.unsupported"),
        ("5126", "5130", "gltf.syntax"),
        ("\"count\":36", "\"count\":35", "gltf.syntax"),
        ("\"count\":36", "\"count\":39", "gltf.size"),
        ("\"count\":8", "\"count\":7", "mesh.index"),
        ("\"byteOffset\":96", "\"byteOffset\":97", "gltf.size"),
        ("\"byteLength\":168", "\"byteLength\":169", "gltf.size"),
        ("base64,", "base64,!", "gltf.syntax"),
        ("data:;base64,", "../../secret", "read.failed"),
        ("\"type\":\"SCALAR\"", "\"type\":", "json.syntax"),
        ("\"scale\":[1,1,-1]", "\"scale\":[1,1]", "json.syntax"),
        ("\"scale\":[1,1,-1]", "\"scale\":[1,1,0]", "mesh.degenerate_face"),
    ] {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let error = refused("a.gltf", changed.as_bytes());
        assert_eq!(error.code, code, "{to}: {error}");
        assert!(error.value.is_some(), "{to}: {error}");
    }
}

/// Errors that only the whole surface shows are reported with the byte or line of a triangle, also in formats without lines.
#[test]
fn late_errors_have_a_place_in_every_format() {
    // The last face again.
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let text = String::from_utf8_lossy(&ply(format)).into_owned();
        let good = ply(format);
        let header = text.find("end_header\n").expect("a header") + "end_header\n".len();
        let face = if format == "ascii" { 10 } else { 17 };
        let at = good.len() - face;
        let mut bad = good.clone();
        bad.extend_from_slice(&good[at..]);
        let text = core::str::from_utf8(&bad[..header]).expect("ascii").replace("element face 6", "element face 7");
        let bad = [text.as_bytes(), &bad[header..]].concat();
        let error = &surface("a.ply", &bad).expect_err("a face twice")[0];
        assert_eq!(error.code, "mesh.duplicate_element", "{format}: {error}");
        match format {
            "ascii" => assert_eq!(error.line, Some(header_lines(&text) + 8 + 7), "{error}"),
            _ => assert!(error.sentence(None).ends_with(&format!("at byte {}", bad.len() - face)), "{format}: {error}"),
        }
    }
    let uri = format!("\"uri\":\"data:;base64,{}\",", base64(&buffer()));
    let twice = gltf(&uri).replace(
        r#""primitives":[{"attributes":{"POSITION":0},"indices":1}]"#,
        "\"primitives\":[\n{\"attributes\":{\"POSITION\":0},\"indices\":1},\n{\"attributes\":{\"POSITION\":0},\"indices\":1}]",
    );
    let error = &surface("a.gltf", twice.as_bytes()).expect_err("two cubes at one place")[0];
    assert_eq!(error.code, "mesh.self_intersection", "{error}");
    let line = twice.lines().nth(error.line.expect("a line") - 1).expect("a line");
    assert!(line.starts_with("{\"attributes\""), "{line}");
}

fn header_lines(header: &str) -> usize {
    header.lines().count()
}
