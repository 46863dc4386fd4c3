//! Reads the hashes of the frames of a recording. Only the heads of the chunks of the file are read, so that xtask needs no part of the engine.

use std::collections::BTreeMap;

/// The number of bytes before the header. `CHUNK` is the number of bytes of the head of a chunk.
const HEAD: usize = 24;
const CHUNK: usize = 48;
/// The versions whose chunks are supported.
const VERSIONS: [u32; 2] = [5, 6];

/// The hash of every frame in the bytes of a recording.
pub(super) fn hashes(bytes: &[u8]) -> Result<BTreeMap<u64, u64>, String> {
    let cut = || "the recording is cut off".to_string();
    let number = |at: usize| Some(u64::from_le_bytes(bytes.get(at..)?.first_chunk().copied()?));
    if !bytes.starts_with(b"OPRREC\x1a\n") {
        return Err("this is no recording".into());
    }
    let version = number(8).ok_or_else(cut)? as u32;
    if !VERSIONS.contains(&version) {
        return Err(format!("recordings of version {version} are unknown to xtask/src/same_results/hashes.rs"));
    }
    let mut at = HEAD + number(12).ok_or_else(cut)? as usize + 4;
    let mut out = BTreeMap::new();
    while let Some(head) = bytes.get(at..at + CHUNK) {
        let length = number(at + 24).ok_or_else(cut)? as usize;
        let payload = bytes.get(at + CHUNK..at + CHUNK + length).ok_or_else(cut)?;
        match (&head[..4], head[4]) {
            (b"FRAM", kind) => {
                let frame = number(at + 8).ok_or_else(cut)?;
                // The state of the last frame may follow the hash of that frame. Both chunks contain the same hash.
                out.insert(frame, number(at + 32).ok_or_else(cut)?);
                // Several frames without a state may share a chunk. Its payload contains the hashes of all of them except the first.
                if kind == 4 {
                    let others = payload.as_chunks().0.iter().map(|hash| u64::from_le_bytes(*hash));
                    out.extend((frame + 1..).zip(others));
                }
            }
            (b"INPT", _) => {}
            (b"INDX", _) => return Ok(out),
            _ => return Err(format!("the recording has no chunk at byte {at}")),
        }
        at += CHUNK + length;
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::{BTreeMap, hashes};
    use crate::workspace;

    fn of(name: &str) -> BTreeMap<u64, u64> {
        let path = workspace::root().expect("a root").join("fuzz/corpus/recording").join(name);
        hashes(&std::fs::read(path).expect("a recording")).expect("hashes")
    }

    #[test]
    fn a_run_has_the_same_hashes_however_it_was_recorded() {
        let every = of("every-state");
        assert_eq!(every.keys().copied().collect::<Vec<_>>(), (0..8).collect::<Vec<_>>());
        assert_eq!([every[&0], every[&3]], [0xf8ad_f087_caa5_47bb, 0xfe6e_7f36_499f_621b]);
        // This recording contains frames without states, several in a chunk, and the state of the last frame after its hash.
        assert_eq!(of("one-in-three"), every);
        let killed = of("killed");
        assert!(killed.len() == 6 && killed.iter().all(|(frame, hash)| every[frame] == *hash));
    }

    #[test]
    fn other_files_and_versions_are_refused() {
        assert!(hashes(b"OPR").is_err() && hashes(b"OPRREC\x1a\n\x07\0\0\0\0\0\0\0\0\0\0\0").is_err());
    }
}
