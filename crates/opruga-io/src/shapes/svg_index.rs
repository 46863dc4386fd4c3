//! Elements that are looked up repeatedly while a drawing is read, and the number of drawn elements.

use crate::budget::{ELEMENTS, Limit, POINTS};
use crate::problem::SceneError;
use roxmltree::{Document, Node, NodeId};
use std::cell::Cell;
use std::collections::BTreeMap;

/// The elements of a drawing by their ids, and counts of what has been drawn so far, including clip paths.
#[derive(Debug, Default)]
pub(super) struct Index {
    /// The first two elements with each id.
    ids: BTreeMap<String, (NodeId, Option<NodeId>)>,
    elements: Cell<u64>,
    points: Cell<u64>,
}

impl Index {
    /// Indexes the ids of a drawing.
    pub(super) fn of(document: &Document<'_>) -> Index {
        let mut index = Index::default();
        for node in document.descendants() {
            let Some(id) = node.attribute("id") else { continue };
            match index.ids.get_mut(id) {
                Some((_, second)) => *second = second.or(Some(node.id())),
                None => drop(index.ids.insert(id.to_string(), (node.id(), None))),
            }
        }
        index
    }

    /// The first and the second element with an id.
    pub(super) fn named<'d, 'a>(&self, document: &'d Document<'a>, id: &str) -> [Option<Node<'d, 'a>>; 2] {
        let Some((first, second)) = self.ids.get(id) else { return [None; 2] };
        [document.get_node(*first), second.and_then(|id| document.get_node(id))]
    }

    /// All ids.
    pub(super) fn ids(&self) -> impl Iterator<Item = &str> {
        self.ids.keys().map(String::as_str)
    }

    /// Counts an element that is drawn.
    pub(super) fn element(&self) -> Result<(), SceneError> {
        count(&self.elements, 1, &ELEMENTS)
    }

    /// Counts points of outlines.
    pub(super) fn points(&self, more: usize) -> Result<(), SceneError> {
        count(&self.points, more as u64, &POINTS)
    }
}

fn count(of: &Cell<u64>, more: u64, limit: &Limit) -> Result<(), SceneError> {
    of.set(of.get().saturating_add(more));
    limit.check(of.get())
}
