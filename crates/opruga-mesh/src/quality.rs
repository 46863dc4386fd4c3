//! The quality of cells: measures, the worst corner, angles.

use crate::geometry::{Point, cross, dot, lift, norm, subtract};
use crate::{Element, Mesh};

/// The size of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellMeasure {
    /// The signed area [m²] or volume [m³] of the cell.
    pub whole: f64,
    /// The smallest det ∂x/∂ξ at its nodes, as the area or volume that a cell with this value everywhere would have. If the determinant is positive
    /// at the nodes but negative between them, this is its smallest value between them: see [`crate::least_jacobian`].
    pub least: f64,
    /// The largest of these values at the nodes of the cell.
    pub greatest: f64,
    /// The longest distance between two nodes of the cell [m].
    pub longest: f64,
}

/// The quality of the cells of a mesh. Angles are those between the faces of tetrahedra and between the sides of other cells, with straight sides
/// through the corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellQuality {
    /// Number of cells.
    pub cells: usize,
    /// Number of cells with a negative Jacobian anywhere.
    pub inverted: usize,
    /// The area or volume of all cells [m², m³].
    pub measure: f64,
    /// The smallest angle [rad].
    pub smallest_angle: f64,
    /// The largest angle [rad].
    pub largest_angle: f64,
    /// The shortest straight edge [m].
    pub shortest_edge: f64,
    /// The longest straight edge [m].
    pub longest_edge: f64,
}

/// Corners of a cell at which angles are measured: every corner with its two, or three, neighbours.
const QUADRILATERAL_CORNERS: [[usize; 3]; 4] = [[0, 1, 3], [1, 2, 0], [2, 3, 1], [3, 0, 2]];
const HEXAHEDRON_CORNERS: [[usize; 4]; 8] =
    [[0, 1, 3, 4], [1, 2, 0, 5], [2, 3, 1, 6], [3, 0, 2, 7], [4, 7, 5, 0], [5, 4, 6, 1], [6, 5, 7, 2], [7, 6, 4, 3]];

pub(crate) const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

impl<const D: usize> Mesh<D> {
    /// The size of every cell, in the order of [`crate::Cells::iter`]. Indices must be valid.
    pub fn cell_measures(&self) -> Vec<CellMeasure> {
        let measure = |(element, _, nodes): (Element, u32, &[u32])| {
            let whole = self.size_of(nodes, element);
            let (least, greatest) = self.extreme_measures(element, nodes, whole);
            let mut longest = 0.0;
            for (place, &a) in nodes.iter().enumerate() {
                for &b in &nodes[..place] {
                    let length = norm(subtract(self.point(a), self.point(b)));
                    if length > longest {
                        longest = length;
                    }
                }
            }
            CellMeasure { whole, least, greatest, longest }
        };
        self.cells.iter().map(measure).collect()
    }

    fn point(&self, node: u32) -> Point {
        lift(&self.positions[node as usize])
    }

    /// The smallest and the largest Jacobian at the nodes of a cell, as areas or volumes. If the Jacobian is negative only between the nodes, its
    /// smallest value is sought there.
    pub(crate) fn extreme_measures(&self, element: Element, nodes: &[u32], whole: f64) -> (f64, f64) {
        let at = |k: usize| self.point(nodes[k]);
        let side = |a: usize, b: usize| subtract(at(b), at(a));
        let values: Vec<f64> = match element {
            Element::QuadraticTriangle => crate::quadratic::triangle_areas(&core::array::from_fn(at)).to_vec(),
            Element::QuadraticTetrahedron => crate::quadratic::tetrahedron_volumes(&core::array::from_fn(at)).to_vec(),
            Element::Quadrilateral => QUADRILATERAL_CORNERS.map(|[o, a, b]| cross(side(o, a), side(o, b))[2]).to_vec(),
            Element::Hexahedron => {
                HEXAHEDRON_CORNERS.map(|[o, a, b, c]| dot(side(o, a), cross(side(o, b), side(o, c)))).to_vec()
            }
            _ => return (whole, whole),
        };
        let (low, high) = values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (if x < low { x } else { low }, if x > high { x } else { high })
        });
        // A cell with positive values at its nodes may be folded between them.
        let unit = match element {
            Element::QuadraticTriangle => 0.5,
            Element::QuadraticTetrahedron => 1.0 / 6.0,
            Element::Hexahedron => 1.0,
            _ => return (low, high),
        };
        let between = if low > 0.0 { self.least_jacobian_of(nodes).filter(|least| least.is_inverted()) } else { None };
        (between.map_or(low, |least| unit * least.found), high)
    }

    fn least_jacobian_of(&self, nodes: &[u32]) -> Option<crate::LeastJacobian> {
        let rest: Vec<[f64; D]> = nodes.iter().map(|&node| self.positions[node as usize]).collect();
        crate::least_jacobian(&rest)
    }

    /// Reverses cells, so that their measure changes its sign; cells are numbered in the order of [`crate::Cells::iter`].
    pub fn turn_cells(&mut self, cells: &[u32]) {
        let locations: Vec<(Element, u32)> = self.cells.iter().map(|(element, index, _)| (element, index)).collect();
        for cell in cells {
            let (element, index) = locations[*cell as usize];
            self.cells.turn(element, index as usize);
        }
    }

    /// Nodes that no element uses, ascending.
    pub fn unreferenced_nodes(&self) -> Vec<u32> {
        let mut named = vec![false; self.nodes()];
        for (_, _, nodes) in self.elements() {
            nodes.iter().for_each(|&node| named[node as usize] = true);
        }
        (0..named.len()).filter(|&node| !named[node]).map(|node| node as u32).collect()
    }

    /// The quality of the cells; none without cells.
    pub fn cell_quality(&self) -> Option<CellQuality> {
        if self.cells.is_empty() {
            return None;
        }
        let mut quality = CellQuality {
            cells: self.cells.len(),
            inverted: 0,
            measure: 0.0,
            smallest_angle: f64::INFINITY,
            largest_angle: 0.0,
            shortest_edge: f64::INFINITY,
            longest_edge: 0.0,
        };
        for (element, _, nodes) in self.cells.iter() {
            let whole = self.size_of(nodes, element);
            quality.measure += whole;
            if self.extreme_measures(element, nodes, whole).0 < 0.0 {
                quality.inverted += 1;
            }
            let at = |k: usize| self.point(nodes[k]);
            let (low, high) = self.angles_of(element, nodes);
            if low < quality.smallest_angle {
                quality.smallest_angle = low;
            }
            if high > quality.largest_angle {
                quality.largest_angle = high;
            }
            let edges: &[[usize; 2]] = match element {
                Element::Tetrahedron | Element::QuadraticTetrahedron => &crate::quadratic::TETRAHEDRON_EDGES,
                Element::Triangle | Element::QuadraticTriangle => &crate::quadratic::TRIANGLE_SIDES,
                Element::Quadrilateral => &[[0, 1], [1, 2], [2, 3], [3, 0]],
                _ => &HEXAHEDRON_EDGES,
            };
            for &[a, b] in edges {
                let length = norm(subtract(at(a), at(b)));
                if length < quality.shortest_edge {
                    quality.shortest_edge = length;
                }
                if length > quality.longest_edge {
                    quality.longest_edge = length;
                }
            }
        }
        Some(quality)
    }
}

impl<const D: usize> Mesh<D> {
    /// The smallest angle of every cell [rad], measured as in [`Mesh::cell_quality`], in the order of [`crate::Cells::iter`].
    pub fn smallest_cell_angles(&self) -> Vec<f64> {
        self.cells.iter().map(|(element, _, nodes)| self.angles_of(element, nodes).0).collect()
    }

    /// The smallest and the largest angle [rad] of a cell, between faces of tetrahedra or sides of other cells.
    fn angles_of(&self, element: Element, nodes: &[u32]) -> (f64, f64) {
        let at = |k: usize| self.point(nodes[k]);
        let corner = |o: usize, a: usize, b: usize| between(subtract(at(a), at(o)), subtract(at(b), at(o)));
        let angles = match element {
            Element::Tetrahedron | Element::QuadraticTetrahedron => {
                dihedral_angles([at(0), at(1), at(2), at(3)]).to_vec()
            }
            Element::Triangle | Element::QuadraticTriangle => vec![corner(0, 1, 2), corner(1, 2, 0), corner(2, 0, 1)],
            Element::Quadrilateral => QUADRILATERAL_CORNERS.iter().map(|[o, a, b]| corner(*o, *a, *b)).collect(),
            _ => {
                let all = HEXAHEDRON_CORNERS.iter().flat_map(|&[o, a, b, c]| [[o, a, b], [o, b, c], [o, c, a]]);
                all.map(|[o, a, b]| corner(o, a, b)).collect()
            }
        };
        angles.into_iter().fold((f64::INFINITY, 0.0), |(low, high), angle| {
            (if angle < low { angle } else { low }, if angle > high { angle } else { high })
        })
    }
}

/// The angle between two directions [rad].
fn between(a: Point, b: Point) -> f64 {
    libm::atan2(norm(cross(a, b)), dot(a, b))
}

/// The six interior angles between the faces of a tetrahedron [rad].
pub(crate) fn dihedral_angles(corners: [Point; 4]) -> [f64; 6] {
    // At edge ij with the other corners k and l: the angle between the components of ik and il perpendicular to the edge.
    const EDGES: [[usize; 4]; 6] = [[0, 1, 2, 3], [1, 2, 0, 3], [2, 0, 1, 3], [0, 3, 1, 2], [1, 3, 2, 0], [2, 3, 0, 1]];
    EDGES.map(|[i, j, k, l]| {
        let edge = subtract(corners[j], corners[i]);
        let across = |to: usize| cross(edge, subtract(corners[to], corners[i]));
        between(across(k), across(l))
    })
}
