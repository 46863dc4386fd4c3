//! Encodes images as the pictures of a stream. The encoder also reconstructs the pictures as a decoder shows them, and predicts from these, so that
//! errors do not accumulate.

use super::bits::{Bits, Unit, pack, se_bits};
use super::frame::{BLOCK, Frame};
use super::parameters::NUMBER_BITS;
use super::predict::{Direction, Motion, Neighbour, Pixels, difference, expected_motion, from_before, from_neighbours};
use super::residual::{Counts, Quantisers, Residual};
use super::tables::PATTERNS;
use crate::image::Image;

/// The largest motion that is searched [pixels]. All levels of the format allow a motion of this size.
const FURTHEST: i32 = 56;

/// The maximum number of steps of a search.
const STEPS: usize = 24;

/// A picture of the stream.
#[derive(Clone, Debug)]
pub(crate) struct Coded {
    /// The unit of the picture, without a start code.
    pub(crate) unit: Vec<u8>,
    /// Whether this picture can be decoded without other pictures.
    pub(crate) refresh: bool,
}

/// Encodes one image after another.
#[derive(Clone, Debug)]
pub(crate) struct Encoder {
    /// The number of macroblocks in a row, and of rows.
    blocks: [usize; 2],
    /// The pixels of the last image.
    last: Vec<u8>,
    source: Frame,
    /// The previous frame and the present one, as a decoder reconstructs them.
    before: Frame,
    drawn: Frame,
    quantisers: Quantisers,
    counts: Counts,
    /// The motion of each macroblock; none if it was not predicted from the previous frame.
    motion: Vec<Option<Motion>>,
    /// The cost of a bit, in the unit of the sums of absolute differences that measure predictions.
    bit_cost: u32,
    /// The number of pictures from one independent picture to the next.
    period: u32,
    /// The number of the next picture, counted from the last independent picture.
    number: u32,
    /// The number of independent pictures so far.
    refreshes: u32,
}

/// A macroblock predicted from its neighbours.
struct Alone {
    luma: Direction,
    colour: Direction,
    expected: [Pixels; 3],
    cost: u32,
}

impl Encoder {
    /// An encoder for images of one size.
    pub(crate) fn new([width, height]: [u32; 2], quantiser: u8, period: u32) -> Encoder {
        let blocks = [width, height].map(|side| (side as usize).div_ceil(BLOCK));
        let frame = Frame::new(blocks[0], blocks[1]);
        Encoder {
            blocks,
            last: Vec::new(),
            source: frame.clone(),
            before: frame.clone(),
            drawn: frame,
            quantisers: Quantisers::new(quantiser),
            counts: Counts::new(blocks[0], blocks[1]),
            motion: vec![None; blocks[0] * blocks[1]],
            bit_cost: 1 << (quantiser.saturating_sub(10) / 6),
            period,
            number: 0,
            refreshes: 0,
        }
    }

    /// The latest picture as a decoder shows it.
    #[cfg(test)]
    pub(crate) fn shown(&self) -> &Frame {
        &self.before
    }

    /// Encodes an image.
    pub(crate) fn code(&mut self, image: Image<'_>) -> Coded {
        let changed = self.take(image);
        let refresh = self.number.is_multiple_of(self.period);
        if refresh {
            self.number = 0;
        }
        let mut bits = Bits::default();
        self.head(&mut bits, refresh);
        let mut skipped = 0;
        for y in 0..self.blocks[1] {
            for x in 0..self.blocks[0] {
                if refresh {
                    let alone = self.alone([x, y]);
                    self.write_alone(&mut bits, [x, y], &alone, 0);
                } else if !changed[y * self.blocks[0] + x] {
                    self.repeat(&mut bits, [x, y], &mut skipped);
                } else {
                    self.renew(&mut bits, [x, y], &mut skipped);
                }
            }
        }
        if skipped > 0 {
            bits.ue(skipped);
        }
        if refresh {
            self.refreshes += 1;
        }
        self.number += 1;
        std::mem::swap(&mut self.before, &mut self.drawn);
        Coded { unit: pack(if refresh { Unit::Refresh } else { Unit::Slice }, &bits.finish()), refresh }
    }

    /// Copies the changed macroblocks of an image, and returns which macroblocks have changed.
    fn take(&mut self, image: Image<'_>) -> Vec<bool> {
        let pixels = image.pixels();
        let row_bytes = 4 * image.width() as usize;
        let mut changed = vec![self.last.len() != pixels.len(); self.blocks[0] * self.blocks[1]];
        if self.last.len() == pixels.len() {
            for (row, (line, last)) in pixels.chunks_exact(row_bytes).zip(self.last.chunks_exact(row_bytes)).enumerate()
            {
                if line == last {
                    continue;
                }
                let flags = &mut changed[row / BLOCK * self.blocks[0]..][..self.blocks[0]];
                for (x, (part, last)) in line.chunks(4 * BLOCK).zip(last.chunks(4 * BLOCK)).enumerate() {
                    if part != last {
                        flags[x] = true;
                        // The chroma at the left edge of a macroblock depends on the pixel to the left of the macroblock.
                        if let Some(next) = flags.get_mut(x + 1) {
                            *next = true;
                        }
                    }
                }
            }
        }
        for (index, _) in changed.iter().enumerate().filter(|(_, changed)| **changed) {
            self.source.take(image, [index % self.blocks[0], index / self.blocks[0]]);
        }
        self.last.clear();
        self.last.extend_from_slice(pixels);
        changed
    }

    /// Writes the header of a picture, which consists of one slice.
    fn head(&self, bits: &mut Bits, refresh: bool) {
        bits.ue(0);
        bits.ue(if refresh { 7 } else { 5 });
        bits.ue(0);
        bits.put(self.number, NUMBER_BITS);
        if refresh {
            bits.ue(self.refreshes % 2);
            // These flags mean that no earlier picture is kept.
            bits.flag(false);
            bits.flag(false);
        } else {
            // These flags mean that one earlier picture is used, in the default order, and that the oldest picture is dropped.
            bits.flag(false);
            bits.flag(false);
            bits.flag(false);
        }
        bits.se(0);
        // There is no deblocking, so lines and letters stay sharp.
        bits.ue(1);
    }

    /// The predicted motion of a macroblock, its motion if it is skipped, and the motions of its neighbours.
    fn neighbours(&self, [x, y]: [usize; 2]) -> ([Motion; 2], [Neighbour; 3]) {
        let wide = self.blocks[0];
        let at = |x: usize, y: usize| self.motion[y * wide + x];
        let left = (x > 0).then(|| at(x - 1, y));
        let above = (y > 0).then(|| at(x, y - 1));
        let corner = match y {
            0 => None,
            _ if x + 1 < wide => Some(at(x + 1, y - 1)),
            _ => (x > 0).then(|| at(x - 1, y - 1)),
        };
        (expected_motion(left, above, corner), [left, above, corner])
    }

    /// The prediction from the previous frame.
    fn moved(&self, macroblock: [usize; 2], motion: Motion) -> [Pixels; 3] {
        std::array::from_fn(|plane| from_before(&self.before, plane, macroblock, motion))
    }

    /// Encodes an unchanged macroblock.
    fn repeat(&mut self, bits: &mut Bits, macroblock: [usize; 2], skipped: &mut u32) {
        let ([expected, left_out], _) = self.neighbours(macroblock);
        self.drawn.copy_block(&self.before, macroblock);
        self.counts.clear(macroblock);
        let here = || -> [Pixels; 3] { self.moved(macroblock, [0, 0]) };
        if left_out == [0, 0] || self.moved(macroblock, left_out) == here() {
            self.motion[macroblock[1] * self.blocks[0] + macroblock[0]] = Some(left_out);
            *skipped += 1;
            return;
        }
        self.motion[macroblock[1] * self.blocks[0] + macroblock[0]] = Some([0, 0]);
        bits.ue(std::mem::take(skipped));
        bits.ue(0);
        (0..2).for_each(|axis| bits.se(-expected[axis]));
        bits.ue(u32::from(PATTERNS[0]));
    }

    /// Encodes a changed macroblock.
    fn renew(&mut self, bits: &mut Bits, macroblock: [usize; 2], skipped: &mut u32) {
        let ([expected, left_out], neighbours) = self.neighbours(macroblock);
        let (motion, pixels, cost) = self.search(macroblock, expected, left_out, neighbours);
        // An empty macroblock that a body has just left is predicted from its neighbours, so that no traces of the body remain.
        let empty = cost > 0 && self.source.is_empty(macroblock);
        if cost > 256 || empty {
            let alone = self.alone(macroblock);
            if alone.cost < cost || empty {
                bits.ue(std::mem::take(skipped));
                self.write_alone(bits, macroblock, &alone, 5);
                return;
            }
        }
        let mut pixels = [pixels, [0; 256], [0; 256]];
        for plane in 1..3 {
            pixels[plane] = from_before(&self.before, plane, macroblock, motion);
        }
        let residual = Residual::new(&self.source, &mut self.drawn, macroblock, &pixels, false, &self.quantisers);
        self.motion[macroblock[1] * self.blocks[0] + macroblock[0]] = Some(motion);
        if residual.is_empty() && motion == left_out {
            self.counts.clear(macroblock);
            *skipped += 1;
            return;
        }
        bits.ue(std::mem::take(skipped));
        bits.ue(0);
        (0..2).for_each(|axis| bits.se(motion[axis] - expected[axis]));
        let pattern = 16 * residual.colour_coded + residual.luma_coded;
        bits.ue(u32::from(PATTERNS[pattern as usize]));
        if pattern != 0 {
            bits.se(0);
        }
        residual.write(bits, &mut self.counts, macroblock);
    }

    /// Searches the previous frame for the content of a macroblock, beginning with the motions of its neighbours.
    fn search(
        &self,
        macroblock: [usize; 2],
        expected: Motion,
        left_out: Motion,
        neighbours: [Neighbour; 3],
    ) -> (Motion, Pixels, u32) {
        let mut best = ([0, 0], [0; 256], u32::MAX);
        let mut tried = [[i32::MAX; 2]; 8];
        let mut count = 0;
        let mut attempt = |motion: Motion, best: &mut (Motion, Pixels, u32)| {
            let motion = motion.map(|part| (part >> 2).clamp(-FURTHEST, FURTHEST) << 2);
            if tried.contains(&motion) {
                return false;
            }
            tried[count % 8] = motion;
            count += 1;
            let bits = (0..2).map(|axis| se_bits(motion[axis] - expected[axis])).sum::<u32>();
            let price = if motion == left_out { 0 } else { self.bit_cost * (bits + 2) };
            if price >= best.2 {
                return false;
            }
            let pixels = from_before(&self.before, 0, macroblock, motion);
            let cost = price + difference(&self.source, 0, macroblock, &pixels, best.2 - price);
            let better = cost < best.2;
            if better {
                *best = (motion, pixels, cost);
            }
            better
        };
        for motion in
            [Some([0, 0]), Some(left_out), Some(expected)].into_iter().chain(neighbours.map(Option::flatten)).flatten()
        {
            attempt(motion, &mut best);
        }
        for reach in [16, 4] {
            for _ in 0..STEPS {
                if best.2 < 128 {
                    break;
                }
                let [x, y] = best.0;
                let around = [[x - reach, y], [x + reach, y], [x, y - reach], [x, y + reach]];
                let mut moved = false;
                for motion in around {
                    moved |= attempt(motion, &mut best);
                }
                if !moved {
                    break;
                }
            }
        }
        best
    }

    /// The best prediction from the neighbours.
    fn alone(&self, macroblock: [usize; 2]) -> Alone {
        let best = |plane: usize| {
            let directions: &[Direction] = match self.source.is_empty(macroblock) {
                true => &[Direction::Mean],
                false => &[Direction::Mean, Direction::Right, Direction::Down],
            };
            let mut best = (Direction::Mean, [0; 256], u32::MAX);
            for direction in directions.iter().copied().filter(|direction| direction.is_possible(macroblock)) {
                let pixels = from_neighbours(&self.drawn, plane, macroblock, direction);
                let cost = difference(&self.source, plane, macroblock, &pixels, best.2);
                if cost < best.2 {
                    best = (direction, pixels, cost);
                }
            }
            best
        };
        let (luma, brightness, cost) = best(0);
        let (colour, blue, _) = best(1);
        let red = from_neighbours(&self.drawn, 2, macroblock, colour);
        Alone { luma, colour, expected: [brightness, blue, red], cost: cost + 12 * self.bit_cost }
    }

    /// Encodes a macroblock predicted from its neighbours; `offset` is the number of macroblock types that precede those of such macroblocks in the
    /// numbering for this kind of picture.
    fn write_alone(&mut self, bits: &mut Bits, macroblock: [usize; 2], alone: &Alone, offset: u32) {
        let residual =
            Residual::new(&self.source, &mut self.drawn, macroblock, &alone.expected, true, &self.quantisers);
        self.motion[macroblock[1] * self.blocks[0] + macroblock[0]] = None;
        let luma = if residual.luma_coded == 0 { 0 } else { 12 };
        bits.ue(offset + 1 + alone.luma.luma() + 4 * residual.colour_coded + luma);
        bits.ue(alone.colour.chroma());
        bits.se(0);
        residual.write(bits, &mut self.counts, macroblock);
    }
}
