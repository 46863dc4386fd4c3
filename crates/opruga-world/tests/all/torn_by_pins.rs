//! Pins whose displacement in one step would overstretch the neighbouring cells, if only these had to follow, still move the body.

#![allow(clippy::disallowed_methods, reason = "shapes, and no bits")]

use crate::common;

use common::{solid, text};
use opruga_core::spec::Value;
use opruga_math::message::Message as _;
use opruga_mesh::Mesh;
use opruga_world::blueprint::{Blueprint, PinBlueprint, Selector, Time};
use opruga_world::{Options, World};

const STIFFNESS: f64 = 1e5;

/// A plate of 2 by 1 m whose right side pins stretch along x to `to` lengths in `steps` steps of 1 s; it contracts freely in the lateral directions.
fn drawn(order: u32, rule: &str, material: &str, ratio: f64, to: f64, steps: u32) -> Blueprint<2> {
    drawn_by(order, (rule, &[]), material, ratio, to, steps)
}

/// The same with an integrator that has parameters of its own.
fn drawn_by(
    order: u32,
    (rule, of_rule): (&str, &[(&str, Value)]),
    material: &str,
    ratio: f64,
    to: f64,
    steps: u32,
) -> Blueprint<2> {
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
    let mut out = solid(mesh, rule, of_rule, &fields);
    out.time = Time { seconds: 1e3, frame: 1.0, substeps: 1 };
    let seconds = f64::from(steps);
    let side = |side: &str, motion| PinBlueprint { select: Selector::Side(side.into()), axes: [true, false], motion };
    let motion = vec![vec![0.0; 3], vec![seconds, 2.0 * (to - 1.0), 0.0]];
    let corner = PinBlueprint { select: Selector::Nodes(vec![0]), axes: [true; 2], motion: Vec::new() };
    out.bodies[0].pins = vec![side("left", Vec::new()), side("right", motion), corner];
    out
}

/// The force along x with which pins pull the right side [N].
fn tension(world: &mut World<2>) -> f64 {
    let forces = world.node_forces(0, None);
    let at = &world.blueprint().bodies[0].mesh.positions;
    at.iter().zip(forces).filter(|(x, _)| x[0] == 2.0).map(|(_, force)| -force[0]).sum()
}

/// Uniaxial stress of the St. Venant–Kirchhoff law at the stretch λ: S₁₁ = E (λ² − 1)/2 and E₂₂ = E₃₃ = −ν (λ² − 1)/2, so both other stretches are
/// √(1 − ν (λ² − 1)). The first row of cells alone, an eighth of the length, would exceed the largest stretch with a positive thickness, √(1 + 1/ν).
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

/// Beyond the largest stretch no plate has a positive thickness; the error names this, and the world stays at its last good frame.
#[test]
fn plates_without_a_thickness_are_refused_with_that_reason() {
    for order in [1, 2] {
        let mut world = World::new(drawn(order, "equilibrium", "st_venant_kirchhoff", 0.4, 2.5, 3), Options::default())
            .expect("a world");
        world.frame().expect("a stretch of 1.5");
        let before = tension(&mut world);
        let told = world.frame().expect_err("no stretch of 2.0").to_string();
        assert!(told.contains(" gives zero stress across the plane"), "{told}");
        assert_eq!(tension(&mut world), before);
    }
}

/// The same with integrators in time: long steps in which the first row of cells would have no thickness.
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

/// Ten iterations are too few for the whole displacement from a state with overstretched cells. The reported reason is the refusal of the model,
/// which does not occur for half of the displacement.
#[test]
fn a_way_that_a_model_refuses_is_gone_in_halves_where_that_is_asked_for() {
    let lead = |policy: &str| {
        let of_rule = [("iterations", Value::Integer(10)), ("when_not_converged", text(policy))];
        let rule = ("equilibrium", &of_rule[..]);
        let mut world =
            World::new(drawn_by(1, rule, "st_venant_kirchhoff", 0.4, 1.8, 1), Options::default()).expect("a world");
        (world.frame().map_err(|error| (error.code().to_string(), error.in_full())), world)
    };
    let (outcome, mut world) = lead("error");
    let (code, told) = outcome.expect_err("a refusal");
    assert!(code == "run.model" && told.contains("no positive thickness of cell"), "{code}: {told}");
    assert!(told.contains("hint: use `when_not_converged = \"halve\"`"), "{told}");
    assert_eq!((world.solver_work().halved, tension(&mut world)), (0, 0.0));
    let (outcome, mut world) = lead("halve");
    outcome.expect("half of the way, and the other half");
    assert_eq!((world.solver_work().halved, world.solver_work().deepest), (1, 1));
    let warnings = world.warnings();
    let halved = warnings.iter().find(|warning| warning.code == "step.halved").expect("a warning");
    assert!(halved.count == 1 && halved.message.contains("or a model is undefined in a state within it"), "{halved:?}");
    let (wanted, force) = (1.8 * STIFFNESS * 0.5 * (1.8 * 1.8 - 1.0), tension(&mut world));
    assert!((force / wanted - 1.0).abs() < 1e-9, "{force} N, {wanted} N");
}

/// A square with `count` cells per side that pins compress to the fraction `to` of its length in one step of statics.
fn pressed(count: u32, to: f64, ratio: f64, unfold: bool) -> World<2> {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [count; 2]).expect("a grid").into_simplices().expect("triangles");
    let fields = [
        ("material", text("st_venant_kirchhoff")),
        ("youngs_modulus", Value::Number(STIFFNESS)),
        ("poissons_ratio", Value::Number(ratio)),
        ("plane", text("stress")),
    ];
    let mut out = solid(mesh.into_quadratic().expect("quadratic triangles"), "equilibrium", &[], &fields);
    out.time = Time { seconds: 1e3, frame: 1.0, substeps: 1 };
    out.surroundings.unfold = unfold;
    let side = |side: &str, axes, motion| PinBlueprint { select: Selector::Side(side.into()), axes, motion };
    let motion = vec![vec![0.0; 3], vec![1.0, to - 1.0, 0.0]];
    out.bodies[0].pins = vec![
        side("left", [true, false], Vec::new()),
        side("bottom", [false, true], Vec::new()),
        side("right", [true, false], motion),
    ];
    let mut world = World::new(out, Options::default()).expect("a world");
    world.frame().expect("a balance");
    world
}

/// The four plates, with the energy of the closed form.
const PRESSED: [(u32, f64, f64); 4] = [(3, 0.7, 0.4), (3, 0.8, 0.3), (4, 0.7, 0.3), (4, 0.8, 0.4)];

fn closed_form(to: f64) -> f64 {
    let strain = 0.5 * (to * to - 1.0);
    0.5 * STIFFNESS * strain * strain
}

/// During compression to 0.7 or 0.8 of its length in one step, the law softens so much that the iteration passes through folded shapes. Either it
/// ends at the closed form, or in a folded equilibrium, which a warning reports together with the option that helps.
#[test]
fn plates_that_are_pressed_at_once_end_at_the_closed_form_or_are_reported_as_folded() {
    let mut folded = 0;
    for (count, to, ratio) in PRESSED {
        let world = pressed(count, to, ratio, false);
        let (found, warnings) = (world.energy().elastic, world.warnings_at_the_end());
        if (found / closed_form(to) - 1.0).abs() < 1e-9 {
            assert!(warnings.is_empty(), "{count} {to} {ratio}: {warnings:?}");
        } else {
            let named = warnings.iter().any(|w| w.code == "cells.inverted" && w.message.contains("unfold"));
            assert!(named, "{count} {to} {ratio}: {found} J, {warnings:?}");
            folded += 1;
        }
    }
    assert!(folded > 0, "no plate folds any more: the twin below shows nothing");
}

/// With `unfold`, statics repeats the frame in parts: all end at the closed form, and the intermediate fold is not reported.
#[test]
fn plates_that_are_pressed_at_once_and_may_unfold_end_at_the_closed_form() {
    for (count, to, ratio) in PRESSED {
        let world = pressed(count, to, ratio, true);
        let (found, wanted) = (world.energy().elastic, closed_form(to));
        assert!((found / wanted - 1.0).abs() < 1e-9, "{count} {to} {ratio}: {found} J, {wanted} J");
        assert!(world.warnings_at_the_end().is_empty(), "{count} {to} {ratio}: {:?}", world.warnings_at_the_end());
    }
}
