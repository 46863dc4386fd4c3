//! Makes a body from the nodes and elements of a file, or reports what is wrong with them.

use super::errors::{CornerOrder, MeshFileError, MeshFileNotice};
use super::found::{Found, Item, Kind};
use super::scanner::Scanner;
use crate::problem::{SceneError, visible};
use crate::rounding::Stored;
use opruga_math::message::{AnyMessage, Setting};
use opruga_mesh::{Mesh, THIN_ELEMENT};
use std::collections::BTreeMap;

/// The repairs that may be made in a file with errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mending {
    /// Flips inverted cells, and counts them.
    pub turn_inverted: bool,
    /// Drops nodes that no cell uses, and counts them.
    pub leave_out_unreferenced: bool,
}

/// Makes a body from the contents of a file, or of a file of nodes and a file of elements. Nodes keep their order. Also returns what was dropped or
/// repaired, with counts.
///
/// # Errors
/// `mesh.empty`, `mesh.dimension`, `mesh.mixed_dimension`, `mesh.degenerate_element`, `mesh.duplicate_element`, `mesh.inverted`, `mesh.unreferenced`,
/// `mesh.non_manifold`, with the position of the element or node.
pub(super) fn assemble<const D: usize>(
    mut found: Found,
    nodes: &Scanner<'_>,
    items: &Scanner<'_>,
    mending: Mending,
) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
    // Nodes keep their order, so their values can be used as they are.
    let node_values = std::mem::take(&mut found.node_values);
    let work = Assembly { found: &found, nodes, items };
    let dimension = work.dimension::<D>()?;
    let mut notices = found.all_notices();
    let stored = Stored::of(&found.positions, found.items.iter().map(Item::nodes), found.single);
    notices.extend(stored.warning().map_err(|error| work.file(error))?);
    let mut mesh = Mesh::<D> { positions: work.positions(&mut notices)?, node_values, ..Mesh::default() };
    // Cells are counted kind by kind; `order` gives the item of each cell.
    let order = work.order(dimension);
    work.distinct(&order)?;
    work.fill(&mut mesh, &order);
    work.lower(dimension, &order, mesh.nodes())?;
    mesh.validate().map_err(|error| work.topology(&error))?;
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
    /// The file with the nodes, and the file with the elements.
    nodes: &'a Scanner<'a>,
    items: &'a Scanner<'a>,
}

impl Assembly<'_> {
    fn at(&self, item: &Item, message: impl Into<AnyMessage>) -> SceneError {
        self.items.error(message, item.offset)
    }

    fn topology(&self, error: &opruga_mesh::MeshError) -> SceneError {
        let error = SceneError::of(MeshFileError::Topology { problem: error.clone() });
        self.file(SceneError { message: visible(&error.message), ..error })
    }

    fn at_node(&self, node: usize, message: MeshFileError) -> SceneError {
        match self.found.node_offsets.get(node) {
            Some(offset) => self.nodes.error(message, *offset),
            None => self.file(SceneError::of(message)),
        }
    }

    fn file(&self, error: SceneError) -> SceneError {
        SceneError { file: self.items.file.to_string(), ..error }
    }

    /// The dimension of the elements that make up the body.
    fn dimension<const D: usize>(&self) -> Result<usize, SceneError> {
        // The first element of the highest dimension in the file.
        let Some(highest) = self.found.items.iter().rev().max_by_key(|item| item.kind.dimension()) else {
            return Err(self.file(SceneError::of(MeshFileError::NoElements {})));
        };
        let element = highest.kind.name();
        let error = match highest.kind.dimension() {
            0 => MeshFileError::PointsOnly { element },
            1 => return Ok(1),
            dimension if dimension == D => return Ok(D),
            2 => MeshFileError::SurfaceInSpace { element },
            _ => MeshFileError::SpaceInPlane { element },
        };
        Err(self.at(highest, error))
    }

    /// Positions in as many dimensions as the scene has.
    fn positions<const D: usize>(&self, notices: &mut Vec<SceneError>) -> Result<Vec<[f64; D]>, SceneError> {
        let points = &self.found.positions;
        if points.len() as u64 > opruga_mesh::MAXIMUM_NODES {
            let error = MeshFileError::TooManyNodes { nodes: points.len(), most: opruga_mesh::MAXIMUM_NODES };
            return Err(self.file(SceneError::of(error)));
        }
        if D == 2
            && let Some(first) = points.first()
        {
            if let Some(node) = points.iter().position(|p| p[2] != first[2]) {
                let number = self.found.node_numbers.get(node).copied().unwrap_or(node as u64);
                let (z, plane) = (points[node][2].to_string(), first[2].to_string());
                return Err(self.at_node(node, MeshFileError::OutOfPlane { node: number, z, plane }));
            }
            if first[2] != 0.0 {
                notices.push(SceneError::of(MeshFileNotice::PlaneOffset { z: first[2].to_string() }));
            }
        }
        Ok(points.iter().map(|p| core::array::from_fn(|d| p[d])).collect())
    }

    /// Items of the highest dimension, sorted by kind in the order of `Cells`.
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

    /// Refuses elements that name a node twice, and pairs of elements with the same nodes.
    fn distinct(&self, order: &[u32]) -> Result<(), SceneError> {
        let mut keys: Vec<([u32; 10], u32)> = Vec::with_capacity(order.len());
        for &k in order {
            let item = &self.found.items[k as usize];
            let mut key = [u32::MAX; 10];
            key[..item.nodes().len()].copy_from_slice(item.nodes());
            key.sort_unstable();
            if let Some(pair) = key.windows(2).find(|pair| pair[0] == pair[1] && pair[0] != u32::MAX) {
                let (element, index, node) = (item.kind.name(), item.number, self.number(pair[0]));
                return Err(self.at(item, MeshFileError::RepeatedNode { element, index, node }));
            }
            keys.push((key, k));
        }
        keys.sort_unstable();
        if let Some(pair) = keys.windows(2).filter(|pair| pair[0].0 == pair[1].0).min_by_key(|pair| pair[1].1) {
            let (first, second) = (&self.found.items[pair[0].1 as usize], &self.found.items[pair[1].1 as usize]);
            return Err(self.at(second, MeshFileError::SameNodes { first: first.number, second: second.number }));
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

    /// Refuses elements of lower dimension that are not part of a cell, because such elements only name parts of cells.
    fn lower(&self, dimension: usize, order: &[u32], nodes: usize) -> Result<(), SceneError> {
        let items = &self.found.items;
        if order.len() == items.len() {
            return Ok(());
        }
        // The cells at every node, as consecutive lists.
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
                let (element, index) = (item.kind.name(), item.number);
                return Err(self.at(item, MeshFileError::NoPartOfCell { element, index }));
            }
        }
        Ok(())
    }

    /// Refuses or flips inverted cells, and refuses degenerate ones.
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
                let (element, index) = (item.kind.name(), item.number);
                let (whole, least) = (format!("{:e}", measures.whole), format!("{THIN_ELEMENT:e}"));
                return Err(self.at(
                    item,
                    match D {
                        2 => MeshFileError::NoArea { element, index, area: whole, least },
                        _ => MeshFileError::NoVolume { element, index, volume: whole, least },
                    },
                ));
            }
            if measures.least < 0.0 {
                inverted.push((cell as u32, measures));
            }
        }
        let turned = |measures: &opruga_mesh::CellMeasure| measures.greatest < 0.0;
        // A cell with a negative measure at only some of its nodes is folded; flipping does not help.
        let hopeless = inverted.iter().find(|(_, measures)| !turned(measures));
        if let Some((cell, measures)) = hopeless.or(inverted.first().filter(|_| !mending.turn_inverted)) {
            let item = &self.found.items[order[*cell as usize] as usize];
            let (element, index, measure) = (item.kind.name(), item.number, format!("{:e}", measures.least));
            let (count, cells) = (inverted.len(), order.len());
            let order = if D == 2 { CornerOrder::Plane } else { CornerOrder::Space };
            let turn = Setting::with("inverted", "\"turn\"");
            return Err(self.at(
                item,
                match turned(measures) {
                    false => MeshFileError::Folded { element, index, count, cells, measure, order },
                    true if count == cells => {
                        MeshFileError::AllInverted { element, index, cells, measure, order, turn }
                    }
                    true => MeshFileError::Inverted { element, index, count, cells, measure, order, turn },
                },
            ));
        }
        if !inverted.is_empty() {
            let cells: Vec<u32> = inverted.iter().map(|entry| entry.0).collect();
            mesh.turn_cells(&cells);
            notices.push(SceneError::of(MeshFileNotice::Turned { count: cells.len(), cells: order.len() }));
        }
        Ok(())
    }

    fn crowded<const D: usize>(&self, mesh: &Mesh<D>, error: &opruga_mesh::MeshError) -> SceneError {
        let opruga_mesh::MeshError::NonManifoldEdges { edges } = error else {
            return self.topology(error);
        };
        let [a, b] = edges[0];
        // The last cell at this face is the surplus one.
        let cell =
            mesh.cells.iter().enumerate().filter(|(_, (_, _, nodes))| nodes.contains(&a) && nodes.contains(&b)).last();
        let error = MeshFileError::Crowded { first: self.number(a), second: self.number(b), edges: edges.len() };
        match cell.and_then(|(cell, _)| self.found.items.get(cell)) {
            Some(item) => self.at(item, error),
            None => self.file(SceneError::of(error)),
        }
    }

    /// Copies the groups of nodes and of cells, and the values of cells, to the mesh.
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
            notices.push(SceneError::of(MeshFileNotice::Unreferenced { count }));
            return Ok(());
        }
        let (node, first) = (first as usize, self.number(first));
        let leave_out = Setting::with("unreferenced", "\"leave_out\"");
        Err(self.at_node(
            node,
            match count {
                1 => MeshFileError::LooseNode { first, leave_out },
                _ => MeshFileError::LooseNodes { count, first, leave_out },
            },
        ))
    }
}
