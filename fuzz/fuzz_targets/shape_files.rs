//! Any bytes are a shape that is sound, or an error that names the file. The first byte says which format.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga_core::spec::Spec;
use opruga_io::scene::{Limits, Options, read};
use opruga_io::{Catalogue, Files};
use std::sync::Arc;

static EULER: Spec =
    Spec { kind: "symplectic_euler", summary: "", documentation: "", dimensions: &[2, 3], fields: &[] };

include!("../shared/shapes.rs");

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
