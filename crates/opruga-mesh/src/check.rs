//! A list of everything that looks wrong with a mesh.

use crate::geometry::{Point, cross, dot, lift, norm, subtract};
use crate::{Element, Mesh, MeshError};
use opruga_math::words::{counted, number};

/// An edge shorter than this fraction of the body's extent counts as degenerate [−].
pub const SHORT_EDGE: f64 = 1e-12;

/// An element counts as degenerate if its area is below this fraction of its longest edge squared, or its volume below this fraction of its longest
/// edge cubed [−].
pub const THIN_ELEMENT: f64 = 1e-10;

/// A body counts as flat if its extent in one direction is below this fraction of its largest extent [−].
const FLAT_BODY: f64 = 1e-9;

/// Something that looks wrong with a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// A coordinate is infinite or not a number.
    #[error("the position of node {node} is not finite")]
    NotFinite {
        /// The node.
        node: u32,
    },
    /// The indices or the boundary are invalid; see the error.
    #[error(transparent)]
    Topology(#[from] MeshError),
    /// An element has no length, area or volume, relative to its size.
    #[error("{element} {index} is degenerate: its measure is {}", number(*measure))]
    Degenerate {
        /// Kind of the element.
        element: Element,
        /// Index of the element among its kind.
        index: u32,
        /// The length [m], area [m²] or volume [m³] of the element.
        measure: f64,
    },
    /// A filled cell has negative area or volume, or a negative Jacobian at one of its nodes.
    #[error("{element} {index} is inverted: its measure is {}", number(*measure))]
    Inverted {
        /// Kind of the cell.
        element: Element,
        /// Index of the cell among its kind.
        index: u32,
        /// The signed area [m²] or volume [m³] that the cell would have if its Jacobian had the value at its worst node everywhere.
        measure: f64,
    },
    /// Two facets have the same nodes.
    #[error("facets {first} and {second} have the same nodes")]
    DuplicateFacet {
        /// The facet of lower index.
        first: u32,
        /// The facet that repeats the nodes of the first one.
        second: u32,
    },
    /// No element uses these nodes.
    #[error("{} to no element, the first is node {}", counted(nodes.len() as u64, "node belongs", "nodes belong"), nodes.first().copied().unwrap_or(0))]
    UnreferencedNodes {
        /// The nodes, ascending.
        nodes: Vec<u32>,
    },
    /// A body that should enclose area or volume is contained in a point, a line or a plane.
    #[error("the body is flat: its nodes span only {dimension} dimensions")]
    Flat {
        /// The number of dimensions that the nodes span.
        dimension: usize,
    },
}

impl<const D: usize> Mesh<D> {
    /// Lists everything that looks wrong: invalid indices and boundaries, coordinates that are not finite, degenerate or inverted elements, duplicate
    /// facets, unused nodes, bodies without extent. Empty for a sound mesh.
    ///
    /// If indices are invalid, only that problem is listed. If coordinates are not finite, problems of shape are not listed.
    pub fn check(&self) -> Vec<Problem> {
        let mut problems = Vec::new();
        if let Err(error) = self.validate() {
            problems.push(Problem::Topology(error));
            return problems;
        }
        self.check_references(&mut problems);
        let broken = (0..self.nodes()).filter(|&node| self.positions[node].iter().any(|x| !x.is_finite()));
        let finite_from = problems.len();
        problems.extend(broken.map(|node| Problem::NotFinite { node: node as u32 }));
        if problems.len() == finite_from {
            self.check_shapes(&mut problems);
            if let Err(error) = self.chambers() {
                problems.push(Problem::Topology(error));
            }
        }
        problems
    }

    /// Checks for duplicate facets and unused nodes.
    fn check_references(&self, problems: &mut Vec<Problem>) {
        let mut keys: Vec<([u32; D], u32)> = Vec::with_capacity(self.facets.len());
        for (index, &facet) in self.facets.iter().enumerate() {
            let mut key = facet;
            key.sort_unstable();
            keys.push((key, index as u32));
        }
        keys.sort_unstable();
        for pair in keys.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            problems.push(Problem::DuplicateFacet { first: pair[0].1, second: pair[1].1 });
        }

        let nodes = self.unreferenced_nodes();
        if !nodes.is_empty() {
            problems.push(Problem::UnreferencedNodes { nodes });
        }
    }

    /// Checks for degenerate and inverted elements and flat bodies; the positions are finite.
    fn check_shapes(&self, problems: &mut Vec<Problem>) {
        let points: Vec<Point> = self.positions.iter().map(lift).collect();
        let spread = spread(&points);
        for (element, index, nodes) in self.elements().filter(|entry| entry.0 != Element::SheetQuadrilateral) {
            // A curved cell must not fold over at any of its nodes.
            let measure = self.size_of(nodes, element);
            let least = self.extreme_measures(element, nodes, measure).0;
            let mut longest = 0.0;
            for (place, &a) in nodes.iter().enumerate() {
                for &b in &nodes[..place] {
                    let length = norm(subtract(points[a as usize], points[b as usize]));
                    if length > longest {
                        longest = length;
                    }
                }
            }
            let thin = match element {
                Element::Tetrahedron | Element::Hexahedron | Element::QuadraticTetrahedron => {
                    THIN_ELEMENT * longest * longest * longest
                }
                _ if nodes.len() > 2 => THIN_ELEMENT * longest * longest,
                _ => 0.0,
            };
            if longest <= SHORT_EDGE * spread[0] || measure.abs() <= thin {
                problems.push(Problem::Degenerate { element, index, measure });
            } else if least < 0.0 {
                problems.push(Problem::Inverted { element, index, measure: least });
            }
        }
        if !self.facets.is_empty() || !self.cells.is_empty() {
            let dimension = spread.iter().filter(|&&extent| extent > FLAT_BODY * spread[0]).count();
            if dimension < D {
                problems.push(Problem::Flat { dimension });
            }
        }
    }
}

/// The extents of points [m]: along their longest direction from the first point, perpendicular to this direction, and out of the plane of both
/// directions.
fn spread(points: &[Point]) -> [f64; 3] {
    let mut extents = [0.0; 3];
    let Some(&origin) = points.first() else {
        return extents;
    };

    // This is a greedy search: the farthest point gives a direction, whose component is then removed from all points.
    let mut directions: [Point; 3] = [[0.0; 3]; 3];
    for rank in 0..3 {
        let mut farthest = [0.0; 3];
        for &point in points {
            let offset = subtract(point, origin);
            let rest = match rank {
                0 => offset,
                1 => cross(offset, directions[0]),
                _ => {
                    let out = dot(offset, directions[2]);
                    [out, 0.0, 0.0]
                }
            };
            if norm(rest) > extents[rank] {
                extents[rank] = norm(rest);
                farthest = offset;
            }
        }
        if extents[rank] == 0.0 {
            break;
        }
        match rank {
            0 => directions[0] = farthest.map(|component| component / extents[0]),
            1 => directions[2] = cross(directions[0], farthest).map(|component| component / extents[1]),
            _ => {}
        }
    }
    extents
}
