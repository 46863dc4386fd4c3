//! The sphere of nearly equal triangles.

use std::f64::consts::PI;

use crate::geometry::{Point, norm};
use crate::mesh::{count, positive};
use crate::{Mesh, MeshError, Quantity};

/// The maximum number of subdivisions of the icosahedron: 7 gives 163,842 nodes.
pub const MAXIMUM_SUBDIVISIONS: u32 = 7;

/// The lattice on the icosahedron with edges divided into n parts, numbered row by row from the north pole to the south pole.
///
/// ```text
///            N                row 0         1 node
///          / | \              row k ≤ n     5k nodes       five northern faces  (N, Uₛ, Uₛ₊₁)
///        U₀--U₁--…            row n         5n nodes
///        /\  /\               n … 2n        5n nodes each  ten faces of the belt (Uₛ, Lₛ, Uₛ₊₁), (Lₛ, Lₛ₊₁, Uₛ₊₁)
///       /  \/  \              row 2n
///      L₀--L₁--…              row 2n + k    5(n − k) nodes five southern faces (S, Lₛ₊₁, Lₛ)
///        \ | /
///          S                  row 3n        1 node
/// ```
struct Rows {
    n: u32,
}

impl Rows {
    /// Nodes per fifth of a row; a pole is a row of one node.
    fn sector(&self, row: u32) -> u32 {
        let n = self.n;
        if row < n {
            row
        } else if row <= 2 * n {
            n
        } else {
            3 * n - row
        }
    }

    /// Index of the first node of a row.
    fn first(&self, row: u32) -> u32 {
        let n = self.n;
        if row == 0 {
            0
        } else if row <= n {
            // The pole and 5·1 + … + 5(row − 1).
            1 + 5 * row * (row - 1) / 2
        } else if row <= 2 * n {
            self.first(n) + 5 * n * (row - n)
        } else {
            // Counted from the far end: the pole and 5·1 + … + 5(3n − row).
            let left = 3 * n - row;
            10 * n * n + 1 - 5 * left * (left + 1) / 2
        }
    }

    /// Index of the node `step` steps into sector `s` of a row.
    fn node(&self, row: u32, s: u32, step: u32) -> u32 {
        let m = self.sector(row);
        if m == 0 { self.first(row) } else { self.first(row) + (s * m + step) % (5 * m) }
    }

    /// Index of lattice point (i, j) of a face, 0 ≤ i, j and i + j ≤ n. Faces 5k … 5k + 4 are north, belt down, belt up, south.
    ///
    /// The corners are (0, 0), (n, 0), (0, n), counter-clockwise as seen from outside.
    fn at(&self, face: u32, i: u32, j: u32) -> u32 {
        let (n, s) = (self.n, face % 5);
        match face / 5 {
            // N, Uₛ, Uₛ₊₁: the row counts from the pole.
            0 => self.node(i + j, s, j),
            // Uₛ, Lₛ, Uₛ₊₁: i steps down, j steps right.
            1 => self.node(n + i, s, j),
            // Lₛ₊₁, Uₛ₊₁, Lₛ: i steps up, j steps left.
            2 => self.node(2 * n - i, s, n - j),
            // S, Lₛ₊₁, Lₛ: the row counts from the pole, i moves to the right corner.
            _ => self.node(3 * n - i - j, s, i),
        }
    }
}

impl Mesh<3> {
    /// A sphere of radius r [m] about the origin. It is an icosahedron with corners on the z axis, whose faces are divided into four `subdivisions`
    /// times; each new node is projected onto the sphere.
    ///
    /// The sphere has 10·4ˢ + 2 nodes (12, 42, 162, 642, 2562, 10242, 40962, 163842) and 20·4ˢ facets. Twelve nodes have 5 neighbours, all others 6.
    ///
    /// Nodes are numbered in rows from the north pole to the south pole, so that neighbours are close in memory: at most 10·2ˢ apart in index. The
    /// belt, half of all nodes, has edges in only three directions, in long runs.
    ///
    /// # Errors
    /// [`MeshError::Size`] for a radius that is not positive and finite; [`MeshError::Count`] for more than [`MAXIMUM_SUBDIVISIONS`].
    pub fn icosphere(radius: f64, subdivisions: u32) -> Result<Mesh<3>, MeshError> {
        positive(Quantity::Radius, radius)?;
        count(Quantity::NumberSubdivisions, subdivisions, 0, u64::from(MAXIMUM_SUBDIVISIONS))?;
        let n = 1 << subdivisions;
        let rows = Rows { n };
        let mut unit: Vec<Point> = vec![[0.0; 3]; (10 * n * n + 2) as usize];

        // The twelve corners: two poles and two rings of five at z = ±1/√5, rotated by 36° relative to each other.
        let (z, r) = (1.0 / 5.0_f64.sqrt(), 2.0 / 5.0_f64.sqrt());
        unit[rows.node(0, 0, 0) as usize] = [0.0, 0.0, 1.0];
        unit[rows.node(3 * n, 0, 0) as usize] = [0.0, 0.0, -1.0];
        for s in 0..5 {
            let angle = 2.0 * PI * f64::from(s) / 5.0;
            unit[rows.node(n, s, 0) as usize] = [r * libm::cos(angle), r * libm::sin(angle), z];
            // Lₛ is below the midpoint of Uₛ and Uₛ₊₁.
            let lower = angle + PI / 5.0;
            unit[rows.node(2 * n, s, 0) as usize] = [r * libm::cos(lower), r * libm::sin(lower), -z];
        }

        // Halve every edge, level by level. Neighbouring faces compute a shared midpoint twice, with the same bits, because a + b = b + a.
        let mut stride = n;
        while stride > 1 {
            let half = stride / 2;
            for face in 0..20 {
                for i in (0..n).step_by(stride as usize) {
                    for j in (0..n - i).step_by(stride as usize) {
                        let corners = [(i, j), (i + stride, j), (i, j + stride)];
                        let middles = [(i + half, j), (i + half, j + half), (i, j + half)];
                        for side in 0..3 {
                            let (a, b, m) = (corners[side], corners[(side + 1) % 3], middles[side]);
                            let (a, b) =
                                (unit[rows.at(face, a.0, a.1) as usize], unit[rows.at(face, b.0, b.1) as usize]);
                            let sum = [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
                            let length = norm(sum);
                            unit[rows.at(face, m.0, m.1) as usize] = sum.map(|component| component / length);
                        }
                    }
                }
            }
            stride = half;
        }

        // Two triangles per lattice cell, only one along the slanted side.
        let mut facets = Vec::with_capacity((20 * n * n) as usize);
        for face in 0..20 {
            for i in 0..n {
                for j in 0..n - i {
                    let (b, c) = (rows.at(face, i + 1, j), rows.at(face, i, j + 1));
                    facets.push([rows.at(face, i, j), b, c]);
                    if i + j + 2 <= n {
                        facets.push([b, rows.at(face, i + 1, j + 1), c]);
                    }
                }
            }
        }
        let positions = unit.into_iter().map(|point| point.map(|component| radius * component)).collect();
        Ok(Mesh { positions, facets, ..Mesh::default() })
    }
}
