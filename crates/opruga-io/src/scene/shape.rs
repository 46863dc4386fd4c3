//! The shape of a body: its file, if it has one, and its mesh.

use super::place_of;
use super::reader::{Reader, join};
use crate::document::{Node, Place};
use crate::problem::{SceneError, visible};
use crate::shapes::Loaded;
use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use opruga_world::shapes;

/// Where a shape stands in the scene.
pub(super) struct ShapePlace<'a> {
    /// The name of its body.
    pub(super) name: &'a str,
    pub(super) place: Place,
    pub(super) path: String,
}

/// Reads the file of a shape that has one. The file is looked at only where its own fields have no errors.
pub(super) fn loaded<const D: usize>(
    reader: &mut Reader<'_>,
    node: &Node,
    path: &str,
    shape: &Values,
    sound: bool,
) -> Option<Loaded> {
    if !shapes::is_from_file(shape.kind()) || !sound {
        return None;
    }
    let (at, here) = (node.get("shape")?, join(path, "shape"));
    match crate::shapes::load(shape, D, &mut |name| reader.file(name)) {
        Ok(loaded) => {
            for notice in &loaded.notices {
                reader.notice(at.place, notice.clone().path(&here));
            }
            Some(loaded)
        }
        Err(problem) => {
            let field = join(&here, problem.field);
            reader.report(place_of(at, problem.field), problem.about.path(field));
            None
        }
    }
}

/// Makes the mesh of a shape.
pub(super) fn mesh<const D: usize>(
    reader: &mut Reader<'_>,
    shape: &Values,
    loaded: Option<&Loaded>,
    transform: &shapes::Transform<'_>,
    at: &ShapePlace<'_>,
) -> Option<Mesh<D>> {
    let made = match loaded {
        Some(loaded) => loaded.mesh::<D>(transform),
        // Why there is no file was told.
        None if shapes::is_from_file(shape.kind()) => return None,
        None => {
            shapes::mesh::<D>(shape, transform).map_err(|refusal| SceneError::new("scene.shape", refusal.to_string()))
        }
    };
    let made = match made {
        Ok(made) => made,
        Err(error) => {
            reader.report(at.place, error.path(&at.path));
            return None;
        }
    };
    if made.flipped {
        let notice = SceneError::new("shape.flipped", format!("the points of `{}` run clockwise", visible(at.name)));
        reader.notice(at.place, notice.path(&at.path).hint("its edges run against them"));
    }
    // Large factors may leave the range of numbers.
    if let Some(x) = made.mesh.positions.iter().flatten().find(|x| !x.is_finite()) {
        let error = SceneError::new("scene.shape", format!("a coordinate of the shape is {x}")).path(&at.path);
        reader.report(at.place, error.allowed("finite coordinates"));
        return None;
    }
    Some(made.mesh)
}
