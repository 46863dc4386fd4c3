//! Any bytes are a shape that is sound, or an error that names the file. The first byte says which format.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga_core::spec::Spec;
use opruga_io::scene::{Limits, Options, read};
use opruga_io::{Catalogue, Files};
use std::sync::Arc;

static EULER: Spec =
    Spec { kind: "symplectic_euler", summary: "", documentation: "", dimensions: &[2, 3], fields: &[] };

const SHAPES: [(u8, &str, &str); 10] = [
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
];

fuzz_target!(|bytes: &[u8]| {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let (dimension, name, shape) = SHAPES[usize::from(*which) % SHAPES.len()];
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{name}\", {shape} }}\n"
    );
    let catalogue = Catalogue { models: vec![], integrators: vec![&EULER], colliders: vec![] };
    let limits = Limits { nodes: 20_000, memory_bytes: 64 << 20, ..Limits::default() };
    let files = Files::held([(name.to_string(), Arc::from(bytes))]);
    if let Err(errors) = read(text.as_bytes(), "fuzz.toml", &catalogue, &Options { limits, files, ..Options::default() }) {
        for error in errors {
            assert!(!error.file.is_empty());
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
});
