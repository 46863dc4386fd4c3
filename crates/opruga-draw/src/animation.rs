//! Films as MP4 and as GIF. A GIF has one palette for all frames, and contains only the changed part of every frame.

use crate::error::{DrawError, Nothing};
use crate::image::Image;
use crate::palette::Palette;
use std::io::Write;

/// Writes an H.264 film frame by frame (`opruga-video`).
#[derive(Debug)]
pub struct Mp4Writer<W: Write>(opruga_video::Mp4Writer<W>);

impl<W: Write> Mp4Writer<W> {
    /// Begins a film with frames of one size, in pixels. If a side is odd, its last column or row is repeated.
    ///
    /// # Errors
    /// [`DrawError::Video`] if the size or the rate is outside the range that the format allows.
    pub fn new(out: W, size: [u32; 2], frames_per_second: f64) -> Result<Mp4Writer<W>, DrawError> {
        Ok(Mp4Writer(opruga_video::Mp4Writer::new(out, size, frames_per_second)?))
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`DrawError::Video`] if the frame has another size; the film can continue without it.
    pub fn push(&mut self, image: &Image) -> Result<(), DrawError> {
        Ok(self.0.push([image.width(), image.height()], image.pixels())?)
    }

    /// Writes the file and returns the writer.
    ///
    /// # Errors
    /// [`DrawError::Video`] if there is no frame, or if the bytes cannot be written.
    pub fn finish(self) -> Result<W, DrawError> {
        Ok(self.0.finish()?)
    }
}

/// Writes an animated GIF frame by frame.
pub struct GifWriter<W: Write> {
    encoder: gif::Encoder<W>,
    size: [u32; 2],
    palette: Palette,
    last: Option<Vec<u8>>,
    /// The length of a frame in hundredths of a second, the unit of GIF.
    delay: f64,
    frames: u64,
}

impl<W: Write> core::fmt::Debug for GifWriter<W> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("GifWriter").field("size", &self.size).finish_non_exhaustive()
    }
}

impl<W: Write> GifWriter<W> {
    /// Begins an animation that repeats for ever, with a palette made from sample frames.
    ///
    /// # Errors
    /// [`DrawError`] if there is no sample, if an image is larger than a GIF may be, or if `out` cannot be written.
    pub fn new(out: W, frames_per_second: f64, samples: &[Image]) -> Result<GifWriter<W>, DrawError> {
        let first = samples.first().ok_or(DrawError::Empty { nothing: Nothing::Sample })?;
        let size = [first.width(), first.height()];
        let (Ok(width), Ok(height)) = (u16::try_from(size[0]), u16::try_from(size[1])) else {
            return Err(DrawError::Size { width: size[0], height: size[1] });
        };
        if !(frames_per_second > 0.0 && frames_per_second.is_finite()) {
            return Err(DrawError::Rate { rate: frames_per_second });
        }
        let palette = Palette::of(samples);
        let mut encoder = gif::Encoder::new(out, width, height, palette.colours()).map_err(DrawError::from)?;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(DrawError::from)?;
        // Viewers show frames that are shorter than two hundredths of a second for longer than requested.
        let delay = (100.0 / frames_per_second).clamp(2.0, 6000.0);
        Ok(GifWriter { encoder, size, palette, last: None, delay, frames: 0 })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// [`DrawError`] if the frame has another size, or if it cannot be written.
    pub fn push(&mut self, image: &Image) -> Result<(), DrawError> {
        if [image.width(), image.height()] != self.size {
            return Err(DrawError::FrameSize { expected: self.size, found: [image.width(), image.height()] });
        }
        let pixels: Vec<u8> = image.pixels().chunks_exact(4).map(|p| self.palette.nearest(p)).collect();
        let (width, height) = (self.size[0] as usize, self.size[1] as usize);
        let [left, top, right, bottom] = match &self.last {
            Some(last) => changed(last, &pixels, width),
            None => [0, 0, width, height],
        };
        let mut part = Vec::with_capacity((right - left) * (bottom - top));
        for row in top..bottom {
            part.extend(&pixels[row * width + left..row * width + right]);
        }
        // The end of each frame is rounded to a hundredth of a second, and not its length, so that rounding errors do not add up.
        let end = |frames: u64| (frames as f64 * self.delay).round() as u64;
        let delay = (end(self.frames + 1) - end(self.frames)) as u16;
        self.frames += 1;
        let frame = gif::Frame {
            delay,
            left: left as u16,
            top: top as u16,
            width: (right - left) as u16,
            height: (bottom - top) as u16,
            dispose: gif::DisposalMethod::Keep,
            buffer: part.into(),
            ..gif::Frame::default()
        };
        self.encoder.write_frame(&frame).map_err(DrawError::from)?;
        self.last = Some(pixels);
        Ok(())
    }
}

/// Returns the left, top, right and bottom of the region in which two images differ; one pixel if they are equal.
fn changed(a: &[u8], b: &[u8], width: usize) -> [usize; 4] {
    let mut bounds = [width, a.len() / width, 0, 0];
    for (index, (x, y)) in a.iter().zip(b).enumerate() {
        if x != y {
            let (column, row) = (index % width, index / width);
            bounds = [bounds[0].min(column), bounds[1].min(row), bounds[2].max(column + 1), bounds[3].max(row + 1)];
        }
    }
    if bounds[2] == 0 { [0, 0, 1, 1] } else { bounds }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_delays_do_not_add_up() {
        let image = Image::new(2, 2, [0; 3]).expect("an image");
        for rate in [30.0, 24.0, 60.0, 12.5, 1000.0 / 48.0] {
            let mut bytes = Vec::new();
            let mut writer = GifWriter::new(&mut bytes, rate, std::slice::from_ref(&image)).expect("a writer");
            (0..100).for_each(|_| writer.push(&image).expect("a frame"));
            drop(writer);
            let mut decoder = gif::DecodeOptions::new().read_info(&bytes[..]).expect("a GIF");
            let (mut time, mut frames) = (0, 0);
            while let Some(frame) = decoder.read_next_frame().expect("a frame") {
                (time, frames) = (time + i32::from(frame.delay), frames + 1);
                let exact = f64::from(frames) * (100.0 / rate).max(2.0);
                assert!((f64::from(time) - exact).abs() <= 0.5 + 1e-9, "{rate}: frame {frames} ends at {time}");
                assert!((f64::from(frame.delay) - 100.0 / rate).abs() < 1.0 || rate > 50.0);
            }
            assert_eq!(frames, 100);
        }
    }

    #[test]
    fn frames_come_back_with_their_size_delay_and_colours() {
        let red = Image::new(20, 10, [248, 0, 0]).expect("an image");
        let blue = Image::new(20, 10, [0, 0, 248]).expect("an image");
        let mut bytes = Vec::new();
        let mut writer = GifWriter::new(&mut bytes, 25.0, &[red.clone(), blue.clone()]).expect("a writer");
        writer.push(&red).expect("a frame");
        writer.push(&blue).expect("a frame");
        writer.push(&blue).expect("a frame");
        drop(writer);
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).expect("a GIF");
        let mut frames = Vec::new();
        while let Some(frame) = decoder.read_next_frame().expect("a frame") {
            frames.push((frame.width, frame.height, frame.delay, frame.buffer[0], frame.buffer[2]));
        }
        assert_eq!(frames.len(), 3);
        assert_eq!((frames[0].0, frames[0].1, frames[0].2), (20, 10, 4));
        assert!(frames[0].3 > 240 && frames[0].4 < 10 && frames[1].4 > 240);
        assert_eq!((frames[2].0, frames[2].1), (1, 1), "nothing has changed");
    }
}
