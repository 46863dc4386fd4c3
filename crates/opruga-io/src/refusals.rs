//! Converts errors of a world to errors of the scene, with the location of the part that they are about.

use crate::document::{self, Data, Entry, Location, Node};
use crate::overrides;
use crate::problem::{Around, SceneError};
use crate::source::Source;
use opruga_core::error::BuildError;
use opruga_math::message::AnyMessage;
use opruga_math::messages;
use opruga_math::words::number;
use opruga_world::error::Part;
use opruga_world::schema::{self, MOST_SUBSTEPS};
use opruga_world::{RefusedCommand, Warning, WorldError};

messages! {
    /// What helps if a scene is refused, in addition to the hints of the world.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum RefusalHint {
        "part.refusal_hint" #[error("use substeps >= {substeps}, such as --set time.substeps={substeps}, or another integrator")]
        Substeps { substeps: u32 },
        "part.refusal_hint" #[error("use another `value`: a frame has at most {most} substeps")]
        OtherValue { most: u32 },
        "part.refusal_hint" #[error("use a `value` of {substeps} or more, or another integrator")]
        LargerValue { substeps: u32 },
        "part.refusal_hint" #[error("use another `value`, or an earlier command that sets substeps >= {substeps}")]
        ValueOrEarlierCommand { substeps: u32 },
        "part.refusal_hint" #[error("use another `value`, or substeps >= {substeps} when the command begins, such as --set time.substeps={substeps}")]
        ValueOrSubsteps { substeps: u32 },
        "part.refusal_hint" #[error("use a softer or heavier body, or an earlier command that sets substeps >= {substeps}")]
        BodyOrEarlierCommand { substeps: u32 },
        "part.refusal_hint" #[error("use a softer or heavier body, or substeps >= {substeps} when the command begins, such as --set time.substeps={substeps}")]
        BodyOrSubsteps { substeps: u32 },
    }

    /// The reason why a command of a scene was refused.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CommandRefusal {
        "part.command" #[error("the command `{word}`: {about}")]
        #[allowed("{}", about.allowed().unwrap_or_default())] #[hint("{}", about.hint().unwrap_or_default())]
        Command { word: &'static str, about: AnyMessage },
    }
}

/// All messages of this file.
pub(crate) const MESSAGES: &[&[opruga_math::message::Variant]] = &[RefusalHint::VARIANTS, CommandRefusal::VARIANTS];

impl From<&WorldError> for SceneError {
    /// Converts the error to the terms of a scene: what is wrong, what is allowed, and what would help. The location is given by the path;
    /// [`in_scene`] finds its line.
    fn from(error: &WorldError) -> SceneError {
        let scene_error = SceneError { code: error.code(), ..SceneError::of(error.clone()) }.path(path_of(error));
        match error {
            WorldError::UnstableStep { h, substeps, .. } => {
                let scene_error = scene_error.value(number(*h));
                match *substeps {
                    ..=MOST_SUBSTEPS => scene_error.advice(RefusalHint::Substeps { substeps: *substeps }),
                    _ => scene_error,
                }
            }
            WorldError::Diverged { time, .. } => scene_error.value(time.to_string()),
            WorldError::Build { source, .. } => match source.about.value() {
                Some(value) => scene_error.value(value),
                None => scene_error,
            },
            _ => scene_error,
        }
    }
}

/// Whether an error about a body is about one of the body's own fields rather than about a model.
fn is_field_of_body(kind: &str) -> bool {
    let plain = schema::BODY.spec.fields.iter().map(|field| field.name);
    plain.chain(schema::BODY.children.iter().map(|child| child.name)).any(|name| name == kind && name != "models")
}

/// The path of the part of the scene that an error is about.
fn path_of(error: &WorldError) -> String {
    let body = |name: &str| format!("body.{}", name.split('[').next().unwrap_or(name));
    match error {
        WorldError::Build { part, source } => {
            let around = match part {
                Part::Body { name } => match source.kind.as_str() {
                    _ if source.code() == "contact.unfold" => return "world.unfold".into(),
                    // The body uses the integrator of the scene.
                    "contact" if source.code() == "contact.implicit" => return "integrator".into(),
                    // Fields such as the position, the pins and the integrator belong to the body, not to a model.
                    kind if is_field_of_body(kind) => {
                        return format!("{}.{}", body(name), valued(source).unwrap_or(kind.into()));
                    }
                    "stability" | "modes" | "memory" | "mass" => body(name),
                    _ if source.code().starts_with("static.") => body(name),
                    kind => format!("{}.models.{kind}", body(name)),
                },
                Part::IntegratorOf { name } => format!("{}.integrator", body(name)),
                Part::BodyAt { index } => format!("body.{index}"),
                Part::Load { index } => format!("load.{index}"),
                Part::Command { index } => format!("command.{index}"),
                Part::Probe { name } => format!("probe.{name}"),
                Part::Pair { index } => format!("contact.pair.{index}"),
                Part::Section { path } => (*path).into(),
                Part::Collider { index } => format!("collider.{index}"),
            };
            valued(source).map_or(around.clone(), |parameter| format!("{around}.{parameter}"))
        }
        WorldError::UnstableStep { .. } => "time.substeps".into(),
        WorldError::Step { body: name, .. }
        | WorldError::Diverged { body: name, .. }
        | WorldError::NotConverged { body: name, .. }
        | WorldError::Meet { first: name, .. }
        | WorldError::LedThrough { first: name, .. } => body(name),
        WorldError::LedThroughObstacle { collider, .. } => format!("collider.{collider}"),
        WorldError::Path { path, .. } => path.clone(),
        WorldError::Cross { .. } => "contact.response".into(),
        WorldError::Snapshot { .. }
        | WorldError::Overflow { .. }
        | WorldError::TooManyContacts { .. }
        | WorldError::BrokenOff {} => String::new(),
    }
}

/// The parameter whose value is refused.
fn valued(error: &BuildError) -> Option<String> {
    error.about.value().and_then(|_| error.about.parameters().into_iter().next())
}

/// Converts a warning of a world to an error, for callers that want no warnings.
impl From<&Warning> for SceneError {
    fn from(warning: &Warning) -> SceneError {
        const CODES: [&str; 6] = [
            "units.sag",
            "step.no_stable_step",
            "step.unstable",
            "contact.starts_inside",
            "contact.starts_across",
            "contact.starts_overlapping",
        ];
        let code = CODES.into_iter().find(|code| *code == warning.code).unwrap_or("world.warning");
        let path = warning
            .field("body")
            .map_or_else(String::new, |body| format!("body.{}", body.split('[').next().unwrap_or_default()));
        let error = SceneError { about: warning.about.clone(), ..SceneError::new(code, warning.message.clone()) };
        error.path(path).advice(Around::NotStrict {})
    }
}

/// Adds to an error the file and the line of the error's path: the line of the parameter that the error is about or, if the path itself is not
/// written, the line of the nearest enclosing part. If an override set the parameter, the override is named instead.
#[must_use]
pub fn in_scene(error: SceneError, text: &str, file: &str, overrides: &[(String, String)]) -> SceneError {
    let source = Source { file, text: text.strip_prefix('\u{feff}').unwrap_or(text) };
    let error = SceneError { file: file.to_string(), ..error };
    if error.path.is_empty() {
        return error;
    }
    let Some(mut root) = document::parse(&source).0 else { return error };
    // An override that cannot be applied was an error before the world was built.
    let _ = overrides::apply_all(&mut root, overrides);
    // The length of the step depends on all fields of `time`.
    let of_time = |(path, _): &(String, String)| error.code == "step.unstable" && path.starts_with("time.");
    if let Some((path, value)) = overrides.iter().rfind(|set| of_time(set)) {
        return SceneError { file: overrides::named(path, value), ..error };
    }
    if error.code == "model.cell_value"
        && let Some(mesh) = mesh_file(&root, &error.path)
    {
        // The field of the scene is right; a number of the mesh is wrong.
        return SceneError { file: mesh.into(), ..error };
    }
    let parameters = error.about.as_ref().map_or_else(Vec::new, |about| about.parameters());
    match location(&root, &error.path, &parameters) {
        Some(Location::Bytes(start, end)) => source.mark(error, start, end),
        Some(Location::Override(number)) => match overrides.get(number) {
            Some((path, value)) => SceneError { file: overrides::named(path, value), ..error },
            None => error,
        },
        None => error,
    }
}

/// Converts the error of a command of a scene that was refused during the run: adds the location of the command and a hint for that command.
#[must_use]
pub fn of_command(
    error: &WorldError,
    command: &RefusedCommand<'_>,
    (text, file): (&str, &str),
    overrides: &[(String, String)],
) -> SceneError {
    let scene_error = SceneError::from(error);
    let about = scene_error.about.clone().map(|about| CommandRefusal::Command { word: command.word, about }.into());
    let message = about.as_ref().map_or_else(|| scene_error.message.clone(), AnyMessage::to_string);
    let mut scene_error = SceneError { about, message, file: file.to_string(), path: "command".into(), ..scene_error };
    let sets = command.sets.is_some();
    if let WorldError::UnstableStep { substeps, .. } = error {
        // An override remains in effect until a command sets the same parameter.
        let (substeps, earlier) = (*substeps, command.substeps_were_set);
        let hint = match substeps {
            ..=MOST_SUBSTEPS => Some(match (sets, earlier) {
                (true, _) if command.sets_substeps() => RefusalHint::LargerValue { substeps },
                (true, true) => RefusalHint::ValueOrEarlierCommand { substeps },
                (true, false) => RefusalHint::ValueOrSubsteps { substeps },
                (false, true) => RefusalHint::BodyOrEarlierCommand { substeps },
                (false, false) => RefusalHint::BodyOrSubsteps { substeps },
            }),
            _ => sets.then_some(RefusalHint::OtherValue { most: MOST_SUBSTEPS }),
        };
        scene_error = hint.map_or(scene_error.clone(), |hint| scene_error.advice(hint));
    }
    let source = Source { file, text: text.strip_prefix('\u{feff}').unwrap_or(text) };
    let Some(mut root) = document::parse(&source).0 else { return scene_error };
    let _ = overrides::apply_all(&mut root, overrides);
    let Some((number, node)) = written(&root, command) else { return scene_error };
    let key = if sets { "value" } else { "do" };
    scene_error.path = format!("command.{number}.{key}");
    match node.get(key).map_or(node.location, |value| value.location) {
        Location::Bytes(start, end) => source.mark(scene_error, start, end),
        Location::Override(number) => match overrides.get(number) {
            Some((path, value)) => SceneError { file: overrides::named(path, value), ..scene_error },
            None => scene_error,
        },
    }
}

/// The table in a scene that describes a command, and the index of this table; none if the command came from a program.
fn written<'n>(root: &'n Node, command: &RefusedCommand<'_>) -> Option<(usize, &'n Node)> {
    let Data::Array(tables) = &root.get("command")?.data else { return None };
    let begins = |node: &Node| match node.data {
        Data::Number(at, _) => at == command.at,
        Data::Integer(Some(at), _) => at as f64 == command.at,
        _ => false,
    };
    tables.iter().enumerate().find(|(_, table)| {
        let text = |key: &str| table.get(key).and_then(Node::text);
        let added = table.get("body").and_then(|body| body.get("name")).and_then(Node::text);
        let named = |name| text("body").or(added) == Some(name);
        let alike = command.sets.is_none_or(|path| text("path") == Some(path)) && command.body.is_none_or(named);
        alike && text("do") == Some(command.word) && table.get("at").is_some_and(begins)
    })
}

/// The mesh file of the body that a path belongs to.
fn mesh_file<'n>(root: &'n Node, path: &str) -> Option<&'n str> {
    let name = path.split('.').nth(1)?;
    let Data::Array(bodies) = &root.get("body")?.data else { return None };
    let body = bodies.iter().find(|body| body.get("name").and_then(Node::text) == Some(name))?;
    body.get("shape")?.get("file")?.text()
}

/// The location of the last part of a path that occurs in the scene, or of a parameter in that part; none if no part occurs.
fn location(root: &Node, path: &str, parameters: &[String]) -> Option<Location> {
    let (mut node, mut location) = (root, None);
    for part in path.split('.') {
        let next = match &node.data {
            Data::Table(_) => node.entry(part).map(|entry| (&entry.value, shown_at(entry))),
            Data::Array(items) => {
                let named = |n: &&Node| ["name", "kind"].iter().any(|k| n.get(k).and_then(Node::text) == Some(part));
                let found = part.parse::<usize>().ok().and_then(|k| items.get(k)).or_else(|| items.iter().find(named));
                found.map(|n| (n, n.location))
            }
            _ => None,
        };
        let Some((next, at)) = next else { break };
        (node, location) = (next, Some(at));
    }
    let within = |node: &Node| parameters.iter().find_map(|parameter| node.entry(parameter)).map(shown_at);
    // A part that does not set the parameter takes its value from the section with the same name.
    let section = || root.get(path.rsplit('.').next()?).and_then(within);
    let named = within(node).or_else(section);
    // A part in which an override has changed something gets the location of the override.
    let changed =
        || node.entries().iter().map(|entry| entry.value.location).rfind(|at| matches!(at, Location::Override(_)));
    named.or_else(changed).or(location)
}

/// A table or a list is located at its key, any other value at the value itself.
fn shown_at(entry: &Entry) -> Location {
    match entry.value.data {
        Data::Table(_) | Data::Array(_) => entry.location,
        _ => entry.value.location,
    }
}
