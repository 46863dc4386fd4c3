//! Frames for other programs: VTK (ParaView), Wavefront OBJ (Blender) and Stanford PLY (MeshLab), one file per frame. [`crate::tracks`] writes whole
//! runs to one file.

pub(crate) mod vtu;

pub use vtu::write_pvd;

use opruga_world::AnyBody;
use std::io::{self, Write};

/// A body in one frame.
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// The body. It gives the name, the elements, and the positions at the time when it was added, from which displacements are measured.
    pub body: &'a dyn AnyBody,
    /// Positions, node by node; z is 0 in the plane [m].
    pub positions: &'a [[f64; 3]],
    /// Velocities, node by node [m/s].
    pub velocities: &'a [[f64; 3]],
    /// Quantities that models compute for every cell, such as stress.
    pub cell_fields: &'a [CellField<'a>],
}

/// The values for every filled cell of a body, in the order of [`opruga_mesh::Cells::iter`].
#[derive(Clone, Copy, Debug)]
pub struct CellField<'a> {
    /// The name of the quantity with its unit, such as `von Mises stress [Pa]`.
    pub name: &'a str,
    /// Number of values per cell: 1, or 9 for a tensor, row by row.
    pub components: usize,
    /// The values, cell by cell.
    pub values: &'a [f64],
}

/// A file format for frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Legacy VTK, ASCII: cells, surfaces and lines, with velocities, the number of the body, and the time.
    Vtk,
    /// VTK XML, base64: like `Vtk`, with displacements, groups, values of cells and fields of models (stress).
    Vtu,
    /// Wavefront OBJ: surfaces and lines, body by body.
    Obj,
    /// Stanford PLY, ASCII: surfaces and lines, with velocities.
    Ply,
}

impl Format {
    /// The ending of the files of this format.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Vtk => "vtk",
            Format::Vtu => "vtu",
            Format::Obj => "obj",
            Format::Ply => "ply",
        }
    }

    /// Writes one frame. In the plane z is zero. Numbers are written with all their digits.
    ///
    /// # Errors
    /// The errors of the writer.
    pub fn write(self, out: &mut dyn Write, title: &str, time: f64, shapes: &[Shape<'_>]) -> io::Result<()> {
        match self {
            Format::Vtk => vtk(out, title, time, shapes),
            Format::Vtu => vtu::write(out, time, shapes),
            Format::Obj => obj(out, title, time, shapes),
            Format::Ply => ply(out, title, time, shapes),
        }
    }
}

/// Writes the list of a series of VTK files with their times, in the format of ParaView (`NAME.vtk.series`).
///
/// # Errors
/// The errors of the writer.
pub fn write_vtk_series(out: &mut dyn Write, files: &[(String, f64)]) -> io::Result<()> {
    let rows: Vec<_> = files.iter().map(|(name, time)| serde_json::json!({"name": name, "time": time})).collect();
    let series = serde_json::json!({"file-series-version": "1.0", "files": rows});
    serde_json::to_writer_pretty(&mut *out, &series)?;
    writeln!(out)
}

/// The elements that are drawn for a body. The nodes of these elements are counted from the first node of the first body.
struct Elements {
    /// Elements with their VTK type.
    all: Vec<(u8, Vec<usize>)>,
}

const LINE: u8 = 3;
const TRIANGLE: u8 = 5;
const QUADRILATERAL: u8 = 9;
const TETRAHEDRON: u8 = 10;
const HEXAHEDRON: u8 = 12;
const QUADRATIC_TRIANGLE: u8 = 22;
const QUADRATIC_TETRAHEDRON: u8 = 24;

impl Elements {
    /// The cells of filled bodies if `filled` is set, otherwise the boundary; wires are always included.
    fn of(body: &dyn AnyBody, filled: bool, first: usize) -> Elements {
        let (cells, flat) = (body.cells(), body.dimension() == 2);
        let mut all = Vec::new();
        let mut add = |kind: u8, nodes: &[u32]| all.push((kind, nodes.iter().map(|n| first + *n as usize).collect()));
        if !cells.is_empty() && (filled || flat) {
            cells.triangles.iter().for_each(|c| add(TRIANGLE, c));
            cells.quadrilaterals.iter().for_each(|c| add(QUADRILATERAL, c));
            cells.tetrahedra.iter().for_each(|c| add(TETRAHEDRON, c));
            cells.hexahedra.iter().for_each(|c| add(HEXAHEDRON, c));
            cells.quadratic_triangles.iter().for_each(|c| add(QUADRATIC_TRIANGLE, c));
            cells.quadratic_tetrahedra.iter().for_each(|c| add(QUADRATIC_TETRAHEDRON, c));
        } else {
            let facets = body.facets().chunks_exact(body.dimension());
            facets.for_each(|facet| add(if flat { LINE } else { TRIANGLE }, facet));
        }
        body.sheets().iter().for_each(|s| add(TRIANGLE, s));
        body.wires().iter().for_each(|w| add(LINE, w));
        Elements { all }
    }

    fn lines(&self) -> impl Iterator<Item = &[usize]> {
        self.all.iter().filter(|e| e.0 == LINE).map(|e| &e.1[..])
    }

    fn faces(&self) -> impl Iterator<Item = &[usize]> {
        self.all.iter().filter(|e| e.0 != LINE).map(|e| &e.1[..])
    }
}

/// Elements of all bodies, body by body.
fn elements(shapes: &[Shape<'_>], filled: bool) -> Vec<Elements> {
    let mut first = 0;
    let of = |shape: &Shape<'_>| {
        let elements = Elements::of(shape.body, filled, first);
        first += shape.positions.len();
        elements
    };
    shapes.iter().map(of).collect()
}

/// Three numbers.
fn three([x, y, z]: &[f64; 3]) -> String {
    format!("{x:e} {y:e} {z:e}")
}

/// Makes a text safe to be a name on a line: without spaces, which would end it.
fn word(text: &str) -> String {
    text.chars().map(|c| if c.is_control() || c.is_whitespace() { '_' } else { c }).collect()
}

fn line(text: &str) -> String {
    text.chars().filter(|c| !c.is_control()).take(200).collect()
}

fn joined(nodes: &[usize], shift: usize) -> String {
    nodes.iter().map(|n| (n + shift).to_string()).collect::<Vec<_>>().join(" ")
}

fn vtk(out: &mut dyn Write, title: &str, time: f64, shapes: &[Shape<'_>]) -> io::Result<()> {
    let elements = elements(shapes, true);
    let points: usize = shapes.iter().map(|s| s.positions.len()).sum();
    let all = || elements.iter().enumerate().flat_map(|(body, e)| e.all.iter().map(move |e| (body, e)));
    let (count, size) = all().fold((0, 0), |(count, size), (_, e)| (count + 1, size + 1 + e.1.len()));
    // The second line may have at most 256 bytes.
    let title: String = line(title).chars().filter(char::is_ascii).collect();
    writeln!(out, "# vtk DataFile Version 3.0\n{title}\nASCII\nDATASET UNSTRUCTURED_GRID")?;
    writeln!(out, "FIELD FieldData 1\nTIME 1 1 double\n{time:e}")?;
    writeln!(out, "POINTS {points} double")?;
    for x in shapes.iter().flat_map(|s| s.positions) {
        writeln!(out, "{}", three(x))?;
    }
    writeln!(out, "CELLS {count} {size}")?;
    for (_, (_, nodes)) in all() {
        writeln!(out, "{} {}", nodes.len(), joined(nodes, 0))?;
    }
    writeln!(out, "CELL_TYPES {count}")?;
    for (_, (kind, _)) in all() {
        writeln!(out, "{kind}")?;
    }
    writeln!(out, "CELL_DATA {count}\nSCALARS body int 1\nLOOKUP_TABLE default")?;
    for (body, _) in all() {
        writeln!(out, "{body}")?;
    }
    writeln!(out, "POINT_DATA {points}\nVECTORS velocity double")?;
    for v in shapes.iter().flat_map(|s| s.velocities) {
        writeln!(out, "{}", three(v))?;
    }
    Ok(())
}

fn obj(out: &mut dyn Write, title: &str, time: f64, shapes: &[Shape<'_>]) -> io::Result<()> {
    writeln!(out, "# {}\n# t = {time} s", line(title))?;
    for (shape, elements) in shapes.iter().zip(elements(shapes, false)) {
        writeln!(out, "o {}", word(shape.body.name()))?;
        for x in shape.positions {
            writeln!(out, "v {}", three(x))?;
        }
        for nodes in elements.faces() {
            writeln!(out, "f {}", joined(nodes, 1))?;
        }
        for nodes in elements.lines() {
            writeln!(out, "l {}", joined(nodes, 1))?;
        }
    }
    Ok(())
}

fn ply(out: &mut dyn Write, title: &str, time: f64, shapes: &[Shape<'_>]) -> io::Result<()> {
    let elements = elements(shapes, false);
    let points: usize = shapes.iter().map(|s| s.positions.len()).sum();
    let faces: usize = elements.iter().map(|e| e.faces().count()).sum();
    let edges: usize = elements.iter().map(|e| e.lines().count()).sum();
    writeln!(out, "ply\nformat ascii 1.0\ncomment {}\ncomment t = {time} s", line(title))?;
    writeln!(out, "element vertex {points}")?;
    for name in ["x", "y", "z", "vx", "vy", "vz"] {
        writeln!(out, "property double {name}")?;
    }
    writeln!(out, "element face {faces}\nproperty list uchar int vertex_indices")?;
    writeln!(out, "element edge {edges}\nproperty int vertex1\nproperty int vertex2\nend_header")?;
    for (x, v) in shapes.iter().flat_map(|s| s.positions.iter().zip(s.velocities)) {
        writeln!(out, "{} {}", three(x), three(v))?;
    }
    for nodes in elements.iter().flat_map(Elements::faces) {
        writeln!(out, "{} {}", nodes.len(), joined(nodes, 0))?;
    }
    for nodes in elements.iter().flat_map(Elements::lines) {
        writeln!(out, "{}", joined(nodes, 0))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_mesh::Mesh;
    use opruga_world::blueprint::{BodyBlueprint, Mass};

    fn body<const D: usize>(name: &str, mesh: Mesh<D>) -> BodyBlueprint<D> {
        BodyBlueprint::new(name, mesh, Mass::Total(1.0), Vec::new())
    }

    fn written(format: Format) -> String {
        let square = Mesh { positions: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], ..Mesh::<2>::default() };
        let ring = Mesh { facets: vec![[0, 1], [1, 2], [2, 0]], ..square.clone() };
        let wire = Mesh { wires: vec![[0, 1]], positions: vec![[0.0; 2]; 2], ..Mesh::default() };
        let (ring, wire) = (body("a ring", ring), body("wire", wire));
        let shapes = [
            Shape {
                body: &ring,
                positions: &ring.rest_positions(),
                velocities: &[[0.1, -2.0, 0.0]; 3],
                cell_fields: &[],
            },
            Shape {
                body: &wire,
                positions: &[[5.0, 1e-9, 0.0], [6.0, 0.0, 0.0]],
                velocities: &[[0.0; 3]; 2],
                cell_fields: &[],
            },
        ];
        let mut out = Vec::new();
        format.write(&mut out, "two\nbodies", 0.25, &shapes).expect("memory does not fail");
        String::from_utf8(out).expect("text")
    }

    /// The nodes of the second body are numbered after those of the first. OBJ counts from one, the others from zero.
    #[test]
    fn elements_name_the_nodes_of_their_own_body() {
        let obj = written(Format::Obj);
        assert!(obj.contains("# twobodies\n# t = 0.25 s\no a_ring\nv 0e0 0e0 0e0\nv 1e0 0e0 0e0\n"), "{obj}");
        assert!(obj.ends_with("l 1 2\nl 2 3\nl 3 1\no wire\nv 5e0 1e-9 0e0\nv 6e0 0e0 0e0\nl 4 5\n"), "{obj}");
        let ply = written(Format::Ply);
        assert!(ply.contains("element vertex 5\n") && ply.contains("element face 0\n"), "{ply}");
        assert!(ply.contains("end_header\n0e0 0e0 0e0 1e-1 -2e0 0e0\n") && ply.ends_with("2 0\n3 4\n"), "{ply}");
        let vtk = written(Format::Vtk);
        assert!(vtk.contains("TIME 1 1 double\n2.5e-1\nPOINTS 5 double\n"), "{vtk}");
        assert!(vtk.contains("CELLS 4 12\n2 0 1\n2 1 2\n2 2 0\n2 3 4\nCELL_TYPES 4\n3\n3\n3\n3\n"), "{vtk}");
        assert!(vtk.contains("LOOKUP_TABLE default\n0\n0\n0\n1\nPOINT_DATA 5\n"), "{vtk}");
    }

    /// A solid is exported to VTK with its interior, and to the other formats by its surface.
    #[test]
    fn solids_have_cells_in_vtk_and_surfaces_elsewhere() {
        let mut mesh = Mesh::<3> {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            facets: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            ..Mesh::default()
        };
        mesh.cells.tetrahedra.push([0, 1, 2, 3]);
        let solid = body("t", mesh);
        let shape =
            Shape { body: &solid, positions: &solid.mesh.positions, velocities: &[[0.0; 3]; 4], cell_fields: &[] };
        let text = |format: Format| {
            let mut out = Vec::new();
            format.write(&mut out, "", 0.0, &[shape]).expect("memory does not fail");
            String::from_utf8(out).expect("text")
        };
        assert!(text(Format::Vtk).contains("CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"));
        assert!(text(Format::Obj).ends_with("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"));
        assert!(text(Format::Ply).ends_with("3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"));
    }

    /// The frame of a solid as VTK XML can be read as a mesh file; time, displacement and fields of cells are where VTK expects them.
    #[test]
    fn frames_in_vtk_xml_are_whole() {
        let grid = Mesh::<3>::grid([0.0; 3], [1.0; 3], [2, 1, 1]).unwrap().into_simplices().unwrap();
        let mut mesh = grid.into_quadratic().unwrap();
        mesh.cell_groups.insert("some".into(), vec![1]);
        let moved: Vec<[f64; 3]> = mesh.positions.iter().map(|x| [x[0] + 5.0, 2.0 * x[1], x[2]]).collect();
        let (still, stress) = (vec![[0.0; 3]; mesh.nodes()], vec![1.5; 9 * mesh.cells.len()]);
        let fields = [CellField { name: "Cauchy stress [Pa]", components: 9, values: &stress }];
        let solid = BodyBlueprint { translation: [5.0, 0.0, 0.0], ..body("b", mesh.clone()) };
        let shape = Shape { body: &solid, positions: &moved, velocities: &still, cell_fields: &fields };
        let mut out = Vec::new();
        Format::Vtu.write(&mut out, "", 0.25, &[shape]).expect("memory does not fail");
        let text = core::str::from_utf8(&out).expect("text");
        let place = |what: &str| text.find(what).unwrap_or_else(|| panic!("{what}"));
        let time = crate::base64::encode(&[8u64.to_le_bytes(), 0.25f64.to_le_bytes()].concat());
        assert!(place(&time) < place("<Piece") && place("<PointData>") < place("displacement [m]"));
        assert!(place("Name=\"Cauchy stress [Pa]\" NumberOfComponents=\"9\"") > place("<CellData>"));
        let mut open = |_: &str| -> Result<std::sync::Arc<[u8]>, crate::SceneError> { panic!("no other file") };
        let file = crate::meshes::read("a.vtu", &out, &mut open).expect("a mesh");
        let (again, left_out) = file.assemble::<3>(crate::meshes::Mending::default()).expect("a body");
        assert_eq!((&again.positions, &again.cells), (&moved, &mesh.cells));
        assert_eq!(again.cell_values["group some"][..2], [0.0, 1.0]);
        assert_eq!(again.node_values["velocity [m/s]"].values, vec![0.0; 3 * mesh.nodes()]);
        assert_eq!(again.node_values["displacement [m]"].values[..3], [0.0, 0.0, 0.0]);
        assert_eq!(left_out.len(), 1, "stress is no part of a body at rest");
    }
}
