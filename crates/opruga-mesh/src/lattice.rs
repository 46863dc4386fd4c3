//! Chains and lattices, for both dimensions: lines, polylines, filled grids.

use std::collections::BTreeMap;

use crate::mesh::{count, finite, limit_nodes, positive};
use crate::{Cells, MAXIMUM_NODES, Mesh, MeshError, Must, Quantity};

/// Names of the low and high side of each axis; `back` is the side with low z.
pub(crate) const SIDES: [[&str; 2]; 3] = [["left", "right"], ["bottom", "top"], ["back", "front"]];

/// Coordinate of lattice station `index` of `cells`; the last one is exactly the far end.
pub(crate) fn station(lower: f64, size: f64, index: u32, cells: u32) -> f64 {
    if index == cells { lower + size } else { lower + size * f64::from(index) / f64::from(cells) }
}

/// Node groups of the sides of a lattice, from each node's lattice index.
pub(crate) fn side_groups<const A: usize>(
    nodes: impl Iterator<Item = [u32; A]>,
    cells: [u32; A],
) -> BTreeMap<String, Vec<u32>> {
    let mut groups: BTreeMap<String, Vec<u32>> = BTreeMap::new();
    for (node, index) in nodes.enumerate() {
        for axis in 0..A {
            for (side, station) in [0, cells[axis]].into_iter().enumerate() {
                if index[axis] == station {
                    groups.entry(SIDES[axis][side].to_owned()).or_default().push(node as u32);
                }
            }
        }
    }
    groups
}

/// Lattice indices in node order; the first axis varies fastest.
pub(crate) fn lattice<const A: usize>(cells: [u32; A]) -> impl Iterator<Item = [u32; A]> {
    let total: u64 = cells.iter().map(|&n| u64::from(n) + 1).product();
    (0..total).map(move |node| {
        let mut rest = node;
        std::array::from_fn(|axis| {
            let length = u64::from(cells[axis]) + 1;
            let index = rest % length;
            rest /= length;
            index as u32
        })
    })
}

impl<const D: usize> Mesh<D> {
    /// A straight wire from one point to another [m], in `segments` equal edges; node i is the i-th station.
    ///
    /// # Errors
    /// [`MeshError::Count`] for no segments or too many; [`MeshError::Size`] if a point is not finite or both coincide.
    pub fn line(from: [f64; D], to: [f64; D], segments: u32) -> Result<Mesh<D>, MeshError> {
        count(Quantity::NumberSegments, segments, 1, MAXIMUM_NODES - 1)?;
        finite(Quantity::EndLine, &from)?;
        finite(Quantity::EndLine, &to)?;
        if from == to {
            return Err(MeshError::Size { what: Quantity::LengthLine, value: 0.0, must: Must::Positive });
        }
        let at = |i: u32| {
            std::array::from_fn(|axis| {
                if i == segments { to[axis] } else { station(from[axis], to[axis] - from[axis], i, segments) }
            })
        };
        let positions = (0..=segments).map(at).collect();
        let wires = (0..segments).map(|i| [i, i + 1]).collect();
        Ok(Mesh { positions, wires, ..Mesh::default() })
    }

    /// A wire through the given points [m], optionally closed to a loop; node i is point i. A closed loop may repeat its first point at the end.
    ///
    /// # Errors
    /// [`MeshError::Count`] for too few points (2, or 3 in a loop); [`MeshError::Size`] if one is not finite; [`MeshError::RepeatedPoint`] if two
    /// consecutive ones coincide.
    pub fn polyline(points: &[[f64; D]], closed: bool) -> Result<Mesh<D>, MeshError> {
        let points = if closed { without_repeated_end(points) } else { points };
        check_points(points, if closed { 3 } else { 2 }, closed)?;
        let n = points.len() as u32;
        let last = if closed { n } else { n - 1 };
        let wires = (0..last).map(|i| [i, (i + 1) % n]).collect();
        Ok(Mesh { positions: points.to_vec(), wires, ..Mesh::default() })
    }

    /// A filled box of `size` [m] from its `lower` corner [m], cut into `cells` quadrilaterals (plane) or hexahedra (space) per axis.
    ///
    /// ```text
    ///   n+1--n+2-- … --2n+1      node (x, y, z) has index  x + (nx+1)·(y + (ny+1)·z)
    ///    |    |         |        cell (x, y, z) likewise   x + nx·(y + ny·z)
    ///    0----1--- … ---n
    /// ```
    /// Groups: `left`, `right` (low and high x), `bottom`, `top` (y), in space `back`, `front` (z). Facets bound the box.
    ///
    /// # Errors
    /// [`MeshError::Count`] for an axis without cells; [`MeshError::Size`] for sizes that are not positive and finite; [`MeshError::TooManyNodes`].
    pub fn grid(lower: [f64; D], size: [f64; D], cells: [u32; D]) -> Result<Mesh<D>, MeshError> {
        finite(Quantity::LowerCornerGrid, &lower)?;
        let mut nodes = 1_u64;
        for axis in 0..D {
            count(Quantity::NumberCellsPerAxis, cells[axis], 1, MAXIMUM_NODES)?;
            positive(Quantity::SizeGrid, size[axis])?;
            nodes = nodes.saturating_mul(u64::from(cells[axis]) + 1);
        }
        limit_nodes(nodes)?;

        // Nodes; the first axis varies fastest.
        let positions = lattice(cells)
            .map(|index| std::array::from_fn(|axis| station(lower[axis], size[axis], index[axis], cells[axis])))
            .collect();
        let groups = side_groups(lattice(cells), cells);

        // Cells from their lowest node: a step along x, y, z changes the index by 1, `row`, `layer`.
        let row = cells[0] + 1;
        let layer = row * (cells[1] + 1);
        let mut filled = Cells::default();
        for index in lattice(cells).filter(|index| (0..D).all(|axis| index[axis] < cells[axis])) {
            let a = index[0] + row * index[1];
            if D == 2 {
                filled.quadrilaterals.push([a, a + 1, a + row + 1, a + row]);
            } else {
                let a = a + layer * index[D - 1];
                let b = a + layer;
                filled.hexahedra.push([a, a + 1, a + row + 1, a + row, b, b + 1, b + row + 1, b + row]);
            }
        }
        let mut mesh = Mesh { positions, cells: filled, groups, ..Mesh::default() };
        mesh.facets = mesh.facets_from_cells()?;
        Ok(mesh)
    }
}

impl Mesh<2> {
    /// A filled quadrilateral through four corners [m], counter-clockwise, with `cells` quadrilaterals along its first and its second side.
    ///
    /// The quadrilateral is a grid of the unit square. Each point (s, t) of the square is mapped to a bilinear mean of the corners. Groups: `bottom`
    /// runs from corner 0 to 1, `right` from 1 to 2, `top` from 3 to 2, `left` from 0 to 3.
    ///
    /// # Errors
    /// The errors of [`Mesh::grid`]; [`MeshError::Size`] with the area at a corner if the quadrilateral is not convex and counter-clockwise there.
    pub fn quadrilateral(corners: [[f64; 2]; 4], cells: [u32; 2]) -> Result<Mesh<2>, MeshError> {
        for k in 0..4 {
            finite(Quantity::CornerQuadrilateral, &corners[k])?;
            let (before, at, after) = (corners[(k + 3) % 4], corners[k], corners[(k + 1) % 4]);
            let (u, w) = ([at[0] - before[0], at[1] - before[1]], [after[0] - at[0], after[1] - at[1]]);
            let area = u[0] * w[1] - u[1] * w[0];
            if area.is_nan() || area <= 0.0 {
                let must = Must::Convex;
                return Err(MeshError::Size { what: Quantity::AreaSpannedSidesCorner, value: area, must });
            }
        }
        let mut mesh = Mesh::grid([0.0; 2], [1.0; 2], cells)?;
        for position in &mut mesh.positions {
            let [s, t] = *position;
            let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
            *position = std::array::from_fn(|axis| (0..4).map(|k| weights[k] * corners[k][axis]).sum());
        }
        Ok(mesh)
    }
}

/// The points without a last one that repeats the first.
pub(crate) fn without_repeated_end<const D: usize>(points: &[[f64; D]]) -> &[[f64; D]] {
    match points {
        [first, inner @ .., last] if first == last && !inner.is_empty() => &points[..points.len() - 1],
        _ => points,
    }
}

/// Refuses too few or too many points, points that are not finite, and points that repeat their predecessor.
pub(crate) fn check_points<const D: usize>(points: &[[f64; D]], least: u64, closed: bool) -> Result<(), MeshError> {
    let n = points.len();
    limit_nodes(n as u64)?;
    count(Quantity::NumberPoints, n as u32, least, MAXIMUM_NODES)?;
    for (index, point) in points.iter().enumerate() {
        finite(Quantity::CoordinatePoint, point)?;
        let next = (index + 1) % n;
        if points[next] == *point && (closed || next != 0) {
            return Err(MeshError::RepeatedPoint { first: index as u32, second: next as u32 });
        }
    }
    Ok(())
}
