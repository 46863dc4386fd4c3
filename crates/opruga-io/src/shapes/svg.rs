//! Drawings: the shapes of an SVG file as curves.
//!
//! What is read: `path`, `rect`, `circle`, `ellipse`, `polygon`, `polyline` in `svg`, `g`, `a`, `switch` and through `use`, with `transform`. What
//! carries no outline (`title`, `style`, `defs`, gradients …) is passed over; what would be drawn but has no outline here (`text`, `image`, strokes,
//! clips and masks) is refused or counted. Every part of the drawing follows the even-odd rule. Fill colours are read where the scene wants them.
//!
//! # Source
//! W3C, Scalable Vector Graphics (SVG) 1.1, second edition.

use super::curves::{Affine, Curves, IDENTITY, Point, after, smaller};
use super::drawing::Drawing;
use super::svg_fill::{Fill, Fills};
use super::svg_path::Pen;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_core::spec::nearest;
use opruga_math::words::counted;
use roxmltree::{Attribute, Document, Node, ParsingOptions};
use svgtypes::{LengthUnit, PathParser, PointsParser, TransformListParser, TransformListToken};

/// Elements may be nested this deep, `use` included.
const DEEPEST: usize = 128;

/// The largest number of elements and texts.
const MOST_NODES: u32 = 4 << 20;

/// The largest number of parts, which `use` could draw many times.
const MOST_PARTS: usize = 1 << 18;

/// Elements inside which nothing is drawn.
const NOT_DRAWN: [&str; 17] = [
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
    "animate",
    "set",
];

/// Reads a whole drawing, or the element with an id; its fill colours too where they are wanted.
///
/// # Errors
/// `svg.syntax`, `svg.entity`, `svg.cycle`, `svg.depth`, `svg.unsupported`, `svg.unknown_id`, `svg.colour`, with line and column.
pub(super) fn read<'a>(source: &'a Source<'a>, id: Option<&str>, colours: bool) -> Result<Drawing<'a>, SceneError> {
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, entity_resolver: None };
    let document = Document::parse_with_options(source.text, options).map_err(|e| syntax(source, &e))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let error =
            SceneError::new("svg.syntax", format!("the file is no drawing but <{}>", visible(root.tag_name().name())));
        return Err(source
            .mark(error, root.range().start, root.range().start + 1)
            .value(visible(root.tag_name().name()))
            .allowed("<svg>"));
    }
    let mut reader = Reader {
        source,
        document: &document,
        curves: Curves::default(),
        places: Vec::new(),
        fills: Fills::of(&document, source, colours),
        open: 0,
        unfilled: 0,
        images: 0,
    };
    match id {
        None => reader.children(root, &IDENTITY, &mut Vec::new(), Fill::FIRST)?,
        Some(id) => {
            let wanted = document.descendants().find(|node| node.attribute("id") == Some(id));
            let Some(wanted) = wanted else { return Err(reader.unknown(root, id, "svg.unknown_id")) };
            // The element keeps the transforms around it.
            let (mut map, mut fill) = (IDENTITY, Fill::FIRST);
            let ancestors: Vec<Node<'_, '_>> = wanted.ancestors().skip(1).filter(Node::is_element).collect();
            for ancestor in ancestors.into_iter().rev() {
                map = after(&map, &reader.transform(ancestor)?);
                fill = reader.fills.within(ancestor, fill)?;
            }
            reader.element_at(wanted, &map, &mut Vec::new(), fill)?;
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
    notice(reader.images, "svg.image", ["image is", "images are"], "left out");
    let gradients = ["gradient is", "gradients are"];
    notice(reader.fills.gradients, "svg.gradient", gradients, "painted in the mean of the colours");
    let styled = ["element has a class", "elements have a class"];
    notice(reader.fills.styled, "svg.style", styled, "whose style sheet is not read: other colours may be meant");
    let painted = reader.fills.painted;
    Ok(Drawing { curves: reader.curves, y_down: true, source: Some(source), places: reader.places, painted, notices })
}

/// What the XML reader refuses.
fn syntax(source: &Source<'_>, error: &roxmltree::Error) -> SceneError {
    let place = error.pos();
    let at = source.offset(place.row as usize, place.col as usize);
    let (code, hint) = match error {
        roxmltree::Error::UnknownEntityReference(..) | roxmltree::Error::EntityResolver(..) => {
            ("svg.entity", Some("entities from outside of the file are never read"))
        }
        roxmltree::Error::EntityReferenceLoop(_) => ("svg.entity", Some("entities may not contain one another")),
        roxmltree::Error::NodesLimitReached => ("shape.too_large", None),
        _ => ("svg.syntax", None),
    };
    let text = error.to_string();
    let message = text.split(" at ").next().unwrap_or(&text);
    let found: String = source.text[at..].chars().take(1).collect();
    let error =
        source.mark(SceneError::new(code, format!("this is no well-formed XML: {}", visible(message))), at, at + 1);
    let error = error.value(visible(&found));
    hint.map_or(error.clone(), |hint| error.hint(hint))
}

struct Reader<'a, 'd> {
    source: &'a Source<'a>,
    document: &'d Document<'a>,
    curves: Curves,
    /// Where each part stands in the file.
    places: Vec<(usize, usize)>,
    fills: Fills<'a, 'd>,
    open: usize,
    unfilled: usize,
    images: usize,
}

impl<'a> Reader<'a, '_> {
    fn error(&self, node: Node<'_, '_>, code: &'static str, message: String) -> SceneError {
        let range = node.range();
        // The tag alone, not all that it holds.
        let end = self.source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
        self.source.mark(SceneError::new(code, message), range.start, end)
    }

    fn unknown(&self, node: Node<'_, '_>, id: &str, code: &'static str) -> SceneError {
        let near = nearest(id, self.document.descendants().filter_map(|n| n.attribute("id")));
        self.error(node, code, format!("no element has the id `{}`", visible(id))).value(visible(id)).nearest(near)
    }

    fn children(
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
        let name = node.tag_name().name();
        if path.len() >= DEEPEST {
            let message = format!("elements are nested more than {DEEPEST} deep");
            return Err(self
                .error(node, "svg.depth", message)
                .value(name)
                .allowed(format!("at most {DEEPEST} levels")));
        }
        let style = |word: &str| style(node, word);
        if style("display") == Some("none") || NOT_DRAWN.contains(&name) {
            return Ok(());
        }
        // What would cut the outline is refused, not ignored.
        for word in ["clip-path", "mask"] {
            if style(word).is_some_and(|value| value != "none") {
                let error = self.error(node, "svg.unsupported", format!("`{word}` cannot be read"));
                return Err(error.value(word).hint("apply it in the drawing program"));
            }
        }
        let fill = self.fills.within(node, fill)?;
        let map = after(map, &self.transform(node)?);
        let id = node.id().get_usize();
        path.push(id);
        match name {
            "svg" | "g" | "a" | "switch" => {
                if name == "svg"
                    && (node.has_attribute("viewBox") || node.has_attribute("x") || node.has_attribute("y"))
                {
                    let error = self.error(
                        node,
                        "svg.unsupported",
                        "an <svg> inside the drawing has a place of its own".into(),
                    );
                    return Err(error.value("svg").hint("make it a group <g> with a transform"));
                }
                self.children(node, &map, path, fill)?;
            }
            "use" => self.used(node, &map, path, fill)?,
            "path" | "rect" | "circle" | "ellipse" | "polygon" | "polyline" => {
                let mut curves = Curves::of_part(self.places.len() as u32);
                match name {
                    "path" => self.path(node, &mut curves)?,
                    "rect" => self.rectangle(node, &mut curves)?,
                    "circle" | "ellipse" => self.ellipse(node, name, &mut curves)?,
                    _ => self.points(node, name, &mut curves)?,
                }
                self.unfilled += usize::from(!fill.filled);
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
        let document = self.document;
        let Some(goal) = document.descendants().find(|node| node.attribute("id") == Some(id)) else {
            return Err(self.unknown(node, id, "svg.unknown_id"));
        };
        if path.contains(&goal.id().get_usize()) {
            let error = self.error(node, "svg.cycle", format!("`#{}` contains itself", visible(id)));
            return Err(error.value(visible(id)).hint("an element cannot be drawn inside of itself"));
        }
        let moved = [1.0, 0.0, 0.0, 1.0, self.number(node, "x", 0.0)?, self.number(node, "y", 0.0)?];
        let map = after(map, &moved);
        if goal.tag_name().name() == "symbol" {
            if goal.has_attribute("viewBox") {
                let error = self.error(goal, "svg.unsupported", "a <symbol> with a viewBox cannot be read".into());
                return Err(error.value("viewBox").hint("make it a group <g>"));
            }
            path.push(goal.id().get_usize());
            self.children(goal, &map, path, fill)?;
            path.pop();
            return Ok(());
        }
        // Many `use` of `use` could draw without end.
        if self.places.len() > MOST_PARTS {
            return Err(self.error(node, "shape.too_large", "the drawing has too many parts".into()).value(id));
        }
        self.element_at(goal, &map, path, fill)
    }

    /// Where a part of an attribute's value stands in the file.
    fn in_attribute(&self, attribute: &Attribute<'_, '_>, at: Option<usize>, error: SceneError) -> SceneError {
        let range = attribute.range_value();
        match at {
            // Positions count characters from 1.
            Some(k) => {
                let text = &self.source.text[range.clone()];
                let from = range.start + text.char_indices().nth(k.saturating_sub(1)).map_or(text.len(), |(k, _)| k);
                self.source.mark(error, from, from + 1)
            }
            None => self.source.mark(error, range.start, range.end),
        }
    }

    /// A value that the SVG grammar refuses.
    fn refused(&self, attribute: &Attribute<'_, '_>, error: &svgtypes::Error) -> SceneError {
        use svgtypes::Error as E;
        let at = match error {
            E::UnexpectedData(k) | E::InvalidChar(_, k) | E::InvalidString(_, k) | E::InvalidNumber(k) => Some(*k),
            E::UnexpectedEndOfStream => Some(attribute.value().chars().count() + 1),
            _ => None,
        };
        let text = error.to_string();
        let what = text.split(" at position").next().unwrap_or(&text);
        let found: String = match at {
            Some(k) => attribute.value().chars().skip(k.saturating_sub(1)).take(12).collect(),
            None => attribute.value().chars().take(40).collect(),
        };
        let message = format!("`{}` cannot be read: {}", attribute.name(), visible(what));
        self.in_attribute(attribute, at, SceneError::new("svg.syntax", message)).value(visible(&found))
    }

    fn transform(&self, node: Node<'_, '_>) -> Result<Affine, SceneError> {
        let Some(attribute) = node.attribute_node("transform") else { return Ok(IDENTITY) };
        let mut map = IDENTITY;
        for token in TransformListParser::from(attribute.value()) {
            let degrees = |angle: f64| angle / 180.0 * core::f64::consts::PI;
            let next = match token.map_err(|e| self.refused(&attribute, &e))? {
                TransformListToken::Matrix { a, b, c, d, e, f } => [a, b, c, d, e, f],
                TransformListToken::Translate { tx, ty } => [1.0, 0.0, 0.0, 1.0, tx, ty],
                TransformListToken::Scale { sx, sy } => [sx, 0.0, 0.0, sy, 0.0, 0.0],
                TransformListToken::Rotate { angle } => {
                    let (s, c) = (libm::sin(degrees(angle)), libm::cos(degrees(angle)));
                    [c, s, -s, c, 0.0, 0.0]
                }
                TransformListToken::SkewX { angle } => [1.0, 0.0, libm::tan(degrees(angle)), 1.0, 0.0, 0.0],
                TransformListToken::SkewY { angle } => [1.0, libm::tan(degrees(angle)), 0.0, 1.0, 0.0, 0.0],
            };
            map = after(&map, &next);
        }
        if map.iter().any(|x| !x.is_finite()) {
            let error = SceneError::new("svg.number", "the transform leaves the range of numbers");
            return Err(self.in_attribute(&attribute, None, error).value(visible(attribute.value())));
        }
        Ok(map)
    }

    /// A length in user units.
    fn number(&self, node: Node<'_, '_>, name: &str, default: f64) -> Result<f64, SceneError> {
        let Some(attribute) = node.attribute_node(name) else { return Ok(default) };
        let length: svgtypes::Length = attribute.value().parse().map_err(|e| self.refused(&attribute, &e))?;
        if !matches!(length.unit, LengthUnit::None | LengthUnit::Px) || !length.number.is_finite() {
            let error = SceneError::new("svg.unsupported", format!("`{name}` is no plain number"));
            let error = self.in_attribute(&attribute, None, error).value(visible(attribute.value()));
            return Err(error.allowed("a finite number without unit, or in px"));
        }
        Ok(length.number)
    }

    /// A length that must not be negative.
    fn size(&self, node: Node<'_, '_>, name: &str) -> Result<f64, SceneError> {
        let value = self.number(node, name, 0.0)?;
        match node.attribute_node(name) {
            Some(attribute) if value < 0.0 => {
                let error = SceneError::new("svg.number", format!("`{name}` is negative"));
                Err(self.in_attribute(&attribute, None, error).value(value.to_string()).allowed("0 or more"))
            }
            _ => Ok(value),
        }
    }

    fn rectangle(&self, node: Node<'_, '_>, curves: &mut Curves) -> Result<(), SceneError> {
        let (x, y) = (self.number(node, "x", 0.0)?, self.number(node, "y", 0.0)?);
        let (w, h) = (self.size(node, "width")?, self.size(node, "height")?);
        // One radius stands for both.
        let (rx, ry) = (self.size(node, "rx")?, self.size(node, "ry")?);
        let rx = if node.has_attribute("rx") { rx } else { ry };
        let ry = if node.has_attribute("ry") { ry } else { rx };
        let (rx, ry) = (smaller(rx, 0.5 * w), smaller(ry, 0.5 * h));
        if rx == 0.0 || ry == 0.0 {
            curves.polygon(&[[x, y], [x + w, y], [x + w, y + h], [x, y + h]]);
            return Ok(());
        }
        curves.move_to([x + rx, y]);
        let corners = [
            ([x + w - rx, y], [x + w, y + ry]),
            ([x + w, y + h - ry], [x + w - rx, y + h]),
            ([x + rx, y + h], [x, y + h - ry]),
            ([x, y + ry], [x + rx, y]),
        ];
        for (from, to) in corners {
            curves.line_to(from);
            curves.arc_to([rx, ry], 0.0, false, true, to);
        }
        Ok(())
    }

    fn ellipse(&self, node: Node<'_, '_>, name: &str, curves: &mut Curves) -> Result<(), SceneError> {
        let (x, y) = (self.number(node, "cx", 0.0)?, self.number(node, "cy", 0.0)?);
        let (rx, ry) = match name {
            "circle" => (self.size(node, "r")?, self.size(node, "r")?),
            _ => (self.size(node, "rx")?, self.size(node, "ry")?),
        };
        curves.move_to([x + rx, y]);
        curves.arc_to([rx, ry], 0.0, false, true, [x - rx, y]);
        curves.arc_to([rx, ry], 0.0, false, true, [x + rx, y]);
        Ok(())
    }

    fn points(&mut self, node: Node<'_, '_>, name: &str, curves: &mut Curves) -> Result<(), SceneError> {
        let Some(attribute) = node.attribute_node("points") else {
            return Err(self.error(node, "svg.syntax", format!("<{name}> has no `points`")).value(name));
        };
        let points: Vec<Point> = PointsParser::from(attribute.value()).map(|(x, y)| [x, y]).collect();
        // The library stops in silence at what it cannot read.
        let numbers = svgtypes::NumberListParser::from(attribute.value());
        let mut count = 0;
        for number in numbers {
            number.map_err(|e| self.refused(&attribute, &e))?;
            count += 1;
        }
        if count != 2 * points.len() {
            let error = SceneError::new("svg.syntax", format!("`points` has {count} numbers, which is odd"));
            return Err(self
                .in_attribute(&attribute, None, error)
                .value(count.to_string())
                .allowed("pairs of numbers"));
        }
        if name == "polyline" && points.first() != points.last() {
            self.open += 1;
        }
        curves.polygon(&points);
        Ok(())
    }

    fn path(&mut self, node: Node<'_, '_>, curves: &mut Curves) -> Result<(), SceneError> {
        let Some(attribute) = node.attribute_node("d") else {
            return Err(self.error(node, "svg.syntax", "<path> has no `d`".into()).value("path"));
        };
        let mut pen = Pen::on(curves);
        for segment in PathParser::from(attribute.value()) {
            pen.draw(segment.map_err(|e| self.refused(&attribute, &e))?);
        }
        pen.leave();
        self.open += pen.open;
        if !pen.at.iter().all(|x| x.is_finite()) {
            let error = SceneError::new("svg.number", "the path leaves the range of numbers");
            return Err(self.in_attribute(&attribute, None, error).value("inf"));
        }
        Ok(())
    }
}

/// A property of an element: in its `style`, or as an attribute.
pub(super) fn style<'n>(node: Node<'n, '_>, name: &str) -> Option<&'n str> {
    let in_style = node.attribute("style").and_then(|style| {
        style.split(';').find_map(|rule| {
            let (word, value) = rule.split_once(':')?;
            (word.trim() == name).then_some(value.trim())
        })
    });
    in_style.or_else(|| node.attribute(name).map(str::trim))
}
