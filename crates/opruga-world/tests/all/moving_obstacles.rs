//! Obstacles whose motion changes all the time, and the bodies that they carry, with `bdf2`, which depends on the previous motion of nodes.

use crate::common;
use common::solid;
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Blueprint, ColliderBlueprint, PinBlueprint, Selector};
use opruga_world::{Options, World};

const MATERIAL: [(&str, Value); 3] =
    [("youngs_modulus", Value::Number(1e5)), ("poissons_ratio", Value::Number(0.3)), ("damping", Value::Number(2e-3))];

fn world<const D: usize>(mut blueprint: Blueprint<D>, ground: &[(&str, Value)]) -> World<D> {
    blueprint.surroundings.gravity[1] = -9.81;
    blueprint.colliders.push(ColliderBlueprint::new::<D>("half_space", ground).expect("a plane"));
    World::new(blueprint, Options::default()).expect("a world")
}

/// A block of 300 kg on a platform that accelerates at 4 m/s² and whose motion has many rows per step: the platform supports the weight of the block
/// and accelerates it. If the platform hit the block in every step, the integrator would supply a quarter of this work.
#[test]
fn a_platform_that_speeds_up_does_all_the_work_on_what_it_carries() {
    let (speeding_up, mass) = (4.0, 300.0);
    let rows = (0..8000).map(|k| f64::from(k) / 3840.0).map(|t| vec![t, 0.0, 0.5 * speeding_up * t * t]).collect();
    let mut block = solid(Mesh::<2>::grid([0.0; 2], [1.0, 0.3], [4; 2]).unwrap(), "bdf2", &[], &MATERIAL);
    block.time.substeps = 2;
    let mut lifted = world(block, &[("normal", [0.0, 1.0].into()), ("motion", Value::Rows(rows))]);
    for _ in 0..120 {
        lifted.frame().unwrap();
    }
    let (energy, height) = (lifted.energy(), lifted.position(0, 0)[1]);
    assert!((height - 8.0).abs() < 1e-3, "{height} m");
    let wanted = mass * (9.81 + speeding_up) * height;
    assert!((energy.work_user / wanted - 1.0).abs() < 1e-3, "{wanted} J: {energy:?}");
    let lost = [energy.loss_contact, energy.loss_numerical];
    assert!(lost.iter().all(|loss| loss.abs() < 1e-3 * wanted), "{wanted} J: {energy:?}");
}

/// A cube of 27 kg with a kinetic energy of 25 J that sticks on a turntable and rotates with it.
#[test]
fn a_turntable_takes_nothing_by_friction_of_what_sticks_on_it() {
    let spin = 2.0;
    let mut cube = solid(Mesh::<3>::grid([0.5, 0.0, 0.0], [0.3; 3], [2; 3]).unwrap(), "bdf2", &[], &MATERIAL);
    cube.bodies[0].angular_velocity = vec![0.0, spin, 0.0];
    // The velocity of its centre, at (0.65, 0.15, 0.15) m.
    cube.bodies[0].velocity = [0.15 * spin, 0.0, -0.65 * spin];
    let table = [("normal", [0.0, 1.0, 0.0].into()), ("friction", 1.0.into()), ("spin", [0.0, spin, 0.0].into())];
    let mut turned = world(cube, &table);
    let radius = |world: &World<3>| {
        let [x, _, z] = world.position(0, 0);
        (x * x + z * z).sqrt()
    };
    (0..30).for_each(|_| turned.frame().unwrap());
    let (before, begun) = (turned.energy(), radius(&turned));
    (0..60).for_each(|_| turned.frame().unwrap());
    let (after, ended) = (turned.energy(), radius(&turned));
    let lost = after.loss_friction - before.loss_friction;
    assert!(after.kinetic > 20.0 && (ended - begun).abs() < 1e-3, "{begun} m, {ended} m: {after:?}");
    assert!(lost.abs() < 0.01, "{lost} J: {after:?}");
}

/// A block whose bottom pins pull 0.3 m below a floor, which holds all other nodes: only the pins do work, and they supply the energy of the block.
#[test]
fn an_obstacle_does_nothing_to_nodes_that_pins_lead_through_it() {
    for rule in ["backward_euler", "bdf2", "implicit_midpoint", "newmark"] {
        let mut block = solid(Mesh::<2>::grid([0.0; 2], [0.6; 2], [3; 2]).unwrap(), rule, &[], &MATERIAL);
        block.time.substeps = 8;
        block.bodies[0].pins.push(PinBlueprint {
            select: Selector::Side("bottom".into()),
            axes: [true; 2],
            motion: vec![vec![0.0; 3], vec![0.5, 0.0, -0.3]],
        });
        let mut pulled = world(block, &[("normal", [0.0, 1.0].into()), ("friction", 0.5.into())]);
        (0..60).for_each(|_| pulled.frame().unwrap());
        let energy = pulled.energy();
        assert!(energy.elastic > 1e3, "{rule}: {energy:?}");
        assert!(energy.work_correction.abs() < 1e-3 * energy.elastic, "{rule}: {energy:?}");
        assert!(energy.loss_numerical.abs() < 0.2 * energy.elastic, "{rule}: {energy:?}");
    }
}
