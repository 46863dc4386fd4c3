//! A decoder that supports only the output of the encoder. The decoder has its own bit reader, but shares the tables, the prediction and the inverse
//! transform with the encoder.

use super::super::frame::Frame;
use super::super::parameters::NUMBER_BITS;
use super::super::predict::{Direction, Motion, expected_motion, from_before, from_neighbours};
use super::super::tables::{COUNTS, Code, PATTERNS, RUNS, SUM_COUNTS, SUM_ZEROS, ZEROS};
use super::super::transform::{Block, Quantiser, ZIGZAG, add_inverse, chroma_quantiser};

/// Reads bits.
struct Reader {
    bytes: Vec<u8>,
    place: usize,
}

impl Reader {
    /// Reads the bits of a unit. The header of the unit is skipped, and so are the bytes that the encoder inserted so that nothing inside looks like
    /// the start of a unit.
    fn new(unit: &[u8]) -> Reader {
        let mut bytes: Vec<u8> = Vec::new();
        for (place, &byte) in unit.iter().enumerate().skip(1) {
            let kept = place >= 3 && unit[place - 2..place] == [0, 0];
            assert!(!kept || byte >= 3, "a start code within a unit");
            if !(kept && byte == 3) {
                bytes.push(byte);
            }
        }
        Reader { bytes, place: 0 }
    }

    fn bits(&mut self, count: usize) -> u32 {
        (0..count).fold(0, |value, _| value << 1 | u32::from(self.bit()))
    }

    fn bit(&mut self) -> u8 {
        let bit = self.bytes[self.place / 8] >> (7 - self.place % 8) & 1;
        self.place += 1;
        bit
    }

    fn ue(&mut self) -> u32 {
        let mut zeros = 0;
        while self.bit() == 0 {
            zeros += 1;
        }
        (1 << zeros) - 1 + self.bits(zeros)
    }

    fn se(&mut self) -> i32 {
        let code = self.ue() as i32;
        if code % 2 == 1 { (code + 1) / 2 } else { -code / 2 }
    }

    /// Whether anything follows before the end of the unit.
    fn has_more(&self) -> bool {
        let last = self.bytes.len() * 8 - 1 - self.bytes[self.bytes.len() - 1].trailing_zeros() as usize;
        self.place < last
    }

    /// The index of the next code.
    fn code(&mut self, codes: &[Code]) -> usize {
        let start = self.place;
        for (place, &(length, value)) in codes.iter().enumerate().filter(|(_, code)| code.0 > 0) {
            self.place = start;
            let room = self.bytes.len() * 8 - start >= usize::from(length);
            if room && self.bits(length.into()) == u32::from(value) {
                return place;
            }
        }
        panic!("no code at bit {start}");
    }

    /// Reads up to `most` levels, starting with the lowest frequency. If `near` is `None`, the levels are chroma DC levels.
    fn levels(&mut self, near: Option<u8>, most: usize) -> (Vec<i32>, u8) {
        let (ones, total) = match near {
            None => (self.code(SUM_COUNTS.as_flattened()), 5),
            Some(near @ 0..8) => (self.code(COUNTS[[0, 0, 1, 1, 2, 2, 2, 2][usize::from(near)]].as_flattened()), 17),
            Some(_) => match self.bits(6) as usize {
                3 => (0, 17),
                code => ((code & 3) * 17 + (code >> 2) + 1, 17),
            },
        };
        let (ones, total) = (ones / total, ones % total);
        let mut values = Vec::new();
        let mut suffix = usize::from(total > 10 && ones < 3);
        for index in 0..total {
            if index < ones {
                values.push(1 - 2 * i32::from(self.bit()));
                continue;
            }
            let mut prefix = 0;
            while self.bit() == 0 {
                prefix += 1;
            }
            let length = if prefix == 15 {
                12
            } else if prefix == 14 && suffix == 0 {
                4
            } else {
                suffix
            };
            let mut code = (prefix << suffix) + self.bits(length) as i32;
            code += if prefix == 15 && suffix == 0 { 15 } else { 0 };
            code += if index == ones && ones < 3 { 2 } else { 0 };
            let level = if code % 2 == 0 { code / 2 + 1 } else { -(code + 1) / 2 };
            values.push(level);
            suffix = suffix.max(1);
            suffix += usize::from(level.abs() > 3 << (suffix - 1) && suffix < 6);
        }
        let mut levels = vec![0; most];
        let tables: &[&[Code]] = if near.is_none() { &SUM_ZEROS } else { &ZEROS };
        let mut zeros = if total == 0 || total == most { 0 } else { self.code(&tables[total - 1][..=most - total]) };
        let mut place = total + zeros;
        for (index, value) in values.into_iter().enumerate() {
            place -= 1;
            levels[place] = value;
            if zeros > 0 && index + 1 < total {
                let run = self.code(RUNS[zeros.min(7) - 1]);
                (zeros, place) = (zeros - run, place - run);
            }
        }
        (levels, total as u8)
    }
}

/// Decodes one picture after another.
pub(super) struct Decoder {
    pub(super) size: [u32; 2],
    blocks: [usize; 2],
    quantisers: [Quantiser; 2],
    before: Frame,
    drawn: Frame,
    counts: [Vec<u8>; 3],
    motion: Vec<Option<Motion>>,
}

impl Decoder {
    /// Reads the parameters.
    pub(super) fn new(sequence: &[u8], picture: &[u8]) -> Decoder {
        let mut reader = Reader::new(sequence);
        assert_eq!((sequence[0], reader.bits(8), reader.bits(8)), (0x67, 66, 0xC0));
        reader.bits(8);
        assert_eq!([0; 4].map(|_| reader.ue()), [0, NUMBER_BITS - 4, 2, 1]);
        reader.bit();
        let blocks = [0; 2].map(|_| reader.ue() as usize + 1);
        assert_eq!(reader.bits(2), 3, "frames, no fields");
        let cut = if reader.bit() == 1 { [0; 4].map(|_| reader.ue()) } else { [0; 4] };
        assert_eq!(reader.bits(1), 1, "there is more to know");
        let size = [16 * blocks[0] as u32 - 2 * cut[1], 16 * blocks[1] as u32 - 2 * cut[3]];
        let mut reader = Reader::new(picture);
        assert_eq!((picture[0], reader.ue(), reader.ue(), reader.bits(2)), (0x68, 0, 0, 0));
        assert_eq!(([0; 3].map(|_| reader.ue()), reader.bits(3)), ([0; 3], 0));
        let quantiser = (26 + reader.se()) as u8;
        let frame = Frame::new(blocks[0], blocks[1]);
        Decoder {
            size,
            blocks,
            quantisers: [quantiser, chroma_quantiser(quantiser)].map(|number| Quantiser::new(number, 2)),
            before: frame.clone(),
            drawn: frame,
            counts: [16, 4, 4].map(|count| vec![0; count * blocks[0] * blocks[1]]),
            motion: vec![None; blocks[0] * blocks[1]],
        }
    }

    /// Decodes a picture.
    pub(super) fn decode(&mut self, unit: &[u8]) -> &Frame {
        let refresh = unit[0] == 0x65;
        let mut reader = Reader::new(unit);
        assert_eq!([0; 3].map(|_| reader.ue()), [0, if refresh { 7 } else { 5 }, 0]);
        let number = reader.bits(NUMBER_BITS as usize);
        assert!(!refresh || number == 0);
        let zeros = if refresh { reader.ue() / 2 + reader.bits(2) } else { reader.bits(3) };
        assert_eq!((zeros, reader.se(), reader.ue()), (0, 0, 1));
        let (mut skipped, mut is_read) = (0, false);
        for place in 0..self.blocks[0] * self.blocks[1] {
            let at = [place % self.blocks[0], place / self.blocks[0]];
            for plane in 0..3 {
                let side = if plane == 0 { 4 } else { 2 };
                (0..side * side).for_each(|block| self.set_count(plane, at, [block % side, block / side], 0));
            }
            if !refresh {
                skipped = if is_read { skipped } else { reader.ue() };
                if skipped > 0 {
                    skipped -= 1;
                    is_read = true;
                    let motion = self.expected(at)[1];
                    self.motion[place] = Some(motion);
                    self.expect(at, |before, _, plane| from_before(before, plane, at, motion));
                    continue;
                }
            }
            match reader.ue() + if refresh { 5 } else { 0 } {
                0 => self.moved(&mut reader, at),
                kind => self.alone(&mut reader, at, kind - 6),
            }
            is_read = false;
        }
        assert!(!reader.has_more(), "something is left of the picture");
        std::mem::swap(&mut self.before, &mut self.drawn);
        &self.before
    }

    /// The predicted motion, and the motion of a skipped macroblock.
    fn expected(&self, [x, y]: [usize; 2]) -> [Motion; 2] {
        let wide = self.blocks[0];
        let at = |x: usize, y: usize| (x < wide).then(|| self.motion[y * wide + x]);
        let left = x.checked_sub(1).and_then(|x| at(x, y));
        let row = y.checked_sub(1);
        let corner = row.and_then(|y| at(x + 1, y).or_else(|| x.checked_sub(1).and_then(|x| at(x, y))));
        expected_motion(left, row.and_then(|y| at(x, y)), corner)
    }

    /// Draws the prediction of a macroblock.
    fn expect(&mut self, at: [usize; 2], pixels: impl Fn(&Frame, &Frame, usize) -> [u8; 256]) {
        for plane in 0..3 {
            let expected = pixels(&self.before, &self.drawn, plane);
            let (side, stride, start) = (Frame::side(plane), self.drawn.stride(plane), self.drawn.start(plane, at));
            for (row, line) in expected[..side * side].chunks_exact(side).enumerate() {
                self.drawn.planes[plane][start + row * stride..][..side].copy_from_slice(line);
            }
        }
    }

    /// The index of the number of levels of a block.
    fn count_place(&self, plane: usize, [x, y]: [usize; 2], [column, row]: [usize; 2]) -> [usize; 2] {
        let side = if plane == 0 { 4 } else { 2 };
        [side * x + column, (side * y + row) * side * self.blocks[0]]
    }

    fn set_count(&mut self, plane: usize, at: [usize; 2], block: [usize; 2], count: u8) {
        let [column, row] = self.count_place(plane, at, block);
        self.counts[plane][row + column] = count;
    }

    /// The mean number of levels of the blocks at the left and above.
    fn near(&self, plane: usize, at: [usize; 2], block: [usize; 2]) -> u8 {
        let [column, row] = self.count_place(plane, at, block);
        let wide = if plane == 0 { 4 } else { 2 } * self.blocks[0];
        let left = column.checked_sub(1).map(|column| self.counts[plane][row + column]);
        let above = row.checked_sub(wide).map(|row| self.counts[plane][row + column]);
        match (left, above) {
            (Some(left), Some(above)) => (left + above + 1) >> 1,
            (one, other) => one.or(other).unwrap_or(0),
        }
    }

    /// Decodes a macroblock predicted from the previous frame.
    fn moved(&mut self, reader: &mut Reader, at: [usize; 2]) {
        let expected = self.expected(at)[0];
        let motion = expected.map(|part| part + reader.se());
        self.motion[at[1] * self.blocks[0] + at[0]] = Some(motion);
        self.expect(at, |before, _, plane| from_before(before, plane, at, motion));
        let number = reader.ue() as u8;
        let pattern = PATTERNS.iter().position(|other| *other == number).expect("a pattern") as u32;
        if pattern > 0 {
            assert_eq!(reader.se(), 0);
        }
        self.residual(reader, at, [pattern & 15, pattern >> 4], false);
    }

    /// Decodes a macroblock predicted from its neighbours.
    fn alone(&mut self, reader: &mut Reader, at: [usize; 2], kind: u32) {
        self.motion[at[1] * self.blocks[0] + at[0]] = None;
        let luma = [Direction::Down, Direction::Right, Direction::Mean][kind as usize % 4];
        let colour = [Direction::Mean, Direction::Right, Direction::Down][reader.ue() as usize];
        assert!(luma.is_possible(at) && colour.is_possible(at));
        assert_eq!(reader.se(), 0);
        self.expect(at, |_, drawn, plane| from_neighbours(drawn, plane, at, if plane == 0 { luma } else { colour }));
        self.residual(reader, at, [if kind >= 12 { 15 } else { 0 }, kind / 4 % 3], true);
    }

    /// The levels of a block in their positions, starting at the position `first`.
    fn block(&mut self, reader: &mut Reader, plane: usize, at: [usize; 2], block: [usize; 2], first: usize) -> Block {
        let (levels, count) = reader.levels(Some(self.near(plane, at, block)), 16 - first);
        self.set_count(plane, at, block, count);
        let mut out = [0; 16];
        levels.iter().zip(&ZIGZAG[first..]).for_each(|(level, place)| out[*place] = *level);
        out
    }

    /// Reads the residual of a macroblock and adds it.
    fn residual(&mut self, reader: &mut Reader, at: [usize; 2], [luma, colour]: [u32; 2], alone: bool) {
        let mut sums = [0; 16];
        if alone {
            let (levels, _) = reader.levels(Some(self.near(0, at, [0, 0])), 16);
            levels.iter().zip(ZIGZAG).for_each(|(level, place)| sums[place] = *level);
            self.quantisers[0].restore_sixteen(&mut sums);
        }
        let first = usize::from(alone);
        for quarter in 0..4 {
            for part in 0..4 {
                let block = [2 * (quarter % 2) + part % 2, 2 * (quarter / 2) + part / 2];
                let mut numbers = [0; 16];
                if luma >> quarter & 1 == 1 {
                    numbers = self.block(reader, 0, at, block, first);
                }
                self.quantisers[0].restore(&mut numbers, first);
                numbers[0] += sums[4 * block[1] + block[0]];
                self.add(0, at, block, &numbers);
            }
        }
        let mut sums = [[0; 4]; 2];
        if colour > 0 {
            for sums in &mut sums {
                sums.copy_from_slice(&reader.levels(None, 4).0);
                self.quantisers[1].restore_four(sums);
            }
        }
        for plane in 1..3 {
            for block in 0..4 {
                let place = [block % 2, block / 2];
                let mut numbers = [0; 16];
                if colour == 2 {
                    numbers = self.block(reader, plane, at, place, 1);
                }
                self.quantisers[1].restore(&mut numbers, 1);
                numbers[0] = sums[plane - 1][block];
                self.add(plane, at, place, &numbers);
            }
        }
    }

    fn add(&mut self, plane: usize, at: [usize; 2], [column, row]: [usize; 2], numbers: &Block) {
        let stride = self.drawn.stride(plane);
        let start = self.drawn.start(plane, at) + 4 * row * stride + 4 * column;
        add_inverse(numbers, &mut self.drawn.planes[plane][start..], stride);
    }
}
