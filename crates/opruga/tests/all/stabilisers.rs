//! The thesis's limits of force, velocity and pressure: off by default, and each use is counted.

use crate::common;
use common::*;
use opruga::World;

fn count(world: &World<2>, code: &str) -> u64 {
    world.warnings().into_iter().find(|w| w.code == code).map_or(0, |w| w.count)
}

/// Eleven falling nodes of 0.2 kg.
fn stone(limits: &str) -> World<2> {
    built(plane(&format!(
        "{}{limits}\n[[body]]\nname = \"stone\"\nnode_mass = 0.2\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 11 }}\n",
        head(1.0 / 64.0, 16, -10.0, "symplectic_euler")
    )))
}

#[test]
fn limits_are_off_by_default() {
    let mut world = stone("");
    frames(&mut world, 64);
    assert!((world.velocity(0, 0)[1] + 10.0).abs() < 1e-12);
    assert!(world.warnings().is_empty(), "{:?}", world.warnings());
}

/// The weight of a node, 2 N, is limited to 1.5 N in every step.
#[test]
fn the_largest_force_is_kept_and_counted_per_node_and_step() {
    let mut world = stone("largest_force = 1.5");
    frames(&mut world, 64);
    assert!((world.velocity(0, 3)[1] + 7.5).abs() < 1e-12, "{:?}", world.velocity(0, 3));
    assert_eq!((count(&world, "limit.force"), count(&world, "limit.velocity")), (11 * 16 * 64, 0));
}

/// A fall with 10 m/s² reaches 2.5 m/s after a quarter of a second; every later step would exceed it.
#[test]
fn the_largest_velocity_is_kept_and_counted_per_node_and_step() {
    let mut world = stone("largest_velocity = 2.5");
    frames(&mut world, 16);
    assert_eq!(count(&world, "limit.velocity"), 0, "not before it is needed");
    frames(&mut world, 48);
    assert!((world.velocity(0, 3)[1] + 2.5).abs() < 1e-12, "{:?}", world.velocity(0, 3));
    assert_eq!((count(&world, "limit.velocity"), count(&world, "limit.force")), (11 * 16 * 48, 0));
}

/// Also next to one another in a batch that is not full.
#[test]
fn limits_count_the_nodes_of_bodies_alone() {
    let limits = "largest_force = 1.5\nlargest_velocity = 1e9";
    let mut world = built(plane(&format!(
        "{}{limits}\n[[body]]\nname = \"stone\"\nnode_mass = 0.2\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 11 }}\n\
         copies = {{ count = [3], spacing = [2, 0] }}\n",
        head(1.0 / 64.0, 16, -10.0, "symplectic_euler")
    )));
    frames(&mut world, 4);
    assert_eq!((world.islands(), count(&world, "limit.force")), (1, 3 * 11 * 16 * 4));
}

/// The gas of a pinned ring at 100 Pa with a limit of 60 Pa: counted once per step.
#[test]
fn the_largest_pressure_is_kept_and_counted_per_step() {
    let gas = |cap: &str| {
        built(plane(&format!(
            "{}[[body]]\nname = \"ring\"\nfixed = true\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 36 }}\n\
             models = [{{ kind = \"pressure\", pressure = 100.0{cap} }}]\n",
            head(1.0 / 64.0, 16, 0.0, "symplectic_euler")
        )))
    };
    let mut capped = gas(", largest_pressure = 60.0");
    frames(&mut capped, 10);
    let pressure = capped.readings(0).into_iter().find(|r| r.0 == "pressure").expect("a reading").1;
    assert!((pressure - 60.0).abs() < 1e-9, "{pressure}");
    let counted: Vec<_> = capped.warnings().into_iter().map(|w| (w.code, w.count)).collect();
    assert!(counted.len() == 1 && counted[0].1 == 160, "{counted:?}");
    let mut free = gas("");
    frames(&mut free, 10);
    assert!(free.warnings().is_empty(), "{:?}", free.warnings());
}

/// `nearest_facet` grabs the nearest point of an edge: both of its ends are pulled, weighted by their shares.
#[test]
fn a_pull_on_a_facet_moves_both_of_its_ends() {
    let mut world = built(plane(&format!(
        "{}[[body]]\nname = \"box\"\nnode_mass = 1\nshape = {{ kind = \"polygon\", points = [[0, 0], [1, 0], [1, 1], [0, 1]] }}\n\
         [[command]]\ndo = \"drag\"\nat = 0\nuntil = 1\nbody = \"box\"\nnode = \"nearest_facet\"\nstiffness = 1.0\n\
         path = [[0, 2, 0.25], [1, 2, 0.25]]\n",
        head(1.0 / 64.0, 16, 0.0, "symplectic_euler")
    )));
    frames(&mut world, 4);
    let speed = |node: u32| world.velocity(0, node)[0];
    // The point (1, 0.25) is between nodes 1 and 2 with shares 3/4 and 1/4.
    assert!(speed(1) > 0.0 && (speed(1) / speed(2) - 3.0).abs() < 1e-9, "{} {}", speed(1), speed(2));
    assert_eq!((speed(0), speed(3)), (0.0, 0.0));
}
