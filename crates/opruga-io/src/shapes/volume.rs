//! Bodies of cells from mesh files, and surfaces from the triangles of such files.

use super::surface_errors::SurfaceError;
use super::triangles::Triangles;
use super::{Content, Loaded, Open, Problem};
use crate::meshes::{self, Kind, Mending, MeshFileError};
use crate::problem::{SceneError, visible};
use opruga_core::spec::Values;
use opruga_mesh::triangle_parts;

/// A body with the nodes and cells of the file.
pub(super) fn loaded(
    name: &str,
    bytes: &[u8],
    shape: &Values,
    dimension: usize,
    open: &mut Open<'_>,
) -> Result<Loaded, Problem> {
    let mending = Mending {
        turn_inverted: shape.text("inverted") == Some("turn"),
        leave_out_unreferenced: shape.text("unreferenced") == Some("leave_out"),
    };
    let file = meshes::read(name, bytes, open)?;
    let (content, mut notices) = if dimension == 2 {
        let (mesh, notices) = file.assemble(mending)?;
        (Content::Plane(Box::new(mesh)), notices)
    } else {
        let (mesh, notices) = file.assemble(mending)?;
        (Content::Space(Box::new(mesh)), notices)
    };
    notices.iter_mut().for_each(|notice| notice.file = name.to_string());
    Ok(Loaded { notices, content })
}

/// The triangles of a file that holds a surface; quadrilaterals become two triangles, quadratic triangles four.
pub(super) fn surface(name: &str, bytes: &[u8], open: &mut Open<'_>) -> Result<Triangles, SceneError> {
    let file = meshes::read(name, bytes, open)?;
    let named = |error: SceneError| SceneError { file: name.to_string(), ..error };
    if file.dimension() > 2 {
        return Err(named(SceneError::of(MeshFileError::NoSurface {})));
    }
    let found = file.into_found();
    let notices = found.all_notices();
    let mut out = Triangles { positions: found.positions, notices, single: found.single, ..Triangles::default() };
    out.groups = found.node_groups;
    for (name, items) in &found.item_groups {
        let nodes = out.groups.entry(name.clone()).or_default();
        items.iter().for_each(|item| nodes.extend(found.items[*item as usize].nodes()));
    }
    for nodes in out.groups.values_mut() {
        nodes.sort_unstable();
        nodes.dedup();
    }
    for item in &found.items {
        match (item.kind, item.nodes()) {
            (Kind::QuadraticTriangle, &[a, b, c, d, e, f]) => out.triangles.extend(triangle_parts(&[a, b, c, d, e, f])),
            (Kind::Triangle | Kind::Quadrilateral, corners) => {
                if let Err(problem) = out.polygon(corners) {
                    let corners = visible(&format!("{corners:?}"));
                    return Err(named(SceneError::of(SurfaceError::Element {
                        problem,
                        element: item.number,
                        corners,
                    })));
                }
            }
            _ => {}
        }
    }
    Ok(out)
}
