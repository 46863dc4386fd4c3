//! The part of a body that touches others: points, facets and wires, where a point may be a fixed combination of nodes.

use crate::geometry::HEXAHEDRON_FACES;
use crate::{Mesh, Skin};

/// A fixed combination of at most four nodes: x = Σ wᵢ xᵢ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carrier {
    /// The nodes. Unused entries repeat another node with weight 0.
    pub nodes: [u32; 4],
    /// The weights wᵢ of these nodes, which add up to 1.
    pub weights: [f64; 4],
}

/// The surface with which a body touches others.
///
/// Points are numbered in this order: `nodes` first, then `carried`.
///
/// ```text
///  face of a hexahedron     d---c      four triangles about the mean m of its nodes:
///                           |\ /|      the surface follows every node alike, also where it is not plane
///                           | m |
///                           |/ \|
///                           a---b
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TouchingSurface<const D: usize> {
    /// Nodes that are points, ascending. In this list, nodes that only carry points come first.
    pub nodes: Vec<u32>,
    /// The number of nodes that only carry points.
    pub carrying: usize,
    /// Points whose positions follow from those of nodes. The nodes are given by their numbers as points.
    pub carried: Vec<Carrier>,
    /// The corners of every facet, as points. The facets of closed boundaries come first, then those of open surfaces and, in the plane, those of
    /// wires.
    pub facets: Vec<[u32; D]>,
    /// The number of facets that belong to closed boundaries.
    pub closed: usize,
    /// Wires in space, as points.
    pub wires: Vec<[u32; 2]>,
}

impl<const D: usize> TouchingSurface<D> {
    /// The number of points, including nodes that only carry points.
    pub fn points(&self) -> usize {
        self.nodes.len() + self.carried.len()
    }

    /// The positions of the points when the nodes of the body are at `positions` [m].
    pub fn positions(&self, positions: &[[f64; D]]) -> Vec<[f64; D]> {
        let mut out: Vec<[f64; D]> = self.nodes.iter().map(|node| positions[*node as usize]).collect();
        for carrier in &self.carried {
            let mut sum = [0.0; D];
            for (node, weight) in carrier.nodes.iter().zip(&carrier.weights) {
                (0..D).for_each(|d| sum[d] += weight * out[*node as usize][d]);
            }
            out.push(sum);
        }
        out
    }

    /// Renumbers nodes as points. Before the call, facets and carriers refer to nodes of the body, and to carried points from `first` on.
    fn count(&mut self, first: u32) {
        let TouchingSurface { nodes, carrying, carried, facets, wires, .. } = self;
        let mut own: Vec<u32> = facets.iter().flatten().chain(wires.iter().flatten()).copied().collect();
        own.retain(|point| *point < first);
        let mut all: Vec<u32> = carried.iter().flat_map(|carrier| carrier.nodes).collect();
        for list in [&mut own, &mut all] {
            list.sort_unstable();
            list.dedup();
        }
        all.retain(|node| own.binary_search(node).is_err());
        *carrying = all.len();
        *nodes = all;
        nodes.extend(own);
        let (carriers, points) = nodes.split_at(*carrying);
        let index = |node: u32| match carriers.binary_search(&node) {
            Ok(found) => found as u32,
            Err(_) => (carriers.len() + points.binary_search(&node).unwrap_or(0)) as u32,
        };
        let count = nodes.len() as u32;
        let point = |point: u32| if point < first { index(point) } else { point - first + count };
        carried.iter_mut().flat_map(|carrier| &mut carrier.nodes).for_each(|node| *node = index(*node));
        facets.iter_mut().flatten().for_each(|p| *p = point(*p));
        wires.iter_mut().flatten().for_each(|p| *p = point(*p));
    }
}

impl<const D: usize> Mesh<D> {
    /// The surface with which this body touches others: boundary, open surfaces and wires; without any of these, its nodes as points.
    ///
    /// If `skin` is set, a body that carries a skin touches with that skin instead.
    pub fn touching_surface(&self, skin: bool) -> TouchingSurface<D> {
        let first = self.positions.len() as u32;
        let mut out = TouchingSurface::default();
        if !(skin && self.skin.as_ref().is_some_and(|skin| out.take_skin(skin, first))) {
            out.take_boundary(self, first);
        }
        out.closed = out.facets.len();
        if D == 3 {
            out.facets.extend(self.sheets.iter().map(|sheet| core::array::from_fn(|k| sheet[k])));
            out.wires.extend(&self.wires);
        } else {
            out.facets.extend(self.wires.iter().map(|wire| core::array::from_fn(|k| wire[k])));
        }
        out.count(first);
        if out.points() == 0 && self.cells.is_empty() {
            out.nodes = (0..first).collect();
        }
        out
    }

    /// The faces of hexahedra that bound the body, as seen from outside.
    fn outer_quadrilaterals(&self) -> Vec<[u32; 4]> {
        let mut faces: Vec<([u32; 4], usize, [u32; 4])> = Vec::new();
        for cell in &self.cells.hexahedra {
            for face in HEXAHEDRON_FACES {
                let nodes = face.map(|corner| cell[corner]);
                let mut key = nodes;
                key.sort_unstable();
                faces.push((key, faces.len(), nodes));
            }
        }
        faces.sort_unstable();
        let mut outer: Vec<_> =
            faces.chunk_by(|p, q| p.0 == q.0).filter(|same| same.len() == 1).map(|f| f[0]).collect();
        outer.sort_unstable_by_key(|(_, order, _)| *order);
        outer.into_iter().map(|(_, _, nodes)| nodes).collect()
    }
}

impl<const D: usize> TouchingSurface<D> {
    /// Adds the facets of a body, with those of hexahedra as four triangles each.
    fn take_boundary(&mut self, mesh: &Mesh<D>, first: u32) {
        let quadrilaterals = if D == 3 { mesh.outer_quadrilaterals() } else { Vec::new() };
        // A map from any three corners to the quadrilateral.
        let mut corners: Vec<([u32; 3], u32)> = Vec::with_capacity(4 * quadrilaterals.len());
        for (number, [a, b, c, d]) in quadrilaterals.iter().copied().enumerate() {
            for mut three in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
                three.sort_unstable();
                corners.push((three, number as u32));
            }
        }
        corners.sort_unstable();
        let mut taken = vec![false; quadrilaterals.len()];
        for facet in &mesh.facets {
            let mut key = [facet[0], facet[1], facet[D - 1]];
            key.sort_unstable();
            let Ok(found) = corners.binary_search_by_key(&key, |(three, _)| *three) else {
                self.facets.push(*facet);
                continue;
            };
            let number = corners[found].1 as usize;
            if core::mem::replace(&mut taken[number], true) {
                continue;
            }
            let (nodes, middle) = (quadrilaterals[number], first + self.carried.len() as u32);
            self.carried.push(Carrier { nodes, weights: [0.25; 4] });
            for k in 0..4 {
                let triangle = [nodes[k], nodes[(k + 1) % 4], middle];
                self.facets.push(core::array::from_fn(|k| triangle[k]));
            }
        }
    }

    /// Adds a skin; returns whether it has facets.
    fn take_skin(&mut self, skin: &Skin, first: u32) -> bool {
        if D == 3 {
            self.facets.extend(skin.triangles.iter().map(|t| core::array::from_fn(|k| first + t[k])));
        } else {
            self.facets.extend(skin.outline.iter().map(|edge| core::array::from_fn(|k| first + edge[k])));
        }
        if self.facets.is_empty() {
            return false;
        }
        let points = skin.carriers.iter().zip(&skin.weights);
        self.carried.extend(points.map(|(nodes, weights)| Carrier { nodes: *nodes, weights: *weights }));
        true
    }
}
