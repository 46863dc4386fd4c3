//! Bodies at positions that have lost six of their digits.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

use crate::common;

use common::{clamp, solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::{Options, World};

/// The sag of the tip of a bar of 1 m by 0.1 m under its weight, if its corner is at this distance from the origin along both axes [m].
fn sinks(mesh: &Mesh<2>, stiffness: f64, far: f64) -> f64 {
    let fields = [
        ("material", text("neo_hookean")),
        ("youngs_modulus", Value::Number(stiffness)),
        ("poissons_ratio", Value::Number(0.3)),
        ("plane", text("stress")),
    ];
    let mut bar = solid(mesh.clone(), "equilibrium", &[], &fields);
    bar.surroundings.gravity = [0.0, -9.81];
    bar.bodies[0].translation = [far; 2];
    bar.bodies[0].pins = clamp();
    let mut world = World::new(bar, Options::default()).expect("a world");
    let corner = mesh.positions.iter().position(|x| *x == [1.0, 0.0]).expect("the corner") as u32;
    let before = world.position(0, corner)[1];
    world.frame().expect("a balance");
    assert!(!world.warnings().iter().any(|warning| warning.code == "statics.blurred"), "nothing is in doubt");
    before - world.position(0, corner)[1]
}

/// According to Euler and Bernoulli, the sag is 12 ρ g L⁴/(8 E t²): about a millimetre and a decimetre. The tolerance is several times the resolution
/// of positions at 1e6 m, 6e-11 m, because a bar is a hundred times stiffer along its axis than across it.
#[test]
fn bars_bend_alike_a_thousand_kilometres_away() {
    let boxes = Mesh::<2>::grid([0.0; 2], [1.0, 0.1], [10, 1]).expect("a grid");
    let triangles = boxes.clone().into_simplices().expect("triangles").into_quadratic().expect("quadratic triangles");
    for (name, mesh) in [("quadrilaterals", boxes), ("quadratic triangles", triangles)] {
        for (stiffness, sunk, allowed) in [(1.5e9, 1e-3, 3e-5), (1.5e7, 0.1, 3e-7)] {
            let (near, far) = (sinks(&mesh, stiffness, 0.0), sinks(&mesh, stiffness, 1e6));
            assert!((near / sunk - 1.0).abs() < 0.1, "{name}, {stiffness} Pa: {near} m");
            assert!((far / near - 1.0).abs() < allowed, "{name}, {stiffness} Pa: {near} m and {far} m");
        }
    }
}

/// The displacement of the corner of a soft bar after a fifth of a second of free fall, if its corner starts at this distance from the origin [m].
fn falls(rule: &'static str, far: f64) -> [f64; 2] {
    let boxes = Mesh::<2>::grid([0.0; 2], [1.0, 0.25], [8, 2]).expect("a grid");
    let mesh = boxes.into_simplices().expect("triangles").into_quadratic().expect("quadratic triangles");
    let fields = [
        ("material", text("neo_hookean")),
        ("youngs_modulus", Value::Number(2e5)),
        ("poissons_ratio", Value::Number(0.3)),
    ];
    let mut bar = solid(mesh.clone(), rule, &[], &fields);
    bar.time.frame = 1.0 / 64.0;
    bar.time.substeps = 1;
    bar.surroundings.gravity = [0.0, -9.81];
    bar.bodies[0].translation = [far; 2];
    bar.bodies[0].pins = clamp();
    let mut world = World::new(bar, Options::default()).expect("a world");
    let corner = mesh.positions.iter().position(|x| *x == [1.0, 0.0]).expect("the corner") as u32;
    let before = world.position(0, corner);
    (0..13).for_each(|_| world.frame().expect("a step"));
    let after = world.position(0, corner);
    [0, 1].map(|d| after[d] - before[d])
}

/// Coordinates of this mesh are integer multiples of 2⁻⁴ m: they are exact at 2¹⁷ m, where the resolution of positions is 1.5e-11 m.
#[test]
fn bars_fall_alike_a_hundred_kilometres_away() {
    for rule in ["backward_euler", "bdf2", "implicit_midpoint", "newmark"] {
        let (near, far) = (falls(rule, 0.0), falls(rule, 131_072.0));
        let apart = (near[0] - far[0]).hypot(near[1] - far[1]);
        assert!(near[1] < -0.05, "{rule}: {near:?} m");
        assert!(apart < 5e-10, "{rule}: {apart} m apart");
    }
}
