//! What styles of a drawing say about its outlines: refused where it would change them, else counted.

use super::svg_xml::is_drawing;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use roxmltree::{Document, Node};

/// Properties that change outlines, each with the value that does not; none where any value does.
const OUTLINES: [(&str, Option<&str>); 22] = [
    ("display", Some("none")),
    ("visibility", Some("hidden")),
    ("visibility", Some("collapse")),
    ("opacity", Some("0")),
    ("transform", None),
    ("translate", None),
    ("rotate", None),
    ("scale", None),
    ("offset-path", None),
    ("clip-path", None),
    ("mask", None),
    ("fill-rule", None),
    ("d", None),
    ("x", None),
    ("y", None),
    ("width", None),
    ("height", None),
    ("cx", None),
    ("cy", None),
    ("r", None),
    ("rx", None),
    ("ry", None),
];

/// Properties that are read as attributes only, where they place an element otherwise than its attributes say.
const PLACING: [&str; 5] = ["transform", "translate", "rotate", "scale", "offset-path"];

/// A property of an element: in its `style`, or as an attribute.
pub(super) fn style<'n>(node: Node<'n, '_>, name: &str) -> Option<&'n str> {
    in_style(node, name).or_else(|| node.attribute(name).map(str::trim))
}

/// A property in the `style` of an element.
fn in_style<'n>(node: Node<'n, '_>, name: &str) -> Option<&'n str> {
    node.attribute("style")?.split(';').find_map(|rule| {
        let (word, value) = rule.split_once(':')?;
        (word.trim() == name).then_some(value.trim())
    })
}

/// The style sheets of a drawing: what their rules are about.
#[derive(Debug, Default)]
pub(super) struct Sheets {
    /// Names of elements, `.class`, `#id`, and `*`.
    about: Vec<String>,
}

impl Sheets {
    /// Reads what the style sheets of a drawing are about.
    ///
    /// # Errors
    /// `svg.style` for one that changes outlines.
    pub(super) fn of(document: &Document<'_>, source: &Source<'_>) -> Result<Sheets, SceneError> {
        let mut sheets = Sheets::default();
        for node in document.descendants().filter(|node| is_drawing(*node) && node.tag_name().name() == "style") {
            let text: String = node.descendants().filter(Node::is_text).filter_map(|node| node.text()).collect();
            let text = without_comments(&text);
            let mut start = 0;
            for (place, mark) in text.match_indices(['{', '}', ';']) {
                let piece = text[start..place].trim();
                start = place + 1;
                if mark == "{" {
                    let apart = |c: char| !(c.is_alphanumeric() || "-_.#*".contains(c));
                    let words = piece.split(apart).filter(|word| !word.is_empty());
                    sheets.about.extend(words.flat_map(simple));
                    continue;
                }
                let Some((name, value)) = piece.split_once(':') else { continue };
                let (name, value) = (name.trim(), value.trim().trim_end_matches("!important").trim());
                if changes_outlines(name, value) {
                    let range = node.range();
                    let end = source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
                    let message = format!("a style sheet sets `{}`, which changes outlines", visible(name));
                    let error = source.mark(SceneError::new("svg.style", message), range.start, end);
                    let error = error.value(visible(&format!("{name}: {value}")));
                    let allowed = "style sheets that set colours and strokes alone";
                    return Err(error
                        .allowed(allowed)
                        .hint("let the drawing program write attributes instead of a sheet"));
                }
            }
        }
        Ok(sheets)
    }

    /// Whether a rule may be about an element.
    pub(super) fn are_about(&self, node: Node<'_, '_>) -> bool {
        let mut words = vec!["*".to_string(), node.tag_name().name().to_string()];
        words.extend(node.attribute("id").map(|id| format!("#{id}")));
        words.extend(node.attribute("class").unwrap_or("").split_whitespace().map(|class| format!(".{class}")));
        self.about.iter().any(|about| words.contains(about))
    }
}

/// The simple selectors in a word such as `path.thick#left`.
fn simple(word: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    for c in word.chars() {
        if ".#".contains(c) {
            found.push(String::new());
        }
        if let Some(last) = found.last_mut() {
            last.push(c);
        }
    }
    found.retain(|word| !word.is_empty());
    found
}

fn changes_outlines(name: &str, value: &str) -> bool {
    OUTLINES.iter().any(|(word, only)| {
        *word == name
            && match only {
                Some(only) => value == *only || value.parse::<f64>().is_ok_and(|x| x == 0.0) && *only == "0",
                None => value != "none",
            }
    })
}

fn without_comments(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        out.push_str(before);
        rest = after.split_once("*/").map_or("", |(_, after)| after);
    }
    out + rest
}

/// A property of an element that would place or cut it otherwise than it is read, with the value that it has.
pub(super) fn unread<'n>(node: Node<'n, '_>) -> Option<(&'static str, &'n str)> {
    let set = |value: &&str| *value != "none";
    for name in ["clip-path", "mask"] {
        if let Some(value) = style(node, name).filter(set) {
            return Some((name, value));
        }
    }
    for name in PLACING {
        if let Some(value) = in_style(node, name).filter(set) {
            return Some((name, value));
        }
    }
    // It moves the centre of a transform.
    let moved = style(node, "transform-origin").filter(|_| node.has_attribute("transform"));
    moved.filter(|value| !matches!(*value, "0" | "0 0" | "0px 0px")).map(|value| ("transform-origin", value))
}

/// Whether an element is there but cannot be seen. Visibility is inherited, and may come back.
pub(super) fn is_hidden(node: Node<'_, '_>) -> bool {
    let seen = node.ancestors().find_map(|node| style(node, "visibility").filter(|value| *value != "inherit"));
    matches!(seen, Some("hidden" | "collapse"))
}

/// Whether an element and all that is in it is fully transparent.
pub(super) fn is_clear(node: Node<'_, '_>) -> bool {
    let opacity = style(node, "opacity").map(|value| value.trim_end_matches('%').trim().parse::<f64>());
    matches!(opacity, Some(Ok(x)) if x <= 0.0)
}

/// Whether markers would be drawn along an element.
pub(super) fn has_markers(node: Node<'_, '_>) -> bool {
    ["marker", "marker-start", "marker-mid", "marker-end"]
        .iter()
        .any(|name| style(node, name).is_some_and(|value| value != "none"))
}

/// Elements that change others in time: the drawing is read as it is without them.
pub(super) const ANIMATIONS: [&str; 6] =
    ["animate", "animateColor", "animateMotion", "animateTransform", "discard", "set"];

/// How many animations stand in an element itself.
pub(super) fn animations_of(node: Node<'_, '_>) -> usize {
    node.children().filter(|child| ANIMATIONS.contains(&child.tag_name().name())).count()
}

/// Whether a stroke would be drawn along an element, which makes it larger by half of its width. Strokes are inherited.
pub(super) fn has_stroke(node: Node<'_, '_>) -> bool {
    let said = |name: &str| node.ancestors().find_map(|node| style(node, name).filter(|value| *value != "inherit"));
    let nothing = |value: &str| value.trim_end_matches(|c: char| c == '%' || c.is_alphabetic()).parse() == Ok(0.0);
    let drawn = said("stroke").is_some_and(|paint| !matches!(paint, "none" | "transparent"));
    drawn && !["stroke-width", "stroke-opacity"].into_iter().any(|name| said(name).is_some_and(nothing))
}
