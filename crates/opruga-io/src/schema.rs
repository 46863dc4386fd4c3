//! The JSON Schema of scenes, for editors: made from the descriptions that the reader uses.

use crate::catalogue::{self, Catalogue};
use opruga_core::spec::{Allowed, Bound, Default, Field, Spec};
use opruga_world::schema::{Child, FORMAT, Holds, SCENE, Section};
use opruga_world::shapes;
use serde_json::{Map, Value, json};

/// The JSON Schema (draft 2020-12) of a scene.
pub fn json_schema(catalogue: &Catalogue) -> Value {
    let mut schema = section(&SCENE, None, catalogue);
    schema["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    schema["title"] = "Opruga scene".into();
    schema["properties"]["format"] = json!({ "const": FORMAT, "description": "The version of the format." });
    schema["$defs"] = json!({ "selector": selector() });
    schema
}

/// A table.
fn section(section: &Section, tag: Option<&str>, catalogue: &Catalogue) -> Value {
    let mut properties = Map::new();
    let mut required: Vec<&str> = Vec::new();
    if let Some(tag) = tag {
        properties.insert(tag.into(), json!({ "const": section.spec.kind }));
        required.push(tag);
    }
    for field in section.spec.fields {
        properties.insert(field.name.into(), plain(field));
        if field.default == Default::Required {
            required.push(field.name);
        }
    }
    for child in section.children {
        properties.insert(child.name.into(), structured(child, catalogue));
        if child.required {
            required.push(child.name);
        }
    }
    let mut schema = json!({
        "type": "object",
        "description": describe(section.spec),
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    let one =
        |set: &[&str]| json!({ "oneOf": set.iter().map(|name| json!({ "required": [name] })).collect::<Vec<_>>() });
    let choices: Vec<Value> = section.spec.choices().map(one).collect();
    if !choices.is_empty() {
        schema["allOf"] = choices.into();
    }
    schema
}

fn describe(spec: &Spec) -> String {
    if spec.documentation.is_empty() {
        spec.summary.to_string()
    } else {
        format!("{}\n\n{}", spec.summary, spec.documentation)
    }
}

/// Tables, one of which is selected by `kind`. Each kind occurs only once, because a table that matches two entries of `oneOf` is invalid. If a field
/// differs between the dimensions, the values of both are allowed.
fn kinds(specs: &[&'static Spec], catalogue: &Catalogue) -> Value {
    let table = |kind: Vec<&'static Spec>| {
        let mut schema = section(&Section { spec: kind[0], children: &[] }, Some("kind"), catalogue);
        let fields = catalogue::fields(&kind);
        for name in fields.iter().map(|(field, _)| field.name) {
            let same: Vec<_> = fields.iter().filter(|(field, _)| field.name == name).collect();
            if let [(field, _)] = same[..] {
                schema["properties"][name] = plain(field);
                continue;
            }
            let choices: Vec<Value> = same
                .iter()
                .map(|(field, of)| {
                    let mut choice = plain(field);
                    let dimensions: Vec<String> =
                        catalogue::dimensions(of).iter().map(|dimension| format!("{dimension}D")).collect();
                    let text = choice["description"].as_str().unwrap_or_default();
                    choice["description"] = format!("In {}: {text}", dimensions.join(" and ")).into();
                    choice
                })
                .collect();
            schema["properties"][name] = json!({ "anyOf": choices });
        }
        schema
    };
    let tables: Vec<Value> = catalogue::by_kind(specs).into_iter().map(table).collect();
    json!({ "oneOf": tables })
}

fn structured(child: &Child, catalogue: &Catalogue) -> Value {
    let list = |items: Value| json!({ "type": "array", "items": items });
    let mut schema = match child.holds {
        Holds::Table(inner) => section(inner, None, catalogue),
        Holds::List(inner) => list(section(inner, None, catalogue)),
        Holds::Tagged { tag, sections } => {
            let tables: Vec<Value> = sections.iter().map(|s| section(s, Some(tag), catalogue)).collect();
            list(json!({ "oneOf": tables }))
        }
        Holds::Shape => kinds(&shapes::all(), catalogue),
        Holds::Integrator => {
            let words: Vec<&str> = catalogue.integrators.iter().map(|spec| spec.kind).collect();
            json!({ "oneOf": [{ "enum": words }, kinds(&catalogue.integrators, catalogue)] })
        }
        Holds::Models => list(kinds(&catalogue.models, catalogue)),
        Holds::Colliders => list(kinds(&catalogue.colliders, catalogue)),
        Holds::Selector => json!({ "$ref": "#/$defs/selector" }),
        Holds::VectorOr(inner) => {
            json!({ "oneOf": [allowed(&Allowed::Vector), section(inner, None, catalogue)] })
        }
        Holds::Turn => {
            json!({ "oneOf": [{ "type": "number" }, { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 }] })
        }
        Holds::BodyReference => json!({ "oneOf": [{ "type": "string" }, { "type": "integer", "minimum": 0 }] }),
        Holds::Node => {
            json!({ "oneOf": [{ "type": "integer", "minimum": 0 }, { "enum": ["nearest", "nearest_facet"] }] })
        }
        Holds::Words(words) => {
            json!({ "type": "array", "items": { "enum": words }, "minItems": 1, "uniqueItems": true })
        }
        Holds::Counts => {
            json!({ "type": "array", "items": { "type": "integer", "minimum": 1 }, "minItems": 1, "maxItems": 3 })
        }
        Holds::AnyValue => json!({}),
    };
    schema["description"] = child.documentation.into();
    schema
}

fn plain(field: &Field) -> Value {
    let mut schema = allowed(&field.range);
    let unit = if field.unit.is_empty() { String::new() } else { format!(" [{}]", field.unit) };
    schema["description"] = format!("{}{unit}", field.full_documentation()).into();
    match field.default {
        Default::Number(x) => schema["default"] = x.into(),
        Default::Integer(x) => schema["default"] = x.into(),
        Default::Boolean(x) => schema["default"] = x.into(),
        Default::Text(x) => schema["default"] = x.into(),
        Default::Required | Default::Absent | Default::OneOf(_) | Default::Origin => {}
    }
    schema
}

fn allowed(range: &Allowed) -> Value {
    let numbers = |least: usize, most: usize| json!({ "type": "array", "items": { "type": "number" }, "minItems": least, "maxItems": most });
    match range {
        Allowed::Number { least, greatest } => {
            let mut schema = json!({ "type": "number" });
            match least {
                Bound::None => {}
                Bound::Closed(x) => schema["minimum"] = (*x).into(),
                Bound::Open(x) => schema["exclusiveMinimum"] = (*x).into(),
            }
            match greatest {
                Bound::None => {}
                Bound::Closed(x) => schema["maximum"] = (*x).into(),
                Bound::Open(x) => schema["exclusiveMaximum"] = (*x).into(),
            }
            schema
        }
        Allowed::Integer { least, greatest } => json!({ "type": "integer", "minimum": least, "maximum": greatest }),
        Allowed::Boolean => json!({ "type": "boolean" }),
        Allowed::Text => json!({ "type": "string", "maxLength": 256 }),
        Allowed::Choice(words) => json!({ "enum": words }),
        Allowed::Vector | Allowed::Direction => numbers(2, 3),
        Allowed::Numbers => json!({ "type": "array", "items": { "type": "number" } }),
        Allowed::Integers => json!({ "type": "array", "items": { "type": "integer", "minimum": 0 } }),
        Allowed::Points => json!({ "type": "array", "items": numbers(2, 3), "minItems": 1 }),
        Allowed::Curve | Allowed::CurveNotNegative => json!({ "type": "array", "items": numbers(2, 2), "minItems": 1 }),
        Allowed::Path => json!({ "type": "array", "items": numbers(3, 4), "minItems": 1 }),
    }
}

/// A set of nodes: a table with exactly one of these keys.
fn selector() -> Value {
    let vector = json!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 });
    let sets = json!({ "type": "array", "items": { "$ref": "#/$defs/selector" } });
    let table = |a: &str, va: Value, b: &str, vb: Value| json!({ "type": "object", "properties": { a: va, b: vb }, "required": [a, b], "additionalProperties": false });
    json!({
        "type": "object",
        "description": "A set of nodes of a body.",
        "minProperties": 1,
        "maxProperties": 1,
        "additionalProperties": false,
        "properties": {
            "box": { "type": "array", "items": vector, "minItems": 2, "maxItems": 2 },
            "ball": table("center", vector.clone(), "radius", json!({ "type": "number", "minimum": 0 })),
            "half_space": table("point", vector.clone(), "normal", vector),
            "side": { "enum": ["left", "right", "bottom", "top", "back", "front"] },
            "node": { "type": "integer", "minimum": 0 },
            "nodes": { "type": "array", "items": { "type": "integer", "minimum": 0 } },
            "group": { "type": "string" },
            "boundary": { "const": true },
            "all": { "const": true },
            "and": sets,
            "or": sets,
            "not": { "$ref": "#/$defs/selector" },
        },
    })
}
