//! The contract of every integrator. It applies obstacles once per step and with the positions before the step, moves pins, keeps
//! the ledger and the clock, and gives the same bits with any vector instructions.

use super::{oscillator, problems, run, state, two_nodes};
use crate::explicit_euler::ExplicitEuler;
use crate::heun::Heun;
use crate::runge_kutta::RungeKutta;
use crate::symplectic_euler::SymplecticEuler;
use crate::verlet::Verlet;
use opruga_core::contacts::{Contacts, Moved};
use opruga_core::integrator::Integrator;
use opruga_core::spec::Values;
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::{Pin, System};
use opruga_math::Simd;
use std::sync::{Arc, Mutex};

/// Integrators that pass the end of their steps to obstacles.
const EXPLICIT: [&dyn Integrator<2>; 5] = [&ExplicitEuler, &SymplecticEuler, &Heun, &Verlet, &RungeKutta];

/// Every integrator of motion in time, with its order.
fn rules() -> Vec<(Box<dyn Integrator<2>>, f64)> {
    let orders = |kind: &str| match kind {
        "explicit_euler" | "symplectic_euler" | "backward_euler" => Some(1.0),
        "runge_kutta" => Some(4.0),
        "equilibrium" => None,
        _ => Some(2.0),
    };
    let kinds = crate::all::<2>();
    let rules = kinds.iter().filter_map(|kind| {
        let order = orders(kind.spec().kind)?;
        Some((kind.build(&Values::defaults(kind.spec(), 2)).unwrap(), order))
    });
    rules.collect()
}

#[test]
fn every_kind_is_registered_once() {
    let names: Vec<_> = crate::all::<2>().iter().map(|kind| kind.spec().kind).collect();
    assert_eq!(
        names,
        [
            "symplectic_euler",
            "explicit_euler",
            "heun",
            "verlet",
            "runge_kutta",
            "backward_euler",
            "bdf2",
            "implicit_midpoint",
            "newmark",
            "equilibrium"
        ]
    );
    for kind in crate::all::<3>() {
        let built = kind.build(&Values::defaults(kind.spec(), 3)).unwrap();
        assert_eq!(built.name(), kind.spec().kind);
    }
}

/// Records the positions and the time that an integrator passes to obstacles.
#[derive(Debug, Default)]
struct Witness(Mutex<Vec<(f64, f64, f64)>>);

impl Contacts<2> for Witness {
    fn resolve(&self, _simd: Simd, moved: &mut Moved<2>) -> u8 {
        self.0.lock().unwrap().push((moved.before[0][0], moved.x.0[0][0], moved.time));
        0
    }
}

#[test]
fn obstacles_act_once_between_the_start_and_the_end_of_a_step() {
    for rule in EXPLICIT {
        let witness = Arc::new(Witness::default());
        let mut system = two_nodes::<2>(0.5);
        system.contacts = Some(witness.clone());
        system.equip(rule);
        let mut positions = vec![system.state.x.0[0][0]];
        for _ in 0..5 {
            rule.step(&mut system, 0.01).unwrap();
            positions.push(system.state.x.0[0][0]);
        }
        let seen = witness.0.lock().unwrap();
        assert_eq!(seen.len(), 5, "{}", rule.name());
        for (n, (before, after, time)) in seen.iter().enumerate() {
            assert_eq!((*before, *after), (positions[n], positions[n + 1]), "{}", rule.name());
            assert!((time - 0.01 * (n + 1) as f64).abs() < 1e-15);
        }
    }
}

#[test]
fn held_axes_follow_their_path() {
    for (rule, _) in &rules() {
        let rule = &**rule;
        let mut system = two_nodes::<2>(0.5);
        // The first node moves along x at 2 m/s from (1, 0) and is free along y. The second node is pinned along y.
        let motion = Arc::new(vec![vec![0.0, 0.0, 0.0], vec![10.0, 20.0, 0.0]]);
        system.pins.push(Pin { index: 0, axes: [true, false], anchor: [1.0, 0.0], motion });
        system.pins.push(Pin { index: 1, axes: [false, true], anchor: [0.0, 0.25], motion: Arc::default() });
        run(&mut system, rule, 0.01, 100);
        let (x, v) = (&system.state.x.0, &system.state.v.0);
        assert!((x[0][0] - 3.0).abs() < 1e-12 && (v[0][0] - 2.0).abs() < 1e-12, "{}", rule.name());
        assert_eq!((x[1][1], v[1][1]), (0.25, 0.0), "{}", rule.name());
        assert!(v[1][0] != 0.0 && v[0][1] != 0.0, "{}", rule.name());
    }
}

/// The sum of the damping account and the energy is constant except for the error of the integrator, which falls at the order of
/// the integrator.
#[test]
fn the_ledger_closes_at_the_order_of_the_rule() {
    for (rule, order) in &rules() {
        let (rule, order) = (&**rule, *order);
        let gap = |steps: usize| {
            let mut system = two_nodes::<2>(0.8);
            let before = problems::energy_of_two_nodes(&system);
            run(&mut system, rule, 1.0 / steps as f64, steps);
            let damped: f64 = system.work.damping.iter().sum();
            assert!(damped > 0.01, "{}", rule.name());
            (problems::energy_of_two_nodes(&system) + damped - before).abs()
        };
        // The order is measured over four halvings, because errors of opposite sign may cancel in a single halving.
        let observed = libm::log2(gap(50) / gap(800)) / 4.0;
        assert!(observed >= order - 0.2, "{}: {observed}", rule.name());
    }
}

/// A node is moved along a straight path. The work of the pin is in the ledger, which closes at the order of the integrator.
#[test]
fn the_work_of_pins_is_in_the_ledger() {
    for (rule, order) in &rules() {
        let (rule, order) = (&**rule, *order);
        let gap = |steps: usize| {
            let mut system = two_nodes::<2>(0.8);
            system.gravity = [0.3, -2.0];
            let (start, speed) = (system.state.x.at(0), [2.0, -0.5]);
            let motion = Arc::new(vec![vec![0.0, 0.0, 0.0], vec![10.0, 10.0 * speed[0], 10.0 * speed[1]]]);
            // A node that is listed twice is pinned once.
            system.pins.push(Pin { index: 0, axes: [true, true], anchor: start, motion: Arc::clone(&motion) });
            system.pins.push(Pin { index: 0, axes: [true, false], anchor: start, motion });
            system.state.v.set(0, speed);
            let total = |system: &System<2>| {
                let weight = |node: usize| {
                    let x = system.state.x.at(node);
                    system.mass.at(node) * (0.3 * x[0] - 2.0 * x[1])
                };
                problems::energy_of_two_nodes(system) - weight(0) - weight(1)
            };
            let before = total(&system);
            run(&mut system, rule, 1.0 / steps as f64, steps);
            let (damped, given): (f64, f64) = (system.work.damping.iter().sum(), system.work.user.iter().sum());
            assert!(damped > 0.01 && given.abs() > 0.5, "{}: {damped} {given}", rule.name());
            (total(&system) + damped - given - before).abs()
        };
        let observed = libm::log2(gap(200) / gap(1600)) / 3.0;
        assert!(observed >= order - 0.2, "{}: {observed}", rule.name());
    }
}

/// The bits are the same for one body and for eight, and for any vector instructions.
#[test]
fn bits_depend_neither_on_instructions_nor_on_the_layout() {
    for (rule, _) in &rules() {
        let rule = &**rule;
        let run_with = |simd: Simd| {
            let mut system = two_nodes::<2>(0.3);
            system.simd = simd;
            system.gravity = [0.1, -9.81];
            run(&mut system, rule, 0.01, 200);
            state(&system).iter().map(|n| n.to_bits()).collect::<Vec<_>>()
        };
        let expected = run_with(Simd::Baseline);
        for simd in [Simd::Avx2, Simd::Avx512] {
            assert_eq!(run_with(simd), expected, "{} {simd:?}", rule.name());
        }

        // Implicit integrators process one body at a time.
        if rule.needs().hessian {
            continue;
        }
        let mut alone = oscillator::<2>(0.7, 20.0, 0.4, 1.0, -0.5);
        run(&mut alone, rule, 0.01, 200);
        let (mut x, mut v) = (Columns::zeros(8), Columns::zeros(8));
        for body in 0..8 {
            x.set(body, [1.0, 2.0]);
            v.set(body, [-0.5, -1.0]);
        }
        let mut batch = System::new(Simd::best(), Layout::Batch, 1, 8, x, v, Parameter::uniform(0.7));
        batch.add(Box::new(problems::Anchors { stiffness: 20.0, damping: 0.4 }));
        run(&mut batch, rule, 0.01, 200);
        for body in 0..8 {
            assert_eq!(batch.state.x.at(body).map(f64::to_bits), alone.state.x.at(0).map(f64::to_bits));
            assert_eq!(batch.state.v.at(body).map(f64::to_bits), alone.state.v.at(0).map(f64::to_bits));
        }
    }
}
