//! Parts of bodies that loads act on: sides of the boundary, and cells.

use super::body_list::Bodies;
use super::errors::ReferenceError;
use super::location_of;
use super::reader::{Reader, join};
use crate::document::Node;
use crate::problem::{SceneError, visible};
use opruga_world::blueprint::Selector;

/// Refuses a load on sides of the boundary if no side has all of its nodes selected. Copies have the same mesh and the same selected nodes.
pub(super) fn hold_sides<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    bodies: &Bodies<D>,
    targets: &[(usize, Selector<D>)],
) -> bool {
    let Some((body, select)) = targets.first().and_then(|(k, select)| Some((bodies.list.get(*k)?, select))) else {
        return true;
    };
    if !body.mesh.boundary_sides(&select.resolve(&body.mesh, &body.translation)).is_empty() {
        return true;
    }
    let name = visible(body.common_name());
    let about = match body.mesh.facets.is_empty() {
        true => ReferenceError::NoBoundary { body: name },
        false => ReferenceError::NoFacet { body: name },
    };
    report(reader, node, path, about);
    false
}

/// Refuses a load on cells of a body if no cell has all of its nodes selected.
pub(super) fn hold_cells<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    bodies: &Bodies<D>,
    targets: &[(usize, Selector<D>)],
) -> bool {
    let Some((body, select)) = targets.first().and_then(|(k, select)| Some((bodies.list.get(*k)?, select))) else {
        return true;
    };
    if !body.mesh.cell_shares(&select.resolve(&body.mesh, &body.translation)).is_empty() {
        return true;
    }
    let name = visible(body.common_name());
    if body.mesh.cells.is_empty() {
        let error = SceneError::of(ReferenceError::NoCellsToLoad { body: name }).path(join(path, "kind"));
        reader.report(location_of(node, "kind"), error);
        return false;
    }
    report(reader, node, path, ReferenceError::NoCell { body: name });
    false
}

/// Reports that the selector of a load selects no side or cell.
fn report(reader: &mut Reader<'_>, node: &Node, path: &str, about: ReferenceError) {
    let mut error = SceneError::of(about).path(join(path, "select"));
    if let Some(select) = node.get("select") {
        error = error.value(select.shown());
    }
    reader.report(location_of(node, "select"), error);
}
