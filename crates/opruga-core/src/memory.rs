//! The memory that a body will need, estimated from the counts of its mesh before anything is built.
//!
//! The numbers of bytes come from measured runs (docs/performance.md, "Memory"). A test compares the estimates with the memory
//! of runs.

use opruga_mesh::Mesh;

/// The memory that a part of a body needs, and the pairs of nodes that it couples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Need {
    /// Memory [bytes].
    pub bytes: f64,
    /// The number of pairs of nodes that the part couples. Each is a block above the diagonal of a matrix.
    pub couplings: f64,
}

/// The counts that determine memory. Edges and pairs of nodes that cells share are counted by their mean number per cell in large meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    /// The number of nodes.
    pub nodes: f64,
    /// The number of edges of cells or, if there are no cells, of surfaces and wires.
    pub edges: f64,
    /// The number of edges of surfaces across which two triangles bend.
    pub hinges: f64,
    /// The number of sides of the boundary.
    pub facets: f64,
    /// The number of bytes that finite elements store for the cells.
    pub cell_bytes: f64,
    /// The number of pairs of nodes that have a cell in common.
    pub cell_pairs: f64,
    /// Whether the body fills space, so that factors of its matrix have many more blocks than the factors of a surface.
    pub is_bulk: bool,
}

impl Counts {
    /// The counts of a mesh.
    pub fn of<const D: usize>(mesh: &Mesh<D>) -> Counts {
        let (cells, facets) = (&mesh.cells, mesh.facets.len() as f64);
        // Per cell: edges, pairs of nodes, bytes.
        let rows = [
            (cells.triangles.len(), 1.5, 1.5, 370.0),
            (cells.quadrilaterals.len(), 2.0, 4.0, 440.0),
            (cells.tetrahedra.len(), 1.2, 1.2, 466.0),
            (cells.hexahedra.len(), 3.0, 13.0, 1700.0),
            (cells.quadratic_triangles.len(), 3.0, 10.5, 970.0),
            (cells.quadratic_tetrahedra.len(), 2.4, 20.0, 1143.0),
        ];
        let sum = |of: fn(&(usize, f64, f64, f64)) -> f64| rows.iter().map(|row| row.0 as f64 * of(row)).sum::<f64>();
        let triangles = mesh.sheets.len() as f64 + if D == 3 { facets } else { 0.0 };
        let around = if !cells.is_empty() {
            0.0
        } else if D == 3 {
            1.5 * facets
        } else {
            facets
        };
        Counts {
            nodes: mesh.nodes() as f64,
            edges: sum(|row| row.1) + around + mesh.wires.len() as f64 + 1.5 * mesh.sheets.len() as f64,
            hinges: 1.5 * triangles + if D == 2 { facets } else { 0.0 } + mesh.wires.len() as f64,
            facets,
            cell_bytes: sum(|row| row.3),
            cell_pairs: sum(|row| row.2),
            is_bulk: D == 3 && !cells.is_empty(),
        }
    }

    /// The memory of the mesh, however many bodies use it [bytes].
    pub fn mesh_bytes<const D: usize>(&self) -> f64 {
        self.nodes * (20.0 + 30.0 * D as f64) + 40.0 * self.facets
    }

    /// The memory of the description of one body and of the state of its nodes [bytes].
    pub fn state_bytes<const D: usize>(&self) -> f64 {
        1000.0 + self.nodes * (40.0 + 30.0 * D as f64)
    }
}
