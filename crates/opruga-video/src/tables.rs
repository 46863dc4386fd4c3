//! The codes of levels and runs (H.264, tables 9-5 and 9-7 to 9-10), as lengths and values.

/// A code: its number of bits, and its value.
pub(crate) type Code = (u8, u8);

/// Combines a table of lengths and a table of values.
const fn join<const N: usize>(lengths: [u8; N], values: [u8; N]) -> [Code; N] {
    let mut codes = [(0, 0); N];
    let mut index = 0;
    while index < N {
        codes[index] = (lengths[index], values[index]);
        index += 1;
    }
    codes
}

/// Codes of the number of levels, by the number of trailing ones. The three tables are for neighbours with few, some and many levels.
pub(crate) const COUNTS: [[[Code; 17]; 4]; 3] = [
    [
        join(
            [1, 6, 8, 9, 10, 11, 13, 13, 13, 14, 14, 15, 15, 16, 16, 16, 16],
            [1, 5, 7, 7, 7, 7, 15, 11, 8, 15, 11, 15, 11, 15, 11, 7, 4],
        ),
        join(
            [0, 2, 6, 8, 9, 10, 11, 13, 13, 14, 14, 15, 15, 15, 16, 16, 16],
            [0, 1, 4, 6, 6, 6, 6, 14, 10, 14, 10, 14, 10, 1, 14, 10, 6],
        ),
        join(
            [0, 0, 3, 7, 8, 9, 10, 11, 13, 13, 14, 14, 15, 15, 16, 16, 16],
            [0, 0, 1, 5, 5, 5, 5, 5, 13, 9, 13, 9, 13, 9, 13, 9, 5],
        ),
        join(
            [0, 0, 0, 5, 6, 7, 8, 9, 10, 11, 13, 14, 14, 15, 15, 16, 16],
            [0, 0, 0, 3, 3, 4, 4, 4, 4, 4, 12, 12, 8, 12, 8, 12, 8],
        ),
    ],
    [
        join(
            [2, 6, 6, 7, 8, 8, 9, 11, 11, 12, 12, 12, 13, 13, 13, 14, 14],
            [3, 11, 7, 7, 7, 4, 7, 15, 11, 15, 11, 8, 15, 11, 7, 9, 7],
        ),
        join(
            [0, 2, 5, 6, 6, 7, 8, 9, 11, 11, 12, 12, 13, 13, 14, 14, 14],
            [0, 2, 7, 10, 6, 6, 6, 6, 14, 10, 14, 10, 14, 10, 11, 8, 6],
        ),
        join(
            [0, 0, 3, 6, 6, 7, 8, 9, 11, 11, 12, 12, 13, 13, 13, 14, 14],
            [0, 0, 3, 9, 5, 5, 5, 5, 13, 9, 13, 9, 13, 9, 6, 10, 5],
        ),
        join(
            [0, 0, 0, 4, 4, 5, 6, 6, 7, 9, 11, 11, 12, 13, 13, 13, 14],
            [0, 0, 0, 5, 4, 6, 8, 4, 4, 4, 12, 8, 12, 12, 8, 1, 4],
        ),
    ],
    [
        join(
            [4, 6, 6, 6, 7, 7, 7, 7, 8, 8, 9, 9, 9, 10, 10, 10, 10],
            [15, 15, 11, 8, 15, 11, 9, 8, 15, 11, 15, 11, 8, 13, 9, 5, 1],
        ),
        join(
            [0, 4, 5, 5, 5, 5, 6, 6, 7, 8, 8, 9, 9, 9, 10, 10, 10],
            [0, 14, 15, 12, 10, 8, 14, 10, 14, 14, 10, 14, 10, 7, 12, 8, 4],
        ),
        join(
            [0, 0, 4, 5, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10, 10],
            [0, 0, 13, 14, 11, 9, 13, 9, 13, 10, 13, 9, 13, 9, 11, 7, 3],
        ),
        join(
            [0, 0, 0, 4, 4, 4, 4, 4, 5, 6, 7, 8, 8, 9, 10, 10, 10],
            [0, 0, 0, 12, 11, 10, 9, 8, 13, 12, 12, 12, 8, 12, 10, 6, 2],
        ),
    ],
];

/// Codes of the number of chroma DC levels, by the number of trailing ones.
pub(crate) const SUM_COUNTS: [[Code; 5]; 4] = [
    join([2, 6, 6, 6, 6], [1, 7, 4, 3, 2]),
    join([0, 1, 6, 7, 8], [0, 1, 6, 3, 3]),
    join([0, 0, 3, 7, 8], [0, 0, 1, 2, 2]),
    join([0, 0, 0, 6, 7], [0, 0, 0, 5, 0]),
];

/// Codes of the number of zeros before the last level, by the number of levels.
pub(crate) const ZEROS: [&[Code]; 15] = [
    &join([1, 3, 3, 4, 4, 5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 9], [1, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 3, 2, 1]),
    &join([3, 3, 3, 3, 3, 4, 4, 4, 4, 5, 5, 6, 6, 6, 6], [7, 6, 5, 4, 3, 5, 4, 3, 2, 3, 2, 3, 2, 1, 0]),
    &join([4, 3, 3, 3, 4, 4, 3, 3, 4, 5, 5, 6, 5, 6], [5, 7, 6, 5, 4, 3, 4, 3, 2, 3, 2, 1, 1, 0]),
    &join([5, 3, 4, 4, 3, 3, 3, 4, 3, 4, 5, 5, 5], [3, 7, 5, 4, 6, 5, 4, 3, 3, 2, 2, 1, 0]),
    &join([4, 4, 4, 3, 3, 3, 3, 3, 4, 5, 4, 5], [5, 4, 3, 7, 6, 5, 4, 3, 2, 1, 1, 0]),
    &join([6, 5, 3, 3, 3, 3, 3, 3, 4, 3, 6], [1, 1, 7, 6, 5, 4, 3, 2, 1, 1, 0]),
    &join([6, 5, 3, 3, 3, 2, 3, 4, 3, 6], [1, 1, 5, 4, 3, 3, 2, 1, 1, 0]),
    &join([6, 4, 5, 3, 2, 2, 3, 3, 6], [1, 1, 1, 3, 3, 2, 2, 1, 0]),
    &join([6, 6, 4, 2, 2, 3, 2, 5], [1, 0, 1, 3, 2, 1, 1, 1]),
    &join([5, 5, 3, 2, 2, 2, 4], [1, 0, 1, 3, 2, 1, 1]),
    &join([4, 4, 3, 3, 1, 3], [0, 1, 1, 2, 1, 3]),
    &join([4, 4, 2, 1, 3], [0, 1, 1, 1, 1]),
    &join([3, 3, 1, 2], [0, 1, 1, 1]),
    &join([2, 2, 1], [0, 1, 1]),
    &join([1, 1], [0, 1]),
];

/// Codes of the number of zeros before the last chroma DC level, by the number of levels.
pub(crate) const SUM_ZEROS: [&[Code]; 3] =
    [&join([1, 2, 3, 3], [1, 1, 1, 0]), &join([1, 2, 2], [1, 1, 0]), &join([1, 1], [1, 0])];

/// Codes of the number of zeros before a level, by the number of remaining zeros.
pub(crate) const RUNS: [&[Code]; 7] = [
    &join([1, 1], [1, 0]),
    &join([1, 2, 2], [1, 1, 0]),
    &join([2, 2, 2, 2], [3, 2, 1, 0]),
    &join([2, 2, 2, 3, 3], [3, 2, 1, 1, 0]),
    &join([2, 2, 3, 3, 3, 3], [3, 2, 3, 2, 1, 0]),
    &join([2, 3, 3, 3, 3, 3, 3], [3, 0, 1, 3, 2, 5, 4]),
    &join([3, 3, 3, 3, 3, 3, 3, 4, 5, 6, 7, 8, 9, 10, 11], [7, 6, 5, 4, 3, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1]),
];

/// The numbers of the patterns of coded quarters in predicted macroblocks (table 9-4): 16 × chroma + luma.
pub(crate) const PATTERNS: [u8; 48] = [
    0, 2, 3, 7, 4, 8, 17, 13, 5, 18, 9, 14, 10, 15, 16, 11, 1, 32, 33, 36, 34, 37, 44, 40, 35, 45, 38, 41, 39, 42, 43,
    19, 6, 24, 25, 20, 26, 21, 46, 28, 27, 47, 22, 29, 23, 30, 31, 12,
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether no code is a prefix of another.
    fn is_prefix_free(codes: &[Code]) -> bool {
        let codes: Vec<Code> = codes.iter().copied().filter(|code| code.0 > 0).collect();
        let begins = |a: Code, b: Code| a.0 <= b.0 && u32::from(b.1) >> (b.0 - a.0) == u32::from(a.1);
        (0..codes.len()).all(|i| (0..codes.len()).all(|j| i == j || !begins(codes[i], codes[j])))
    }

    #[test]
    fn codes_can_be_told_apart() {
        for table in COUNTS {
            assert!(is_prefix_free(table.as_flattened()));
        }
        assert!(is_prefix_free(SUM_COUNTS.as_flattened()));
        for table in ZEROS.iter().chain(&SUM_ZEROS).chain(&RUNS) {
            assert!(is_prefix_free(table));
        }
        let mut patterns = PATTERNS;
        patterns.sort_unstable();
        assert!(patterns.iter().enumerate().all(|(index, number)| index == usize::from(*number)));
    }
}
