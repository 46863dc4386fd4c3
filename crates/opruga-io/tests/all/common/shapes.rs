//! Shapes from files in memory.

use super::{HEAD, catalogue};
use opruga_io::scene::{Options, read};
use opruga_io::{Files, Notice, SceneError};
use opruga_mesh::Mesh;
use opruga_world::blueprint::AnyBlueprint;
use std::sync::Arc;

type Read<const D: usize> = Result<(Arc<Mesh<D>>, Vec<Notice>), Vec<SceneError>>;

fn any(dimension: u8, shape: &str, files: &[(&str, &[u8])]) -> Result<(AnyBlueprint, Vec<Notice>), Vec<SceneError>> {
    let head = HEAD.replace("dimension = 2", &format!("dimension = {dimension}"));
    let text = format!("{head}[[body]]\nname = \"it\"\nmass = 1\nshape = {{ {shape} }}\n");
    let held = files.iter().map(|(name, bytes)| (name.to_string(), Arc::from(*bytes)));
    read(text.as_bytes(), "scene.toml", &catalogue(), &Options { files: Files::in_memory(held), ..Options::default() })
}

/// The mesh of a plane shape.
pub(crate) fn plane(shape: &str, file: &str, bytes: &[u8]) -> Read<2> {
    match any(2, shape, &[(file, bytes)])? {
        (AnyBlueprint::Plane(b), notices) => Ok((b.bodies[0].mesh.clone(), notices)),
        _ => panic!("the scene is in space"),
    }
}

/// The mesh of a shape in space.
pub(crate) fn space(shape: &str, files: &[(&str, &[u8])]) -> Read<3> {
    match any(3, shape, files)? {
        (AnyBlueprint::Space(b), notices) => Ok((b.bodies[0].mesh.clone(), notices)),
        _ => panic!("the scene is in the plane"),
    }
}

/// A drawing that is 2 wide, with nodes 0.1 apart.
pub(crate) fn svg(text: &str) -> Read<2> {
    plane("kind = \"svg\", file = \"a.svg\", spacing = 0.1, size = 2.0", "a.svg", text.as_bytes())
}

/// A surface as it is.
pub(crate) fn surface(file: &str, bytes: &[u8]) -> Read<3> {
    space(&format!("kind = \"surface\", file = \"{file}\""), &[(file, bytes)])
}
