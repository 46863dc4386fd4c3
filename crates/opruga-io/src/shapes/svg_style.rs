//! Styles of a drawing that affect its outlines: refused if they would change outlines, otherwise counted.

use super::svg_sheets::Sheets;
use roxmltree::Node;

/// Properties that are read only as attributes; as styles they would override the attributes that place an element.
const PLACING: [&str; 5] = ["transform", "translate", "rotate", "scale", "offset-path"];

/// Properties in styles that give elements their sizes and positions, with the elements that have them.
const MEASURES: [(&str, &[&str]); 10] = [
    ("d", &["path"]),
    ("x", &["rect", "use", "svg"]),
    ("y", &["rect", "use", "svg"]),
    ("width", &["rect", "use", "svg"]),
    ("height", &["rect", "use", "svg"]),
    ("cx", &["circle", "ellipse"]),
    ("cy", &["circle", "ellipse"]),
    ("r", &["circle"]),
    ("rx", &["rect", "ellipse"]),
    ("ry", &["rect", "ellipse"]),
];

impl Sheets {
    /// A property, with its value, that would place or cut an element in a way that the reader does not support.
    pub(super) fn unread<'n>(&'n self, node: Node<'n, '_>) -> Option<(&'static str, &'n str)> {
        let set = |value: &&str| *value != "none";
        if let Some(value) = self.style(node, "mask").filter(set) {
            return Some(("mask", value));
        }
        let element = node.tag_name().name();
        // The size of the whole drawing has no influence on its outlines.
        let inner = node.parent_element().is_some();
        let measures = MEASURES.iter().filter(|(_, of)| inner && of.contains(&element)).map(|(name, _)| *name);
        for name in PLACING.into_iter().chain(measures) {
            if let Some(value) = self.declared(node, name).filter(set).filter(|value| *value != "auto") {
                return Some((name, value));
            }
        }
        // This property moves the centre of a transform.
        let moved = self.style(node, "transform-origin").filter(|_| node.has_attribute("transform"));
        moved.filter(|value| !matches!(*value, "0" | "0 0" | "0px 0px")).map(|value| ("transform-origin", value))
    }

    /// Whether an element exists but is invisible. Visibility is inherited, and children may restore it.
    pub(super) fn is_hidden(&self, node: Node<'_, '_>) -> bool {
        let inherited = |node| self.style(node, "visibility").filter(|value| *value != "inherit");
        matches!(node.ancestors().find_map(inherited), Some("hidden" | "collapse"))
    }

    /// Whether an element and its contents are fully transparent.
    pub(super) fn is_clear(&self, node: Node<'_, '_>) -> bool {
        let opacity = self.style(node, "opacity").map(|value| value.trim_end_matches('%').trim().parse::<f64>());
        matches!(opacity, Some(Ok(x)) if x <= 0.0)
    }

    /// Whether markers would be drawn along an element.
    pub(super) fn has_markers(&self, node: Node<'_, '_>) -> bool {
        ["marker", "marker-start", "marker-mid", "marker-end"]
            .iter()
            .any(|name| self.style(node, name).is_some_and(|value| value != "none"))
    }

    /// Whether a stroke would be drawn along an element, which makes the element larger by half of the stroke width. Strokes are inherited.
    pub(super) fn has_stroke(&self, node: Node<'_, '_>) -> bool {
        let inherited =
            |name: &str| node.ancestors().find_map(|node| self.style(node, name).filter(|value| *value != "inherit"));
        let nothing = |value: &str| value.trim_end_matches(|c: char| c == '%' || c.is_alphabetic()).parse() == Ok(0.0);
        let drawn = inherited("stroke").is_some_and(|paint| !matches!(paint, "none" | "transparent"));
        drawn && !["stroke-width", "stroke-opacity"].into_iter().any(|name| inherited(name).is_some_and(nothing))
    }
}

/// Elements that change others over time: the drawing is read without them.
pub(super) const ANIMATIONS: [&str; 6] =
    ["animate", "animateColor", "animateMotion", "animateTransform", "discard", "set"];

/// The number of animations directly within an element.
pub(super) fn animations_of(node: Node<'_, '_>) -> usize {
    node.children().filter(|child| ANIMATIONS.contains(&child.tag_name().name())).count()
}
