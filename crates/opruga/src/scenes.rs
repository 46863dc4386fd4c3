//! The scenes that come with the library, and the shapes in them.

use crate::io::Files;
use std::sync::Arc;

macro_rules! scenes {
    ($($name:literal),* $(,)?) => {
        const SCENES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/", $name, ".toml")))),*];
    };
}

scenes![
    "ball",
    "ball-as-published",
    "published-beside-physics",
    "pressures",
    "integrators",
    "implicit-integrators",
    "stiff-springs",
    "hanging-chain",
    "snap-through",
    "thousand-balls",
    "million-vertices",
    "giant-ring",
    "leaking-tyre",
    "two-chambers",
    "hanging-net",
    "cloth-over-ball",
    "balloons",
    "heart",
    "fish",
    "spot",
    "torus-tube",
    "country",
    "word",
    "emoji",
    "cantilever",
    "cantilever-cube",
    "cantilever-beam",
    "cooks-membrane",
    "jelly",
    "jelly-crowd",
    "terzopoulos-ring",
    "terzopoulos-cloth",
    "artdefo",
    "teran-cube",
    "shape-matched-letters",
    "five-methods",
    "pile",
    "newtons-bars",
    "funnel",
    "snake",
    "crowd",
    "trampoline",
    "balloon-press",
    "cloth-on-spot",
    "knot",
    "drawings",
    "heart-solid",
    "spot-solid",
];

macro_rules! shapes {
    ($($name:literal),* $(,)?) => {
        const SHAPES: &[(&str, &[u8])] = &[$((
            concat!("shapes/", $name),
            include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/shapes/", $name)),
        )),*];
    };
}

shapes![
    "heart.svg",
    "fish.svg",
    "apple.svg",
    "drop.svg",
    "star.svg",
    "spot.obj",
    "torus.obj",
    "countries-110m.json",
    "inter-black-subset.otf",
];

/// The files that these scenes name.
pub fn files() -> Files {
    Files::held(SHAPES.iter().map(|(name, bytes)| (name.to_string(), Arc::from(*bytes))))
}

/// The names of the scenes, in the order of the documentation.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|s| s.0)
}

/// The text of a scene.
pub fn find(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|s| s.0 == name).map(|s| s.1)
}

/// The title of a scene: the line `title = "…"` of its text.
pub fn title(text: &str) -> &str {
    line(text, "title")
}

/// Whose drawings, maps or surfaces a scene shows, and under which licence: the line `credit = "…"` of its text.
pub fn credit(text: &str) -> &str {
    line(text, "credit")
}

/// The text of a line `name = "…"`; empty where there is none.
fn line<'t>(text: &'t str, name: &str) -> &'t str {
    let value = |l: &'t str| l.strip_prefix(name)?.strip_prefix(" = \"")?.strip_suffix('"');
    text.lines().find_map(value).unwrap_or("")
}
