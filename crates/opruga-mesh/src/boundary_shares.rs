//! How much of a part of the boundary belongs to each node: what makes forces of an even traction.

use crate::Mesh;
use crate::geometry::{lift, norm, subtract, triangle_area};
use crate::quadratic::{TETRAHEDRON_FACES, TRIANGLE_SIDES};
use std::collections::{BTreeMap, BTreeSet};

/// The part of a quadratic face that goes from each corner to the nodes between the corners.
///
/// ```text
/// edge      ¼ – ½ – ¼  as two edges,         1/6 – 2/3 – 1/6  by its shape functions
/// triangle  1/12 and 1/4 as four triangles,  0 and 1/3        by its shape functions
/// ```
const FROM_CORNER: f64 = 1.0 / 12.0;

impl<const D: usize> Mesh<D> {
    /// The shares ∫ Nₐ dA of nodes in the facets all of whose nodes are selected, at rest: lengths [m] in the plane, areas [m²] in space.
    ///
    /// Linear facets give equal shares to their nodes; the sides of quadratic cells what their shape functions say, as long as they are straight. An
    /// even traction times the shares does on any linear displacement, and on the quadratic ones of such cells, the work that it does on the body.
    ///
    /// Nodes without a share are left out. Nodes beyond the mesh select nothing.
    pub fn boundary_shares(&self, selected: &[u32]) -> BTreeMap<u32, f64> {
        let mut chosen = vec![false; self.nodes()];
        for node in selected {
            if let Some(entry) = chosen.get_mut(*node as usize) {
                *entry = true;
            }
        }
        let size = |nodes: &[u32]| {
            let at = |k: usize| lift(&self.positions[nodes[k] as usize]);
            if D == 2 { norm(subtract(at(1), at(0))) } else { triangle_area(at(0), at(1), at(2)) }
        };
        let mut shares = BTreeMap::new();
        let mut known = BTreeSet::new();
        for facet in self.facets.iter().filter(|facet| facet.iter().all(|node| chosen[*node as usize])) {
            let share = size(facet) / D as f64;
            facet.iter().for_each(|node| *shares.entry(*node).or_insert(0.0) += share);
            let mut key = facet.to_vec();
            key.sort_unstable();
            known.insert(key);
        }

        // Sides of quadratic cells: corners, then the nodes between them.
        let triangles = self.cells.quadratic_triangles.iter().flat_map(|cell| {
            (0..3).map(move |side| (TRIANGLE_SIDES[side].map(|c| cell[c]).to_vec(), vec![cell[3 + side]]))
        });
        let tetrahedra = self.cells.quadratic_tetrahedra.iter().flat_map(|cell| {
            TETRAHEDRON_FACES.map(|face| {
                let nodes = face.map(|k| cell[k]);
                (nodes[..3].to_vec(), nodes[3..].to_vec())
            })
        });
        for (corners, middles) in triangles.chain(tetrahedra) {
            // Its part at the first corner is a facet of the boundary where the side is.
            let mut key = vec![corners[0], middles[0]];
            key.extend(middles.get(2));
            key.sort_unstable();
            if !known.contains(&key) || corners.iter().any(|node| !chosen[*node as usize]) {
                continue;
            }
            let moved = FROM_CORNER * size(&corners);
            for node in &corners {
                *shares.entry(*node).or_insert(0.0) -= moved;
            }
            let received = moved * corners.len() as f64 / middles.len() as f64;
            for node in &middles {
                *shares.entry(*node).or_insert(0.0) += received;
            }
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The work of an even traction on x², which linear cells take as linear between nodes.
    #[test]
    fn shares_of_quadratic_sides_integrate_quadratic_motion() {
        let plane = Mesh::<2>::grid([0.0; 2], [1.0, 2.0], [2, 3]).unwrap().into_simplices().unwrap();
        let plane = plane.into_quadratic().unwrap();
        let top = plane.boundary_shares(&plane.groups["top"]);
        assert!((top.values().sum::<f64>() - 1.0).abs() < 1e-14);
        let work: f64 = top
            .iter()
            .map(|(node, share)| plane.positions[*node as usize][0] * plane.positions[*node as usize][0] * share)
            .sum();
        assert!((work - 1.0 / 3.0).abs() < 1e-14, "{work}");

        let space = Mesh::<3>::grid([0.0; 3], [1.0, 2.0, 1.5], [2, 1, 3]).unwrap().into_simplices().unwrap();
        let space = space.into_quadratic().unwrap();
        let top = space.boundary_shares(&space.groups["top"]);
        assert!((top.values().sum::<f64>() - 1.5).abs() < 1e-14);
        let work: f64 = top
            .iter()
            .map(|(node, share)| {
                let [x, _, z] = space.positions[*node as usize];
                (x * x + x * z) * share
            })
            .sum();
        // ∫₀¹∫₀^1.5 x² + xz dz dx.
        assert!((work - (0.5 + 0.5 * 1.125)).abs() < 1e-13, "{work}");
        // Corners of triangles have no share.
        let corner = space.positions.iter().position(|x| *x == [0.5, 2.0, 0.5]).unwrap() as u32;
        assert!(top[&corner].abs() < 1e-15);
    }

    #[test]
    fn facets_that_are_not_selected_whole_give_nothing() {
        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
        assert!(mesh.boundary_shares(&[0, 99]).is_empty());
        assert_eq!(mesh.boundary_shares(&[0, 1]), BTreeMap::from([(0, 0.25), (1, 0.25)]));
    }
}
