//! Films as a whole. With `OPRUGA_FILMS=FOLDER` every film is written there too, as `NAME.mp4`, with what its decoder
//! must show as `NAME.yuv`: `ffmpeg -i NAME.mp4 -f rawvideo OTHER.yuv` and `cmp` check both.

use super::*;
use crate::canvas::{Anchor, Canvas};

/// A film, and what a decoder must show of each frame: three planes without what is cut off.
struct Made {
    bytes: Vec<u8>,
    shown: Vec<[Vec<u8>; 3]>,
}

/// Makes a film.
fn film(name: &str, size: [u32; 2], rate: f64, images: &[Image]) -> Made {
    let mut writer = Mp4Writer::new(Vec::new(), size, rate).expect("a writer");
    let mut shown = Vec::new();
    for image in images {
        writer.push(image).expect("a frame");
        shown.push(planes(writer.encoder.drawn(), size));
    }
    let bytes = writer.finish().expect("a film");
    if let Ok(folder) = std::env::var("OPRUGA_FILMS") {
        let folder = std::path::Path::new(&folder);
        std::fs::write(folder.join(format!("{name}.mp4")), &bytes).expect("a file");
        std::fs::write(folder.join(format!("{name}.yuv")), shown.as_flattened().concat()).expect("a file");
    }
    Made { bytes, shown }
}

/// The planes of a frame as they are shown.
fn planes(frame: &frame::Frame, size: [u32; 2]) -> [Vec<u8>; 3] {
    std::array::from_fn(|plane| {
        let [width, height] = size.map(|side| (side as usize).next_multiple_of(2) / if plane == 0 { 1 } else { 2 });
        let rows = frame.planes[plane].chunks_exact(frame.stride(plane)).take(height);
        rows.flat_map(|row| &row[..width]).copied().collect()
    })
}

/// A disc that moves over lines and letters.
fn scene([width, height]: [u32; 2], step: u32) -> Image {
    let mut image = Image::new(width, height, [255; 3]).expect("an image");
    let mut canvas = Canvas::new(&mut image);
    let (w, h) = (width as f32, height as f32);
    canvas.rectangle([0.0, 0.85 * h, w, 0.15 * h], [226, 228, 232], 1.0);
    for line in 0..12 {
        let x = w * line as f32 / 12.0;
        canvas.line(&[[x, 0.85 * h], [x - 0.03 * w, 0.9 * h]], 1.0, [116, 122, 132], 1.0);
    }
    let middle = [(0.2 + 0.01 * step as f32) * w, (0.3 + 0.013 * step as f32) * h];
    canvas.disc(middle, 0.15 * h, [20, 26, 40]);
    canvas.disc(middle, 0.14 * h, [122, 174, 214]);
    canvas.text(
        &format!("t = {:.3} s", 0.05 * f64::from(step)),
        [0.5 * w, 0.12 * h],
        15.0,
        Anchor::Start,
        [38, 42, 50],
    );
    image
}

/// Every pixel by chance.
fn noise([width, height]: [u32; 2], seed: u32) -> Image {
    let mut state = seed;
    let mut image = Image::new(width, height, [0; 3]).expect("an image");
    for pixel in image.pixels_mut().chunks_exact_mut(4) {
        for value in &mut pixel[..3] {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *value = (state >> 24) as u8;
        }
    }
    image
}

/// How well the brightness is kept [dB].
fn quality(image: &Image, shown: &[Vec<u8>; 3]) -> f64 {
    let blocks = [image.width(), image.height()].map(|side| (side as usize).div_ceil(16));
    let mut frame = frame::Frame::new(blocks[0], blocks[1]);
    for y in 0..blocks[1] {
        (0..blocks[0]).for_each(|x| frame.take(image, [x, y]));
    }
    let wanted = planes(&frame, [image.width(), image.height()]);
    let square = |(a, b): (&u8, &u8)| f64::from(a.abs_diff(*b)).powi(2);
    let mean = wanted[0].iter().zip(&shown[0]).map(square).sum::<f64>() / wanted[0].len() as f64;
    10.0 * (255.0 * 255.0 / mean.max(1e-9)).log10()
}

/// FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01B3))
}

#[test]
fn a_drawn_film_is_small_and_sharp() {
    let size = [320, 240];
    let images: Vec<Image> = (0..45).map(|step| scene(size, step)).collect();
    let made = film("drawn", size, 20.0, &images);
    for (image, shown) in images.iter().zip(&made.shown) {
        let quality = quality(image, shown);
        assert!(quality > 40.0, "{quality} dB");
    }
    assert!(made.bytes.len() < 100_000, "{} bytes", made.bytes.len());
}

#[test]
fn noise_of_any_size_is_coded() {
    for size in [[1, 1], [17, 5], [33, 47], [64, 64], [130, 70]] {
        let images: Vec<Image> = [1, 1, 2, 3, 3, 3].map(|seed| noise(size, seed)).into();
        let made = film(&format!("noise-{}-{}", size[0], size[1]), size, 2.5, &images);
        for (image, shown) in images.iter().zip(&made.shown) {
            assert!(quality(image, shown) > 36.0, "{size:?}");
        }
    }
}
