//! Clip paths: a clip path that cuts nothing off does not change a drawing.
//!
//! # Source
//! W3C, Scalable Vector Graphics 1.1, chapter 14.

use super::curves::{Affine, Curves, after, larger};
use super::drawing_errors::SvgError;
use super::rules::{self, Rule};
use super::svg::Reader;
use super::svg_fill::Fill;
use crate::problem::{SceneError, visible};
use opruga_math::words::rounded;
use opruga_mesh::outline::{self, Overlap, Ring};
use roxmltree::Node;

/// Curves are approximated within this fraction of the size of the drawing.
const TOLERANCE: f64 = 1e-5;
/// A cut counts if it exceeds this fraction of the area. The fraction is larger than the error of the approximated curves.
const CUT: f64 = 1e-4;

impl<'a, 'd> Reader<'a, 'd> {
    /// Refuses an element if its contours from `begun` on extend beyond its clip path; `map` maps the coordinates of the element to those of the
    /// drawing.
    pub(super) fn clipped(
        &mut self,
        node: Node<'_, '_>,
        map: &Affine,
        begun: usize,
        path: &mut Vec<usize>,
    ) -> Result<(), SceneError> {
        let sheets = self.sheets;
        let Some(value) = sheets.style(node, "clip-path").filter(|value| *value != "none") else { return Ok(()) };
        let link = value.strip_prefix("url(").and_then(|rest| rest.strip_suffix(')'));
        let id = link.and_then(|link| link.trim().trim_matches(['"', '\'']).strip_prefix('#'));
        let Some(id) = id else { return Err(self.not_read(node, "clip-path", value)) };
        let clip = self.named(node, id)?;
        let cut_itself = sheets.style(clip, "clip-path").is_some_and(|value| value != "none");
        if clip.tag_name().name() != "clipPath" || cut_itself {
            return Err(self.not_read(node, "clip-path", value));
        }
        if path.contains(&clip.id().get_usize()) {
            return Err(self.error(node, SvgError::Cycle { id: visible(id) }));
        }

        // The region of the clip path, read as a drawing of its own.
        let mut map = *map;
        if clip.attribute("clipPathUnits") == Some("objectBoundingBox") {
            let Some(unit) = self.box_of(begun, &map) else { return Ok(()) };
            map = after(&map, &unit);
        }
        let map = after(&map, &self.transform(clip)?);
        let mut reader = Reader::new(self.source, self.document, self.sheets, self.fills.of_clip());
        reader.canvas = self.canvas;
        path.push(clip.id().get_usize());
        reader.children(clip, &map, path, Fill::CLIP)?;
        path.pop();
        let Some(percent) = self.cut_off(begun, &reader.curves, &reader.fills.rules) else { return Ok(()) };
        Err(self.error(node, SvgError::Clipped { percent, value: visible(value) }))
    }

    /// The map from the unit square to the bounding box of the contours from index `begun` on, in the coordinates from which `map` maps; none if the
    /// box has no area.
    fn box_of(&self, begun: usize, map: &Affine) -> Option<Affine> {
        let [a, b, c, d, e, f] = *map;
        let det = a * d - b * c;
        let back = [d / det, -b / det, -c / det, a / det, (c * f - d * e) / det, (b * e - a * f) / det];
        let mut own = Curves::default();
        own.append(self.curves.from(begun), &back);
        let (low, high) = outline::bounds(&own.flatten(TOLERANCE * own.extent()))?;
        let (w, h) = (high[0] - low[0], high[1] - low[1]);
        (w > 0.0 && h > 0.0 && w.is_finite() && h.is_finite()).then_some([w, 0.0, 0.0, h, low[0], low[1]])
    }

    /// The percentage of the area of the contours from `begun` on that is outside a clip; none if all of it is inside.
    pub(super) fn cut_off(&self, begun: usize, clip: &Curves, rules: &[Rule]) -> Option<String> {
        let drawn = self.curves.from(begun);
        let size = drawn.extent();
        if !(size > 0.0 && size.is_finite()) || clip.holds_points_of(&drawn, 1e-9 * size) {
            return None;
        }
        let silhouette = |curves: &Curves, rules: &[Rule], part: u32| {
            let mut rings = curves.flatten(TOLERANCE * size);
            // For shapes without a rule, the rule that is used is reported elsewhere.
            rules::follow(&mut rings, rules);
            let mut made = outline::joined(&rings, Overlap::Union);
            made.iter_mut().for_each(|ring| ring.part = part);
            made
        };
        let area = |rings: &[Ring]| rings.iter().map(Ring::area).sum::<f64>();
        let (own, left) = (silhouette(&drawn, &self.fills.rules, 0), silhouette(clip, rules, 1));
        let whole = area(&own);
        let off = area(&outline::joined(&[own, left.clone()].concat(), Overlap::Union)) - area(&left);
        (whole > 0.0 && off > CUT * whole).then(|| rounded(100.0 * larger(off, 0.0) / whole, 2))
    }
}
