//! The parameter that a `set` command changes while the scene runs: its path is resolved when the scene is read.

use super::body_list::Bodies;
use super::place_of;
use super::reader::{Reader, join, listed};
use crate::catalogue;
use crate::catalogue::Catalogue;
use crate::document::Node;
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Allowed, Field, Spec, Value, Values, nearest};
use opruga_world::blueprint::ColliderBlueprint;
use opruga_world::schema;

/// What paths may name.
pub(crate) struct Known<'a, const D: usize> {
    pub(crate) bodies: &'a Bodies<D>,
    /// Names of bodies that commands add.
    pub(crate) added: &'a [&'a str],
    pub(crate) integrator: Option<&'a Values>,
    pub(crate) colliders: &'a [ColliderBlueprint],
}

/// Why a path leads nowhere.
struct Lost {
    message: String,
    allowed: String,
    nearest: Option<String>,
    /// What does what the path seems to want.
    hint: Option<&'static str>,
}

/// What changes the kind of a part.
const CHANGE: &str = "the command `do = \"change\"` gives a body other models or another integrator";

fn lost<'w>(what: &str, word: &str, words: impl Iterator<Item = &'w str> + Clone) -> Lost {
    Lost {
        message: format!("there is no {what} `{}`", visible(word)),
        allowed: match listed(words.clone()) {
            none if none.is_empty() => "none, there is nothing to change".into(),
            words => words,
        },
        nearest: nearest(word, words),
        hint: None,
    }
}

/// The value, fit for the parameter that the path names; or a report.
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
                let error = SceneError::new("scene.range", format!("`{}` cannot be {value}", visible(parameter)))
                    .path(join(path, "value"));
                reader.report(place_of(node, "value"), error.value(value).allowed(allowed));
                None
            }
        },
        // A parameter of a body that is not there yet: checked when the command acts.
        Ok(None) => Some(value),
        Err(lost) => {
            let error = SceneError::new("scene.unknown_parameter", lost.message)
                .path(join(path, "path"))
                .value(visible(parameter));
            let error = match lost.hint {
                Some(hint) => error.hint(hint),
                None => error.nearest(lost.nearest),
            };
            reader.report(place_of(node, "path"), error.allowed(lost.allowed));
            None
        }
    }
}

/// A list of whole numbers is read as numbers at first.
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
    // Which models and which integrator a body has is no parameter of them.
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
    found.map_err(|lost| Lost { hint: is_kind.then_some(CHANGE), ..lost })
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
        ["time", ..] => Err(lost("parameter that changes in the run", parameter, ["time.substeps"].into_iter())),
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
                    Err(lost("collider", number, numbers.iter().map(String::as_str)))
                }
            }
        }
        ["body", name, "integrator", field] => {
            let Some(body) = body(name, known)? else { return Ok(None) };
            match body.integrator.as_ref().and_then(|v| catalogue::find(&catalogue.integrators, v.kind(), D)) {
                Some(spec) => find(spec, field).map(Some),
                None => Err(Lost {
                    message: format!("body `{}` has no integrator of its own", visible(name)),
                    allowed: "integrator.FIELD".into(),
                    nearest: None,
                    hint: None,
                }),
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
                None => Err(lost("model of this body", kind, kinds)),
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
            let near =
                nearest(parts.first().unwrap_or(&""), HEADS.into_iter()).filter(|n| Some(&n.as_str()) != parts.first());
            Err(Lost {
                message: format!("`{}` is no parameter", visible(parameter)),
                allowed: FORMS.join(", "),
                nearest: near,
                hint: None,
            })
        }
    }
}

/// The body of a name; none where a command is yet to add it.
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
    Err(lost("body", name, names.iter().copied()))
}

fn find(spec: &'static Spec, name: &str) -> Result<&'static Field, Lost> {
    match spec.fields.iter().find(|f| f.name == name) {
        Some(field) => Ok(field),
        None => {
            let lost = lost("parameter", name, spec.fields.iter().map(|f| f.name));
            Err(Lost { message: format!("{} of `{}`", lost.message, spec.kind), ..lost })
        }
    }
}
