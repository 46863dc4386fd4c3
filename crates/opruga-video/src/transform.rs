//! The transform of four by four numbers, its quantiser, and the inverses of both (H.264, clause 8.5).

/// Four by four numbers, row by row.
pub(crate) type Block = [i32; 16];

/// The indices of the numbers of a block, in the order in which they are coded.
pub(crate) const ZIGZAG: [usize; 16] = [0, 1, 4, 8, 5, 2, 3, 6, 9, 12, 13, 10, 7, 11, 14, 15];

/// The largest level. Larger levels have no code in this profile.
const LARGEST: i32 = 2063;

/// The multipliers of the quantiser: for numbers whose row and column are both even, for those whose row and column are both odd, and for all others.
const SCALES: [[i32; 3]; 6] = [
    [13107, 5243, 8066],
    [11916, 4660, 7490],
    [10082, 4194, 6554],
    [9362, 3647, 5825],
    [8192, 3355, 5243],
    [7282, 2893, 4559],
];

/// The multipliers of the inverse, in the same order.
const STEPS: [[i32; 3]; 6] = [[10, 16, 13], [11, 18, 14], [13, 20, 16], [14, 23, 18], [16, 25, 20], [18, 29, 23]];

/// The chroma quantiser that belongs to a luma quantiser.
pub(crate) fn chroma_quantiser(quantiser: u8) -> u8 {
    const ABOVE_29: [u8; 22] = [29, 30, 31, 32, 32, 33, 34, 34, 35, 35, 36, 36, 37, 37, 37, 38, 38, 38, 39, 39, 39, 39];
    if quantiser < 30 { quantiser } else { ABOVE_29[usize::from(quantiser) - 30] }
}

/// One quantiser, from 0 (fine) to 51 (coarse).
#[derive(Clone, Debug)]
pub(crate) struct Quantiser {
    scales: Block,
    steps: Block,
    /// The value that is added before rounding down, for a block.
    round: i32,
    shift: u32,
}

impl Quantiser {
    /// A quantiser whose rounding offset is 1/`share` of a step; `share` is 3 or 6.
    pub(crate) fn new(quantiser: u8, share: i32) -> Quantiser {
        let class = |index: usize| match (index / 4 % 2, index % 4 % 2) {
            (0, 0) => 0,
            (1, 1) => 1,
            _ => 2,
        };
        let (rest, sixth) = (usize::from(quantiser % 6), u32::from(quantiser / 6));
        let shift = 15 + sixth;
        Quantiser {
            scales: std::array::from_fn(|index| SCALES[rest][class(index)]),
            steps: std::array::from_fn(|index| STEPS[rest][class(index)] << sixth),
            round: (1 << shift) / share,
            shift,
        }
    }

    /// Replaces numbers by levels, starting at the index `first`. Returns whether any level is nonzero.
    pub(crate) fn quantise(&self, block: &mut Block, first: usize) -> bool {
        let mut any = 0;
        for index in first..16 {
            let level = (block[index].abs() * self.scales[index] + self.round) >> self.shift;
            let level = level.min(LARGEST);
            any |= level;
            block[index] = if block[index] < 0 { -level } else { level };
        }
        any != 0
    }

    /// Replaces DC values by levels. Returns whether any level is nonzero.
    pub(crate) fn quantise_sums(&self, sums: &mut [i32]) -> bool {
        let mut any = 0;
        for sum in sums {
            let level = (sum.abs() * self.scales[0] + 2 * self.round) >> (self.shift + 1);
            let level = level.min(LARGEST);
            any |= level;
            *sum = if *sum < 0 { -level } else { level };
        }
        any != 0
    }

    /// Replaces levels by numbers, starting at the index `first`.
    pub(crate) fn restore(&self, block: &mut Block, first: usize) {
        for index in first..16 {
            block[index] *= self.steps[index];
        }
    }

    /// Replaces the sixteen quantised DC levels by the first coefficients of the sixteen blocks.
    pub(crate) fn restore_sixteen(&self, sums: &mut Block) {
        hadamard(sums);
        for sum in sums.iter_mut() {
            // The steps already include the shift by a sixth of the quantiser.
            *sum = (*sum * self.steps[0] + 2) >> 2;
        }
    }

    /// Replaces the four quantised DC levels by the first coefficients of the four blocks.
    pub(crate) fn restore_four(&self, sums: &mut [i32; 4]) {
        hadamard_four(sums);
        for sum in sums.iter_mut() {
            *sum = (*sum * self.steps[0]) >> 1;
        }
    }
}

/// Transforms differences of pixels to coefficients of frequencies.
pub(crate) fn forward(block: &mut Block) {
    for (start, step) in [(4, 1), (1, 4)] {
        for line in 0..4 {
            let at = |index: usize| line * start + index * step;
            let [a, b, c, d] = [block[at(0)], block[at(1)], block[at(2)], block[at(3)]];
            let (outer, inner) = (a + d, b + c);
            let (far, near) = (a - d, b - c);
            block[at(0)] = outer + inner;
            block[at(1)] = 2 * far + near;
            block[at(2)] = outer - inner;
            block[at(3)] = far - 2 * near;
        }
    }
}

/// Transforms restored coefficients to differences, and adds these to pixels.
pub(crate) fn add_inverse(block: &Block, pixels: &mut [u8], stride: usize) {
    let mut work = *block;
    for (start, step) in [(4, 1), (1, 4)] {
        for line in 0..4 {
            let at = |index: usize| line * start + index * step;
            let [a, b, c, d] = [work[at(0)], work[at(1)], work[at(2)], work[at(3)]];
            let (even, odd) = (a + c, a - c);
            let (low, high) = ((b >> 1) - d, b + (d >> 1));
            work[at(0)] = even + high;
            work[at(1)] = odd + low;
            work[at(2)] = odd - low;
            work[at(3)] = even - high;
        }
    }
    for row in 0..4 {
        for (pixel, value) in pixels[row * stride..row * stride + 4].iter_mut().zip(&work[4 * row..]) {
            *pixel = (i32::from(*pixel) + ((value + 32) >> 6)).clamp(0, 255) as u8;
        }
    }
}

/// Replaces sixteen numbers by sums and differences of them (the Hadamard transform).
pub(crate) fn hadamard(block: &mut Block) {
    for (start, step) in [(4, 1), (1, 4)] {
        for line in 0..4 {
            let at = |index: usize| line * start + index * step;
            let [a, b, c, d] = [block[at(0)], block[at(1)], block[at(2)], block[at(3)]];
            block[at(0)] = a + b + c + d;
            block[at(1)] = a + b - c - d;
            block[at(2)] = a - b - c + d;
            block[at(3)] = a - b + c - d;
        }
    }
}

/// Replaces four numbers by sums and differences of them (the Hadamard transform).
pub(crate) fn hadamard_four([a, b, c, d]: &mut [i32; 4]) {
    [*a, *b, *c, *d] = [*a + *b + *c + *d, *a - *b + *c - *d, *a + *b - *c - *d, *a - *b - *c + *d];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_transformed_comes_back_within_half_a_step() {
        let mut state = 1_u32;
        for quantiser in [0, 12, 22, 30] {
            let rule = Quantiser::new(quantiser, 2);
            for _ in 0..200 {
                let mut block: Block = std::array::from_fn(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (state >> 24) as i32 - 128
                });
                let wanted = block;
                forward(&mut block);
                rule.quantise(&mut block, 0);
                rule.restore(&mut block, 0);
                let mut pixels = [128; 16];
                add_inverse(&block, &mut pixels, 4);
                // The step of quantiser 0 is 0.625. The step doubles whenever the number of the quantiser grows by six.
                let step = 0.625 * (f64::from(quantiser) / 6.0).exp2();
                let square: f64 = (0..16).map(|p| f64::from(i32::from(pixels[p]) - 128 - wanted[p]).powi(2)).sum();
                assert!((square / 16.0).sqrt() < 0.5 * step + 0.5, "{quantiser}: {square}");
            }
        }
    }

    #[test]
    fn sums_come_back() {
        let rule = Quantiser::new(12, 3);
        let wanted: Block = std::array::from_fn(|index| 64 * (index as i32 * 37 % 101 - 50));
        let mut sums = wanted;
        hadamard(&mut sums);
        sums.iter_mut().for_each(|sum| *sum = (*sum + 1) >> 1);
        rule.quantise_sums(&mut sums);
        rule.restore_sixteen(&mut sums);
        // The inverse expects DC values four times as large as those of the forward transform: 16 pixels, each divided by 64.
        assert!(sums.iter().zip(&wanted).all(|(a, b)| (a - 4 * b).abs() < 100), "{sums:?} {wanted:?}");
        let wanted = [640, -320, 64, 0];
        let mut sums = wanted;
        hadamard_four(&mut sums);
        rule.quantise_sums(&mut sums);
        rule.restore_four(&mut sums);
        assert!(sums.iter().zip(&wanted).all(|(a, b)| (a - 4 * b).abs() < 100), "{sums:?} {wanted:?}");
    }
}
