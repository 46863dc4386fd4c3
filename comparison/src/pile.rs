//! Cubes of tetrahedra that fall on one another in a walled box: time, height, and overlap.

use crate::falling::{Depth, Row, Table, positions, run_and_measure};
use crate::rapier;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue};
use rapier3d::prelude::*;
use std::ops::Range;

const SCENE: &str = include_str!("../../benches/scenes/falling-cubes.toml");

/// Edge of a cube [m].
const EDGE: f64 = 0.8;

/// The numbers of substeps per frame for explicit steps. The first is near their limit of stability, and the last is that of the scene.
const EXPLICIT: [u32; 3] = [8, 12, 20];

/// The numbers of substeps per frame for implicit steps in real time.
const IMPLICIT: [u32; 2] = [1, 2];

/// The timed frames: from 1.5 to 2.5 s.
const TIMED: Range<usize> = 90..150;

/// The data that the programs share.
struct Cubes {
    positions: Vec<Vec<[f64; 3]>>,
    masses: Vec<f64>,
    tetrahedra: Vec<[u32; 4]>,
    facets: Vec<[u32; 3]>,
}

/// The scene with `along` cubes along every axis, this number of substeps, and further settings.
fn world(along: usize, substeps: u32, more: &[(&str, &str)]) -> Result<World<3>, String> {
    let count = format!("[{along}, {along}, {along}]");
    let settings = [("body.cube.copies.count", count.as_str()), ("time.substeps", &substeps.to_string())];
    let overrides = settings.iter().chain(more).map(|(key, value)| (key.to_string(), value.to_string())).collect();
    let far = format!("[{:?}, 60.0, {:?}]", along as f64 + 0.5, along as f64 + 0.5);
    let text = SCENE.replace("max = [3.5, 20.0, 3.5]", &format!("max = {far}"));
    let reading = scene::Options { overrides, ..scene::Options::default() };
    let (blueprint, _) = scene::read(text.as_bytes(), "falling-cubes", &catalogue(), &reading)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    let AnyBlueprint::Space(blueprint) = blueprint else { return Err("the cubes are not in space".into()) };
    World::new(blueprint, Options::default()).map_err(|e| e.to_string())
}

fn cubes(world: &World<3>) -> Cubes {
    let nodes = world.node_count(0) as u32;
    let mesh = &world.blueprint().bodies[0].mesh;
    Cubes {
        positions: positions(world),
        masses: (0..nodes).map(|node| world.node_mass(0, node)).collect(),
        tetrahedra: mesh.cells.tetrahedra.clone(),
        facets: mesh.facets.clone(),
    }
}

fn of_rapier(cubes: &Cubes, along: usize, name: &str, solver: SoftBodySolver) -> Result<Row, String> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.integration_parameters.num_solver_iterations = rapier::SUBSTEPS as usize;
    let far = along as f32 + 0.5;
    let middle = 0.5 * (far - 0.5);
    // The walls are thick. Their inner size is that of Opruga's box.
    for (center, half) in [
        ([middle, -2.0, middle], [far + 4.0, 2.0, far + 4.0]),
        ([-2.5, 20.0, middle], [2.0, 30.0, far + 4.0]),
        ([far + 2.0, 20.0, middle], [2.0, 30.0, far + 4.0]),
        ([middle, 20.0, -2.5], [far + 4.0, 30.0, 2.0]),
        ([middle, 20.0, far + 2.0], [far + 4.0, 30.0, 2.0]),
    ] {
        let wall = ColliderBuilder::cuboid(half[0], half[1], half[2]).friction(0.5);
        let place = Vector::new(center[0], center[1], center[2]);
        world.insert(RigidBodyBuilder::fixed().translation(place), wall);
    }
    let handles: Vec<SoftBodyHandle> = (cubes.positions.iter())
        .map(|nodes| {
            let narrow = |x: &[f64; 3]| Vector::new(x[0] as f32, x[1] as f32, x[2] as f32);
            let material = SoftBodyMaterial { young_modulus: 1e5, poisson_ratio: 0.4, ..SoftBodyMaterial::default() };
            let body = SoftBodyBuilder::new(nodes.iter().map(narrow).collect())
                .cells(cubes.tetrahedra.clone())
                .surface(cubes.facets.clone())
                .cell_model(SoftBodyCellModel::Corotational)
                .material(material)
                .solver(solver)
                .masses(cubes.masses.iter().map(|m| *m as f32).collect())
                .can_sleep(false);
            world.insert_soft_body(body)
        })
        .collect();
    let place = |world: &PhysicsWorld| {
        let of = |handle: &SoftBodyHandle| {
            let body = &world.soft_bodies[*handle];
            let at = |node| {
                let x = body.particle_position(node);
                [f64::from(x.x), f64::from(x.y), f64::from(x.z)]
            };
            (0..cubes.masses.len()).map(at).collect()
        };
        handles.iter().map(of).collect()
    };
    let step = |world: &mut PhysicsWorld| {
        world.step();
        Ok(())
    };
    let depth = |p: &Point, nodes: &[Point]| depth(cubes, p, nodes);
    run_and_measure(name, TIMED, &mut world, step, place, &Depth { of: &depth, unit: EDGE })
}

/// Runs Rapier and Opruga with this number of cubes along every axis.
pub fn compare(along: usize) -> Result<Table, String> {
    let own = world(along, EXPLICIT[0], &[])?;
    let cubes = cubes(&own);
    let mut rows = vec![of_rapier(&cubes, along, "Rapier, constraints, 4 steps", SoftBodySolver::Constraints)?];
    let real_time = [("integrator.kind", "backward_euler"), ("integrator.accuracy", "real_time")];
    let barrier = [real_time[0], real_time[1], ("contact.response", "barrier")];
    let explicit = EXPLICIT.map(|substeps| (substeps, &[][..], "symplectic Euler"));
    let implicit = IMPLICIT.map(|substeps| (substeps, &real_time[..], "backward Euler, real time"));
    let by_barrier = [(IMPLICIT[0], &barrier[..], "backward Euler, real time, barrier")];
    for (substeps, settings, rule) in explicit.into_iter().chain(implicit).chain(by_barrier) {
        let mut own = world(along, substeps, settings)?;
        let step = |world: &mut World<3>| world.frame().map(|_| ()).map_err(|e| e.to_string());
        let name = format!("Opruga, {rule}, {substeps} {}", if substeps == 1 { "step" } else { "steps" });
        let depth = |p: &Point, nodes: &[Point]| depth(&cubes, p, nodes);
        rows.push(run_and_measure(&name, TIMED, &mut own, step, positions, &Depth { of: &depth, unit: EDGE })?);
    }
    let title = format!("{} cubes of 320 tetrahedra, E = 1e5 Pa, that fall on one another", cubes.positions.len());
    Ok(Table { title, more: vec!["deepest node, % of an edge"], rows })
}

type Point = [f64; 3];

fn minus(a: &Point, b: &Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: &Point, b: &Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Point, b: &Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Six times the volume of a tetrahedron.
fn volume(a: &Point, b: &Point, c: &Point, d: &Point) -> f64 {
    dot(&cross(&minus(b, a), &minus(c, a)), &minus(d, a))
}

fn is_within(p: &Point, corners: [&Point; 4]) -> bool {
    let [a, b, c, d] = corners;
    let whole = volume(a, b, c, d);
    [volume(p, b, c, d), volume(a, p, c, d), volume(a, b, p, d), volume(a, b, c, p)].iter().all(|v| v * whole >= 0.0)
}

/// The distance of a point from a triangle: from its plane, its sides or its corners.
fn distance(p: &Point, corners: [&Point; 3]) -> f64 {
    let mut least = f64::INFINITY;
    for k in 0..3 {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        let (along, to) = (minus(b, a), minus(p, a));
        let t = (dot(&to, &along) / dot(&along, &along)).clamp(0.0, 1.0);
        let rest = minus(&to, &along.map(|c| t * c));
        least = least.min(dot(&rest, &rest).sqrt());
    }
    let normal = cross(&minus(corners[1], corners[0]), &minus(corners[2], corners[0]));
    let over = (0..3).all(|k| {
        let (a, b) = (corners[k], corners[(k + 1) % 3]);
        dot(&cross(&minus(b, a), &minus(p, a)), &normal) >= 0.0
    });
    if over {
        least = least.min((dot(&normal, &minus(p, corners[0])) / dot(&normal, &normal).sqrt()).abs());
    }
    least
}

/// The depth of a point inside a cube with nodes at these positions [m]; 0 outside.
fn depth(cubes: &Cubes, p: &Point, nodes: &[Point]) -> f64 {
    let at = |k: &u32| &nodes[*k as usize];
    if !cubes.tetrahedra.iter().any(|cell| is_within(p, cell.each_ref().map(at))) {
        return 0.0;
    }
    cubes.facets.iter().map(|facet| distance(p, facet.each_ref().map(at))).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_node_is_as_deep_as_the_nearest_side_is_away() {
        let world = world(1, EXPLICIT[0], &[]).expect("a cube");
        let cubes = cubes(&world);
        let one = positions(&world).remove(0);
        let moved = |by: f64| one.iter().map(|x| [x[0] + EDGE - by, x[1] + 0.01, x[2] + 0.013]).collect::<Vec<_>>();
        let depth = |p: &Point, nodes: &[Point]| depth(&cubes, p, nodes);
        let measure = Depth { of: &depth, unit: EDGE };
        assert_eq!(measure.deepest(&vec![one.clone(), moved(-0.01)]), 0.0);
        assert!((measure.deepest(&vec![one.clone(), moved(0.03)]) - 0.03).abs() < 1e-12);
    }
}
