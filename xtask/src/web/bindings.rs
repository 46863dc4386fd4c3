//! Makes the layer between the program and the browser: the JavaScript through which they call each other.

use std::path::{Path, PathBuf};
use wasm_bindgen_cli_support::Bindgen;

/// A program and its JavaScript.
pub(super) struct Made {
    pub(super) program: Vec<u8>,
    pub(super) script: Vec<u8>,
}

/// Makes the program of the page and its JavaScript from a compiled program.
///
/// # Errors
/// The file that cannot be read or translated.
pub(super) fn make(compiled: &Path) -> Result<Made, String> {
    let folder: PathBuf = compiled.with_extension("bindings");
    let mut bindgen = Bindgen::new();
    let bindgen = bindgen.web(true).map_err(|e| e.to_string())?;
    bindgen.input_path(compiled).typescript(false).remove_name_section(true).remove_producers_section(true);
    bindgen.out_name("program").generate(&folder).map_err(|e| format!("{}: {e:#}", compiled.display()))?;
    let read = |name: &str| {
        let path = folder.join(name);
        std::fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    Ok(Made { program: read("program_bg.wasm")?, script: read("program.js")? })
}
