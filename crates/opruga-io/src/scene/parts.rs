//! Parts of bodies that loads act on: sides of the boundary, and cells.

use super::body_list::Bodies;
use super::place_of;
use super::reader::{Reader, join};
use crate::document::Node;
use crate::problem::{SceneError, visible};
use opruga_world::blueprint::Selector;

/// Refuses a load on sides of the boundary whose nodes hold none of them; copies have one mesh, and the same nodes of it.
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
    let message = format!("the nodes that the load selects on `{name}` hold no whole facet of its boundary");
    let mut error = SceneError::new("scene.selects_nothing", message).path(join(path, "select"));
    if let Some(select) = node.get("select") {
        error = error.value(select.shown());
    }
    let (allowed, hint) = match body.mesh.facets.is_empty() {
        true => ("bodies that have a boundary", "a chain has none; `kind = \"force\"` acts on nodes"),
        false => (
            "all nodes of one facet at least: an edge of the outline, or a triangle of the surface",
            "`side`, `group` and `boundary` select whole sides; `kind = \"force\"` acts on nodes",
        ),
    };
    reader.report(place_of(node, "select"), error.allowed(allowed).hint(hint));
    false
}

/// Refuses a load on cells of a body whose nodes hold none of them.
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
        let message = format!("the load acts on the volume of cells, and `{name}` has no cells");
        let error = SceneError::new("scene.selects_nothing", message).path(join(path, "kind")).value("\"body_force\"");
        let error = error.allowed("bodies that are filled: `grid`, shapes with a `filling`, volume meshes");
        let hint = "`kind = \"force\"` acts on nodes; `world.gravity` on whatever has a mass";
        reader.report(place_of(node, "kind"), error.hint(hint));
        return false;
    }
    let message = format!("the nodes that the load selects on `{name}` hold no whole cell of it");
    let mut error = SceneError::new("scene.selects_nothing", message).path(join(path, "select"));
    if let Some(select) = node.get("select") {
        error = error.value(select.shown());
    }
    let hint = "without `select` the load acts on all cells; `group` selects those of a mesh file";
    reader.report(place_of(node, "select"), error.allowed("all nodes of one cell at least").hint(hint));
    false
}
