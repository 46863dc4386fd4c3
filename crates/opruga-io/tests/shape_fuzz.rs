//! Random bytes and tampered files of every format: a mesh that is sound, or an error that names file and value, never a panic.
//!
//! `fuzz/` looks for new ones.

mod common;
use common::{HEAD, catalogue};
use opruga_io::Files;
use opruga_io::scene::{Limits, Options, read};
use opruga_mesh::Mesh;
use opruga_world::blueprint::AnyBlueprint;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;

const HEART: &[u8] = include_bytes!("../../../scenes/shapes/heart.svg");
const FISH: &[u8] = include_bytes!("../../../scenes/shapes/fish.svg");
const GRADIENTS: &[u8] = br##"<svg xmlns="http://www.w3.org/2000/svg"><style>.a{}</style><radialGradient id="b" href="#a"/><linearGradient id="a"><stop stop-color="red"/><stop stop-color="#123" stop-opacity="30%"/></linearGradient><g fill="url(#b)" opacity=".5"><circle r="4" class="a"/><rect width="5" height="3" style="fill: rgb(1, 20, 3)"/></g></svg>"##;
const FONT: &[u8] = include_bytes!("../../../scenes/shapes/inter-black-subset.otf");
const SMALL_MAP: &[u8] = br#"{"type":"Topology","transform":{"scale":[0.5,0.5],"translate":[0,0]},"arcs":[[[4,0],[0,4]],[[4,4],[-4,0],[0,-4],[4,0]]],"objects":{"one":{"type":"MultiPolygon","arcs":[[[0,1]]],"properties":{"name":"a"}}}}"#;
const GEOJSON: &[u8] = br#"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"a"},"geometry":{"type":"Polygon","coordinates":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,3],[3,3],[3,1],[1,1]]]}}]}"#;
const OBJ: &[u8] = b"o a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
const PLY: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const STL: &[u8] = b"solid a\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const GLTF: &[u8] = br#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],"buffers":[{"byteLength":60,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAQIDAAMC"}]}"#;

const MSH_2: &[u8] = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 3 \"steel\"\n$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0.5 0 0\n5 0.5 0.5 0\n6 0 0.5 0\n$EndNodes\n$Elements\n2\n1 1 2 7 1 1 2\n2 9 2 3 1 1 2 3 4 5 6\n$EndElements\n$ElementData\n1\n\"E\"\n1\n0.0\n3\n0\n1\n1\n2 2.5\n$EndElementData\n";
const MSH_4: &[u8] = include_bytes!("data/meshes/fenris/cube_tet10_24.msh");
const MSH_2_BINARY: &[u8] = include_bytes!("data/meshes/polyfem/22_binary.msh");
const MSH_4_BINARY: &[u8] = include_bytes!("data/meshes/polyfem/41_binary.msh");
const VTK: &[u8] = include_bytes!("data/meshes/mfem/beam-tet.vtk");
const VTU: &[u8] = br#"<VTKFile type="UnstructuredGrid"><UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1"><Points><DataArray type="Float32" format="binary">MAAAAAAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAAAAAAAAAAAAAAAAACAPw==</DataArray></Points><Cells><DataArray type="Int32" Name="connectivity">0 1 2 3</DataArray><DataArray type="Int32" Name="offsets">4</DataArray><DataArray type="UInt8" Name="types" format="appended" offset="0"/></Cells></Piece></UnstructuredGrid><AppendedData encoding="base64">_AQAAAAo=</AppendedData></VTKFile>"#;
const MFEM: &[u8] = include_bytes!("data/meshes/mfem/beam-tet.mesh");
const MEDIT: &[u8] = b"MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 5\n0 0 1 5\nTriangles 1\n1 3 2 9\nTetrahedra\n1\n1 2 3 4 2\nEnd\n";
const ELE: &[u8] = b"1 4 1\n1 1 2 3 4 2.5\n";
/// A leaf of 12 by 9 dots, dark on white.
const PNG: &[u8] = include_bytes!("data/leaf.png");
/// Goes with `ELE`.
const NODE: &[u8] = b"4 3 0 1\n1 0 0 0 0\n2 1 0 0 3\n3 0 1 0 3\n4 0 0 1 -1\n";

/// How many samples there are.
const SAMPLES: usize = 25;

/// Dimension, shape, name of the file, contents.
fn samples() -> Vec<(u8, &'static str, &'static str, &'static [u8])> {
    let leaked = |text: String| -> &'static str { text.leak() };
    let outline = |kind: &str, more: &str| leaked(format!("kind = \"{kind}\", {more}"));
    let joined = "spacing = 0.1, size = 1.0, overlap = \"union\"";
    let filled = "spacing = 0.2, size = 1.0, filling = \"triangles\"";
    let lattice = "spacing = 0.2, size = 1.0, filling = \"lattice\"";
    let painted = "spacing = 0.2, size = 1.0, filling = \"lattice\", overlap = \"union\", colours = true";
    let gradients = "spacing = 0.2, size = 1.0, overlap = \"union\", colours = true";
    let mending = "inverted = \"turn\", unreferenced = \"leave_out\"";
    vec![
        (2, outline("svg", filled), "a.svg", HEART),
        (2, outline("svg", joined), "a.svg", FISH),
        (2, outline("svg", painted), "a.svg", FISH),
        (2, outline("svg", gradients), "a.svg", GRADIENTS),
        (2, outline("map", lattice), "a.json", GEOJSON),
        (2, outline("map", filled), "a.json", SMALL_MAP),
        (2, outline("map", joined), "a.json", GEOJSON),
        (2, outline("bitmap", "spacing = 0.1, size = 1.0"), "a.png", PNG),
        (2, outline("text", "spacing = 0.2, size = 1.0, text = \"oB\""), "a.otf", FONT),
        (3, outline("surface", "weld = 1e-9"), "a.obj", OBJ),
        (3, outline("surface", "filling = \"lattice\", spacing = 0.4"), "a.ply", PLY),
        (3, outline("surface", "open = \"cap\""), "a.stl", STL),
        (3, outline("surface", "open = \"sheet\""), "a.gltf", GLTF),
        (3, outline("surface", "weld = 1e-9"), "a.glb", &*common::cube::glb().leak()),
        (3, outline("surface", "filling = \"tetrahedra\", spacing = 0.3"), "a.obj", OBJ),
        (2, outline("mesh", mending), "a.msh", MSH_2),
        (3, outline("mesh", mending), "a.msh", MSH_4),
        (3, outline("mesh", mending), "a.msh", MSH_2_BINARY),
        (3, outline("mesh", mending), "a.msh", MSH_4_BINARY),
        (3, outline("mesh", mending), "a.vtk", VTK),
        (3, outline("mesh", mending), "a.vtu", VTU),
        (3, outline("mesh", mending), "a.mesh", MFEM),
        (3, outline("mesh", mending), "a.mesh", MEDIT),
        (3, outline("mesh", mending), "a.ele", ELE),
        (3, outline("mesh", mending), "a.node", NODE),
    ]
}

fn sound<const D: usize>(mesh: &Mesh<D>) {
    mesh.validate().expect("a valid mesh");
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    // Cells may touch along an edge, which is sound for elements, but bounds no chamber.
    if mesh.cells.is_empty() {
        mesh.chambers().expect("closed chambers, or none");
    }
    if let Some(skin) = &mesh.skin {
        let nodes = mesh.nodes() as u32;
        assert!(skin.carriers.iter().flatten().all(|node| *node < nodes));
        assert!(skin.weights.iter().flatten().all(|weight| weight.is_finite()));
        let points = skin.carriers.len() as u32;
        let named =
            skin.areas.iter().flat_map(|area| area.rings.iter().flatten().chain(area.triangles.iter().flatten()));
        assert!(named.copied().all(|point| point < points));
    }
    let upright = mesh.cell_measures().iter().all(|measure| measure.least >= 0.0);
    assert!(upright && mesh.unreferenced_nodes().is_empty());
}

/// Whether the file is read; what is read must be sound.
fn survives(dimension: u8, shape: &str, name: &str, bytes: &[u8]) -> bool {
    let head = HEAD.replace("dimension = 2", &format!("dimension = {dimension}"));
    // Of a pair of files the cells are what a scene names.
    let named = name.replace(".node", ".ele");
    let text = format!("{head}[[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{named}\", {shape} }}\n");
    let limits = Limits { nodes: 20_000, memory_bytes: 64 << 20, ..Limits::default() };
    let beside = [("a.node", NODE), ("a.ele", ELE)].into_iter().filter(|(file, _)| *file != name);
    let files = beside.chain([(name, bytes)]).map(|(file, bytes)| (file.to_string(), Arc::from(bytes)));
    let files = Files::held(files);
    match read(text.as_bytes(), "scene.toml", &catalogue(), &Options { limits, files, ..Options::default() }) {
        Ok((AnyBlueprint::Plane(b), _)) => sound(&b.bodies[0].mesh),
        Ok((AnyBlueprint::Space(b), _)) => sound(&b.bodies[0].mesh),
        Err(errors) => {
            for error in errors {
                assert!(!error.file.is_empty(), "{error:?}");
                assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()), "{error:?}");
            }
            return false;
        }
    }
    true
}

#[test]
fn the_samples_are_read() {
    assert_eq!(samples().len(), SAMPLES);
    for (dimension, shape, name, bytes) in samples() {
        assert!(survives(dimension, shape, name, bytes), "{name}, {shape}");
    }
}

/// What a tampered byte becomes.
const BYTES: &[u8] = b"\0\xff09-.eM,[]{}\"<>/ \n1";

proptest! {
    #![proptest_config(ProptestConfig { cases: 2500, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn tampered_files(sample in 0..SAMPLES, changes in proptest::collection::vec((any::<u32>(), 0..BYTES.len(), 0..4u8), 1..5)) {
        let (dimension, shape, name, bytes) = samples()[sample];
        let mut bytes = bytes.to_vec();
        for (place, byte, how) in changes {
            let place = place as usize % bytes.len().max(1);
            match how {
                0 if place < bytes.len() => bytes[place] = BYTES[byte],
                1 => bytes.insert(place, BYTES[byte]),
                2 if !bytes.is_empty() => drop(bytes.remove(place)),
                _ => bytes.truncate(bytes.len().max(1) - 1 - place % 7 % bytes.len().max(1)),
            }
        }
        survives(dimension, shape, name, &bytes);
    }

    #[test]
    fn random_files(sample in 0..SAMPLES, bytes in proptest::collection::vec(any::<u8>(), 0..300), keep in 0..60usize) {
        let (dimension, shape, name, good) = samples()[sample];
        // A good beginning leads deeper.
        let bytes = [&good[..keep.min(good.len())], &bytes[..]].concat();
        survives(dimension, shape, name, &bytes);
    }

    /// Other digits: files that are well formed, of shapes that nobody drew.
    #[test]
    fn files_with_other_numbers(sample in 0..SAMPLES, changes in proptest::collection::vec((any::<u32>(), b'0'..=b'9'), 1..8)) {
        let (dimension, shape, name, bytes) = samples()[sample];
        let mut bytes = bytes.to_vec();
        let digits: Vec<usize> = (0..bytes.len()).filter(|k| bytes[*k].is_ascii_digit()).collect();
        for (place, digit) in changes {
            bytes[digits[place as usize % digits.len()]] = digit;
        }
        survives(dimension, shape, name, &bytes);
    }
}
