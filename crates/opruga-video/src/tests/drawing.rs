//! Test frames of smooth and sharp shapes.

use crate::image::Image;

/// A frame to draw on.
#[derive(Clone)]
pub(super) struct Drawing {
    pub(super) size: [u32; 2],
    pub(super) pixels: Vec<u8>,
}

/// Digits, five rows of three pixels each.
const DIGITS: [[u8; 5]; 10] = [
    [7, 5, 5, 5, 7],
    [2, 6, 2, 2, 7],
    [7, 1, 7, 4, 7],
    [7, 1, 7, 1, 7],
    [5, 5, 7, 1, 1],
    [7, 4, 7, 1, 7],
    [7, 4, 7, 5, 7],
    [7, 1, 1, 2, 2],
    [7, 5, 7, 5, 7],
    [7, 5, 7, 1, 7],
];

impl Drawing {
    /// A frame of one colour.
    pub(super) fn new(width: u32, height: u32, [r, g, b]: [u8; 3]) -> Drawing {
        Drawing { size: [width, height], pixels: [r, g, b, 255].repeat((width * height) as usize) }
    }
    /// The frame in the form that the film accepts.
    pub(super) fn image(&self) -> Image<'_> {
        Image { size: self.size, pixels: &self.pixels }
    }
    /// Blends a colour into every pixel, weighted by the fraction that a shape covers.
    pub(super) fn blend(&mut self, colour: [u8; 3], covered: impl Fn(f32, f32) -> f32) {
        let width = self.size[0] as usize;
        for (index, pixel) in self.pixels.chunks_exact_mut(4).enumerate() {
            let part = covered((index % width) as f32 + 0.5, (index / width) as f32 + 0.5).clamp(0.0, 1.0);
            for (value, new) in pixel.iter_mut().zip(colour) {
                *value = (f32::from(*value) * (1.0 - part) + f32::from(new) * part).round() as u8;
            }
        }
    }
    /// A disc with a smooth edge.
    pub(super) fn disc(&mut self, [x, y]: [f32; 2], radius: f32, colour: [u8; 3]) {
        self.blend(colour, |px, py| radius + 0.5 - ((px - x) * (px - x) + (py - y) * (py - y)).sqrt());
    }
    /// A rectangle, given by its upper left corner.
    pub(super) fn rectangle(&mut self, [x, y]: [f32; 2], [width, height]: [f32; 2], colour: [u8; 3]) {
        self.blend(colour, |px, py| if px >= x && py >= y && px < x + width && py < y + height { 1.0 } else { 0.0 });
    }
    /// Draws a number; each pixel of its digits becomes a square of three by three pixels.
    pub(super) fn number(&mut self, value: u32, [x, y]: [f32; 2], colour: [u8; 3]) {
        for (place, digit) in value.to_string().bytes().enumerate() {
            for (row, bits) in DIGITS[usize::from(digit - b'0')].iter().enumerate() {
                for column in (0..3).filter(|column| bits & (4 >> column) != 0) {
                    let corner = [x + 3.0 * (4 * place + column) as f32, y + 3.0 * row as f32];
                    self.rectangle(corner, [3.0, 3.0], colour);
                }
            }
        }
    }
    /// Copies another drawing to a position in this drawing. Parts outside are cut off.
    pub(super) fn paste(&mut self, other: &Drawing, x: u32, y: u32) {
        for row in 0..other.size[1].min(self.size[1].saturating_sub(y)) {
            let columns = other.size[0].min(self.size[0].saturating_sub(x)) as usize;
            let from = 4 * (row * other.size[0]) as usize;
            let to = 4 * ((y + row) * self.size[0] + x) as usize;
            self.pixels[to..to + 4 * columns].copy_from_slice(&other.pixels[from..from + 4 * columns]);
        }
    }
}
