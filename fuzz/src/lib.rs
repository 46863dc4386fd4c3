//! The functions of the fuzz targets, without a fuzzer: the targets in `fuzz_targets` call them with libFuzzer, and the test
//! `opruga/tests/all/fuzz_corpus.rs` calls them with every file of `fuzz/corpus`, on any compiler.

use opruga::Input;
use opruga::core::spec::Spec;
use opruga::io::checkpoint::Checkpoint;
use opruga::io::recording::Recording;
use opruga::io::scene::{Limits, Options, read};
use opruga::io::{Catalogue, Files};
use opruga::sweep::{Design, Question, read_rows};
use std::io::Cursor;
use std::sync::Arc;

/// A function that takes any bytes; an error in the library shows as a panic.
pub type Target = fn(&[u8]);

/// The targets by their names, which are also those of the folders of the corpus.
pub const TARGETS: [(&str, Target); 5] = [
    ("checkpoint", checkpoint),
    ("recording", recording),
    ("scene_reader", scene_reader),
    ("shape_files", shape_files),
    ("sweep_folder", sweep_folder),
];

/// Any bytes are a scene or a list of errors with locations that can be printed: with all models, integrators and obstacles of the library, and the
/// files that its scenes name.
pub fn scene_reader(bytes: &[u8]) {
    let limits = Limits { nodes: 20_000, bodies: 2_000, memory_bytes: 64 << 20, ..Limits::default() };
    let options = Options { limits, files: opruga::scenes::files(), ..Options::default() };
    if let Err(errors) = read(bytes, "fuzz.toml", &opruga::catalogue(), &options) {
        assert!(!errors.is_empty());
        for error in errors {
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
}

/// Any bytes are a checkpoint or a typed error.
pub fn checkpoint(bytes: &[u8]) {
    let _ = Checkpoint::read(bytes);
}

static EULER: Spec =
    Spec { kind: "symplectic_euler", summary: "", documentation: "", dimensions: &[2, 3], fields: &[], roles: &[] };

include!("shape_kinds.rs");

/// Any bytes are a valid shape, or an error that names the file. The first byte selects the format.
pub fn shape_files(bytes: &[u8]) {
    let Some((which, bytes)) = bytes.split_first() else { return };
    let (dimension, name, shape) = SHAPES[usize::from(*which) % SHAPES.len()];
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{}\", {shape} }}\n",
        // The scene names the file with the cells.
        name.replace(".node", ".ele")
    );
    let catalogue = Catalogue { models: vec![], integrators: vec![&EULER], colliders: vec![] };
    let limits = Limits { nodes: 20_000, memory_bytes: 64 << 20, ..Limits::default() };
    let beside = [("a.node", NODES), ("a.ele", CELLS)].into_iter().filter(|(file, _)| *file != name);
    let files = beside.chain([(name, bytes)]).map(|(file, bytes)| (file.to_string(), Arc::from(bytes)));
    let files = Files::in_memory(files);
    if let Err(errors) =
        read(text.as_bytes(), "fuzz.toml", &catalogue, &Options { limits, files, ..Options::default() })
    {
        for error in errors {
            assert!(!error.file.is_empty());
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
}

/// Any bytes are the question of a sweep and its table, or typed errors. A zero byte separates the two.
pub fn sweep_folder(bytes: &[u8]) {
    let end = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    let (question, table) = (&bytes[..end], bytes.get(end + 1..).unwrap_or_default());
    let printable = |text: String| assert!(text.chars().all(|c| c == '\n' || !c.is_control()));
    let question = match Question::read(question) {
        Ok(question) => question,
        Err(error) => return printable(error.to_string()),
    };
    // Reading the written question gives the same question.
    assert!(Question::read(question.to_text().as_bytes()).is_ok_and(|again| again.same(&question)));
    let sweep = match question.sweep(&opruga::Registries::default()) {
        Ok(sweep) => sweep,
        Err(errors) => return errors.iter().for_each(|error| printable(error.to_string())),
    };
    // A sample may ask for any number of points.
    if matches!(sweep.design, Design::Sample { count, .. } if count > 1000) {
        return;
    }
    match sweep.points() {
        Err(errors) => errors.iter().for_each(|error| printable(error.to_string())),
        Ok(points) => match read_rows(&sweep, &points, &String::from_utf8_lossy(table), "results.csv") {
            Ok(rows) => assert!(rows.iter().all(|row| row.number < points.len())),
            Err(errors) => errors.iter().for_each(|error| printable(error.to_string())),
        },
    }
}

/// Any bytes are a recording whose frames and inputs can be read, or a typed error.
pub fn recording(bytes: &[u8]) {
    // The actions of a program are in separate chunks.
    let _ = Input::<2>::from_bytes(bytes);
    let _ = Input::<3>::from_bytes(bytes);
    let Ok(mut recording) = Recording::open(Cursor::new(bytes)) else { return };
    for frame in recording.frames().take(100) {
        let _ = recording.read(frame);
    }
    for number in 0..recording.inputs().count().min(100) {
        let _ = recording.input(number);
    }
}
