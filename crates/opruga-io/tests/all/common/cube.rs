//! A cube in every surface format.

use super::shapes::surface;
use opruga_io::SceneError;
use opruga_mesh::Mesh;

/// A cube of side 2 about the origin: corners, and six squares counter-clockwise seen from outside.
pub(crate) const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];
pub(crate) const SQUARES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

pub(crate) fn triangles() -> Vec<[usize; 3]> {
    SQUARES.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect()
}

pub(crate) fn obj() -> String {
    let mut text = String::from("# a cube\r\no cube\r\n");
    CORNERS.iter().for_each(|[x, y, z]| text += &format!("v {x} {y}\t{z}\r\n"));
    SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("f {}/1 {}//1 {}/1/1 {}\r\n", a + 1, b + 1, c + 1, d + 1));
    text + "vt 0 0\r\nvn 0 0 1\r\n"
}

pub(crate) fn stl_text() -> String {
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

pub(crate) fn stl_bytes() -> Vec<u8> {
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

pub(crate) fn ply(format: &str) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat {format} 1.0\ncomment a cube\nelement vertex 8\nproperty uchar red\nproperty float x\nproperty double y\nproperty float z\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    if format == "ascii" {
        let mut text = String::new();
        CORNERS.iter().for_each(|[x, y, z]| text += &format!("255 {x} {y} {z}\n"));
        SQUARES.iter().for_each(|[a, b, c, d]| text += &format!("4 {a} {b} {c} {d}\n"));
        bytes.extend(text.bytes());
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
    bytes
}

/// The buffer of the cube: positions, then indices as 16-bit numbers.
pub(crate) fn buffer() -> Vec<u8> {
    let mut bytes: Vec<u8> = CORNERS.iter().flatten().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    bytes.extend(triangles().iter().flatten().flat_map(|c| (*c as u16).to_le_bytes()));
    bytes
}

pub(crate) fn gltf(uri: &str) -> String {
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

pub(crate) fn base64(bytes: &[u8]) -> String {
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

pub(crate) fn glb() -> Vec<u8> {
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

pub(crate) fn is_cube(mesh: &Mesh<3>) {
    assert_eq!((mesh.nodes(), mesh.facets.len(), mesh.euler_characteristic()), (8, 12, 2));
    assert!((mesh.enclosed_volume() - 8.0).abs() < 1e-6, "{}", mesh.enclosed_volume());
    assert_eq!(mesh.components().expect("closed").len(), 1);
    assert_eq!(mesh.check(), []);
}

pub(crate) fn refused(name: &str, bytes: &[u8]) -> SceneError {
    match surface(name, bytes) {
        Ok(_) => panic!("{name} should be refused: {:?}", String::from_utf8_lossy(bytes)),
        Err(mut errors) => errors.remove(0),
    }
}
