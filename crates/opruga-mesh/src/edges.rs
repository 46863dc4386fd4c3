//! Edges in the order of memory access, and the area beside each.

use crate::Mesh;
use crate::MeshError;
use crate::geometry::{HEXAHEDRON_FACES, ascending, lift, triangle_area};
use crate::quadratic::{tetrahedron_parts, triangle_parts};

/// The set of edges of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeSet {
    /// Edges of the boundary facets.
    Boundary,
    /// Edges of facets, wires, sheets and cells. This set excludes the diagonals that only cut the boundary faces of hexahedra into triangles,
    /// because they would stiffen one diagonal of the skin and not the other. Quadratic cells have the edges of the triangles through the nodes of
    /// their faces.
    All,
    /// `All`, with both diagonals of every quadrilateral and of every face of a hexahedron (not the diagonals through its interior).
    AllWithShear,
}

/// A run of edges (a, b), (a+1, b+1), …, (a+count−1, b+count−1), which can be processed without reading the edge list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EdgeRun {
    /// Position of the first edge in the edge list.
    pub start: u32,
    /// Nodes (a, b) of the first edge.
    pub first: [u32; 2],
    /// Number of edges.
    pub count: u32,
}

/// Splits an edge list into its maximal runs, in list order. A ring gives two runs: its sides, and the edge that closes it.
pub fn edge_runs(edges: &[[u32; 2]]) -> Vec<EdgeRun> {
    let mut runs: Vec<EdgeRun> = Vec::new();
    for (index, &[a, b]) in edges.iter().enumerate() {
        match runs.last_mut() {
            Some(run)
                if run.first[0].checked_add(run.count) == Some(a) && run.first[1].checked_add(run.count) == Some(b) =>
            {
                run.count += 1
            }
            _ => runs.push(EdgeRun { start: index as u32, first: [a, b], count: 1 }),
        }
    }
    runs
}

/// The largest difference |b − a| between the indices of the ends of an edge, which is the distance between neighbours in memory. The difference is
/// zero if there are no edges.
pub fn bandwidth(edges: &[[u32; 2]]) -> u32 {
    edges.iter().map(|&[a, b]| a.abs_diff(b)).max().unwrap_or(0)
}

/// Adds the sides of a closed polygon of nodes.
fn push_sides(nodes: &[u32], out: &mut Vec<[u32; 2]>) {
    for (index, &a) in nodes.iter().enumerate() {
        out.push(ascending(a, nodes[(index + 1) % nodes.len()]));
    }
}

/// Adds both diagonals of a quadrilateral.
fn push_diagonals([a, b, c, d]: [u32; 4], out: &mut Vec<[u32; 2]>) {
    out.push(ascending(a, c));
    out.push(ascending(b, d));
}

/// The six faces of a hexahedron, each as four nodes.
fn faces(cell: &[u32; 8]) -> [[u32; 4]; 6] {
    HEXAHEDRON_FACES.map(|face| face.map(|corner| cell[corner]))
}

impl<const D: usize> Mesh<D> {
    /// The edges of the set, each once, with the lower node first, in the order of (b − a, a).
    ///
    /// Edges with the same difference b − a are adjacent in the list, so that long runs (a+k, b+k) appear. A loop over springs can then stream
    /// through memory without an index. A ring gives (0,1), (1,2), …, (n−2,n−1) and then (0,n−1); a grid gives all its horizontal edges, then each
    /// family of diagonals and all its vertical edges. [`edge_runs`] lists the runs.
    pub fn edges(&self, set: EdgeSet) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        for facet in &self.facets {
            if D == 2 {
                edges.push(ascending(facet[0], facet[1]));
            } else {
                push_sides(facet, &mut edges);
            }
        }
        if set != EdgeSet::Boundary {
            // Facet edges that are diagonals of hexahedron faces have no spring of their own.
            if set == EdgeSet::All && !self.cells.hexahedra.is_empty() {
                let mut diagonals = Vec::new();
                for cell in &self.cells.hexahedra {
                    faces(cell).into_iter().for_each(|face| push_diagonals(face, &mut diagonals));
                }
                diagonals.sort_unstable();
                edges.retain(|edge| diagonals.binary_search(edge).is_err());
            }
            self.push_inner_edges(&mut edges);
        }
        if set == EdgeSet::AllWithShear {
            for &quadrilateral in self.cells.quadrilaterals.iter().chain(&self.sheet_quadrilaterals) {
                push_diagonals(quadrilateral, &mut edges);
            }
            for cell in &self.cells.hexahedra {
                faces(cell).into_iter().for_each(|face| push_diagonals(face, &mut edges));
            }
        }

        // One sort makes edges unique and gives the runs.
        edges.sort_unstable_by_key(|&[a, b]| (b - a, a));
        edges.dedup();
        edges
    }

    /// Adds the edges of wires, sheets and cells.
    fn push_inner_edges(&self, edges: &mut Vec<[u32; 2]>) {
        edges.extend(self.wires.iter().map(|&[a, b]| ascending(a, b)));
        self.sheets.iter().for_each(|triangle| push_sides(triangle, edges));
        self.sheet_quadrilaterals.iter().for_each(|quadrilateral| push_sides(quadrilateral, edges));
        self.cells.triangles.iter().for_each(|triangle| push_sides(triangle, edges));
        self.cells.quadrilaterals.iter().for_each(|quadrilateral| push_sides(quadrilateral, edges));
        for &[a, b, c, d] in &self.cells.tetrahedra {
            push_sides(&[a, b, c], edges);
            [a, b, c].into_iter().for_each(|corner| edges.push(ascending(corner, d)));
        }
        for cell in &self.cells.hexahedra {
            push_sides(&cell[..4], edges);
            push_sides(&cell[4..], edges);
            (0..4).for_each(|corner| edges.push(ascending(cell[corner], cell[corner + 4])));
        }
        for cell in &self.cells.quadratic_triangles {
            triangle_parts(cell).iter().for_each(|triangle| push_sides(triangle, edges));
        }
        for cell in &self.cells.quadratic_tetrahedra {
            tetrahedron_parts(cell).for_each(|triangle| push_sides(&triangle, edges));
        }
    }

    /// The sum ΣA of the areas of the triangles beside each edge [m²], one value per edge of the list.
    ///
    /// Triangles are the facets in space, sheet triangles, triangle cells and the four parts of quadratic triangles. On a regular triangular lattice,
    /// the membrane stiffness k = E₂D ΣA / l² (E₂D [N/m], l [m]) is √3/2·E₂D inside. On the border, where only one triangle adjoins the edge, k is
    /// half as large.
    ///
    /// A quadrilateral (cell or sheet) is cut along the diagonal that the edge list contains. With both diagonals, or with none, a quadrilateral
    /// counts as the mean of its two triangulations: a rectangle of area A then adds A/2 to each side and A/2 to each diagonal. Edges without
    /// adjacent area get 0.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`].
    pub fn edge_areas(&self, edges: &[[u32; 2]]) -> Result<Vec<f64>, MeshError> {
        self.validate()?;

        // A sorted copy gives the index of an edge in any list.
        let mut sorted: Vec<([u32; 2], usize)> =
            edges.iter().enumerate().map(|(index, &[a, b])| (ascending(a, b), index)).collect();
        sorted.sort_unstable();
        let find = |a: u32, b: u32| {
            let edge = ascending(a, b);
            let slot = sorted.partition_point(|entry| entry.0 < edge);
            sorted.get(slot).filter(|entry| entry.0 == edge).map(|entry| entry.1)
        };
        let at = |node: u32| lift(&self.positions[node as usize]);
        let mut areas = vec![0.0; edges.len()];
        let mut add = |[a, b, c]: [u32; 3], weight: f64| {
            let area = weight * triangle_area(at(a), at(b), at(c));
            for (p, q) in [(a, b), (b, c), (c, a)] {
                if let Some(index) = find(p, q) {
                    areas[index] += area;
                }
            }
        };

        // All triangles except the sheet triangles that make up quadrilaterals, which follow below.
        let loose = self.sheets.get(2 * self.sheet_quadrilaterals.len()..).unwrap_or_default();
        for &triangle in self.facet_triangles().iter().chain(loose).chain(&self.cells.triangles) {
            add(triangle, 1.0);
        }
        self.cells.quadratic_triangles.iter().flat_map(triangle_parts).for_each(|triangle| add(triangle, 1.0));
        // Quadrilaterals, cut along the diagonals in the list.
        for &[a, b, c, d] in self.cells.quadrilaterals.iter().chain(&self.sheet_quadrilaterals) {
            let (weight_ac, weight_bd) = match (find(a, c).is_some(), find(b, d).is_some()) {
                (true, false) => (1.0, 0.0),
                (false, true) => (0.0, 1.0),
                _ => (0.5, 0.5),
            };
            add([a, b, c], weight_ac);
            add([a, c, d], weight_ac);
            add([a, b, d], weight_bd);
            add([b, c, d], weight_bd);
        }

        // An edge that is listed twice has the same area both times.
        for pair in sorted.windows(2) {
            if pair[0].0 == pair[1].0 {
                areas[pair[1].1] = areas[pair[0].1];
            }
        }
        Ok(areas)
    }
}
