//! Common functions of the scene reader: reports, tables by specification, words and their nearest neighbours.

use super::Options;
use super::errors::{FieldError, FieldOf, Part, SceneAllowed, SceneHint, Wanted};
use crate::catalogue::{Catalogue, find};
use crate::document::{Data, Entry, Location, Node};
use crate::problem::{MOST_SHOWN, Notice, SceneError, visible};
use crate::source::Source;
use opruga_core::spec::{ChoiceError, Default, Spec, Values, nearest, quoted};
use opruga_math::message::AnyMessage;
use opruga_world::schema::{self, Child, Section};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// The data that every part of the reader needs.
pub(crate) struct Reader<'a> {
    pub(crate) source: &'a Source<'a>,
    pub(crate) catalogue: &'a Catalogue,
    pub(crate) options: &'a Options,
    pub(crate) dimension: usize,
    pub(crate) errors: Vec<SceneError>,
    /// The number of errors that were only counted.
    more: usize,
    notices: Vec<Notice>,
    /// The number of notices that were only counted.
    more_notices: usize,
    /// The files that shapes have named so far.
    pub(crate) files: BTreeMap<String, Arc<[u8]>>,
    /// The names of files that could not be read.
    pub(crate) unread: Vec<String>,
}

/// Joins the parts of a path: `a.b`, or `b` at the top level.
pub(crate) fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.to_string() } else { format!("{path}.{name}") }
}

impl<'a> Reader<'a> {
    pub(crate) fn new(
        source: &'a Source<'a>,
        catalogue: &'a Catalogue,
        options: &'a Options,
        errors: Vec<SceneError>,
    ) -> Reader<'a> {
        Reader {
            source,
            catalogue,
            options,
            dimension: 2,
            errors,
            more: 0,
            notices: Vec::new(),
            more_notices: 0,
            files: BTreeMap::new(),
            unread: Vec::new(),
        }
    }

    /// Adds an error with its location.
    pub(crate) fn report(&mut self, location: Location, error: SceneError) {
        if self.errors.len() >= MOST_SHOWN {
            self.more += 1;
            return;
        }
        let error = self.located(location, error);
        self.errors.push(error);
    }

    /// Adds an error. The error is made only if it will be listed, because finding similar words takes time.
    fn report_lazily(&mut self, location: Location, error: impl FnOnce() -> SceneError) {
        if self.errors.len() >= MOST_SHOWN {
            self.more += 1;
        } else {
            self.report(location, error());
        }
    }

    /// Returns the bytes of a file that the scene names.
    pub(crate) fn file(&mut self, name: &str) -> Result<Arc<[u8]>, SceneError> {
        if let Some(bytes) = self.files.get(name) {
            return Ok(Arc::clone(bytes));
        }
        match self.options.files.read(name, self.options.limits.shape_bytes) {
            Ok(bytes) => {
                self.files.insert(name.to_string(), Arc::clone(&bytes));
                Ok(bytes)
            }
            Err(error) => {
                self.unread.push(name.to_string());
                Err(error)
            }
        }
    }

    /// The number of errors so far.
    pub(crate) fn count(&self) -> usize {
        self.errors.len() + self.more
    }

    /// Whether no error about a field, or anything in it, was reported after the first `before` errors.
    pub(crate) fn sound_since(&self, before: usize, path: &str) -> bool {
        let about =
            |e: &SceneError| e.path.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
        // Errors that were only counted may be about anything.
        self.more == 0 && !self.errors.iter().skip(before).any(about)
    }

    /// Adds a notice with its location. With `strict`, the notice becomes an error, unless it reports what the scene asks for.
    pub(crate) fn notice(&mut self, location: Location, about: SceneError) {
        if self.options.strict && !Notice::is_asked_for(about.code) {
            return self.report(location, about);
        }
        // The first notice of each type has the location; the others are counted.
        if let Some(first) =
            self.notices.iter_mut().find(|n| n.about.code == about.code && n.about.message == about.message)
        {
            first.count += 1;
        } else if self.notices.len() < MOST_SHOWN {
            let about = self.located(location, about);
            self.notices.push(Notice { about, count: 1 });
        } else {
            self.more_notices += 1;
        }
    }

    /// The line of a location; none if it is an override.
    pub(crate) fn line_of(&self, location: Location) -> Option<usize> {
        match location {
            Location::Bytes(start, _) => Some(self.source.position(start).0),
            Location::Override(_) => None,
        }
    }

    fn located(&self, location: Location, error: SceneError) -> SceneError {
        if !error.file.is_empty() {
            return error; // it has a location in another file
        }
        match location {
            Location::Bytes(start, end) => self.source.mark(error, start, end),
            Location::Override(k) => {
                let (path, value) = self.options.overrides.get(k).cloned().unwrap_or_default();
                SceneError { file: crate::overrides::named(&path, &value), ..error }
            }
        }
    }

    /// Returns the errors in the order of their locations, and the notices.
    pub(crate) fn finish(mut self) -> (Vec<SceneError>, Vec<Notice>) {
        self.errors.sort_by_key(|e| (e.line.unwrap_or(0), e.column.unwrap_or(0)));
        let of_file = |count| SceneError { file: self.source.file.to_string(), ..SceneError::and_more(count) };
        if self.more > 0 {
            self.errors.push(of_file(self.more));
        }
        if self.more_notices > 0 {
            self.notices.push(Notice { about: of_file(self.more_notices), count: 1 });
        }
        (crate::problem::shown(self.errors), self.notices)
    }

    /// Checks that the format is the supported one; otherwise nothing else could be understood.
    pub(crate) fn format(&mut self, root: &Node) -> bool {
        let readable = format!("\"{}\"", schema::FORMAT);
        match root.get("format") {
            Some(node) if node.text() == Some(schema::FORMAT) => {}
            Some(node) => {
                let about = FieldError::Format { value: node.shown(), readable };
                self.report(node.location, SceneError::of(about).path("format"));
                return false;
            }
            None => {
                let misspelt = nearest("format", root.entries().iter().map(|e| e.key.as_str()));
                let error = SceneError::of(FieldError::NoFormat { readable }).path("format");
                let error = error.advice(match misspelt {
                    Some(word) => SceneHint::Misspelt { word: visible(&word) },
                    None => SceneHint::BeginFormat { format: schema::FORMAT },
                });
                self.report(Location::Bytes(0, 0), error);
                return false;
            }
        }
        true
    }

    /// Reads and checks the plain fields of a table. Errors and missing fields are reported, and these fields keep their defaults. Structured fields
    /// are left to the caller, who reads them by name.
    pub(crate) fn fields(&mut self, node: &Node, path: &str, section: &Section, tag: Option<&'static str>) -> Values {
        self.fields_of(None, node, path, section, tag)
    }

    /// Does the same as `fields` for a table that describes the kind of a part, or for a section of the format.
    fn fields_of(
        &mut self,
        part: Option<Part>,
        node: &Node,
        path: &str,
        section: &Section,
        tag: Option<&'static str>,
    ) -> Values {
        let mut values = Values::defaults(section.spec, self.dimension);
        if !matches!(node.data, Data::Table(_)) {
            self.wrong_type(node, path, Wanted::Table);
            let hint = match node.data {
                Data::Array(_) if !path.contains('.') => Some(SceneHint::Section { name: path.into() }),
                Data::Boolean(touches) => contact_hint(section, touches),
                _ => None,
            };
            if let (Some(hint), Some(error)) = (hint, self.errors.last_mut()) {
                *error = error.clone().advice(hint);
            }
            return values;
        }
        let names = || names(section, tag);
        for entry in node.entries() {
            let here = join(path, &entry.key);
            if let Some(field) = section.spec.fields.iter().find(|f| f.name == entry.key) {
                if let Some(value) = self.plain(&entry.value, &here, field.name, &field.range)
                    && let Err(e) = values.set(section.spec, field.name, value, self.dimension)
                {
                    self.report(entry.value.location, SceneError::of(e).path(here));
                }
            } else if !names().any(|n| n == entry.key) {
                self.unknown_field(node, entry, &here, section, tag);
            }
        }
        let meant = self.misspelt(node, section, tag);
        self.missing(part, node, path, section, &meant);
        self.choices(node, path, section.spec, &meant);
        self.without_effect(node, path, section.spec, &values);
        values
    }

    /// Reports a field that a table does not have.
    fn unknown_field(&mut self, node: &Node, entry: &Entry, here: &str, section: &Section, tag: Option<&'static str>) {
        let names = || names(section, tag);
        let error = || {
            let (field, kind) = (visible(&entry.key), section.spec.kind);
            let about = match kind {
                "scene" => FieldError::NoFieldInScene { field },
                table => FieldError::NoField { field, table },
            };
            let mut error = SceneError::of(about).path(visible(here)).nearest(nearest(&entry.key, names()));
            error.allowed = Some(listed(names()));
            // The field belongs to the kind that an override has replaced.
            if let Some(Location::Override(_)) = tag.and_then(|tag| node.get(tag)).map(|kind| kind.location)
                && let (Location::Bytes(..), Some((table, _))) = (entry.location, here.rsplit_once('.'))
            {
                // An integrator may be a single word; other parts are tables with all fields that have no default.
                let table = table.to_string();
                error = error.advice(if table == "integrator" {
                    SceneHint::KindSet { table, kind }
                } else {
                    let needed = section.spec.fields.iter().filter(|field| field.default == Default::Required);
                    let needed = needed.map(|field| format!(", {}=…", field.name)).collect();
                    SceneHint::KindSetWith { table, kind, needed }
                });
            }
            error
        };
        match self.options.lenient {
            // Each of these notices has its own message, so it is not compared with the listed ones.
            true if self.notices.len() >= MOST_SHOWN => self.more_notices += 1,
            true => self.notice(entry.location, error()),
            false => self.report_lazily(entry.location, error),
        }
    }

    /// The names that misspelt fields probably mean; they are used so that one mistake gives only one error. If unknown fields cause only warnings,
    /// the fields that were probably meant are still reported as missing.
    pub(crate) fn misspelt(&self, node: &Node, section: &Section, tag: Option<&str>) -> Vec<String> {
        if self.options.lenient {
            return Vec::new();
        }
        let unknown = node.entries().iter().filter(|entry| !names(section, tag).any(|name| name == entry.key));
        // Suggestions are needed only for errors that are listed; the other errors are only counted.
        unknown.take(MOST_SHOWN).filter_map(|entry| nearest(&entry.key, names(section, tag))).collect()
    }

    /// Reports fields that are given but have no effect together with the others.
    fn without_effect(&mut self, node: &Node, path: &str, spec: &'static Spec, values: &Values) {
        for entry in node.entries() {
            let Some(field) = spec.fields.iter().find(|field| field.name == entry.key) else { continue };
            let Some(condition) = field.without_effect(values, self.dimension) else { continue };
            let (field, value) = (field.name, entry.value.shown());
            let about = FieldError::NoEffect { field, condition: condition.text().into(), value };
            let about = SceneError::of(about).path(join(path, field));
            self.notice(entry.location, about);
        }
    }

    /// Reports a field, if it is given, that has an effect only under a condition that does not hold.
    pub(crate) fn no_effect(&mut self, node: &Node, path: &str, field: &'static str, condition: impl Into<AnyMessage>) {
        let Some(entry) = node.entry(field) else { return };
        let (condition, value) = (condition.into(), entry.value.shown());
        let about = FieldError::NoEffect { field, condition, value };
        self.notice(entry.location, SceneError::of(about).path(join(path, field)));
    }

    /// Reports all missing fields of a table at once, except those that a misspelt name probably means.
    fn missing(&mut self, part: Option<Part>, node: &Node, path: &str, section: &Section, meant: &[String]) {
        let plain = section.spec.fields.iter().filter(|f| f.default == Default::Required).map(|f| f.name);
        let structured = section.children.iter().filter(|c: &&Child| c.required).map(|c| c.name);
        let missing: Vec<&str> = plain
            .chain(structured)
            .filter(|name| node.get(name).is_none() && !meant.iter().any(|m| m == name))
            .collect();
        if missing.is_empty() {
            return;
        }
        let (fields, count) = (quoted(&missing), missing.len());
        let about = match path.is_empty() {
            true => FieldError::MissingInScene { fields, count },
            false => FieldError::Missing { fields, count, table: section.spec.kind },
        };
        let mut error = SceneError::of(about).path(join(path, missing[0]));
        if let Some(field) = section.spec.fields.iter().find(|f| f.name == missing[0] && missing.len() == 1) {
            let purpose = SceneHint::Purpose { field: FieldOf { part, kind: section.spec.kind, about: field } };
            error = error.allows(field.range.describe(self.dimension)).advice(purpose);
        }
        self.report(node.location, error);
    }

    /// Reports every choice between fields of which none or several are given, except choices with a field that a misspelt name probably means.
    fn choices(&mut self, node: &Node, path: &str, spec: &'static Spec, meant: &[String]) {
        for set in spec.choices().filter(|set| !set.iter().any(|name| meant.iter().any(|m| m == name))) {
            let given: Vec<&&str> = set.iter().filter(|name| node.get(name).is_some()).collect();
            let (location, name) = match given.as_slice() {
                [_] => continue,
                [] => (node.location, set[0]),
                [_, second, ..] => (super::location_of(node, second), **second),
            };
            let about = match given.as_slice() {
                [] => ChoiceError::None { fields: quoted(set) },
                given => {
                    let given: Vec<&str> = given.iter().map(|name| **name).collect();
                    ChoiceError::Several { fields: quoted(set), given: quoted(&given) }
                }
            };
            let allowed = SceneAllowed::OneOf { fields: set.join(", ") };
            self.report(location, SceneError::of(about).path(join(path, name)).allows(allowed));
        }
    }

    /// A table whose `kind` names one of several specifications.
    pub(crate) fn kind_table(&mut self, node: &Node, path: &str, what: Part, list: &[&'static Spec]) -> Option<Values> {
        let word = node.get("kind").and_then(Node::text);
        let Some(spec) = word.and_then(|word| find(list, word, self.dimension)) else {
            let here = list.iter().filter(|spec| spec.dimensions.contains(&self.dimension));
            self.tag(node, path, "kind", what, &here.map(|spec| spec.kind).collect::<Vec<_>>());
            return None;
        };
        if !spec.dimensions.contains(&self.dimension) {
            let location = super::location_of(node, "kind");
            let dimensions = spec.dimensions.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
            let about = FieldError::KindDimension { kind: spec.kind, dimension: self.dimension, dimensions };
            self.report(location, SceneError::of(about).path(join(path, "kind")));
            return None;
        }
        Some(self.fields_of(Some(what), node, path, &Section { spec, children: &[] }, Some("kind")))
    }

    /// Reads `integrator`: a table, or the word alone if its defaults are sufficient.
    pub(crate) fn integrator(&mut self, node: &Node, path: &str) -> Option<Values> {
        let value = node.get("integrator")?;
        let list = self.catalogue.integrators.clone();
        let here = join(path, "integrator");
        let Data::Text(_) = &value.data else { return self.kind_table(value, &here, Part::Integrator, &list) };
        let kind = Entry { key: "kind".into(), location: value.location, value: value.clone() };
        let table = Node { location: value.location, data: Data::Table(vec![kind]) };
        self.kind_table(&table, &here, Part::Integrator, &list)
    }

    /// The word that selects the type of a table.
    pub(crate) fn tag(&mut self, node: &Node, path: &str, tag: &str, what: Part, words: &[&str]) -> Option<String> {
        if !matches!(node.data, Data::Table(_)) {
            self.wrong_type(node, path, Wanted::Table);
            return None;
        }
        let here = join(path, tag);
        let Some(value) = node.get(tag) else {
            let error = SceneError::of(FieldError::NoTag { tag: tag.into(), table: what });
            self.report(node.location, error.path(here).allowed(listed(words.iter().copied())));
            return None;
        };
        let Some(word) = value.text() else {
            self.wrong_type(value, &here, Wanted::Text);
            return None;
        };
        if words.contains(&word) {
            return Some(word.to_string());
        }
        let error = SceneError::of(FieldError::NoKind { table: what, word: visible(word) })
            .path(here)
            .allowed(listed(words.iter().copied()))
            .nearest(nearest(word, words.iter().copied()));
        self.report(value.location, error);
        None
    }

    /// The tables of a list, with their paths. A single table is not a list.
    pub(crate) fn list<'n>(&mut self, node: &'n Node, path: &str, name: &str) -> Vec<(&'n Node, String)> {
        let Some(value) = node.get(name) else { return Vec::new() };
        let here = join(path, name);
        match &value.data {
            Data::Array(items) => items.iter().enumerate().map(|(k, item)| (item, format!("{here}.{k}"))).collect(),
            _ => {
                self.wrong_type(value, &here, Wanted::Tables);
                if matches!(value.data, Data::Table(_))
                    && let Some(error) = self.errors.last_mut()
                {
                    let name = name.to_string();
                    *error = error.clone().advice(match path.is_empty() {
                        true => SceneHint::Sections { name },
                        false => SceneHint::Inline { name },
                    });
                }
                Vec::new()
            }
        }
    }

    /// Reports a value of the wrong type.
    pub(crate) fn wrong_type(&mut self, node: &Node, path: &str, wanted: Wanted) {
        let field = visible(if path.is_empty() { "the scene" } else { path });
        let about = FieldError::Type { field, kind: node.kind(), value: node.shown() };
        let mut error = SceneError::of(about).path(visible(path)).allows(wanted);
        if let Data::Text(text) = &node.data
            && wanted.takes_numbers()
            && text.trim().parse::<f64>().is_ok()
        {
            error = error.advice(SceneHint::NoQuotes {});
        }
        self.report(node.location, error);
    }
}

/// What helps if a truth value is written instead of a table of contact.
fn contact_hint(section: &Section, touches: bool) -> Option<SceneHint> {
    match (section.spec.kind, touches) {
        ("body.contact", false) => Some(SceneHint::PassThrough {}),
        ("body.contact", true) => Some(SceneHint::KeepApart {}),
        ("contact", true) => Some(SceneHint::Section { name: "contact".into() }),
        ("contact", false) => Some(SceneHint::NoSection {}),
        _ => None,
    }
}

/// Joins words into a list for a sentence, each word once.
pub(crate) fn listed<'w>(words: impl Iterator<Item = &'w str>) -> String {
    let mut seen = BTreeSet::new();
    words.filter(|word| seen.insert(*word)).collect::<Vec<_>>().join(", ")
}

/// The names of all fields that a table may contain.
fn names<'s>(section: &'s Section, tag: Option<&'s str>) -> impl Iterator<Item = &'s str> {
    let fields = section.spec.fields.iter().map(|f| f.name);
    fields.chain(section.children.iter().map(|c| c.name)).chain(tag)
}
