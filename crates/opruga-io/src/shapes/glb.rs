//! The chunks of a .glb: the JSON and the binary data of a glTF file in one file.

use super::gltf_errors::{GltfError, Sized};
use crate::problem::SceneError;

/// Returns the JSON of a file, and the binary chunk of a .glb.
pub(super) fn chunks<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let named = |error: GltfError| SceneError { file: file.to_string(), ..SceneError::of(error) };
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u64::from(u32::from_le_bytes([w[0], w[1], w[2], w[3]])));
    let bytes_of_file = bytes.len();
    match (word(4), word(8)) {
        (Some(2), Some(length)) if length == bytes.len() as u64 => {}
        (Some(2), Some(length)) => {
            let (what, bytes) = (Sized::File, bytes_of_file);
            return Err(named(match (bytes as u64).saturating_sub(length) {
                0 => GltfError::CutOff { what, length, bytes },
                more => GltfError::Behind { what, length, bytes, more },
            }));
        }
        (version, _) => {
            return Err(named(GltfError::BinaryVersion { version: version.unwrap_or(0) }));
        }
    }
    let (mut at, mut json, mut binary) = (12usize, None, None);
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (word(at), word(at + 4)) else {
            let (what, length) = (Sized::Chunk, at as u64);
            return Err(named(GltfError::CutOff { what, length, bytes: bytes_of_file }));
        };
        let Some(chunk) = usize::try_from(length).ok().and_then(|n| bytes.get(at + 8..(at + 8).checked_add(n)?)) else {
            return Err(named(GltfError::Chunk { byte: at, length, bytes: bytes_of_file }));
        };
        match kind {
            0x4E4F_534A if json.is_none() => json = Some(chunk),
            0x004E_4942 if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + chunk.len();
    }
    match json {
        Some(json) => Ok((json, binary)),
        None => Err(named(GltfError::NoJson {})),
    }
}
