//! A thousand discs of gas that fill a box, so that all of them touch: time, height, and how deep they are in one another.

use crate::falling::{Positions, Row, Table, positions, run};
use crate::rapier;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue};
use rapier2d::prelude::*;
use std::ops::Range;

const SCENE: &str = include_str!("../../benches/scenes/heap.toml");

/// The walled box of the scene [m].
const BOX: [f32; 2] = [57.8, 40.0];
const RADIUS: f64 = 0.5;
const FRICTION: f32 = 0.3;

/// The substeps of Opruga in a frame: near its limit of stability, and those of the scene.
const SUBSTEPS: [u32; 3] = [8, 16, 32];

/// The frames that are timed: from 0.5 to 1 s.
const TIMED: Range<usize> = 30..60;

/// Every such frame, the depth is measured.
const LOOK: usize = 10;

/// The scene, with as many substeps.
fn world(substeps: u32) -> Result<World<2>, String> {
    let overrides = vec![("time.substeps".to_string(), substeps.to_string())];
    let reading = scene::Options { overrides, ..scene::Options::default() };
    let (blueprint, _) = scene::read(SCENE.as_bytes(), "heap", &catalogue(), &reading)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    let AnyBlueprint::Plane(blueprint) = blueprint else { return Err("the discs are not in the plane".into()) };
    World::new(blueprint, Options::default()).map_err(|e| e.to_string())
}

/// Lets a program step through the frames: time, mean height, and how deep discs are in one another.
fn measure<W>(
    name: &str,
    world: &mut W,
    step: impl FnMut(&mut W) -> Result<(), String>,
    place: impl Fn(&W) -> Positions<2>,
) -> Result<Row, String> {
    let mut deepest: f64 = 0.0;
    let mut row = run(name, TIMED, world, step, |world, frame| {
        let at = place(world);
        if TIMED.contains(&frame) && (frame + 1 - TIMED.start).is_multiple_of(LOOK) {
            deepest = deepest.max(depth(&at));
        }
        at
    })?;
    row.more.push(100.0 * deepest / (2.0 * RADIUS));
    Ok(row)
}

fn of_rapier(own: &World<2>) -> Result<Row, String> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81);
    world.integration_parameters.num_solver_iterations = rapier::SUBSTEPS as usize;
    // Thick walls: the inside is that of Opruga's box.
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
    measure("Rapier, discs, 4 steps", &mut world, step, place)
}

/// Rapier and Opruga on the thousand discs.
pub fn compare() -> Result<Table, String> {
    let own = world(SUBSTEPS[0])?;
    let mut rows = vec![of_rapier(&own)?];
    for substeps in SUBSTEPS {
        let mut own = world(substeps)?;
        let step = |world: &mut World<2>| world.frame().map(|_| ()).map_err(|e| e.to_string());
        rows.push(measure(&format!("Opruga, symplectic Euler, {substeps} steps"), &mut own, step, positions)?);
    }
    let title = format!("{} discs of 36 vertices that fill a box", own.blueprint().bodies.len());
    Ok(Table { title, more: vec!["deepest node, % of a diameter"], rows })
}

type Point = [f64; 2];

fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

/// Whether a point is inside a polygon, by how often a ray to the right crosses it.
fn is_within(p: &Point, polygon: &[Point]) -> bool {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let crossed = sides
        .filter(|(a, b)| (a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    crossed.count() % 2 == 1
}

/// The distance of a point and the outline of a polygon.
fn distance(p: &Point, polygon: &[Point]) -> f64 {
    let sides = polygon.iter().zip(polygon.iter().cycle().skip(1));
    let to_side = |(a, b): (&Point, &Point)| {
        let (along, to) = (minus(b, a), minus(p, a));
        let t = ((to[0] * along[0] + to[1] * along[1]) / (along[0] * along[0] + along[1] * along[1])).clamp(0.0, 1.0);
        (to[0] - t * along[0]).hypot(to[1] - t * along[1])
    };
    sides.map(to_side).fold(f64::INFINITY, f64::min)
}

/// How deep a node of one disc is inside another one, at most [m].
fn depth(at: &Positions<2>) -> f64 {
    let boxes: Vec<[Point; 2]> = at
        .iter()
        .map(|nodes| {
            nodes.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], x| {
                [std::array::from_fn(|d| low[d].min(x[d])), std::array::from_fn(|d| high[d].max(x[d]))]
            })
        })
        .collect();
    let mut deepest: f64 = 0.0;
    for (a, nodes) in at.iter().enumerate() {
        for (b, other) in at.iter().enumerate().filter(|(b, _)| *b != a) {
            let near = |x: &&Point| (0..2).all(|d| boxes[b][0][d] <= x[d] && x[d] <= boxes[b][1][d]);
            for p in nodes.iter().filter(near).filter(|p| is_within(p, other)) {
                deepest = deepest.max(distance(p, other));
            }
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_as_deep_as_the_nearest_side_is_away() {
        let square = |x: f64| vec![[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
        let spike = vec![[0.9, 0.5], [1.5, 0.4], [1.5, 0.6]];
        assert!((depth(&vec![square(0.0), spike]) - 0.1).abs() < 1e-12);
        assert_eq!(depth(&vec![square(0.0), square(1.1)]), 0.0);
    }
}
