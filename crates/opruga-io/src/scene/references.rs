//! Names of bodies in other tables: finds the body with a name, or makes the error if there is none.

use super::body_list::Bodies;
use super::errors::{ReferenceError, SceneAllowed, SceneHint, Wanted};
use super::reader::{Reader, join, listed};
use crate::document::{Data, Location, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::nearest;
use opruga_world::blueprint::BodyBlueprint;

impl<const D: usize> Bodies<D> {
    /// The bodies that `body = …` of a table names, and the offset of selectors for each. The common name of copies means all copies.
    pub(crate) fn targets(&self, reader: &mut Reader<'_>, table: &Node, path: &str) -> Option<Vec<(usize, [f64; D])>> {
        if let Some((first, offsets)) = table.get("body").and_then(Node::text).and_then(|name| self.copied.get(name)) {
            return Some(offsets.iter().enumerate().map(|(k, offset)| (first + k, *offset)).collect());
        }
        self.reference(reader, table, path).map(|body| vec![(body, [0.0; D])])
    }

    /// The index of the body that `body = …` of a table names.
    pub(crate) fn reference(&self, reader: &mut Reader<'_>, table: &Node, path: &str) -> Option<usize> {
        let node = table.get("body")?;
        let here = join(path, "body");
        match &node.data {
            Data::Integer(Some(k), _) => {
                if let Ok(k) = usize::try_from(*k)
                    && k < self.initial
                {
                    return Some(k);
                }
                if self.broken.is_empty() {
                    let error = SceneError::of(ReferenceError::NoBodyAt { index: *k }).path(here);
                    reader.report(node.location, self.with_allowed(error));
                }
                None
            }
            Data::Text(name) => match self.names.get(name) {
                Some(k) => Some(*k),
                None => {
                    self.unknown(reader, node.location, here, name, &[]);
                    None
                }
            },
            _ => {
                reader.wrong_type(node, &here, Wanted::Body);
                None
            }
        }
    }
    /// The first body that a name means; the name may also be the common name of copies.
    pub(crate) fn first(&self, name: &str) -> Option<&BodyBlueprint<D>> {
        let k = self.names.get(name).or_else(|| self.names.get(&format!("{name}[0]")));
        k.and_then(|k| self.list.get(*k)).or_else(|| name.parse::<usize>().ok().and_then(|k| self.list.get(k)))
    }

    /// Reports a name that no body has.
    pub(crate) fn unknown(
        &self,
        reader: &mut Reader<'_>,
        location: Location,
        path: String,
        name: &str,
        others: &[&str],
    ) {
        if self.broken.iter().any(|b| b.is_empty() || b == name || name.starts_with(&format!("{b}["))) {
            return; // the body is there, but has errors of its own
        }
        let error = SceneError::of(ReferenceError::NoBodyCalled { body: visible(name) }).path(path);
        let error = self.with_allowed(error);
        let base = name.split('[').next().unwrap_or(name);
        let error = match self.copied.get(base) {
            Some((_, copies)) => {
                let count = copies.len();
                error.advice(SceneHint::Copies { name: base.into(), count, last: count - 1 })
            }
            None => error.nearest(nearest(
                name,
                self.names.keys().map(String::as_str).filter(|n| !n.ends_with(']')).chain(others.iter().copied()),
            )),
        };
        reader.report(location, error);
    }

    /// Adds the existing bodies to an error.
    fn with_allowed(&self, error: SceneError) -> SceneError {
        match self.list.len() {
            0 if !self.broken.is_empty() => error.allowed(listed(self.broken.iter().map(String::as_str))),
            0 => error.allows(SceneAllowed::NoBodies {}),
            n if n <= 8 => error.allowed(listed(self.list.iter().map(|b| b.name.as_str()))),
            count => error.allows(SceneAllowed::Bodies { count, last: self.initial.saturating_sub(1) }),
        }
    }
}
