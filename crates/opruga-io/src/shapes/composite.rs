//! The amount of data that a letter of a TrueType font draws. Composite letters consist of other letters, which may themselves be composite.
//!
//! # Source
//! Microsoft, OpenType Specification 1.9, tables `glyf` and `loca`.

use crate::budget::EXPANSION;
use std::collections::BTreeMap;
use ttf_parser::{Face, GlyphId, Tag};

/// The deepest nesting of letters that the font library follows.
const DEEPEST: u8 = 32;

/// The total size [bytes] of the letters that a letter consists of, each counted as often as it is drawn; 0 for fonts of another format. Counting
/// stops above the limit.
pub(super) fn bytes(face: &Face<'_>, glyph: GlyphId) -> u64 {
    let table = |name| face.raw_face().table(Tag::from_bytes(name));
    let (Some(glyf), Some(loca)) = (table(b"glyf"), table(b"loca")) else { return 0 };
    let long = face.tables().head.index_to_location_format == ttf_parser::head::IndexToLocationFormat::Long;
    Letters { glyf, loca, long, known: BTreeMap::new() }.bytes(glyph.0, 0)
}

struct Letters<'a> {
    glyf: &'a [u8],
    loca: &'a [u8],
    long: bool,
    /// The sizes that are already known, by letter and depth [bytes].
    known: BTreeMap<(u16, u8), u64>,
}

impl<'a> Letters<'a> {
    fn data(&self, glyph: u16) -> Option<&'a [u8]> {
        let at = |k: usize| {
            if self.long {
                let word = self.loca.get(4 * k..)?.first_chunk::<4>()?;
                Some(u32::from_be_bytes(*word) as usize)
            } else {
                let word = self.loca.get(2 * k..)?.first_chunk::<2>()?;
                Some(2 * usize::from(u16::from_be_bytes(*word)))
            }
        };
        self.glyf.get(at(usize::from(glyph))?..at(usize::from(glyph) + 1)?)
    }

    fn bytes(&mut self, glyph: u16, depth: u8) -> u64 {
        let Some(data) = self.data(glyph).filter(|_| depth < DEEPEST) else { return 0 };
        if let Some(known) = self.known.get(&(glyph, depth)) {
            return *known;
        }
        let mut total = data.len() as u64;
        for part in parts(data) {
            if total > EXPANSION.most {
                break;
            }
            total = total.saturating_add(self.bytes(part, depth + 1));
        }
        self.known.insert((glyph, depth), total);
        total
    }
}

/// The letters that a composite letter names.
fn parts(data: &[u8]) -> Vec<u16> {
    let word =
        |at: usize| data.get(at..).and_then(|rest| rest.first_chunk::<2>()).map(|word| u16::from_be_bytes(*word));
    let mut found = Vec::new();
    // A composite letter begins with a negative number of contours, followed by a box and the parts.
    if word(0).is_none_or(|contours| contours < 0x8000) {
        return found;
    }
    let mut at = 10;
    while let (Some(flags), Some(glyph)) = (word(at), word(at + 2)) {
        found.push(glyph);
        let offsets = if flags & 0x0001 != 0 { 4 } else { 2 };
        let scale = match flags {
            _ if flags & 0x0008 != 0 => 2,
            _ if flags & 0x0040 != 0 => 4,
            _ if flags & 0x0080 != 0 => 8,
            _ => 0,
        };
        at += 4 + offsets + scale;
        if flags & 0x0020 == 0 {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::Letters;
    use std::collections::BTreeMap;

    /// A letter made of two letters, each made of two letters, and so on: the first of a chain of 40.
    #[test]
    fn letters_of_letters_are_counted_and_not_drawn() {
        let (mut glyf, mut loca) = (Vec::new(), vec![0u8; 4]);
        for glyph in 0..40u16 {
            let mut data = vec![0xff, 0xff, 0, 0, 0, 0, 0, 0, 0, 0];
            for more in [0x20u8, 0] {
                data.extend([0, more]);
                data.extend((glyph + 1).to_be_bytes());
                data.extend([0, 0]);
            }
            glyf.extend(data);
            loca.extend((glyf.len() as u32).to_be_bytes());
        }
        let bytes = |glyph| Letters { glyf: &glyf, loca: &loca, long: true, known: BTreeMap::new() }.bytes(glyph, 0);
        assert_eq!([bytes(39), bytes(38), bytes(37)], [22, 3 * 22, 7 * 22]);
        assert!(bytes(0) > crate::budget::EXPANSION.most);
    }
}
