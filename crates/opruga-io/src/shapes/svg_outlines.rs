//! The properties that change the outlines of a drawing.

/// Properties that change outlines, each with the value that leaves outlines unchanged; none if every value changes them.
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

/// Whether a property changes outlines if it has this value.
pub(super) fn changes_outlines(name: &str, value: &str) -> bool {
    OUTLINES.iter().any(|(word, only)| {
        *word == name
            && match only {
                Some(only) => value == *only || value.parse::<f64>().is_ok_and(|x| x == 0.0) && *only == "0",
                None => value != "none",
            }
    })
}
