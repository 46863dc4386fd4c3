//! The chunks of a .glb: the JSON and the bytes of a glTF file in one.

use crate::problem::SceneError;

/// The JSON of a file, and the binary chunk of a .glb.
pub(super) fn chunks<'a>(file: &str, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let named = |error: SceneError| SceneError { file: file.to_string(), ..error };
    let word = |at: usize| bytes.get(at..at + 4).map(|w| u64::from(u32::from_le_bytes([w[0], w[1], w[2], w[3]])));
    let size = |what: &str, value: u64| {
        named(SceneError::new("gltf.size", format!("{what}: {value}, but the file has {} bytes", bytes.len())))
            .value(value.to_string())
            .hint("the file is cut off")
    };
    match (word(4), word(8)) {
        (Some(2), Some(length)) if length == bytes.len() as u64 => {}
        (Some(2), Some(length)) => {
            let error = size("at byte 8, the length of the file", length);
            let more = (bytes.len() as u64).saturating_sub(length);
            let hint = format!("the length covers the whole file: leave out what follows it, {more} bytes");
            return Err(if more > 0 { error.hint(hint) } else { error });
        }
        (version, _) => {
            let version = version.unwrap_or(0);
            let error = SceneError::new("gltf.version", format!("at byte 4, version {version}"));
            return Err(named(error.value(version.to_string()).allowed("2")));
        }
    }
    let (mut at, mut json, mut binary) = (12usize, None, None);
    while at < bytes.len() {
        let (Some(length), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(size("a chunk begins at byte", at as u64));
        };
        let Some(chunk) = usize::try_from(length).ok().and_then(|n| bytes.get(at + 8..(at + 8).checked_add(n)?)) else {
            return Err(size(&format!("at byte {at}, the length of a chunk"), length));
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
        None => Err(named(
            SceneError::new("gltf.size", "the file has no JSON chunk").value("0").allowed("a chunk `JSON` at byte 12"),
        )),
    }
}
