//! Surfaces: the same body from every format, and what is wrong with bad files (torture list, section 2).
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

mod common;
use common::shapes::{space, surface};
use opruga_io::SceneError;
use opruga_mesh::Mesh;

/// A cube of side 2 about the origin: corners, and six squares counter-clockwise seen from outside.
const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
const SQUARES: [[usize; 4]; 6] = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

fn triangles() -> Vec<[usize; 3]> {
    SQUARES.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect()
}

fn obj() -> String {
    let mut text = String::from("# a cube\r\no cube\r\n");
    CORNERS.iter().for_each(|[x, y, z]| text += &format!("v {x} {y}\t{z}\r\n"));
    SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("f {}/1 {}//1 {}/1/1 {}\r\n", a + 1, b + 1, c + 1, d + 1));
    text
}

fn stl_text() -> String {
    let mut text = String::from("solid cube\n");
    for corners in triangles() {
        text += "facet normal 0 0 0\n outer loop\n";
        corners
            .iter()
            .for_each(|c| text += &format!("  vertex {:e} {} {}\n", CORNERS[*c][0], CORNERS[*c][1], CORNERS[*c][2]));
        text += " endloop\nendfacet\n";
    }
    text + "endsolid cube\n"
}

fn stl_bytes() -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, 0);
    bytes.extend(12u32.to_le_bytes());
    for corners in triangles() {
        bytes.extend([0; 12]);
        corners.iter().flat_map(|c| CORNERS[*c]).for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment a cube\nelement vertex 8\nproperty uchar red\nproperty float x\nproperty double y\nproperty float z\nelement face 6\nproperty list uchar int vertex_indices\nelement edge 1\nproperty short a\nend_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        let mut text = String::new();
        CORNERS.iter().for_each(|[x, y, z]| text += &format!("255 {x} {y} {z}\n"));
        SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("4 {a} {b} {c} {d}\n"));
        bytes.extend((text + "7\n").bytes());
        return bytes;
    }
    let big = format == "binary_big_endian";
    let mut put = |little: &[u8]| {
        let mut word = little.to_vec();
        if big {
            word.reverse();
        }
        bytes.extend(word);
    };
    for [x, y, z] in CORNERS {
        put(&[255]);
        put(&(x as f32).to_le_bytes());
        put(&y.to_le_bytes());
        put(&(z as f32).to_le_bytes());
    }
    for square in SQUARES {
        put(&[4]);
        square.iter().for_each(|c| put(&(*c as i32).to_le_bytes()));
    }
    put(&7i16.to_le_bytes());
    bytes
}

/// The buffer of the cube: positions, then indices as 16-bit numbers.
fn buffer() -> Vec<u8> {
    let mut bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    bytes.extend(triangles().iter().flatten().flat_map(|c| (*c as u16).to_le_bytes()));
    bytes
}

fn gltf(uri: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
"nodes":[{{"name":"top","translation":[5,0,0],"children":[1]}},{{"mesh":0,"scale":[1,1,-1],"rotation":[0,0,0.7071067811865476,0.7071067811865476]}}],
"meshes":[{{"name":"cube","primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"}},
 {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}],
"bufferViews":[{{"buffer":0,"byteLength":96}},{{"buffer":0,"byteOffset":96,"byteLength":72}}],
"buffers":[{{{uri}"byteLength":168}}]}}"#
    )
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::new();
    for three in bytes.chunks(3) {
        let word = three.iter().fold(0u32, |w, b| w << 8 | u32::from(*b)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * k) & 63) as usize] as char;
            out.push(if k <= three.len() { letter } else { '=' });
        }
    }
    out
}

fn glb() -> Vec<u8> {
    let mut json = gltf("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = buffer();
    let mut bytes = b"glTF".to_vec();
    bytes.extend(2u32.to_le_bytes());
    bytes.extend((12 + 8 + json.len() as u32 + 8 + buffer.len() as u32).to_le_bytes());
    bytes.extend((json.len() as u32).to_le_bytes());
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

fn is_cube(mesh: &Mesh<3>) {
    assert_eq!((mesh.nodes(), mesh.facets.len(), mesh.euler_characteristic()), (8, 12, 2));
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-6, "{}", mesh.enclosed_volume());
    assert_eq!(mesh.components().expect("closed").len(), 1);
    assert_eq!(mesh.check(), []);
}

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

#[test]
fn named_parts_are_groups() {
    let (mesh, _) = surface("a.obj", obj().as_bytes()).expect("a cube");
    assert_eq!(mesh.groups["cube"], (0..8).collect::<Vec<u32>>());
    assert!(surface("a.glb", &glb()).expect("a cube").0.groups.contains_key("cube"));
}

#[test]
fn size_place_and_upright_axis() {
    let of = |more: &str| {
        let text = obj().replace("v -1 1\t1", "v -1 1\t3").replace("v -1 -1\t1", "v -1 -1\t3");
        let text = text.replace("v 1 1\t1", "v 1 1\t3").replace("v 1 -1\t1", "v 1 -1\t3");
        space(&format!("kind = \"surface\", file = \"a.obj\", {more}"), &[("a.obj", text.as_bytes())]).expect(more).0
    };
    let bounds = of("size = 1.0, center = [1, 2, 3]").bounds();
    assert_eq!(bounds, ([0.75, 1.75, 2.5], [1.25, 2.25, 3.5]));
    assert_eq!(of("up = \"z\"").bounds(), ([-1.0, -2.0, -1.0], [1.0, 2.0, 1.0]));
    assert!((of("up = \"z\"").enclosed_volume() - 16.0).abs() < 1e-12);
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

#[test]
fn what_is_mended_is_counted() {
    let codes = |text: &str, more: &str| -> (Mesh<3>, Vec<(&'static str, String)>) {
        let (mesh, notices) =
            space(&format!("kind = \"surface\", file = \"a.obj\"{more}"), &[("a.obj", text.as_bytes())])
                .unwrap_or_else(|e| panic!("{}", e[0]));
        let told = notices.into_iter().map(|n| (n.about.code, n.about.value.unwrap_or_default())).collect();
        ((*mesh).clone(), told)
    };
    let told = |code: &'static str, value: &str| vec![(code, value.to_string())];
    // One square turned, all squares turned, a vertex that nobody names.
    let (mesh, notices) = codes(&obj().replace("f 5/1 6//1 7/1/1 8", "f 8 7 6 5"), "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.flipped", "2"));
    let mut turned = String::new();
    CORNERS.iter().for_each(|[x, y, z]| turned += &format!("v {x} {y} {z}\n"));
    SQUARES.iter().for_each(|[a, b, c, d]| turned += &format!("f {} {} {} {}\n", d + 1, c + 1, b + 1, a + 1));
    let (mesh, notices) = codes(&turned, "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.flipped", "1"));
    let (mesh, notices) = codes(&format!("{}v 9 9 9\nv 8 8 8\n", obj()), "");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.unreferenced", "2"));
    let (_, notices) = codes(&format!("{}l 1 2\np 3\n", obj()), "");
    assert_eq!(notices, told("mesh.strokes", "2"));
    // An open box: refused, closed, or cloth.
    let open = obj().replace("f 5/1 6//1 7/1/1 8\r\n", "");
    let error = &surface("a.obj", open.as_bytes()).expect_err("open")[0];
    assert_eq!((error.code, error.value.as_deref()), ("mesh.open", Some("1")));
    assert!(error.hint.as_ref().is_some_and(|h| h.contains("cap")));
    let (mesh, notices) = codes(&open, ", open = \"cap\"");
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-12 && mesh.nodes() == 9);
    assert_eq!(notices, told("mesh.capped", "1"));
    let (mesh, notices) = codes(&open, ", open = \"sheet\"");
    assert_eq!((mesh.facets.len(), mesh.sheets.len(), notices.len()), (0, 10, 0));
    // Every triangle with vertices of its own: in pieces, until they are welded.
    let mut soup = String::new();
    for (k, corners) in triangles().into_iter().enumerate() {
        corners.iter().for_each(|c| soup += &format!("v {} {} {}\n", CORNERS[*c][0], CORNERS[*c][1], CORNERS[*c][2]));
        soup += &format!("f {} {} {}\n", 3 * k + 1, 3 * k + 2, 3 * k + 3);
    }
    let error = &surface("a.obj", soup.as_bytes()).expect_err("in pieces")[0];
    assert!(
        error.code == "mesh.open"
            && error.hint.as_ref().is_some_and(|h| h.contains("28 vertices") && h.contains("weld")),
        "{error}"
    );
    let (mesh, notices) = codes(&soup, ", weld = 1e-6");
    is_cube(&mesh);
    assert_eq!(notices, told("mesh.welded", "28"));
}

fn refused(name: &str, bytes: &[u8]) -> SceneError {
    match surface(name, bytes) {
        Ok(_) => panic!("{name} should be refused: {:?}", String::from_utf8_lossy(bytes)),
        Err(mut errors) => errors.remove(0),
    }
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

/// Rows 26 and 38: what is odd but can be meant is counted, with the worst of it and a guess at the unit.
#[test]
fn slivers_and_odd_scales_are_told() {
    let codes = |text: &str, more: &str| -> Vec<(&'static str, Option<String>)> {
        let shape = format!("kind = \"surface\", file = \"a.obj\"{more}");
        let (_, notices) = space(&shape, &[("a.obj", text.as_bytes())]).unwrap_or_else(|e| panic!("{}", e[0]));
        notices.into_iter().map(|n| (n.about.code, n.about.value)).collect()
    };
    // A tetrahedron whose sides are long and whose front is thin.
    let needle =
        |thin: f64| format!("v 0 0 0\nv 1 0 0\nv 0 {thin} 0\nv 0 0 {thin}\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
    assert_eq!(codes(&needle(0.1), ""), []);
    assert_eq!(codes(&needle(1e-4), ""), [("mesh.sliver", Some("3".into()))]);
    assert_eq!(refused("a.obj", needle(1e-11).as_bytes()).code, "mesh.degenerate_face");
    // The cube, 2 units wide, in other units.
    let cube = |scale: f64| {
        let mut text = String::new();
        CORNERS.iter().for_each(|c| text += &format!("v {:e} {:e} {:e}\n", scale * c[0], scale * c[1], scale * c[2]));
        SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("f {} {} {} {}\n", a + 1, b + 1, c + 1, d + 1));
        text
    };
    for (scale, wanted) in [(1.0, None), (1e5, Some("200000")), (1e-6, Some("0.000002"))] {
        let told: Vec<_> = wanted.map(|value| ("mesh.scale", Some(value.to_string()))).into_iter().collect();
        assert_eq!(codes(&cube(scale), ""), told, "{scale}");
        assert_eq!(codes(&cube(scale), ", size = 2.0"), [], "whoever says the size has seen it");
    }
    for scale in [1e30, 1e-30, 1e200, 1e-200, 1e308] {
        match surface("a.obj", cube(scale).as_bytes()) {
            Ok((mesh, notices)) => {
                assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()), "{scale}");
                assert_eq!(notices[0].about.code, "mesh.scale", "{scale}");
            }
            Err(errors) => assert_eq!(errors[0].file, "a.obj", "{scale}: {}", errors[0]),
        }
    }
}

/// Row 35: a shell inside another is a cavity of one chamber, shells beside one another are chambers each.
#[test]
fn shells_are_chambers_and_shells_in_them_cavities() {
    let cubes = |scales: [f64; 2], apart: f64| {
        let mut text = String::new();
        for (k, scale) in scales.into_iter().enumerate() {
            for c in CORNERS {
                let [x, y, z] = c.map(|x| scale * x);
                text += &format!("v {} {y} {z}\n", x + apart * k as f64);
            }
        }
        for first in [1, 9] {
            SQUARES.iter().for_each(|[a, b, c, d]| {
                text += &format!("f {} {} {} {}\n", a + first, b + first, c + first, d + first);
            });
        }
        surface("a.obj", text.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0])).0
    };
    let (nested, beside) = (cubes([1.0, 0.5], 0.0), cubes([1.0, 0.5], 4.0));
    assert_eq!((nested.components().expect("closed").len(), nested.chambers().expect("one").len()), (2, 1));
    assert!((nested.enclosed_volume() - 7.0).abs() < 1e-12, "{}", nested.enclosed_volume());
    assert_eq!((beside.components().expect("closed").len(), beside.chambers().expect("two").len()), (2, 2));
    assert!((beside.enclosed_volume() - 9.0).abs() < 1e-12, "{}", beside.enclosed_volume());
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
        ("4 0 3 2 1", "4 0 3 2 8", "mesh.index", Some(22)),
        ("4 0 3 2 1", "4 0 3 2 -1", "mesh.index", Some(22)),
        ("4 0 3 2 1", "2 0 3", "mesh.degenerate_face", Some(22)),
        ("4 0 3 2 1", "400 0 3 2 1", "ply.size", Some(22)),
        ("255 1 1 1", "255 1 1 x", "shape.number", Some(20)),
        ("255 1 1 1", "255 1 nan 1", "scene.not_finite", Some(20)),
        ("\n7\n", "\n7\n8\n", "ply.size", Some(28)),
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

#[test]
fn a_lattice_needs_a_spacing_and_a_closed_surface() {
    let of = |more: &str| {
        space(
            &format!("kind = \"surface\", file = \"a.obj\", filling = \"lattice\"{more}"),
            &[("a.obj", obj().as_bytes())],
        )
    };
    assert_eq!(of("").expect_err("no spacing")[0].code, "scene.missing");
    let (mesh, _) = of(", spacing = 0.5").expect("a lattice");
    assert!(mesh.skin.as_ref().is_some_and(|skin| skin.carriers.len() > 8) && mesh.cells.tetrahedra.len() > 100);
    assert_eq!(of(", spacing = 1e-7").expect_err("too fine")[0].code, "limit.nodes");
}

/// `cargo test --release -p opruga-io --test surfaces -- --ignored --nocapture` prints how long it takes.
#[test]
#[ignore = "a time, which only a quiet machine and a release build make meaningful"]
fn a_million_triangles_are_read_within_two_seconds() {
    let torus = Mesh::torus(1.0, 0.4, [1000, 500]).expect("a torus");
    let mut bytes = vec![0; 80];
    bytes.extend((torus.facets.len() as u32).to_le_bytes());
    for facet in &torus.facets {
        bytes.extend([0; 12]);
        facet
            .iter()
            .flat_map(|node| torus.positions[*node as usize])
            .for_each(|x| bytes.extend((x as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    let start = std::time::Instant::now();
    let (mesh, notices) = surface("a.stl", &bytes).expect("a torus");
    let seconds = start.elapsed().as_secs_f64();
    println!("{} triangles, {} nodes: {seconds:.2} s", mesh.facets.len(), mesh.nodes());
    assert_eq!((mesh.nodes(), mesh.euler_characteristic(), notices.len()), (torus.nodes(), 0, 0));
    assert!(seconds < 2.0, "{seconds} s");
}

/// Row 35: a closed surface that crosses itself is refused with two triangles and a place, in every format; on request it
/// is taken as it is, and counted.
#[test]
fn surfaces_that_meet_themselves_are_refused_with_their_place() {
    // A second cube, moved by half of its side: it begins at vertex 9, face 7.
    let mut twice = obj().replace("\r\n", "\n");
    let first = twice.clone();
    CORNERS.iter().for_each(|[x, y, z]| twice += &format!("v {} {} {}\n", x + 1.0, y + 0.9, z + 0.8));
    SQUARES.iter().for_each(|[a, b, c, d]| twice += &format!("f {} {} {} {}\n", a + 9, b + 9, c + 9, d + 9));
    surface("a.obj", first.as_bytes()).expect("one cube is sound");
    let error = surface("a.obj", twice.as_bytes()).expect_err("two cubes cross");
    let error = &error[0];
    assert_eq!(error.code, "mesh.self_intersection", "{error}");
    let line = twice.lines().nth(error.line.expect("a line") - 1).expect("a line");
    assert!(line.starts_with("f "), "{line}");
    assert!(error.message.contains("triangle ") && error.to_string().contains("overlap = \"keep\""), "{error}");
    let kept = space("kind = \"surface\", file = \"a.obj\", overlap = \"keep\"", &[("a.obj", twice.as_bytes())]);
    let (mesh, notices) = kept.expect("taken as it is");
    assert_eq!(mesh.facets.len(), 24);
    assert!(notices.iter().any(|n| n.about.code == "mesh.self_intersection"), "{notices:?}");

    // The same as bytes: each triangle of a binary STL, each face of a PLY, each primitive of a glTF has its place.
    let mut stl = stl_bytes();
    stl[80..84].copy_from_slice(&24u32.to_le_bytes());
    let second: Vec<u8> = stl[84..].to_vec();
    for triangle in second.chunks_exact(50) {
        let mut moved = triangle.to_vec();
        for corner in moved[12..48].chunks_exact_mut(12) {
            for (axis, word) in corner.chunks_exact_mut(4).enumerate() {
                let x = f32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                word.copy_from_slice(&(x + [1.0, 0.9, 0.8][axis]).to_le_bytes());
            }
        }
        stl.extend(moved);
    }
    let error = &surface("a.stl", &stl).expect_err("two cubes cross")[0];
    assert_eq!(error.code, "mesh.self_intersection");
    let byte: usize = error.message.rsplit_once("at byte ").expect("a byte").1.parse().expect("a number");
    assert!(byte >= 84 + 12 * 50 && (byte - 84).is_multiple_of(50), "{error}");
}

/// What only the whole surface shows is told with the byte or line of a triangle, in formats without lines too.
#[test]
fn late_errors_have_a_place_in_every_format() {
    // The last face once more.
    for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let text = String::from_utf8_lossy(&ply(format)).into_owned();
        let good = ply(format);
        let header = text.find("end_header\n").expect("a header") + "end_header\n".len();
        let (face, tail) = if format == "ascii" { (10, 2) } else { (17, 2) };
        let at = good.len() - tail - face;
        let mut bad = good[..good.len() - tail].to_vec();
        bad.extend_from_slice(&good[at..]);
        let text = core::str::from_utf8(&bad[..header]).expect("ascii").replace("element face 6", "element face 7");
        let bad = [text.as_bytes(), &bad[header..]].concat();
        let error = &surface("a.ply", &bad).expect_err("a face twice")[0];
        assert_eq!(error.code, "mesh.duplicate_element", "{format}: {error}");
        match format {
            "ascii" => assert_eq!(error.line, Some(header_lines(&text) + 8 + 7), "{error}"),
            _ => assert!(error.message.ends_with(&format!("at byte {}", bad.len() - tail - face)), "{format}: {error}"),
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

/// A surface is made anew of triangles of a wanted size; a cloth is not.
#[test]
fn surfaces_are_remeshed_to_a_length() {
    let text = obj();
    let files: &[(&str, &[u8])] = &[("a.obj", text.as_bytes())];
    let shape = "kind = \"surface\", file = \"a.obj\"";
    let (mesh, notices) = space(&format!("{shape}, remesh = 0.2"), files).expect("a cube");
    assert!((600..1200).contains(&mesh.nodes()) && notices.is_empty(), "{}", mesh.nodes());
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-9 && mesh.check().is_empty());
    let (filled, _) =
        space(&format!("{shape}, remesh = 0.2, filling = \"lattice\", spacing = 0.5"), files).expect("filled");
    assert_eq!(filled.skin.as_ref().expect("a skin").carriers.len(), mesh.nodes());
    let open = text.rsplit_once("f ").expect("a face").0;
    let files: &[(&str, &[u8])] = &[("a.obj", open.as_bytes())];
    let error = &space(&format!("{shape}, open = \"sheet\", remesh = 0.2"), files).expect_err("it is open")[0];
    assert!(error.code == "mesh.open" && error.to_string().contains("remesh"), "{error}");
    let error = &space(&format!("{shape}, remesh = 1e-5, open = \"cap\""), files).expect_err("too many nodes")[0];
    assert!(error.code.starts_with("limit.") || error.code.starts_with("scene."), "{error}");
}
