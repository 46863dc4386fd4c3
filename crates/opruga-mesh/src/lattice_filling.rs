//! The inside of a closed surface as a lattice of tetrahedra.

use crate::geometry::ascending;
use crate::lattice_bcc::{Key, Lattice};
use crate::skin::{Inside, Skin, refined, weights};
use crate::{Mesh, MeshError};
use std::collections::BTreeMap;

impl Mesh<3> {
    /// The approximate number of nodes of [`Mesh::lattice_filling`] or [`Mesh::tetrahedra_filling`] for this surface.
    pub fn lattice_estimate(&self, spacing: f64) -> f64 {
        let mut area = 0.0;
        for facet in &self.facets {
            let [a, b, c] = facet.map(|node| self.positions[node as usize]);
            area += crate::geometry::triangle_area(a, b, c);
        }
        let nodes =
            2.0 * self.enclosed_volume().abs() / (spacing * spacing * spacing) + 2.0 * area / (spacing * spacing);
        crate::mesh::estimated(nodes)
    }

    /// The inside of this closed surface as a body of equal tetrahedra, which carries the surface as its [`Skin`].
    ///
    /// The nodes are the body-centred cubic lattice of cubes of side `spacing` [m]: corners and centres. The tetrahedra of the lattice are congruent;
    /// each has two edges of length a (one between centres, and one along cubes) and four edges of length √3/2·a. A tetrahedron is kept if its centre
    /// is inside the surface or if it contains a node of the surface. Tetrahedra around edges at which the body would otherwise only touch itself are
    /// kept too. The body therefore extends slightly beyond the surface; the skin shows the surface itself.
    ///
    /// # Errors
    /// The errors of [`Mesh::components`]; [`MeshError::Size`] for a spacing that is not positive; [`MeshError::TooManyNodes`], also for a surface
    /// whose box is too large for the spacing.
    ///
    /// # Source
    /// F. Labelle, J. R. Shewchuk, "Isosurface stuffing", ACM Trans. Graphics 26 (2007), section 3.
    pub fn lattice_filling(&self, spacing: f64) -> Result<Mesh<3>, MeshError> {
        let lattice = Lattice::around(self, spacing)?;
        let inside = Inside::of(self)?;

        // Tetrahedra that contain a point of the skin.
        let mut kept: BTreeMap<[Key; 4], ()> = BTreeMap::new();
        let mut holders: Vec<[Key; 4]> = Vec::with_capacity(self.nodes());
        for position in &self.positions {
            let holder = holder(*position, &lattice);
            kept.insert(holder, ());
            holders.push(holder);
        }
        // Tetrahedra whose centre is inside.
        for center in lattice.centers() {
            for axis in 0..3 {
                for tetrahedron in lattice.beyond(center, axis) {
                    let corners = tetrahedron.map(|key| lattice.at(key));
                    let middle = core::array::from_fn(|d| 0.25 * corners.iter().map(|c| c[d]).sum::<f64>());
                    if inside.contains(middle) {
                        kept.insert(tetrahedron, ());
                    }
                }
            }
        }
        let (keys, mut mesh) = loop {
            let (keys, mesh) = body(&kept, &lattice)?;
            // If parts of the body touch only along an edge, the tetrahedra around that edge are added.
            let crowded = crowded_edges(&mesh.facets);
            if crowded.is_empty() {
                break (keys, mesh);
            }
            for edge in crowded {
                let edge = edge.map(|node| keys[node as usize]);
                kept.extend(around_edge(edge, &lattice).into_iter().map(|tetrahedron| (tetrahedron, ())));
            }
        };
        let number = |key: &Key| number(&keys, key);
        // A surface coarser than the lattice could not follow its deformation, so points are added that only pictures show.
        let (points, triangles) = refined(&self.positions, &self.facets, spacing);
        holders.extend(points.iter().skip(holders.len()).map(|point| kept_holder(*point, &kept, &lattice)));
        let mut skin = Skin { triangles, ..Skin::default() };
        for (position, holder) in points.iter().zip(&holders) {
            skin.carriers.push(holder.map(|key| number(&key)));
            skin.weights.push(weights(holder.map(|key| lattice.at(key)), *position));
        }
        mesh.skin = Some(skin);
        Ok(mesh)
    }

    /// Lowest and highest coordinates [m]; zeros without nodes.
    pub fn bounds(&self) -> ([f64; 3], [f64; 3]) {
        let first = self.positions.first().copied().unwrap_or([0.0; 3]);
        let (mut low, mut high) = (first, first);
        for position in &self.positions {
            for d in 0..3 {
                if position[d] < low[d] {
                    low[d] = position[d];
                }
                if position[d] > high[d] {
                    high[d] = position[d];
                }
            }
        }
        (low, high)
    }
}

/// The nodes of tetrahedra in the order of the lattice, with z varying slowest, and their mesh.
fn body(kept: &BTreeMap<[Key; 4], ()>, lattice: &Lattice) -> Result<(Vec<Key>, Mesh<3>), MeshError> {
    let mut keys: Vec<Key> = kept.keys().flatten().copied().collect();
    keys.sort_unstable_by_key(|[x, y, z]| (*z, *y, *x));
    keys.dedup();
    let mut mesh = Mesh::<3> { positions: keys.iter().map(|key| lattice.at(*key)).collect(), ..Mesh::default() };
    mesh.cells.tetrahedra = kept.keys().map(|tetrahedron| tetrahedron.map(|key| number(&keys, &key))).collect();
    mesh.facets = mesh.facets_from_cells()?;
    Ok((keys, mesh))
}

/// The node number of a lattice point.
fn number(keys: &[Key], key: &Key) -> u32 {
    keys.binary_search_by_key(&(key[2], key[1], key[0]), |[x, y, z]| (*z, *y, *x)).unwrap_or(0) as u32
}

/// Edges at which more than two facets meet.
fn crowded_edges(facets: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> =
        facets.iter().flat_map(|[a, b, c]| [(*a, *b), (*b, *c), (*c, *a)]).map(|(a, b)| ascending(a, b)).collect();
    edges.sort_unstable();
    edges.chunk_by(|p, q| p == q).filter(|group| group.len() > 2).map(|group| group[0]).collect()
}

/// All tetrahedra of the lattice that contain both ends of an edge.
fn around_edge(edge: [Key; 2], lattice: &Lattice) -> Vec<[Key; 4]> {
    let mut found = Vec::new();
    // Coordinates of centres are odd; the relevant centres are at most two steps away.
    let centers_around = |x: i32| (x - 3..=x + 3).filter(|c| c.rem_euclid(2) == 1);
    for z in centers_around(edge[0][2]) {
        for y in centers_around(edge[0][1]) {
            for x in centers_around(edge[0][0]) {
                for axis in 0..3 {
                    let four = lattice.beyond([x, y, z], axis);
                    found.extend(
                        four.into_iter().filter(|tetrahedron| edge.iter().all(|key| tetrahedron.contains(key))),
                    );
                }
            }
        }
    }
    found
}

/// The tetrahedron of the body that contains a point; if there is none, the nearby tetrahedron in which the smallest weight of the point is largest.
fn kept_holder(point: [f64; 3], kept: &BTreeMap<[Key; 4], ()>, lattice: &Lattice) -> [Key; 4] {
    let ideal = holder(point, lattice);
    if kept.contains_key(&ideal) {
        return ideal;
    }
    let cube = cube_of(point, lattice);
    let mut best = (ideal, f64::NEG_INFINITY);
    for shift in 0..125 {
        let center: [i32; 3] =
            core::array::from_fn(|d| 2 * (cube[d] + [shift % 5, shift / 5 % 5, shift / 25][d] - 2) + 1);
        for tetrahedron in (0..3).flat_map(|axis| lattice.beyond(center, axis)) {
            if kept.contains_key(&tetrahedron) {
                let least = least_weight(&tetrahedron, point, lattice);
                if least > best.1 {
                    best = (tetrahedron, least);
                }
            }
        }
    }
    best.0
}

/// The cube of the lattice that contains a point.
fn cube_of(point: [f64; 3], lattice: &Lattice) -> [i32; 3] {
    core::array::from_fn(|d| ((point[d] - lattice.origin[d]) / lattice.spacing).floor() as i32)
}

/// The smallest weight of a point in a tetrahedron; negative outside.
fn least_weight(tetrahedron: &[Key; 4], point: [f64; 3], lattice: &Lattice) -> f64 {
    let weights = weights(tetrahedron.map(|key| lattice.at(key)), point);
    weights.into_iter().fold(f64::INFINITY, |m, w| if w < m { w } else { m })
}

/// The tetrahedron of the lattice that contains a point: the one around the point's cube in which the smallest weight of the point is largest.
fn holder(point: [f64; 3], lattice: &Lattice) -> [Key; 4] {
    let center = cube_of(point, lattice).map(|c| 2 * c + 1);
    let mut best = ([center; 4], f64::NEG_INFINITY);
    for axis in 0..3 {
        let mut before = center;
        before[axis] -= 2;
        for from in [before, center] {
            for tetrahedron in lattice.beyond(from, axis) {
                let least = least_weight(&tetrahedron, point, lattice);
                if least > best.1 {
                    best = (tetrahedron, least);
                }
            }
        }
    }
    best.0
}
