//! Neighbours of nodes.

use crate::chambers::Survey;
use crate::{Mesh, MeshError};

/// Lists of neighbour nodes, one list per node, stored end to end.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Adjacency {
    /// The start of each node's list in `neighbours`; one more entry than nodes.
    pub starts: Vec<u32>,
    /// The lists, end to end.
    pub neighbours: Vec<u32>,
}

impl Adjacency {
    /// Neighbours of a node; empty for a node that does not exist.
    pub fn of(&self, node: u32) -> &[u32] {
        match (self.starts.get(node as usize), self.starts.get(node as usize + 1)) {
            (Some(&start), Some(&end)) => &self.neighbours[start as usize..end as usize],
            _ => &[],
        }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Empty lists with space for `counts[node]` entries each.
    fn with_counts(counts: impl Iterator<Item = u32>) -> Adjacency {
        let mut starts = vec![0];
        let mut end = 0;
        for count in counts {
            end += count;
            starts.push(end);
        }
        Adjacency { starts, neighbours: vec![0; end as usize] }
    }
}

/// For each of `nodes` nodes, lists the nodes that share an edge with it, ascending and without repetition.
///
/// # Errors
/// [`MeshError::IndexOutOfRange`] if an edge names a node that does not exist.
pub fn node_neighbours(edges: &[[u32; 2]], nodes: usize) -> Result<Adjacency, MeshError> {
    crate::mesh::limit_nodes(nodes as u64)?;
    let mut pairs = Vec::with_capacity(2 * edges.len());
    for (index, &[a, b]) in edges.iter().enumerate() {
        if let Some(&node) = [a, b].iter().find(|&&node| node as usize >= nodes) {
            return Err(MeshError::IndexOutOfRange {
                element: crate::Element::Edge,
                index: index as u32,
                node,
                nodes: nodes as u32,
            });
        }
        pairs.push([a, b]);
        pairs.push([b, a]);
    }
    pairs.sort_unstable();
    pairs.dedup();
    let mut counts = vec![0; nodes];
    pairs.iter().for_each(|pair| counts[pair[0] as usize] += 1);
    let mut adjacency = Adjacency::with_counts(counts.into_iter());
    adjacency.neighbours = pairs.into_iter().map(|pair| pair[1]).collect();
    Ok(adjacency)
}

impl Mesh<3> {
    /// For each node of the closed triangle surface, the ring of its neighbours, counter-clockwise as seen from outside.
    ///
    /// ```text
    ///       2---1
    ///      / \ / \        ring of the middle node: 0 1 2 3 4 5, begun at its lowest node;
    ///     3---*---0       the facets around it are (*, 0, 1), (*, 1, 2), …, (*, 5, 0)
    ///      \ / \ /
    ///       4---5
    /// ```
    /// Nodes that no facet names have an empty ring.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::Open`], [`MeshError::NonManifoldEdges`], [`MeshError::NonOrientable`],
    /// [`MeshError::InconsistentOrientation`]; [`MeshError::NonManifoldNodes`] if the triangles at a node form more than one
    /// fan.
    pub fn node_rings(&self) -> Result<Adjacency, MeshError> {
        self.validate()?;
        Survey::of(&self.facets)?.closed_and_consistent()?;

        // At each corner of each triangle (a, b, c), the ring of a steps from b to c.
        let mut steps = Vec::with_capacity(3 * self.facets.len());
        for &[a, b, c] in &self.facets {
            steps.extend([[a, b, c], [b, c, a], [c, a, b]]);
        }
        steps.sort_unstable();
        let mut counts = vec![0; self.nodes()];
        steps.iter().for_each(|step| counts[step[0] as usize] += 1);
        let mut rings = Adjacency::with_counts(counts.into_iter());

        // Follow the steps around the node once. If the ring closes early, there is a second fan.
        let mut pinched = Vec::new();
        for node in 0..self.nodes() {
            let (start, end) = (rings.starts[node] as usize, rings.starts[node + 1] as usize);
            let own = &steps[start..end];
            let Some(&[_, first, _]) = own.first() else {
                continue;
            };
            let mut current = first;
            for (place, slot) in rings.neighbours[start..end].iter_mut().enumerate() {
                if place > 0 && current == first {
                    pinched.push(node as u32);
                    break;
                }
                *slot = current;
                // On a closed, consistently oriented surface, exactly one step starts from every neighbour.
                let Ok(found) = own.binary_search_by_key(&current, |step| step[1]) else {
                    break;
                };
                current = own[found][2];
            }
        }
        if pinched.is_empty() { Ok(rings) } else { Err(MeshError::NonManifoldNodes { nodes: pinched }) }
    }
}
