//! Writes meshes to files of other programs.

use super::found::Kind;
use crate::problem::{SceneError, visible};
use crate::series::vtu;
use opruga_math::words::counted;
use opruga_mesh::{Element, Mesh};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The endings of files that can be written.
pub const WRITTEN: &str = ".msh (Gmsh 4.1), .vtk, .vtu, .mesh (Medit), .mfem (MFEM), .node and .ele (TetGen)";

/// A mesh as files.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Endings, without the dot, and contents.
    pub files: Vec<(&'static str, Vec<u8>)>,
    /// What the format cannot represent.
    pub left_out: Vec<LeftOut>,
}

opruga_math::messages! {
    /// Parts of a mesh that a format cannot represent.
    #[derive(Clone, Debug, PartialEq)]
    pub enum LeftOut {
        "part.left_out" #[error("`{name}`, which not all cells have")]
        CellValues { name: String },
        "part.left_out" #[error("`{name}`, which not all nodes have")]
        NodeValues { name: String },
        "part.left_out" #[error("{}", counted(*count as u64, "value that not all cells have", "values that not all cells have"))]
        GappyValues { count: usize },
        "part.left_out" #[error("the names of {}", counted(*count as u64, "group", "groups"))]
        GroupNames { count: usize },
        "part.left_out" #[error("names of {}; the groups are numbered from 1, in alphabetical order of their names", counted(*count as u64, "group of cells", "groups of cells"))]
        NamesOfCellGroups { count: usize },
        "part.left_out" #[error("names of {}", counted(*count as u64, "value of cells", "values of cells"))]
        NamesOfCellValues { count: usize },
        "part.left_out" #[error("{}", counted(*count as u64, "group", "groups"))]
        Groups { count: usize },
        "part.left_out" #[error("{}", counted(*count as u64, "group of nodes", "groups of nodes"))]
        GroupsOfNodes { count: usize },
        "part.left_out" #[error("{}", counted(*count as u64, "value of cells", "values of cells"))]
        ValuesOfCells { count: usize },
        "part.left_out" #[error("{}", counted(*count as u64, "value of nodes", "values of nodes"))]
        ValuesOfNodes { count: usize },
    }
    /// The notice that a part is omitted.
    #[derive(Clone, Debug, PartialEq)]
    pub enum NotInFormat {
        "mesh.left_out" #[error("left out, because the format cannot store it: {what}")]
        LeftOutOfFormat { what: LeftOut },
    }
}

opruga_math::messages! {
    /// Errors of writing a mesh.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MeshWriteError {
        "mesh.write" #[error("the mesh has no cells")] #[value("0")] #[allowed("at least one cell")]
        #[hint("a filling makes cells inside a surface or an outline")]
        NoCellsToWrite {},
        "mesh.write" #[error("files ending in `.{ending}` cannot be written")] #[value("{ending}")] #[allowed("{WRITTEN}")]
        Ending { ending: String },
        "mesh.write" #[error("cells of second order are not written to {format} files")] #[value("{cells}")] #[allowed("linear cells")]
        #[hint("`.msh`, `.vtk` and `.vtu` files can store them")]
        SecondOrder { format: &'static str, cells: usize },
        "mesh.write" #[error("a TetGen file cannot contain quadrilaterals or hexahedra")] #[value("{cells}")] #[allowed("triangles or tetrahedra")]
        Boxes { cells: usize },
    }
}

/// Writes the cells of a mesh, its groups, values of cells and of nodes, in the format of an ending (without the dot).
///
/// # Errors
/// `mesh.write` for an unknown ending, a mesh without cells, and cells that the format does not have.
pub fn write<const D: usize>(mesh: &Mesh<D>, ending: &str) -> Result<Written, SceneError> {
    if mesh.cells.is_empty() {
        return Err(SceneError::of(MeshWriteError::NoCellsToWrite {}));
    }
    match ending.to_ascii_lowercase().as_str() {
        "msh" => Ok(Written { files: vec![("msh", gmsh(mesh).into_bytes())], left_out: Vec::new() }),
        "vtk" => {
            let mut written = named_values("vtk", vtk(mesh).into_bytes(), mesh);
            let gaps = mesh.cell_values.iter().filter(|(_, values)| !is_whole(values));
            written.left_out.extend(gaps.map(|(name, _)| LeftOut::CellValues { name: visible(name) }));
            let gaps = mesh.node_values.iter().filter(|(_, field)| !is_whole(&field.values));
            written.left_out.extend(gaps.map(|(name, _)| LeftOut::NodeValues { name: visible(name) }));
            Ok(written)
        }
        "vtu" => Ok(named_values("vtu", vtu_file(mesh), mesh)),
        "mesh" => medit(mesh),
        "mfem" => mfem(mesh),
        "node" | "ele" => tetgen(mesh),
        other => Err(SceneError::of(MeshWriteError::Ending { ending: visible(other) })),
    }
}

/// The endings of the files to which a mesh is written if this ending is requested.
pub fn endings(ending: &str) -> Vec<&str> {
    match ending {
        "node" | "ele" => vec!["node", "ele"],
        one => vec![one],
    }
}

/// The kind of a cell.
fn kind(element: Element) -> Kind {
    match element {
        Element::Quadrilateral => Kind::Quadrilateral,
        Element::Tetrahedron => Kind::Tetrahedron,
        Element::Hexahedron => Kind::Hexahedron,
        Element::QuadraticTriangle => Kind::QuadraticTriangle,
        Element::QuadraticTetrahedron => Kind::QuadraticTetrahedron,
        _ => Kind::Triangle,
    }
}

/// Coordinates with all their digits, z zero in the plane.
fn three<const D: usize>(x: &[f64; D]) -> String {
    format!("{:e} {:e} {:e}", x[0], x[1], x.get(2).copied().unwrap_or(0.0))
}

/// Makes a name safe to be written in quotes on one line.
fn word(name: &str) -> String {
    name.chars().map(|c| if c == '"' || c.is_control() { '_' } else { c }).collect()
}

fn listed(nodes: &[u32], shift: u32) -> String {
    nodes.iter().map(|node| (node + shift).to_string()).collect::<Vec<_>>().join(" ")
}

/// The result for a file format that holds cell values but no groups.
fn named_values<const D: usize>(ending: &'static str, bytes: Vec<u8>, mesh: &Mesh<D>) -> Written {
    let mut left_out = Vec::new();
    if !mesh.groups.is_empty() || !mesh.cell_groups.is_empty() {
        left_out.push(LeftOut::GroupNames { count: mesh.groups.len() + mesh.cell_groups.len() });
    }
    Written { files: vec![(ending, bytes)], left_out }
}

/// Gmsh 4.1 as text. Cells with the same groups form an entity; every group of nodes is an entity of points.
fn gmsh<const D: usize>(mesh: &Mesh<D>) -> String {
    let point_groups = own_groups_of_nodes(mesh);
    let mut sets: Vec<Vec<usize>> = vec![Vec::new(); mesh.cells.len()];
    for (k, cells) in mesh.cell_groups.values().enumerate() {
        cells.iter().for_each(|cell| sets[*cell as usize].push(k + 1));
    }
    let mut entities: BTreeMap<&[usize], usize> = BTreeMap::new();
    for set in &sets {
        let next = entities.len() + 1;
        entities.entry(set).or_insert(next);
    }
    let entity_of_cell: Vec<usize> = sets.iter().map(|set| entities[&set[..]]).collect();

    let mut out = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n".to_string();
    gmsh_names(&mut out, mesh, &point_groups);
    gmsh_entities::<D>(&mut out, point_groups.len(), &entities);
    // All nodes in one block.
    let n = mesh.nodes();
    let _ = writeln!(out, "$Nodes\n1 {n} 1 {n}\n{D} 1 0 {n}");
    out.extend((1..=n).map(|node| format!("{node}\n")));
    out.extend(mesh.positions.iter().map(|x| three(x) + "\n"));
    out.push_str("$EndNodes\n");
    gmsh_elements(&mut out, mesh, &point_groups, &entity_of_cell);
    gmsh_values(&mut out, mesh);
    out
}

/// Names of the groups of nodes, without those that a group of cells implies.
fn own_groups_of_nodes<const D: usize>(mesh: &Mesh<D>) -> Vec<&String> {
    let all: Vec<&[u32]> = mesh.cells.iter().map(|(_, _, nodes)| nodes).collect();
    let of_cells = |name: &String| {
        let mut nodes: Vec<u32> = Vec::new();
        mesh.cell_groups.get(name).into_iter().flatten().for_each(|cell| nodes.extend(all[*cell as usize]));
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    };
    mesh.groups.iter().filter(|(name, nodes)| of_cells(name) != **nodes).map(|(name, _)| name).collect()
}

/// The names of groups.
fn gmsh_names<const D: usize>(out: &mut String, mesh: &Mesh<D>, point_groups: &[&String]) {
    let count = mesh.cell_groups.len() + point_groups.len();
    if count == 0 {
        return;
    }
    let _ = writeln!(out, "$PhysicalNames\n{count}");
    for (k, name) in point_groups.iter().enumerate() {
        let _ = writeln!(out, "0 {} \"{}\"", k + 1, word(name));
    }
    for (k, name) in mesh.cell_groups.keys().enumerate() {
        let _ = writeln!(out, "{D} {} \"{}\"", k + 1, word(name));
    }
    out.push_str("$EndPhysicalNames\n");
}

/// Entities: one for points, and one for each combination of groups of cells.
fn gmsh_entities<const D: usize>(out: &mut String, points: usize, entities: &BTreeMap<&[usize], usize>) {
    let mut counts = [0; 4];
    counts[0] = points;
    counts[D] = entities.len();
    let _ = writeln!(out, "$Entities\n{} {} {} {}", counts[0], counts[1], counts[2], counts[3]);
    for k in 1..=points {
        let _ = writeln!(out, "{k} 0 0 0 1 {k}");
    }
    let mut by_number: Vec<(usize, &[usize])> = entities.iter().map(|(set, number)| (*number, *set)).collect();
    by_number.sort_unstable();
    for (number, set) in by_number {
        let groups: String = set.iter().map(|group| format!(" {group}")).collect();
        let _ = writeln!(out, "{number} 0 0 0 0 0 0 {}{groups} 0", set.len());
    }
    out.push_str("$EndEntities\n");
}

/// Cells in blocks of one kind and one entity, in their order; then points.
fn gmsh_elements<const D: usize>(out: &mut String, mesh: &Mesh<D>, point_groups: &[&String], entity_of_cell: &[usize]) {
    let mut blocks: Vec<(usize, i32, Vec<String>)> = Vec::new();
    for (cell, (element, _, nodes)) in mesh.cells.iter().enumerate() {
        let kind = match kind(element) {
            Kind::Triangle => 2,
            Kind::Quadrilateral => 3,
            Kind::Tetrahedron => 4,
            Kind::Hexahedron => 5,
            Kind::QuadraticTriangle => 9,
            _ => 11,
        };
        let mut own = nodes.to_vec();
        super::gmsh::reorder(self::kind(element), &mut own);
        let row = format!("{} {}", cell + 1, listed(&own, 1));
        let entity = entity_of_cell[cell];
        match blocks.last_mut() {
            Some((e, k, rows)) if *e == entity && *k == kind => rows.push(row),
            _ => blocks.push((entity, kind, vec![row])),
        }
    }
    let points: usize = point_groups.iter().map(|name| mesh.groups[*name].len()).sum();
    let total = mesh.cells.len() + points;
    let _ = writeln!(out, "$Elements\n{} {total} 1 {total}", blocks.len() + point_groups.len());
    for (entity, kind, rows) in blocks {
        let _ = writeln!(out, "{D} {entity} {kind} {}\n{}", rows.len(), rows.join("\n"));
    }
    let mut number = mesh.cells.len();
    for (k, name) in point_groups.iter().enumerate() {
        let nodes = &mesh.groups[*name];
        let _ = writeln!(out, "0 {} 15 {}", k + 1, nodes.len());
        for node in nodes {
            number += 1;
            let _ = writeln!(out, "{number} {}", node + 1);
        }
    }
    out.push_str("$EndElements\n");
}

/// Values of cells and of nodes, without those that are NaN.
fn gmsh_values<const D: usize>(out: &mut String, mesh: &Mesh<D>) {
    for (name, values) in &mesh.cell_values {
        let given: Vec<(usize, &f64)> = values.iter().enumerate().filter(|(_, x)| x.is_finite()).collect();
        let _ = writeln!(out, "$ElementData\n1\n\"{}\"\n1\n0\n3\n0\n1\n{}", word(name), given.len());
        out.extend(given.iter().map(|(cell, x)| format!("{} {x:e}\n", cell + 1)));
        out.push_str("$EndElementData\n");
    }
    for (name, field) in &mesh.node_values {
        // Vectors in Gmsh have three components.
        let width = if field.components == 1 { 1 } else { 3 };
        let rows = field.values.chunks_exact(field.components).enumerate();
        let given: Vec<(usize, &[f64])> = rows.filter(|(_, row)| is_whole(row)).collect();
        let _ = writeln!(out, "$NodeData\n1\n\"{}\"\n1\n0\n3\n0\n{width}\n{}", word(name), given.len());
        for (node, row) in given {
            let numbers = (0..width).map(|k| format!(" {:e}", row.get(k).copied().unwrap_or(0.0)));
            let _ = writeln!(out, "{}{}", node + 1, numbers.collect::<String>());
        }
        out.push_str("$EndNodeData\n");
    }
}

/// Whether all cells have a value.
fn is_whole(values: &[f64]) -> bool {
    values.iter().all(|x| x.is_finite())
}

/// The cell type of VTK for an element.
fn vtk_type(element: Element) -> u8 {
    match kind(element) {
        Kind::Triangle => 5,
        Kind::Quadrilateral => 9,
        Kind::Tetrahedron => 10,
        Kind::Hexahedron => 12,
        Kind::QuadraticTriangle => 22,
        _ => 24,
    }
}

fn vtk<const D: usize>(mesh: &Mesh<D>) -> String {
    let mut out = "# vtk DataFile Version 3.0\nmesh by Opruga\nASCII\nDATASET UNSTRUCTURED_GRID\n".to_string();
    let _ = writeln!(out, "POINTS {} double", mesh.nodes());
    out.extend(mesh.positions.iter().map(|x| three(x) + "\n"));
    let cells = mesh.cells.len();
    let size: usize = mesh.cells.iter().map(|(_, _, nodes)| nodes.len() + 1).sum();
    let _ = writeln!(out, "CELLS {cells} {size}");
    for (_, _, nodes) in mesh.cells.iter() {
        let _ = writeln!(out, "{} {}", nodes.len(), listed(nodes, 0));
    }
    let _ = writeln!(out, "CELL_TYPES {cells}");
    out.extend(mesh.cells.iter().map(|(element, _, _)| format!("{}\n", vtk_type(element))));
    let whole = || mesh.cell_values.iter().filter(|(_, values)| is_whole(values));
    if whole().next().is_some() {
        let _ = writeln!(out, "CELL_DATA {cells}");
    }
    for (name, values) in whole() {
        let _ = writeln!(out, "SCALARS {} double 1\nLOOKUP_TABLE default", name.replace(char::is_whitespace, "%20"));
        out.extend(values.iter().map(|x| format!("{x:e}\n")));
    }
    let whole = || mesh.node_values.iter().filter(|(_, field)| is_whole(&field.values));
    if whole().next().is_some() {
        let _ = writeln!(out, "POINT_DATA {}", mesh.nodes());
    }
    for (name, field) in whole() {
        let name = name.replace(char::is_whitespace, "%20");
        let _ = match field.components {
            3 => writeln!(out, "VECTORS {name} double"),
            components => writeln!(out, "SCALARS {name} double {components}\nLOOKUP_TABLE default"),
        };
        for row in field.values.chunks_exact(field.components) {
            let words: Vec<String> = row.iter().map(|x| format!("{x:e}")).collect();
            let _ = writeln!(out, "{}", words.join(" "));
        }
    }
    out
}

fn vtu_file<const D: usize>(mesh: &Mesh<D>) -> Vec<u8> {
    let mut out = Vec::new();
    let points: Vec<f64> = mesh.positions.iter().flat_map(|x| [x[0], x[1], x.get(2).copied().unwrap_or(0.0)]).collect();
    let cells: Vec<(u8, Vec<usize>)> = mesh
        .cells
        .iter()
        .map(|(element, _, nodes)| (vtk_type(element), nodes.iter().map(|node| *node as usize).collect()))
        .collect();
    let mut write = || -> std::io::Result<()> {
        vtu::head(&mut out, None, &points, cells.len())?;
        vtu::cells(&mut out, cells.iter().map(|(kind, nodes)| (*kind, &nodes[..])))?;
        std::io::Write::write_all(&mut out, b"<PointData>\n")?;
        for (name, field) in &mesh.node_values {
            vtu::reals(&mut out, name, field.components, &field.values)?;
        }
        std::io::Write::write_all(&mut out, b"</PointData>\n<CellData>\n")?;
        for (name, values) in &mesh.cell_values {
            vtu::reals(&mut out, name, 1, values)?;
        }
        std::io::Write::write_all(&mut out, b"</CellData>\n")?;
        vtu::foot(&mut out)
    };
    // Writing to memory cannot fail.
    let _ = write();
    out
}

/// Refuses cells of second order, which only other formats support.
fn linear<const D: usize>(mesh: &Mesh<D>, format: &'static str) -> Result<(), SceneError> {
    let quadratic = mesh.cells.quadratic_triangles.len() + mesh.cells.quadratic_tetrahedra.len();
    if quadratic == 0 {
        return Ok(());
    }
    Err(SceneError::of(MeshWriteError::SecondOrder { format, cells: quadratic }))
}

/// For each cell, the number of its group, from 1; 0 if the cell is in no group. If a cell is in several groups, this is the number of the first
/// group by name.
fn references<const D: usize>(mesh: &Mesh<D>, left_out: &mut Vec<LeftOut>) -> Vec<usize> {
    let mut out = vec![0; mesh.cells.len()];
    for (k, cells) in mesh.cell_groups.values().enumerate().rev() {
        cells.iter().for_each(|cell| out[*cell as usize] = k + 1);
    }
    if !mesh.cell_groups.is_empty() {
        left_out.push(LeftOut::NamesOfCellGroups { count: mesh.cell_groups.len() });
    }
    if !mesh.groups.is_empty() {
        left_out.push(LeftOut::GroupsOfNodes { count: mesh.groups.len() });
    }
    if !mesh.cell_values.is_empty() {
        left_out.push(LeftOut::ValuesOfCells { count: mesh.cell_values.len() });
    }
    left_out.extend(of_nodes(mesh));
    out
}

/// The notice for formats that cannot represent values of nodes.
fn of_nodes<const D: usize>(mesh: &Mesh<D>) -> Option<LeftOut> {
    let count = mesh.node_values.len();
    (count > 0).then_some(LeftOut::ValuesOfNodes { count })
}

fn medit<const D: usize>(mesh: &Mesh<D>) -> Result<Written, SceneError> {
    linear(mesh, "Medit")?;
    let mut left_out = Vec::new();
    let references = references(mesh, &mut left_out);
    let mut out = format!("MeshVersionFormatted 2\nDimension {D}\nVertices\n{}\n", mesh.nodes());
    for x in &mesh.positions {
        let words: Vec<String> = x.iter().map(|x| format!("{x:e}")).collect();
        let _ = writeln!(out, "{} 0", words.join(" "));
    }
    for (keyword, element) in [
        ("Triangles", Element::Triangle),
        ("Quadrilaterals", Element::Quadrilateral),
        ("Tetrahedra", Element::Tetrahedron),
        ("Hexahedra", Element::Hexahedron),
    ] {
        let rows: Vec<String> = mesh
            .cells
            .iter()
            .zip(&references)
            .filter(|((kind, ..), _)| *kind == element)
            .map(|((_, _, nodes), reference)| format!("{} {reference}", listed(nodes, 1)))
            .collect();
        if !rows.is_empty() {
            let _ = writeln!(out, "{keyword}\n{}\n{}", rows.len(), rows.join("\n"));
        }
    }
    out.push_str("End\n");
    Ok(Written { files: vec![("mesh", out.into_bytes())], left_out })
}

fn mfem<const D: usize>(mesh: &Mesh<D>) -> Result<Written, SceneError> {
    linear(mesh, "MFEM")?;
    let mut left_out = Vec::new();
    let references = references(mesh, &mut left_out);
    let mut out = format!("MFEM mesh v1.0\n\ndimension\n{D}\n\nelements\n{}\n", mesh.cells.len());
    for ((element, _, nodes), reference) in mesh.cells.iter().zip(references) {
        let geometry = match kind(element) {
            Kind::Triangle => 2,
            Kind::Quadrilateral => 3,
            Kind::Tetrahedron => 4,
            _ => 5,
        };
        // Attributes count from 1, so cells without a group get the number after that of the last group.
        let attribute = if reference == 0 { mesh.cell_groups.len() + 1 } else { reference };
        let _ = writeln!(out, "{attribute} {geometry} {}", listed(nodes, 0));
    }
    // The boundary is left empty, because the facets of a mesh do not contain the quadrilateral faces of hexahedra. MFEM then finds it by itself.
    let _ = writeln!(out, "\nboundary\n0\n\nvertices\n{}\n{D}", mesh.nodes());
    for x in &mesh.positions {
        let words: Vec<String> = x.iter().map(|x| format!("{x:e}")).collect();
        let _ = writeln!(out, "{}", words.join(" "));
    }
    Ok(Written { files: vec![("mfem", out.into_bytes())], left_out })
}

fn tetgen<const D: usize>(mesh: &Mesh<D>) -> Result<Written, SceneError> {
    linear(mesh, "TetGen")?;
    let boxes = mesh.cells.quadrilaterals.len() + mesh.cells.hexahedra.len();
    if boxes > 0 {
        return Err(SceneError::of(MeshWriteError::Boxes { cells: boxes }));
    }
    let mut left_out = Vec::new();
    if !mesh.cell_groups.is_empty() || !mesh.groups.is_empty() {
        left_out.push(LeftOut::Groups { count: mesh.cell_groups.len() + mesh.groups.len() });
    }
    let mut nodes = format!("{} {D} 0 0\n", mesh.nodes());
    for (node, x) in mesh.positions.iter().enumerate() {
        let words: Vec<String> = x.iter().map(|x| format!("{x:e}")).collect();
        let _ = writeln!(nodes, "{node} {}", words.join(" "));
    }
    // Attributes have no names and no gaps.
    let values: Vec<&Vec<f64>> = mesh.cell_values.values().filter(|values| is_whole(values)).collect();
    if !mesh.cell_values.is_empty() {
        left_out.push(LeftOut::NamesOfCellValues { count: mesh.cell_values.len() });
    }
    if values.len() < mesh.cell_values.len() {
        left_out.push(LeftOut::GappyValues { count: mesh.cell_values.len() - values.len() });
    }
    left_out.extend(of_nodes(mesh));
    let mut elements = format!("{} {} {}\n", mesh.cells.len(), D + 1, values.len());
    for (cell, (_, _, corners)) in mesh.cells.iter().enumerate() {
        let more: String = values.iter().map(|v| format!(" {:e}", v[cell])).collect();
        let _ = writeln!(elements, "{cell} {}{more}", listed(corners, 0));
    }
    Ok(Written { files: vec![("node", nodes.into_bytes()), ("ele", elements.into_bytes())], left_out })
}
