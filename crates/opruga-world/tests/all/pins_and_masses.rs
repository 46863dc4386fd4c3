//! The effect of pins on the motion of neighbouring nodes, with consistent and lumped masses, and the forces of the pins.
//!
//! Every body here is a bar of one square cell, 1 m and 2 kg, with a stiffness of 1 N/m between its ends. The bar has one coordinate u_f at the free
//! end and one u_p at the pinned end, each for two nodes. With consistent masses M_ff = M_pp = 2/3 kg and M_fp = 1/3 kg, so ω² = 3/2 for the free
//! end; with lumped ones 1 kg, 1 kg and 0, so ω² = 1.

#![allow(clippy::disallowed_methods)] // expected values of the tests' own

use crate::common;

use common::{solid, text};
use opruga_core::spec::{Value, Values};
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};

/// Every implicit integrator of motion: its kind and its spectral radius.
const RULES: [(&str, Option<f64>); 6] = [
    ("backward_euler", None),
    ("bdf2", None),
    ("implicit_midpoint", None),
    ("newmark", None),
    ("newmark", Some(0.5)),
    ("newmark", Some(0.0)),
];

/// The mass of the free end, and the coupling mass between the ends [kg].
fn masses(mass: &str) -> (f64, f64) {
    if mass == "consistent" { (2.0 / 3.0, 1.0 / 3.0) } else { (1.0, 0.0) }
}

/// The bar with its left end pinned along the axis and all nodes pinned across it, in steps of `h`.
fn bar((rule, radius): (&str, Option<f64>), mass: &str, damping: f64, h: f64) -> Blueprint<2> {
    let mesh = Mesh::<2>::grid([0.0; 2], [1.0; 2], [1, 1]).unwrap();
    let spec = Registry::<2>::default().integrator(rule).unwrap().spec();
    let iterates = Values::defaults(spec, 2).number("tolerance").is_some();
    let mut fields = Vec::new();
    fields.extend(iterates.then_some(("tolerance", Value::Number(1e-13))));
    fields.extend(radius.map(|radius| ("spectral_radius", Value::Number(radius))));
    let material = [
        ("material", text("linear")),
        ("youngs_modulus", Value::Number(1.0)),
        ("poissons_ratio", Value::Number(0.0)),
        ("damping", Value::Number(damping)),
        ("mass", text(mass)),
    ];
    let mut blueprint = solid(mesh, rule, &fields, &material);
    blueprint.bodies[0].mass = Mass::Density(2.0);
    blueprint.time = Time { seconds: 1e3, frame: h, substeps: 1 };
    blueprint.bodies[0].pins = vec![PinBlueprint { select: Selector::All, axes: [false, true], motion: Vec::new() }];
    blueprint
}

fn left() -> Selector<2> {
    Selector::Side("left".into())
}

fn hold(blueprint: &mut Blueprint<2>, motion: Vec<Vec<f64>>) {
    blueprint.bodies[0].pins.push(PinBlueprint { select: left(), axes: [true, false], motion });
}

/// Displacements of the pinned and of the free end.
fn ends(world: &World<2>) -> [f64; 2] {
    [world.position(0, 0)[0], world.position(0, 1)[0] - 1.0]
}

fn mechanical(world: &World<2>) -> f64 {
    world.energy().kinetic + world.energy().elastic
}

/// The largest stretch of the bar until a given time, and its largest energy.
fn swing(world: &mut World<2>, until: f64) -> (f64, f64) {
    let (mut stretch, mut most) = (0.0f64, 0.0f64);
    while world.time() < until {
        world.frame().unwrap();
        let [held, free] = ends(world);
        stretch = stretch.max((free - held).abs());
        most = most.max(mechanical(world));
    }
    (stretch, most)
}

/// A bar that flies at 1 m/s and whose end is pinned from the first step. The impulse acts only on the pinned nodes, so the free row of M Δv is zero:
/// v_f = 1 + M_fp/M_ff = 3/2 with consistent masses, 1 with lumped ones, and the amplitude is v_f/ω. The energy is then ½ M_ff v_f², which is 3/4 J
/// and 1/2 J of the initial 1 J.
fn swings_as_one_that_is_caught(world: &mut World<2>, rule: (&str, Option<f64>), mass: &str) {
    let (own, between) = masses(mass);
    let (speed, omega) = (1.0 + between / own, 1.0 / f64::sqrt(own));
    let (amplitude, most) = swing(world, world.time() + 2.0);
    let wanted = speed / omega;
    assert!((amplitude / wanted - 1.0).abs() < 4e-3, "{rule:?}, {mass}: {amplitude}, not {wanted}");
    let energy = 0.5 * own * speed * speed;
    assert!(most < 1.001 * energy, "{rule:?}, {mass}: {most} J of {energy} J");
    // Integrators without dissipation conserve it.
    if matches!(rule, ("implicit_midpoint", _) | ("newmark", None)) {
        let end = mechanical(world);
        assert!((end / energy - 1.0).abs() < 1e-3, "{rule:?}, {mass}: {end} J of {energy} J");
    }
}

#[test]
fn every_rule_gives_a_bar_that_is_pinned_in_flight_the_same_motion_and_never_more_energy() {
    for rule in RULES {
        for mass in ["lumped", "consistent"] {
            let mut pinned = bar(rule, mass, 0.0, 2e-3);
            pinned.bodies[0].velocity = [1.0, 0.0];
            hold(&mut pinned, Vec::new());
            let mut world = World::new(pinned, Options::default()).unwrap();
            assert!((mechanical(&world) - 1.0).abs() < 1e-12);
            swings_as_one_that_is_caught(&mut world, rule, mass);
        }
    }
}

#[test]
fn every_rule_gives_a_bar_that_a_command_catches_the_same_motion_and_never_more_energy() {
    for rule in RULES {
        for mass in ["lumped", "consistent"] {
            let mut flying = bar(rule, mass, 0.0, 2e-3);
            flying.bodies[0].velocity = [1.0, 0.0];
            let catch = Action::Pin { body: 0, select: left(), axes: [true, false] };
            flying.commands = vec![CommandBlueprint { at: 0.1, until: 1e3, action: catch }];
            let mut world = World::new(flying, Options::default()).unwrap();
            while world.time() < 0.1 - 1e-9 {
                world.frame().unwrap();
            }
            let [held, free] = ends(&world);
            assert!((held - 0.1).abs() < 1e-9 && (free - 0.1).abs() < 1e-9, "{held} {free}");
            swings_as_one_that_is_caught(&mut world, rule, mass);
        }
    }
}

/// A base that suddenly moves at 1/2 m/s, at the beginning of a step or within it. The free end is thrown back at M_fp/M_ff of that speed. It
/// oscillates about the base with an amplitude of the sum of both speeds over ω.
#[test]
fn every_rule_gives_a_bar_whose_base_sets_off_at_once_the_same_motion() {
    for rule in RULES {
        for mass in ["lumped", "consistent"] {
            for start in [0.1, 0.1007] {
                let mut pulled = bar(rule, mass, 0.0, 2e-3);
                hold(&mut pulled, vec![vec![start, 0.0, 0.0], vec![start + 100.0, 50.0, 0.0]]);
                let mut world = World::new(pulled, Options::default()).unwrap();
                let (amplitude, _) = swing(&mut world, 2.1);
                let (own, between) = masses(mass);
                let wanted = 0.5 * (1.0 + between / own) * own.sqrt();
                assert!(
                    (amplitude / wanted - 1.0).abs() < 5e-3,
                    "{rule:?}, {mass}, {start}: {amplitude}, not {wanted}"
                );
                let energy = world.energy();
                // Integrators without dissipation lose nothing: the ledger contains the impulse of the pin and its work within steps.
                if matches!(rule, ("implicit_midpoint", _) | ("newmark", None)) && mass == "consistent" {
                    assert!(energy.loss_integrator.abs() < 1e-6, "{rule:?}, {mass}: {energy:?}");
                }
            }
        }
    }
}

/// A base that accelerates at a = 0.1 m/s², as a table with a row for every step. At rest in its frame the bar lags by (M_ff + M_fp) a/k = 0.1 m with
/// either kind of masses, and the pin accelerates 2 kg with 0.2 N. Its work counts as work of the user.
#[test]
fn every_rule_lets_a_bar_hang_back_behind_its_accelerated_base_by_its_mass_and_tells_the_force_on_the_base() {
    hangs_back(&[0.02]);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn every_rule_lets_a_bar_hang_back_behind_its_accelerated_base_by_its_mass_and_tells_the_force_on_the_base_whole_sweep()
{
    hangs_back(&[0.005]);
}

fn hangs_back(steps: &[f64]) {
    let explicit = [("symplectic_euler", None), ("verlet", None)];
    for rule in RULES.into_iter().chain(explicit) {
        // The tolerance falls with the step, so that the shorter step reveals a constant error.
        for (mass, h) in steps.iter().flat_map(|h| [("lumped", *h), ("consistent", *h)]) {
            if mass == "consistent" && explicit.contains(&rule) {
                continue;
            }
            let (a, damping, until) = (0.1, 1.0, 40.0);
            let rows = (0..(until / h) as u32 + 2).map(|k| {
                let t = f64::from(k) * h;
                vec![t, 0.5 * a * t * t, 0.0]
            });
            let mut drawn = bar(rule, mass, damping, h);
            hold(&mut drawn, rows.collect());
            let mut world = World::new(drawn, Options::default()).unwrap();
            let mut given = 0.0;
            while world.time() < until - 1e-9 {
                let before = ends(&world)[0];
                world.frame().unwrap();
                given += world.reaction(0, &[0, 2])[0] * (ends(&world)[0] - before);
            }
            let [held, free] = ends(&world);
            // The velocity of the base jumps once in every step, so within a step the velocities at its ends differ by up to a h, which acts on the
            // damper: a first-order error in the step.
            let ahead = damping * a * h;
            assert!((free - held + a).abs() < ahead + 1e-4, "{rule:?}, {mass}: {}", free - held);
            let force = world.reaction(0, &[0, 2])[0];
            assert!((force - 2.0 * a).abs() < ahead + 1e-4, "{rule:?}, {mass}: {force}");
            let work = world.energy().work_user;
            assert!(
                (given / work - 1.0).abs() < 2e-3 + ahead / (2.0 * a),
                "{rule:?}, {mass}: {given} J by the force, {work} J in the ledger"
            );
            // ½ · 2 kg · (4 m/s)² plus the energy of the stretch.
            assert!((work / 16.0 - 1.0).abs() < 5e-3 + ahead / (2.0 * a), "{rule:?}, {mass}: {work}");
        }
    }
}

/// A clamped bar at rest under a weight that acts suddenly, g = 0.1 m/s² along it: u = g (M_ff + M_fp) (1 − cos ωt)/k. The clamp supplies the change
/// of momentum beyond the weight of 2 kg, R = (M_ff + M_fp) u″ − 2 g.
#[test]
fn the_force_on_a_clamp_and_the_weight_change_the_momentum() {
    for mass in ["lumped", "consistent"] {
        let mut hung = bar(("newmark", None), mass, 0.0, 5e-3);
        hung.surroundings.gravity = [0.1, 0.0];
        hold(&mut hung, Vec::new());
        let mut world = World::new(hung, Options::default()).unwrap();
        let omega = 1.0 / f64::sqrt(masses(mass).0);
        for _ in 0..400 {
            world.frame().unwrap();
            let wanted = 0.1 * omega * omega * f64::cos(omega * world.time()) - 0.2;
            let force = world.reaction(0, &[0, 2])[0];
            assert!((force - wanted).abs() < 1e-5, "{mass}, {} s: {force} N, not {wanted} N", world.time());
        }
    }
}

/// In statics nothing accelerates: a moving pin supports only the weight and tension of the bar.
#[test]
fn in_statics_a_moving_pin_bears_the_forces_alone() {
    let mut led = bar(("equilibrium", None), "consistent", 0.0, 0.1);
    led.surroundings.gravity = [0.1, 0.0];
    hold(&mut led, vec![vec![0.0, 0.0, 0.0], vec![0.3, 0.5, 0.0]]);
    let mut world = World::new(led, Options::default()).unwrap();
    for _ in 0..5 {
        world.frame().unwrap();
        let force = world.reaction(0, &[0, 2])[0];
        assert!((force + 0.2).abs() < 1e-9, "{force}");
    }
}
