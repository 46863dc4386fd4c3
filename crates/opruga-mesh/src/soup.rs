//! Triangles in space as they come from files: welding, orientation, closing, bodies.

use crate::boxes::Tree;
use crate::buckets::{nodes_of, sorted_by_node};
use crate::chambers::Survey;
use crate::geometry::{lift, norm, subtract, triangle_area};
use crate::{Mesh, MeshError, Must, Quantity, signed_volume};
use std::collections::BTreeMap;

/// Joins points that are at most `distance` [m] apart (0: at the same position), and makes triangles refer to the first point of each cluster.
/// Returns the number of points that were joined to another point. The remaining points keep their order.
///
/// A point joins the first earlier point that is near enough, so clusters do not grow along chains.
///
/// # Errors
/// [`MeshError::Size`] for a distance that is negative or not finite, [`MeshError::RepeatedNode`] with the first triangle that collapses; nothing is
/// then changed.
pub fn weld(positions: &mut Vec<[f64; 3]>, triangles: &mut [[u32; 3]], distance: f64) -> Result<usize, MeshError> {
    if !(distance >= 0.0 && distance.is_finite()) {
        return Err(MeshError::Size { what: Quantity::DistanceWelding, value: distance, must: Must::NotNegative });
    }
    let target = if distance == 0.0 { first_coincident(positions) } else { first_within(positions, distance) };

    // A triangle must keep three corners.
    for (index, triangle) in triangles.iter().enumerate() {
        let [a, b, c] = triangle.map(|node| target[node as usize]);
        if a == b || b == c || c == a {
            let node = if a == b || c == a { a } else { b };
            return Err(MeshError::RepeatedNode { element: crate::Element::Facet, index: index as u32, node });
        }
    }
    let mut numbers = vec![0u32; positions.len()];
    let mut kept = 0u32;
    for node in 0..positions.len() {
        if target[node] as usize == node {
            numbers[node] = kept;
            positions[kept as usize] = positions[node];
            kept += 1;
        }
    }
    let joined = positions.len() - kept as usize;
    positions.truncate(kept as usize);
    triangles.iter_mut().flatten().for_each(|node| *node = numbers[target[*node as usize] as usize]);
    Ok(joined)
}

/// For every point, the first point with the same coordinates; −0 equals 0.
fn first_coincident(positions: &[[f64; 3]]) -> Vec<u32> {
    const FREE: u32 = u32::MAX;
    let key = |node: u32| positions[node as usize].map(|x| (x + 0.0).to_bits());
    // The first point at each position, in a hash slot given by its coordinates or in the next free one. Most positions of a soup occur several
    // times, and close together in the list.
    let slots = (2 * positions.len()).next_power_of_two();
    let mut firsts = vec![FREE; slots];
    let slot_of = |[x, y, z]: [u64; 3]| {
        // Every step is invertible, so coordinates collide only by chance.
        let mix = |sum: u64, x: u64| (sum ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        (mix(mix(mix(0, x), y), z) >> 20) as usize & (slots - 1)
    };
    let mut first_of = |node: u32| {
        let own = key(node);
        let mut slot = slot_of(own);
        loop {
            match firsts[slot] {
                FREE => {
                    firsts[slot] = node;
                    return node;
                }
                first if key(first) == own => return first,
                _ => slot = (slot + 1) & (slots - 1),
            }
        }
    };
    (0..positions.len() as u32).map(&mut first_of).collect()
}

/// For every point, the first earlier point within `distance` that was not itself joined to another point; if there is none, the point itself.
fn first_within(positions: &[[f64; 3]], distance: f64) -> Vec<u32> {
    let cell = |x: f64| (x / distance).floor();
    let mut cells: BTreeMap<[i64; 3], Vec<u32>> = BTreeMap::new();
    let mut target = Vec::with_capacity(positions.len());
    for (node, position) in positions.iter().enumerate() {
        let [i, j, k] = position.map(|x| cell(x) as i64);
        let mut found: Option<u32> = None;
        for x in -1..=1 {
            for y in -1..=1 {
                for z in -1..=1 {
                    let key = [i.saturating_add(x), j.saturating_add(y), k.saturating_add(z)];
                    for &other in cells.get(&key).into_iter().flatten() {
                        let close = norm(subtract(positions[other as usize], *position)) <= distance;
                        if close && found.is_none_or(|best| other < best) {
                            found = Some(other);
                        }
                    }
                }
            }
        }
        match found {
            Some(other) => target.push(other),
            None => {
                cells.entry([i, j, k]).or_default().push(node as u32);
                target.push(node as u32);
            }
        }
    }
    target
}

/// The changes that were made to orient the triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// The number of triangles that were oriented against their neighbours.
    pub against: usize,
    /// The number of components that were inside out.
    pub inside_out: usize,
    /// A triangle of the first component whose enclosed volume is less than 10⁻¹² of its cubed extent, and that volume [m³].
    pub flat: Option<(u32, f64)>,
}

/// A component is flat if its enclosed volume is less than this fraction of its cubed extent.
const FLAT: f64 = 1e-12;

impl<const D: usize> Mesh<D> {
    /// Drops nodes that no element uses; returns their number. These nodes are also removed from groups. The carriers of a skin are nodes of
    /// elements.
    pub fn drop_unreferenced(&mut self) -> usize {
        let mut used = vec![false; self.nodes()];
        for (_, _, nodes) in self.elements() {
            nodes.iter().for_each(|node| used[*node as usize] = true);
        }
        let dropped = used.iter().filter(|u| !**u).count();
        if dropped == 0 {
            return 0;
        }
        let mut numbers = vec![u32::MAX; used.len()];
        let mut kept = 0;
        for node in 0..used.len() {
            if used[node] {
                numbers[node] = kept;
                self.positions[kept as usize] = self.positions[node];
                kept += 1;
            }
        }
        self.positions.truncate(kept as usize);
        let renumber = |node: &mut u32| *node = numbers[*node as usize];
        self.facets.iter_mut().flatten().for_each(renumber);
        self.wires.iter_mut().flatten().for_each(renumber);
        self.sheets.iter_mut().flatten().for_each(renumber);
        self.sheet_quadrilaterals.iter_mut().flatten().for_each(renumber);
        self.cells.nodes_mut().for_each(renumber);
        self.skin.iter_mut().flat_map(|skin| &mut skin.carriers).flatten().for_each(renumber);
        for nodes in self.groups.values_mut() {
            nodes.retain(|node| used[*node as usize]);
            nodes.iter_mut().for_each(renumber);
        }
        for field in self.node_values.values_mut() {
            let rows = field.values.chunks_exact(field.components.max(1)).zip(&used);
            field.values = rows.filter(|(_, used)| **used).flat_map(|(row, _)| row).copied().collect();
        }
        dropped
    }
}

impl Mesh<3> {
    /// Orients the triangles of every closed component outward, and those of cavities (with an odd number of components around them) inward.
    ///
    /// # Errors
    /// The errors of [`Mesh::orient_outward`]. The mesh is then unchanged.
    pub fn orient_components(&mut self) -> Result<Turned, MeshError> {
        self.validate()?;
        let survey = Survey::of(&self.facets)?;
        survey.closed()?;
        for facet in survey.minority() {
            self.facets[*facet as usize].swap(0, 1);
        }
        let components = self.components_of(&survey);
        // The number of other components around a component, from their winding numbers about one of its nodes, independent of their orientation.
        let boxes: Vec<([f64; 3], [f64; 3])> = components.iter().map(|c| self.bounds_of(&c.facets)).collect();
        let tree = Tree::of(boxes.iter().map(|(low, high)| [*low, *high, *high]));
        let (mut inside_out, mut flat) = (0, None);
        for (number, component) in components.iter().enumerate() {
            let node = self.facets[component.facets[0] as usize][0];
            let point = self.positions[node as usize];
            let around = |other: &u32| {
                *other as usize != number && {
                    let facets = self.gather(&components[*other as usize].facets);
                    let winding = crate::chambers::winding_number(&facets, &self.positions, &point);
                    winding.abs() > 0.5
                }
            };
            let cavity = tree.around(&point).iter().filter(|other| around(other)).count() % 2 == 1;
            if (component.signed_volume < 0.0) != cavity {
                inside_out += 1;
                component.facets.iter().for_each(|facet| self.facets[*facet as usize].swap(0, 1));
            }
            let (low, high) = boxes[number];
            let extent = (0..3).map(|d| high[d] - low[d]).fold(0.0, |most, x| if x > most { x } else { most });
            if flat.is_none() && component.signed_volume.abs() <= FLAT * extent * extent * extent {
                flat = Some((component.facets[0], component.signed_volume));
            }
        }
        Ok(Turned { against: survey.minority().len(), inside_out, flat })
    }

    /// Lowest and highest coordinates of some facets [m].
    fn bounds_of(&self, facets: &[u32]) -> ([f64; 3], [f64; 3]) {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for node in facets.iter().flat_map(|facet| self.facets[*facet as usize]) {
            for d in 0..3 {
                let x = self.positions[node as usize][d];
                if x < low[d] {
                    low[d] = x;
                }
                if x > high[d] {
                    high[d] = x;
                }
            }
        }
        (low, high)
    }

    /// Orients the triangles of open surfaces so that neighbours agree; the majority of each component decides. Returns the number of reversed
    /// triangles.
    ///
    /// # Errors
    /// [`MeshError::NonManifoldEdges`], [`MeshError::NonOrientable`].
    pub fn orient_alike(&mut self) -> Result<usize, MeshError> {
        let survey = Survey::of(&self.facets)?;
        survey.minority().iter().for_each(|facet| self.facets[*facet as usize].swap(0, 1));
        Ok(survey.minority().len())
    }

    /// Closes every free boundary with a fan of triangles around the mean of its nodes, which becomes a new node; returns the number of closed
    /// boundaries.
    ///
    /// # Errors
    /// The errors of the orientation, and [`MeshError::NonManifoldNodes`] if a free boundary touches itself.
    pub fn cap(&mut self) -> Result<usize, MeshError> {
        self.orient_alike()?;
        // Free edges run in the opposite direction to the boundary of the hole: from each node to the next.
        let mut sides: Vec<[u32; 2]> =
            self.facets.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]).collect();
        sides.sort_unstable();
        let free: Vec<[u32; 2]> =
            sides.iter().copied().filter(|[a, b]| sides.binary_search(&[*b, *a]).is_err()).collect();
        let twice: Vec<u32> = free.windows(2).filter(|pair| pair[0][0] == pair[1][0]).map(|pair| pair[0][0]).collect();
        if !twice.is_empty() {
            return Err(MeshError::NonManifoldNodes { nodes: twice });
        }
        let (mut closed, mut taken) = (0, vec![false; free.len()]);
        for start in 0..free.len() {
            if taken[start] {
                continue;
            }
            let mut ring = Vec::new();
            let mut at = free[start][0];
            while let Ok(index) = free.binary_search_by_key(&at, |edge| edge[0]) {
                if core::mem::replace(&mut taken[index], true) {
                    break;
                }
                let [from, to] = free[index];
                ring.push(from);
                at = to;
            }
            let n = ring.len() as f64;
            let mean =
                core::array::from_fn(|d| ring.iter().map(|node| self.positions[*node as usize][d]).sum::<f64>() / n);
            let center = self.positions.len() as u32;
            self.positions.push(mean);
            for (k, from) in ring.iter().enumerate() {
                self.facets.push([ring[(k + 1) % ring.len()], *from, center]);
            }
            closed += 1;
        }
        Ok(closed)
    }

    /// The first triangle whose area is below `fraction` of its longest edge squared, with its area [m²].
    pub fn thin_facet(&self, fraction: f64) -> Option<(u32, f64)> {
        self.facets.iter().enumerate().find_map(|(index, facet)| {
            let [a, b, c] = facet.map(|node| lift(&self.positions[node as usize]));
            let area = triangle_area(a, b, c);
            let mut longest = norm(subtract(b, a));
            for other in [norm(subtract(c, b)), norm(subtract(a, c))] {
                if other > longest {
                    longest = other;
                }
            }
            (area <= fraction * longest * longest).then_some((index as u32, area))
        })
    }

    /// The first two triangles with the same nodes.
    pub fn duplicate_facets(&self) -> Option<[u32; 2]> {
        let mut keys: Vec<([u32; 3], u32)> = Vec::with_capacity(self.facets.len());
        for (index, facet) in self.facets.iter().enumerate() {
            let mut key = *facet;
            key.sort_unstable();
            keys.push((key, index as u32));
        }
        let keys = sorted_by_node(&keys, nodes_of(&self.facets), |(key, _)| key[0]);
        keys.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]).min_by_key(|p| p[1])
    }

    /// Nodes of a closed surface, ascending, at which several parts meet that have no common edge at the node.
    pub fn pinched_nodes(&self) -> Vec<u32> {
        // Every facet at a node connects one neighbour to another. If they form a single loop, no facet remains.
        let mut links: Vec<[u32; 3]> = Vec::with_capacity(3 * self.facets.len());
        for [a, b, c] in &self.facets {
            links.extend([[*a, *b, *c], [*b, *c, *a], [*c, *a, *b]]);
        }
        let links = sorted_by_node(&links, nodes_of(&self.facets), |link| link[0]);
        let mut pinched = Vec::new();
        for around in links.chunk_by(|p, q| p[0] == q[0]) {
            let mut at = around[0][1];
            let mut steps = 0;
            while let Ok(index) = around.binary_search_by_key(&at, |link| link[1]) {
                at = around[index][2];
                steps += 1;
                if at == around[0][1] || steps > around.len() {
                    break;
                }
            }
            if steps != around.len() {
                pinched.push(around[0][0]);
            }
        }
        pinched
    }

    /// Volume that the facets enclose [m³], positive for outward ones.
    pub fn enclosed_volume(&self) -> f64 {
        signed_volume(&self.facets, &self.positions)
    }
}
