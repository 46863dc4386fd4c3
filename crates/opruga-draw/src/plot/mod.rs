//! Plots of lines over a common axis, and maps over two, as SVG text.

mod heat;
mod scale;
mod svg;

use crate::error::{DrawError, Nothing};

/// A plot: panels above each other, over one axis.
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
    /// Whose data are behind it, small below everything; empty where nobody asks for it.
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
    /// The unit of the quantity; empty where there is none.
    pub unit: String,
    /// Whether equal distances mean equal ratios; values which are not above zero are left out then.
    pub logarithmic: bool,
    /// The values at the ends; measured where this is absent.
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
    /// The height of the area of the lines in pixels.
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
    /// The points; a point which is not finite makes a gap.
    pub points: Vec<[f64; 2]>,
    /// A band behind the line: places along x, each with the values where the band begins and ends.
    pub band: Vec<[f64; 3]>,
    /// The sign at each point.
    pub marker: Option<Marker>,
    /// Whether the line has dashes.
    pub dashed: bool,
    /// The colour; the colours of Okabe and Ito follow each other where this is absent.
    pub colour: Option<[u8; 3]>,
}

/// The sign at each point of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A disc.
    Circle,
    /// A square.
    Square,
    /// A triangle.
    Triangle,
    /// A square on its corner.
    Diamond,
}

/// A horizontal line for comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// The value.
    pub value: f64,
    /// What the value means.
    pub label: String,
}

/// A map of quantities over two others: cells in colours, panels above each other.
#[derive(Clone, Debug, PartialEq)]
pub struct HeatMap {
    /// The title, which may be empty.
    pub title: String,
    /// The width of the whole plot in pixels.
    pub width: f64,
    /// What the columns are.
    pub x_label: String,
    /// The columns from the left.
    pub x: Vec<String>,
    /// What the rows are.
    pub y_label: String,
    /// The rows from below.
    pub y: Vec<String>,
    /// The panels from the top.
    pub panels: Vec<HeatPanel>,
    /// Whose data are behind it, small below everything; empty where nobody asks for it.
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
    /// The quantity, and how its values become colours.
    pub scale: Axis,
    /// The values, row by row; what is not finite has no colour.
    pub values: Vec<Vec<f64>>,
    /// Cells, each a column and a row, that have no value because something went wrong.
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
