//! Bodies that touch with the skins that they carry.

use crate::contact::{contact, model, scene, world};
use opruga_core::spec::{Value, Values};
use opruga_math::Lane;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::schema::BODY_CONTACT;

/// A ball of 0.5 m filled by a lattice, which extends beyond it by up to 0.1 m.
fn ball(name: &str, surface: &str, x: f64, v: f64) -> BodyBlueprint<3> {
    let mesh = Mesh::<3>::icosphere(0.5, 2).expect("a ball").lattice_filling(0.2).expect("a lattice");
    let springs = vec![model::<3>("mass_spring", &[("stiffness", 200.0), ("damping", 0.02)])];
    let mut own = Values::defaults(BODY_CONTACT.spec, 3);
    own.set(BODY_CONTACT.spec, "surface", Value::Text(surface.into()), 3).expect("a field");
    BodyBlueprint {
        translation: [x, 0.02 * x, 0.0],
        velocity: [v, 0.0, 0.0],
        contact: Some(own),
        ..BodyBlueprint::new(name, mesh, Mass::Total(1.0), springs)
    }
}

/// The smallest distance between the centres of two balls [m], and their momentum before and after [kg m/s].
fn meet(rule: &str, surface: &str, response: &str) -> (f64, [f64; 2]) {
    let mut scene = scene(rule, vec![ball("a", surface, -0.75, 1.0), ball("b", surface, 0.75, -0.5)]);
    scene.contact = contact::<3>(&[("friction", 0.3.into()), ("response", response.into())]);
    scene.time = Time { seconds: 1.0, frame: 1.0 / 60.0, substeps: if rule == "symplectic_euler" { 64 } else { 1 } };
    let mut world = world(&scene);
    let mass = |world: &opruga_world::World<3>, body: usize, node: u32| world.node_mass(body, node);
    let sum = |world: &opruga_world::World<3>, body: usize, of: &dyn Fn(u32) -> f64| {
        (0..world.node_count(body) as u32).map(|node| mass(world, body, node) * of(node)).sum::<f64>()
    };
    let momentum = |world: &opruga_world::World<3>| {
        [0, 1].map(|body| sum(world, body, &|node| world.velocity(body, node)[0])).iter().sum::<f64>()
    };
    let before = momentum(&world);
    let mut nearest = f64::INFINITY;
    for frame in 0..40 {
        world.frame().unwrap_or_else(|error| panic!("{rule} {surface}, frame {frame}: {error}"));
        assert_eq!(world.crossed_surfaces(), [], "{rule} {surface}, frame {frame}");
        let [a, b] = [0, 1].map(|body| sum(&world, body, &|node| world.position(body, node)[0]));
        nearest = nearest.smaller(b - a);
    }
    (nearest, [before, momentum(&world)])
}

#[test]
fn lattices_touch_with_the_skin_that_is_drawn() {
    let (skin, [before, after]) = meet("symplectic_euler", "skin", "constraint");
    assert!((before - after).abs() < 1e-12, "{before} {after}");
    let (cells, _) = meet("symplectic_euler", "cells", "constraint");
    // The skins are pressed in; the cells extend beyond them.
    assert!(skin < 1.0 && skin > 0.8 && cells > skin + 0.05, "{skin} {cells}");
}

#[test]
fn skins_touch_under_implicit_rules() {
    skins_touch("constraint");
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn skins_touch_under_a_barrier_whole_sweep() {
    skins_touch("barrier");
}

fn skins_touch(response: &str) {
    let (explicit, _) = meet("symplectic_euler", "skin", "constraint");
    let (nearest, [before, after]) = meet("backward_euler", "skin", response);
    assert!((before - after).abs() < 1e-6, "{before} {after}");
    assert!((nearest - explicit).abs() < 0.1, "{nearest} {explicit}");
}
