//! Bits, Exp-Golomb codes, and the units of a stream (H.264, clauses 7.2, 7.3.1 and 9.1).

/// Bits in the order in which they were written.
#[derive(Debug, Default)]
pub(crate) struct Bits {
    /// The complete bytes.
    bytes: Vec<u8>,
    /// The bits that do not fill a byte yet. The latest bit is the lowest one.
    rest: u64,
    /// The number of these bits, below 8 between two calls.
    count: u32,
}

impl Bits {
    /// Writes the lowest `count` bits of a value, the highest of them first; at most 32.
    #[inline]
    pub(crate) fn put(&mut self, value: u32, count: u32) {
        debug_assert!(count <= 32 && (count == 32 || value >> count == 0));
        self.rest = self.rest << count | u64::from(value);
        self.count += count;
        while self.count >= 8 {
            self.count -= 8;
            self.bytes.push((self.rest >> self.count) as u8);
        }
    }

    /// Writes one bit.
    pub(crate) fn flag(&mut self, value: bool) {
        self.put(u32::from(value), 1);
    }

    /// Writes a number in the unsigned Exp-Golomb code, `ue(v)`.
    pub(crate) fn ue(&mut self, value: u32) {
        debug_assert!(value < u32::MAX);
        let code = value + 1;
        let length = 32 - code.leading_zeros();
        self.put(0, length - 1);
        self.put(code, length);
    }

    /// Writes a number in the signed Exp-Golomb code, `se(v)`.
    pub(crate) fn se(&mut self, value: i32) {
        let doubled = 2 * value.unsigned_abs();
        self.ue(if value > 0 { doubled - 1 } else { doubled });
    }

    /// Ends the unit with a one, followed by zeros up to the next byte boundary.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.flag(true);
        if self.count > 0 {
            self.put(0, 8 - self.count);
        }
        self.bytes
    }
}

/// The number of bits of a number in the signed Exp-Golomb code.
pub(crate) fn se_bits(value: i32) -> u32 {
    let code = 2 * value.unsigned_abs() + u32::from(value <= 0);
    2 * (32 - code.leading_zeros()) - 1
}

/// The kinds of units that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unit {
    /// A picture that depends on the previous one.
    Slice = 0x61,
    /// A picture that does not depend on others.
    Refresh = 0x65,
    /// Parameters of the whole stream.
    Sequence = 0x67,
    /// The parameters of the pictures of a stream.
    Picture = 0x68,
}

/// Packs a unit: its header, and its bytes, with a 3 inserted wherever bytes could be mistaken for the start of a unit.
pub(crate) fn pack(unit: Unit, bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len() + bytes.len() / 64 + 1);
    out.push(unit as u8);
    let mut zeros = 0;
    for &byte in bytes {
        if zeros >= 2 && byte <= 3 {
            out.push(3);
            zeros = 0;
        }
        zeros = if byte == 0 { zeros + 1 } else { 0 };
        out.push(byte);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_golomb_numbers_have_their_published_codes() {
        let written = |put: &dyn Fn(&mut Bits)| {
            let mut bits = Bits::default();
            put(&mut bits);
            bits.finish()
        };
        // 0 → 1, 1 → 010, 2 → 011, 3 → 00100.
        assert_eq!(written(&|b| (0..4).for_each(|n| b.ue(n))), vec![0b1010_0110, 0b0100_1000]);
        // 1 → 010, -1 → 011, 2 → 00100, -2 → 00101.
        assert_eq!(written(&|b| [1, -1, 2, -2].into_iter().for_each(|n| b.se(n))), vec![0b0100_1100, 0b1000_0101, 128]);
        for value in -40..40 {
            let mut bits = Bits::default();
            bits.se(value);
            assert_eq!(bits.bytes.len() as u32 * 8 + bits.count, se_bits(value));
        }
    }

    #[test]
    fn no_start_code_is_left_within_a_unit() {
        assert_eq!(pack(Unit::Slice, &[0, 0, 0, 0, 0, 1]), vec![0x61, 0, 0, 3, 0, 0, 3, 0, 1]);
        assert_eq!(pack(Unit::Slice, &[0, 0, 4]), vec![0x61, 0, 0, 4]);
    }
}
