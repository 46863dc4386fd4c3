//! The grid of a body: a curve, surface or solid, with its spacings.

use super::FiniteDifferenceError as Refusal;
use opruga_mesh::Mesh;
use std::collections::BTreeMap;

/// The fraction of a spacing by which the cells of a grid may deviate from equal rectangles.
///
/// If spacings vary from node to node, the error of differences falls with the first instead of the second power of the
/// spacing. Rest positions have double precision, so a grid that is meant to be regular deviates by only about 1e-12 of a
/// spacing.
const DEVIATION: f64 = 1e-6;

/// A body as a grid.
pub(super) enum Grid {
    /// Edges, and nodes between two edges.
    Curve { edges: Vec<[u32; 2]>, nodes: Vec<[u32; 3]> },
    /// The cells of a surface, with consistent numbering of their nodes.
    Surface { cells: Vec<[u32; 4]>, inner: Vec<[u32; 5]>, edge: Vec<[u32; 4]> },
    /// The cells of a body in the plane.
    Plane { cells: Vec<[u32; 4]> },
    /// The cells of a body in space.
    Space { cells: Vec<[u32; 8]> },
}

/// The distance of two points.
fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// The spacings of a cell that is a rectangle or box. Each corner is corner 0 plus the steps of `steps` along perpendicular axes.
/// `neighbours` gives the corner one step along each axis. Other cells are refused.
pub(super) fn spacings<const D: usize, const N: usize, const A: usize>(
    mesh: &Mesh<D>,
    number: usize,
    cell: &[u32; N],
    neighbours: [usize; A],
    steps: [[u8; A]; N],
) -> Result<[f64; A], Refusal> {
    let at = |corner: usize| &mesh.positions[cell[corner] as usize];
    let axes: [[f64; D]; A] = neighbours.map(|corner| core::array::from_fn(|d| at(corner)[d] - at(0)[d]));
    let spacing = neighbours.map(|corner| distance(at(0), at(corner)));
    let least = spacing.iter().copied().fold(f64::INFINITY, |a, b| if b < a { b } else { a });
    let refused = |deviation: f64| Refusal::NotRectangular { cell: number, deviation };
    if least <= 0.0 || !least.is_finite() {
        return Err(refused(f64::INFINITY));
    }
    for i in 0..A {
        for j in 0..i {
            let cosine = axes[i].iter().zip(&axes[j]).map(|(a, b)| a * b).sum::<f64>() / (spacing[i] * spacing[j]);
            if cosine.abs() > DEVIATION {
                return Err(refused(cosine.abs()));
            }
        }
    }
    for (corner, steps) in steps.iter().enumerate() {
        let wanted: [f64; D] =
            core::array::from_fn(|d| at(0)[d] + (0..A).map(|axis| f64::from(steps[axis]) * axes[axis][d]).sum::<f64>());
        let off = distance(&wanted, at(corner)) / least;
        if off > DEVIATION {
            return Err(refused(off));
        }
    }
    Ok(spacing)
}

/// For quadrilaterals and hexahedra: the corner one step along each axis, and the steps to every corner.
pub(super) const QUADRILATERAL: ([usize; 2], [[u8; 2]; 4]) = ([1, 3], [[0, 0], [1, 0], [1, 1], [0, 1]]);
pub(super) const HEXAHEDRON: ([usize; 3], [[u8; 3]; 8]) =
    ([1, 3, 4], [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]);

impl Grid {
    /// The grid of a body.
    pub(super) fn of<const D: usize>(mesh: &Mesh<D>) -> Result<Grid, Refusal> {
        let cells = &mesh.cells;
        let (quadrilaterals, hexahedra) = (cells.quadrilaterals.len(), cells.hexahedra.len());
        let all = cells.iter().count();
        if all > 0 {
            return match (D, all == quadrilaterals, all == hexahedra) {
                (2, true, _) => Ok(Grid::Plane { cells: cells.quadrilaterals.clone() }),
                (3, _, true) => Ok(Grid::Space { cells: cells.hexahedra.clone() }),
                _ => Err(Refusal::NotAGrid {}),
            };
        }
        if !mesh.sheets.is_empty() {
            // Every triangle of a grid is half of one of its quadrilaterals.
            if 2 * mesh.sheet_quadrilaterals.len() != mesh.sheets.len() {
                return Err(Refusal::NotAGrid {});
            }
            return Grid::surface(&mesh.sheet_quadrilaterals);
        }
        let mut edges = mesh.wires.clone();
        if D == 2 {
            edges.extend(mesh.facets.iter().map(|facet| [facet[0], facet[D - 1]]));
        }
        if edges.is_empty() || (D == 3 && !mesh.facets.is_empty()) {
            return Err(Refusal::NotAGrid {});
        }
        Grid::curve(edges)
    }

    /// Makes a curve from edges that follow each other without branching.
    fn curve(edges: Vec<[u32; 2]>) -> Result<Grid, Refusal> {
        let (mut next, mut before) = (BTreeMap::new(), BTreeMap::new());
        for &[a, b] in &edges {
            if next.insert(a, b).is_some() || before.insert(b, a).is_some() {
                return Err(Refusal::NotAGrid {});
            }
        }
        let nodes = edges.iter().filter_map(|&[at, after]| before.get(&at).map(|b| [*b, at, after])).collect();
        Ok(Grid::Curve { edges, nodes })
    }

    /// Finds the nodes with all four neighbours, and the nodes on the edge. A node on the edge has both neighbours along the edge
    /// and one neighbour inside.
    fn surface(cells: &[[u32; 4]]) -> Result<Grid, Refusal> {
        // The neighbours of every node: backward and forward along both axes.
        let mut around: BTreeMap<u32, [Option<u32>; 4]> = BTreeMap::new();
        for &[a, b, c, d] in cells {
            for (from, to, axis) in [(a, b, 0), (d, c, 0), (a, d, 1), (b, c, 1)] {
                for (node, other, seat) in [(from, to, 2 * axis + 1), (to, from, 2 * axis)] {
                    let known = &mut around.entry(node).or_default()[seat];
                    if known.is_some_and(|known| known != other) {
                        return Err(Refusal::NotAGrid {});
                    }
                    *known = Some(other);
                }
            }
        }
        let (mut inner, mut edge) = (Vec::new(), Vec::new());
        for (&node, &neighbours) in &around {
            match neighbours {
                [Some(a), Some(b), Some(c), Some(d)] => inner.push([node, a, b, c, d]),
                [Some(a), Some(b), Some(c), None] | [Some(a), Some(b), None, Some(c)] => edge.push([node, a, b, c]),
                [Some(c), None, Some(a), Some(b)] | [None, Some(c), Some(a), Some(b)] => edge.push([node, a, b, c]),
                // No curvature is defined at a corner along either edge.
                _ => {}
            }
        }
        Ok(Grid::Surface { cells: cells.to_vec(), inner, edge })
    }
}
