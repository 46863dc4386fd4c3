//! Contact of bodies that begin inside one another, and of implicit rules with obstacles that have corners.

use crate::contact::{contact, world};
use crate::implicit_contact::{block, fixed, heavy};
use opruga_core::spec::Value;
use opruga_world::World;
use opruga_world::blueprint::*;

fn lowest(world: &World<2>, body: usize) -> f64 {
    let heights = (0..world.node_count(body) as u32).map(|node| world.position(body, node)[1]);
    heights.fold(f64::INFINITY, |low, y| if y < low { y } else { low })
}

/// All nodes of the lowest row begin deeper than they could touch anything: they come out through the nearest side, and no energy is made.
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

/// A block of an implicit rule falls onto the edge of a box, tips over, and slides off: the box does not poke into it, and contact makes no
/// energy. Where an obstacle holds nodes, contact beside its corner cannot lift them.
#[test]
fn a_block_of_an_implicit_rule_falls_over_the_corner_of_a_box() {
    for response in ["constraint", "barrier"] {
        let mut above = block("block", [1.0, 0.5], [6, 3], [0.55, 0.3], 1.0, 3e3);
        above.translation[1] = 0.3;
        let mut scene = heavy("backward_euler", vec![above], 2);
        scene.contact = contact::<2>(&[("response", response.into()), ("friction", 0.3.into())]);
        let numbers = |x: [f64; 2]| Value::Numbers(x.to_vec());
        let fields = [("min", numbers([-1.0, -1.0])), ("max", numbers([1.0, 0.0])), ("friction", 0.3.into())];
        scene.colliders.push(ColliderBlueprint::new::<2>("box", &fields).expect("a box"));
        let mut world = world(&scene);
        for _ in 0..60 {
            world.frame().unwrap_or_else(|error| panic!("{response}: {error}"));
            let nearest = world.nearest_surface_point([1.0, 0.0], 10.0).expect("a point").expect("a body");
            assert!(nearest.distance > -1e-3, "{response} at {} s: {nearest:?}", world.time());
            let energy = world.energy();
            assert!(energy.loss_contact > -1e-3 && energy.closure < 1e-4, "{response}: {energy:?}");
        }
        assert!(lowest(&world, 0) < -0.5, "{response}: {}", lowest(&world, 0));
    }
}
