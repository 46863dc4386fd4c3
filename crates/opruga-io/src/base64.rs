//! Base64 (RFC 4648): bytes as letters.

const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

fn value(letter: u8) -> Option<u8> {
    Some(match letter {
        b'A'..=b'Z' => letter - b'A',
        b'a'..=b'z' => letter - b'a' + 26,
        b'0'..=b'9' => letter - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    })
}

/// Decodes letters to bytes; none if one of them does not belong to Base64. Any group of four may be padded with `=`, as when several texts follow
/// one another.
pub fn decode(letters: &[u8]) -> Option<Vec<u8>> {
    decode_up_to(letters, usize::MAX).map(|found| found.0)
}

/// Decodes letters from the beginning until there are at least `most` bytes, or until the letters end. Also returns the number of letters read.
pub(crate) fn decode_up_to(letters: &[u8], most: usize) -> Option<(Vec<u8>, usize)> {
    let mut out = Vec::with_capacity(usize::min(most.saturating_add(3), letters.len() / 4 * 3 + 3));
    let mut taken = 0;
    for group in letters.chunks(4) {
        if out.len() >= most {
            break;
        }
        taken += group.len();
        let filled = group.iter().rev().take_while(|letter| **letter == b'=').count();
        let own = &group[..group.len() - filled];
        // A single letter does not hold a whole byte. Only the last group may be incomplete.
        if own.len() < 2 || (group.len() < 4 && taken < letters.len()) {
            return None;
        }
        let mut bits = 0u32;
        for letter in own {
            bits = bits << 6 | u32::from(value(*letter)?);
        }
        bits <<= 6 * (4 - own.len());
        out.extend_from_slice(&bits.to_be_bytes()[1..own.len()]);
    }
    Some((out, taken))
}

/// Encodes bytes as letters.
pub fn encode(bytes: &[u8]) -> String {
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let mut word = [0; 4];
        word[1..=group.len()].copy_from_slice(group);
        let bits = u32::from_be_bytes(word);
        for place in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * place) & 63) as usize];
            out.push(if place <= group.len() { char::from(letter) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn known_texts() {
        for (plain, coded) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(encode(plain.as_bytes()), coded);
            assert_eq!(decode(coded.as_bytes()).as_deref(), Some(plain.as_bytes()));
            assert_eq!(decode(coded.trim_end_matches('=').as_bytes()).as_deref(), Some(plain.as_bytes()));
        }
        assert_eq!(decode(b"Zg==Zm8=").as_deref(), Some(&b"ffo"[..]), "texts that follow one another");
        assert_eq!(decode_up_to(b"Zm9vYmFy", 2), Some((b"foo".to_vec(), 4)));
        for wrong in ["Z", "Zm9v!", "Zg==Z", "====", "Z==="] {
            assert_eq!(decode(wrong.as_bytes()), None, "{wrong}");
        }
    }
}
