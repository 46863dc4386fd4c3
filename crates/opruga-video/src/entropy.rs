//! Encoding of levels: CAVLC (H.264, clause 9.2).

use super::bits::Bits;
use super::tables::{COUNTS, RUNS, SUM_COUNTS, SUM_ZEROS, ZEROS};

/// The choice of the code for the number of levels of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Context {
    /// The code for a block whose neighbours have this number of levels on average.
    Near(u8),
    /// The code for the chroma DC levels.
    Sums,
}

/// Writes up to 16 levels, from the lowest frequency to the highest; returns the number of nonzero levels.
pub(crate) fn write_levels(bits: &mut Bits, levels: &[i32], context: Context) -> u8 {
    let mut found = [(0, 0); 16];
    let mut total = 0;
    for (position, &level) in levels.iter().enumerate() {
        if level != 0 {
            found[total] = (position, level);
            total += 1;
        }
    }
    let found = &found[..total];
    let ones = found.iter().rev().take(3).take_while(|(_, level)| level.abs() == 1).count();
    let (length, value) = match context {
        Context::Sums => SUM_COUNTS[ones][total],
        Context::Near(0..2) => COUNTS[0][ones][total],
        Context::Near(2..4) => COUNTS[1][ones][total],
        Context::Near(4..8) => COUNTS[2][ones][total],
        Context::Near(_) if total == 0 => (6, 3),
        Context::Near(_) => (6, (total as u8 - 1) << 2 | ones as u8),
    };
    bits.put(u32::from(value), u32::from(length));
    let Some(&(last, _)) = found.last() else { return 0 };
    for (_, level) in found.iter().rev().take(ones) {
        bits.flag(*level < 0);
    }
    let mut suffix = u32::from(total > 10 && ones < 3);
    for (index, &(_, level)) in found.iter().rev().enumerate().skip(ones) {
        // If there are fewer than three trailing ones, the first other level is larger than one.
        let smaller = i32::from(index == ones && ones < 3);
        let code = (2 * (level.abs() - smaller) - 1 - i32::from(level > 0)) as u32;
        write_level(bits, code, suffix);
        suffix = suffix.max(1);
        if level.abs() > 3 << (suffix - 1) && suffix < 6 {
            suffix += 1;
        }
    }
    let mut zeros = last + 1 - total;
    if total < levels.len() {
        let tables: &[&[_]] = if context == Context::Sums { &SUM_ZEROS } else { &ZEROS };
        let (length, value) = tables[total - 1][zeros];
        bits.put(u32::from(value), u32::from(length));
    }
    for pair in found.windows(2).rev() {
        if zeros == 0 {
            break;
        }
        let run = pair[1].0 - pair[0].0 - 1;
        let (length, value) = RUNS[zeros.min(7) - 1][run];
        bits.put(u32::from(value), u32::from(length));
        zeros -= run;
    }
    total as u8
}

/// Writes the code of a level: zeros, a one, and a remainder.
fn write_level(bits: &mut Bits, code: u32, suffix: u32) {
    let (prefix, rest, length) = match suffix {
        0 if code < 14 => (code, 0, 0),
        0 if code < 30 => (14, code - 14, 4),
        0 => (15, code - 30, 12),
        _ if code < 15 << suffix => (code >> suffix, code & ((1 << suffix) - 1), suffix),
        _ => (15, code - (15 << suffix), 12),
    };
    bits.put(1, prefix + 1);
    bits.put(rest, length);
}
