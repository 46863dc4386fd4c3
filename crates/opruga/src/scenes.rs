//! The scenes that come with the library, and their shapes.

use crate::io::problem::visible;
use crate::io::{Files, SceneError};
use opruga_core::spec::close_matches;
use opruga_math::message::Variant;
use std::path::Path;
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
    Files::in_memory(SHAPES.iter().map(|(name, bytes)| (name.to_string(), Arc::from(*bytes))))
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

/// The authors and the licence of the drawings, maps or surfaces in a scene: the line `credit = "…"` of its text.
pub fn credit(text: &str) -> &str {
    line(text, "credit")
}

/// The text between the quotes of a line `name = "…"`; empty if there is no such line.
fn line<'t>(text: &'t str, name: &str) -> &'t str {
    let value = |l: &'t str| l.strip_prefix(name)?.strip_prefix(" = \"")?.strip_suffix('"');
    text.lines().find_map(value).unwrap_or("")
}

opruga_math::messages! {
    /// Why a name does not belong to a scene.
    #[derive(Clone, Debug, PartialEq)]
    pub enum NoSuchScene {
        /// No similar name exists.
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("scenes that come with the program: {scenes}")]
        NoScene { scenes: String },
        /// Exactly one scene or file has a similar name.
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("did you mean {closest}?")]
        NoSceneNear { closest: String },
        /// Several scenes or files have similar names.
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("did you mean {closest} or {last}?")]
        NoSceneNearOf { closest: String, last: String },
    }
}

/// All messages of scenes by name, for catalogues.
pub const MESSAGES: &[&[Variant]] = &[NoSuchScene::VARIANTS];

/// The error for a name that belongs to no file and to no scene of the library. The error lists the scenes, and the files in the folder, that have
/// similar names.
pub fn missing(name: &str) -> SceneError {
    let path = Path::new(name);
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let files: Vec<String> = std::fs::read_dir(folder.unwrap_or(Path::new(".")))
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|file| file.ends_with(".toml"))
        .map(|file| folder.map_or(file.clone(), |folder| folder.join(&file).display().to_string()))
        .collect();
    let with_ending = format!("{name}.toml");
    let closest: Vec<String> = match files.contains(&with_ending) {
        true => vec![with_ending],
        false => {
            let mut known: Vec<&str> = names().collect();
            known.extend(files.iter().map(String::as_str));
            close_matches(name, known.into_iter())
        }
    };
    let quoted: Vec<String> = closest.iter().map(|name| format!("`{}`", visible(name))).collect();
    SceneError::of(match quoted.split_last() {
        Some((last, [])) => NoSuchScene::NoSceneNear { closest: last.clone() },
        Some((last, others)) => NoSuchScene::NoSceneNearOf { closest: others.join(", "), last: last.clone() },
        None => NoSuchScene::NoScene { scenes: names().collect::<Vec<_>>().join(", ") },
    })
}
