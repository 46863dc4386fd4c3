//! Nodes and elements as a mesh file gives them, before a body is made of them.

use super::errors::{Listed, MeshFileError, MeshFileNotice};
use super::scanner::Scanner;
use super::terms::ElementName;
use crate::budget::{NOTICES, VALUES};
use crate::problem::{SceneError, visible};
use opruga_mesh::NodeValues;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

/// Element types that Opruga knows, numbered as in [`opruga_mesh::Cells`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Point,
    Line,
    /// The ends, then the middle.
    QuadraticLine,
    Triangle,
    Quadrilateral,
    QuadraticTriangle,
    Tetrahedron,
    Hexahedron,
    QuadraticTetrahedron,
}

impl Kind {
    /// The dimension of the element.
    pub(crate) fn dimension(self) -> usize {
        match self {
            Kind::Point => 0,
            Kind::Line | Kind::QuadraticLine => 1,
            Kind::Triangle | Kind::Quadrilateral | Kind::QuadraticTriangle => 2,
            Kind::Tetrahedron | Kind::Hexahedron | Kind::QuadraticTetrahedron => 3,
        }
    }

    /// Number of nodes.
    pub(crate) fn nodes(self) -> usize {
        match self {
            Kind::Point => 1,
            Kind::Line => 2,
            Kind::QuadraticLine | Kind::Triangle => 3,
            Kind::Quadrilateral | Kind::Tetrahedron => 4,
            Kind::QuadraticTriangle => 6,
            Kind::Hexahedron => 8,
            Kind::QuadraticTetrahedron => 10,
        }
    }

    pub(crate) fn name(self) -> ElementName {
        match self {
            Kind::Point => ElementName::Point,
            Kind::Line => ElementName::Line,
            Kind::QuadraticLine => ElementName::QuadraticLine,
            Kind::Triangle => ElementName::Triangle,
            Kind::Quadrilateral => ElementName::Quadrilateral,
            Kind::QuadraticTriangle => ElementName::QuadraticTriangle,
            Kind::Tetrahedron => ElementName::Tetrahedron,
            Kind::Hexahedron => ElementName::Hexahedron,
            Kind::QuadraticTetrahedron => ElementName::QuadraticTetrahedron,
        }
    }
}

/// An element of a file.
#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub(crate) kind: Kind,
    nodes: [u32; 10],
    /// The number of the element in the file.
    pub(crate) number: u64,
    /// The byte at which the element begins.
    pub(crate) offset: usize,
}

impl Item {
    pub(crate) fn nodes(&self) -> &[u32] {
        &self.nodes[..self.kind.nodes()]
    }
}

/// The contents of a file, as a reader found them.
#[derive(Debug, Default)]
pub(crate) struct Found {
    /// Positions of nodes in the order of the file [m]; z is 0 where the file has none.
    pub(crate) positions: Vec<[f64; 3]>,
    /// The byte at which each node begins; empty if the format does not list single nodes.
    pub(crate) node_offsets: Vec<usize>,
    /// The number of each node in the file.
    pub(crate) node_numbers: Vec<u64>,
    pub(crate) items: Vec<Item>,
    /// Named sets of items.
    pub(crate) item_groups: BTreeMap<String, Vec<u32>>,
    /// Named sets of nodes.
    pub(crate) node_groups: BTreeMap<String, Vec<u32>>,
    /// Named numbers, one per item; NaN for items without one.
    pub(crate) item_values: BTreeMap<String, Vec<f64>>,
    /// Named numbers and vectors of nodes; NaN for nodes without one.
    pub(crate) node_values: BTreeMap<String, NodeValues>,
    /// The first omitted parts, at most [`NOTICES`].
    notices: Vec<SceneError>,
    /// The number of omitted parts that are not listed.
    more: usize,
    /// The number of values of items and nodes and of memberships in groups so far.
    given: u64,
    /// Whether the file holds coordinates of 4 bytes each.
    pub(crate) single: bool,
}

impl Found {
    /// Adds a node.
    pub(super) fn node(&mut self, number: u64, position: [f64; 3], offset: usize) {
        self.positions.push(position);
        self.node_numbers.push(number);
        self.node_offsets.push(offset);
    }

    /// Adds an element whose nodes are in the order of Opruga.
    pub(super) fn item(&mut self, kind: Kind, nodes: &[u32], number: u64, offset: usize) {
        let mut own = [0; 10];
        own[..nodes.len()].copy_from_slice(nodes);
        self.items.push(Item { kind, nodes: own, number, offset });
    }

    /// Adds the last item to a group.
    pub(super) fn join(&mut self, group: String) {
        let last = self.items.len() as u32 - 1;
        let list = self.item_groups.entry(group).or_default();
        if list.last() != Some(&last) {
            list.push(last);
        }
    }

    /// Refuses elements whose number another element already has.
    ///
    /// # Errors
    /// `mesh.duplicate_element` with the offset of the second element.
    pub(super) fn distinct_elements(&self, scanner: &Scanner<'_>) -> Result<(), SceneError> {
        let mut order: Vec<(u64, usize)> = self.items.iter().map(|item| (item.number, item.offset)).collect();
        order.sort_unstable();
        let pairs = order.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        let Some(&(number, offset)) = pairs.map(|pair| &pair[1]).min_by_key(|second| second.1) else { return Ok(()) };
        Err(scanner.error(MeshFileError::ElementTwice { number }, offset))
    }

    /// Adds all items from `first` on to each of the groups.
    ///
    /// # Errors
    /// `limit.values` for too many.
    pub(super) fn join_all(&mut self, groups: &BTreeSet<String>, first: usize) -> Result<(), SceneError> {
        let items = first as u32..self.items.len() as u32;
        for group in groups {
            self.gives(items.len())?;
            self.item_groups.entry(group.clone()).or_default().extend(items.clone());
        }
        Ok(())
    }

    /// Adds values of consecutive nodes, beginning at a given node. Earlier nodes without a value are NaN.
    ///
    /// # Errors
    /// `limit.values`; `mesh.components` if earlier nodes have another number of components under this name.
    pub(super) fn values_of_nodes(
        &mut self,
        name: &str,
        first: usize,
        components: usize,
        own: impl Iterator<Item = f64>,
    ) -> Result<(), SceneError> {
        let known = self.node_values.get(name).map_or(0, |known| known.values.len());
        let end = self.positions.len() * components;
        self.gives(end.saturating_sub(known))?;
        let field = match self.node_values.entry(name.to_string()) {
            Entry::Vacant(free) => free.insert(NodeValues { components, values: Vec::new() }),
            Entry::Occupied(taken) if taken.get().components == components => taken.into_mut(),
            Entry::Occupied(taken) => {
                let before = taken.get().components;
                let name = visible(name);
                return Err(SceneError::of(MeshFileError::Components { before, name, components }));
            }
        };
        field.values.resize(first * components, f64::NAN);
        field.values.extend(own);
        Ok(())
    }

    /// Counts values of items and memberships in groups.
    ///
    /// # Errors
    /// `limit.values`.
    pub(super) fn gives(&mut self, values: usize) -> Result<(), SceneError> {
        self.given = self.given.saturating_add(values as u64);
        VALUES.check(self.given)
    }

    /// Reports a part of the file that a body at rest does not use.
    pub(super) fn left_out(&mut self, what: MeshFileNotice) {
        if self.notices.len() < NOTICES {
            self.notices.push(SceneError::of(what));
        } else {
            self.more += 1;
        }
    }

    /// All notices; those beyond the listed ones are counted.
    pub(crate) fn all_notices(&self) -> Vec<SceneError> {
        let mut all = self.notices.clone();
        if self.more > 0 {
            // The count takes the place of one notice.
            all.truncate(NOTICES - 1);
            let count = self.more + self.notices.len() - all.len();
            all.push(SceneError::of(MeshFileNotice::More { count }));
        }
        all
    }
}

/// Whether values with this number of components are kept for every node: numbers, and vectors in the plane and in space. Tensors are not used.
pub(super) fn is_kept(components: u64) -> bool {
    (1..=3).contains(&components)
}

/// Maps the numbers of nodes in a file to the indices of these nodes.
pub(super) struct Numbers(Vec<(u64, u32)>);

impl Numbers {
    /// Sorts the numbers of the nodes of a file.
    ///
    /// # Errors
    /// `mesh.duplicate_node` for a number that occurs twice.
    pub(super) fn of(found: &Found, scanner: &Scanner<'_>) -> Result<Numbers, SceneError> {
        let mut pairs: Vec<(u64, u32)> =
            found.node_numbers.iter().zip(0..).map(|(number, node)| (*number, node)).collect();
        pairs.sort_unstable();
        if let Some(pair) = pairs.windows(2).filter(|pair| pair[0].0 == pair[1].0).min_by_key(|pair| pair[1].1) {
            let (number, second) = pair[1];
            return Err(scanner.error(MeshFileError::NodeTwice { number }, found.node_offsets[second as usize]));
        }
        Ok(Numbers(pairs))
    }

    /// Returns the node whose number an element or a value gives; `offset` is the byte of this number, for the error.
    ///
    /// # Errors
    /// `mesh.index`.
    pub(super) fn node(
        &self,
        number: u64,
        scanner: &Scanner<'_>,
        element: Option<u64>,
        offset: usize,
    ) -> Result<u32, SceneError> {
        if let Ok(at) = self.0.binary_search_by_key(&number, |pair| pair.0) {
            return Ok(self.0[at].1);
        }
        let listed = match (self.0.first(), self.0.last()) {
            (Some(low), Some(high)) => Listed::Nodes { count: self.0.len(), first: low.0, last: high.0 },
            _ => Listed::NoNodes {},
        };
        let error = match element {
            Some(element) => MeshFileError::NoNode { element, node: number, listed },
            None => MeshFileError::NoNodeOfValue { node: number, listed },
        };
        Err(scanner.error(error, offset))
    }
}
