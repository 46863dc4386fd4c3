//! Rapier: bodies of linear tetrahedra, with Opruga's nodes, cells and masses.

use crate::motion::Run;
use crate::ours::Shape;
use crate::processor_time;
use rapier3d::prelude::*;

/// The version of Rapier.
pub const VERSION: &str = "0.36";

/// The default number of steps of its solver per frame.
pub const SUBSTEPS: u32 = 4;

/// The damping of the cells, as a fraction of critical damping.
#[derive(Clone, Copy, Debug)]
pub enum Damping {
    /// None, except for the numerical damping of the integrator.
    None,
    /// The default: critical damping.
    Full,
}

/// Runs a body frame by frame until `enough` returns true, for at most `frames` frames.
pub fn run(
    shape: &Shape,
    modulus: f64,
    solver: SoftBodySolver,
    damping: Damping,
    frames: usize,
    enough: impl Fn(&Run) -> bool,
) -> Run {
    let mut world = PhysicsWorld::new();
    world.gravity = Vector::new(0.0, -9.81, 0.0);
    world.integration_parameters.num_solver_iterations = SUBSTEPS as usize;
    let narrow = |x: &[f64; 3]| Vector::new(x[0] as f32, x[1] as f32, x[2] as f32);
    let material = SoftBodyMaterial {
        young_modulus: modulus as f32,
        poisson_ratio: 0.4,
        elastic_damping_ratio: match damping {
            Damping::None => 0.0,
            Damping::Full => 1.0,
        },
        ..SoftBodyMaterial::default()
    };
    let body = SoftBodyBuilder::new(shape.positions.iter().map(narrow).collect())
        .cells(shape.tetrahedra.clone())
        .cell_model(SoftBodyCellModel::Corotational)
        .material(material)
        .solver(solver)
        .masses(shape.masses.iter().map(|m| *m as f32).collect())
        .pinned_particles(shape.held.clone())
        .no_surface_collider()
        .can_sleep(false);
    let handle = world.insert_soft_body(body);
    let height = |world: &PhysicsWorld| {
        let body = &world.soft_bodies[handle];
        let sum: f64 = shape.tip.iter().map(|node| f64::from(body.particle_position(*node as usize).y)).sum();
        sum / shape.tip.len() as f64
    };
    let mut run = Run { milliseconds: Vec::new(), heights: vec![height(&world)] };
    while run.milliseconds.len() < frames && !enough(&run) {
        let start = processor_time();
        world.step();
        run.milliseconds.push((processor_time() - start) * 1e3);
        run.heights.push(height(&world));
    }
    run
}
