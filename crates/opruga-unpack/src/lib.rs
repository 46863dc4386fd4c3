//! Unpacks the program of the studio's web page. Browsers unpack gzip by themselves, but files packed by LZMA are three tenths smaller. This is a
//! separate module because it must run before the studio has been loaded.

use lzma_rust2::LzmaReader;
use std::io::Read;
#[cfg(target_arch = "wasm32")]
use wasm_bindgen::prelude::wasm_bindgen;

/// The largest memory that a file may ask for [KiB]: four times what `cargo xtask web` uses.
const MOST_MEMORY: u32 = 64 << 10;

/// Returns the content of a file in the format of `lzma_alone` that states its length.
///
/// # Errors
/// The file is damaged, is truncated, or asks for more than 64 MiB.
#[cfg_attr(target_arch = "wasm32", wasm_bindgen)]
pub fn unpack(packed: &[u8]) -> Result<Vec<u8>, String> {
    let failed = |error: std::io::Error| format!("the packed program is damaged: {error}");
    // The length follows the byte of the properties and the size of the dictionary.
    let stated = packed.get(5..13).and_then(|bytes| bytes.try_into().ok()).map(u64::from_le_bytes);
    let mut reader = LzmaReader::new_mem_limit(packed, MOST_MEMORY, None).map_err(failed)?;
    let mut content = Vec::new();
    reader.read_to_end(&mut content).map_err(failed)?;
    if stated != Some(content.len() as u64) {
        return Err(format!("the packed program is damaged: it ends after {} bytes", content.len()));
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::unpack;
    use lzma_rust2::{LzmaOptions, LzmaWriter};
    use std::io::Write;

    fn packed(content: &[u8]) -> Vec<u8> {
        let options = LzmaOptions::with_preset(6);
        let mut writer = LzmaWriter::new_use_header(Vec::new(), &options, Some(content.len() as u64)).expect("options");
        writer.write_all(content).expect("memory takes all");
        writer.finish().expect("memory takes all")
    }

    fn content() -> Vec<u8> {
        let mut state = 1_u32;
        let mut letter = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 28) as u8
        };
        (0..100_000).map(|_| letter()).collect()
    }

    #[test]
    fn what_was_packed_comes_back() {
        for content in [content(), vec![7; 100_000], vec![1]] {
            assert_eq!(unpack(&packed(&content)).as_ref(), Ok(&content));
        }
    }

    #[test]
    fn a_file_that_is_cut_short_or_asks_for_too_much_is_refused() {
        let whole = packed(&content());
        for length in [0, 4, 12, 13, 20, whole.len() / 2, whole.len() - 9] {
            assert!(unpack(&whole[..length]).is_err(), "{length} of {} bytes", whole.len());
        }
        let mut large = whole;
        large[1..5].copy_from_slice(&(1_u32 << 30).to_le_bytes());
        assert!(unpack(&large).is_err());
    }
}
