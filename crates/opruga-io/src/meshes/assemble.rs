//! From the nodes and elements of a file to a body, or to what is wrong with them.

use super::found::{Found, Item, Kind};
use super::scanner::Scanner;
use crate::problem::{SceneError, visible};
use crate::rounding::Stored;
use opruga_math::words::counted;
use opruga_mesh::{Mesh, THIN_ELEMENT};
use std::collections::BTreeMap;

/// What may be mended where a file is not sound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mending {
    /// Inverted cells are turned round, and counted.
    pub turn_inverted: bool,
    /// Nodes that no cell names are left out, and counted.
    pub leave_out_unreferenced: bool,
}

/// Makes a body of what a file, or one of nodes and one of elements, holds; nodes keep their order. Returns what was left out or mended, counted.
///
/// # Errors
/// `mesh.empty`, `mesh.dimension`, `mesh.mixed_dimension`, `mesh.degenerate_element`, `mesh.duplicate_element`, `mesh.inverted`,
/// `mesh.unreferenced`, `mesh.non_manifold`, with the place of the element or node.
pub(super) fn assemble<const D: usize>(
    mut found: Found,
    nodes: &Scanner<'_>,
    items: &Scanner<'_>,
    mending: Mending,
) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
    // Nodes keep their order, so these are theirs as they stand.
    let node_values = std::mem::take(&mut found.node_values);
    let work = Assembly { found: &found, nodes, items };
    let dimension = work.dimension::<D>()?;
    let mut notices = found.all_notices();
    let stored = Stored::of(&found.positions, found.items.iter().map(Item::nodes), found.single);
    notices.extend(stored.told().map_err(|error| work.file(error))?);
    let mut mesh = Mesh::<D> { positions: work.positions(&mut notices)?, node_values, ..Mesh::default() };
    // Cells are counted kind by kind: `order` says which item each of them was.
    let order = work.order(dimension);
    work.distinct(&order)?;
    work.fill(&mut mesh, &order);
    work.lower(dimension, &order, mesh.nodes())?;
    let named = |error: opruga_mesh::MeshError| {
        let error = SceneError::new("mesh.topology", visible(&error.to_string()));
        SceneError { file: items.file.to_string(), ..error }
    };
    mesh.validate().map_err(named)?;
    if dimension > 1 {
        work.upright(&mut mesh, &order, mending, &mut notices)?;
        mesh.facets = mesh.facets_from_cells().map_err(|error| work.crowded(&mesh, &error))?;
    }
    work.groups(&mut mesh, dimension, &order);
    work.unreferenced(&mut mesh, mending, &mut notices)?;
    Ok((mesh, notices))
}

struct Assembly<'a> {
    found: &'a Found,
    /// Where nodes stand, and where elements do.
    nodes: &'a Scanner<'a>,
    items: &'a Scanner<'a>,
}

impl Assembly<'_> {
    fn at(&self, item: &Item, code: &'static str, message: String) -> SceneError {
        self.items.error(code, message, item.place)
    }

    fn file(&self, error: SceneError) -> SceneError {
        SceneError { file: self.items.file.to_string(), ..error }
    }

    /// The dimension of the elements that make up the body.
    fn dimension<const D: usize>(&self) -> Result<usize, SceneError> {
        // The first of them in the file.
        let Some(highest) = self.found.items.iter().rev().max_by_key(|item| item.kind.dimension()) else {
            let error = SceneError::new("mesh.empty", "the file holds no elements").value("0");
            return Err(self.file(error.allowed("at least one element")));
        };
        let dimension = highest.kind.dimension();
        let message = |what: String| (what, highest.kind.name().to_string());
        let (text, value) = match dimension {
            0 => message("the file holds points only".into()),
            1 => return Ok(1),
            _ if dimension == D => return Ok(D),
            2 => message("the file holds a surface in space, and nothing that fills it".into()),
            _ => message("the file holds elements of space, but the scene lies in the plane".into()),
        };
        let error = self.at(highest, "mesh.dimension", text).value(value);
        Err(match (dimension, D) {
            (2, _) => error
                .allowed("tetrahedra or hexahedra")
                .hint("`kind = \"surface\"` reads surfaces; with `filling = \"tetrahedra\"` it fills them"),
            (3, _) => error.allowed("triangles or quadrilaterals").hint("`dimension = 3` at the head of the scene"),
            _ => error.allowed("lines, triangles, quadrilaterals, tetrahedra or hexahedra"),
        })
    }

    /// Positions in as many dimensions as the scene has.
    fn positions<const D: usize>(&self, notices: &mut Vec<SceneError>) -> Result<Vec<[f64; D]>, SceneError> {
        let points = &self.found.positions;
        if points.len() as u64 > opruga_mesh::MAXIMUM_NODES {
            let error = SceneError::new("shape.too_large", format!("the mesh has {} nodes", points.len()));
            let allowed = format!("at most {}", opruga_mesh::MAXIMUM_NODES);
            return Err(self.file(error.value(points.len().to_string()).allowed(allowed)));
        }
        if D == 2
            && let Some(first) = points.first()
        {
            if let Some(node) = points.iter().position(|p| p[2] != first[2]) {
                let number = self.found.node_numbers.get(node).copied().unwrap_or(node as u64);
                let message = format!("node {number} lies outside of the plane of the first node");
                let error = match self.found.node_places.get(node) {
                    Some(place) => self.nodes.error("mesh.dimension", message, *place),
                    None => self.file(SceneError::new("mesh.dimension", message)),
                };
                let error = error.value(points[node][2].to_string()).allowed(format!("z = {}", first[2]));
                return Err(error.hint("`dimension = 3` at the head of the scene"));
            }
            if first[2] != 0.0 {
                let message = format!("z = {} of all nodes is left out", first[2]);
                notices.push(SceneError::new("mesh.left_out", message).value(first[2].to_string()));
            }
        }
        Ok(points.iter().map(|p| core::array::from_fn(|d| p[d])).collect())
    }

    /// Items of the highest dimension, kind by kind in the order of `Cells`.
    fn order(&self, dimension: usize) -> Vec<u32> {
        let rank = |kind: Kind| match kind {
            Kind::QuadraticTriangle | Kind::QuadraticTetrahedron => 1,
            _ => 0,
        };
        let items = &self.found.items;
        let mut order: Vec<u32> =
            (0..items.len() as u32).filter(|k| items[*k as usize].kind.dimension() == dimension).collect();
        order.sort_by_key(|k| (rank(items[*k as usize].kind), items[*k as usize].kind, *k));
        order
    }

    /// Refuses elements that name a node twice, and two elements with the same nodes.
    fn distinct(&self, order: &[u32]) -> Result<(), SceneError> {
        let mut keys: Vec<([u32; 10], u32)> = Vec::with_capacity(order.len());
        for &k in order {
            let item = &self.found.items[k as usize];
            let mut key = [u32::MAX; 10];
            key[..item.nodes().len()].copy_from_slice(item.nodes());
            key.sort_unstable();
            if let Some(pair) = key.windows(2).find(|pair| pair[0] == pair[1] && pair[0] != u32::MAX) {
                let number = self.number(pair[0]);
                let message = format!("{} {} names node {number} twice", item.kind.name(), item.number);
                let error = self.at(item, "mesh.degenerate_element", message);
                return Err(error.value(number.to_string()).allowed("every node once"));
            }
            keys.push((key, k));
        }
        keys.sort_unstable();
        if let Some(pair) = keys.windows(2).filter(|pair| pair[0].0 == pair[1].0).min_by_key(|pair| pair[1].1) {
            let (first, second) = (&self.found.items[pair[0].1 as usize], &self.found.items[pair[1].1 as usize]);
            let message = format!("elements {} and {} have the same nodes", first.number, second.number);
            let error = self.at(second, "mesh.duplicate_element", message).value(second.number.to_string());
            return Err(error.hint("leave one of them out"));
        }
        Ok(())
    }

    /// The number that the file gives a node.
    fn number(&self, node: u32) -> u64 {
        self.found.node_numbers.get(node as usize).copied().unwrap_or(u64::from(node))
    }

    fn fill<const D: usize>(&self, mesh: &mut Mesh<D>, order: &[u32]) {
        fn copy<const N: usize>(nodes: &[u32]) -> [u32; N] {
            core::array::from_fn(|k| nodes[k])
        }
        for &k in order {
            let item = &self.found.items[k as usize];
            let nodes = item.nodes();
            match item.kind {
                Kind::Point => {}
                Kind::Line => mesh.wires.push(copy(nodes)),
                Kind::QuadraticLine => mesh.wires.extend([[nodes[0], nodes[2]], [nodes[2], nodes[1]]]),
                Kind::Triangle => mesh.cells.triangles.push(copy(nodes)),
                Kind::Quadrilateral => mesh.cells.quadrilaterals.push(copy(nodes)),
                Kind::QuadraticTriangle => mesh.cells.quadratic_triangles.push(copy(nodes)),
                Kind::Tetrahedron => mesh.cells.tetrahedra.push(copy(nodes)),
                Kind::Hexahedron => mesh.cells.hexahedra.push(copy(nodes)),
                Kind::QuadraticTetrahedron => mesh.cells.quadratic_tetrahedra.push(copy(nodes)),
            }
        }
    }

    /// Elements of lower dimension only name parts of cells: refuses those that are no part of one.
    fn lower(&self, dimension: usize, order: &[u32], nodes: usize) -> Result<(), SceneError> {
        let items = &self.found.items;
        if order.len() == items.len() {
            return Ok(());
        }
        // The cells at every node, list by list.
        let mut starts = vec![0u32; nodes + 1];
        let ends = || order.iter().flat_map(|k| items[*k as usize].nodes().iter().map(move |node| (*node, *k)));
        ends().for_each(|(node, _)| starts[node as usize + 1] += 1);
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut cells = vec![0u32; starts[nodes] as usize];
        for (node, cell) in ends() {
            cells[next[node as usize] as usize] = cell;
            next[node as usize] += 1;
        }
        for item in items.iter().filter(|item| item.kind.dimension() < dimension) {
            let first = item.nodes()[0] as usize;
            let around = &cells[starts[first] as usize..starts[first + 1] as usize];
            let within = |cell: &u32| item.nodes().iter().all(|node| items[*cell as usize].nodes().contains(node));
            if !around.iter().any(within) {
                let message = format!("{} {} is no part of a cell", item.kind.name(), item.number);
                let error = self.at(item, "mesh.mixed_dimension", message).value(item.number.to_string());
                return Err(error.allowed("faces, edges and corners of the cells, or a body of one dimension"));
            }
        }
        Ok(())
    }

    /// Refuses or turns cells that are inverted, refuses those without extent.
    fn upright<const D: usize>(
        &self,
        mesh: &mut Mesh<D>,
        order: &[u32],
        mending: Mending,
        notices: &mut Vec<SceneError>,
    ) -> Result<(), SceneError> {
        let mut inverted = Vec::new();
        for (cell, measures) in mesh.cell_measures().into_iter().enumerate() {
            let item = &self.found.items[order[cell] as usize];
            let power = if D == 2 {
                measures.longest * measures.longest
            } else {
                measures.longest * measures.longest * measures.longest
            };
            if measures.whole.abs() <= THIN_ELEMENT * power {
                let message = format!(
                    "{} {} has no {} for its size",
                    item.kind.name(),
                    item.number,
                    if D == 2 { "area" } else { "volume" }
                );
                let error = self.at(item, "mesh.degenerate_element", message).value(format!("{:e}", measures.whole));
                let unit = if D == 2 { "squared" } else { "cubed" };
                return Err(error.allowed(format!("more than {THIN_ELEMENT:e} of its longest edge {unit}")));
            }
            if measures.least < 0.0 {
                inverted.push((cell as u32, measures));
            }
        }
        let turned = |measures: &opruga_mesh::CellMeasure| measures.greatest < 0.0;
        let all = inverted.len() == order.len();
        // What is negative at one node only is folded, and turning does not help.
        let hopeless = inverted.iter().find(|(_, measures)| !turned(measures));
        if let Some((cell, measures)) = hopeless.or(inverted.first().filter(|_| !mending.turn_inverted)) {
            let item = &self.found.items[order[*cell as usize] as usize];
            let folded = !turned(measures);
            let many = if inverted.len() == 1 {
                String::new()
            } else {
                format!(" ({} of {} are)", inverted.len(), order.len())
            };
            let what = if folded { "folds over itself" } else { "is inverted" };
            let message = format!("{} {} {what}{many}", item.kind.name(), item.number);
            let error = self.at(item, "mesh.inverted", message).value(format!("{:e}", measures.least));
            let error = error.allowed(if D == 2 {
                "a positive area: corners counter-clockwise"
            } else {
                "a positive volume: the last corner on the side where the others run counter-clockwise"
            });
            return Err(match (folded, all) {
                (true, _) => error,
                (_, true) => error.hint(
                    "the whole file runs the other way: `inverted = \"turn\"` turns its cells round, and counts them",
                ),
                _ => error.hint("`inverted = \"turn\"` turns such cells round, and counts them"),
            });
        }
        if !inverted.is_empty() {
            let cells: Vec<u32> = inverted.iter().map(|entry| entry.0).collect();
            mesh.turn_cells(&cells);
            let message = format!(
                "{} of {} turned round",
                counted(cells.len() as u64, "inverted cell", "inverted cells"),
                order.len()
            );
            notices.push(SceneError::new("mesh.flipped", message).value(cells.len().to_string()));
        }
        Ok(())
    }

    fn crowded<const D: usize>(&self, mesh: &Mesh<D>, error: &opruga_mesh::MeshError) -> SceneError {
        let opruga_mesh::MeshError::NonManifoldEdges { edges } = error else {
            return self.file(SceneError::new("mesh.topology", visible(&error.to_string())));
        };
        let [a, b] = edges[0];
        // The last cell at this face is one too many.
        let cell =
            mesh.cells.iter().enumerate().filter(|(_, (_, _, nodes))| nodes.contains(&a) && nodes.contains(&b)).last();
        let message =
            format!("more than two cells share a face, through nodes {} and {}", self.number(a), self.number(b));
        let error = match cell.and_then(|(cell, _)| self.found.items.get(cell)) {
            Some(item) => self.at(item, "mesh.non_manifold", message),
            None => self.file(SceneError::new("mesh.non_manifold", message)),
        };
        error.value(edges.len().to_string()).allowed("at most two cells at a face")
    }

    /// Groups of nodes and of cells, values of cells.
    fn groups<const D: usize>(&self, mesh: &mut Mesh<D>, dimension: usize, order: &[u32]) {
        let mut cell_of = vec![u32::MAX; self.found.items.len()];
        order.iter().zip(0..).for_each(|(item, cell)| cell_of[*item as usize] = cell);
        let mut groups: BTreeMap<String, Vec<u32>> = self.found.node_groups.clone();
        for (name, items) in &self.found.item_groups {
            let nodes = groups.entry(name.clone()).or_default();
            items.iter().for_each(|item| nodes.extend(self.found.items[*item as usize].nodes()));
            let mut cells: Vec<u32> =
                items.iter().map(|item| cell_of[*item as usize]).filter(|cell| *cell != u32::MAX).collect();
            if !cells.is_empty() && dimension > 1 {
                cells.sort_unstable();
                mesh.cell_groups.insert(name.clone(), cells);
            }
        }
        for nodes in groups.values_mut() {
            nodes.sort_unstable();
            nodes.dedup();
        }
        mesh.groups = groups;
        if dimension > 1 {
            for (name, values) in &self.found.item_values {
                let own = order.iter().map(|item| values[*item as usize]).collect();
                mesh.cell_values.insert(name.clone(), own);
            }
        }
    }

    fn unreferenced<const D: usize>(
        &self,
        mesh: &mut Mesh<D>,
        mending: Mending,
        notices: &mut Vec<SceneError>,
    ) -> Result<(), SceneError> {
        let loose = mesh.unreferenced_nodes();
        let Some(&first) = loose.first() else { return Ok(()) };
        let count = loose.len();
        if mending.leave_out_unreferenced {
            mesh.drop_unreferenced();
            let message = format!(
                "{} left out",
                counted(count as u64, "node that no cell names is", "nodes that no cell names are")
            );
            notices.push(SceneError::new("mesh.unreferenced", message).value(count.to_string()));
            return Ok(());
        }
        let message = match count {
            1 => format!("node {} belongs to no cell", self.number(first)),
            _ => format!("{count} nodes belong to no cell, the first is node {}", self.number(first)),
        };
        let error = match self.found.node_places.get(first as usize) {
            Some(place) => self.nodes.error("mesh.unreferenced", message, *place),
            None => self.file(SceneError::new("mesh.unreferenced", message)),
        };
        let error = error.value(self.number(first).to_string()).allowed("nodes of cells");
        Err(error.hint("`unreferenced = \"leave_out\"` leaves such nodes out, and counts them"))
    }
}
