//! A frame in the format of H.264, and the conversion of the colours of an image to it.

use crate::image::Image;

/// The number of pixels along a side of a macroblock, the unit in which a frame is encoded.
pub(crate) const BLOCK: usize = 16;

/// Luma for every pixel and two chroma values for every four pixels, in whole macroblocks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Frame {
    /// The number of macroblocks in a row.
    pub(crate) wide: usize,
    /// The number of rows of macroblocks.
    pub(crate) high: usize,
    /// Luma (Y), and chroma of blue (Cb) and red (Cr).
    pub(crate) planes: [Vec<u8>; 3],
}

impl Frame {
    /// A grey frame.
    pub(crate) fn new(wide: usize, high: usize) -> Frame {
        let blocks = wide * high;
        Frame { wide, high, planes: [256, 64, 64].map(|size| vec![128; size * blocks]) }
    }

    /// The side of a macroblock in a plane.
    pub(crate) fn side(plane: usize) -> usize {
        if plane == 0 { BLOCK } else { BLOCK / 2 }
    }

    /// The length of a row of a plane.
    pub(crate) fn stride(&self, plane: usize) -> usize {
        self.wide * Frame::side(plane)
    }

    /// The index of the first pixel of a macroblock in a plane.
    pub(crate) fn start(&self, plane: usize, [x, y]: [usize; 2]) -> usize {
        (y * self.stride(plane) + x) * Frame::side(plane)
    }

    /// Whether a macroblock has uniform luma.
    pub(crate) fn is_empty(&self, macroblock: [usize; 2]) -> bool {
        let (stride, start) = (self.stride(0), self.start(0, macroblock));
        let pixels = &self.planes[0];
        (0..BLOCK).all(|row| pixels[start + row * stride..][..BLOCK].iter().all(|pixel| *pixel == pixels[start]))
    }

    /// Copies a macroblock from another frame of the same size.
    pub(crate) fn copy_block(&mut self, from: &Frame, macroblock: [usize; 2]) {
        for plane in 0..3 {
            let (side, stride, start) = (Frame::side(plane), self.stride(plane), self.start(plane, macroblock));
            for row in 0..side {
                let part = start + row * stride..start + row * stride + side;
                self.planes[plane][part.clone()].copy_from_slice(&from.planes[plane][part]);
            }
        }
    }

    /// Copies a macroblock from an image. Beyond the edge of the image, its last column and row are repeated.
    ///
    /// The colours are converted to BT.709 in the limited range. A chroma sample belongs to two columns and two rows. As decoders expect, the sample
    /// is at the left column, and halfway between the rows.
    pub(crate) fn take(&mut self, image: Image<'_>, [x, y]: [usize; 2]) {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let pixels = image.pixels();
        let at = |column: usize, row: usize| -> [i32; 3] {
            let offset = 4 * (row.min(height - 1) * width + column.min(width - 1));
            [pixels[offset], pixels[offset + 1], pixels[offset + 2]].map(i32::from)
        };
        let (stride, start) = (self.stride(0), self.start(0, [x, y]));
        for row in 0..BLOCK {
            for column in 0..BLOCK {
                let [r, g, b] = at(BLOCK * x + column, BLOCK * y + row);
                let luma = (11_966 * r + 40_254 * g + 4_064 * b + (16 << 16) + (1 << 15)) >> 16;
                self.planes[0][start + row * stride + column] = luma as u8;
            }
        }
        let (stride, start) = (self.stride(1), self.start(1, [x, y]));
        for row in 0..BLOCK / 2 {
            for column in 0..BLOCK / 2 {
                let (middle, upper) = (BLOCK * x + 2 * column, BLOCK * y + 2 * row);
                let mut sum = [0; 3];
                for line in [upper, upper + 1] {
                    let (before, here, after) =
                        (at(middle.saturating_sub(1), line), at(middle, line), at(middle + 1, line));
                    for channel in 0..3 {
                        sum[channel] += before[channel] + 2 * here[channel] + after[channel];
                    }
                }
                let [r, g, b] = sum;
                let middle = (128 << 19) + (1 << 18);
                let index = start + row * stride + column;
                self.planes[1][index] = ((middle - 6_596 * r - 22_189 * g + 28_785 * b) >> 19) as u8;
                self.planes[2][index] = ((middle + 28_784 * r - 26_145 * g - 2_639 * b) >> 19) as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_bt_709() {
        for (colour, expected) in [
            ([255, 255, 255], [235, 128, 128]),
            ([0, 0, 0], [16, 128, 128]),
            ([255, 0, 0], [63, 102, 240]),
            ([0, 255, 0], [173, 42, 26]),
            ([0, 0, 255], [32, 240, 118]),
        ] {
            let pixels = [colour[0], colour[1], colour[2], 255].repeat(17 * 5);
            let image = Image { size: [17, 5], pixels: &pixels };
            let mut frame = Frame::new(2, 1);
            frame.take(image, [0, 0]);
            frame.take(image, [1, 0]);
            for plane in 0..3 {
                assert!(frame.planes[plane].iter().all(|value| *value == expected[plane]), "{colour:?} {plane}");
            }
        }
    }
}
