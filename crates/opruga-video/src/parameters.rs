//! The parameters that a decoder needs before the first picture (H.264, clauses 7.3.2.1, 7.3.2.2 and annexes A and E).

use super::bits::{Bits, Unit, pack};
use super::frame::BLOCK;
use crate::error::VideoError;

/// The number of bits of a picture number.
pub(crate) const NUMBER_BITS: u32 = 16;

/// The levels of the format: ten times the level number, and the largest numbers of macroblocks per second and per frame.
const LEVELS: [(u8, u64, u64); 18] = [
    (10, 1_485, 99),
    (11, 3_000, 396),
    (12, 6_000, 396),
    (13, 11_880, 396),
    (20, 11_880, 396),
    (21, 19_800, 792),
    (22, 20_250, 1_620),
    (30, 40_500, 1_620),
    (31, 108_000, 3_600),
    (32, 216_000, 5_120),
    (40, 245_760, 8_192),
    (42, 522_240, 8_704),
    (50, 589_824, 22_080),
    (51, 983_040, 36_864),
    (52, 2_073_600, 36_864),
    (60, 4_177_920, 139_264),
    (61, 8_355_840, 139_264),
    (62, 16_711_680, 139_264),
];

/// The length of a frame as a fraction of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rate {
    /// Clock ticks per second.
    pub(crate) ticks: u32,
    /// Ticks per frame.
    pub(crate) frame: u32,
}

impl Rate {
    /// Finds the fraction for a number of frames per second. The fraction is exact for numbers such as 20, 12.5 and 30000/1001.
    pub(crate) fn new(frames_per_second: f64) -> Result<Rate, VideoError> {
        if !(1e-4..=1e4).contains(&frames_per_second) {
            return Err(VideoError::Rate { rate: frames_per_second });
        }
        for frame in 1..=1001_u32 {
            let ticks = frames_per_second * f64::from(frame);
            let close = (ticks - ticks.round()).abs() < 1e-9 * ticks;
            if close && ticks >= 0.5 {
                let (ticks, fine) = (ticks.round() as u32, 1000_u32.div_ceil(ticks.round() as u32));
                return Ok(Rate { ticks: ticks * fine, frame: frame * fine });
            }
        }
        Ok(Rate { ticks: 90_000, frame: (90_000.0 / frames_per_second).round() as u32 })
    }

    /// Frames per second.
    pub(crate) fn frames_per_second(self) -> f64 {
        f64::from(self.ticks) / f64::from(self.frame)
    }
}

/// The two units at the beginning of a stream.
#[derive(Clone, Debug)]
pub(crate) struct Parameters {
    /// Parameters of the whole stream.
    pub(crate) sequence: Vec<u8>,
    /// The parameters of the pictures of the stream.
    pub(crate) picture: Vec<u8>,
}

impl Parameters {
    /// The parameters of a film.
    ///
    /// # Errors
    /// [`VideoError::Size`] if a frame is larger than the format allows.
    pub(crate) fn new([width, height]: [u32; 2], rate: Rate, quantiser: u8) -> Result<Parameters, VideoError> {
        let blocks = [width, height].map(|side| u64::from(side).div_ceil(BLOCK as u64));
        let size = blocks[0] * blocks[1];
        let fits = |most: u64| size <= most && blocks.iter().all(|side| side * side <= 8 * most);
        let speed = (size as f64 * rate.frames_per_second()).ceil() as u64;
        let level = LEVELS.iter().find(|level| fits(level.2) && speed <= level.1);
        // If no level allows so many frames per second, the highest level is chosen if it allows the size of the frames. A player plays such a film
        // more slowly. A film whose frames are too large is not played at all.
        let level = level.or(LEVELS.last().filter(|level| fits(level.2)));
        let level = level.ok_or(VideoError::Size { width, height })?.0;
        Ok(Parameters {
            sequence: sequence([width, height], blocks.map(|side| side as u32), rate, level),
            picture: picture(quantiser),
        })
    }
}

/// The parameters of the whole stream.
fn sequence(size: [u32; 2], blocks: [u32; 2], rate: Rate, level: u8) -> Vec<u8> {
    let mut bits = Bits::default();
    // The constrained baseline profile.
    bits.put(66, 8);
    bits.put(0b1100_0000, 8);
    bits.put(level.into(), 8);
    bits.ue(0);
    bits.ue(NUMBER_BITS - 4);
    // Pictures are shown in the order of the stream, and each may depend on the previous one.
    bits.ue(2);
    bits.ue(1);
    bits.flag(false);
    bits.ue(blocks[0] - 1);
    bits.ue(blocks[1] - 1);
    bits.flag(true);
    bits.flag(true);
    // The part of the macroblocks beyond the picture is cropped. Its size is given in pairs of pixels.
    let extra: [u32; 2] = std::array::from_fn(|axis| (blocks[axis] * BLOCK as u32 - size[axis]) / 2);
    bits.flag(extra != [0, 0]);
    if extra != [0, 0] {
        for cut in [0, extra[0], 0, extra[1]] {
            bits.ue(cut);
        }
    }
    bits.flag(true);
    // Square pixels; no overscan; the limited range and the three codes for BT.709.
    bits.flag(true);
    bits.put(1, 8);
    bits.flag(false);
    bits.flag(true);
    bits.put(5, 3);
    bits.flag(false);
    bits.flag(true);
    [1, 1, 1].into_iter().for_each(|word| bits.put(word, 8));
    bits.flag(false);
    // The clock counts fields, two per frame.
    bits.flag(true);
    bits.put(rate.frame, 32);
    bits.put(2 * rate.ticks, 32);
    bits.flag(true);
    // No buffer model and no picture structure; no picture depends on a later one.
    [false; 3].into_iter().for_each(|flag| bits.flag(flag));
    bits.flag(true);
    bits.flag(true);
    [0, 0, 11, 11, 0, 1].into_iter().for_each(|number| bits.ue(number));
    pack(Unit::Sequence, &bits.finish())
}

/// The parameters of the pictures.
fn picture(quantiser: u8) -> Vec<u8> {
    let mut bits = Bits::default();
    bits.ue(0);
    bits.ue(0);
    // CAVLC, no fields, one slice group, one reference picture, no weights.
    bits.flag(false);
    bits.flag(false);
    [0, 0, 0].into_iter().for_each(|number| bits.ue(number));
    bits.flag(false);
    bits.put(0, 2);
    bits.se(i32::from(quantiser) - 26);
    bits.se(0);
    bits.se(0);
    // Slices control their deblocking; prediction is unconstrained; nothing is sent redundantly.
    bits.flag(true);
    bits.flag(false);
    bits.flag(false);
    pack(Unit::Picture, &bits.finish())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_are_exact_fractions() {
        for (rate, frames, seconds) in [(20.0, 20, 1), (12.5, 25, 2), (30_000.0 / 1001.0, 30_000, 1001), (0.25, 1, 4)] {
            let found = Rate::new(rate).expect("a rate");
            assert_eq!(u64::from(found.ticks) * seconds, u64::from(found.frame) * frames, "{rate}");
            assert!(found.ticks >= 1000);
        }
        let odd = Rate::new(std::f64::consts::PI).expect("a rate").frames_per_second();
        assert!((odd - std::f64::consts::PI).abs() < 1e-3);
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-5, 1e5] {
            assert!(matches!(Rate::new(wrong), Err(VideoError::Rate { .. })), "{wrong}");
        }
    }

    #[test]
    fn the_level_grows_with_the_size_and_too_large_is_an_error() {
        let level = |width, height, rate| {
            let rate = Rate::new(rate).expect("a rate");
            Parameters::new([width, height], rate, 24).map(|parameters| parameters.sequence[3])
        };
        assert_eq!(level(16, 16, 20.0).expect("a level"), 10);
        assert_eq!(level(800, 600, 20.0).expect("a level"), 31);
        assert_eq!(level(1920, 1080, 60.0).expect("a level"), 42);
        assert!(matches!(level(16_384, 16_384, 20.0), Err(VideoError::Size { .. })));
        assert!(matches!(level(16_384, 16, 20.0), Ok(60)), "wide but low");
    }
}
