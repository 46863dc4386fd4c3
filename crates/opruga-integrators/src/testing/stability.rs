//! Compares estimated limits with closed-form spectra and with the onset of instability in runs.

use super::problems::{Anchors, Springs};
use crate::explicit_euler::ExplicitEuler;
use crate::heun::Heun;
use crate::runge_kutta::RungeKutta;
use crate::symplectic_euler::SymplecticEuler;
use crate::verlet::Verlet;
use opruga_core::integrator::Integrator;
use opruga_core::stability::{Spectrum, Stability, estimate};
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::System;
use opruga_math::Simd;

/// A ring of radius `radius` whose springs have rest lengths of `rest` times the edges, and a gas inside.
fn ring(nodes: usize, radius: f64, rest: f64, stiffness: f64, damping: f64, gas: f64) -> System<2> {
    let (mut x, v) =
        (Columns::zeros(Layout::Single.index_count(nodes)), Columns::zeros(Layout::Single.index_count(nodes)));
    for p in 0..nodes {
        let angle = 2.0 * core::f64::consts::PI * p as f64 / nodes as f64;
        x.set(p, [radius * libm::cos(angle), radius * libm::sin(angle)]);
    }
    let edge = 2.0 * radius * libm::sin(core::f64::consts::PI / nodes as f64);
    let pairs = (0..nodes).map(|p| [p, (p + 1) % nodes]).collect();
    let mut system = System::new(Simd::best(), Layout::Single, nodes, 1, x, v, Parameter::uniform(1.0));
    system.add(Box::new(Springs { pairs, stiffness, damping, rest_length: rest * edge, gas }));
    system.plan(0);
    system
}

fn estimated(system: &System<2>, integrator: &dyn Integrator<2>) -> Stability {
    estimate(system, integrator).unwrap()
}

/// Whether small disturbances of an equilibrium grow. Disturbances that do not grow stay within the linear range.
fn grows(mut system: System<2>, integrator: &dyn Integrator<2>, h: f64, steps: usize) -> bool {
    system.plan(integrator.work_columns());
    let at_rest = system.state.x.clone();
    let size = 1e-7 * at_rest.0[0][0];
    for d in 0..2 {
        for p in 0..system.nodes {
            system.state.x.0[d][p] += size * (((p * 7919 + d * 104_729) % 101) as f64 / 50.0 - 1.0);
        }
    }
    for _ in 0..steps {
        integrator.step(&mut system, h).unwrap();
    }
    let far = |d: usize, p: usize| (system.state.x.0[d][p] - at_rest.0[d][p]).abs();
    !(0..system.nodes).all(|p| (0..2).all(|d| far(d, p) < 1000.0 * size))
}

/// The largest h without growth within `steps` steps, by bisection.
fn onset(make: &dyn Fn() -> System<2>, integrator: &dyn Integrator<2>, guess: f64, steps: usize) -> f64 {
    let (mut low, mut high) = (0.5 * guess, 2.0 * guess);
    assert!(!grows(make(), integrator, low, steps) && grows(make(), integrator, high, steps));
    for _ in 0..12 {
        let middle = 0.5 * (low + high);
        if grows(make(), integrator, middle, steps) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// A ring of an even number of springs at rest, in which neighbours move in opposite directions: ω² = 4k/m at most. On a circle,
/// the alternating motion along the edges stretches each by 2 cos(π/N).
#[test]
fn rings_have_the_frequency_of_their_closed_form() {
    for nodes in [4, 6, 36, 300, 1024, 4096] {
        let system = ring(nodes, 1.0, 1.0, 1600.0, 40.0, 0.0);
        let stability = estimated(&system, &SymplecticEuler);
        // Springs are stretched alternately, and all nodes move along the radius or along the edge, whichever is faster.
        let (sin, cos) =
            (libm::sin(core::f64::consts::PI / nodes as f64), libm::cos(core::f64::consts::PI / nodes as f64));
        let omega = 80.0 * if sin > cos { sin } else { cos };
        assert!(
            stability.spectrum.omega >= 0.999_999 * omega && stability.spectrum.omega <= 1.005 * omega,
            "{nodes}: {stability:?} {omega}"
        );
        let c = 40.0 * 4.0 * (omega / 80.0) * (omega / 80.0);
        assert!(
            stability.spectrum.damping >= 0.999_999 * c && stability.spectrum.damping <= 1.005 * c,
            "{nodes}: {stability:?} {c}"
        );
        assert_eq!(stability.spectrum.least_damping, 0.0);
    }
}

/// The springs of the thesis: k = 1600 N/m, c = 40 N·s/m, m = 1 kg; (2/ω)(√(1 + ζ²) − ζ) = 0.01036 s instead of 0.025 s.
#[test]
fn the_step_of_the_thesis_ball() {
    let make = || ring(36, 100.0, 1.0, 1600.0, 40.0, 0.0);
    let limit = estimated(&make(), &SymplecticEuler).largest_stable_step.unwrap();
    assert!((0.0098..0.01036).contains(&limit), "{limit}");
    let undamped = estimated(&ring(36, 100.0, 1.0, 1600.0, 0.0, 0.0), &SymplecticEuler).largest_stable_step.unwrap();
    assert!((0.0242..0.0251).contains(&undamped), "{undamped}");
}

/// Estimates are below the true onset, but by no more than a tenth, with and without damping, with and without gas.
#[test]
fn estimates_lie_just_below_the_onset() {
    let rules: [&dyn Integrator<2>; 3] = [&SymplecticEuler, &Verlet, &RungeKutta];
    for (damping, gas) in [(0.0, 0.0), (40.0, 0.0), (4.0, 0.0), (0.0, 2e6), (40.0, 2e6), (0.0, 5e7)] {
        // Equilibrium of tension and pressure: k (l − l₀) = 2 nRT/(N l).
        let edge = 2.0 * 100.0 * libm::sin(core::f64::consts::PI / 36.0);
        let rest = 1.0 - 2.0 * gas / (36.0 * 1600.0 * edge * edge);
        let make = || ring(36, 100.0, rest, 1600.0, damping, gas);
        for rule in rules {
            let limit = estimated(&make(), rule).largest_stable_step.unwrap();
            let onset = onset(&make, rule, limit, 3000);
            assert!(
                limit <= onset && limit >= 0.9 * onset,
                "{} c = {damping}, nRT = {gas}: {limit} {onset}",
                rule.name()
            );
        }
    }
}

/// If modes may be undamped, explicit Euler and Heun have no stable step. With drag on every node they have a stable step.
#[test]
fn rules_that_need_damping_of_every_mode() {
    let rules: [&dyn Integrator<2>; 2] = [&ExplicitEuler, &Heun];
    for rule in rules {
        assert_eq!(estimated(&ring(36, 100.0, 1.0, 1600.0, 0.0, 0.0), rule).largest_stable_step, None);
        let stability = estimated(&ring(36, 100.0, 0.9, 1600.0, 40.0, 0.0), rule);
        assert_eq!(stability.largest_stable_step, None);
        assert!(stability.spectrum.growth_per_second(rule, 0.001) > 0.0);
        let make = || {
            let mut system = ring(36, 100.0, 1.0, 1600.0, 0.0, 0.0);
            system.add(Box::new(Anchors { stiffness: 0.0, damping: 5.0 }));
            system
        };
        let limit = estimated(&make(), rule).largest_stable_step.unwrap();
        // The limit follows from the fastest mode alone: ω = 80 cos(π/36), c = 5.
        let fastest = 80.0 * libm::cos(core::f64::consts::PI / 36.0);
        let exact = Spectrum::uniform(fastest, 5.0).largest_stable_step(rule).unwrap();
        assert!(limit <= exact && limit >= 0.9 * exact, "{}: {limit} {exact}", rule.name());
        assert!(!grows(make(), rule, limit, 20_000) && grows(make(), rule, 1.2 * exact, 20_000));
    }
}

/// If drag is weak compared with the damping of springs, the step is still stable for every mode.
#[test]
fn a_weak_drag_beside_damped_springs_gives_a_stable_step() {
    let rules: [&dyn Integrator<2>; 2] = [&ExplicitEuler, &Heun];
    for rule in rules {
        for drag in [0.5, 1.5, 5.0] {
            // Springs under tension do not damp motions across them.
            let make = || {
                let mut system = ring(36, 100.0, 0.9, 1600.0, 40.0, 0.0);
                system.add(Box::new(Anchors { stiffness: 0.0, damping: drag }));
                system
            };
            let limit = estimated(&make(), rule).largest_stable_step;
            assert!(limit.is_some_and(|h| h > 1e-4), "{}, {drag} 1/s: {limit:?}", rule.name());
        }
    }
}

/// Stiffness-proportional damping, c = γ k: explicit Euler is stable up to γ, where |1 + hμ|² = 1 − hc + h²ω² reaches 1 in every
/// mode, and up to 2/|μ| of the most strongly damped mode. Rounding must not hide these limits.
#[test]
fn damping_in_proportion_to_stiffness_gives_explicit_euler_a_stable_step() {
    for (nodes, damping) in [(6, 1.0), (36, 1.0), (36, 8.0), (300, 4.0)] {
        let limit = estimated(&ring(nodes, 1.0, 1.0, 1600.0, damping, 0.0), &ExplicitEuler).largest_stable_step;
        let gamma = damping / 1600.0;
        assert!(limit.is_some_and(|h| h <= gamma && h > 0.95 * gamma), "{nodes}, {damping}: {limit:?}");
    }
}

/// The growth of the whole system per second matches the estimate (within its safety margin).
#[test]
fn growth_is_as_fast_as_announced() {
    let h = 0.001;
    let mut system = ring(36, 100.0, 1.0, 1600.0, 0.0, 0.0);
    let announced =
        estimated(&system, &ExplicitEuler).spectrum.growth_per_second(&ExplicitEuler as &dyn Integrator<2>, h);
    // The initial motion contains only the alternating mode.
    for p in 0..36 {
        let (x, sign) = (system.state.x.at(p), if p % 2 == 0 { 1e-9 } else { -1e-9 });
        system.state.v.set(p, [-x[1] * sign, x[0] * sign]);
    }
    let speed = |s: &System<2>| s.state.v.0.iter().flatten().map(|v| v * v).sum::<f64>().sqrt();
    // ω = 79.7 rad/s: 2 ωh π = 1 is never met exactly, so the mean over whole periods is taken from energies.
    let energy = |s: &System<2>, rest: &Columns<2>| {
        let far: f64 = (0..2)
            .flat_map(|d| (0..36).map(move |p| (d, p)))
            .map(|(d, p)| s.state.x.0[d][p] - rest.0[d][p])
            .map(|u| u * u)
            .sum();
        (speed(s) * speed(s) + far * 6400.0 * libm::pow(libm::cos(core::f64::consts::PI / 36.0), 2.0)).sqrt()
    };
    let rest = system.state.x.clone();
    let before = energy(&system, &rest);
    for _ in 0..1000 {
        ExplicitEuler.step(&mut system, h).unwrap();
    }
    let measured = libm::log(energy(&system, &rest) / before) / 1.0;
    assert!(measured <= announced && measured > 0.9 * announced, "{measured} {announced}");
}
