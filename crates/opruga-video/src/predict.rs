//! The prediction of a macroblock: from its neighbours, or from the previous frame (H.264, clauses 8.3, 8.4).

use super::frame::Frame;

/// The prediction of a macroblock from its neighbours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    /// Every row equals the row above the macroblock.
    Down,
    /// Every column equals the column to the left of the macroblock.
    Right,
    /// All pixels equal the mean of that row and that column.
    Mean,
}

impl Direction {
    /// Whether the neighbours that this prediction needs exist.
    pub(crate) fn is_possible(self, [x, y]: [usize; 2]) -> bool {
        match self {
            Direction::Down => y > 0,
            Direction::Right => x > 0,
            Direction::Mean => true,
        }
    }
    /// The number of this prediction for luma.
    pub(crate) fn luma(self) -> u32 {
        match self {
            Direction::Down => 0,
            Direction::Right => 1,
            Direction::Mean => 2,
        }
    }
    /// The number of this prediction for chroma.
    pub(crate) fn chroma(self) -> u32 {
        match self {
            Direction::Mean => 0,
            Direction::Right => 1,
            Direction::Down => 2,
        }
    }
}

/// The pixels of a macroblock in one plane; chroma fills only the first 64.
pub(crate) type Pixels = [u8; 256];

/// The prediction from the neighbours.
pub(crate) fn from_neighbours(frame: &Frame, plane: usize, macroblock: [usize; 2], direction: Direction) -> Pixels {
    let (side, stride, start) = (Frame::side(plane), frame.stride(plane), frame.start(plane, macroblock));
    let pixels = &frame.planes[plane];
    let mut out = [128; 256];
    let sum = |part: std::ops::Range<usize>, above: bool| -> u32 {
        let at = |step: usize| if above { start - stride + step } else { start - 1 + step * stride };
        part.map(|step| u32::from(pixels[at(step)])).sum()
    };
    let [x, y] = macroblock;
    match direction {
        Direction::Down => {
            for row in out[..side * side].chunks_exact_mut(side) {
                row.copy_from_slice(&pixels[start - stride..start - stride + side]);
            }
        }
        Direction::Right => {
            for (row, line) in out[..side * side].chunks_exact_mut(side).enumerate() {
                line.fill(pixels[start + row * stride - 1]);
            }
        }
        Direction::Mean if plane == 0 => {
            let mean = match (x > 0, y > 0) {
                (true, true) => (sum(0..16, true) + sum(0..16, false) + 16) >> 5,
                (true, false) => (sum(0..16, false) + 8) >> 4,
                (false, true) => (sum(0..16, true) + 8) >> 4,
                (false, false) => 128,
            };
            out.fill(mean as u8);
        }
        Direction::Mean => {
            // Each quarter has its own mean. The two quarters off the diagonal use only one side, if it exists.
            for (right, lower) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let above = || sum(4 * right..4 * right + 4, true);
                let left = || sum(4 * lower..4 * lower + 4, false);
                let mean = match (x > 0, y > 0) {
                    (true, true) if right == lower => (above() + left() + 4) >> 3,
                    (true, true) if right == 1 => (above() + 2) >> 2,
                    (true, true) | (true, false) => (left() + 2) >> 2,
                    (false, true) => (above() + 2) >> 2,
                    (false, false) => 128,
                };
                for row in 0..4 {
                    let from = (4 * lower + row) * side + 4 * right;
                    out[from..from + 4].fill(mean as u8);
                }
            }
        }
    }
    out
}

/// The motion of a macroblock, in quarters of a pixel.
pub(crate) type Motion = [i32; 2];

/// The prediction from the previous frame after a motion by whole pixels.
pub(crate) fn from_before(before: &Frame, plane: usize, [x, y]: [usize; 2], motion: Motion) -> Pixels {
    let (side, stride) = (Frame::side(plane), before.stride(plane));
    let rows = before.high * side;
    let (units, mask) = if plane == 0 { (2, 3) } else { (3, 7) };
    let left = (side * x) as i32 + (motion[0] >> units);
    let top = (side * y) as i32 + (motion[1] >> units);
    let [right_share, lower_share] = motion.map(|part| part & mask);
    debug_assert!(plane > 0 || right_share == 0 && lower_share == 0, "brightness moves by whole pixels");
    let pixels = &before.planes[plane];
    let mut out = [0; 256];
    // Beyond the edge the last column and row are repeated.
    let column = |x: i32| x.clamp(0, stride as i32 - 1) as usize;
    let row = |y: i32| y.clamp(0, rows as i32 - 1) as usize * stride;
    let inside = left >= 0 && left as usize + side <= stride;
    for (line, part) in out[..side * side].chunks_exact_mut(side).enumerate() {
        let upper = row(top + line as i32);
        if right_share == 0 && lower_share == 0 {
            if inside {
                part.copy_from_slice(&pixels[upper + left as usize..][..side]);
            } else {
                (left..).zip(part).for_each(|(x, pixel)| *pixel = pixels[upper + column(x)]);
            }
            continue;
        }
        let lower = row(top + line as i32 + 1);
        for (x, pixel) in (left..).zip(part) {
            let at = |row: usize, x: i32| i32::from(pixels[row + column(x)]);
            let above = (8 - right_share) * at(upper, x) + right_share * at(upper, x + 1);
            let below = (8 - right_share) * at(lower, x) + right_share * at(lower, x + 1);
            *pixel = (((8 - lower_share) * above + lower_share * below + 32) >> 6) as u8;
        }
    }
    out
}

/// The sum of the absolute differences between a macroblock of a frame and its prediction. The summation stops as soon as the sum exceeds a limit.
pub(crate) fn difference(frame: &Frame, plane: usize, macroblock: [usize; 2], expected: &Pixels, limit: u32) -> u32 {
    let (side, stride, start) = (Frame::side(plane), frame.stride(plane), frame.start(plane, macroblock));
    let mut sum = 0;
    for (row, line) in expected[..side * side].chunks_exact(side).enumerate() {
        let pixels = &frame.planes[plane][start + row * stride..][..side];
        sum += pixels.iter().zip(line).map(|(a, b)| u32::from(a.abs_diff(*b))).sum::<u32>();
        if sum > limit {
            break;
        }
    }
    sum
}

/// The motion predicted from the neighbours, and the motion of a skipped macroblock.
///
/// A neighbour is `None` outside the picture, and `Some(None)` if it was not predicted from the previous frame.
pub(crate) fn expected_motion(left: Neighbour, above: Neighbour, corner: Neighbour) -> [Motion; 2] {
    let known = |neighbour: Neighbour| neighbour.flatten();
    let motion = match (left, above, corner) {
        (Some(left), None, None) => left.unwrap_or_default(),
        _ => match [known(left), known(above), known(corner)] {
            [Some(only), None, None] | [None, Some(only), None] | [None, None, Some(only)] => only,
            three => {
                let three = three.map(Option::unwrap_or_default);
                std::array::from_fn(|axis| {
                    let [a, b, c] = three.map(|motion| motion[axis]);
                    a.max(b).min(a.min(b).max(c))
                })
            }
        },
    };
    let rests = |neighbour: Neighbour| neighbour.is_none_or(|motion| motion == Some([0, 0]));
    [motion, if rests(left) || rests(above) { [0, 0] } else { motion }]
}

/// The motion of a neighbour: `None` outside the picture, `Some(None)` if it was not predicted from the previous frame.
pub(crate) type Neighbour = Option<Option<Motion>>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_is_expected_from_the_neighbours() {
        let at = |x, y| Some(Some([x, y]));
        assert_eq!(expected_motion(at(4, 8), at(8, 0), at(-4, 12)), [[4, 8]; 2]);
        assert_eq!(expected_motion(at(4, 8), None, None), [[4, 8], [0, 0]], "at the upper edge");
        assert_eq!(expected_motion(Some(None), at(8, 4), Some(None)), [[8, 4]; 2], "the only one that moves");
        assert_eq!(expected_motion(at(0, 0), at(8, 4), at(8, 4)), [[8, 4], [0, 0]], "beside one that rests");
    }

    #[test]
    fn a_macroblock_is_found_where_it_was_also_beyond_the_edge() {
        let mut frame = Frame::new(2, 2);
        for (place, pixel) in frame.planes[0].iter_mut().enumerate() {
            *pixel = (place % 32 + 4 * (place / 32)) as u8;
        }
        let moved = from_before(&frame, 0, [0, 0], [12, 20]);
        assert_eq!((moved[0], moved[17]), (3 + 20, 4 + 24));
        let beyond = from_before(&frame, 0, [1, 0], [4 * 20, -8]);
        assert!(beyond[..48].iter().all(|pixel| *pixel == 31), "the last column of the first row");
    }
}
