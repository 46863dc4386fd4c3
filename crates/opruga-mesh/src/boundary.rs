//! Boundaries of cells, and conversion of boxes to simplices.

use crate::geometry::{HEXAHEDRON_FACES, TETRAHEDRON_FACES, ascending};
use crate::quadratic::{TRIANGLE_SIDES, tetrahedron_parts};
use crate::quality::HEXAHEDRON_EDGES;
use crate::{Element, Mesh, MeshError};

/// Six tetrahedra around the diagonal 0–6 of a hexahedron, all of positive volume. Neighbours in a grid cut their common face in the same way.
///
/// # Source
/// Kuhn, "Some combinatorial lemmas in topology", IBM J. Res. Dev. 4 (1960).
const KUHN: [[usize; 4]; 6] = [[0, 1, 2, 6], [0, 5, 1, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 4, 5, 6], [0, 7, 4, 6]];

/// The tetrahedra 0257 and 1346 of a hexahedron, whose edges are diagonals of its faces, each with the four remaining corner tetrahedra.
const INSCRIBED: [[[usize; 4]; 5]; 2] = [
    [[0, 5, 2, 7], [0, 1, 2, 5], [0, 2, 3, 7], [0, 4, 5, 7], [2, 5, 6, 7]],
    [[1, 3, 4, 6], [0, 1, 3, 4], [1, 2, 3, 6], [1, 4, 5, 6], [3, 4, 6, 7]],
];

/// The number of tetrahedra into which a hexahedron is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cut {
    /// Six around the diagonal 0–6 of the hexahedron, in the same way in every hexahedron. If neighbours would then cut a common face along different
    /// diagonals, all hexahedra are cut into six from their node with the lowest number instead.
    Six,
    /// Five: one inscribed and four at corners, mirrored from hexahedron to hexahedron so that common faces are cut in the same way.
    Five,
}

/// A face of a cell: its distinct nodes, ascending (the key), and its nodes as seen from outside. Triangles and edges repeat their last node.
struct Face {
    key: [u32; 4],
    order: usize,
    nodes: [u32; 4],
}

impl<const D: usize> Mesh<D> {
    /// The facets that bound the cells: oriented faces that belong to only one cell, in the order of the cells.
    ///
    /// A face of a hexahedron becomes two triangles, cut from its lowest node. The side of a quadratic triangle becomes two edges, and the face of a
    /// quadratic tetrahedron four triangles, through all of its nodes.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::NonManifoldEdges`] with the lowest two nodes of each face that more than two cells share.
    pub fn facets_from_cells(&self) -> Result<Vec<[u32; D]>, MeshError> {
        self.validate()?;
        let mut faces = Vec::new();
        for (element, _, cell) in self.cells.iter() {
            let mut push = |nodes: [u32; 4]| {
                faces.push(Face { key: distinct(nodes), order: faces.len(), nodes });
            };
            match element {
                Element::Tetrahedron => {
                    TETRAHEDRON_FACES.iter().for_each(|&[a, b, c]| push([cell[a], cell[b], cell[c], cell[c]]))
                }
                Element::Hexahedron => HEXAHEDRON_FACES.iter().for_each(|face| push(face.map(|corner| cell[corner]))),
                Element::QuadraticTriangle => {
                    for ([i, j], middle) in TRIANGLE_SIDES.into_iter().zip(3..) {
                        push([cell[i], cell[middle], cell[middle], cell[middle]]);
                        push([cell[middle], cell[j], cell[j], cell[j]]);
                    }
                }
                Element::QuadraticTetrahedron => {
                    let nodes = core::array::from_fn(|k| cell[k]);
                    tetrahedron_parts(&nodes).for_each(|[a, b, c]| push([a, b, c, c]));
                }
                _ => {
                    for (corner, &a) in cell.iter().enumerate() {
                        let b = cell[(corner + 1) % cell.len()];
                        push([a, b, b, b]);
                    }
                }
            }
        }

        // Faces of only one cell are the boundary; return them to the order of the cells.
        faces.sort_unstable_by_key(|face| (face.key, face.order));
        let groups = || faces.chunk_by(|p, q| p.key == q.key);
        let mut crowded: Vec<[u32; 2]> =
            groups().filter(|group| group.len() > 2).map(|group| ascending(group[0].key[0], group[0].key[1])).collect();
        if !crowded.is_empty() {
            crowded.dedup();
            return Err(MeshError::NonManifoldEdges { edges: crowded });
        }
        let mut outer: Vec<&Face> = groups().filter(|group| group.len() == 1).map(|group| &group[0]).collect();
        outer.sort_unstable_by_key(|face| face.order);

        let mut facets = Vec::with_capacity(2 * outer.len());
        for face in outer {
            let [a, b, c, d] = face.nodes;
            if D == 2 || c == d {
                facets.push(facet([a, b, c]));
            } else {
                // Rotate the quadrilateral so that its lowest node comes first.
                let mut nodes = face.nodes;
                let lowest = (0..4).min_by_key(|&corner| nodes[corner]).unwrap_or(0);
                nodes.rotate_left(lowest);
                facets.push(facet([nodes[0], nodes[1], nodes[2]]));
                facets.push(facet([nodes[0], nodes[2], nodes[3]]));
            }
        }
        Ok(facets)
    }

    /// The same body made of simplices: each quadrilateral is cut into two triangles, with diagonals that alternate on grids, and each hexahedron
    /// into six tetrahedra.
    ///
    /// # Errors
    /// The errors of [`Mesh::facets_from_cells`].
    pub fn into_simplices(self) -> Result<Mesh<D>, MeshError> {
        self.into_simplices_by(Cut::Six)
    }

    /// The same body made of simplices, with hexahedra cut as given.
    ///
    /// Nodes, groups, wires, sheets and quadratic cells are kept. Facets are recomputed if there were cells, and the parts of a cell keep its groups
    /// and values.
    ///
    /// # Errors
    /// The errors of [`Mesh::facets_from_cells`]; [`MeshError::OddLoop`] if hexahedra cannot be mirrored from one to the next.
    pub fn into_simplices_by(mut self, cut: Cut) -> Result<Mesh<D>, MeshError> {
        self.validate()?;
        if self.cells.is_empty() {
            return Ok(self);
        }
        let parts = if cut == Cut::Five { INSCRIBED[0].len() } else { KUHN.len() };
        // The old cell of each new cell. The parts of quadrilaterals follow the triangles, and the parts of hexahedra follow the tetrahedra.
        let (triangles, quadrilaterals) = (self.cells.triangles.len(), self.cells.quadrilaterals.len());
        let (tetrahedra, hexahedra) = (self.cells.tetrahedra.len(), self.cells.hexahedra.len());
        let mut origins: Vec<u32> = Vec::new();
        let mut first = 0;
        for (count, parts) in [(triangles, 1), (quadrilaterals, 2), (tetrahedra, 1), (hexahedra, parts)] {
            origins.extend((first..first + count).flat_map(|cell| std::iter::repeat_n(cell as u32, parts)));
            first += count;
        }
        origins.extend((first..self.cells.len()).map(|cell| cell as u32));
        for [a, b, c, d] in std::mem::take(&mut self.cells.quadrilaterals) {
            // On a grid with rows of n nodes the lower left node is i + n·j, so n is the step to the node above.
            let row = d.abs_diff(a).max(1);
            if (a % row + a / row).is_multiple_of(2) {
                self.cells.triangles.extend([[a, b, c], [a, c, d]]);
            } else {
                self.cells.triangles.extend([[a, b, d], [b, c, d]]);
            }
        }
        let alike = cut == Cut::Five || self.are_cut_alike();
        let parities = if cut == Cut::Five { self.node_parities()? } else { Vec::new() };
        for cell in std::mem::take(&mut self.cells.hexahedra) {
            match cut {
                Cut::Six if !alike => self.cells.tetrahedra.extend(from_the_least(&cell)),
                Cut::Six => self.cells.tetrahedra.extend(KUHN.map(|corners| corners.map(|corner| cell[corner]))),
                Cut::Five => {
                    let parts = INSCRIBED[usize::from(parities[cell[0] as usize])];
                    self.cells.tetrahedra.extend(parts.map(|corners| corners.map(|corner| cell[corner])));
                }
            }
        }
        self.follow_cells(&origins);
        self.facets = self.facets_from_cells()?;
        Ok(self)
    }

    /// Whether neighbours that are cut around their diagonals 0–6 cut their common faces along the same diagonal. They do so on grids, and if a file
    /// numbers the corners of all hexahedra in the same way.
    fn are_cut_alike(&self) -> bool {
        let mut faces: Vec<([u32; 4], [u32; 2])> = Vec::with_capacity(6 * self.cells.hexahedra.len());
        for cell in &self.cells.hexahedra {
            for face in &HEXAHEDRON_FACES {
                // The diagonals start at 0 or at 6.
                let Some(from) = face.iter().position(|corner| *corner == 0 || *corner == 6) else { continue };
                let [a, c] = [face[from], face[(from + 2) % 4]].map(|corner| cell[corner]);
                faces.push((distinct(face.map(|corner| cell[corner])), ascending(a, c)));
            }
        }
        faces.sort_unstable();
        faces.windows(2).all(|pair| pair[0].0 != pair[1].0 || pair[0].1 == pair[1].1)
    }

    /// The nodes that are an odd number of edges of hexahedra away from the first node of their piece. Every diagonal of a face then joins nodes of
    /// equal parity.
    fn node_parities(&self) -> Result<Vec<bool>, MeshError> {
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(24 * self.cells.hexahedra.len());
        for cell in &self.cells.hexahedra {
            edges.extend(HEXAHEDRON_EDGES.iter().flat_map(|&[i, j]| [[cell[i], cell[j]], [cell[j], cell[i]]]));
        }
        edges.sort_unstable();
        edges.dedup();
        let mut parities: Vec<Option<bool>> = vec![None; self.positions.len()];
        let mut open: Vec<u32> = Vec::new();
        for [first, _] in &edges {
            if parities[*first as usize].is_none() {
                parities[*first as usize] = Some(false);
                open.push(*first);
            }
            while let Some(node) = open.pop() {
                let own = parities[node as usize] == Some(true);
                let start = edges.partition_point(|edge| edge[0] < node);
                for [_, other] in edges[start..].iter().take_while(|edge| edge[0] == node) {
                    match parities[*other as usize] {
                        None => {
                            parities[*other as usize] = Some(!own);
                            open.push(*other);
                        }
                        Some(parity) if parity == own => {
                            return Err(MeshError::OddLoop { edge: ascending(node, *other) });
                        }
                        Some(_) => {}
                    }
                }
            }
        }
        Ok(parities.into_iter().map(|parity| parity == Some(true)).collect())
    }
}

/// Six tetrahedra from the node with the lowest number to the faces that do not contain it, each of which is cut from its own lowest node. In this
/// way, neighbours cut their common face in the same way, however their corners are numbered.
fn from_the_least(cell: &[u32; 8]) -> impl Iterator<Item = [u32; 4]> {
    let least = cell.iter().copied().fold(u32::MAX, u32::min);
    HEXAHEDRON_FACES
        .map(|face| face.map(|corner| cell[corner]))
        .into_iter()
        .filter(move |face| !face.contains(&least))
        .flat_map(move |face| {
            let first = (0..4).fold(0, |first, k| if face[k] < face[first] { k } else { first });
            let [a, b, c, d] = core::array::from_fn(|k| face[(first + k) % 4]);
            [[least, a, b, c], [least, a, c, d]]
        })
}

/// The first D nodes as a facet.
fn facet<const D: usize>(nodes: [u32; 3]) -> [u32; D] {
    std::array::from_fn(|index| nodes[index])
}

/// The distinct nodes of a face, ascending, filled up with `u32::MAX`.
fn distinct(mut nodes: [u32; 4]) -> [u32; 4] {
    nodes.sort_unstable();
    let mut key = [u32::MAX; 4];
    let mut used = 0;
    for node in nodes {
        if used == 0 || key[used - 1] != node {
            key[used] = node;
            used += 1;
        }
    }
    key
}
