//! An opaque image and its PNG form.

use crate::error::DrawError;
use std::io::Write;

/// The longest side of an image, in pixels.
const LONGEST_SIDE: u32 = 16384;

/// An image whose pixels are red, green, blue and full opacity, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    /// The width in pixels.
    width: u32,
    /// The height in pixels.
    height: u32,
    /// Four bytes per pixel.
    pixels: Vec<u8>,
}

impl Image {
    /// An image of one colour.
    pub fn new(width: u32, height: u32, colour: [u8; 3]) -> Result<Image, DrawError> {
        if !(1..=LONGEST_SIDE).contains(&width) || !(1..=LONGEST_SIDE).contains(&height) {
            return Err(DrawError::Size { width, height });
        }
        let pixel = [colour[0], colour[1], colour[2], 255];
        Ok(Image { width, height, pixels: pixel.repeat(width as usize * height as usize) })
    }

    /// The width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// The height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Four bytes per pixel: red, green, blue and 255.
    pub fn pixels(&self) -> &[u8] {
        &self.pixels
    }

    /// The bytes of the pixels, for modification.
    pub(crate) fn pixels_mut(&mut self) -> &mut [u8] {
        &mut self.pixels
    }

    /// The colour of a pixel; black outside the image.
    pub fn pixel(&self, x: u32, y: u32) -> [u8; 3] {
        if x >= self.width || y >= self.height {
            return [0; 3];
        }
        let offset = 4 * (y as usize * self.width as usize + x as usize);
        [self.pixels[offset], self.pixels[offset + 1], self.pixels[offset + 2]]
    }

    /// Copies another image to a position in this image. Parts outside this image are cut off.
    pub fn paste(&mut self, other: &Image, x: u32, y: u32) {
        let columns = other.width.min(self.width.saturating_sub(x)) as usize;
        let rows = other.height.min(self.height.saturating_sub(y)) as usize;
        for row in 0..rows {
            let from = 4 * row * other.width as usize;
            let to = 4 * ((y as usize + row) * self.width as usize + x as usize);
            self.pixels[to..to + 4 * columns].copy_from_slice(&other.pixels[from..from + 4 * columns]);
        }
    }

    /// Writes the image in the PNG format.
    pub fn write_png(&self, output: impl Write) -> Result<(), DrawError> {
        let mut encoder = png::Encoder::new(output, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Balanced);
        let mut writer = encoder.write_header()?;
        let bytes: Vec<u8> = self.pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        writer.write_image_data(&bytes)?;
        writer.finish()?;
        Ok(())
    }

    /// The bytes of the image in the PNG format.
    pub fn to_png(&self) -> Result<Vec<u8>, DrawError> {
        let mut bytes = Vec::new();
        self.write_png(&mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_survives_png() {
        let mut image = Image::new(3, 2, [10, 20, 30]).unwrap();
        image.paste(&Image::new(2, 2, [200, 0, 1]).unwrap(), 2, 1);
        let bytes = image.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut found = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut found).unwrap();
        assert_eq!(&found[..3], &[10, 20, 30]);
        assert_eq!(&found[15..], &[200, 0, 1]);
        assert_eq!(image.pixel(2, 1), [200, 0, 1]);
        assert!(Image::new(0, 5, [0; 3]).is_err());
    }
}
