//! Drawings inside a drawing: an `<svg>` with its own position and scale, and a `<symbol>` drawn by `use`.
//!
//! # Source
//! W3C, Scalable Vector Graphics 1.1, chapter 7.

use super::curves::{Affine, Curves, Point, after, larger, smaller};
use super::drawing_errors::SvgError;
use super::rules::Rule;
use super::svg::Reader;
use super::svg_fill::Fill;
use crate::problem::{SceneError, visible};
use roxmltree::Node;
use svgtypes::{Align, AspectRatio, ViewBox};

/// The region in which the contents of an element are drawn.
pub(super) struct Viewport {
    /// The map from the coordinates inside the viewport to those around it.
    pub(super) map: Affine,
    /// The corners of the rectangle that the viewport shows, in the coordinates around the viewport; none if it shows everything.
    pub(super) frame: Option<[Point; 4]>,
    /// The size to which percentages inside the viewport refer.
    pub(super) canvas: Option<Point>,
}

impl Reader<'_, '_> {
    /// The `viewBox` of an element.
    pub(super) fn view_box(&self, node: Node<'_, '_>) -> Result<Option<ViewBox>, SceneError> {
        let Some(attribute) = node.attribute_node("viewBox") else { return Ok(None) };
        let view: ViewBox = attribute.value().parse().map_err(|e: svgtypes::ViewBoxError| {
            let (reason, value) = (visible(&e.to_string()), visible(attribute.value()));
            self.in_attribute(&attribute, None, SvgError::ViewBox { reason, value })
        })?;
        Ok(Some(view))
    }

    /// The region in which the contents of an `<svg>` or a `<symbol>` are drawn. A `use` may give its size; none if the size is
    /// zero.
    pub(super) fn viewport(
        &self,
        node: Node<'_, '_>,
        used_by: Option<Node<'_, '_>>,
    ) -> Result<Option<Viewport>, SceneError> {
        let own = node.tag_name().name() == "svg";
        let [x, y] = if own { [self.number(node, "x", 0.0)?, self.number(node, "y", 0.0)?] } else { [0.0; 2] };
        let side = |name: &str, axis: usize| {
            let has_size = |node: &Node<'_, '_>| node.attribute(name).is_some_and(|value| value.trim() != "auto");
            match used_by.filter(has_size).or_else(|| Some(node).filter(has_size)) {
                Some(from) => self.size(from, name).map(Some),
                None => Ok(self.canvas.map(|canvas| canvas[axis])),
            }
        };
        let (width, height) = (side("width", 0)?, side("height", 1)?);
        if width == Some(0.0) || height == Some(0.0) {
            return Ok(None);
        }
        let size = width.zip(height);
        let shown = self.sheets.style(node, "overflow").is_some_and(|value| matches!(value, "visible" | "auto"));
        let frame = size.filter(|_| !shown).map(|(w, h)| [[x, y], [x + w, y], [x + w, y + h], [x, y + h]]);
        let Some(view) = self.view_box(node)? else {
            let canvas = size.map(|(w, h)| [w, h]);
            return Ok(Some(Viewport { map: [1.0, 0.0, 0.0, 1.0, x, y], frame, canvas }));
        };
        let Some((w, h)) = size else {
            return Err(self.error(node, SvgError::SizeOfView { element: node.tag_name().name().into() }));
        };
        let ratio = match node.attribute_node("preserveAspectRatio") {
            Some(attribute) => attribute.value().parse::<AspectRatio>().map_err(|e| self.refused(&attribute, &e))?,
            None => AspectRatio { defer: false, align: Align::XMidYMid, slice: false },
        };
        let (sx, sy) = (w / view.w, h / view.h);
        let (sx, sy) = match ratio.align {
            Align::None => (sx, sy),
            _ if ratio.slice => (larger(sx, sy), larger(sx, sy)),
            _ => (smaller(sx, sy), smaller(sx, sy)),
        };
        // The fraction of the remaining space that is before it.
        let [before_x, before_y] = match ratio.align {
            Align::None | Align::XMinYMin => [0.0, 0.0],
            Align::XMidYMin => [0.5, 0.0],
            Align::XMaxYMin => [1.0, 0.0],
            Align::XMinYMid => [0.0, 0.5],
            Align::XMidYMid => [0.5, 0.5],
            Align::XMaxYMid => [1.0, 0.5],
            Align::XMinYMax => [0.0, 1.0],
            Align::XMidYMax => [0.5, 1.0],
            Align::XMaxYMax => [1.0, 1.0],
        };
        let (to_x, to_y) = (x + before_x * (w - sx * view.w), y + before_y * (h - sy * view.h));
        let map = [sx, 0.0, 0.0, sy, to_x - sx * view.x, to_y - sy * view.y];
        Ok(Some(Viewport { map, frame, canvas: Some([view.w, view.h]) }))
    }

    /// Reads the contents of an `<svg>` or a `<symbol>`.
    ///
    /// # Errors
    /// The errors of its contents; `svg.unsupported` if it shows only a part of them.
    pub(super) fn inside(
        &mut self,
        node: Node<'_, '_>,
        used_by: Option<Node<'_, '_>>,
        map: &Affine,
        path: &mut Vec<usize>,
        fill: Fill,
    ) -> Result<(), SceneError> {
        let Some(view) = self.viewport(node, used_by)? else {
            self.hidden += 1;
            return Ok(());
        };
        let begun = self.curves.count();
        let around = std::mem::replace(&mut self.canvas, view.canvas);
        let read = self.children(node, &after(map, &view.map), path, fill);
        self.canvas = around;
        read?;
        view.frame.map_or(Ok(()), |frame| self.framed(node, &frame, map, begun))
    }

    /// Refuses an element if its contours from `begun` on extend beyond its frame.
    pub(super) fn framed(
        &self,
        node: Node<'_, '_>,
        frame: &[Point; 4],
        map: &Affine,
        begun: usize,
    ) -> Result<(), SceneError> {
        let mut own = Curves::of_part(0);
        own.polygon(frame);
        let mut clip = Curves::default();
        clip.append(own, map);
        let Some(percent) = self.cut_off(begun, &clip, &[Rule::NonZero]) else { return Ok(()) };
        Err(self.error(node, SvgError::Framed { element: node.tag_name().name().into(), percent }))
    }
}
