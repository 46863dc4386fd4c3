//! Makes a world from the text of a scene, as a user does.
#![allow(dead_code, reason = "every test file uses its own part")]

use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::{SceneError, scene};
use opruga::{Options, World, WorldError, catalogue};

/// Reads a scene.
pub(crate) fn read(text: &str) -> Result<AnyBlueprint, Vec<SceneError>> {
    let options = scene::Options { files: opruga::scenes::files(), ..scene::Options::default() };
    scene::read(text.as_bytes(), "test.toml", &catalogue(), &options).map(|r| r.0)
}

/// A scene in the plane.
pub(crate) fn plane(text: &str) -> Blueprint<2> {
    match read(text) {
        Ok(AnyBlueprint::Plane(blueprint)) => blueprint,
        Ok(_) => panic!("the scene is in space"),
        Err(errors) => panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

/// A scene in space.
pub(crate) fn space(text: &str) -> Blueprint<3> {
    match read(text) {
        Ok(AnyBlueprint::Space(blueprint)) => blueprint,
        Ok(_) => panic!("the scene is in the plane"),
        Err(errors) => panic!("{}", errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
    }
}

/// Builds a world on one thread.
pub(crate) fn built<const D: usize>(blueprint: Blueprint<D>) -> World<D> {
    World::new(blueprint, Options::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// The error of a scene in the plane whose world cannot be built.
pub(crate) fn refused(text: &str) -> WorldError {
    World::new(plane(text), Options::default()).expect_err("the world should be refused")
}

/// Steps through frames.
pub(crate) fn frames<const D: usize>(world: &mut World<D>, count: u64) {
    for _ in 0..count {
        world.frame().unwrap_or_else(|e| panic!("{e}"));
    }
}

/// The largest absolute value.
pub(crate) fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values.into_iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}

/// The head of a scene in the plane: length of a frame, substeps, downward gravity, integrator.
pub(crate) fn head(frame: f64, substeps: u32, gravity: f64, rule: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nframe = {frame:?}\nsubsteps = {substeps}\n\
         [integrator]\nkind = \"{rule}\"\n[world]\ngravity = [0, {gravity:?}]\n"
    )
}
