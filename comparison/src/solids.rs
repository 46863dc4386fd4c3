//! Two solids that fall on a floor: Spot and a ring, both of tetrahedra.

use crate::falling::{Row, Table, positions, run};
use crate::rapier;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue, scenes};
use rapier3d::prelude::*;
use std::ops::Range;

const SCENE: &str = "spot-solid";

/// The friction of the scene's floor.
const FRICTION: f32 = 0.6;

/// The timed frames, in which both solids lie on the floor.
const TIMED: Range<usize> = 60..120;

/// The frames without any contact.
const FLIGHT: Range<usize> = 2..18;

/// The scene with this number of substeps and this accuracy.
fn world(substeps: u32, accuracy: &str) -> Result<World<3>, String> {
    let text = scenes::find(SCENE).ok_or_else(|| format!("the scene `{SCENE}` is missing"))?;
    let overrides = vec![
        ("time.substeps".to_string(), substeps.to_string()),
        ("integrator.accuracy".to_string(), accuracy.to_string()),
    ];
    let reading = scene::Options { overrides, files: scenes::files(), ..scene::Options::default() };
    let (blueprint, _) = scene::read(text.as_bytes(), SCENE, &catalogue(), &reading)
        .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
    let AnyBlueprint::Space(blueprint) = blueprint else { return Err(format!("`{SCENE}` is not in space")) };
    World::new(blueprint, Options::default()).map_err(|e| e.to_string())
}

/// Steps through all frames and adds the median time of those in flight [ms].
fn measure<W>(
    name: &str,
    world: &mut W,
    mut step: impl FnMut(&mut W) -> Result<(), String>,
    place: impl Fn(&W) -> Vec<Vec<[f64; 3]>>,
) -> Result<Row, String> {
    let (mut frame, mut flight) = (0, Vec::new());
    let timed = |world: &mut W| {
        let start = crate::processor_time();
        step(world)?;
        if FLIGHT.contains(&frame) {
            flight.push((crate::processor_time() - start) * 1e3);
        }
        frame += 1;
        Ok(())
    };
    let mut row = run(name, TIMED, world, timed, |world, _| place(world))?;
    flight.sort_by(f64::total_cmp);
    row.more.push(flight[flight.len() / 2]);
    Ok(row)
}

fn of_rapier(own: &World<3>, name: &str, solver: SoftBodySolver) -> Result<Row, String> {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.integration_parameters.num_solver_iterations = rapier::SUBSTEPS as usize;
    world.insert(RigidBodyBuilder::fixed(), ColliderBuilder::new(SharedShape::halfspace(Vector::Y)).friction(FRICTION));
    let bodies = own.blueprint().bodies.iter().zip(positions(own)).enumerate();
    let handles: Vec<SoftBodyHandle> = bodies
        .map(|(number, (body, nodes))| {
            let narrow = |x: &[f64; 3]| Vector::new(x[0] as f32, x[1] as f32, x[2] as f32);
            let masses = (0..nodes.len() as u32).map(|node| own.node_mass(number, node) as f32).collect();
            let material = SoftBodyMaterial { young_modulus: 6e4, poisson_ratio: 0.4, ..SoftBodyMaterial::default() };
            let builder = SoftBodyBuilder::new(nodes.iter().map(narrow).collect())
                .cells(body.mesh.cells.tetrahedra.clone())
                .surface(body.mesh.facets.clone())
                .surface_collider(ColliderBuilder::ball(1.0).friction(FRICTION))
                .cell_model(SoftBodyCellModel::Corotational)
                .material(material)
                .solver(solver)
                .masses(masses)
                .self_contacts(false)
                .can_sleep(false);
            world.insert_soft_body(builder)
        })
        .collect();
    let counts: Vec<usize> = positions(own).iter().map(Vec::len).collect();
    let place = |world: &PhysicsWorld| {
        let of = |(handle, count): (&SoftBodyHandle, &usize)| {
            let body = &world.soft_bodies[*handle];
            let at = |node| {
                let x = body.particle_position(node);
                [f64::from(x.x), f64::from(x.y), f64::from(x.z)]
            };
            (0..*count).map(at).collect()
        };
        handles.iter().zip(&counts).map(of).collect()
    };
    let step = |world: &mut PhysicsWorld| {
        world.step();
        Ok(())
    };
    measure(name, &mut world, step, place)
}

/// Runs Rapier and Opruga on both solids.
pub fn compare(times_only: bool) -> Result<Table, String> {
    let own = world(3, "real_time")?;
    let cells: usize = own.blueprint().bodies.iter().map(|body| body.mesh.cells.tetrahedra.len()).sum();
    let mut rows = vec![of_rapier(&own, "Rapier, constraints, 4 steps", SoftBodySolver::Constraints)?];
    let real_time = [1, 3, 12].map(|substeps| (substeps, "real_time"));
    let settings = if times_only { real_time[..2].to_vec() } else { [&real_time[..], &[(3, "exact")]].concat() };
    for (substeps, accuracy) in settings {
        let mut own = world(substeps, accuracy)?;
        let step = |world: &mut World<3>| world.frame().map(|_| ()).map_err(|e| e.to_string());
        let plural = if substeps == 1 { "" } else { "s" };
        let name = format!("Opruga, BDF2, {}, {substeps} step{plural}", accuracy.replace('_', " "));
        rows.push(measure(&name, &mut own, step, positions)?);
    }
    let title = format!("Spot and a ring of {cells} tetrahedra, E = 6e4 Pa, that fall on a floor");
    Ok(Table { title, more: vec!["ms per frame in flight"], rows })
}
