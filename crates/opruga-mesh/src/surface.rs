//! Surfaces in space made of lattices: sheet, box, torus.

use std::f64::consts::PI;

use crate::geometry::{cross, norm};
use crate::lattice::{lattice, side_groups, station};
use crate::mesh::{count, finite, limit_nodes, positive};
use crate::{MAXIMUM_NODES, Mesh, MeshError, Must, Quantity};

/// The two triangles of a quadrilateral, cut along a–c if `even`, otherwise along b–d.
fn halves([a, b, c, d]: [u32; 4], even: bool) -> [[u32; 3]; 2] {
    if even { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// Indices of the nodes of a box surface: the lattice points of the surface, with x varying fastest, then y, then z.
struct Skin {
    cells: [u32; 3],
}

impl Skin {
    fn node(&self, [x, y, z]: [u32; 3]) -> u32 {
        let [nx, ny, nz] = self.cells;
        let (full, border) = ((nx + 1) * (ny + 1), 2 * (nx + ny));
        let layer = if z == 0 { 0 } else { full + (z - 1) * border };
        let within = if z == 0 || z == nz || y == 0 {
            // A full layer, or the first row of a border.
            x + (nx + 1) * y
        } else if y == ny {
            (nx + 1) + 2 * (ny - 1) + x
        } else {
            (nx + 1) + 2 * (y - 1) + u32::from(x == nx)
        };
        layer + within
    }
}

impl Mesh<3> {
    /// An open plane surface: the parallelogram of two sides [m] from a corner [m], divided into `cells` quadrilaterals along each side.
    ///
    /// ```text
    ///   v ^   n+1---n+2---n+3       node (x, y) has index x + (nu+1)·y
    ///     |    | \   |  /  |        each quadrilateral is cut into two triangles, with alternating diagonals,
    ///     |    |   \ | /   |        counter-clockwise seen from the side to which u × v points
    ///     |    0-----1-----2  --> u
    /// ```
    /// Groups: `left`, `right` (low and high u), `bottom`, `top` (v).
    ///
    /// # Errors
    /// [`MeshError::Count`] for a side without cells; [`MeshError::Size`] if a number is not finite or the sides span no area;
    /// [`MeshError::TooManyNodes`].
    pub fn sheet(corner: [f64; 3], sides: [[f64; 3]; 2], cells: [u32; 2]) -> Result<Mesh<3>, MeshError> {
        let [u, v] = sides;
        finite(Quantity::CornerSheet, &corner)?;
        positive(Quantity::AreaSheet, norm(cross(u, v)))?;
        count(Quantity::NumberCellsPerSide, cells[0], 1, MAXIMUM_NODES)?;
        count(Quantity::NumberCellsPerSide, cells[1], 1, MAXIMUM_NODES)?;
        limit_nodes((u64::from(cells[0]) + 1) * (u64::from(cells[1]) + 1))?;

        let at = |[x, y]: [u32; 2]| {
            std::array::from_fn(|axis| {
                corner[axis] + station(0.0, u[axis], x, cells[0]) + station(0.0, v[axis], y, cells[1])
            })
        };
        let mut mesh = Mesh {
            positions: lattice(cells).map(at).collect(),
            groups: side_groups(lattice(cells), cells),
            ..Mesh::default()
        };
        let row = cells[0] + 1;
        for [x, y] in lattice([cells[0] - 1, cells[1] - 1]) {
            let a = x + row * y;
            let quadrilateral = [a, a + 1, a + row + 1, a + row];
            mesh.sheet_quadrilaterals.push(quadrilateral);
            mesh.sheets.extend(halves(quadrilateral, (x + y) % 2 == 1));
        }
        Ok(mesh)
    }

    /// The closed surface of a box of `size` [m] from its `lower` corner [m], with `cells` divisions per axis. Each face is divided into two
    /// triangles per cell, with alternating diagonals.
    ///
    /// The surface has 2(nx·ny + ny·nz + nz·nx) + 2 nodes, numbered by layers of z, rows of y, then x. It has twice as many facets as nodes, minus
    /// four. Groups as for [`Mesh::grid`].
    ///
    /// # Errors
    /// [`MeshError::Count`] for an axis without cells; [`MeshError::Size`] for sizes that are not positive and finite; [`MeshError::TooManyNodes`].
    pub fn box_surface(lower: [f64; 3], size: [f64; 3], cells: [u32; 3]) -> Result<Mesh<3>, MeshError> {
        finite(Quantity::LowerCornerBox, &lower)?;
        for axis in 0..3 {
            count(Quantity::NumberCellsPerAxis, cells[axis], 1, MAXIMUM_NODES)?;
            positive(Quantity::SizeBox, size[axis])?;
        }
        let [nx, ny, nz] = cells.map(u64::from);
        limit_nodes(2 * (nx * ny + ny * nz + nz * nx) + 2)?;

        // Lattice points of the surface in node order.
        let mut points = Vec::new();
        for z in 0..=cells[2] {
            for y in 0..=cells[1] {
                let inner = 0 < z && z < cells[2] && 0 < y && y < cells[1];
                let step = if inner { cells[0] as usize } else { 1 };
                points.extend((0..=cells[0]).step_by(step).map(|x| [x, y, z]));
            }
        }
        let at =
            |index: &[u32; 3]| std::array::from_fn(|axis| station(lower[axis], size[axis], index[axis], cells[axis]));
        let positions = points.iter().map(at).collect();
        let groups = side_groups(points.iter().copied(), cells);

        // Each pair of axes (u, v) with u × v along w spans the far side; the near side has the opposite orientation.
        let skin = Skin { cells };
        let mut facets = Vec::new();
        for w in 0..3 {
            let (u, v) = ((w + 1) % 3, (w + 2) % 3);
            for far in [false, true] {
                for [i, j] in lattice([cells[u] - 1, cells[v] - 1]) {
                    let node = |p: u32, q: u32| {
                        let mut index = [0; 3];
                        index[w] = if far { cells[w] } else { 0 };
                        index[u] = p;
                        index[v] = q;
                        skin.node(index)
                    };
                    let (a, b, c, d) = (node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1));
                    let quadrilateral = if far { [a, b, c, d] } else { [a, d, c, b] };
                    facets.extend(halves(quadrilateral, (i + j) % 2 == 0));
                }
            }
        }
        Ok(Mesh { positions, facets, groups, ..Mesh::default() })
    }

    /// A torus about the z axis through the origin: a tube of radius `minor` [m] around a circle of radius `major` [m] in the plane z = 0.
    ///
    /// Node (i, j) of `counts` = (around the axis, around the tube) has index i·counts[1] + j. Each cell of this lattice is cut along (i, j)–(i+1, j+1).
    ///
    /// # Errors
    /// [`MeshError::Count`] for fewer than 3 nodes around; [`MeshError::Size`] for radii that are not positive and finite, or a tube that closes the
    /// hole (`minor` ≥ `major`); [`MeshError::TooManyNodes`].
    pub fn torus(major: f64, minor: f64, counts: [u32; 2]) -> Result<Mesh<3>, MeshError> {
        let [around, tube] = counts;
        count(Quantity::NumberNodesAroundAxis, around, 3, MAXIMUM_NODES)?;
        count(Quantity::NumberNodesAroundTube, tube, 3, MAXIMUM_NODES)?;
        limit_nodes(u64::from(around) * u64::from(tube))?;
        positive(Quantity::MajorRadius, major)?;
        positive(Quantity::MinorRadius, minor)?;
        if minor >= major {
            return Err(MeshError::Size { what: Quantity::MinorRadius, value: minor, must: Must::BelowMajorRadius });
        }
        let turn = |index: u32, of: u32| {
            let angle = 2.0 * PI * f64::from(index) / f64::from(of);
            (libm::sin(angle), libm::cos(angle))
        };
        let mut positions = Vec::with_capacity(around as usize * tube as usize);
        let mut facets = Vec::with_capacity(2 * positions.capacity());
        for i in 0..around {
            let (su, cu) = turn(i, around);
            for j in 0..tube {
                let (sv, cv) = turn(j, tube);
                let r = major + minor * cv;
                positions.push([r * cu, r * su, minor * sv]);
                let (next_i, next_j) = ((i + 1) % around, (j + 1) % tube);
                let quadrilateral = [i * tube + j, next_i * tube + j, next_i * tube + next_j, i * tube + next_j];
                facets.extend(halves(quadrilateral, true));
            }
        }
        Ok(Mesh { positions, facets, ..Mesh::default() })
    }
}
