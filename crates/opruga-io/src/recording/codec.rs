//! Encodes states as differences from the previous state. Every eight bytes are treated as a whole number, and the upper bytes of its difference are
//! omitted if they are zero.
//!
//! Neighbouring frames differ little, so the upper bytes of a difference are mostly zero. The lower bytes are practically random, so a general
//! compressor would gain nothing and would take ten times as long.

/// Appends the code of a state: the number of bytes of the difference of every word (four bits each), then these bytes, and then the bytes after the
/// last whole word. `before` has the same length or is empty; if it is empty, the words themselves are encoded.
pub(super) fn encode(state: &[u8], before: &[u8], out: &mut Vec<u8>) {
    let (words, rest) = state.as_chunks::<8>();
    let (old, _) = before.as_chunks::<8>();
    let mut counts = out.len();
    let mut at = counts + words.len().div_ceil(2);
    out.resize(at + state.len() + 8, 0);
    for (number, word) in words.iter().enumerate() {
        let old = old.get(number).map_or(0, |old| u64::from_le_bytes(*old));
        let difference = u64::from_le_bytes(*word).wrapping_sub(old) as i64;
        // The sign moves to the lowest bit, so that small differences of both signs have zeros in the upper bits.
        let folded = ((difference << 1) ^ (difference >> 63)) as u64;
        let count = 8 - folded.leading_zeros() as usize / 8;
        out[counts] |= (count as u8) << (4 * (number % 2));
        counts += number % 2;
        out[at..at + 8].copy_from_slice(&folded.to_le_bytes());
        at += count;
    }
    out.truncate(at);
    out.extend_from_slice(rest);
}

/// Decodes a state of `bytes` bytes; none if the code is not valid for that length.
pub(super) fn decode(code: &[u8], bytes: usize, before: &[u8]) -> Option<Vec<u8>> {
    let words = bytes / 8;
    let (counts, mut code) = code.split_at_checked(words.div_ceil(2))?;
    let (old, _) = before.as_chunks::<8>();
    let mut out = Vec::with_capacity(bytes);
    for number in 0..words {
        let count = usize::from(counts[number / 2] >> (4 * (number % 2)) & 15);
        let (used, rest) = code.split_at_checked(count)?;
        code = rest;
        let mut folded = [0; 8];
        folded.get_mut(..count)?.copy_from_slice(used);
        let folded = u64::from_le_bytes(folded);
        let difference = (folded >> 1) ^ (folded & 1).wrapping_neg();
        let old = old.get(number).map_or(0, |old| u64::from_le_bytes(*old));
        out.extend_from_slice(&old.wrapping_add(difference).to_le_bytes());
    }
    (code.len() == bytes % 8).then(|| {
        out.extend_from_slice(code);
        out
    })
}

#[cfg(test)]
mod tests {
    use super::{decode, encode};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_coded_is_decoded(pairs in proptest::collection::vec((any::<u8>(), any::<u8>()), 0..200), plain in any::<bool>()) {
            let state: Vec<u8> = pairs.iter().map(|p| p.0).collect();
            let before: Vec<u8> = if plain { Vec::new() } else { pairs.iter().map(|p| p.1).collect() };
            let mut code = vec![7];
            encode(&state, &before, &mut code);
            prop_assert_eq!(decode(&code[1..], state.len(), &before), Some(state.clone()));
            // One byte less or one byte more is refused.
            prop_assert_eq!(decode(&[&code[1..], &[0]].concat(), state.len(), &before), None);
            if !state.is_empty() {
                prop_assert_eq!(decode(&code[1..code.len() - 1], state.len(), &before), None);
            }
        }

        #[test]
        fn any_bytes_are_a_state_or_none(code in proptest::collection::vec(any::<u8>(), 0..60), bytes in 0..80usize) {
            if let Some(state) = decode(&code, bytes, &[]) {
                prop_assert_eq!(state.len(), bytes);
            }
        }
    }

    #[test]
    fn numbers_that_change_little_are_short() {
        let numbers = |shift: f64| -> Vec<u8> { (0..100).flat_map(|k| (f64::from(k) + shift).to_le_bytes()).collect() };
        let (before, same) = (numbers(0.25), numbers(0.25));
        let after = numbers(0.25 + 1e-9);
        let length = |state: &[u8]| {
            let mut code = Vec::new();
            encode(state, &before, &mut code);
            code.len()
        };
        assert_eq!(length(&same), 50);
        assert!(length(&after) < 500, "{}", length(&after));
    }
}
