//! Tests with hanging bars, a truss that snaps, and bodies that nothing holds.

use super::{COMPLETE, Equilibrium, LOAD, SPEC};
use crate::testing::problems::{Anchors, Springs};
use opruga_core::error::StepError;
use opruga_core::integrator::Integrator;
use opruga_core::spec::{Value, Values};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::{Pin, System};
use opruga_math::Simd;
use std::sync::Arc;

fn rule(fields: &[(&str, Value)]) -> Equilibrium {
    let mut values = Values::defaults(&SPEC, 2);
    for (name, value) in fields {
        values.set(&SPEC, name, value.clone(), 2).unwrap();
    }
    Equilibrium::new(&values)
}

/// Nodes joined by springs.
fn body<const D: usize>(positions: &[[f64; D]], pairs: Vec<[usize; 2]>, stiffness: f64, mass: Vec<f64>) -> System<D> {
    let (mut x, v) = (Columns::zeros(8), Columns::zeros(8));
    for column in &mut x.0 {
        column.grow(Layout::Single.index_count(positions.len()) + 8);
    }
    let mut speeds = v;
    for column in &mut speeds.0 {
        column.grow(Layout::Single.index_count(positions.len()) + 8);
    }
    for (node, position) in positions.iter().enumerate() {
        x.set(node, *position);
    }
    let first: [f64; D] = core::array::from_fn(|d| positions[pairs[0][0]][d] - positions[pairs[0][1]][d]);
    let rest_length = first.iter().map(|c| c * c).sum::<f64>().sqrt();
    let mass = Parameter::column(mass);
    let mut system = System::new(Simd::best(), Layout::Single, positions.len(), 1, x, speeds, mass);
    system.add(Box::new(Springs { pairs, stiffness, damping: 0.0, rest_length, gas: 0.0 }));
    system
}

fn pin<const D: usize>(system: &mut System<D>, node: usize, axes: [bool; D]) {
    let anchor = system.state.x.at(node);
    system.pins.push(Pin { index: node, axes, anchor, motion: Arc::default() });
}

/// ρ = 1000, L = 1, E = 125 000, g = 9.81: the end sinks by ρgL²/2E = .03924 m (validation B1). The formula holds for any
/// number of springs with half the mass at the ends, and with every solver.
#[test]
fn a_hanging_bar_has_the_length_of_its_closed_form() {
    for (nodes, solver) in [(2, "conjugate_gradients"), (11, "conjugate_gradients"), (41, "cholesky")] {
        let springs = nodes - 1;
        let positions: Vec<[f64; 2]> = (0..nodes).map(|k| [0.0, -(k as f64) / springs as f64]).collect();
        let part = 1000.0 / springs as f64;
        let mass = (0..nodes).map(|k| if k == 0 || k == springs { 0.5 * part } else { part }).collect();
        let pairs = (0..springs).map(|k| [k, k + 1]).collect();
        let mut system = body(&positions, pairs, 125_000.0 * springs as f64, mass);
        system.gravity = [0.0, -9.81];
        pin(&mut system, 0, [true, true]);
        let rule = rule(&[("linear_solver", Value::Text(solver.into()))]);
        system.equip(&rule);
        Integrator::<2>::check(&rule, &system, false).unwrap();
        rule.step(&mut system, 1.0).unwrap();
        let sunk = -1.0 - system.state.x.at(springs)[1];
        assert!((sunk - 0.039_24).abs() < 1e-12, "{nodes} nodes: {sunk}");
        assert!(system.state.v.0.iter().flatten().all(|v| *v == 0.0));
        // The springs store half of the energy that the weight releases. The other half is external work, because nothing
        // damps.
        let (damped, work): (f64, f64) = (system.work.damping.iter().sum(), system.work.user.iter().sum());
        let stored = system.stored_energy(opruga_core::system::Stage::Current, 0.0);
        assert!(damped == 0.0 && work < 0.0, "{damped} {work}");
        let lifted: f64 = (0..nodes).map(|k| system.mass.at(k) * 9.81 * positions[k][1]).sum();
        assert!((work - (stored - lifted)).abs() < 1e-9 * stored.abs(), "{work} {stored} {lifted}");
    }
}

/// Two springs of length 1, whose apex at a height of 0.2 m is pressed down by λ m g. The load falls after its limit and rises
/// again later. Every point of the curve satisfies the closed form 2 k (1 − l)(y/l) = −λ m g.
#[test]
fn a_truss_is_followed_through_its_snap() {
    let (height, k, weight) = (0.2, 1000.0, 30.0);
    let half = (1.0f64 - height * height).sqrt();
    let truss = || {
        let mut system = body(&[[-half, 0.0], [0.0, height], [half, 0.0]], vec![[0, 1], [1, 2]], k, vec![1.0; 3]);
        system.gravity = [0.0, -weight];
        pin(&mut system, 0, [true, true]);
        pin(&mut system, 2, [true, true]);
        pin(&mut system, 1, [true, false]);
        system
    };
    let needed = |y: f64| {
        let length = (half * half + y * y).sqrt();
        2.0 * k * (1.0 - length) * (y / length) / weight
    };
    let arc = rule(&[("arc_length", Value::Number(0.01))]);
    let mut system = truss();
    system.equip(&arc);
    let (mut highest, mut lowest, mut steps) = (0.0f64, f64::INFINITY, 0);
    while !system.history.get(COMPLETE) {
        arc.step(&mut system, 0.1).unwrap();
        let (load, y) = (system.history.get(LOAD), system.state.x.at(1)[1]);
        assert!((needed(y) - load).abs() < 1e-7, "{y}: {load}, not {}", needed(y));
        highest = if load > highest && load < 1.0 && y > 0.0 { load } else { highest };
        lowest = if load < lowest { load } else { lowest };
        steps += 1;
        assert!(steps < 100);
    }
    // The limits are at about y = ±0.2/√3 and are ±0.1048 of the load.
    assert!((highest - 0.1048).abs() < 1e-3 && (lowest + 0.1048).abs() < 1e-3, "{highest} {lowest}");
    let behind = system.state.x.at(1)[1];
    assert!(behind < -height && (needed(behind) - 1.0).abs() < 1e-9, "{behind}");
    // The body stays at this equilibrium.
    arc.step(&mut system, 0.1).unwrap();
    assert!((system.state.x.at(1)[1] - behind).abs() < 1e-9);

    // With the whole load at once it jumps to the same position.
    let mut jumped = truss();
    let plain = rule(&[]);
    jumped.equip(&plain);
    plain.step(&mut jumped, 0.1).unwrap();
    assert!((jumped.state.x.at(1)[1] - behind).abs() < 1e-8, "{}", jumped.state.x.at(1)[1]);
}

#[test]
fn a_body_that_nothing_holds_is_refused_with_the_names_of_its_rigid_modes() {
    let message = |pins: &[(usize, [bool; 2])]| {
        let mut system = body(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![[0, 1], [1, 2]], 10.0, vec![1.0; 3]);
        pins.iter().for_each(|(node, axes)| pin(&mut system, *node, *axes));
        system.equip(&rule(&[]));
        let outcome = Integrator::<2>::check(&rule(&[]), &system, false);
        assert!(Integrator::<2>::check(&rule(&[]), &system, true).is_ok());
        outcome.map_err(|error| {
            assert_eq!(error.code(), "static.rigid_modes");
            error.about.to_string().split(';').next().unwrap_or_default().to_string()
        })
    };
    let refusal = |text: &str| Err(format!("nothing prevents {text}"));
    assert_eq!(message(&[]), refusal("translation along x, translation along y, rotation: 3 rigid modes"));
    assert_eq!(message(&[(0, [false, true])]), refusal("translation along x, rotation: 2 rigid modes"));
    assert_eq!(message(&[(0, [true, true])]), refusal("rotation: 1 rigid mode"));
    assert_eq!(message(&[(0, [true, true]), (1, [true, false])]), refusal("rotation: 1 rigid mode"));
    assert_eq!(message(&[(0, [true, true]), (1, [false, true])]), Ok(()));
    // The weight holds a pendulum, unless it hangs at its centre of mass.
    let pendulum = |shift: f64| {
        let positions = [[0.0, 0.0], [1.0, 0.0], [shift - 1.0, 0.0]];
        let mut system = body(&positions, vec![[0, 1], [0, 2]], 10.0, vec![1.0; 3]);
        system.gravity = [0.0, -9.81];
        pin(&mut system, 0, [true, true]);
        system.equip(&rule(&[]));
        Integrator::<2>::check(&rule(&[]), &system, false)
    };
    assert_eq!(pendulum(0.1), Ok(()));
    assert!(pendulum(0.0).unwrap_err().about.to_string().contains("rotation: 1 rigid mode"));
    // The body is pinned along x only, at nodes of different heights.
    assert_eq!(message(&[(0, [true, false]), (2, [true, false])]), refusal("translation along y: 1 rigid mode"));

    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut system = body(&corners, vec![[0, 1], [1, 2], [2, 3]], 10.0, vec![1.0; 4]);
    let error = Integrator::<3>::check(&rule(&[]), &system, false).unwrap_err();
    assert!(
        error.about.to_string().contains("6 rigid modes") && error.about.to_string().contains("about an axis along z"),
        "{error}"
    );
    pin(&mut system, 0, [true, true, true]);
    pin(&mut system, 1, [true, true, true]);
    system.equip(&rule(&[]));
    let error = Integrator::<3>::check(&rule(&[]), &system, false).unwrap_err();
    assert!(error.about.to_string().contains("rotation about an axis along x: 1 rigid mode"), "{error}");
}

#[test]
fn a_balance_that_is_not_found_leaves_the_state_as_it_was() {
    let mut system = body(&[[0.0, 0.0], [0.0, -1.0]], vec![[0, 1]], 10.0, vec![1.0, 5.0]);
    system.gravity = [0.0, -9.81];
    pin(&mut system, 0, [true, true]);
    system.state.v.set(1, [3.0, 0.0]);
    let rule = rule(&[("iterations", Value::Integer(1))]);
    system.equip(&rule);
    let (x, v) = (system.state.x.clone(), system.state.v.clone());
    let error = rule.step(&mut system, 0.5).unwrap_err().to_string();
    assert!(
        error.starts_with("`equilibrium` did not converge in 1 iteration at t = 0 s: the forces are out"),
        "{error}"
    );
    assert_eq!((&system.state.x, &system.state.v), (&x, &v));
}

#[test]
fn what_is_out_of_balance_is_reported_for_nodes_pinned_along_some_axes_too() {
    let mut system = body(&[[0.0, 0.0], [0.0, -1.0]], vec![[0, 1]], 10.0, vec![1.0, 5.0]);
    system.gravity = [300.0, -9.81];
    pin(&mut system, 0, [true, true]);
    pin(&mut system, 1, [true, false]);
    let rule = rule(&[("iterations", Value::Integer(1))]);
    system.equip(&rule);
    let StepError::NotConverged { residual, .. } = rule.step(&mut system, 0.5).unwrap_err() else {
        panic!("another error")
    };
    // The spring shares the displacement of the pinned axis, so a residual remains along the free axis only.
    assert!(residual > 1.0 && residual < 5.0 * 9.81, "{residual}");
}

/// A custom model that ties nodes to space holds a body, even if the ledger does not count it among the loads. Forces between
/// nodes do not hold a body.
#[test]
fn models_that_tie_nodes_to_space_hold_a_body_by_what_they_do() {
    let rule = rule(&[]);
    let triangle = || {
        body(&[[0.0, 0.0], [1.0, 0.0], [0.5, 0.866_025_403_784_438_6]], vec![[0, 1], [1, 2], [2, 0]], 1e6, vec![1.0; 3])
    };
    let mut free = triangle();
    free.equip(&rule);
    let refused = Integrator::<2>::check(&rule, &free, false).unwrap_err();
    assert_eq!(refused.code(), "static.rigid_modes");
    let mut tied = triangle();
    tied.gravity = [0.0, -9.81];
    tied.add(Box::new(Anchors { stiffness: 100.0, damping: 0.0 }));
    tied.equip(&rule);
    Integrator::<2>::check(&rule, &tied, false).unwrap();
    rule.step(&mut tied, 1.0).unwrap();
    // Three springs to the origin carry the weight of three nodes, which determines their mean position.
    let mean = (0..3).map(|node| tied.state.x.at(node)[1]).sum::<f64>() / 3.0;
    assert!((mean + 9.81 / 100.0).abs() < 1e-9, "{mean}");
}
