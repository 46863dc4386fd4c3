//! Any bytes are a shape that is sound, or an error that names the file. The first byte says which format.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga_core::spec::Spec;
use opruga_io::scene::{Limits, Options, read};
use opruga_io::{Catalogue, Files};
use std::sync::Arc;

static EULER: Spec =
    Spec { kind: "symplectic_euler", summary: "", documentation: "", dimensions: &[2, 3], fields: &[] };

const SHAPES: [(u8, &str, &str); 20] = [
    (2, "a.svg", "kind = \"svg\", spacing = 0.2, size = 1.0, filling = \"triangles\""),
    (2, "a.svg", "kind = \"svg\", spacing = 0.1, size = 1.0, overlap = \"union\""),
    (2, "a.json", "kind = \"map\", spacing = 0.1, size = 1.0, overlap = \"even_odd\""),
    (2, "a.otf", "kind = \"text\", spacing = 0.1, size = 1.0, text = \"oB\""),
    (2, "a.png", "kind = \"bitmap\", spacing = 0.1, size = 1.0"),
    (3, "a.obj", "kind = \"surface\", weld = 1e-6"),
    (3, "a.stl", "kind = \"surface\", open = \"cap\""),
    (3, "a.ply", "kind = \"surface\", filling = \"lattice\", spacing = 0.5"),
    (3, "a.gltf", "kind = \"surface\", open = \"sheet\""),
    (3, "a.glb", "kind = \"surface\""),
    (3, "a.obj", "kind = \"surface\", filling = \"tetrahedra\", spacing = 0.3"),
    (2, "a.msh", "kind = \"mesh\", inverted = \"turn\", unreferenced = \"leave_out\""),
    (3, "a.msh", "kind = \"mesh\", inverted = \"turn\", unreferenced = \"leave_out\""),
    (3, "a.vtk", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.vtu", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.mesh", "kind = \"mesh\", inverted = \"turn\""),
    (
        2,
        "a.svg",
        "kind = \"svg\", spacing = 0.2, size = 1.0, filling = \"lattice\", overlap = \"union\", colours = true",
    ),
    (2, "a.svg", "kind = \"svg\", spacing = 0.2, size = 1.0, overlap = \"even_odd\", colours = true"),
    (3, "a.ele", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.node", "kind = \"mesh\", unreferenced = \"leave_out\""),
];

/// The two files of a mesh of TetGen, of which one is made of any bytes.
const NODES: &[u8] = b"4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
const CELLS: &[u8] = b"1 4 0\n1 1 2 3 4\n";

fuzz_target!(|bytes: &[u8]| {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let (dimension, name, shape) = SHAPES[usize::from(*which) % SHAPES.len()];
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{}\", {shape} }}\n",
        // The cells are what a scene names.
        name.replace(".node", ".ele")
    );
    let catalogue = Catalogue { models: vec![], integrators: vec![&EULER], colliders: vec![] };
    let limits = Limits { nodes: 20_000, memory_bytes: 64 << 20, ..Limits::default() };
    let beside = [("a.node", NODES), ("a.ele", CELLS)].into_iter().filter(|(file, _)| *file != name);
    let files = beside.chain([(name, bytes)]).map(|(file, bytes)| (file.to_string(), Arc::from(bytes)));
    let files = Files::held(files);
    if let Err(errors) =
        read(text.as_bytes(), "fuzz.toml", &catalogue, &Options { limits, files, ..Options::default() })
    {
        for error in errors {
            assert!(!error.file.is_empty());
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
});
