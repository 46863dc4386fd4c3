//! Surfaces from files: the same body from every format, and what is wrong with bad files (torture list, section 2). What
//! becomes of sound ones: surface_bodies.rs.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

mod common;
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

/// What a file holds besides its triangles and a body cannot have: how the cube changes, what is told, how often.
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

#[test]
fn polygons_become_fans_and_concave_ones_are_cut_where_a_fan_fits() {
    // A prism over a dart: concave, but a fan from its inner corner fills it.
    let dart = [[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.7, 1.0]];
    let mut text = String::new();
    for z in [0, 1] {
        dart.iter().for_each(|[x, y]| text += &format!("v {x} {y} {z}\n"));
    }
    text += "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let (mesh, _) = surface("a.obj", text.as_bytes()).expect("a prism");
    assert!((mesh.enclosed_volume() - (2.0 - 0.7)).abs() < 1e-12, "{}", mesh.enclosed_volume());
    // Indices that count from the end mean the same.
    let relative = text.replace("f 4 3 2 1", "f -5 -6 -7 -8").replace("f 5 6 7 8", "f -4 -3 -2 -1");
    assert_eq!(surface("a.obj", relative.as_bytes()).expect("a prism").0, mesh);
}

/// Rows 22, 24, 25, 26, 30, 31, 33, 37, 38 in OBJ: what is changed in the cube, the code, the line, the value.
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
        // A quad may be cut along either diagonal: a repeated triangle is found as one or the other.
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

/// Row 23: headers that promise more than the file holds, before anything is allocated.
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
    // A text may lack its last line end, and the name behind `endsolid`.
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
    assert!(error.code == "scene.not_finite" && error.message.contains("byte 150"), "{error}");
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
        ("\"children\":[1]", "\"children\":[0]", "gltf.depth"),
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

/// What only the whole surface shows is told with the byte or line of a triangle, in formats without lines too.
#[test]
fn late_errors_have_a_place_in_every_format() {
    // The last face once more.
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
            _ => assert!(error.message.ends_with(&format!("at byte {}", bad.len() - face)), "{format}: {error}"),
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
