//! Drawings: the shapes of an SVG file as curves.
//!
//! What is read: `path`, `rect`, `circle`, `ellipse`, `polygon`, `polyline` in `svg`, `g`, `a`, the first suitable one in `switch`, and through `use`,
//! with `transform`, an `svg` inside the drawing and a `symbol` also with their `viewBox`. What carries no outline (`title`, `defs`, gradients …) is passed over, and what is not displayed; what would be drawn but has no
//! outline here (`text`, `image`, strokes, markers, filters, animations, masks, and clip paths that cut something off) is refused or counted. Style sheets are followed; what is said behind selectors that
//! are not read is counted, or refused where it would change outlines. Every part of the drawing
//! follows the even-odd rule, or the non-zero rule where its `fill-rule` says so. Fill colours are read where the scene wants them.
//!
//! # Source
//! W3C, Scalable Vector Graphics (SVG) 1.1, second edition.

use super::curves::{Affine, Curves, IDENTITY, Point, after};
use super::drawing::Drawing;
use super::svg_fill::{Fill, Fills};
use super::svg_sheets::Sheets;
use super::svg_style::{ANIMATIONS, animations_of};
use super::svg_units::units;
use super::svg_xml::{document, is_drawing};
use crate::budget::OUTLINES;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_core::spec::nearest;
use opruga_math::words::counted;
use roxmltree::{Document, Node};

/// Elements may be nested this deep, `use` included.
const DEEPEST: usize = 128;

/// Elements inside which nothing is drawn.
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

/// Reads a whole drawing, or the element with an id; its fill colours too where they are wanted.
///
/// # Errors
/// `svg.syntax`, `svg.entity`, `svg.cycle`, `svg.depth`, `svg.unsupported`, `svg.style`, `svg.unknown_id`, `svg.same_id`, `svg.colour`,
/// `limit.…`, with line and column.
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
    let mut notice = |count: usize, code, [one, many]: [&str; 2], what: &str| {
        if count > 0 {
            let message = format!("{} {what}", counted(count as u64, one, many));
            notices.push(SceneError::new(code, message).value(count.to_string()));
        }
    };
    notice(reader.open, "svg.open_path", ["open path is", "open paths are"], "closed by a straight line");
    let unfilled = ["shape without fill is read by its outline", "shapes without fill are read by their outlines"];
    notice(reader.unfilled, "svg.stroke", unfilled, "instead of strokes");
    let empty = ["shape without a path or points is", "shapes without a path or points are"];
    notice(reader.empty, "svg.empty", empty, "left out");
    notice(reader.images, "svg.image", ["image is", "images are"], "left out");
    let hidden = ["element that cannot be seen is", "elements that cannot be seen are"];
    notice(reader.hidden, "svg.hidden", hidden, "left out");
    notice(reader.markers, "svg.marker", ["element has markers", "elements have markers"], "which are left out");
    let filters = ["element has a filter", "elements have a filter"];
    notice(reader.filters, "svg.filter", filters, "which is not applied");
    let strokes = ["filled shape has a stroke", "filled shapes have a stroke"];
    notice(reader.strokes, "svg.stroke", strokes, "which is left out: the outline runs along its middle");
    notice(reader.animations, "svg.animation", ["animation is", "animations are"], "left out");
    let gradients = ["gradient is", "gradients are"];
    notice(reader.fills.gradients, "svg.gradient", gradients, "painted in the mean of the colours");
    let styled = ["shape has a rule of a style sheet", "shapes have rules of style sheets"];
    notice(reader.fills.styled, "svg.style", styled, "behind a selector that is not read: other colours may be meant");
    let (painted, rules) = (reader.fills.painted, reader.fills.rules);
    let (curves, places) = (reader.curves, reader.places);
    Ok(Drawing { curves, y_down: true, source: Some(source), places, painted, rules, notices })
}

pub(super) struct Reader<'a, 'd> {
    pub(super) source: &'a Source<'a>,
    pub(super) document: &'d Document<'a>,
    pub(super) sheets: &'d Sheets,
    pub(super) curves: Curves,
    /// Where each part stands in the file.
    places: Vec<(usize, usize)>,
    pub(super) fills: Fills<'a, 'd>,
    /// Width and height that per cent refer to; none where the drawing does not say.
    pub(super) canvas: Option<Point>,
    pub(super) open: usize,
    unfilled: usize,
    /// Shapes that draw nothing.
    pub(super) empty: usize,
    images: usize,
    pub(super) hidden: usize,
    markers: usize,
    filters: usize,
    strokes: usize,
    animations: usize,
}

impl<'a, 'd> Reader<'a, 'd> {
    /// A reader that has read nothing.
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
            places: Vec::new(),
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

    pub(super) fn error(&self, node: Node<'_, '_>, code: &'static str, message: String) -> SceneError {
        self.marked(node, SceneError::new(code, message))
    }

    /// An error at the tag of an element.
    fn marked(&self, node: Node<'_, '_>, error: SceneError) -> SceneError {
        let range = node.range();
        // The tag alone, not all that it holds.
        let end = self.source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
        self.source.mark(error, range.start, end)
    }

    fn unknown(&self, node: Node<'_, '_>, id: &str, code: &'static str) -> SceneError {
        let near = nearest(id, self.sheets.index.ids());
        self.error(node, code, format!("no element has the id `{}`", visible(id))).value(visible(id)).nearest(near)
    }

    /// The only element with an id.
    pub(super) fn named(&self, node: Node<'_, '_>, id: &str) -> Result<Node<'d, 'a>, SceneError> {
        match self.sheets.index.named(self.document, id) {
            [None, _] => Err(self.unknown(node, id, "svg.unknown_id")),
            [Some(first), None] => Ok(first),
            [_, Some(second)] => {
                let message = format!("two elements have the id `{}`", visible(id));
                Err(self.error(second, "svg.same_id", message).value(visible(id)).allowed("ids that differ"))
            }
        }
    }

    /// What per cent of a drawing refer to: its `viewBox`, else its width and height.
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
            let error =
                self.error(root, "svg.unsupported", "the drawing is stretched more one way than the other".into());
            let error = error.value("preserveAspectRatio=\"none\"");
            return Err(error.allowed("a width and a height in proportion to the `viewBox`"));
        }
        Ok(Some([view.w, view.h]))
    }

    /// The child of a `switch` that is drawn: the first that asks for nothing that is not there.
    fn chosen<'n, 'i>(&self, node: Node<'n, 'i>) -> Result<Option<Node<'n, 'i>>, SceneError> {
        for child in node.children().filter(Node::is_element) {
            if child.has_attribute("systemLanguage") {
                let error = self.error(child, "svg.unsupported", "which language is meant is not known".into());
                return Err(error.value("systemLanguage").hint("leave one element in the <switch>"));
            }
            if child.attribute("requiredExtensions").is_none_or(|value| value.trim().is_empty()) {
                return Ok(Some(child));
            }
        }
        Ok(None)
    }

    /// An element alone, with the transforms and clips around it.
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

    /// The coordinates of an element and its fill, inside of others; refused is what would cut or move it and is not read.
    fn within(&mut self, node: Node<'_, '_>, map: &Affine, fill: Fill) -> Result<(Affine, Fill), SceneError> {
        let sheets = self.sheets;
        if let Some((word, value)) = sheets.unread(node) {
            return Err(self.not_read(node, word, value));
        }
        self.filters += usize::from(sheets.style(node, "filter").is_some_and(|value| value != "none"));
        let fill = self.fills.within(node, fill)?;
        Ok((after(map, &self.transform(node)?), fill))
    }

    /// That a property of an element cannot be read.
    pub(super) fn not_read(&self, node: Node<'_, '_>, word: &str, value: &str) -> SceneError {
        let error = self.error(node, "svg.unsupported", format!("`{word}` cannot be read"));
        error.value(visible(value)).hint("apply it in the drawing program")
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

    /// An element and what is in it; `path` holds the elements around it, to find cycles.
    fn element_at(
        &mut self,
        node: Node<'_, '_>,
        map: &Affine,
        path: &mut Vec<usize>,
        fill: Fill,
    ) -> Result<(), SceneError> {
        // What drawing programs note for themselves is in languages of their own.
        if !is_drawing(node) {
            return Ok(());
        }
        let name = node.tag_name().name();
        // Elements that `use` draws are counted again.
        self.sheets.index.element().map_err(|e| self.marked(node, e))?;
        if path.len() >= DEEPEST {
            let message = format!("elements are nested more than {DEEPEST} deep");
            return Err(self
                .error(node, "svg.depth", message)
                .value(name)
                .allowed(format!("at most {DEEPEST} levels")));
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
                let (mut curves, empty) = (Curves::of_part(self.places.len() as u32), self.empty);
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
                let parts = OUTLINES.check(self.places.len() as u64 + 1);
                parts.and(sheets.index.points(curves.points())).map_err(|e| self.marked(node, e))?;
                self.unfilled += usize::from(!fill.filled);
                self.strokes += usize::from(fill.filled && sheets.has_stroke(node));
                self.fills.paint(fill);
                self.curves.append(curves, &map);
                let range = node.range();
                self.places.push((range.start, range.end));
            }
            "line" => self.unfilled += 1,
            "image" => self.images += 1,
            "text" | "foreignObject" => {
                let error = self.error(node, "svg.unsupported", format!("<{name}> has no outline here"));
                return Err(error
                    .value(name)
                    .hint("turn text into paths in the drawing program, or use `kind = \"text\"`"));
            }
            _ => {
                let error = self.error(node, "svg.unsupported", format!("<{}> cannot be read", visible(name)));
                return Err(error
                    .value(visible(name))
                    .allowed("path, rect, circle, ellipse, polygon, polyline in svg, g, a, switch, use"));
            }
        }
        self.clipped(node, &map, begun, path)?;
        path.pop();
        Ok(())
    }

    /// `use`: the element that it names, moved.
    fn used(&mut self, node: Node<'_, '_>, map: &Affine, path: &mut Vec<usize>, fill: Fill) -> Result<(), SceneError> {
        let link =
            node.attribute("href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href"))).unwrap_or("");
        let Some(id) = link.strip_prefix('#') else {
            let error = self.error(node, "svg.outside", format!("`{}` is no element of this file", visible(link)));
            return Err(error
                .value(visible(link))
                .allowed("href = \"#id\" of this file")
                .hint("other files are never read"));
        };
        let goal = self.named(node, id)?;
        if path.contains(&goal.id().get_usize()) {
            let error = self.error(node, "svg.cycle", format!("`#{}` contains itself", visible(id)));
            return Err(error.value(visible(id)).hint("an element cannot be drawn inside of itself"));
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
            let error = self.error(node, "svg.unsupported", "a <use> cannot give an <svg> another size".into());
            return Err(error.value("use").hint("give the <svg> itself its `width` and `height`"));
        }
        self.element_at(goal, &map, path, fill)
    }
}
