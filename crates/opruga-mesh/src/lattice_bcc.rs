//! The body-centred cubic lattice: corners and centres of cubes, and the congruent tetrahedra between them.
//!
//! Each tetrahedron has two long edges of length a, opposite each other, and four short edges of length √3/2·a. One long edge joins the centres of
//! neighbouring cubes, and the other is an edge of both cubes. Short edges join centres and corners.

use crate::geometry::tetrahedron_volume;
use crate::{MAXIMUM_NODES, Mesh, MeshError, Quantity};

/// Lattice points, given by twice their coordinates: all are even for corners of cubes, all are odd for centres.
pub(crate) type Key = [i32; 3];

/// The maximum number of cubes in the box of a surface, each of which is examined.
const MOST_CUBES: f64 = 8_388_608.0;

/// Cubes around the box of a surface, centred on it, with at least one cube beyond it on every side.
pub(crate) struct Lattice {
    /// Cubes along each axis.
    pub(crate) counts: [i32; 3],
    pub(crate) origin: [f64; 3],
    /// Side of the cubes [m].
    pub(crate) spacing: f64,
}

impl Lattice {
    /// Returns the lattice around a surface, with cubes of side `spacing` [m].
    ///
    /// # Errors
    /// [`MeshError::Size`] for a spacing that is not positive; [`MeshError::TooManyNodes`] if the filling or the box would have too many nodes.
    pub(crate) fn around(surface: &Mesh<3>, spacing: f64) -> Result<Lattice, MeshError> {
        crate::mesh::positive(Quantity::Spacing, spacing)?;
        let estimate = surface.lattice_estimate(spacing) as u64;
        if estimate > MAXIMUM_NODES {
            return Err(MeshError::TooManyNodes { nodes: estimate, most: MAXIMUM_NODES });
        }
        let (low, high) = surface.bounds();
        // A slanted needle has few nodes, but a large box with many cubes.
        let cubes: f64 = (0..3).map(|d| (high[d] - low[d]) / spacing + 3.0).product();
        if cubes > MOST_CUBES {
            let nodes = if cubes < 1e18 { 2 * cubes as u64 } else { u64::MAX };
            return Err(MeshError::TooManyNodes { nodes, most: 2 * MOST_CUBES as u64 });
        }
        // Coordinates count half cubes.
        let counts: [i32; 3] = core::array::from_fn(|d| ((high[d] - low[d]) / spacing).ceil() as i32 + 2);
        let origin: [f64; 3] =
            core::array::from_fn(|d| 0.5 * (low[d] + high[d]) - 0.5 * f64::from(counts[d]) * spacing);
        Ok(Lattice { counts, origin, spacing })
    }

    /// The position of a lattice point [m].
    pub(crate) fn at(&self, key: Key) -> [f64; 3] {
        core::array::from_fn(|d| self.origin[d] + 0.5 * self.spacing * f64::from(key[d]))
    }

    /// Centres of all cubes; x varies fastest.
    pub(crate) fn centers(&self) -> impl Iterator<Item = Key> {
        let [x, y, z] = self.counts;
        let rows = (0..z).flat_map(move |k| (0..y).map(move |j| (j, k)));
        rows.flat_map(move |(j, k)| (0..x).map(move |i| [2 * i + 1, 2 * j + 1, 2 * k + 1]))
    }

    /// The four tetrahedra between a cube and the next along an axis, each of positive volume: both centres and an edge of the face between them.
    pub(crate) fn beyond(&self, center: Key, axis: usize) -> [[Key; 4]; 4] {
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut next = center;
        next[axis] += 2;
        let corner = |p: i32, q: i32| {
            let mut key = center;
            key[axis] += 1;
            key[u] += p;
            key[v] += q;
            key
        };
        let face = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
        let around: [[Key; 4]; 4] = core::array::from_fn(|k| [center, next, face[k], face[(k + 1) % 4]]);
        around.map(|tetrahedron| {
            let [a, b, c, d] = tetrahedron.map(|key| self.at(key));
            if tetrahedron_volume(a, b, c, d) < 0.0 {
                let [p, q, r, s] = tetrahedron;
                [p, q, s, r]
            } else {
                tetrahedron
            }
        })
    }
}
