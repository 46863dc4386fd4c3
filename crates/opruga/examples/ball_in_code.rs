//! A pressurised ball made in code, without a scene file, falls on a floor and bounces.

use opruga::blueprint::{Blueprint, BodyBlueprint, ColliderBlueprint, Mass};
use opruga::{Options, Registry, World, WorldError, mesh::Mesh};

/// Builds the scene: a ring of springs with gas in it, two metres above a floor.
pub(crate) fn scene() -> Result<Blueprint<2>, Box<dyn std::error::Error>> {
    let registry = Registry::<2>::default();
    let springs = registry.model_values("mass_spring", &[("stiffness", 1600.0.into()), ("damping", 1.0.into())])?;
    let gas = registry.model_values("pressure", &[("nRT", 55.0.into()), ("ambient", 0.0.into())])?;
    let ring = Mesh::ring(0.5, 36, [0.0, 2.0], 0.0)?;

    let mut scene = Blueprint::new("ball", registry.integrator_values("verlet", &[])?);
    scene.time.substeps = 32;
    scene.surroundings.gravity = [0.0, -9.81];
    scene.bodies.push(BodyBlueprint::new("ball", ring, Mass::Total(1.0), vec![springs, gas]));
    let floor = [("normal", [0.0, 1.0].into()), ("restitution", 0.3.into()), ("friction", 0.4.into())];
    scene.colliders.push(ColliderBlueprint::new::<2>("half_space", &floor)?);
    Ok(scene)
}

/// The height of the lowest node [m].
pub(crate) fn lowest(world: &World<2>) -> f64 {
    (0..world.node_count(0) as u32).map(|node| world.position(0, node)[1]).min_by(f64::total_cmp).unwrap_or(f64::NAN)
}

/// Steps through two seconds; returns the heights of the lowest node, frame by frame [m].
pub(crate) fn heights(world: &mut World<2>) -> Result<Vec<f64>, WorldError> {
    (0..120)
        .map(|_| {
            world.frame()?;
            Ok(lowest(world))
        })
        .collect()
}

/// Returns when the ball reaches the floor [s], and how far it rises again [m].
pub(crate) fn run() -> Result<(f64, f64), Box<dyn std::error::Error>> {
    let mut world = World::new(scene()?, Options::default())?;
    let heights = heights(&mut world)?;
    let meets = heights.iter().position(|height| *height < 1e-3).ok_or("the ball does not meet the floor")?;
    let rises = heights[meets..].iter().copied().max_by(f64::total_cmp).unwrap_or(0.0);
    Ok(((meets + 1) as f64 / 60.0, rises))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (meets, rises) = run()?;
    println!("the ball meets the floor after {meets:.2} s and rises again by {rises:.2} m");
    Ok(())
}
