//! Tests of complete films. With `OPRUGA_FILMS=FOLDER` every film is also written to that folder as `NAME.mp4`, and the expected output of its
//! decoder as `NAME.yuv`. `ffmpeg -i NAME.mp4 -f rawvideo OTHER.yuv` and `cmp` compare both.

mod boxes;
mod decoder;
mod drawing;

use super::*;
use drawing::Drawing;

/// A film, and the expected output of a decoder for each frame: its three planes without the cropped part.
struct Made {
    bytes: Vec<u8>,
    shown: Vec<[Vec<u8>; 3]>,
}

/// Makes a film.
fn film(name: &str, size: [u32; 2], rate: f64, images: &[Drawing]) -> Made {
    let mut writer = Mp4Writer::new(Vec::new(), size, rate).expect("a writer");
    let mut shown = Vec::new();
    for image in images {
        writer.push(image.size, &image.pixels).expect("a frame");
        shown.push(planes(writer.encoder.shown(), size));
    }
    let bytes = writer.finish().expect("a film");
    if let Ok(folder) = std::env::var("OPRUGA_FILMS") {
        let folder = std::path::Path::new(&folder);
        std::fs::write(folder.join(format!("{name}.mp4")), &bytes).expect("a file");
        std::fs::write(folder.join(format!("{name}.yuv")), shown.as_flattened().concat()).expect("a file");
    }
    Made { bytes, shown }
}

/// The planes of a frame as shown.
fn planes(frame: &frame::Frame, size: [u32; 2]) -> [Vec<u8>; 3] {
    std::array::from_fn(|plane| {
        let [width, height] = size.map(|side| (side as usize).next_multiple_of(2) / if plane == 0 { 1 } else { 2 });
        let rows = frame.planes[plane].chunks_exact(frame.stride(plane)).take(height);
        rows.flat_map(|row| &row[..width]).copied().collect()
    })
}

/// A disc that moves over lines and digits.
fn scene([width, height]: [u32; 2], step: u32) -> Drawing {
    let mut drawing = Drawing::new(width, height, [255; 3]);
    let (w, h) = (width as f32, height as f32);
    drawing.rectangle([0.0, 0.85 * h], [w, 0.15 * h], [226, 228, 232]);
    for line in 0..12 {
        let (x, slope) = (w * line as f32 / 12.0, -0.6 * w / h);
        drawing.blend([116, 122, 132], |px, py| {
            let inside = py > 0.85 * h && py < 0.9 * h;
            if inside { 1.0 - (px - x - slope * (py - 0.85 * h)).abs() } else { 0.0 }
        });
    }
    let middle = [(0.2 + 0.01 * step as f32) * w, (0.3 + 0.013 * step as f32) * h];
    drawing.disc(middle, 0.15 * h, [20, 26, 40]);
    drawing.disc(middle, 0.14 * h, [122, 174, 214]);
    drawing.number(50 * step, [0.5 * w, 0.08 * h], [38, 42, 50]);
    drawing
}

/// A frame of random pixels.
fn noise([width, height]: [u32; 2], seed: u32) -> Drawing {
    let mut state = seed;
    let mut image = Drawing::new(width, height, [0; 3]);
    for pixel in image.pixels.chunks_exact_mut(4) {
        for value in &mut pixel[..3] {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            *value = (state >> 24) as u8;
        }
    }
    image
}

/// The peak signal-to-noise ratio of the luma [dB].
fn quality(image: Image<'_>, shown: &[Vec<u8>; 3]) -> f64 {
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

/// The hash FNV-1a.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x100_0000_01B3))
}

#[test]
fn a_drawn_film_is_small_and_sharp() {
    let size = [320, 240];
    let images: Vec<Drawing> = (0..45).map(|step| scene(size, step)).collect();
    let made = film("drawn", size, 20.0, &images);
    for (image, shown) in images.iter().zip(&made.shown) {
        let quality = quality(image.image(), shown);
        assert!(quality > 40.0, "{quality} dB");
    }
    assert!(made.bytes.len() < 60_000, "{} bytes", made.bytes.len());
    // The disc has passed through this part, which must be white again. White is 235.
    let last = &made.shown[44][0];
    let traces = (64..112).flat_map(|row| &last[row * 320 + 64..row * 320 + 112]).filter(|pixel| **pixel < 234).count();
    assert_eq!(traces, 0);
}

#[test]
fn noise_of_any_size_is_coded() {
    for size in [[1, 1], [17, 5], [33, 47], [64, 64], [130, 70]] {
        let images: Vec<Drawing> = [1, 1, 2, 3, 3, 3].map(|seed| noise(size, seed)).into();
        let made = film(&format!("noise-{}-{}", size[0], size[1]), size, 2.5, &images);
        for (image, shown) in images.iter().zip(&made.shown) {
            assert!(quality(image.image(), shown) > 38.0, "{size:?}");
        }
        check_decoded(&made, size);
    }
}

/// Decodes a film from its bytes alone, and compares every pixel with the output that the encoder expects.
fn check_decoded(made: &Made, size: [u32; 2]) {
    let (parameters, pictures) = boxes::units(&made.bytes);
    assert_eq!(pictures.len(), made.shown.len());
    let mut decoder = decoder::Decoder::new(parameters[0], parameters[1]);
    assert_eq!(decoder.size, size.map(|side| side.next_multiple_of(2)));
    for (number, (picture, shown)) in pictures.into_iter().zip(&made.shown).enumerate() {
        assert!(planes(decoder.decode(picture), size) == *shown, "{size:?}: picture {number} is shown otherwise");
    }
}

#[test]
fn a_decoder_shows_what_the_encoder_expects() {
    let size = [200, 150];
    let mut images: Vec<Drawing> = (0..30).map(|step| scene(size, step)).collect();
    // The film has a cut, an unchanged picture, and pictures that move as a whole, even beyond their edges.
    images.push(noise(size, 5));
    images.extend([scene(size, 8), scene(size, 8)]);
    for step in 0..6 {
        let mut moved = Drawing::new(size[0], size[1], [255; 3]);
        moved.paste(&noise([120, 90], 7), 100 - 20 * step, 5 + 11 * step);
        images.push(moved);
    }
    let made = film("mixed", size, 30.0, &images);
    check_decoded(&made, size);
}

#[test]
fn known_films_have_known_bytes() {
    // ffmpeg decodes exactly the expected bytes from this film, without a warning. The film contains no lines and letters, because their pixels may
    // differ on other machines.
    let size = [98, 51];
    let mut images: Vec<Drawing> = Vec::new();
    for step in 0..12 {
        let mut image = Drawing::new(size[0], size[1], [250, 252, 255]);
        image.paste(&Drawing::new(40, 30, [122, 174, 214]), 3 * step, 20 - step);
        image.paste(&noise([20, 9], 4), 60 - 2 * step, 4 * step);
        images.push(image);
    }
    images.push(noise(size, 9));
    let made = film("known", size, 12.5, &images);
    check_decoded(&made, size);
    assert_eq!(format!("{:016x}", hash(&made.bytes)), "9cc5e8c2e38d93af");
}

#[test]
fn the_boxes_of_a_film_fit_together() {
    let size = [35, 20];
    let images: Vec<Drawing> = (0..9).map(|step| scene(size, step)).collect();
    let made = film("boxes", size, 2.0, &images);
    let order: Vec<String> = boxes::read(&made.bytes).into_iter().map(|found| found.path).collect();
    let top: Vec<&String> = order.iter().filter(|path| !path.contains('/')).collect();
    assert_eq!(top, ["ftyp", "moov", "mdat"], "a player finds what it needs before the pictures");
    let table = "moov/trak/mdia/minf/stbl";
    let only = |path: &str| boxes::only(&made.bytes, path);
    let header = only("moov/trak/mdia/mdhd");
    let ticks = boxes::number(header, 20);
    let times = only(&format!("{table}/stts"));
    assert_eq!([boxes::number(times, 4), boxes::number(times, 8)], [1, 9], "all pictures are equally long");
    assert_eq!(boxes::number(times, 12) * 2, ticks, "two pictures a second");
    assert_eq!(boxes::number(header, 28), 9 * ticks / 2, "four and a half seconds");
    let starts = only(&format!("{table}/stss"));
    let starts: Vec<usize> = (0..boxes::number(starts, 4)).map(|n| boxes::number(starts, 8 + 4 * n)).collect();
    assert_eq!(starts, [1, 5, 9], "every two seconds");
    let track = only("moov/trak/tkhd");
    assert_eq!([track.len() - 8, track.len() - 4].map(|place| boxes::number(track, place) >> 16), [36, 20]);
    let (_, pictures) = boxes::units(&made.bytes);
    let refreshes: Vec<usize> = (1..).zip(&pictures).filter(|(_, unit)| unit[0] == 0x65).map(|(n, _)| n).collect();
    assert_eq!(refreshes, starts);
}

#[test]
fn a_film_may_have_one_frame_but_not_none() {
    let made = film("one", [64, 48], 20.0, &[scene([64, 48], 3)]);
    check_decoded(&made, [64, 48]);
    let none = Mp4Writer::new(Vec::new(), [64, 48], 20.0).expect("a writer").finish();
    assert!(matches!(none, Err(VideoError::Empty {})));
}

#[test]
fn what_cannot_be_written_is_an_error() {
    let new = |size, rate| Mp4Writer::new(Vec::new(), size, rate);
    for size in [[0, 4], [4, 0], [16_385, 4], [16_384, 16_384]] {
        assert!(matches!(new(size, 20.0), Err(VideoError::Size { .. })), "{size:?}");
    }
    for rate in [0.0, -1.0, f64::NAN, 1e9] {
        assert!(matches!(new([4, 4], rate), Err(VideoError::Rate { .. })), "{rate}");
    }
    let mut writer = new([4, 6], 20.0).expect("a writer");
    let other = Drawing::new(6, 4, [0; 3]);
    assert!(matches!(
        writer.push(other.size, &other.pixels),
        Err(VideoError::FrameSize { width: 6, height: 4, film_width: 4, film_height: 6 })
    ));
    writer.push([4, 6], &Drawing::new(4, 6, [0; 3]).pixels).expect("the film goes on");
    assert_eq!(boxes::units(&writer.finish().expect("a film")).1.len(), 1);
    struct Full;
    impl Write for Full {
        fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
            Err(std::io::ErrorKind::StorageFull.into())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut writer = Mp4Writer::new(Full, [4, 4], 20.0).expect("a writer");
    writer.push([4, 4], &Drawing::new(4, 4, [0; 3]).pixels).expect("a frame");
    assert!(matches!(writer.finish(), Err(VideoError::Write { .. })));
}

#[test]
fn a_picture_that_stays_costs_hardly_any_bytes() {
    let size = [320, 240];
    let made = film("still", size, 25.0, &vec![scene(size, 5); 30]);
    let (_, pictures) = boxes::units(&made.bytes);
    assert!(pictures[1..].iter().all(|picture| picture.len() < 16), "{:?}", pictures[1].len());
    assert!(made.shown.iter().all(|shown| *shown == made.shown[0]));
}
