//! The reference page of the scene format, made from the descriptions that the reader uses.

use crate::catalogue::{self, Catalogue};
use opruga_core::spec::{Allowed, Bound, Default, Field, Spec};
use opruga_world::schema::{Child, Holds, SCENE, SELECTORS, Section};
use opruga_world::shapes;
use std::fmt::Write as _;

/// The reference page in Markdown.
pub fn markdown(catalogue: &Catalogue) -> String {
    let mut out =
        String::from("# The scene file\n\n<!-- Generated from the descriptions in the code; do not edit. -->\n\n");
    out.push_str(INTRODUCTION);
    table(&mut out, "## ", &SCENE, None);
    for child in SCENE.children {
        match child.holds {
            Holds::Table(section) => heading(&mut out, &format!("`[{}]`", child.name), section),
            Holds::List(section) => heading(&mut out, &format!("`[[{}]]`", child.name), section),
            Holds::Tagged { tag, sections } => {
                let _ = writeln!(out, "## `[[{}]]`\n\n{}\n", child.name, child.documentation);
                sections.iter().for_each(|s| table(&mut out, "### ", s, Some(tag)));
            }
            Holds::Integrator => kinds(&mut out, "Integrators", "[integrator]", &catalogue.integrators),
            Holds::Colliders => kinds(&mut out, "Colliders", "[[collider]]", &catalogue.colliders),
            _ => {}
        }
        if child.name == "body" {
            kinds(&mut out, "Shapes", "shape = { … }", &shapes::all());
            kinds(&mut out, "Models", "models = [ { … } ]", &catalogue.models);
        }
    }
    out.push_str("## Selectors\n\nA selector is a table with exactly one of these keys. A selector that selects nothing is an error. Selectors refer \
to the positions at the start.\n\n| key | selects | form |\n|---|---|---|\n");
    for spec in SELECTORS {
        let _ = writeln!(out, "| `{}` | {} | {} |", spec.kind, spec.summary, spec.documentation);
    }
    out.push_str(PATHS);
    out
}

const INTRODUCTION: &str = "A scene is a [TOML](https://toml.io) file in UTF-8. Units are SI. Numbers must be finite. Where a number is expected, a \
whole number is accepted, but a text is not. Unknown fields, repeated keys and names of bodies that do not exist are errors. All errors are reported \
at once. A scene cannot include another one.\n\n";

const PATHS: &str = "\n## Paths of parameters\n\n`--set PATH=VALUE` and `do = \"set\"` name a parameter by its path: `seed`, `time.substeps`, \
`world.gravity`, `integrator.kind`, `collider.0.friction`, `body.ball.mass`, `body.0.models.mass_spring.stiffness`. An entry of a list is named by \
its number from 0, its `name` or its `kind`. `--set` changes the scene before it is read, so it may name any field, and numbers refer to the order \
of the tables in the file. `do = \"set\"` changes the running world, so it may name only `time.substeps` and fields of `world`, of `[contact]`, of \
the integrator, of colliders and of models. In this case, the name of a body with copies means all copies.\n";

fn heading(out: &mut String, title: &str, section: &'static Section) {
    let _ = writeln!(out, "## {title}\n\n{}\n", sentence(section.spec));
    rows(out, section, None);
    for child in section.children {
        if let Holds::Table(inner) | Holds::List(inner) | Holds::VectorOr(inner) = child.holds {
            let _ = writeln!(out, "### `{}` in a {}\n\n{}\n", child.name, section.spec.kind, sentence(inner.spec));
            rows(out, inner, None);
        }
    }
}

fn table(out: &mut String, level: &str, section: &Section, tag: Option<&str>) {
    let title = match tag {
        Some(tag) => format!("`{tag} = \"{}\"`", section.spec.kind),
        None => section.spec.summary.to_string(),
    };
    let text = if tag.is_some() { sentence(section.spec) } else { section.spec.documentation.to_string() };
    let _ = writeln!(out, "{level}{title}\n\n{text}\n");
    rows(out, section, tag);
}

/// Writes a section for each kind. The headings of these sections occur in no other chapter. A field that differs between the dimensions has one row for each.
fn kinds(out: &mut String, title: &str, path: &str, specs: &[&'static Spec]) {
    let _ = writeln!(out, "## {title}: `{path}`\n");
    for kind in catalogue::by_kind(specs) {
        let dimensions = catalogue::dimensions(&kind);
        let one = title.strip_suffix('s').unwrap_or(title);
        let text = sentence_of(kind[0], &dimensions);
        let _ = writeln!(out, "### {one} `kind = \"{}\"`\n\n{text}\n", kind[0].kind);
        let fields = catalogue::fields(&kind);
        if fields.is_empty() {
            out.push_str("No fields but `kind`.\n\n");
            continue;
        }
        out.push_str(HEAD);
        for (field, of) in fields {
            let note = match (of.len() < kind.len(), catalogue::dimensions(&of).as_slice()) {
                (true, [dimension]) => format!(" ({dimension}D)"),
                _ => String::new(),
            };
            row(out, field, &note);
        }
        out.push('\n');
    }
}

/// The header of a table of fields.
const HEAD: &str = "| field | unit | allowed | default | meaning |\n|---|---|---|---|---|\n";

/// The row of a field.
fn row(out: &mut String, field: &Field, note: &str) {
    let _ = writeln!(
        out,
        "| `{}`{note} | {} | {} | {} | {} |",
        field.name,
        field.unit,
        escape(&allowed(&field.range)),
        default(field),
        escape(&field.full_documentation())
    );
}

fn sentence(spec: &Spec) -> String {
    sentence_of(spec, spec.dimensions)
}

fn sentence_of(spec: &Spec, dimensions: &[usize]) -> String {
    let dimensions = match dimensions {
        [2] => " (2D only)",
        [3] => " (3D only)",
        _ => "",
    };
    let text = format!("{}{dimensions}.", spec.summary);
    if spec.documentation.is_empty() { text } else { format!("{text} {}", spec.documentation) }
}

fn rows(out: &mut String, section: &Section, tag: Option<&str>) {
    if section.spec.fields.is_empty() && section.children.is_empty() {
        let _ = writeln!(out, "No fields{}.\n", tag.map(|t| format!(" but `{t}`")).unwrap_or_default());
        return;
    }
    out.push_str(HEAD);
    section.spec.fields.iter().for_each(|field| row(out, field, ""));
    for child in section.children {
        let default = if child.required { "required" } else { "" };
        let _ =
            writeln!(out, "| `{}` | | {} | {default} | {} |", child.name, holds(child), escape(child.documentation));
    }
    out.push('\n');
}

fn escape(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn allowed(range: &Allowed) -> String {
    match range {
        Allowed::Number { least: Bound::None, greatest: Bound::None } => "any number".into(),
        Allowed::Vector => "one number per axis".into(),
        Allowed::Direction => "one number per axis, not all zero".into(),
        Allowed::Points => "a list of points".into(),
        Allowed::Path => "a path `[[t, x, y(, z)], …]`, t rising".into(),
        Allowed::Curve => "a curve `[[t, value], …]`, t rising".into(),
        Allowed::CurveNotNegative => "a curve `[[t, value], …]`, t rising, values >= 0".into(),
        other => other.describe(2).to_string(),
    }
}

fn default(field: &Field) -> String {
    match field.default {
        Default::Required => "required".into(),
        Default::Absent => String::new(),
        Default::OneOf(set) => {
            format!("one of {}", set.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "))
        }
        Default::Number(x) => x.to_string(),
        Default::Integer(x) => x.to_string(),
        Default::Boolean(x) => x.to_string(),
        Default::Text("") => "empty".into(),
        Default::Text(x) => format!("`{x}`"),
        Default::Origin => "zeros".into(),
    }
}

fn holds(child: &Child) -> String {
    match child.holds {
        Holds::Table(_) => "a table, see below".into(),
        Holds::Integrator => "a table, see Integrators, or only its `kind`".into(),
        Holds::List(_) | Holds::Tagged { .. } | Holds::Models | Holds::Colliders => {
            "a list of tables, see below".into()
        }
        Holds::Shape => "a table, see Shapes".into(),
        Holds::Selector => "a selector, see below".into(),
        Holds::VectorOr(_) => "one number per axis, or a table, see below".into(),
        Holds::Turn => "a number in 2D, an axis times its angle in 3D".into(),
        Holds::BodyReference => "the name of a body or its number".into(),
        Holds::Node => "a number, `nearest` or `nearest_facet`".into(),
        Holds::Words(words) => format!("a list of {}", words.join(", ")),
        Holds::Counts => "one whole number from 1 per axis".into(),
        Holds::AnyValue => "a value that fits the parameter".into(),
    }
}
