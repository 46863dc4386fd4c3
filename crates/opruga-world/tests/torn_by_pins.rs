//! Pins whose way in one step would tear the cells beside them, if these alone had to follow, lead the body all the same.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

mod common;

use common::{solid, text};
use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Blueprint, PinBlueprint, Selector, Time};
use opruga_world::{Options, World};

const STIFFNESS: f64 = 1e5;

/// A plate of 2 by 1 m whose right side pins draw along x to so many lengths in so many steps of 1 s; it thins freely.
fn drawn(order: u32, rule: &str, material: &str, ratio: f64, to: f64, steps: u32) -> Blueprint<2> {
    let mut mesh = Mesh::<2>::grid([0.0; 2], [2.0, 1.0], [8, 4]).expect("a grid").into_simplices().expect("triangles");
    if order == 2 {
        mesh = mesh.into_quadratic().expect("quadratic triangles");
    }
    let fields = [
        ("material", text(material)),
        ("youngs_modulus", Value::Number(STIFFNESS)),
        ("poissons_ratio", Value::Number(ratio)),
        ("plane", text("stress")),
    ];
    let mut out = solid(mesh, rule, &[], &fields);
    out.time = Time { seconds: 1e3, frame: 1.0, substeps: 1 };
    let seconds = f64::from(steps);
    let side = |side: &str, motion| PinBlueprint { select: Selector::Side(side.into()), axes: [true, false], motion };
    let motion = vec![vec![0.0; 3], vec![seconds, 2.0 * (to - 1.0), 0.0]];
    let corner = PinBlueprint { select: Selector::Nodes(vec![0]), axes: [true; 2], motion: Vec::new() };
    out.bodies[0].pins = vec![side("left", Vec::new()), side("right", motion), corner];
    out
}

/// The force along x by which pins draw the right side [N].
fn tension(world: &mut World<2>) -> f64 {
    let forces = world.node_forces(0, None);
    let at = &world.blueprint().bodies[0].mesh.positions;
    at.iter().zip(forces).filter(|(x, _)| x[0] == 2.0).map(|(_, force)| -force[0]).sum()
}

/// Uniaxial stress of St. Venant and Kirchhoff at the stretch λ: S₁₁ = E (λ² − 1)/2 and E₂₂ = E₃₃ = −ν (λ² − 1)/2, so each of both other
/// stretches is √(1 − ν (λ² − 1)). The first row of cells alone, an eighth of the length, would be drawn to more than the largest
/// stretch that has a thickness, √(1 + 1/ν).
#[test]
fn plates_that_thin_follow_pins_in_statics_at_the_closed_form() {
    for order in [1, 2] {
        for ratio in [0.3, 0.4] {
            for (to, steps) in [(1.5, 4), (1.5, 1), (1.8, 2)] {
                let name = format!("order {order}, ratio {ratio}, to {to} in {steps}");
                let blueprint = drawn(order, "equilibrium", "st_venant_kirchhoff", ratio, to, steps);
                let mut world = World::new(blueprint, Options::default()).expect("a world");
                for step in 1..=steps {
                    world.frame().unwrap_or_else(|error| panic!("{name}, step {step}: {error}"));
                    let stretch = 1.0 + (to - 1.0) * f64::from(step) / f64::from(steps);
                    let (strain, force) = (0.5 * (stretch * stretch - 1.0), tension(&mut world));
                    let wanted = stretch * STIFFNESS * strain;
                    assert!((force / wanted - 1.0).abs() < 1e-9, "{name}, step {step}: {force} N, {wanted} N");
                    let top = (0..world.node_count(0)).map(|k| world.position(0, k as u32)[1]).fold(0.0, f64::max);
                    let thinned = (1.0 - 2.0 * ratio * strain).sqrt();
                    assert!((top - thinned).abs() < 1e-9, "{name}, step {step}: {top} m, {thinned} m");
                }
            }
        }
    }
}

/// Beyond the largest stretch no plate has a thickness; what is told names that, and the world stays at its last good frame.
#[test]
fn plates_without_a_thickness_are_refused_with_that_reason() {
    for order in [1, 2] {
        let mut world = World::new(drawn(order, "equilibrium", "st_venant_kirchhoff", 0.4, 2.5, 3), Options::default())
            .expect("a world");
        world.frame().expect("a stretch of 1.5");
        let before = tension(&mut world);
        let told = world.frame().expect_err("no stretch of 2.0").to_string();
        assert!(told.contains("has no positive thickness without stress across the plane"), "{told}");
        assert_eq!(tension(&mut world), before);
    }
}

/// The same under rules that step through time: long steps in which the first row of cells would have no thickness.
#[test]
fn plates_that_thin_follow_pins_through_time() {
    for rule in ["backward_euler", "bdf2", "newmark", "implicit_midpoint"] {
        for order in [1, 2] {
            let mut blueprint = drawn(order, rule, "st_venant_kirchhoff", 0.4, 1.5, 2);
            blueprint.time.frame = 0.5;
            let mut world = World::new(blueprint, Options::default()).expect("a world");
            for frame in 0..4 {
                world.frame().unwrap_or_else(|error| panic!("{rule}, order {order}, frame {frame}: {error}"));
            }
            assert!(world.energy().elastic > 0.0 && world.energy().elastic.is_finite());
        }
    }
}
