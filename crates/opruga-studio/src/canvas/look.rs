//! The colours of the canvas, and the data that all drawing functions need.

use crate::shown::{Show, Shown};
use egui::{Color32, Rect, Ui};

/// The colour of the rubber band of a pull.
pub(crate) const RUBBER: Color32 = Color32::from_rgb(214, 50, 100);

/// The data that all drawing functions need.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a> {
    pub(crate) painter: &'a egui::Painter,
    pub(crate) shown: &'a Shown,
    /// The rectangle of the scene.
    pub(crate) rect: Rect,
    pub(crate) paper: &'a Paper,
    /// The quantities and marks that the user wants to see.
    pub(crate) show: Show,
    /// The range of the colours.
    pub(crate) range: [f64; 2],
}

/// Colours of the canvas in a theme.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paper {
    pub(crate) background: Color32,
    pub(crate) grid: Color32,
    pub(crate) ink: Color32,
    pub(crate) soft: Color32,
    pub(crate) solid: Color32,
    pub(crate) solid_edge: Color32,
    pub(crate) dark: bool,
}

impl Paper {
    pub(crate) fn of(ui: &Ui) -> Paper {
        if ui.visuals().dark_mode {
            Paper {
                background: Color32::from_rgb(24, 26, 31),
                grid: Color32::from_rgb(36, 39, 46),
                ink: Color32::from_rgb(226, 229, 235),
                soft: Color32::from_rgb(142, 148, 160),
                solid: Color32::from_rgb(48, 52, 61),
                solid_edge: Color32::from_rgb(118, 126, 140),
                dark: true,
            }
        } else {
            Paper {
                background: Color32::from_rgb(252, 252, 253),
                grid: Color32::from_rgb(236, 238, 242),
                ink: Color32::from_rgb(38, 42, 50),
                soft: Color32::from_rgb(108, 114, 124),
                solid: Color32::from_rgb(226, 228, 232),
                solid_edge: Color32::from_rgb(116, 122, 132),
                dark: false,
            }
        }
    }
}

pub(super) fn colour([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Changes a colour so that it is visible on the background. On a dark background, dark colours are made lighter, but keep their order of lightness.
pub(super) fn on_paper(c: Color32, paper: &Paper) -> Color32 {
    let lift = |x: u8| if paper.dark { (70.0 + f32::from(x) * (185.0 / 255.0)) as u8 } else { x };
    Color32::from_rgb(lift(c.r()), lift(c.g()), lift(c.b()))
}
