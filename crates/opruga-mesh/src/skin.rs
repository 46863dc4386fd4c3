//! A fine skin that a coarser body carries, for drawing.

use crate::geometry::{dot, subtract, tetrahedron_volume};
use crate::{Mesh, MeshError};
use std::collections::BTreeMap;

/// Points that move with a body without being part of its physics; each is a weighted mean of four of its nodes.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Skin {
    /// In space: triangles between the points of the skin, oriented outward.
    pub triangles: Vec<[u32; 3]>,
    /// In the plane: areas between the points of the skin, painted one over another.
    pub areas: Vec<Area>,
    /// In the plane: edges between the points of the skin, with the inside to their left. A body that is filled by a lattice touches others with
    /// these edges. Empty if the boundary of the cells coincides with that of the drawing.
    pub outline: Vec<[u32; 2]>,
    /// The nodes that carry each point.
    pub carriers: Vec<[u32; 4]>,
    /// The weights of these nodes, which add up to 1.
    pub weights: Vec<[f64; 4]>,
}

/// An area of a drawing.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Area {
    /// Red, green, blue and opacity; none for the colour of the body.
    pub colour: Option<[u8; 4]>,
    /// The points of the skin along each closed line that bounds the area; a line inside another bounds a hole.
    pub rings: Vec<Vec<u32>>,
    /// The area at rest as triangles between these points.
    pub triangles: Vec<[u32; 3]>,
}

impl Skin {
    /// The positions of the points of the skin when the body's nodes are at `positions` [m].
    pub fn positions(&self, positions: &[[f64; 3]]) -> Vec<[f64; 3]> {
        self.carriers
            .iter()
            .zip(&self.weights)
            .map(|(nodes, weights)| mean(nodes, weights, |node| positions[node]))
            .collect()
    }

    /// A nodal quantity at the points of the skin.
    pub fn values(&self, values: &[f64]) -> Vec<f64> {
        let each = |(nodes, weights): (&[u32; 4], &[f64; 4])| {
            nodes.iter().zip(weights).map(|(node, weight)| weight * values[*node as usize]).sum()
        };
        self.carriers.iter().zip(&self.weights).map(each).collect()
    }
}

fn mean(nodes: &[u32; 4], weights: &[f64; 4], at: impl Fn(usize) -> [f64; 3]) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (node, weight) in nodes.iter().zip(weights) {
        let p = at(*node as usize);
        for d in 0..3 {
            out[d] += weight * p[d];
        }
    }
    out
}

/// Weights of a point in a tetrahedron: the volumes of the tetrahedra that it forms with the faces, divided by the total.
pub(crate) fn weights([a, b, c, d]: [[f64; 3]; 4], point: [f64; 3]) -> [f64; 4] {
    let whole = tetrahedron_volume(a, b, c, d);
    [
        tetrahedron_volume(point, b, c, d) / whole,
        tetrahedron_volume(a, point, c, d) / whole,
        tetrahedron_volume(a, b, point, d) / whole,
        tetrahedron_volume(a, b, c, point) / whole,
    ]
}

/// The maximum number of points that are added to a skin.
const MOST_ADDED: usize = 1 << 20;

/// A surface with edges no longer than a length: longer ones are repeatedly halved, and the triangles at them are cut. Existing points keep their
/// numbers.
pub(crate) fn refined(positions: &[[f64; 3]], triangles: &[[u32; 3]], longest: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let (mut points, mut cut) = (positions.to_vec(), triangles.to_vec());
    while points.len() < positions.len() + MOST_ADDED {
        let mut middles: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        for [a, b, c] in &cut {
            for (p, q) in [(*a, *b), (*b, *c), (*c, *a)] {
                let edge = if p < q { [p, q] } else { [q, p] };
                let [x, y] = edge.map(|node| points[node as usize]);
                let edge_vector = subtract(y, x);
                if dot(edge_vector, edge_vector) > longest * longest && !middles.contains_key(&edge) {
                    middles.insert(edge, points.len() as u32);
                    points.push(core::array::from_fn(|d| 0.5 * (x[d] + y[d])));
                }
            }
        }
        if middles.is_empty() {
            break;
        }
        let middle = |p: u32, q: u32| middles.get(&if p < q { [p, q] } else { [q, p] }).copied();
        cut = cut.iter().flat_map(|triangle| pieces(*triangle, &middle)).collect();
    }
    (points, cut)
}

/// The triangles into which a triangle is cut at the midpoints that its edges may have.
fn pieces([a, b, c]: [u32; 3], middle: &impl Fn(u32, u32) -> Option<u32>) -> Vec<[u32; 3]> {
    match (middle(a, b), middle(b, c), middle(c, a)) {
        (None, None, None) => vec![[a, b, c]],
        (Some(m), None, None) => vec![[a, m, c], [m, b, c]],
        (Some(m), Some(n), None) => vec![[m, b, n], [a, m, n], [a, n, c]],
        (Some(m), Some(n), Some(o)) => vec![[a, m, o], [m, b, n], [o, n, c], [m, n, o]],
        // The same case, starting from another corner.
        (None, ..) | (Some(_), None, Some(_)) => pieces([b, c, a], middle),
    }
}

/// Tests whether an upward ray (along z) from a point meets closed facets an odd number of times. Facets are found by a grid in x and y.
pub(crate) struct Inside<'m> {
    mesh: &'m Mesh<3>,
    low: [f64; 2],
    cell: [f64; 2],
    counts: [usize; 2],
    cells: Vec<Vec<u32>>,
}

impl<'m> Inside<'m> {
    pub(crate) fn of(mesh: &'m Mesh<3>) -> Result<Inside<'m>, MeshError> {
        mesh.components()?;
        let (low, high) = mesh.bounds();
        // About as many cells as facets.
        let n = (mesh.facets.len() as f64).sqrt().ceil() as usize + 1;
        let side = |axis: usize| if high[axis] > low[axis] { (high[axis] - low[axis]) / n as f64 } else { 1.0 };
        let mut grid =
            Inside { mesh, low: [low[0], low[1]], cell: [side(0), side(1)], counts: [n + 1, n + 1], cells: Vec::new() };
        grid.cells = vec![Vec::new(); grid.counts[0] * grid.counts[1]];
        for (index, facet) in mesh.facets.iter().enumerate() {
            let corners = facet.map(|node| mesh.positions[node as usize]);
            let range = |axis: usize| {
                let cell_indices = corners.map(|p| grid.cell_index(axis, p[axis]));
                let (mut from, mut to) = (cell_indices[0], cell_indices[0]);
                for cell_index in cell_indices {
                    from = usize::min(from, cell_index);
                    to = usize::max(to, cell_index);
                }
                from..=to
            };
            let (across, along) = (range(0), range(1));
            for j in along {
                for i in across.clone() {
                    grid.cells[i + grid.counts[0] * j].push(index as u32);
                }
            }
        }
        Ok(grid)
    }

    fn cell_index(&self, axis: usize, x: f64) -> usize {
        let index = ((x - self.low[axis]) / self.cell[axis]).floor();
        if index > 0.0 { usize::min(index as usize, self.counts[axis] - 1) } else { 0 }
    }

    /// Whether a point is inside.
    pub(crate) fn contains(&self, point: [f64; 3]) -> bool {
        let cell = &self.cells[self.cell_index(0, point[0]) + self.counts[0] * self.cell_index(1, point[1])];
        let mut inside = false;
        for facet in cell {
            let [a, b, c] = self.mesh.facets[*facet as usize].map(|node| self.mesh.positions[node as usize]);
            // Half-open intervals in x make a ray through an edge or a node count once.
            let mut within = false;
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if (p[1] > point[1]) != (q[1] > point[1]) {
                    // The edge has the same direction for both of its triangles, so that they agree to the last bit.
                    let (p, q) = if p[1] < q[1] { (p, q) } else { (q, p) };
                    let x = p[0] + (point[1] - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
                    within ^= x > point[0];
                }
            }
            if within {
                let normal = crate::geometry::cross(subtract(b, a), subtract(c, a));
                if normal[2] != 0.0 {
                    let height = a[2] + dot(normal, subtract(a, [point[0], point[1], a[2]])) / normal[2];
                    inside ^= height > point[2];
                }
            }
        }
        inside
    }
}
