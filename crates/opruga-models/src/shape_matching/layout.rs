//! The memory layout of the clusters of a body, or of eight bodies side by side. The symbols φₖ and L are those of the file
//! `shape`.
//!
//! A *slot* is a node in a cluster. The slots of a cluster are consecutive and fill whole packs. Slots without a node have no
//! mass. The data of slots and clusters have the layout of the columns of nodes ([`Layout::index`]), so that one body and eight
//! bodies run the same code and have the same bits.

use super::shape::Shape;
use opruga_core::potential::Ingredients;
use opruga_core::state::Layout;
use opruga_math::{Column, WIDTH};

/// The clusters of one body, or of eight identical ones.
#[derive(Debug)]
pub(super) struct Clusters<const D: usize> {
    pub(super) layout: Layout,
    /// The number of nodes of a body.
    pub(super) nodes: usize,
    /// The number of columns of a cluster: D, plus the products if the fit is quadratic.
    pub(super) columns: usize,
    /// The first slot of each cluster, and the end of the last one.
    pub(super) start: Vec<u32>,
    /// The number of slots of each cluster that hold a node.
    pub(super) count: Vec<u32>,
    /// The index of the node of every slot, for the first body.
    pub(super) indices: Vec<u32>,
    /// Whether there is one cluster, whose slots are the nodes in their order.
    pub(super) is_whole: bool,
    /// The slots of each node.
    pub(super) slots_of: Vec<u32>,
    pub(super) slots_start: Vec<u32>,
    /// The mass of a node in a cluster [kg].
    pub(super) mass: Column,
    /// φₖ, one after the other.
    pub(super) phi: Vec<Column>,
    /// 1/M [1/kg] of every cluster, and L, `[axis · D + k]`.
    pub(super) inverse_mass: Column,
    pub(super) frame: Vec<Column>,
}

impl<const D: usize> Clusters<D> {
    pub(super) fn new(ingredients: &Ingredients<D>, lists: &[Vec<u32>], quadratic: bool) -> Clusters<D> {
        let (layout, mesh) = (ingredients.layout, ingredients.mesh);
        let nodes = mesh.positions.len();
        let stride = layout.stride();
        let mut times = vec![0u32; nodes];
        lists.iter().flatten().for_each(|node| times[*node as usize] += 1);
        let is_whole = lists.len() == 1 && lists[0].len() == nodes;
        let mut start = vec![0u32];
        for list in lists {
            start.push(start[start.len() - 1] + list.len().next_multiple_of(WIDTH) as u32);
        }
        let slots = start[start.len() - 1] as usize;
        let columns = if quadratic { D + D * (D + 1) / 2 } else { D };
        let column = |items: usize| Column::zeros(layout.index_count(items) + WIDTH);
        let mut out = Clusters {
            layout,
            nodes,
            columns,
            count: lists.iter().map(|list| list.len() as u32).collect(),
            indices: vec![0; slots],
            is_whole,
            slots_of: Vec::new(),
            slots_start: Vec::new(),
            mass: column(slots),
            phi: (0..columns).map(|_| column(slots)).collect(),
            inverse_mass: column(lists.len()),
            frame: (0..D * D).map(|_| column(lists.len())).collect(),
            start,
        };
        let mut of_node = vec![Vec::new(); nodes];
        for (cluster, list) in lists.iter().enumerate() {
            let first = out.start[cluster] as usize;
            let end = out.start[cluster + 1] as usize;
            for slot in first..end {
                // Slots without a node read the first node.
                let node = list.get(slot - first).copied().unwrap_or(list[0]);
                out.indices[slot] = node * stride as u32;
            }
            for (k, node) in list.iter().enumerate() {
                of_node[*node as usize].push((first + k) as u32);
            }
            let positions: Vec<[f64; D]> = list.iter().map(|node| mesh.positions[*node as usize]).collect();
            for body in 0..stride {
                let share = |node: &u32| {
                    let whole = ingredients.mass.at(layout.index(*node as usize, body));
                    whole / f64::from(times[*node as usize])
                };
                let masses: Vec<f64> = list.iter().map(share).collect();
                let shape = Shape::new(&positions, &masses, quadratic);
                let at = layout.index(cluster, body);
                out.inverse_mass[at] = 1.0 / shape.mass;
                for d in 0..D * D {
                    out.frame[d][at] = shape.frame[d / D][d % D];
                }
                for (k, mass) in masses.iter().enumerate() {
                    let at = layout.index(first + k, body);
                    out.mass[at] = *mass;
                    for (to, from) in out.phi.iter_mut().zip(&shape.columns) {
                        to[at] = from[k];
                    }
                }
            }
        }
        out.slots_start.push(0);
        for own in of_node {
            out.slots_of.extend(own);
            out.slots_start.push(out.slots_of.len() as u32);
        }
        out
    }

    /// The number of clusters.
    pub(super) fn len(&self) -> usize {
        self.count.len()
    }
    /// The number of slots, including those that fill up packs.
    pub(super) fn slots(&self) -> usize {
        self.indices.len()
    }
    /// The slots of a cluster.
    pub(super) fn range(&self, cluster: usize) -> core::ops::Range<usize> {
        self.start[cluster] as usize..self.start[cluster + 1] as usize
    }
    pub(super) fn heap_bytes(&self) -> usize {
        let columns = self.phi.iter().chain(&self.frame).map(Column::heap_bytes).sum::<usize>();
        let lists = self.start.capacity() + self.count.capacity() + self.slots_of.capacity();
        columns
            + self.mass.heap_bytes()
            + self.inverse_mass.heap_bytes()
            + 4 * (lists + self.indices.capacity() + self.slots_start.capacity())
    }
}
