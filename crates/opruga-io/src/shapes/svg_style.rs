//! What styles of a drawing say about its outlines: refused where it would change them, else counted.

use super::svg_sheets::Sheets;
use roxmltree::Node;

/// Properties that are read as attributes only, where they place an element otherwise than its attributes say.
const PLACING: [&str; 5] = ["transform", "translate", "rotate", "scale", "offset-path"];

/// Properties that give elements their sizes and places, where they stand in styles, with the elements that have them.
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
    /// A property of an element that would place or cut it otherwise than it is read, with the value that it has.
    pub(super) fn unread<'n>(&'n self, node: Node<'n, '_>) -> Option<(&'static str, &'n str)> {
        let set = |value: &&str| *value != "none";
        if let Some(value) = self.style(node, "mask").filter(set) {
            return Some(("mask", value));
        }
        let element = node.tag_name().name();
        // The size of the whole drawing says nothing about its outlines.
        let inner = node.parent_element().is_some();
        let measures = MEASURES.iter().filter(|(_, of)| inner && of.contains(&element)).map(|(name, _)| *name);
        for name in PLACING.into_iter().chain(measures) {
            if let Some(value) = self.declared(node, name).filter(set).filter(|value| *value != "auto") {
                return Some((name, value));
            }
        }
        // It moves the centre of a transform.
        let moved = self.style(node, "transform-origin").filter(|_| node.has_attribute("transform"));
        moved.filter(|value| !matches!(*value, "0" | "0 0" | "0px 0px")).map(|value| ("transform-origin", value))
    }

    /// Whether an element is there but cannot be seen. Visibility is inherited, and may come back.
    pub(super) fn is_hidden(&self, node: Node<'_, '_>) -> bool {
        let inherited = |node| self.style(node, "visibility").filter(|value| *value != "inherit");
        matches!(node.ancestors().find_map(inherited), Some("hidden" | "collapse"))
    }

    /// Whether an element and all that is in it is fully transparent.
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

    /// Whether a stroke would be drawn along an element, which makes it larger by half of its width. Strokes are inherited.
    pub(super) fn has_stroke(&self, node: Node<'_, '_>) -> bool {
        let inherited =
            |name: &str| node.ancestors().find_map(|node| self.style(node, name).filter(|value| *value != "inherit"));
        let nothing = |value: &str| value.trim_end_matches(|c: char| c == '%' || c.is_alphabetic()).parse() == Ok(0.0);
        let drawn = inherited("stroke").is_some_and(|paint| !matches!(paint, "none" | "transparent"));
        drawn && !["stroke-width", "stroke-opacity"].into_iter().any(|name| inherited(name).is_some_and(nothing))
    }
}

/// Elements that change others in time: the drawing is read as it is without them.
pub(super) const ANIMATIONS: [&str; 6] =
    ["animate", "animateColor", "animateMotion", "animateTransform", "discard", "set"];

/// How many animations stand in an element itself.
pub(super) fn animations_of(node: Node<'_, '_>) -> usize {
    node.children().filter(|child| ANIMATIONS.contains(&child.tag_name().name())).count()
}
