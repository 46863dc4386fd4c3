//! The path language of SVG: segments drawn by a pen.

use super::curves::{Curves, Point};
use svgtypes::PathSegment;

/// The pen of the path language: its position, and the control point that a smooth curve continues from.
pub(super) struct Pen<'c> {
    curves: &'c mut Curves,
    pub(super) at: Point,
    /// The last control point, and whether its curve was cubic.
    control: Option<(Point, bool)>,
    /// Whether a subpath has begun.
    begun: bool,
    /// Whether lines of this subpath have been drawn but not closed yet.
    drawing: bool,
    /// The number of subpaths that were left open.
    pub(super) open: usize,
}

impl<'c> Pen<'c> {
    /// A pen at the origin.
    pub(super) fn on(curves: &'c mut Curves) -> Pen<'c> {
        Pen { curves, at: [0.0; 2], control: None, begun: false, drawing: false, open: 0 }
    }

    /// Leaves the present subpath open.
    pub(super) fn leave(&mut self) {
        let closed = self.curves.start() == self.at;
        self.open += usize::from(self.drawing && !closed);
        self.drawing = false;
    }

    /// Draws one segment.
    pub(super) fn draw(&mut self, segment: PathSegment) {
        let from = self.at;
        let point = |abs: bool, x: f64, y: f64| if abs { [x, y] } else { [from[0] + x, from[1] + y] };
        // A smooth curve mirrors the control point of the previous curve if both curves are of the same kind.
        let mirrored = |cubic: bool| match self.control {
            Some((p, kind)) if kind == cubic => [2.0 * from[0] - p[0], 2.0 * from[1] - p[1]],
            _ => from,
        };
        let mut control = None;
        let mut draws = true;
        // After a subpath has been closed, the next one begins at the same point.
        if !self.begun && !matches!(segment, PathSegment::MoveTo { .. } | PathSegment::ClosePath { .. }) {
            self.curves.move_to(from);
            self.begun = true;
        }
        match segment {
            PathSegment::MoveTo { abs, x, y } => {
                let to = point(abs, x, y);
                self.leave();
                self.curves.move_to(to);
                self.at = to;
                self.begun = true;
                draws = false;
            }
            PathSegment::LineTo { abs, x, y } => self.line(point(abs, x, y)),
            PathSegment::HorizontalLineTo { abs, x } => self.line([if abs { x } else { from[0] + x }, from[1]]),
            PathSegment::VerticalLineTo { abs, y } => self.line([from[0], if abs { y } else { from[1] + y }]),
            PathSegment::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                let (p, q) = (point(abs, x1, y1), point(abs, x2, y2));
                self.cubic(p, q, point(abs, x, y));
                control = Some((q, true));
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                let (p, q) = (mirrored(true), point(abs, x2, y2));
                self.cubic(p, q, point(abs, x, y));
                control = Some((q, true));
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                let p = point(abs, x1, y1);
                self.quadratic(p, point(abs, x, y));
                control = Some((p, false));
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let p = mirrored(false);
                self.quadratic(p, point(abs, x, y));
                control = Some((p, false));
            }
            PathSegment::EllipticalArc { abs, rx, ry, x_axis_rotation, large_arc, sweep, x, y } => {
                let to = point(abs, x, y);
                self.curves.arc_to([rx, ry], x_axis_rotation / 180.0 * core::f64::consts::PI, large_arc, sweep, to);
                self.at = to;
            }
            PathSegment::ClosePath { .. } => {
                self.at = self.curves.start();
                draws = false;
                (self.begun, self.drawing) = (false, false);
            }
        }
        self.control = control;
        self.drawing |= draws;
    }

    fn line(&mut self, to: Point) {
        self.curves.line_to(to);
        self.at = to;
    }

    fn cubic(&mut self, p: Point, q: Point, to: Point) {
        self.curves.cubic_to(p, q, to);
        self.at = to;
    }

    fn quadratic(&mut self, p: Point, to: Point) {
        self.curves.quadratic_to(p, to);
        self.at = to;
    }
}
