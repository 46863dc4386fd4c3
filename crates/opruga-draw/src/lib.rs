//! Pictures, film strips, plots and videos of deformable bodies, without a graphics card.
//!
//! A [`Picture`] describes what is visible at one moment. A [`View`], which is fitted to all pictures of a run, describes how it is seen. From these,
//! [`draw`] makes an [`Image`], [`strip`] a row of images, and [`Mp4Writer`] or [`GifWriter`] a film.
// Only physics needs the reproducible elementary functions; pictures may differ in the last bit between machines.
#![allow(clippy::disallowed_methods)]

mod animation;
mod canvas;
mod colour;
mod error;
mod eye;
mod fitting;
mod flat;
mod framing;
mod image;
mod layout;
mod marks;
mod palette;
mod picture;
mod plot;
mod solid;
mod strip;
mod ticks;
mod view;

pub use animation::{GifWriter, Mp4Writer};
pub use canvas::FONT;
pub use colour::{BODIES, ColourMap, OKABE_ITO};
pub use error::{DrawError, MESSAGES, Nothing, PictureList};
pub use eye::{Eye, Lens, scene as draw_scene};
pub use fitting::Fitting;
pub use image::Image;
pub use layout::Style;
pub use marks::{arrow_colour, arrow_unit};
pub use picture::{
    AreaPicture, ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, Facets, Legend, Picture, PullPicture,
    RestPicture, Sight,
};
pub use plot::{Axis, Chart, HeatMap, HeatPanel, Level, Line, Marker, Panel};
pub use strip::{StripStyle, best_count, captioned_strip, spread, strip};
pub use ticks::{decades, format_tick, format_value, nice_length, nice_step, nice_ticks, scientific};
pub use view::View;

/// Draws a picture as seen in a view.
pub fn draw(picture: &Picture, view: &View, style: &Style) -> Result<Image, DrawError> {
    let mut image = Image::new(style.width, style.height, style.background)?;
    let layout = layout::Layout::new(picture, view, style);
    let [left, top, width, height] = layout.scene;
    let (scene, scale) = scene(picture, view, style.background, [width, height], layout.unit)?;
    image.paste(&scene, left, top);
    layout.annotate(&mut canvas::Canvas::new(&mut image), picture, view, style, scale);
    Ok(image)
}

/// Draws the scene of a picture, and returns the number of pixels per metre, which in space applies at the centre of the view.
fn scene(
    picture: &Picture,
    view: &View,
    background: [u8; 3],
    size: [u32; 2],
    unit: f32,
) -> Result<(Image, f64), DrawError> {
    picture.check()?;
    match picture.dimension {
        3 => solid::scene(picture, view, background, size, unit),
        _ => flat::scene(picture, view, background, size, unit),
    }
}
