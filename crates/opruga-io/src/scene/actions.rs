//! `[[load]]` and `[[command]]`.

use super::body_list::Bodies;
use super::errors::{CommandError, FieldError, Part, Wanted};
use super::lifetimes::Lifetimes;
use super::moments::{Frames, Set};
use super::pins;
use super::reader::{Reader, join};
use super::{location_of, parameters, parts, selectors};
use crate::document::{Data, Node};
use crate::problem::SceneError;
use opruga_core::spec::{Values, nearest};
use opruga_world::blueprint::{Action, ColliderBlueprint, CommandBlueprint, LoadBlueprint, LoadKind, Selector};
use opruga_world::schema::{self, Section};

/// The section that the tag of a table selects, and its plain fields.
fn tagged(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    tag: &'static str,
    what: Part,
    sections: &'static [Section],
) -> Option<Values> {
    let words: Vec<&str> = sections.iter().map(|s| s.spec.kind).collect();
    let word = reader.tag(node, path, tag, what, &words)?;
    let section = sections.iter().find(|s| s.spec.kind == word)?;
    Some(reader.fields(node, path, section, Some(tag)))
}

/// Reads external forces.
pub(crate) fn loads<const D: usize>(reader: &mut Reader<'_>, root: &Node, bodies: &Bodies<D>) -> Vec<LoadBlueprint<D>> {
    let mut loads = Vec::new();
    for (node, path) in reader.list(root, "", "load") {
        let Some(values) = tagged(reader, node, &path, "kind", Part::Load, schema::LOADS) else { continue };
        let targets = bodies.targets(reader, node, &path);
        let Some(targets) = selectors::of_bodies(reader, node, &path, bodies, targets) else { continue };
        let kind = match values.kind() {
            "force" => LoadKind::Force(values.vector("value")),
            "traction" => LoadKind::Traction(values.vector("value")),
            "central_force" => {
                LoadKind::Central { value: values.number("value").unwrap_or(0.0), center: values.vector("center") }
            }
            "body_force" => LoadKind::BodyForce(values.vector("value")),
            _ => LoadKind::Pressure(values.number("value").unwrap_or(0.0)),
        };
        let there = match kind {
            LoadKind::Force(_) | LoadKind::Central { .. } => true,
            LoadKind::BodyForce(_) => parts::hold_cells(reader, node, &path, bodies, &targets),
            LoadKind::Traction(_) | LoadKind::Pressure(_) => parts::hold_sides(reader, node, &path, bodies, &targets),
        };
        if !there {
            continue;
        }
        let curve = values.rows("curve").to_vec();
        loads.extend(targets.into_iter().map(|(body, select)| LoadBlueprint {
            body,
            select,
            kind,
            curve: curve.clone(),
        }));
    }
    loads
}

/// Reads the commands, in the order of time.
pub(crate) fn commands<const D: usize>(
    reader: &mut Reader<'_>,
    list: &[(&Node, String)],
    bodies: &Bodies<D>,
    integrator: Option<&Values>,
    colliders: &[ColliderBlueprint],
    frames: Option<&Frames>,
) -> Vec<CommandBlueprint<D>> {
    // Bodies that are added later may also be removed or changed.
    let added: Vec<&str> = list.iter().filter_map(|(node, _)| node.get("body")?.get("name")?.text()).collect();
    let known = parameters::Known { bodies, added: &added, integrator, colliders };
    let (mut commands, mut sets, mut lifetimes) = (Vec::new(), Vec::new(), Lifetimes::default());
    for (number, (node, path)) in list.iter().enumerate() {
        let before = reader.count();
        let Some(values) = tagged(reader, node, path, "do", Part::Command, schema::COMMANDS) else { continue };
        let at = values.number("at").unwrap_or(0.0);
        let Some(actions) = actions(reader, number, node, path, &values, &known) else { continue };
        let end_of_path = values.rows("path").last().and_then(|row| row.first().copied());
        let until = values.number("until").or(end_of_path).unwrap_or(at);
        let lasts = actions.iter().any(Action::lasts);
        if values.kind() == "drag" && node.get("until").is_none() && values.rows("path").len() == 1 {
            let error = SceneError::of(CommandError::NoEnd { at }).path(join(path, "until"));
            reader.report(node.location, error);
        } else if until < at || until == at && lasts && reader.sound_since(before, path) {
            let key = if node.get("until").is_some() { "until" } else { "path" };
            let about = match (until < at, lasts) {
                (true, false) => CommandError::EndsBefore { until, at },
                (true, true) => CommandError::LastsNegative { until, at },
                (false, _) => CommandError::EndsAtOnce { until, at },
            };
            reader.report(location_of(node, key), SceneError::of(about).path(join(path, key)));
        }
        if let Some(frames) = frames
            && reader.sound_since(before, path)
            && frames.command(reader, node, path, at, lasts.then_some(until))
            && let [Action::Set { path: parameter, .. }] = actions.as_slice()
        {
            sets.push(Set { at, parameter: parameter.clone(), location: location_of(node, "at"), path: path.clone() });
        }
        if reader.sound_since(before, &join(path, "at")) {
            lifetimes.add(at, (*node, path), &actions, bodies.later.get(&number).map(|(k, _)| *k), bodies);
        }
        commands.extend(actions.into_iter().map(|action| CommandBlueprint { at, until, action }));
    }
    lifetimes.report(reader, bodies);
    if let Some(frames) = frames {
        frames.sets(reader, sets);
    }
    commands.sort_by(|a, b| a.at.total_cmp(&b.at));
    commands
}

/// The actions of a command: one, or one for each copy of its body.
fn actions<const D: usize>(
    reader: &mut Reader<'_>,
    number: usize,
    node: &Node,
    path: &str,
    values: &Values,
    known: &parameters::Known<'_, D>,
) -> Option<Vec<Action<D>>> {
    let bodies = known.bodies;
    Some(match values.kind() {
        "drag" => {
            let body = bodies.reference(reader, node, path);
            let (grabbed, facet) = grabbed_node(reader, node, path)?;
            let body = body?;
            if let (Some(k), Some(blueprint)) = (grabbed, bodies.list.get(body)) {
                let only = Selector::Nodes(vec![k]);
                selectors::check(reader, location_of(node, "node"), &join(path, "node"), &only, blueprint)
                    .then_some(())?;
            }
            vec![Action::Drag {
                body,
                node: grabbed,
                facet,
                stiffness: values.number("stiffness"),
                path: values.rows("path").to_vec(),
                largest_force: values.number("largest_force"),
            }]
        }
        "push" => {
            let targets = bodies.targets(reader, node, path);
            let targets = selectors::of_bodies(reader, node, path, bodies, targets)?;
            let force = values.vector("force");
            targets.into_iter().map(|(body, select)| Action::Push { body, select, force }).collect()
        }
        "pin" => {
            let targets = bodies.targets(reader, node, path);
            let axes = pins::axes(reader, node, path, values);
            let targets = selectors::of_bodies(reader, node, path, bodies, targets)?;
            targets.into_iter().map(|(body, select)| Action::Pin { body, select, axes }).collect()
        }
        "free" => {
            let targets = bodies.targets(reader, node, path);
            let targets = selectors::of_bodies(reader, node, path, bodies, targets)?;
            targets.into_iter().map(|(body, select)| Action::Free { body, select }).collect()
        }
        "set" => {
            let value_node = node.get("value")?;
            let value = reader.any_value(value_node, &join(path, "value"))?;
            let parameter = values.text("path")?.to_string();
            let value = parameters::check(reader, node, path, &parameter, value, known)?;
            vec![Action::Set { path: parameter, value }]
        }
        "change" => {
            let targets = bodies.targets(reader, node, path);
            let kinds = reader.catalogue.models.clone();
            let before = reader.count();
            let models = node.get("models").map(|_| {
                let list = reader.list(node, path, "models");
                list.into_iter()
                    .filter_map(|(item, here)| reader.kind_table(item, &here, Part::Model, &kinds))
                    .collect()
            });
            let integrator = reader.integrator(node, path);
            if reader.count() == before && models.is_none() && integrator.is_none() {
                reader.report(node.location, SceneError::of(CommandError::ChangesNothing {}).path(path));
            }
            let change = |body| Action::Change { body, models: models.clone(), integrator: integrator.clone() };
            targets?.into_iter().map(|(body, _)| change(body)).collect()
        }
        "add" => {
            let (body, _) = bodies.later.get(&number)?;
            vec![Action::Add(Box::new(bodies.list.get(*body)?.clone()))]
        }
        _ => {
            let name = values.text("body")?;
            // Copies are handled one by one, because no body has their common name.
            if !bodies.names.contains_key(name) && !known.added.contains(&name) {
                bodies.unknown(reader, location_of(node, "body"), join(path, "body"), name, known.added);
                return None;
            }
            vec![Action::Remove { name: name.to_string() }]
        }
    })
}

/// What a drag grabs: the number of a node, or none for the nearest one; and whether it grabs a point of a facet instead of a
/// node.
fn grabbed_node(reader: &mut Reader<'_>, node: &Node, path: &str) -> Option<(Option<u32>, bool)> {
    const WORDS: [&str; 2] = ["nearest", "nearest_facet"];
    let Some(value) = node.get("node") else { return Some((None, false)) };
    let here = join(path, "node");
    match &value.data {
        Data::Text(word) if word == "nearest" => Some((None, false)),
        Data::Text(word) if word == "nearest_facet" => Some((None, true)),
        Data::Text(word) => {
            let about = FieldError::Word { field: "node".into(), value: value.shown() };
            let closest = nearest(word, WORDS.into_iter());
            reader.report(value.location, SceneError::of(about).path(here).allows(Wanted::Node).nearest(closest));
            None
        }
        Data::Integer(..) => Some((Some(reader.natural(value, &here)?), false)),
        _ => {
            reader.wrong_type(value, &here, Wanted::Node);
            None
        }
    }
}
