//! The residual of a macroblock after prediction: its levels, and the pixels that are restored from them.

use super::bits::Bits;
use super::entropy::{Context, write_levels};
use super::frame::Frame;
use super::predict::Pixels;
use super::transform::{Block, Quantiser, ZIGZAG, add_inverse, chroma_quantiser, forward, hadamard, hadamard_four};

/// The quantisers of a film.
#[derive(Clone, Debug)]
pub(crate) struct Quantisers {
    /// The quantisers of luma and chroma for predictions from neighbours.
    alone: [Quantiser; 2],
    /// The quantisers of luma and chroma for predictions from the previous frame.
    moved: [Quantiser; 2],
}

impl Quantisers {
    /// The quantisers for a number from 12 (fine) to 51 (coarse).
    pub(crate) fn new(quantiser: u8) -> Quantisers {
        let both = |share| [quantiser, chroma_quantiser(quantiser)].map(|number| Quantiser::new(number, share));
        Quantisers { alone: both(3), moved: both(6) }
    }
}

/// The levels of a macroblock.
#[derive(Clone, Debug)]
pub(crate) struct Residual {
    /// Whether the luma DC values are encoded separately, as in predictions from neighbours.
    alone: bool,
    /// The sixteen luma DC values, if they are separate.
    sums: Block,
    /// The luma, in blocks of 4 × 4 pixels.
    luma: [Block; 16],
    /// The four DC values of both chroma planes.
    colour_sums: [[i32; 4]; 2],
    /// The chroma.
    colour: [[Block; 4]; 2],
    /// The quarters of the luma that have nonzero levels, one bit each.
    pub(crate) luma_coded: u32,
    /// How much of the chroma is encoded: 0 for nothing, 1 for only the DC values, 2 for everything.
    pub(crate) colour_coded: u32,
}

/// The number of levels of every block. The codes of neighbouring blocks depend on these numbers.
#[derive(Clone, Debug)]
pub(crate) struct Counts {
    /// The number of blocks in a row of each plane.
    wide: [usize; 3],
    planes: [Vec<u8>; 3],
}

impl Counts {
    /// All counts zero.
    pub(crate) fn new(wide: usize, high: usize) -> Counts {
        Counts { wide: [4 * wide, 2 * wide, 2 * wide], planes: [16, 4, 4].map(|blocks| vec![0; blocks * wide * high]) }
    }

    /// The context of a block.
    fn context(&self, plane: usize, [x, y]: [usize; 2]) -> Context {
        let at = |x: usize, y: usize| self.planes[plane][y * self.wide[plane] + x];
        Context::Near(match (x > 0, y > 0) {
            (true, true) => (at(x - 1, y) + at(x, y - 1)).div_ceil(2),
            (true, false) => at(x - 1, y),
            (false, true) => at(x, y - 1),
            (false, false) => 0,
        })
    }

    /// Stores the number of levels of a block.
    fn set(&mut self, plane: usize, [x, y]: [usize; 2], count: u8) {
        self.planes[plane][y * self.wide[plane] + x] = count;
    }

    /// Clears the counts of a macroblock.
    pub(crate) fn clear(&mut self, [x, y]: [usize; 2]) {
        for plane in 0..3 {
            let side = if plane == 0 { 4 } else { 2 };
            for row in 0..side {
                let start = (side * y + row) * self.wide[plane] + side * x;
                self.planes[plane][start..start + side].fill(0);
            }
        }
    }
}

/// The column and the row of a block in its macroblock, in the coding order of luma blocks.
fn luma_position(block: usize) -> [usize; 2] {
    [block & 1 | block >> 1 & 2, block >> 1 & 1 | block >> 2 & 2]
}

/// The transform of the difference between a block and its prediction.
fn differences(source: &Frame, plane: usize, start: usize, expected: &Pixels, [x, y]: [usize; 2]) -> Block {
    let (side, stride) = (Frame::side(plane), source.stride(plane));
    let mut block = [0; 16];
    for row in 0..4 {
        let pixels = &source.planes[plane][start + (4 * y + row) * stride + 4 * x..][..4];
        let expected = &expected[(4 * y + row) * side + 4 * x..][..4];
        for column in 0..4 {
            block[4 * row + column] = i32::from(pixels[column]) - i32::from(expected[column]);
        }
    }
    forward(&mut block);
    block
}

impl Residual {
    /// Finds the levels of a macroblock of `source`, and draws into `drawn` what a decoder restores from them.
    pub(crate) fn new(
        source: &Frame,
        drawn: &mut Frame,
        macroblock: [usize; 2],
        expected: &[Pixels; 3],
        alone: bool,
        quantisers: &Quantisers,
    ) -> Residual {
        let [luma, colour] = if alone { &quantisers.alone } else { &quantisers.moved };
        let mut out = Residual {
            alone,
            sums: [0; 16],
            luma: [[0; 16]; 16],
            colour_sums: [[0; 4]; 2],
            colour: [[[0; 16]; 4]; 2],
            luma_coded: 0,
            colour_coded: 0,
        };
        for plane in 0..3 {
            let (side, stride, start) = (Frame::side(plane), drawn.stride(plane), drawn.start(plane, macroblock));
            for (row, line) in expected[plane][..side * side].chunks_exact(side).enumerate() {
                drawn.planes[plane][start + row * stride..][..side].copy_from_slice(line);
            }
        }
        out.take_luma(source, drawn, macroblock, &expected[0], luma);
        out.take_colour(source, drawn, macroblock, expected, colour);
        out
    }

    /// Finds the levels of the luma, and draws the luma that a decoder restores from them.
    fn take_luma(
        &mut self,
        source: &Frame,
        drawn: &mut Frame,
        macroblock: [usize; 2],
        expected: &Pixels,
        quantiser: &Quantiser,
    ) {
        let (stride, start) = (drawn.stride(0), drawn.start(0, macroblock));
        let first = usize::from(self.alone);
        for block in 0..16 {
            let [x, y] = luma_position(block);
            self.luma[block] = differences(source, 0, start, expected, [x, y]);
            self.sums[4 * y + x] = self.luma[block][0];
            if quantiser.quantise(&mut self.luma[block], first) {
                self.luma_coded |= 1 << (block / 4);
            }
        }
        let mut sums = [0; 16];
        if self.alone {
            hadamard(&mut self.sums);
            self.sums.iter_mut().for_each(|sum| *sum = (*sum + 1) >> 1);
            quantiser.quantise_sums(&mut self.sums);
            sums = self.sums;
            quantiser.restore_sixteen(&mut sums);
            if self.luma_coded != 0 {
                self.luma_coded = 15;
            }
        }
        for block in 0..16 {
            let [x, y] = luma_position(block);
            let mut numbers = self.luma[block];
            if self.alone {
                numbers[0] = sums[4 * y + x];
            }
            quantiser.restore(&mut numbers, first);
            if numbers != [0; 16] {
                add_inverse(&numbers, &mut drawn.planes[0][start + 4 * y * stride + 4 * x..], stride);
            }
        }
    }

    /// Finds the levels of the chroma, and draws the chroma that a decoder restores from them.
    fn take_colour(
        &mut self,
        source: &Frame,
        drawn: &mut Frame,
        macroblock: [usize; 2],
        expected: &[Pixels; 3],
        quantiser: &Quantiser,
    ) {
        let (stride, start) = (drawn.stride(1), drawn.start(1, macroblock));
        for plane in 1..3 {
            let (blocks, sums) = (&mut self.colour[plane - 1], &mut self.colour_sums[plane - 1]);
            for (block, numbers) in blocks.iter_mut().enumerate() {
                *numbers = differences(source, plane, start, &expected[plane], [block & 1, block >> 1]);
                sums[block] = numbers[0];
                if quantiser.quantise(numbers, 1) {
                    self.colour_coded = 2;
                }
            }
            hadamard_four(sums);
            if quantiser.quantise_sums(sums) {
                self.colour_coded = self.colour_coded.max(1);
            }
            let mut restored = *sums;
            quantiser.restore_four(&mut restored);
            for (block, numbers) in blocks.iter().enumerate() {
                let mut numbers = *numbers;
                numbers[0] = restored[block];
                quantiser.restore(&mut numbers, 1);
                if numbers != [0; 16] {
                    let corner = start + 4 * (block >> 1) * stride + 4 * (block & 1);
                    add_inverse(&numbers, &mut drawn.planes[plane][corner..], stride);
                }
            }
        }
    }

    /// Whether there are no levels.
    pub(crate) fn is_empty(&self) -> bool {
        self.luma_coded == 0 && self.colour_coded == 0 && !self.alone
    }

    /// Writes the levels.
    pub(crate) fn write(&self, bits: &mut Bits, counts: &mut Counts, [x, y]: [usize; 2]) {
        let ordered = |block: &Block| ZIGZAG.map(|index| block[index]);
        counts.clear([x, y]);
        if self.alone {
            write_levels(bits, &ordered(&self.sums), counts.context(0, [4 * x, 4 * y]));
        }
        for block in (0..16).filter(|block| self.luma_coded >> (block / 4) & 1 == 1) {
            let [column, row] = luma_position(block);
            let at = [4 * x + column, 4 * y + row];
            let levels = ordered(&self.luma[block]);
            let count = write_levels(bits, &levels[usize::from(self.alone)..], counts.context(0, at));
            counts.set(0, at, count);
        }
        if self.colour_coded > 0 {
            for sums in &self.colour_sums {
                write_levels(bits, sums, Context::Sums);
            }
        }
        if self.colour_coded == 2 {
            for plane in 1..3 {
                for block in 0..4 {
                    let at = [2 * x + (block & 1), 2 * y + (block >> 1)];
                    let levels = ordered(&self.colour[plane - 1][block]);
                    let count = write_levels(bits, &levels[1..], counts.context(plane, at));
                    counts.set(plane, at, count);
                }
            }
        }
    }
}
