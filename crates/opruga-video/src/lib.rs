//! Films as MP4 with H.264, constrained baseline profile, in pure Rust.
//!
//! The encoder is made for drawn pictures. An unchanged macroblock takes hardly any time and bits, and a moved one is searched for in the previous
//! frame. There is no deblocking, so that lines and letters stay sharp. The same frames give the same bytes everywhere. ITU-T recommendation H.264 is
//! the source of all tables and formulas.

// Only tests use floating-point functions: they compare pictures, not physics.
#![cfg_attr(test, allow(clippy::disallowed_methods))]

mod bits;
mod encoder;
mod entropy;
mod error;
mod frame;
mod image;
mod mp4;
mod parameters;
mod predict;
mod residual;
mod tables;
mod transform;

pub use error::VideoError;

use encoder::Encoder;
use image::Image;
use mp4::{Film, Sample};
use parameters::{Parameters, Rate};
use std::io::Write;

/// The quantiser: smaller numbers keep more detail.
const QUANTISER: u8 = 20;

/// The time from one independent frame to the next [s], which determines how precisely a player can seek.
const PERIOD: f64 = 2.0;

/// Writes a film frame by frame. Only the coded frames stay in memory until [`Mp4Writer::finish`].
pub struct Mp4Writer<W: Write> {
    out: W,
    size: [u32; 2],
    rate: Rate,
    parameters: Parameters,
    encoder: Encoder,
    samples: Vec<Sample>,
    data: Vec<u8>,
}

impl<W: Write> core::fmt::Debug for Mp4Writer<W> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Mp4Writer")
            .field("size", &self.size)
            .field("frames", &self.samples.len())
            .finish_non_exhaustive()
    }
}

impl<W: Write> Mp4Writer<W> {
    /// Begins a film with frames of one size, in pixels. If a side is odd, its last column or row is repeated.
    ///
    /// # Errors
    /// [`VideoError`] if there are no pixels or more than the format allows (about 35 million), or if the rate is not between 0.0001 and 10,000
    /// frames per second.
    pub fn new(out: W, size: [u32; 2], frames_per_second: f64) -> Result<Mp4Writer<W>, VideoError> {
        let [width, height] = size;
        if width == 0 || height == 0 || width > 16_384 || height > 16_384 {
            return Err(VideoError::Size { width, height });
        }
        let rate = Rate::new(frames_per_second)?;
        let period = (PERIOD * rate.frames_per_second()).round().clamp(1.0, 600.0) as u32;
        Ok(Mp4Writer {
            out,
            size,
            rate,
            parameters: Parameters::new(size, rate, QUANTISER)?,
            encoder: Encoder::new(size, QUANTISER, period),
            samples: Vec::new(),
            data: Vec::new(),
        })
    }

    /// Adds a frame, row by row from the top. Every pixel has four bytes: red, green, blue and an opacity, which is ignored.
    ///
    /// # Errors
    /// [`VideoError::FrameSize`] if the frame has another size; the film can continue without it.
    pub fn push(&mut self, size: [u32; 2], pixels: &[u8]) -> Result<(), VideoError> {
        let image = Image { size, pixels };
        if size != self.size || pixels.len() as u64 != 4 * u64::from(size[0]) * u64::from(size[1]) {
            let ([width, height], [film_width, film_height]) = (size, self.size);
            return Err(VideoError::FrameSize { width, height, film_width, film_height });
        }
        let coded = self.encoder.code(image);
        self.samples.push(Sample { size: coded.unit.len() as u32 + 4, refresh: coded.refresh });
        self.data.extend((coded.unit.len() as u32).to_be_bytes());
        self.data.extend(coded.unit);
        Ok(())
    }

    /// Writes the file and returns the writer.
    ///
    /// # Errors
    /// [`VideoError`] if there is no frame, or if the bytes cannot be written.
    pub fn finish(mut self) -> Result<W, VideoError> {
        if self.samples.is_empty() {
            return Err(VideoError::Empty {});
        }
        let size = self.size.map(|side| side.next_multiple_of(2));
        let film = Film { size, rate: self.rate, parameters: &self.parameters, samples: &self.samples };
        film.write_head(&mut self.out)?;
        self.out.write_all(&self.data)?;
        self.out.flush()?;
        Ok(self.out)
    }
}

#[cfg(test)]
mod tests;
