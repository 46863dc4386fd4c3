//! The corners and edges of the surface of an obstacle. Lines that divide a flat face into facets are not edges.

use crate::vector::{add, dot, scaled, subtract};
use core::array::from_fn;
use opruga_mesh::Mesh;

/// The angle between the normals of two facets, in radians, from which their common side counts as an edge.
const FLAT: f64 = 1e-9;

/// A surface whose points are sorted: points within plane faces come first.
pub(crate) struct Creases<const D: usize> {
    pub(crate) mesh: Mesh<D>,
    pub(crate) within_faces: usize,
    /// In space, the edges at which the surface bends or ends, ascending.
    pub(crate) edges: Vec<[u32; 2]>,
}

impl<const D: usize> Creases<D> {
    /// Finds the corners and edges. Lines and points within a plane face are not among them. If a body lies on the face, contact
    /// of its nodes with the face already holds it. Lines and points within the face would hold the body a second time, along a
    /// normal that rounding errors have rotated.
    pub(crate) fn of(mut mesh: Mesh<D>) -> Creases<D> {
        // The sides of every facet and wire, and the corner opposite to each; in the plane sides are points.
        let mut sides: Vec<([u32; 2], u32)> = Vec::new();
        let facets = mesh.facets.iter().map(|facet| &facet[..]).chain(mesh.sheets.iter().map(|facet| &facet[..]));
        for facet in facets.chain(mesh.wires.iter().map(|wire| &wire[..])) {
            match *facet {
                [a, b] if D == 2 => sides.extend([([a, a], b), ([b, b], a)]),
                [a, b] => sides.push(([a.min(b), a.max(b)], u32::MAX)),
                [a, b, c] => {
                    let side = |a: u32, b: u32, c: u32| ([a.min(b), a.max(b)], c);
                    sides.extend([side(a, b, c), side(b, c, a), side(c, a, b)]);
                }
                _ => {}
            }
        }
        sides.sort_unstable();
        let mut is_corner: Vec<bool> = vec![sides.is_empty(); mesh.positions.len()];
        let mut edges = Vec::new();
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            let [a, b] = same[0].0;
            let is_flat = same.len() == 2 && same.iter().all(|(_, opposite)| *opposite != u32::MAX) && {
                let [first, second] = [0, 1].map(|k| arm(&mesh.positions, [a, b], same[k].1));
                let turn = add(&first, &second);
                dot(&turn, &turn) < FLAT * FLAT
            };
            if !is_flat {
                edges.push([a, b]);
                is_corner[a as usize] = true;
                is_corner[b as usize] = true;
            }
        }
        // Unused points are omitted.
        let mut is_used = is_corner.clone();
        sides.iter().for_each(|(side, _)| side.iter().for_each(|p| is_used[*p as usize] = true));
        let mut order: Vec<u32> = (0..mesh.positions.len() as u32).filter(|p| is_used[*p as usize]).collect();
        order.sort_by_key(|p| is_corner[*p as usize]);
        let within_faces = order.iter().filter(|p| !is_corner[**p as usize]).count();
        let mut number = vec![0; is_used.len()];
        order.iter().zip(0..).for_each(|(p, at)| number[*p as usize] = at);
        mesh.positions = order.iter().map(|p| mesh.positions[*p as usize]).collect();
        mesh.facets.iter_mut().flatten().for_each(|p| *p = number[*p as usize]);
        mesh.sheets.iter_mut().flatten().for_each(|p| *p = number[*p as usize]);
        mesh.wires.iter_mut().flatten().for_each(|p| *p = number[*p as usize]);
        let mut edges: Vec<[u32; 2]> = edges.into_iter().map(|edge| edge.map(|p| number[p as usize])).collect();
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        if D == 2 {
            edges.clear();
        }
        Creases { mesh, within_faces, edges }
    }
}

/// The unit vector from a side to the corner opposite to it, perpendicular to the side.
fn arm<const D: usize>(positions: &[[f64; D]], [a, b]: [u32; 2], opposite: u32) -> [f64; D] {
    let [a, b, c] = [a, b, opposite].map(|p| positions[p as usize]);
    let (along, to) = (subtract(&b, &a), subtract(&c, &a));
    let square = dot(&along, &along);
    let part = if square > 0.0 { dot(&to, &along) / square } else { 0.0 };
    let arm: [f64; D] = from_fn(|d| to[d] - part * along[d]);
    scaled(&arm, 1.0 / dot(&arm, &arm).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plate_cut_into_triangles_has_corners_and_edges_at_its_border_alone() {
        // Nine points of a square, the fifth of them inside; triangles with either orientation.
        let positions = (0..9).map(|k| [f64::from(k % 3), 0.3 * f64::from(k % 3), f64::from(k / 3)]).collect();
        let cells = [0, 1, 3, 4].into_iter();
        let sheets = cells.flat_map(|k: u32| [[k, k + 1, k + 4], [k, k + 3, k + 4]]).collect();
        let creases = Creases::<3>::of(Mesh { positions, sheets, ..Mesh::default() });
        assert_eq!((creases.within_faces, creases.edges.len()), (1, 8));
        assert_eq!(creases.mesh.positions[0], [1.0, 0.3, 1.0]);
        assert!(creases.edges.iter().flatten().all(|p| *p > 0));
    }

    #[test]
    fn a_line_has_corners_where_it_turns_and_ends() {
        let positions = vec![[0.0, 0.0], [1.0, 0.5], [2.0, 1.0], [3.0, 0.0]];
        let wires = vec![[0, 1], [1, 2], [2, 3]];
        let creases = Creases::<2>::of(Mesh { positions, wires, ..Mesh::default() });
        assert_eq!((creases.within_faces, creases.mesh.positions[0]), (1, [1.0, 0.5]));
        assert!(creases.edges.is_empty());
    }
}
