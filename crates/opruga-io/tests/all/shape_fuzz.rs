//! Random bytes and altered files of every format give a valid mesh, or an error that names file and value, and never a panic.
//!
//! `fuzz/` searches for new ones.

use crate::common;
use common::{HEAD, catalogue};
use opruga_io::Files;
use opruga_io::scene::{Limits, Options, read};
use opruga_mesh::Mesh;
use opruga_world::blueprint::AnyBlueprint;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

include!("../../../../fuzz/src/shape_kinds.rs");

/// Files larger than those of the corpus: the shapes as which they are read, and their bytes.
const LARGER: [(u8, &str, &str, &[u8]); 6] = [
    (2, SHAPES[7].1, SHAPES[7].2, include_bytes!("../../../../scenes/shapes/inter-black-subset.otf")),
    (3, SHAPES[17].1, SHAPES[17].2, include_bytes!("../data/meshes/fenris/cube_tet10_24.msh")),
    (3, SHAPES[17].1, SHAPES[17].2, include_bytes!("../data/meshes/polyfem/22_binary.msh")),
    (3, SHAPES[17].1, SHAPES[17].2, include_bytes!("../data/meshes/polyfem/41_binary.msh")),
    (3, SHAPES[18].1, SHAPES[18].2, include_bytes!("../data/meshes/mfem/beam-tet.vtk")),
    (3, SHAPES[20].1, SHAPES[20].2, include_bytes!("../data/meshes/mfem/beam-tet.mesh")),
];

/// A good file, and the shape as which it is read.
struct Sample {
    dimension: u8,
    name: &'static str,
    shape: &'static str,
    bytes: Vec<u8>,
}

/// The files of the corpus that can be read, or the small files that ask for too much, whose names begin with `refused`.
fn corpus(refused: bool) -> Vec<Sample> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/shape_files");
    let entries = std::fs::read_dir(&folder).expect("a corpus");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("refused-")) == refused);
    let sample = |path: &PathBuf| {
        let input = std::fs::read(path).expect("a sample");
        let (which, bytes) = input.split_first().expect("a sample that says what it is");
        let (dimension, name, shape) = SHAPES[usize::from(*which)];
        Sample { dimension, name, shape, bytes: bytes.to_vec() }
    };
    paths.iter().map(sample).collect()
}

/// The corpus from which fuzzing starts, in the order of its names, and larger files.
static SAMPLES: LazyLock<Vec<Sample>> = LazyLock::new(|| {
    let corpus = corpus(false).into_iter();
    let larger = LARGER.iter().map(|(dimension, name, shape, bytes)| Sample {
        dimension: *dimension,
        name,
        shape,
        bytes: bytes.to_vec(),
    });
    corpus.chain(larger).collect()
});

/// The sample for a number; every number has one.
fn sample(number: usize) -> &'static Sample {
    &SAMPLES[number % SAMPLES.len()]
}

fn sound<const D: usize>(mesh: &Mesh<D>) {
    mesh.validate().expect("a valid mesh");
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    // Cells may touch along an edge. This is valid for elements, but bounds no chamber.
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

/// Whether the file is accepted; an accepted file must give a valid mesh.
fn survives(&Sample { dimension, name, shape, .. }: &Sample, bytes: &[u8]) -> bool {
    let head = HEAD.replace("dimension = 2", &format!("dimension = {dimension}"));
    // Of a pair of files, the scene names the one with the cells.
    let named = name.replace(".node", ".ele");
    let text = format!("{head}[[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{named}\", {shape} }}\n");
    let limits = Limits { nodes: 20_000, memory_bytes: 64 << 20, ..Limits::default() };
    let beside = [("a.node", NODES), ("a.ele", CELLS)].into_iter().filter(|(file, _)| *file != name);
    let files = beside.chain([(name, bytes)]).map(|(file, bytes)| (file.to_string(), Arc::from(bytes)));
    let files = Files::in_memory(files);
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

/// Fuzzing without good samples finds little: every shape must have a sample, and every readable ending a shape.
#[test]
fn the_samples_reach_every_reader() {
    for (number, (_, name, shape)) in SHAPES.iter().enumerate() {
        assert!(SAMPLES.iter().any(|s| s.name == *name && s.shape == *shape), "{number}: {name}, {shape}");
    }
    let endings = "svg geojson topojson json ttf png obj stl ply gltf glb msh vtk vtu mesh ele node";
    for ending in endings.split(' ') {
        assert!(SAMPLES.iter().any(|s| s.name == format!("a.{ending}")), "no sample ends in .{ending}");
    }
    // For formats with several variants, each must occur.
    let begin = |ending: &str, head: &[u8]| {
        SAMPLES.iter().any(|s| s.name.ends_with(ending) && s.bytes.windows(head.len()).take(400).any(|w| w == head))
    };
    for (ending, heads) in [
        ("msh", &["\n2.2 0 8", "\n2.2 1 8", "\n4.1 0 8", "\n4.1 1 8"][..]),
        ("ply", &["format ascii", "format binary_little_endian", "format binary_big_endian"]),
        ("stl", &["solid a\nfacet", "a tetrahedron\0"]),
        ("vtk", &["\nASCII", "\nBINARY"]),
        ("mesh", &["MFEM mesh", "MeshVersionFormatted"]),
    ] {
        for head in heads {
            assert!(begin(ending, head.as_bytes()), "no .{ending} with {head:?}");
        }
    }
}

#[test]
fn the_samples_are_read() {
    for sample in SAMPLES.iter() {
        assert!(survives(sample, &sample.bytes), "{}, {}", sample.name, sample.shape);
    }
}

#[test]
fn small_files_that_ask_for_much_are_refused() {
    let refused = corpus(true);
    assert!(refused.len() > 5);
    for sample in refused {
        assert!(!survives(&sample, &sample.bytes), "{}, {}", sample.name, sample.shape);
    }
}

/// The replacements of an altered byte.
const BYTES: &[u8] = b"\0\xff09-.eM,[]{}\"<>/ \n1";

proptest! {
    #![proptest_config(ProptestConfig { cases: 2500, failure_persistence: None, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn tampered_files(number in any::<usize>(), changes in proptest::collection::vec((any::<u32>(), 0..BYTES.len(), 0..4u8), 1..5)) {
        let sample = sample(number);
        let mut bytes = sample.bytes.clone();
        for (place, byte, how) in changes {
            let place = place as usize % bytes.len().max(1);
            match how {
                0 if place < bytes.len() => bytes[place] = BYTES[byte],
                1 => bytes.insert(place, BYTES[byte]),
                2 if !bytes.is_empty() => drop(bytes.remove(place)),
                _ => bytes.truncate(bytes.len().max(1) - 1 - place % 7 % bytes.len().max(1)),
            }
        }
        survives(sample, &bytes);
    }

    #[test]
    fn random_files(number in any::<usize>(), bytes in proptest::collection::vec(any::<u8>(), 0..300), keep in 0..60usize) {
        let sample = sample(number);
        // A valid beginning leads deeper into the reader.
        let bytes = [&sample.bytes[..keep.min(sample.bytes.len())], &bytes[..]].concat();
        survives(sample, &bytes);
    }

    /// Other digits: well-formed files with shapes that nobody drew.
    #[test]
    fn files_with_other_numbers(number in any::<usize>(), changes in proptest::collection::vec((any::<u32>(), b'0'..=b'9'), 1..8)) {
        let sample = sample(number);
        let mut bytes = sample.bytes.clone();
        let digits: Vec<usize> = (0..bytes.len()).filter(|k| bytes[*k].is_ascii_digit()).collect();
        prop_assume!(!digits.is_empty());
        for (place, digit) in changes {
            bytes[digits[place as usize % digits.len()]] = digit;
        }
        survives(sample, &bytes);
    }
}
