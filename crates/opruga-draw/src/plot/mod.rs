//! Plots of lines over a common axis, and maps over two axes, as SVG text.

mod heat;
mod scale;
mod svg;

use crate::error::{DrawError, Nothing};

/// A plot: panels one above another, over a common axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The title, which may be empty.
    pub title: String,
    /// The width of the whole plot in pixels.
    pub width: f64,
    /// The axis along x, which all panels share.
    pub x: Axis,
    /// The panels from the top.
    pub panels: Vec<Panel>,
    /// The credit for the data, in small letters at the bottom; empty if none is needed.
    pub credit: String,
}

impl Default for Chart {
    fn default() -> Chart {
        Chart { title: String::new(), width: 720.0, x: Axis::default(), panels: Vec::new(), credit: String::new() }
    }
}

/// One axis of a plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// The name of the quantity.
    pub label: String,
    /// Unit of the quantity; empty if there is none.
    pub unit: String,
    /// Whether the axis is logarithmic: equal distances mean equal ratios, and values that are not positive are omitted.
    pub logarithmic: bool,
    /// The values at the ends of the axis. If the values are not given, they are found from the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// A linear axis with a label and a unit.
    pub fn linear(label: impl Into<String>, unit: impl Into<String>) -> Axis {
        Axis { label: label.into(), unit: unit.into(), ..Axis::default() }
    }

    /// A logarithmic axis with a label and a unit.
    pub fn logarithmic(label: impl Into<String>, unit: impl Into<String>) -> Axis {
        Axis { logarithmic: true, ..Axis::linear(label, unit) }
    }
}

/// One panel of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The height of the plotting area in pixels.
    pub height: f64,
    /// The axis along y.
    pub y: Axis,
    /// The lines.
    pub lines: Vec<Line>,
    /// The levels for comparison.
    pub levels: Vec<Level>,
}

impl Default for Panel {
    fn default() -> Panel {
        Panel { height: 180.0, y: Axis::default(), lines: Vec::new(), levels: Vec::new() }
    }
}

/// One line of a panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The name in the list of lines; a line without a name is not listed.
    pub name: String,
    /// The points; a point that is not finite makes a gap.
    pub points: Vec<[f64; 2]>,
    /// A band behind the line: positions along x, each with the lower and upper value of the band.
    pub band: Vec<[f64; 3]>,
    /// The marker at each point.
    pub marker: Option<Marker>,
    /// Whether the line is dashed.
    pub dashed: bool,
    /// The colour; if it is not given, the colours of Okabe and Ito are used in turn.
    pub colour: Option<[u8; 3]>,
}

/// The marker at each point of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A square standing on its corner.
    Diamond,
}

/// A horizontal line for comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The value.
    pub value: f64,
    /// The meaning of the value.
    pub label: String,
}

/// A map of quantities over two other quantities. Each quantity has a panel of coloured cells, and the panels are one above another.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// The title, which may be empty.
    pub title: String,
    /// The width of the whole plot in pixels.
    pub width: f64,
    /// The meaning of the columns.
    pub x_label: String,
    /// The labels of the columns, from the left.
    pub x: Vec<String>,
    /// The meaning of the rows.
    pub y_label: String,
    /// The labels of the rows, from below.
    pub y: Vec<String>,
    /// The panels from the top.
    pub panels: Vec<HeatPanel>,
    /// The credit for the data, in small letters at the bottom; empty if none is needed.
    pub credit: String,
}

impl Default for HeatMap {
    fn default() -> HeatMap {
        HeatMap {
            title: String::new(),
            width: 720.0,
            x_label: String::new(),
            x: Vec::new(),
            y_label: String::new(),
            y: Vec::new(),
            panels: Vec::new(),
            credit: String::new(),
        }
    }
}

/// One quantity of a [`HeatMap`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatPanel {
    /// The quantity, and the mapping of its values to colours.
    pub scale: Axis,
    /// The values, row by row; values that are not finite have no colour.
    pub values: Vec<Vec<f64>>,
    /// The cells that have no value because of an error, each given by its column and row.
    pub failed: Vec<[usize; 2]>,
}

impl HeatMap {
    /// The map as the text of an SVG file.
    ///
    /// # Errors
    /// [`DrawError::Empty`] without panels, columns or rows.
    pub fn to_svg(&self) -> Result<String, DrawError> {
        if self.panels.is_empty() || self.x.is_empty() || self.y.is_empty() {
            return Err(DrawError::Empty { nothing: Nothing::Cell });
        }
        Ok(heat::write(self))
    }
}

impl Chart {
    /// The plot as the text of an SVG file.
    pub fn to_svg(&self) -> Result<String, DrawError> {
        if self.panels.is_empty() {
            return Err(DrawError::Empty { nothing: Nothing::Panel });
        }
        Ok(svg::write(self))
    }
}
