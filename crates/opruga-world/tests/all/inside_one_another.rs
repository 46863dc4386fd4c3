//! Contact of bodies that start inside one another.

use crate::contact::{model, scene, world};
use crate::implicit_contact::{block, fixed, heavy};
use opruga_mesh::Mesh;
use opruga_world::World;
use opruga_world::blueprint::*;

fn lowest(world: &World<2>, body: usize) -> f64 {
    let heights = (0..world.node_count(body) as u32).map(|node| world.position(body, node)[1]);
    heights.fold(f64::INFINITY, |low, y| if y < low { y } else { low })
}

/// All nodes of the lowest row start deeper than contact reaches: they come out through the nearest side, without a gain of energy.
#[test]
fn a_block_that_begins_inside_a_floor_comes_out() {
    for (rule, substeps) in [("symplectic_euler", 32), ("backward_euler", 8)] {
        for depth in [0.02, 0.1] {
            let floor = fixed(block("floor", [5.0, 2.0], [10, 4], [-2.0, -2.0], 1.0, 1e3));
            let bodies = vec![floor, block("block", [1.0, 1.0], [4, 4], [0.03, -depth], 1.0, 1e3)];
            let mut world = world(&heavy(rule, bodies, substeps));
            for _ in 0..90 {
                world.frame().unwrap_or_else(|error| panic!("{rule} from {depth} m: {error}"));
                let energy = world.energy();
                assert!(energy.kinetic < 1.0, "{rule} from {depth} m: {energy:?}");
            }
            assert!(lowest(&world, 1) > -1e-3, "{rule} from {depth} m: {}", lowest(&world, 1));
            assert_eq!(world.overlaps(), [], "{rule} from {depth} m");
        }
    }
}

/// Four cubes that overlap by a tenth of their size, slightly misaligned: points beside an edge of another cube do not leave sideways, and edges do
/// not lock the cubes together.
#[test]
fn cubes_that_begin_inside_one_another_part() {
    let solid = vec![model::<3>("fem", &[("youngs_modulus", 1e4), ("poissons_ratio", 0.3), ("damping", 0.01)])];
    let cube = |name: &str, x: [f64; 3]| {
        let mesh = Mesh::<3>::grid([0.0; 3], [0.8; 3], [3; 3]).expect("a cube");
        BodyBlueprint { translation: x, ..BodyBlueprint::new(name, mesh, Mass::Total(10.0), solid.clone()) }
    };
    let places = [[0.0, 0.0, 0.0], [0.72, 0.02, -0.03], [-0.02, 0.72, 0.03], [0.7, 0.74, 0.01]];
    let bodies = ["a", "b", "c", "d"].into_iter().zip(places).map(|(name, x)| cube(name, x)).collect();
    let mut scene = scene("symplectic_euler", bodies);
    scene.time = Time { seconds: 2.0, frame: 1.0 / 60.0, substeps: 32 };
    let mut world = world(&scene);
    assert!(world.overlaps().len() > 5);
    for _ in 0..30 {
        world.frame().expect("a frame");
    }
    assert_eq!((world.overlaps(), world.crossed_surfaces()), (Vec::new(), Vec::new()));
    let energy = world.energy();
    assert!(energy.kinetic + energy.elastic < energy.work_correction, "{energy:?}");
}
