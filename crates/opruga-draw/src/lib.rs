//! Pictures, film strips, plots and videos of deformable bodies, without a graphics card.
//!
//! A [`Picture`] says what is seen at one moment. A [`View`], fitted to all pictures of a run, says from where. Then
//! [`draw`] makes an [`Image`], [`strip`] a row of them, and [`GifWriter`] and [`Mp4Writer`] a video.
// The fixed elementary functions are for physics; a picture may differ in a last bit.
#![allow(clippy::disallowed_methods)]

mod canvas;
mod colour;
mod error;
mod flat;
mod image;
mod layout;
mod marks;
mod picture;
mod ticks;
mod view;

pub use colour::{BODIES, ColourMap, OKABE_ITO};
pub use error::DrawError;
pub use image::Image;
pub use layout::Style;
pub use picture::{
    ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, Facets, Legend, Picture, PullPicture,
};
pub use ticks::{
    decades, format_tick, format_value, nice_length, nice_step, nice_ticks, scientific,
};
pub use view::View;

/// Draws a picture as it is seen in a view.
pub fn draw(picture: &Picture, view: &View, style: &Style) -> Result<Image, DrawError> {
    picture.check()?;
    flat::draw(picture, view, style)
}
