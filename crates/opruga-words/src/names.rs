//! The names of kinds, of their parameters, and of the values of these parameters.
//!
//! An entry is named after its subject: `model-fem` is a kind, `model-fem-plane` is a parameter of this kind, and `model-every-plane` is this
//! parameter of all kinds without an entry of their own. The attribute `.about` of an entry is a description.

use crate::Translation;
use fluent_syntax::ast::{Entry, Pattern, PatternElement};
use fluent_syntax::parser::parse_runtime;
use std::collections::HashMap;
use std::sync::PoisonError;

/// A name with a description, which may be empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    /// The name.
    pub name: &'static str,
    /// The description in one line.
    pub about: &'static str,
}

/// All names of a language.
#[derive(Debug, Default)]
pub(crate) struct Names {
    lines: HashMap<&'static str, Named>,
    /// For every parameter, the first entry with its name, whatever the kind.
    parameters: HashMap<&'static str, Named>,
}

impl Names {
    /// Adds the names of a text in Fluent syntax; returns its errors. Entries with errors are skipped.
    pub(crate) fn add(&mut self, text: &'static str) -> Vec<String> {
        let mut problems = Vec::new();
        let resource = parse_runtime(text).unwrap_or_else(|(resource, errors)| {
            problems.extend(errors.iter().map(|error| format!("{error} at byte {}", error.pos.start)));
            resource
        });
        for entry in resource.body {
            let Entry::Message(message) = entry else { continue };
            let path = message.id.name;
            let about = message.attributes.iter().find(|attribute| attribute.id.name == "about");
            let about = about.map_or(Some(""), |attribute| plain(&attribute.value));
            let (Some(name), Some(about)) = (message.value.as_ref().and_then(plain), about) else {
                problems.push(format!("`{path}` is not one plain line"));
                continue;
            };
            let named = Named { name, about };
            if self.lines.contains_key(path) {
                problems.push(format!("`{path}` is named already"));
                continue;
            }
            self.lines.insert(path, named);
            if let Some((_, parameter)) = path.split_once('-').and_then(|(_, rest)| rest.split_once('-')) {
                self.parameters.entry(parameter).or_insert(named);
            }
        }
        problems
    }
}

/// The text of a single-line pattern without variables.
fn plain(pattern: &Pattern<&'static str>) -> Option<&'static str> {
    match pattern.elements.as_slice() {
        [PatternElement::TextElement { value }] => Some(*value),
        _ => None,
    }
}

impl Translation {
    /// The name for a path such as `["model", "fem"]`, `["model", "fem", "plane"]` or `["choice", "stress"]`; none if the language does not have it.
    pub fn named(&self, path: &[&str]) -> Option<Named> {
        let names = self.names.read().unwrap_or_else(PoisonError::into_inner);
        names.lines.get(&*path.join("-")).copied()
    }

    /// The name of a parameter of a kind, from its own entry or from the common entry of all kinds.
    pub fn named_parameter(&self, part: &str, kind: &str, parameter: &str) -> Option<Named> {
        self.named(&[part, kind, parameter]).or_else(|| self.named(&[part, "every", parameter]))
    }

    /// The name of a parameter whose kind is unknown.
    pub fn any_parameter(&self, parameter: &str) -> Option<Named> {
        let names = self.names.read().unwrap_or_else(PoisonError::into_inner);
        names.parameters.get(parameter).copied()
    }

    /// Adds the names of kinds that a program registers, given in Fluent syntax.
    ///
    /// # Errors
    /// The errors of the text: its syntax, existing names, names with variables. All entries without errors are added.
    pub fn add_names(&self, text: &'static str) -> Result<(), Vec<String>> {
        let problems = self.names.write().unwrap_or_else(PoisonError::into_inner).add(text);
        if problems.is_empty() { Ok(()) } else { Err(problems) }
    }

    /// The paths of all names, joined by `-`, in alphabetical order.
    pub fn paths(&self) -> Vec<&'static str> {
        let names = self.names.read().unwrap_or_else(PoisonError::into_inner);
        let mut paths: Vec<&str> = names.lines.keys().copied().collect();
        paths.sort_unstable();
        paths
    }
}
