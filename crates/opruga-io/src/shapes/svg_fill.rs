//! Fill colours of a drawing, inherited from element to element according to the standard.

use super::drawing_errors::SvgError;
use super::rules::Rule;
use super::svg_sheets::Sheets;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::message::Setting;
use roxmltree::{Document, Node};
use svgtypes::{Color, Paint, PaintFallback};

/// The fill of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fill {
    /// Whether the element is filled at all.
    pub(super) filled: bool,
    /// Red, green and blue.
    colour: [u8; 3],
    /// The opacity, from 0 to 1: that of its colour times that of the groups around it.
    opacity: f64,
    /// The value of `fill-opacity`, which is inherited and not multiplied.
    fill_opacity: f64,
    /// The fill rule.
    rule: Rule,
    /// Whether a rule of a style sheet may apply to the element, or to an element around it, but the reader cannot decide whether it does.
    styled: bool,
}

impl Fill {
    /// The default fill: black.
    pub(super) const FIRST: Fill =
        Fill { filled: true, colour: [0; 3], opacity: 1.0, fill_opacity: 1.0, rule: Rule::Unsaid, styled: false };

    /// The default fill of a clip path.
    pub(super) const CLIP: Fill = Fill { rule: Rule::NonZero, ..Fill::FIRST };
}

/// Reads the fills of elements.
pub(super) struct Fills<'a, 'd> {
    document: &'d Document<'a>,
    source: &'a Source<'a>,
    /// Whether colours are needed; if not, only whether an element is filled matters.
    wanted: bool,
    /// Red, green, blue and opacity of every part of the drawing; none for parts that are not filled.
    pub(super) painted: Vec<Option<[u8; 4]>>,
    /// The number of elements that are filled with a gradient.
    pub(super) gradients: usize,
    /// The number of parts for which the reader cannot decide whether a rule of a style sheet applies.
    pub(super) styled: usize,
    /// The fill rule of every part of the drawing.
    pub(super) rules: Vec<Rule>,
    sheets: &'d Sheets,
    /// The property with the fill rule; clip paths have a separate one.
    rule: &'static str,
}

impl<'a, 'd> Fills<'a, 'd> {
    /// A reader that has not read anything yet.
    pub(super) fn of(
        document: &'d Document<'a>,
        source: &'a Source<'a>,
        sheets: &'d Sheets,
        wanted: bool,
    ) -> Fills<'a, 'd> {
        let rule = "fill-rule";
        Fills {
            document,
            source,
            wanted,
            painted: Vec::new(),
            gradients: 0,
            styled: 0,
            rules: Vec::new(),
            sheets,
            rule,
        }
    }

    /// A reader for a clip path that has not read anything yet.
    pub(super) fn of_clip(&self) -> Fills<'a, 'd> {
        Fills { rule: "clip-rule", ..Fills::of(self.document, self.source, self.sheets, false) }
    }

    /// Returns the fill of an element inside an element with the fill `around`.
    ///
    /// # Errors
    /// `svg.colour` for something that is not a fill, if colours are needed; `svg.unsupported` for an unknown fill rule; `svg.style` for style sheets
    /// that may change outlines.
    pub(super) fn within(&mut self, node: Node<'_, '_>, around: Fill) -> Result<Fill, SceneError> {
        let mut fill = around;
        let sheets = self.sheets;
        fill.styled |= sheets.may_be_about(node, self.source)?;
        match sheets.style(node, self.rule) {
            None | Some("inherit") => {}
            Some("evenodd") => fill.rule = Rule::EvenOdd,
            Some("nonzero") => fill.rule = Rule::NonZero,
            Some(other) => {
                return Err(self.mark(node, SvgError::FillRule { value: visible(other) }));
            }
        }
        if !self.wanted {
            let own = sheets.style(node, "fill").filter(|fill| *fill != "inherit");
            fill.filled = own.map_or(around.filled, |fill| fill != "none");
            return Ok(fill);
        }
        if let Some(text) = sheets.style(node, "fill") {
            let (paint, alpha) = self.colour(node, text, around)?;
            fill.filled = paint.is_some();
            (fill.colour, fill.opacity) = (paint.unwrap_or(fill.colour), around.opacity * alpha);
        }
        if let Some(text) = sheets.style(node, "fill-opacity") {
            fill.fill_opacity = self.share(node, "fill-opacity", text)?;
        }
        if let Some(text) = sheets.style(node, "opacity") {
            fill.opacity *= self.share(node, "opacity", text)?;
        }
        Ok(fill)
    }

    /// Stores the fill of the next part of the drawing.
    pub(super) fn paint(&mut self, fill: Fill) {
        self.rules.push(fill.rule);
        self.styled += usize::from(fill.styled);
        let opacity = (fill.opacity * fill.fill_opacity * 255.0).round() as u8;
        let [red, green, blue] = fill.colour;
        self.painted.push((self.wanted && fill.filled && opacity > 0).then_some([red, green, blue, opacity]));
    }

    /// A fill and the opacity of its colour; no colour for `none`.
    fn colour(&mut self, node: Node<'_, '_>, text: &str, around: Fill) -> Result<(Option<[u8; 3]>, f64), SceneError> {
        let plain = |c: Color| (Some([c.red, c.green, c.blue]), f64::from(c.alpha) / 255.0);
        match Paint::from_str(text) {
            Ok(Paint::None) => Ok((None, 1.0)),
            Ok(Paint::Inherit | Paint::ContextFill) => Ok((around.filled.then_some(around.colour), 1.0)),
            Ok(Paint::CurrentColor) => {
                // `color` is inherited.
                let inherited = node.ancestors().find_map(|n| self.sheets.style(n, "color"));
                match inherited.map(str::parse::<Color>) {
                    None => Ok(plain(Color::black())),
                    Some(Ok(colour)) => Ok(plain(colour)),
                    Some(Err(_)) => Err(self.refused(node, inherited.unwrap_or(""))),
                }
            }
            Ok(Paint::Color(colour)) => Ok(plain(colour)),
            Ok(Paint::FuncIRI(id, fallback)) => match (self.gradient(id)?, fallback) {
                (Some(mean), _) => {
                    self.gradients += 1;
                    Ok((Some([mean[0], mean[1], mean[2]]), f64::from(mean[3]) / 255.0))
                }
                (None, Some(PaintFallback::Color(colour))) => Ok(plain(colour)),
                (None, Some(PaintFallback::None)) => Ok((None, 1.0)),
                (None, _) => Err(self.refused(node, text)),
            },
            Ok(Paint::ContextStroke) | Err(_) => Err(self.refused(node, text)),
        }
    }

    /// The mean colour of the stops of a gradient; none if the gradient does not exist.
    fn gradient(&self, id: &str) -> Result<Option<[u8; 4]>, SceneError> {
        let mut next = id;
        // A gradient may take its stops from another one.
        for _ in 0..16 {
            let [Some(node), _] = self.sheets.index.named(self.document, next) else { return Ok(None) };
            if !matches!(node.tag_name().name(), "linearGradient" | "radialGradient") {
                return Ok(None);
            }
            let (mut sum, mut count) = ([0.0; 4], 0.0);
            for stop in node.children().filter(|child| child.tag_name().name() == "stop") {
                let text = self.sheets.style(stop, "stop-color").unwrap_or("black");
                let colour: Color = text.parse().map_err(|_| self.refused(stop, text))?;
                let opacity = self.sheets.style(stop, "stop-opacity");
                let opacity = opacity.map_or(Ok(1.0), |t| self.share(stop, "stop-opacity", t))?;
                let parts = [colour.red, colour.green, colour.blue, colour.alpha].map(f64::from);
                sum = [sum[0] + parts[0], sum[1] + parts[1], sum[2] + parts[2], sum[3] + parts[3] * opacity];
                count += 1.0;
            }
            if count > 0.0 {
                return Ok(Some(sum.map(|s: f64| (s / count).round() as u8)));
            }
            let link = node.attribute("href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")));
            let Some(other) = link.and_then(|link| link.strip_prefix('#')) else { return Ok(None) };
            next = other;
        }
        Ok(None)
    }

    /// A number from 0 to 1, or a percentage.
    fn share(&self, node: Node<'_, '_>, name: &str, text: &str) -> Result<f64, SceneError> {
        let (number, unit) = text.strip_suffix('%').map_or((text, 1.0), |number| (number, 100.0));
        match number.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok((x / unit).clamp(0.0, 1.0)),
            _ => Err(self.mark(node, SvgError::Share { property: name.into(), value: visible(text) })),
        }
    }

    fn refused(&self, node: Node<'_, '_>, text: &str) -> SceneError {
        self.mark(node, SvgError::Colour { value: visible(text), colours: Setting::with("colours", false) })
    }

    /// An error at the tag of an element.
    fn mark(&self, node: Node<'_, '_>, error: SvgError) -> SceneError {
        let range = node.range();
        let end = self.source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
        self.source.mark(SceneError::of(error), range.start, end)
    }
}
