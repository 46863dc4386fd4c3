//! The files of the page.

use super::bindings::Made;
use flate2::{Compression, write::GzEncoder};
use lzma_rust2::{LzmaOptions, LzmaWriter};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The largest transfer size of the page [bytes].
const MOST_BYTES: usize = 4_000_000;
/// The distance over which the compressor finds repetitions [bytes]. It covers the whole program. The browser needs the same amount of memory to
/// unpack the program.
const DICTIONARY: u32 = 16 << 20;

/// Writes the page to a folder: the packed program, the module that unpacks it, the JavaScript of both, and the handwritten files, into which the
/// names of the others are filled in.
///
/// # Errors
/// Files that cannot be written, and a page that is too large.
pub(super) fn lay_out(root: &Path, studio: &Made, unpacker: &Made, folder: &Path) -> Result<(), String> {
    let sources = root.join("crates/opruga-studio/web");
    let packed = packed(&studio.program).map_err(|e| format!("the program cannot be packed: {e}"))?;
    // The names of the files contain a fingerprint of the version, so that no browser mixes files of different versions.
    let version = format!("{:016x}", fingerprint(&[&packed, &studio.script, &unpacker.program, &unpacker.script]));
    let [program, glue, unpack_program, unpack] = ["studio.wasm.lzma", "studio.js", "unpack.wasm", "unpack.js"]
        .map(|name| name.replacen('.', &format!("-{version}."), 1));
    let source = |name: &str| {
        let path = sources.join(name);
        std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))
    };
    let page = source("index.html")?;
    let page = page.replace("{{packed}}", &program).replace("{{glue}}", &glue);
    let page = page.replace("{{unpack}}", &unpack).replace("{{unpack_program}}", &unpack_program);
    let page = page.replace("{{packed_bytes}}", &packed.len().to_string());
    let credits = credits(&[root.join("scenes/shapes"), root.join("crates/opruga-studio/font")])?;
    // The credits are not among the files that the browser keeps. Some servers convert such texts to pages, and if one file is missing, the browser
    // keeps none.
    let kept = ["./", "icon.svg", "manifest.webmanifest", &program, &glue, &unpack_program, &unpack];
    let version = format!("{:016x}", fingerprint(&[version.as_bytes(), page.as_bytes()]));
    let worker = source("worker.js")?.replace("{{version}}", &version);
    let worker = worker.replace("{{files}}", &serde_json::json!(kept).to_string());
    let mut files = vec![
        ("index.html", page.into_bytes()),
        ("worker.js", worker.into_bytes()),
        ("icon.svg", source("icon.svg")?.into_bytes()),
        ("manifest.webmanifest", source("manifest.webmanifest")?.into_bytes()),
        (&glue, studio.script.clone()),
        (&program, packed),
        (&unpack, unpacker.script.clone()),
        (&unpack_program, unpacker.program.clone()),
    ];
    files.extend(credits.iter().map(|(name, text)| (name.as_str(), text.clone())));
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut all = 0;
    println!("{:>10}  {:>10}  file", "bytes", "packed");
    for (name, bytes) in &files {
        let path = folder.join(name);
        std::fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        let (size, small) = match *name == program {
            true => (studio.program.len(), bytes.len()),
            false => (bytes.len(), gzipped_size(bytes)),
        };
        all += small;
        println!("{size:>10}  {small:>10}  {name}");
    }
    println!("{:>10}  {all:>10}  in {}", "", folder.display());
    if all > MOST_BYTES {
        return Err(format!("the page takes {all} bytes on its way; allowed: {MOST_BYTES}"));
    }
    Ok(())
}

/// The credits: the names and texts of the files with the origins of the shapes and fonts, and with the licences of their authors.
///
/// # Errors
/// The file that cannot be read.
fn credits(folders: &[PathBuf]) -> Result<Vec<(String, Vec<u8>)>, String> {
    let mut found = Vec::new();
    for folder in folders {
        let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if ["CREDITS", "LICENSE", "README"].iter().any(|kind| name.starts_with(kind)) {
                found.push((name, std::fs::read(entry.path()).map_err(failed)?));
            }
        }
    }
    found.sort();
    Ok(found)
}

fn packed(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut options = LzmaOptions::with_preset(9);
    // The options are set for WebAssembly, whose instructions are not aligned and depend on more of the preceding data than the characters of a text.
    (options.lc, options.lp, options.pb) = (4, 0, 0);
    options.dict_size = DICTIONARY;
    options.nice_len = 273;
    let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(bytes.len() as u64))?;
    writer.write_all(bytes)?;
    writer.finish()
}

/// The number of bytes that a compressing server sends for a file.
fn gzipped_size(bytes: &[u8]) -> usize {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    let packed = encoder.write_all(bytes).and_then(|()| encoder.finish());
    packed.map_or(bytes.len(), |packed| packed.len())
}

/// A 64-bit hash (Fowler, Noll, Vo 1a) of the contents of files.
fn fingerprint(parts: &[&[u8]]) -> u64 {
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
    parts.iter().flat_map(|part| part.iter()).fold(0xcbf2_9ce4_8422_2325, step)
}
