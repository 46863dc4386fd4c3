//! A whole scene in one piece: its text and the files that it names, compressed. An address contains the compressed scene as letters after its `#`.
//! Browsers do not send this part of the address to the server.

use crate::report::Report;
use flate2::read::DeflateDecoder;
use flate2::write::DeflateEncoder;
use opruga::io::{Files, base64};
use serde_json::{Map, Value, json};
use std::io::{Read as _, Write as _};
use std::sync::Arc;

/// The prefix of the letters of a scene.
const HEAD: &str = "scene=";
/// The largest number of letters in an address that common browsers accept.
pub const MOST_LETTERS: usize = 1 << 20;
/// The largest number of bytes that a scene may have when it is unpacked.
const MOST_BYTES: u64 = 64 << 20;

/// A scene that an address names.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// The name of the scene.
    pub name: String,
    /// The text of the scene.
    pub text: String,
    /// The files that the scene names.
    pub files: Files,
}

/// Packs a scene. Files that come with the program are omitted.
///
/// # Errors
/// [`Report::NotCompressed`].
pub fn pack(scene: &Shared) -> Result<Vec<u8>, Report> {
    let known = opruga::scenes::files();
    let own = scene.files.files_in_memory().filter(|(name, bytes)| known.file_in_memory(name) != Some(*bytes));
    let files: Map<String, Value> = own.map(|(name, bytes)| (name.into(), base64::encode(bytes).into())).collect();
    let whole = json!({ "name": scene.name, "text": scene.text, "files": files }).to_string();
    let mut encoder = DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(whole.as_bytes()).and_then(|()| encoder.finish()).map_err(|_| Report::NotCompressed)
}

/// Unpacks a scene packed by [`pack`].
///
/// # Errors
/// The scene is truncated, or larger than 64 MiB.
pub fn unpack(packed: &[u8]) -> Result<Shared, Report> {
    let cut = || Report::AddressCut;
    let mut whole = Vec::new();
    DeflateDecoder::new(packed).take(MOST_BYTES + 1).read_to_end(&mut whole).map_err(|_| cut())?;
    if whole.len() as u64 > MOST_BYTES {
        return Err(Report::AddressTooLarge(MOST_BYTES));
    }
    let whole: Value = serde_json::from_slice(&whole).map_err(|_| cut())?;
    let word = |key: &str| whole[key].as_str().map(String::from).ok_or_else(cut);
    let mut own = Vec::new();
    for (name, letters) in whole["files"].as_object().ok_or_else(cut)? {
        let bytes = letters.as_str().and_then(|letters| base64::decode(letters.as_bytes())).ok_or_else(cut)?;
        own.push((name.clone(), Arc::from(bytes)));
    }
    Ok(Shared { name: word("name")?, text: word("text")?, files: opruga::scenes::files().with(own) })
}

/// The part after the `#` of an address that contains a scene. Files that come with the program are omitted.
///
/// # Errors
/// [`Report::AddressTooLong`].
pub fn to_fragment(scene: &Shared) -> Result<String, Report> {
    let letters = base64::encode(&pack(scene)?).trim_end_matches('=').replace('+', "-").replace('/', "_");
    if letters.len() > MOST_LETTERS {
        return Err(Report::AddressTooLong(letters.len(), MOST_LETTERS));
    }
    Ok(format!("{HEAD}{letters}"))
}

/// Returns the scene in the part of an address after its `#`. This part contains the name of a scene that comes with the program, or a complete
/// scene. None if the part is empty.
///
/// # Errors
/// The scene does not exist, or the address was truncated.
pub fn of_fragment(fragment: &str) -> Result<Option<Shared>, Report> {
    let fragment = fragment.trim_start_matches('#');
    let Some(letters) = fragment.strip_prefix(HEAD) else {
        if fragment.is_empty() {
            return Ok(None);
        }
        let text = opruga::scenes::find(fragment).ok_or_else(|| {
            let known: Vec<&str> = opruga::scenes::names().collect();
            Report::AddressUnknown(known.join(", "))
        })?;
        let shared = Shared { name: fragment.into(), text: text.into(), files: opruga::scenes::files() };
        return Ok(Some(shared));
    };
    let packed = base64::decode(letters.replace('-', "+").replace('_', "/").as_bytes()).ok_or(Report::AddressCut)?;
    unpack(&packed).map(Some)
}
