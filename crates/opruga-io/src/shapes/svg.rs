//! Drawings: the shapes of an SVG file as curves.
//!
//! The reader takes `path`, `rect`, `circle`, `ellipse`, `polygon` and `polyline` in `svg`, `g` and `a`, in the first suitable child of `switch`, and
//! through `use`. The reader applies `transform`, and also the `viewBox` of an inner `svg` and of a `symbol`. Elements without an outline (`title`,
//! `defs`, gradients …) and elements that are not displayed are skipped. Elements that would be drawn but for which no outline is computed (`text`,
//! `image`, strokes, markers, filters, animations, masks, and clip paths that cut something off) are refused or counted. Style sheets are applied;
//! rules with unsupported selectors are counted, or refused if they would change outlines. Every part of the drawing uses the even-odd rule, or the
//! non-zero rule if its `fill-rule` says so. Fill colours are read if the scene asks for them.
//!
//! # Source
//! W3C, Scalable Vector Graphics (SVG) 1.1, second edition.

use super::curves::{Affine, Curves, IDENTITY, Point, after};
use super::drawing::Drawing;
use super::drawing_errors::{SvgError, SvgNotice};
use super::svg_fill::{Fill, Fills};
use super::svg_sheets::Sheets;
use super::svg_style::{ANIMATIONS, animations_of};
use super::svg_units::units;
use super::svg_xml::{document, is_drawing};
use crate::budget::OUTLINES;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_core::spec::nearest;
use roxmltree::{Document, Node};

/// The deepest nesting of elements, `use` included.
const DEEPEST: usize = 128;

/// Elements whose contents are not drawn.
const NOT_DRAWN: [&str; 15] = [
    "title",
    "desc",
    "metadata",
    "style",
    "script",
    "defs",
    "symbol",
    "linearGradient",
    "radialGradient",
    "pattern",
    "clipPath",
    "mask",
    "marker",
    "filter",
    "view",
];

/// Reads a whole drawing, or the element with an id, with fill colours if they are needed.
///
/// # Errors
/// `svg.syntax`, `svg.entity`, `svg.cycle`, `svg.depth`, `svg.unsupported`, `svg.style`, `svg.unknown_id`, `svg.same_id`, `svg.colour`, `limit.…`,
/// with line and column.
pub(super) fn read<'a>(source: &'a Source<'a>, id: Option<&str>, colours: bool) -> Result<Drawing<'a>, SceneError> {
    let document = document(source)?;
    let root = document.root_element();
    let sheets = Sheets::of(&document, source)?;
    let mut reader = Reader::new(source, &document, &sheets, Fills::of(&document, source, &sheets, colours));
    reader.animations = animations_of(root);
    reader.canvas = reader.canvas_of(root)?;
    match id {
        None => {
            let (map, fill) = reader.within(root, &IDENTITY, Fill::FIRST)?;
            reader.children(root, &map, &mut Vec::new(), fill)?;
            reader.clipped(root, &map, 0, &mut Vec::new())?;
        }
        Some(id) => {
            let wanted = reader.named(root, id)?;
            reader.element_by_itself(wanted)?;
        }
    }
    let mut notices = Vec::new();
    let mut notice = |count: usize, notice: fn(usize) -> SvgNotice| {
        if count > 0 {
            notices.push(SceneError::of(notice(count)));
        }
    };
    notice(reader.open, |count| SvgNotice::OpenPaths { count });
    notice(reader.unfilled, |count| SvgNotice::Unfilled { count });
    notice(reader.empty, |count| SvgNotice::Empty { count });
    notice(reader.images, |count| SvgNotice::Images { count });
    notice(reader.hidden, |count| SvgNotice::Hidden { count });
    notice(reader.markers, |count| SvgNotice::Markers { count });
    notice(reader.filters, |count| SvgNotice::Filters { count });
    notice(reader.strokes, |count| SvgNotice::Strokes { count });
    notice(reader.animations, |count| SvgNotice::Animations { count });
    notice(reader.fills.gradients, |count| SvgNotice::Gradients { count });
    notice(reader.fills.styled, |count| SvgNotice::Styled { count });
    let (painted, rules) = (reader.fills.painted, reader.fills.rules);
    let (curves, spans) = (reader.curves, reader.spans);
    Ok(Drawing { curves, y_down: true, source: Some(source), spans, painted, rules, notices })
}

pub(super) struct Reader<'a, 'd> {
    pub(super) source: &'a Source<'a>,
    pub(super) document: &'d Document<'a>,
    pub(super) sheets: &'d Sheets,
    pub(super) curves: Curves,
    /// The range of each part in the file.
    spans: Vec<(usize, usize)>,
    pub(super) fills: Fills<'a, 'd>,
    /// Width and height to which percentages refer; none if the drawing does not give them.
    pub(super) canvas: Option<Point>,
    pub(super) open: usize,
    unfilled: usize,
    /// The number of shapes that draw nothing.
    pub(super) empty: usize,
    images: usize,
    pub(super) hidden: usize,
    markers: usize,
    filters: usize,
    strokes: usize,
    animations: usize,
}

impl<'a, 'd> Reader<'a, 'd> {
    /// A reader that has not read anything yet.
    pub(super) fn new(
        source: &'a Source<'a>,
        document: &'d Document<'a>,
        sheets: &'d Sheets,
        fills: Fills<'a, 'd>,
    ) -> Reader<'a, 'd> {
        Reader {
            source,
            document,
            sheets,
            curves: Curves::default(),
            spans: Vec::new(),
            fills,
            canvas: None,
            open: 0,
            unfilled: 0,
            empty: 0,
            images: 0,
            hidden: 0,
            markers: 0,
            filters: 0,
            strokes: 0,
            animations: 0,
        }
    }

    pub(super) fn error(&self, node: Node<'_, '_>, error: SvgError) -> SceneError {
        self.marked(node, SceneError::of(error))
    }

    /// An error at the tag of an element.
    fn marked(&self, node: Node<'_, '_>, error: SceneError) -> SceneError {
        let range = node.range();
        // Only the tag, without the contents of the element.
        let end = self.source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
        self.source.mark(error, range.start, end)
    }

    /// The only element with an id.
    pub(super) fn named(&self, node: Node<'_, '_>, id: &str) -> Result<Node<'d, 'a>, SceneError> {
        match self.sheets.index.named(self.document, id) {
            [None, _] => {
                let suggestion = nearest(id, self.sheets.index.ids());
                Err(self.error(node, SvgError::UnknownId { id: visible(id) }).nearest(suggestion))
            }
            [Some(first), None] => Ok(first),
            [_, Some(second)] => Err(self.error(second, SvgError::SameId { id: visible(id) })),
        }
    }

    /// The size to which percentages of a drawing refer: that of its `viewBox` or, without a `viewBox`, its width and height.
    fn canvas_of(&self, root: Node<'_, '_>) -> Result<Option<Point>, SceneError> {
        let size = |name: &str| {
            let length = root.attribute(name)?.parse::<svgtypes::Length>().ok()?;
            units(length.unit).map(|unit| unit * length.number)
        };
        let size = size("width").zip(size("height")).map(|(w, h)| [w, h]);
        let Some(view) = self.view_box(root)? else { return Ok(size) };
        let ratio = |[w, h]: Point| w / h;
        let stretched = root.attribute("preserveAspectRatio").is_some_and(|value| value.trim().starts_with("none"))
            && size.is_some_and(|size| (ratio(size) / ratio([view.w, view.h]) - 1.0).abs() > 1e-6);
        if stretched {
            return Err(self.error(root, SvgError::Stretched {}));
        }
        Ok(Some([view.w, view.h]))
    }

    /// The child of a `switch` that is drawn: the first one that does not require anything unsupported.
    fn chosen<'n, 'i>(&self, node: Node<'n, 'i>) -> Result<Option<Node<'n, 'i>>, SceneError> {
        for child in node.children().filter(Node::is_element) {
            if child.has_attribute("systemLanguage") {
                return Err(self.error(child, SvgError::Language {}));
            }
            if child.attribute("requiredExtensions").is_none_or(|value| value.trim().is_empty()) {
                return Ok(Some(child));
            }
        }
        Ok(None)
    }

    /// Reads only one element, with the transforms and clips around it.
    fn element_by_itself(&mut self, wanted: Node<'_, '_>) -> Result<(), SceneError> {
        let (mut map, mut fill) = (IDENTITY, Fill::FIRST);
        let (mut clips, mut frames) = (Vec::new(), Vec::new());
        let ancestors: Vec<Node<'_, '_>> = wanted.ancestors().skip(1).filter(Node::is_element).collect();
        for ancestor in ancestors.into_iter().rev() {
            (map, fill) = self.within(ancestor, &map, fill)?;
            clips.push((ancestor, map));
            let nested = ancestor.tag_name().name() == "svg" && ancestor != self.document.root_element();
            if let Some(view) = if nested { self.viewport(ancestor, None)? } else { None } {
                frames.extend(view.frame.map(|frame| (ancestor, frame, map)));
                map = after(&map, &view.map);
                self.canvas = view.canvas;
            }
        }
        self.element_at(wanted, &map, &mut Vec::new(), fill)?;
        for (ancestor, map) in clips {
            self.clipped(ancestor, &map, 0, &mut Vec::new())?;
        }
        frames.iter().try_for_each(|(ancestor, frame, map)| self.framed(*ancestor, frame, map, 0))
    }

    /// Computes the coordinate map and the fill of an element from those of its parent. Refuses properties that are not read but would cut or move
    /// the element.
    fn within(&mut self, node: Node<'_, '_>, map: &Affine, fill: Fill) -> Result<(Affine, Fill), SceneError> {
        let sheets = self.sheets;
        if let Some((word, value)) = sheets.unread(node) {
            return Err(self.not_read(node, word, value));
        }
        self.filters += usize::from(sheets.style(node, "filter").is_some_and(|value| value != "none"));
        let fill = self.fills.within(node, fill)?;
        Ok((after(map, &self.transform(node)?), fill))
    }

    /// The error for a property of an element that cannot be read.
    pub(super) fn not_read(&self, node: Node<'_, '_>, word: &str, value: &str) -> SceneError {
        self.error(node, SvgError::Property { property: word.into(), value: visible(value) })
    }

    pub(super) fn children(
        &mut self,
        node: Node<'_, '_>,
        map: &Affine,
        path: &mut Vec<usize>,
        fill: Fill,
    ) -> Result<(), SceneError> {
        for child in node.children().filter(Node::is_element) {
            self.element_at(child, map, path, fill)?;
        }
        Ok(())
    }

    /// Reads an element and its contents; `path` lists the elements around it, to find cycles.
    fn element_at(
        &mut self,
        node: Node<'_, '_>,
        map: &Affine,
        path: &mut Vec<usize>,
        fill: Fill,
    ) -> Result<(), SceneError> {
        // Data that drawing programs store for themselves are in their own namespaces.
        if !is_drawing(node) {
            return Ok(());
        }
        let name = node.tag_name().name();
        // Elements that `use` draws are counted every time.
        self.sheets.index.element().map_err(|e| self.marked(node, e))?;
        if path.len() >= DEEPEST {
            return Err(self.error(node, SvgError::Depth { deepest: DEEPEST, element: name.into() }));
        }
        if NOT_DRAWN.contains(&name) || ANIMATIONS.contains(&name) {
            return Ok(());
        }
        let leaf = !matches!(name, "svg" | "g" | "a" | "switch" | "use");
        let sheets = self.sheets;
        if sheets.style(node, "display") == Some("none") || sheets.is_clear(node) || leaf && sheets.is_hidden(node) {
            self.hidden += 1;
            return Ok(());
        }
        self.markers += usize::from(leaf && sheets.has_markers(node));
        self.animations += animations_of(node);
        let (map, fill) = self.within(node, map, fill)?;
        let begun = self.curves.count();
        path.push(node.id().get_usize());
        match name {
            "svg" => self.inside(node, None, &map, path, fill)?,
            "g" | "a" => self.children(node, &map, path, fill)?,
            "switch" => {
                if let Some(child) = self.chosen(node)? {
                    self.element_at(child, &map, path, fill)?;
                }
            }
            "use" => self.used(node, &map, path, fill)?,
            "path" | "rect" | "circle" | "ellipse" | "polygon" | "polyline" => {
                let (mut curves, empty) = (Curves::of_part(self.spans.len() as u32), self.empty);
                match name {
                    "path" => self.path(node, &mut curves)?,
                    "rect" => self.rectangle(node, &mut curves)?,
                    "circle" | "ellipse" => self.ellipse(node, name, &mut curves)?,
                    _ => self.points(node, name, &mut curves)?,
                }
                if self.empty > empty {
                    path.pop();
                    return Ok(());
                }
                let parts = OUTLINES.check(self.spans.len() as u64 + 1);
                parts.and(sheets.index.points(curves.points())).map_err(|e| self.marked(node, e))?;
                self.unfilled += usize::from(!fill.filled);
                self.strokes += usize::from(fill.filled && sheets.has_stroke(node));
                self.fills.paint(fill);
                self.curves.append(curves, &map);
                let range = node.range();
                self.spans.push((range.start, range.end));
            }
            "line" => self.unfilled += 1,
            "image" => self.images += 1,
            "text" | "foreignObject" => {
                return Err(self.error(node, SvgError::NoOutline { element: name.into() }));
            }
            _ => return Err(self.error(node, SvgError::Element { element: visible(name) })),
        }
        self.clipped(node, &map, begun, path)?;
        path.pop();
        Ok(())
    }

    /// Reads `use`, which draws the element that it names at another position.
    fn used(&mut self, node: Node<'_, '_>, map: &Affine, path: &mut Vec<usize>, fill: Fill) -> Result<(), SceneError> {
        let link =
            node.attribute("href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href"))).unwrap_or("");
        let Some(id) = link.strip_prefix('#') else {
            return Err(self.error(node, SvgError::Outside { link: visible(link) }));
        };
        let goal = self.named(node, id)?;
        if path.contains(&goal.id().get_usize()) {
            return Err(self.error(node, SvgError::Cycle { id: visible(id) }));
        }
        let moved = [1.0, 0.0, 0.0, 1.0, self.number(node, "x", 0.0)?, self.number(node, "y", 0.0)?];
        let map = after(map, &moved);
        if goal.tag_name().name() == "symbol" {
            path.push(goal.id().get_usize());
            self.animations += animations_of(goal);
            let begun = self.curves.count();
            let (map, fill) = self.within(goal, &map, fill)?;
            self.inside(goal, Some(node), &map, path, fill)?;
            self.clipped(goal, &map, begun, path)?;
            path.pop();
            return Ok(());
        }
        if goal.tag_name().name() == "svg" && (node.has_attribute("width") || node.has_attribute("height")) {
            return Err(self.error(node, SvgError::SizeOfUse {}));
        }
        self.element_at(goal, &map, path, fill)
    }
}
