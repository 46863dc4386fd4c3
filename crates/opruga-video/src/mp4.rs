//! Writes the boxes of an MP4 file with one film (ISO/IEC 14496-12 and 14496-15). The data that a player needs come first.

use super::parameters::{Parameters, Rate};
use std::io::{Result, Write};

/// One picture of the film.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// The length of the picture in bytes.
    pub(crate) size: u32,
    /// Whether the picture can be decoded without other pictures.
    pub(crate) refresh: bool,
}

/// The content of the boxes.
#[derive(Clone, Debug)]
pub(crate) struct Film<'a> {
    /// The width and the height of the film.
    pub(crate) size: [u32; 2],
    /// The length of a picture as a fraction of a second.
    pub(crate) rate: Rate,
    /// The parameters for the decoder.
    pub(crate) parameters: &'a Parameters,
    /// The pictures.
    pub(crate) samples: &'a [Sample],
}

/// A box: its length, its name and its content.
fn boxed(name: &[u8; 4], parts: &[&[u8]]) -> Vec<u8> {
    let length: usize = parts.iter().map(|part| part.len()).sum();
    let mut out = Vec::with_capacity(8 + length);
    out.extend((length as u32 + 8).to_be_bytes());
    out.extend(name);
    parts.iter().for_each(|part| out.extend(*part));
    out
}

/// Converts integers of different sizes to bytes.
macro_rules! bytes {
    ($($number:expr),* $(,)?) => {{
        let mut out: Vec<u8> = Vec::new();
        $(out.extend($number.to_be_bytes());)*
        out
    }};
}

/// The identity matrix.
fn unit_matrix() -> Vec<u8> {
    [0x1_0000_u32, 0, 0, 0, 0x1_0000, 0, 0, 0, 0x4000_0000].iter().flat_map(|number| number.to_be_bytes()).collect()
}

/// Version 1: times have 64 bits.
const LONG: u32 = 1 << 24;

impl Film<'_> {
    /// Writes the header of the file; the pictures follow, each with its length in four bytes.
    pub(crate) fn write_head(&self, out: &mut impl Write) -> Result<()> {
        let kind = boxed(b"ftyp", &[b"isom", &bytes![512_u32], b"isomiso2avc1mp41"]);
        let data: u64 = self.samples.iter().map(|sample| u64::from(sample.size)).sum();
        let long = data + 8 > u64::from(u32::MAX);
        let data_head = if long { 16 } else { 8 };
        // The size of the header does not depend on the value of the offset.
        let length = kind.len() + self.movie(0).len() + data_head;
        out.write_all(&kind)?;
        out.write_all(&self.movie(length as u64))?;
        if long {
            out.write_all(&bytes![1_u32])?;
            out.write_all(b"mdat")?;
            return out.write_all(&bytes![data + 16]);
        }
        out.write_all(&bytes![data as u32 + 8])?;
        out.write_all(b"mdat")
    }

    /// Everything except the pictures, which begin at the given offset in the file.
    fn movie(&self, start: u64) -> Vec<u8> {
        let duration = self.samples.len() as u64 * u64::from(self.rate.frame);
        let ticks = self.rate.ticks;
        let movie = boxed(
            b"mvhd",
            &[
                &bytes![LONG, 0_u64, 0_u64, ticks, duration, 0x1_0000_u32, 0x100_u16],
                &[0; 10],
                &unit_matrix(),
                &[0; 24],
                &bytes![2_u32],
            ],
        );
        let [width, height] = self.size;
        let track = boxed(
            b"tkhd",
            &[
                // The flags mean that the track is enabled and part of the film.
                &bytes![LONG | 3, 0_u64, 0_u64, 1_u32, 0_u32, duration],
                &[0; 16],
                &unit_matrix(),
                &bytes![width << 16, height << 16],
            ],
        );
        // The language is undetermined: `und`.
        let media = boxed(b"mdhd", &[&bytes![LONG, 0_u64, 0_u64, ticks, duration, 0x55C4_u16, 0_u16]]);
        let handler = boxed(b"hdlr", &[&[0; 8], b"vide", &[0; 12], b"Opruga\0"]);
        let look = boxed(b"vmhd", &[&bytes![1_u32], &[0; 8]]);
        let here = boxed(b"url ", &[&bytes![1_u32]]);
        let reference = boxed(b"dref", &[&bytes![0_u32, 1_u32], &here]);
        let data = boxed(b"dinf", &[&reference]);
        let information = boxed(b"minf", &[&look, &data, &self.table(start)]);
        let media = boxed(b"mdia", &[&media, &handler, &information]);
        boxed(b"moov", &[&movie, &boxed(b"trak", &[&track, &media])])
    }

    /// The table of the pictures.
    fn table(&self, start: u64) -> Vec<u8> {
        let count = self.samples.len() as u32;
        let description = boxed(b"stsd", &[&bytes![0_u32, 1_u32], &self.entry()]);
        let times = boxed(b"stts", &[&bytes![0_u32, 1_u32, count, self.rate.frame]]);
        let refreshes: Vec<u8> = (1_u32..)
            .zip(self.samples)
            .filter(|(_, sample)| sample.refresh)
            .flat_map(|(number, _)| number.to_be_bytes())
            .collect();
        let starts = boxed(b"stss", &[&bytes![0_u32, refreshes.len() as u32 / 4], &refreshes]);
        // All pictures are one chunk.
        let chunks = boxed(b"stsc", &[&bytes![0_u32, 1_u32, 1_u32, count, 1_u32]]);
        let sizes: Vec<u8> = self.samples.iter().flat_map(|sample| sample.size.to_be_bytes()).collect();
        let sizes = boxed(b"stsz", &[&bytes![0_u32, 0_u32, count], &sizes]);
        let offsets = boxed(b"co64", &[&bytes![0_u32, 1_u32, start]]);
        boxed(b"stbl", &[&description, &times, &starts, &chunks, &sizes, &offsets])
    }

    /// The parameters for the decoder.
    fn entry(&self) -> Vec<u8> {
        let Parameters { sequence, picture } = self.parameters;
        let configuration = boxed(
            b"avcC",
            &[
                // The profile and the level are copied from the parameters. The last two bytes mean that lengths have four bytes, and that there is
                // one parameter set.
                &[1, sequence[1], sequence[2], sequence[3], 0xFF, 0xE1],
                &bytes![sequence.len() as u16],
                sequence,
                &[1],
                &bytes![picture.len() as u16],
                picture,
            ],
        );
        // BT.709 in the limited range.
        let colours = boxed(b"colr", &[b"nclx", &bytes![1_u16, 1_u16, 1_u16, 0_u8]]);
        let [width, height] = self.size.map(|side| side as u16);
        boxed(
            b"avc1",
            &[
                &[0; 6],
                &bytes![1_u16],
                &[0; 16],
                &bytes![width, height, 0x48_0000_u32, 0x48_0000_u32, 0_u32, 1_u16],
                &[0; 32],
                &bytes![24_u16, u16::MAX],
                &configuration,
                &colours,
            ],
        )
    }
}
