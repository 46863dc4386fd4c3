//! The basic shapes of a drawing, with their attributes: lengths, transforms, points and paths.

use super::curves::{Affine, Curves, IDENTITY, Point, after, smaller};
use super::drawing_errors::SvgError;
use super::svg::Reader;
use super::svg_path::Pen;
use super::svg_units::units;
use crate::problem::{SceneError, visible};
use roxmltree::{Attribute, Node};
use svgtypes::{LengthUnit, PathParser, PointsParser, TransformListParser, TransformListToken};

impl Reader<'_, '_> {
    /// The location of a part of an attribute's value in the file.
    pub(super) fn in_attribute(&self, attribute: &Attribute<'_, '_>, at: Option<usize>, error: SvgError) -> SceneError {
        let error = SceneError::of(error);
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

    /// An error of the SVG grammar about a value.
    pub(super) fn refused(&self, attribute: &Attribute<'_, '_>, error: &svgtypes::Error) -> SceneError {
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
        let (reason, found) = (visible(what), visible(&found));
        self.in_attribute(attribute, at, SvgError::Attribute { attribute: attribute.name().into(), reason, found })
    }

    pub(super) fn transform(&self, node: Node<'_, '_>) -> Result<Affine, SceneError> {
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
            let value = visible(attribute.value());
            return Err(self.in_attribute(&attribute, None, SvgError::Transform { value }));
        }
        Ok(map)
    }

    /// A length in user units.
    pub(super) fn number(&self, node: Node<'_, '_>, name: &str, default: f64) -> Result<f64, SceneError> {
        let Some(attribute) = node.attribute_node(name) else { return Ok(default) };
        let length: svgtypes::Length = attribute.value().parse().map_err(|e| self.refused(&attribute, &e))?;
        let share = |along: Point| match name {
            "x" | "cx" | "width" | "rx" => along[0],
            "y" | "cy" | "height" | "ry" => along[1],
            _ => (0.5 * (along[0] * along[0] + along[1] * along[1])).sqrt(),
        };
        let unit = match length.unit {
            LengthUnit::Percent => self.canvas.map(|canvas| 0.01 * share(canvas)),
            unit => units(unit),
        };
        let value = unit.map(|unit| unit * length.number).filter(|value| value.is_finite());
        value.ok_or_else(|| {
            let value = visible(attribute.value());
            self.in_attribute(&attribute, None, SvgError::Length { attribute: name.into(), value })
        })
    }

    /// A length that must not be negative.
    pub(super) fn size(&self, node: Node<'_, '_>, name: &str) -> Result<f64, SceneError> {
        let value = self.number(node, name, 0.0)?;
        match node.attribute_node(name) {
            Some(attribute) if value < 0.0 => {
                Err(self.in_attribute(&attribute, None, SvgError::Negative { attribute: name.into(), value }))
            }
            _ => Ok(value),
        }
    }

    pub(super) fn rectangle(&self, node: Node<'_, '_>, curves: &mut Curves) -> Result<(), SceneError> {
        let (x, y) = (self.number(node, "x", 0.0)?, self.number(node, "y", 0.0)?);
        let (w, h) = (self.size(node, "width")?, self.size(node, "height")?);
        // If only one radius is given, it is used for both.
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

    pub(super) fn ellipse(&self, node: Node<'_, '_>, name: &str, curves: &mut Curves) -> Result<(), SceneError> {
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

    pub(super) fn points(&mut self, node: Node<'_, '_>, name: &str, curves: &mut Curves) -> Result<(), SceneError> {
        let Some(attribute) = node.attribute_node("points").filter(|points| !points.value().trim().is_empty()) else {
            self.empty += 1;
            return Ok(());
        };
        let points: Vec<Point> = PointsParser::from(attribute.value()).map(|(x, y)| [x, y]).collect();
        // The library silently stops at anything that it cannot read.
        let numbers = svgtypes::NumberListParser::from(attribute.value());
        let mut count = 0;
        for number in numbers {
            number.map_err(|e| self.refused(&attribute, &e))?;
            count += 1;
        }
        if count != 2 * points.len() {
            return Err(self.in_attribute(&attribute, None, SvgError::OddPoints { count }));
        }
        if name == "polyline" && points.first() != points.last() {
            self.open += 1;
        }
        curves.polygon(&points);
        Ok(())
    }

    pub(super) fn path(&mut self, node: Node<'_, '_>, curves: &mut Curves) -> Result<(), SceneError> {
        let nothing = |value: &str| value.is_empty() || value == "none";
        let Some(attribute) = node.attribute_node("d").filter(|path| !nothing(path.value().trim())) else {
            self.empty += 1;
            return Ok(());
        };
        let mut pen = Pen::on(curves);
        for segment in PathParser::from(attribute.value()) {
            pen.draw(segment.map_err(|e| self.refused(&attribute, &e))?);
        }
        pen.leave();
        self.open += pen.open;
        if !pen.at.iter().all(|x| x.is_finite()) {
            return Err(self.in_attribute(&attribute, None, SvgError::Path {}));
        }
        Ok(())
    }
}
