//! Compatibility: every model on every type of body, with every integrator, and every pair of models.
//!
//! The tables of docs/methods.md come from these runs. `OPRUGA_TABLES=write` writes them again.

use super::common::read;
use opruga::core::spec::{Default, Field, Role, Spec};
use opruga::{Options, catalogue};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// A type of body: its name in the tables, its dimension and its lines in a scene.
type Body = (&'static str, usize, &'static str);

/// Small bodies of every type, each pinned at some nodes.
const BODIES: &[Body] = &[
    (
        "chain",
        2,
        "shape = { kind = \"line\", from = [0, 0], to = [1, 0], segments = 11 }\npin = [{ select = { nodes = [0, 1] } }]",
    ),
    (
        "outline",
        2,
        "shape = { kind = \"ring\", radius = 0.5, vertices = 16 }\npin = [{ select = { nodes = [0, 1, 2, 3, 4] } }]",
    ),
    (
        TRIANGLES,
        2,
        "shape = { kind = \"grid\", size = [1, 0.6], cells = [4, 3] }\nrotation = 0.6\nsimplices = true\norder = 1\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "quadratic",
        2,
        "shape = { kind = \"grid\", size = [1, 0.6], cells = [4, 3] }\nrotation = 0.6\nsimplices = true\norder = 2\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "quadrilaterals",
        2,
        "shape = { kind = \"grid\", size = [1, 0.6], cells = [4, 3] }\nrotation = 0.6\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "chain",
        3,
        "shape = { kind = \"line\", from = [0, 0, 0], to = [1, 0, 0], segments = 11 }\npin = [{ select = { nodes = [0, 1] } }]",
    ),
    (
        "closed surface",
        3,
        "shape = { kind = \"icosphere\", radius = 0.5, subdivisions = 1 }\npin = [{ select = { half_space = { point = [0, -0.2, 0], normal = [0, -1, 0] } } }]",
    ),
    (
        "sheet",
        3,
        "shape = { kind = \"sheet\", u = [1, 0, 0], v = [0, 0, 0.8], cells = [5, 4] }\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "tetrahedra",
        3,
        "shape = { kind = \"grid\", size = [1, 0.6, 0.5], cells = [3, 2, 2] }\nsimplices = true\norder = 1\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "quadratic",
        3,
        "shape = { kind = \"grid\", size = [1, 0.6, 0.5], cells = [3, 2, 2] }\nsimplices = true\norder = 2\npin = [{ select = { group = \"left\" } }]",
    ),
    (
        "hexahedra",
        3,
        "shape = { kind = \"grid\", size = [1, 0.6, 0.5], cells = [3, 2, 2] }\npin = [{ select = { group = \"left\" } }]",
    ),
];
const TRIANGLES: &str = "triangles";

/// A model with the initial values of an editor, and the first field of each choice; `full` includes fields without a default.
fn written(spec: &Spec, full: bool) -> String {
    let given = |field: &&Field| match field.default {
        Default::Required => true,
        Default::OneOf(set) => set.first() == Some(&field.name),
        Default::Absent => full && field.start.is_some() && field.applies.is_empty(),
        _ => false,
    };
    let mut text = format!("{{ kind = \"{}\"", spec.kind);
    for field in spec.fields.iter().filter(given) {
        let _ = write!(text, ", {} = {:?}", field.name, field.start.unwrap_or(1.0));
    }
    text + " }"
}

/// The end of a run: after all of its frames, or with a code and a sentence.
type End = Result<(), (String, String)>;

fn run(body: &Body, models: &[&str], rule: &str) -> End {
    let (_, dimension, lines) = body;
    let gravity = if *dimension == 2 { "[0.3, -1]" } else { "[0.3, -1, 0.2]" };
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 100\n\
         [integrator]\nkind = \"{rule}\"\n[world]\ngravity = {gravity}\n[[body]]\nname = \"body\"\nmass = 1\n{lines}\nmodels = [{}]\n",
        models.join(", ")
    );
    let blueprint = read(&text).map_err(|errors| {
        let first = errors.first();
        (first.map_or("", |error| error.code).to_string(), first.map(ToString::to_string).unwrap_or_default())
    })?;
    let refusal = |error: opruga::WorldError| (error.code().to_string(), error.to_string());
    let mut world = blueprint.build(Options::default()).map_err(refusal)?;
    world.frame().map_err(refusal)?;
    Ok(())
}

/// The reasons of a table, each with its letter.
#[derive(Default)]
struct Reasons(Vec<String>);

impl Reasons {
    /// The letter of a reason: a sentence without the names of the body, the model and the integrator.
    fn letter(&mut self, end: &End, model: &str, rule: &str) -> char {
        let Err((code, said)) = end else { panic!("there is no reason") };
        // A combination that is refused must be refused before the run; a run that ends otherwise is a fault.
        assert!(
            code.starts_with("model.")
                || code.starts_with("integrator.")
                || ["static.rigid_modes", "step.unstable"].contains(&code.as_str()),
            "{model}, {rule}: {said}"
        );
        let said = said.trim_start_matches("body `body`: ").trim_start_matches(&format!("{model}: "));
        let said = said.split("; ").next().unwrap_or_default().replace(&format!("`{rule}`"), "the integrator");
        // Numbers depend on the body of this test.
        let mut said: String = said.split(|c: char| c.is_ascii_digit()).collect::<Vec<_>>().join("#");
        while said.contains("##") {
            said = said.replace("##", "#");
        }
        let reason = format!("{said} (`{code}`)");
        let at = self.0.iter().position(|known| *known == reason).unwrap_or_else(|| {
            self.0.push(reason);
            self.0.len() - 1
        });
        (b'a' + at as u8) as char
    }
    fn notes(&self) -> String {
        self.0.iter().enumerate().map(|(k, reason)| format!("* {}: {reason}\n", (b'a' + k as u8) as char)).collect()
    }
}

/// A table in Markdown.
fn table(head: &str, columns: &[String], rows: &[(String, Vec<String>)], notes: &str) -> String {
    let mut out = format!("| {head} | {} |\n|---|{}\n", columns.join(" | "), "---|".repeat(columns.len()));
    for (name, cells) in rows {
        let _ = writeln!(out, "| {name} | {} |", cells.join(" | "));
    }
    format!("{out}\n{notes}")
}

/// The models and the integrators of the library, with the result of each model alone: by model, body and integrator.
struct Runs {
    models: Vec<&'static Spec>,
    rules: Vec<&'static Spec>,
    ends: BTreeMap<(&'static str, &'static str, usize, &'static str), End>,
    /// The text of a model on a body.
    texts: BTreeMap<(&'static str, &'static str, usize), String>,
}

impl Runs {
    fn all() -> Runs {
        let known = catalogue();
        let (mut ends, mut texts) = (BTreeMap::new(), BTreeMap::new());
        let explicit =
            known.integrators.iter().find(|rule| rule.has_role(Role::OfferedExplicit)).expect("an explicit rule");
        for model in &known.models {
            for body in BODIES.iter().filter(|body| model.dimensions.contains(&body.1)) {
                // A field that one body needs, such as the thickness of a curve, is refused by another.
                let spare = run(body, &[&written(model, false)], explicit.kind).is_ok();
                let full = !spare && run(body, &[&written(model, true)], explicit.kind).is_ok();
                let text = written(model, full);
                for rule in &known.integrators {
                    ends.insert((model.kind, body.0, body.1, rule.kind), run(body, &[&text], rule.kind));
                }
                texts.insert((model.kind, body.0, body.1), text);
            }
        }
        Runs { models: known.models, rules: known.integrators, ends, texts }
    }
    fn rule(&self, role: Role) -> &'static str {
        self.rules.iter().find(|rule| rule.has_role(role)).expect("a rule of every role").kind
    }
    /// Two models on one body.
    fn sum(&self, body: &Body, models: [&Spec; 2], rule: &str) -> End {
        let texts = models.map(|model| self.texts.get(&(model.kind, body.0, body.1)).map_or("", String::as_str));
        run(body, &texts, rule)
    }
    /// The bodies that a model supports: those that the suggested explicit integrator can step.
    fn bodies(&self, model: &'static str) -> impl Iterator<Item = &'static Body> {
        let rule = self.rule(Role::OfferedExplicit);
        BODIES.iter().filter(move |body| self.ends.get(&(model, body.0, body.1, rule)).is_some_and(Result::is_ok))
    }

    fn of_bodies(&self) -> String {
        let (rule, mut reasons) = (self.rule(Role::OfferedExplicit), Reasons::default());
        let columns: Vec<String> = BODIES.iter().map(|body| format!("{} {}D", body.0, body.1)).collect();
        let mut rows = Vec::new();
        for model in &self.models {
            let cell = |body: &Body| match self.ends.get(&(model.kind, body.0, body.1, rule)) {
                None => String::new(),
                Some(Ok(())) => "✓".into(),
                Some(end) => reasons.letter(end, model.kind, rule).into(),
            };
            rows.push((format!("`{}`", model.kind), BODIES.iter().map(cell).collect::<Vec<String>>()));
            assert!(self.bodies(model.kind).count() > 0, "no body of this table suits {}", model.kind);
        }
        table("model", &columns, &rows, &reasons.notes())
    }

    fn of_integrators(&self) -> String {
        let mut reasons = Reasons::default();
        let registries = opruga::Registries::default();
        let promised = |model, rule, dimension| {
            let pairs = if dimension == 2 { registries.plane.pairs() } else { registries.space.pairs() };
            pairs.contains(&(model, rule, true))
        };
        let springs = self.models.iter().find(|model| model.has_role(Role::Edges)).expect("springs");
        let mut rows = Vec::new();
        for model in &self.models {
            let mut cells = Vec::new();
            for rule in &self.rules {
                let mut cell = "✓".to_string();
                for body in self.bodies(model.kind) {
                    let end = &self.ends[&(model.kind, body.0, body.1, rule.kind)];
                    // A model that does not hold nodes by itself has no equilibrium without other forces.
                    let with_springs = || self.sum(body, [springs, model], rule.kind);
                    if end.is_ok() {
                        continue;
                    }
                    if rule.has_role(Role::Statics) && with_springs().is_ok() {
                        cell = "with springs".into();
                        continue;
                    }
                    let (model, rule) = (model.kind, rule.kind);
                    assert!(!promised(model, rule, body.1), "lists promise {model} with {rule}, but: {end:?}");
                    let some = self.bodies(model).any(|b| self.ends[&(model, b.0, b.1, rule)].is_ok());
                    let letter = reasons.letter(end, model, rule);
                    cell = if some { format!("✓ but {letter}") } else { letter.into() };
                }
                cells.push(cell);
            }
            rows.push((format!("`{}`", model.kind), cells));
        }
        let columns: Vec<String> = self.rules.iter().map(|rule| format!("`{}`", rule.kind)).collect();
        table("model", &columns, &rows, &reasons.notes())
    }

    fn of_sums(&self) -> String {
        let mut reasons = Reasons::default();
        let rules = [Role::OfferedExplicit, Role::OfferedImplicit, Role::Statics].map(|role| self.rule(role));
        let mut rows = Vec::new();
        for (k, first) in self.models.iter().enumerate() {
            let mut cells = vec![String::new(); k];
            for second in &self.models[k..] {
                let mut cell = String::new();
                for body in self.bodies(first.kind).filter(|body| self.bodies(second.kind).any(|other| other == *body))
                {
                    for rule in rules {
                        let alone = [first, second].map(|model| self.ends[&(model.kind, body.0, body.1, rule)].is_ok());
                        let end = self.sum(body, [first, second], rule);
                        if end.is_ok() {
                            cell = "✓".into();
                        } else if alone == [true; 2] {
                            cell = reasons.letter(&end, second.kind, rule).into();
                        }
                    }
                }
                cells.push(cell);
            }
            rows.push((format!("`{}`", first.kind), cells));
        }
        let columns: Vec<String> = self.models.iter().map(|model| format!("`{}`", model.kind)).collect();
        table("with", &columns, &rows, &reasons.notes())
    }
}

/// The result of `Registry::pairs` in lists and in the studio is right for every body that a model supports.
#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn what_goes_with_what_is_what_the_page_of_methods_says_whole_sweep() {
    let runs = Runs::all();
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/methods.md");
    let mut text = std::fs::read_to_string(page).expect("docs/methods.md").replace("\r\n", "\n");
    let found = text.clone();
    for (name, table) in
        [("bodies", runs.of_bodies()), ("integrators", runs.of_integrators()), ("sums", runs.of_sums())]
    {
        let (from, to) = (format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->\n"));
        let start = text.find(&from).expect("the mark of a table") + from.len();
        let end = text.find(&to).expect("the mark of its end");
        text.replace_range(start..end, &table);
    }
    if std::env::var("OPRUGA_TABLES").is_ok_and(|what| what == "write") {
        std::fs::write(page, &text).expect("docs/methods.md can be written");
        return;
    }
    assert!(text == found, "docs/methods.md is not what the runs say: run this test with OPRUGA_TABLES=write\n{text}");
}
