//! The 256 colours that an animation may have.

use crate::image::Image;
use color_quant::NeuQuant;

/// The number of bits per channel that distinguish colours.
const BITS: u32 = 6;
/// The maximum number of colours of a palette.
const MOST: usize = 256;
/// The number of entries that are exactly the most frequent colours: backgrounds, lines, arrows.
const KEPT: usize = 64;

/// The colours of an animation, and the palette entry for each colour.
pub(crate) struct Palette {
    /// Red, green and blue of one colour after another.
    colours: Vec<u8>,
    /// For every coarse colour, the number of the nearest palette colour, once it has been requested.
    nearest: Vec<Option<u8>>,
}

/// The coarse colour of a pixel, as a number of six bits per channel.
fn coarse(pixel: &[u8]) -> usize {
    pixel[..3].iter().fold(0, |number, channel| (number << BITS) | usize::from(channel >> (8 - BITS)))
}

impl Palette {
    /// The palette for some frames. If they have few colours, the palette contains these colours. Otherwise, it contains the most frequent colours,
    /// and colours that a neural network learns from the remaining ones (Dekker 1994, "Kohonen neural networks for optimal colour quantization").
    pub(crate) fn of(samples: &[Image]) -> Palette {
        // The count of each coarse colour, and the sums of its channels.
        let mut sums = vec![[0u64; 4]; 1 << (3 * BITS)];
        for pixel in samples.iter().flat_map(|sample| sample.pixels().chunks_exact(4)) {
            let sum = &mut sums[coarse(pixel)];
            sum[0] += 1;
            (0..3).for_each(|c| sum[c + 1] += u64::from(pixel[c]));
        }
        sums.retain(|sum| sum[0] > 0);
        let mean = |sum: &[u64; 4]| [1, 2, 3].map(|c| ((sum[c] + sum[0] / 2) / sum[0]) as u8);
        let colours = if sums.len() <= MOST {
            sums.iter().flat_map(mean).collect()
        } else {
            sums.sort_by_key(|sum| std::cmp::Reverse(sum[0]));
            let (kept, others) = sums.split_at(KEPT);
            // Colours are weighted by the square roots of their counts. Otherwise the plain squares of a floor would use up the entries that the
            // shades of bodies need.
            let learnt: Vec<u8> = others
                .iter()
                .flat_map(|sum| {
                    let [red, green, blue] = mean(sum);
                    std::iter::repeat_n([red, green, blue, 255], (sum[0] as f64).sqrt() as usize)
                })
                .flatten()
                .collect();
            let learnt = NeuQuant::new(1, MOST - KEPT, &learnt).color_map_rgb();
            kept.iter().flat_map(mean).chain(learnt).collect()
        };
        Palette { colours, nearest: vec![None; 1 << (3 * BITS)] }
    }

    /// Red, green and blue of one colour after another.
    pub(crate) fn colours(&self) -> &[u8] {
        &self.colours
    }

    /// The index of the palette colour that is nearest to a pixel.
    pub(crate) fn nearest(&mut self, pixel: &[u8]) -> u8 {
        let index = coarse(pixel);
        if let Some(number) = self.nearest[index] {
            return number;
        }
        // All pixels with the same coarse colour get the same entry, which is the one nearest to the centre of the coarse colour. A still picture
        // therefore does not change from frame to frame.
        let middle = [0, 1, 2].map(|c| i32::from(pixel[c] >> (8 - BITS) << (8 - BITS)) + (1 << (7 - BITS)));
        let distance = |colour: &[u8]| -> i32 { (0..3).map(|c| (middle[c] - i32::from(colour[c])).pow(2)).sum() };
        let numbers = self.colours.chunks_exact(3).map(distance).enumerate();
        let number = numbers.min_by_key(|(_, far)| *far).map_or(0, |(number, _)| number) as u8;
        self.nearest[index] = Some(number);
        number
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The root mean square of the distances between the colours of an image and their palette colours.
    fn off(image: &Image, palette: &mut Palette) -> f64 {
        let mut sum = 0.0;
        for pixel in image.pixels().chunks_exact(4) {
            let number = usize::from(palette.nearest(pixel));
            let colour = &palette.colours()[3 * number..3 * number + 3];
            sum += (0..3).map(|c| f64::from(colour[c]) - f64::from(pixel[c])).map(|d| d * d).sum::<f64>();
        }
        (sum / (image.width() * image.height()) as f64).sqrt()
    }

    /// An image with the given colour at each pixel.
    fn image(size: [u32; 2], colour: impl Fn(u32, u32) -> [u8; 3]) -> Image {
        let mut image = Image::new(size[0], size[1], [0; 3]).expect("an image");
        for y in 0..size[1] {
            for x in 0..size[0] {
                let offset = 4 * (y * size[0] + x) as usize;
                image.pixels_mut()[offset..offset + 3].copy_from_slice(&colour(x, y));
            }
        }
        image
    }

    #[test]
    fn few_colours_are_kept_as_they_are() {
        let few = image([16, 16], |x, y| [252, 252, (8 * x) as u8 + u8::from(y > 7)]);
        let mut palette = Palette::of(std::slice::from_ref(&few));
        assert!(off(&few, &mut palette) < 1.0, "{}", off(&few, &mut palette));
    }

    #[test]
    fn shades_of_a_small_body_before_a_large_background_are_told_apart() {
        // Colours from blue to yellow and from light to dark fill a hundredth of a plain picture. With the 256 most frequent colours, the distance
        // would be 59.
        let wide = 600;
        let body = |x: u32, y: u32| [(4 * x) as u8, (2 * x + 2 * y) as u8, (4 * (63 - y)) as u8];
        let colour = |x, y| if x < 64 && y < 64 { body(x, y) } else { [252, 252, 253] };
        let whole = image([wide, wide], colour);
        let mut palette = Palette::of(std::slice::from_ref(&whole));
        let small = image([64, 64], body);
        let far = off(&small, &mut palette);
        assert!(far < 15.0, "{far}");
        assert!(off(&whole, &mut palette) < 2.0, "{}", off(&whole, &mut palette));
        // The background is not confused with its neighbours.
        let number = usize::from(palette.nearest(&[252, 252, 253]));
        assert_eq!(palette.colours()[3 * number..3 * number + 3], [252, 252, 253]);
    }
}
