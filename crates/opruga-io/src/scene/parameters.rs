//! The parameter that a `set` command changes while the scene runs. The path of the parameter is resolved when the scene is read.

use super::body_list::Bodies;
use super::errors::{CommandError, SceneAllowed, SceneHint};
use super::location_of;
use super::reader::{Reader, join, listed};
use crate::catalogue;
use crate::catalogue::Catalogue;
use crate::document::Node;
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, Field, Spec, Value, Values, nearest};
use opruga_world::blueprint::ColliderBlueprint;
use opruga_world::schema;

/// What the path of a parameter may name.
pub(crate) struct Known<'a, const D: usize> {
    pub(crate) bodies: &'a Bodies<D>,
    /// Names of bodies that commands add.
    pub(crate) added: &'a [&'a str],
    pub(crate) integrator: Option<&'a Values>,
    pub(crate) colliders: &'a [ColliderBlueprint],
}

/// Why a path does not name a parameter.
struct Lost {
    about: CommandError,
    /// The words that would be allowed; none if the message lists them.
    allowed: Option<String>,
    nearest: Option<String>,
    /// Whether the path names the kind of a part, which a command cannot change.
    is_kind: bool,
}

fn lost<'w>(about: CommandError, word: &str, words: impl Iterator<Item = &'w str> + Clone) -> Lost {
    Lost { about, allowed: Some(listed(words.clone())), nearest: nearest(word, words), is_kind: false }
}

/// Returns the value, converted for the parameter that the path names, or reports an error.
pub(crate) fn check<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    parameter: &str,
    value: Value,
    known: &Known<'_, D>,
) -> Option<Value> {
    match field(reader, parameter, known) {
        Ok(Some(field)) => match field.range.accept(suited(value, &field.range), D) {
            Ok(value) => Some(value),
            Err((value, allowed)) => {
                let error = SceneError::of(CommandError::CannotBe { parameter: visible(parameter), value });
                reader.report(location_of(node, "value"), error.path(join(path, "value")).allows(allowed));
                None
            }
        },
        // A parameter of a body that does not exist yet is checked when the command acts.
        Ok(None) => Some(value),
        Err(lost) => {
            let error = SceneError::of(lost.about).path(join(path, "path")).value(visible(parameter));
            let error = match lost.is_kind {
                true => error.advice(SceneHint::Change {}),
                false => error.nearest(lost.nearest),
            };
            let error = match lost.allowed {
                Some(none) if none.is_empty() => error.allows(SceneAllowed::NothingToChange {}),
                Some(words) => error.allowed(words),
                None => error,
            };
            reader.report(location_of(node, "path"), error);
            None
        }
    }
}

/// Converts a list to whole numbers if the parameter needs them. A list is at first read as a list of real numbers.
fn suited(value: Value, range: &Allowed) -> Value {
    match (range, &value) {
        (Allowed::Integers, Value::Numbers(x))
            if x.iter().all(|x| x.fract() == 0.0 && *x >= 0.0 && *x <= f64::from(u32::MAX)) =>
        {
            Value::Integers(x.iter().map(|x| *x as u32).collect())
        }
        _ => value,
    }
}

fn field<const D: usize>(
    reader: &Reader<'_>,
    parameter: &str,
    known: &Known<'_, D>,
) -> Result<Option<&'static Field>, Lost> {
    let parts: Vec<&str> = parameter.split('.').collect();
    let catalogue = reader.catalogue;
    let found = resolve(&parts, parameter, catalogue, known);
    // The kinds of the models and of the integrator of a body are not parameters.
    let is_kind = matches!(
        parts.as_slice(),
        ["integrator"]
            | ["integrator", "kind"]
            | ["body", _, "integrator"]
            | ["body", _, "integrator", "kind"]
            | ["body", _, "models"]
            | ["body", _, "models", _]
            | ["body", _, "models", _, "kind"]
    );
    found.map_err(|lost| Lost { is_kind, ..lost })
}

fn resolve<const D: usize>(
    parts: &[&str],
    parameter: &str,
    catalogue: &Catalogue,
    known: &Known<'_, D>,
) -> Result<Option<&'static Field>, Lost> {
    match parts {
        ["world", name] => find(schema::WORLD.spec, name).map(Some),
        ["contact", name] => find(schema::CONTACT.spec, name).map(Some),
        ["time", "substeps"] => find(schema::TIME.spec, "substeps").map(Some),
        ["time", ..] => {
            let about = CommandError::NotInRun { parameter: visible(parameter) };
            Err(lost(about, parameter, ["time.substeps"].into_iter()))
        }
        ["integrator", name] => {
            match known.integrator.and_then(|v| catalogue::find(&catalogue.integrators, v.kind(), D)) {
                Some(spec) => find(spec, name).map(Some),
                None => Ok(None),
            }
        }
        ["collider", number, name] => {
            let collider = number.parse::<usize>().ok().and_then(|k| known.colliders.get(k));
            match collider.and_then(|c| catalogue::find(&catalogue.colliders, c.values.kind(), D)) {
                Some(spec) => find(spec, name).map(Some),
                None => {
                    let numbers: Vec<String> = (0..known.colliders.len().min(20)).map(|k| k.to_string()).collect();
                    let about = CommandError::NoCollider { collider: visible(number) };
                    Err(lost(about, number, numbers.iter().map(String::as_str)))
                }
            }
        }
        ["body", name, "integrator", field] => {
            let Some(body) = body(name, known)? else { return Ok(None) };
            match body.integrator.as_ref().and_then(|v| catalogue::find(&catalogue.integrators, v.kind(), D)) {
                Some(spec) => find(spec, field).map(Some),
                None => {
                    let about = CommandError::NoIntegrator { body: visible(name) };
                    Err(Lost { about, allowed: None, nearest: None, is_kind: false })
                }
            }
        }
        ["body", name, "models", kind, field] => {
            let Some(body) = body(name, known)? else { return Ok(None) };
            let kinds = body.models.iter().map(Values::kind);
            let model = kind
                .parse::<usize>()
                .ok()
                .and_then(|k| body.models.get(k))
                .map(Values::kind)
                .or_else(|| kinds.clone().find(|k| k == kind));
            match model.and_then(|k| catalogue::find(&catalogue.models, k, D)) {
                Some(spec) => find(spec, field).map(Some),
                None => Err(lost(CommandError::NoModel { model: visible(kind) }, kind, kinds)),
            }
        }
        _ => {
            const FORMS: [&str; 7] = [
                "world.FIELD",
                "contact.FIELD",
                "time.substeps",
                "integrator.FIELD",
                "collider.NUMBER.FIELD",
                "body.NAME.models.KIND.FIELD",
                "body.NAME.integrator.FIELD",
            ];
            const HEADS: [&str; 6] = ["world", "contact", "time", "integrator", "collider", "body"];
            let closest =
                nearest(parts.first().unwrap_or(&""), HEADS.into_iter()).filter(|n| Some(&n.as_str()) != parts.first());
            let about = CommandError::NotAParameter { parameter: visible(parameter) };
            Err(Lost { about, allowed: Some(FORMS.join(", ")), nearest: closest, is_kind: false })
        }
    }
}

/// The body with a name; none if a command adds it later.
fn body<'a, const D: usize>(
    name: &str,
    known: &'a Known<'_, D>,
) -> Result<Option<&'a opruga_world::blueprint::BodyBlueprint<D>>, Lost> {
    if let Some(body) = known.bodies.first(name) {
        return Ok(Some(body));
    }
    if known.added.contains(&name) {
        return Ok(None);
    }
    let names = known.bodies.list.iter().take(20).map(|b| b.name.as_str()).chain(known.added.iter().copied());
    let names: Vec<&str> = names.collect();
    Err(lost(CommandError::NoBodyOfPath { body: visible(name) }, name, names.iter().copied()))
}

fn find(spec: &'static Spec, name: &str) -> Result<&'static Field, Lost> {
    match spec.fields.iter().find(|f| f.name == name) {
        Some(field) => Ok(field),
        None => {
            let about = CommandError::NoParameter { parameter: visible(name), kind: spec.kind };
            Err(lost(about, name, spec.fields.iter().map(|f| f.name)))
        }
    }
}
