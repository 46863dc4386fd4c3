//! Scene files: text → checked [`Blueprint`], or all errors at once.
//!
//! The steps are: bytes → checks of encoding, size and depth → TOML with locations → overrides → sections, according to the constants of
//! [`opruga_world::schema`] and the caller's [`Catalogue`] → meshes, if the estimate of memory is within its limit → references and selectors.

mod actions;
mod bodies;
mod body_list;
mod copies;
mod cost;
mod dimension;
pub(crate) mod errors;
mod lifetimes;
mod moments;
mod names;
mod parameters;
mod parts;
mod pins;
mod plain;
mod probes;
mod reader;
mod references;
mod selectors;
mod shape;
mod velocities;
pub mod written;

use crate::catalogue::Catalogue;
use crate::document::{self, Data, Location, Node};
use crate::files::Files;
pub use crate::limits::Limits;
use crate::overrides;
use crate::problem::{Notice, SceneError, visible};
use crate::regular_file::regular_file;
use crate::source::Source;
use crate::text_errors::{Measured, TextError};
use body_list::Bodies;
pub(crate) use cost::{Cost, CostError, shown};
pub(crate) use errors::MESSAGES;
use errors::{Part, ReferenceError, SceneHint};
use moments::Frames;
use opruga_core::spec::{ConditionText, Values, nearest};
use opruga_world::blueprint::{
    AnyBlueprint, Blueprint, ColliderBlueprint, ContactBlueprint, LoadBlueprint, Pictured, Surroundings, Time,
};
use opruga_world::validity::BlueprintFault;
use opruga_world::{schema, validity};
use reader::{Reader, join, listed};
pub use shape::of_fields as shape_of_fields;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// How a scene is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// The limits on the cost of the scene.
    pub limits: Limits,
    /// Whether unknown fields are notices instead of errors.
    pub lenient: bool,
    /// Whether notices are errors.
    pub strict: bool,
    /// Overrides of parameters, each a path and a value, as `--set PATH=VALUE` gives them.
    pub overrides: Vec<(String, String)>,
    /// The source of the files that the scene names. By default there are no files.
    pub files: Files,
}

/// The result of reading a scene.
#[derive(Debug)]
pub struct Reading {
    /// The complete scene if there are no errors. If there are errors, the scene without commands and probes, and without the bodies, obstacles,
    /// loads and pins that have errors of their own; this is enough to find further errors in the rest. None if too little remains.
    pub blueprint: Option<AnyBlueprint>,
    /// All errors that can be found at once, in the order of their locations.
    pub errors: Vec<SceneError>,
    /// Notices about anything unusual in the scene.
    pub notices: Vec<Notice>,
    /// The files that the scene names, by name. These files are needed to read the scene again.
    pub files: BTreeMap<String, Arc<[u8]>>,
    /// The names of files that the scene names but that could not be read.
    pub unread: Vec<String>,
}

impl Reading {
    /// Whether everything that holds bodies in statics is known, that is, whether no error removes a pin, a load or an obstacle from the blueprint.
    pub fn knows_what_holds(&self) -> bool {
        self.errors.iter().all(|error| {
            let parts: Vec<&str> = error.path.split('.').collect();
            let holds = matches!(parts[0], "load" | "collider" | "world") || parts.contains(&"pin");
            // An unknown section may be a misspelt section of this kind. Errors that are only counted may be about anything.
            let unknown = error.code == "scene.unknown_field" && parts.len() == 1;
            !holds && !unknown && error.code != "scene.more"
        })
    }
}

/// Reads a scene from bytes.
///
/// # Errors
/// All errors that can be found at once, in the order of their locations.
pub fn read(
    bytes: &[u8],
    file: &str,
    catalogue: &Catalogue,
    options: &Options,
) -> Result<(AnyBlueprint, Vec<Notice>), Vec<SceneError>> {
    match survey(bytes, file, catalogue, options) {
        Reading { blueprint: Some(blueprint), errors, notices, .. } if errors.is_empty() => Ok((blueprint, notices)),
        Reading { errors, .. } => Err(errors),
    }
}

/// Reads as much of a scene as its errors allow, for callers that look for further errors; all other callers use [`read`].
pub fn survey(bytes: &[u8], file: &str, catalogue: &Catalogue, options: &Options) -> Reading {
    let nothing = |errors| {
        let (notices, files, unread) = Default::default();
        Reading { blueprint: None, errors, notices, files, unread }
    };
    let source = match Source::new(file, bytes, &options.limits) {
        Ok(source) => source,
        Err(error) => return nothing(vec![error]),
    };
    let (document, mut errors) = document::parse(&source);
    let Some(mut document) = document else { return nothing(errors) };
    if let Err(mut problems) = overrides::apply_all(&mut document, &options.overrides) {
        errors.append(&mut problems);
    }
    let mut reader = Reader::new(&source, catalogue, options, errors);
    let blueprint = if reader.format(&document) { dimension::read(&mut reader, &document) } else { None };
    let (files, unread) = (std::mem::take(&mut reader.files), std::mem::take(&mut reader.unread));
    let (errors, notices) = reader.finish();
    Reading { blueprint, errors, notices, files, unread }
}

/// Reads a scene from a file. The files that it names are read from the same folder, or from the location that `options` give. A file that is not
/// regular, or larger than the limit, is refused before it is read.
///
/// # Errors
/// The errors of [`read`], and `read.failed` if the file cannot be read.
pub fn read_file(
    path: &Path,
    catalogue: &Catalogue,
    options: &Options,
) -> Result<(AnyBlueprint, Vec<Notice>), Vec<SceneError>> {
    let file = path.display().to_string();
    let bytes = bytes_of(path, &options.limits).map_err(|e| vec![SceneError { file: file.clone(), ..e }])?;
    let mut options = options.clone();
    if options.files == Files::default() {
        options.files = Files::beside(path);
    }
    read(&bytes, &file, catalogue, &options)
}

/// Converts an error of another TOML parser about a scene to an error at its location.
pub fn not_toml(text: &str, file: &str, reason: &str, bytes: core::ops::Range<usize>) -> SceneError {
    let error = SceneError::of(TextError::Syntax { reason: reason.into() });
    Source { file, text }.mark(error, bytes.start, bytes.end)
}

/// Returns the bytes of a regular file that is not larger than the limit.
///
/// # Errors
/// `read.failed`, `read.not_regular_file`, `read.changed` if the file is written at the same time, or `scene.too_large`.
pub fn bytes_of(path: &Path, limits: &Limits) -> Result<Vec<u8>, SceneError> {
    let bytes = regular_file(path, limits.file_bytes, "scene.too_large", Measured::Scene);
    bytes.map(|bytes| bytes.to_vec()).map_err(|error| match error.code {
        "read.failed" if !path.exists() => error.advice(SceneHint::ListScenes {}),
        _ => error,
    })
}

/// Reads everything below the head of a scene; parts with errors are left out.
fn scene<const D: usize>(reader: &mut Reader<'_>, root: &Node) -> Option<Blueprint<D>> {
    let top = reader.fields(root, "", &schema::SCENE, None);
    let before = reader.count();
    let time = time(reader, root);
    // Without these fields it is not known when commands begin.
    let timed = reader.count() == before && root.get("time").is_some();
    let frames = timed.then(|| Frames::of(root, &time));
    let surroundings = surroundings(reader, root);
    let picture = picture(reader, root);
    let integrator = reader.integrator(root, "");
    let founded = reader.count() == before && root.get("time").is_some();
    let known = reader.catalogue.colliders.clone();
    let mut colliders = Vec::new();
    let mut sound_colliders = Vec::new();
    for (node, path) in reader.list(root, "", "collider") {
        let before = reader.count();
        let Some(values) = reader.kind_table(node, &path, Part::Collider, &known) else { continue };
        sound_colliders.extend((reader.count() == before).then(|| ColliderBlueprint { values: values.clone() }));
        colliders.push(ColliderBlueprint { values });
    }
    let mut bodies = bodies::all::<D>(reader, root, top.integer("seed").unwrap_or(1) as u64);
    let commands = reader.list(root, "", "command");
    bodies::later(reader, &commands, &mut bodies);
    let contact = contact(reader, root, &bodies);
    let loads = actions::loads(reader, root, &bodies);
    let commands = actions::commands(reader, &commands, &bodies, integrator.as_ref(), &colliders, frames.as_ref());
    let probes = probes::probes(reader, root, &bodies);
    bodies.list.truncate(bodies.initial);
    let whole = Blueprint {
        name: scene_name(reader.source.file),
        title: top.text("title").unwrap_or("").to_string(),
        length_unit: top.text("length_unit").unwrap_or("m").to_string(),
        credit: top.text("credit").unwrap_or("").to_string(),
        picture,
        seed: top.integer("seed").unwrap_or(1) as u64,
        time,
        surroundings,
        integrator: integrator?,
        bodies: bodies.list,
        colliders,
        contact,
        loads,
        commands,
        probes,
    };
    if reader.count() == 0 {
        return Some(whole);
    }
    // Keeps the parts without errors of their own; loads refer to the index of their body.
    let mut sound_count = 0;
    let sound_indices: Vec<Option<usize>> = (0..whole.bodies.len())
        .map(|k| {
            let sound = !bodies.unsound.contains(&k);
            sound_count += usize::from(sound);
            sound.then(|| sound_count - 1)
        })
        .collect();
    let loads =
        whole.loads.into_iter().filter_map(|load| Some(LoadBlueprint { body: sound_indices[load.body]?, ..load }));
    founded.then(|| Blueprint {
        // Bodies keep all of their pins, because in statics nothing would hold a body without them. A pin that selects nonexistent nodes holds
        // nothing.
        bodies: whole.bodies.into_iter().zip(&sound_indices).filter_map(|(body, index)| index.map(|_| body)).collect(),
        colliders: sound_colliders,
        loads: loads.collect(),
        commands: Vec::new(),
        probes: Vec::new(),
        ..whole
    })
}

/// The name of the file without its folder and ending.
fn scene_name(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(|| "scene".to_string(), |s| s.to_string_lossy().into_owned())
}

fn time(reader: &mut Reader<'_>, root: &Node) -> Time {
    let Some(node) = root.get("time") else { return Time { seconds: 0.0, frame: 1.0, substeps: 1 } };
    let before = reader.count();
    let values = reader.fields(node, "time", &schema::TIME, None);
    let seconds = values.number("seconds").unwrap_or(0.0);
    let frame = values.number("frame").unwrap_or(1.0);
    let substeps = values.integer("substeps").unwrap_or(1);
    let time = Time { seconds, frame, substeps: u32::try_from(substeps).unwrap_or(1) };
    if reader.count() == before
        && let Some(fault) = validity::time_fault(&time)
    {
        let at = node.get(fault.field).unwrap_or(node);
        reader.report(at.location, SceneError::of(fault.about).path(join("time", fault.field)));
    }
    time
}

fn surroundings<const D: usize>(reader: &mut Reader<'_>, root: &Node) -> Surroundings<D> {
    let values = match root.get("world") {
        Some(node) => reader.fields(node, "world", &schema::WORLD, None),
        None => Values::defaults(schema::WORLD.spec, D),
    };
    Surroundings {
        gravity: values.vector("gravity"),
        drag: values.number("drag").unwrap_or(0.0),
        largest_force: values.number("largest_force"),
        largest_velocity: values.number("largest_velocity"),
        largest_distance: values.number("largest_distance"),
        unfold: values.flag("unfold"),
    }
}

/// `[contact]`.
fn contact<const D: usize>(reader: &mut Reader<'_>, root: &Node, bodies: &Bodies<D>) -> Option<ContactBlueprint> {
    let Some(node) = root.get("contact") else {
        if let Some(Data::Array(bodies)) = root.get("body").map(|bodies| &bodies.data) {
            for (number, body) in bodies.iter().enumerate() {
                let condition = ConditionText::Section { section: "contact" };
                reader.no_effect(body, &format!("body.{number}"), "contact", condition);
            }
        }
        return None;
    };
    let values = reader.fields(node, "contact", &schema::CONTACT, None);
    let (mut pairs, mut lines) = (Vec::new(), BTreeMap::new());
    for (item, path) in reader.list(node, "contact", "pair") {
        let before = reader.count();
        let pair = reader.fields(item, &path, &schema::CONTACT_PAIR, None);
        // The name may mean a body that has an error.
        for field in ["first", "second"].into_iter().filter(|_| bodies.broken.is_empty()) {
            let groups = || bodies.list.iter().map(|body| body.contact_group());
            if let Some(group) = pair.text(field).filter(|group| groups().all(|known| known != *group)) {
                let about = BlueprintFault::NoMember { group: visible(group), known: listed(groups()) };
                let closest = nearest(pair.text(field).unwrap_or(""), groups());
                let error = SceneError::of(about).path(join(&path, field)).nearest(closest);
                reader.report(location_of(item, field), error);
            }
        }
        if reader.count() == before {
            let at = location_of(item, "second");
            let groups = validity::groups_of_pair(&pair).map(String::from);
            match lines.get(&groups) {
                None => drop(lines.insert(groups, reader.line_of(at))),
                Some(line) => {
                    let [first, second] = groups.map(|group| visible(&group));
                    let about = BlueprintFault::SamePair { first, second, line: *line };
                    reader.report(at, SceneError::of(about).path(join(&path, "second")));
                }
            }
        }
        pairs.push(pair);
    }
    Some(ContactBlueprint { values, pairs })
}

/// `[picture]`.
fn picture<const D: usize>(reader: &mut Reader<'_>, root: &Node) -> Pictured<D> {
    let Some(node) = root.get("picture") else { return Pictured::default() };
    let values = reader.fields(node, "picture", &schema::PICTURE, None);
    let given = |name: &str| node.get(name).is_some();
    let sound = ["low", "high"].iter().all(|name| values.get(name).is_some());
    let region = match (given("low"), given("high")) {
        (false, false) => None,
        (true, true) => sound.then(|| [values.vector("low"), values.vector("high")]),
        (low, _) => {
            let (one, other) = if low { ("low", "high") } else { ("high", "low") };
            let error = SceneError::of(ReferenceError::OneCorner { one, other }).path(join("picture", other));
            reader.report(location_of(node, one), error);
            None
        }
    };
    if let Some([low, high]) = region
        && !(0..D).all(|axis| low[axis] < high[axis])
    {
        let (low, high) = (format!("{low:?}"), format!("{high:?}"));
        let error = SceneError::of(ReferenceError::EmptyBox { low, high }).path("picture.high");
        reader.report(location_of(node, "high"), error);
    }
    let angles = ["azimuth", "elevation"];
    if let Some(name) = angles.into_iter().find(|name| D == 2 && given(name)) {
        let error = SceneError::of(ReferenceError::Camera { field: name }).path(join("picture", name));
        reader.report(location_of(node, name), error);
    }
    Pictured {
        panels: values.integer("panels").map(|panels| panels as u32),
        region,
        azimuth: values.number("azimuth"),
        elevation: values.number("elevation"),
    }
}

/// The location of a value, or of the table that lacks it.
pub(crate) fn location_of(node: &Node, key: &str) -> Location {
    node.get(key).map_or(node.location, |n| n.location)
}
