//! A thousand discs of gas that fill a box, so that all of them are in contact: time, height, and overlap.

use crate::falling::{Depth, Row, Table, positions, run_and_measure};
use crate::rapier;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue};
use rapier2d::prelude::*;
use std::ops::Range;

const SCENE: &str = include_str!("../../benches/scenes/heap.toml");

/// The depth of a node inside another disc, as a fraction of the diameter.
const MEASURE: Depth<2> = Depth { of: &depth, unit: 2.0 * RADIUS };

/// The walled box of the scene [m].
const BOX: [f32; 2] = [57.8, 40.0];
const RADIUS: f64 = 0.5;
const FRICTION: f32 = 0.3;

/// The numbers of substeps of Opruga per frame. The first is near its limit of stability, and the last is that of the scene.
const SUBSTEPS: [u32; 3] = [8, 16, 32];

/// The timed frames: from 0.5 to 1 s.
const TIMED: Range<usize> = 30..60;

/// The scene with this number of substeps.
fn world(substeps: u32) -> Result<World<2>, String> {
    let overrides = vec![("time.substeps".to_string(), substeps.to_string())];
    let reading = scene::Options { overrides, ..scene::Options::default() };
    let (blueprint, _) = scene::read(SCENE.as_bytes(), "heap", &catalogue(), &reading)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    let AnyBlueprint::Plane(blueprint) = blueprint else { return Err("the discs are not in the plane".into()) };
    World::new(blueprint, Options::default()).map_err(|e| e.to_string())
}

fn of_rapier(own: &World<2>) -> Result<Row, String> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81);
    world.integration_parameters.num_solver_iterations = rapier::SUBSTEPS as usize;
    // The walls are thick. Their inner size is that of Opruga's box.
    let [width, height] = BOX;
    for (center, half) in [
        ([0.5 * width, -5.0], [width, 5.0]),
        ([-5.0, 0.5 * height], [5.0, height]),
        ([width + 5.0, 0.5 * height], [5.0, height]),
    ] {
        let wall = ColliderBuilder::cuboid(half[0], half[1]).friction(FRICTION);
        world.insert(RigidBodyBuilder::fixed().translation(Vector::new(center[0], center[1])), wall);
    }
    let discs = positions(own);
    let handles: Vec<SoftBodyHandle> = (discs.iter())
        .map(|nodes| {
            let narrow = |x: &[f64; 2]| Vector::new(x[0] as f32, x[1] as f32);
            let builder = SoftBodyBuilder::polygon(nodes.iter().map(narrow).collect())
                .surface_collider(ColliderBuilder::ball(1.0).friction(FRICTION))
                .mass(1.0)
                .can_sleep(false);
            world.insert_soft_body(builder)
        })
        .collect();
    let place = |world: &PhysicsWorld| {
        let of = |handle: &SoftBodyHandle| {
            let body = &world.soft_bodies[*handle];
            let at = |node| {
                let x = body.particle_position(node);
                [f64::from(x.x), f64::from(x.y)]
            };
            (0..discs[0].len()).map(at).collect()
        };
        handles.iter().map(of).collect()
    };
    let step = |world: &mut PhysicsWorld| {
        world.step();
        Ok(())
    };
    run_and_measure("Rapier, discs, 4 steps", TIMED, &mut world, step, place, &MEASURE)
}

/// Runs Rapier and Opruga on the thousand discs.
pub fn compare() -> Result<Table, String> {
    let own = world(SUBSTEPS[0])?;
    let mut rows = vec![of_rapier(&own)?];
    for substeps in SUBSTEPS {
        let mut own = world(substeps)?;
        let step = |world: &mut World<2>| world.frame().map(|_| ()).map_err(|e| e.to_string());
        let name = format!("Opruga, symplectic Euler, {substeps} steps");
        rows.push(run_and_measure(&name, TIMED, &mut own, step, positions, &MEASURE)?);
    }
    let title = format!("{} discs of 36 vertices that fill a box", own.blueprint().bodies.len());
    Ok(Table { title, more: vec!["deepest node, % of a diameter"], rows })
}

type Point = [f64; 2];

fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Whether a point is inside a polygon, by the number of crossings of a ray to the right.
fn is_within(p: &Point, polygon: &[Point]) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides
        .filter(|(a, b)| (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    crossed.count() % 2 == 1
}

/// The distance of a point from the outline of a polygon.
fn distance(p: &Point, polygon: &[Point]) -> f64 {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let to_side = |(a, b): (&Point, &Point)| {
        let (along, to) = (minus(b, a), minus(p, a));
        let t = ((to[0] * along[0] + to[1] * along[1]) / (along[0] * along[0] + along[1] * along[1])).clamp(0.0, 1.0);
        (to[0] - t * along[0]).hypot(to[1] - t * along[1])
    };
    sides.map(to_side).fold(f64::INFINITY, f64::min)
}

/// The depth of a point inside a polygon [m]; 0 outside.
fn depth(p: &Point, polygon: &[Point]) -> f64 {
    if is_within(p, polygon) { distance(p, polygon) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_as_deep_as_the_nearest_side_is_away() {
        let square = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let spike = vec![[0.9, 0.5], [1.5, 0.4], [1.5, 0.6]];
        assert!((MEASURE.deepest(&vec![square.clone(), spike]) - 0.1).abs() < 1e-12);
        let beside = square.iter().map(|x| [x[0] + 1.1, x[1]]).collect();
        assert_eq!(MEASURE.deepest(&vec![square, beside]), 0.0);
    }
}
