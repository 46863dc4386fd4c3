//! Draws a synthetic picture of each kind into a directory, given as the first argument (default: `gallery`).
#![allow(clippy::disallowed_methods, reason = "no physics is made here")]

#[path = "gallery/charts.rs"]
mod charts;
#[path = "gallery/flat.rs"]
mod flat;
#[path = "gallery/solid.rs"]
mod solid;

use opruga_draw::{Image, Mp4Writer, Picture, StripStyle, Style, View, draw, spread, strip};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The result of a step of the gallery.
type Outcome = Result<(), Box<dyn std::error::Error>>;

/// Writes an image and prints the time that it took to draw.
fn save(directory: &Path, name: &str, start: Instant, image: &Image) -> Outcome {
    println!("{name}: {:.1} ms", start.elapsed().as_secs_f64() * 1e3);
    image.write_png(std::fs::File::create(directory.join(name))?)?;
    Ok(())
}

/// Draws one picture in its own view.
fn single(directory: &Path, name: &str, picture: &Picture, style: &Style) -> Outcome {
    let view = View::fit([picture])?;
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        draw(picture, &view, style)?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    println!("{name}: {:.1} ms", best * 1e3);
    draw(picture, &view, style)?.write_png(std::fs::File::create(directory.join(name))?)?;
    Ok(())
}

fn main() -> Outcome {
    let directory = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "gallery".to_string()));
    std::fs::create_dir_all(&directory)?;
    let style = Style::default();

    let frames = flat::bouncing_ring(200);
    let view = View::fit(&frames)?;
    let start = Instant::now();
    let image = strip(&spread(&frames, 10), &view, &StripStyle::default())?;
    save(&directory, "strip.png", start, &image)?;
    let start = Instant::now();
    save(&directory, "ring.png", start, &draw(&frames[60], &view, &style)?)?;

    let images: Vec<Image> = frames.iter().map(|frame| draw(frame, &view, &style)).collect::<Result<_, _>>()?;
    let start = Instant::now();
    let mut film = Mp4Writer::new(std::fs::File::create(directory.join("ring.mp4"))?, [800, 600], 25.0)?;
    images.iter().try_for_each(|image| film.push(image))?;
    let bytes = film.finish()?.metadata()?.len();
    println!("ring.mp4: {:.1} ms for {} frames, {bytes} bytes", start.elapsed().as_secs_f64() * 1e3, images.len());

    single(&directory, "plate.png", &flat::plate(), &style)?;
    single(&directory, "net.png", &flat::net(), &style)?;
    single(&directory, "room.png", &flat::room(), &style)?;
    single(&directory, "bodies-1000.png", &flat::crowd(40, 25, true), &style)?;
    single(&directory, "bodies-27778.png", &flat::crowd(193, 144, false), &style)?;
    single(&directory, "balloons.png", &solid::balloons(80), &style)?;
    single(&directory, "cloth.png", &solid::cloth(60, false), &style)?;
    single(&directory, "net-solid.png", &solid::cloth(33, true), &style)?;
    single(&directory, "room-solid.png", &solid::room(), &style)?;
    for (name, chart) in [("ledger.svg", charts::ledger()), ("speed.svg", charts::speed())] {
        std::fs::write(directory.join(name), chart.to_svg()?)?;
    }
    Ok(())
}
