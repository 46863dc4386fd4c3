//! The hinges of surfaces and the triples of chains at which a body bends.

use crate::geometry::ascending;
use crate::{Mesh, MeshError};

/// For each edge that two triangles share, the four nodes [a, b, c, d] of the hinge, in the order of (|b − a|, lower node), as in [`Mesh::edges`].
///
/// ```text
///         c
///        / \          a–b  the shared edge, the hinge
///       /   \         c    opposite node in the triangle of lower index, which runs a → b → c
///      a-----b        d    opposite node in the other triangle, which runs b → a → d
///       \   /
///        \ /
///         d
/// ```
/// Border edges have no hinge. If the two triangles have opposite orientations, the numbering follows the first.
///
/// # Errors
/// [`MeshError::NonManifoldEdges`] if more than two triangles share an edge.
pub fn hinges(triangles: &[[u32; 3]]) -> Result<Vec<[u32; 4]>, MeshError> {
    // Each side of each triangle: edge, triangle, opposite node, and whether it runs from the lower node to the higher.
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (index, &[a, b, c]) in triangles.iter().enumerate() {
        for (p, q, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
            sides.push((ascending(p, q), index as u32, opposite, p < q));
        }
    }
    sides.sort_unstable_by_key(|&(edge, index, ..)| (edge[1] - edge[0], edge[0], index));

    let mut list = Vec::with_capacity(sides.len() / 2);
    let mut crowded = Vec::new();
    for group in sides.chunk_by(|p, q| p.0 == q.0) {
        match *group {
            [_] => {}
            [([low, high], _, c, forward), (_, _, d, _)] => {
                list.push(if forward { [low, high, c, d] } else { [high, low, c, d] })
            }
            _ => crowded.push(group[0].0),
        }
    }
    crowded.sort_unstable();
    if crowded.is_empty() { Ok(list) } else { Err(MeshError::NonManifoldEdges { edges: crowded }) }
}

/// For each node between exactly two edges of a chain, the triple [previous, middle, next], in ascending order of the middle node.
///
/// ```text
///     previous ---> middle ---> next
/// ```
/// The direction of the edges determines the previous node. If both edges start or both end at the middle node, the lower node is the previous one.
/// Free ends and branching nodes have no triple.
pub fn bends(edges: &[[u32; 2]]) -> Vec<[u32; 3]> {
    // Each end of each edge: its node, whether the edge starts there, and the node at the other end. Edges that end at the node
    // come first.
    let mut ends = Vec::with_capacity(2 * edges.len());
    for &[a, b] in edges {
        ends.push((a, true, b));
        ends.push((b, false, a));
    }
    ends.sort_unstable();
    let mut list = Vec::with_capacity(edges.len());
    for group in ends.chunk_by(|p, q| p.0 == q.0) {
        if let [(middle, _, previous), (_, _, next)] = *group {
            list.push([previous, middle, next]);
        }
    }
    list
}

impl<const D: usize> Mesh<D> {
    /// The hinges of the boundary (space only), then those of the sheets; see [`hinges`] for the figure.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`], and [`MeshError::NonManifoldEdges`].
    pub fn hinges(&self) -> Result<Vec<[u32; 4]>, MeshError> {
        self.validate()?;
        let mut list = hinges(&self.facet_triangles())?;
        list.extend(hinges(&self.sheets)?);
        Ok(list)
    }

    /// The bending triples of the outline (plane only), then those of the wires; see [`bends`].
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`].
    pub fn bends(&self) -> Result<Vec<[u32; 3]>, MeshError> {
        self.validate()?;
        let mut list = Vec::new();
        if D == 2 {
            let outline: Vec<[u32; 2]> = self.facets.iter().map(|facet| [facet[0], facet[1]]).collect();
            list = bends(&outline);
        }
        list.extend(bends(&self.wires));
        Ok(list)
    }
}
