//! Common code of the tests of all integrators: small problems with closed forms, and measurements on them.

mod contract;
mod minimisers;
mod own_losses;
pub(crate) mod problems;
mod real_time;
mod stability;

pub(crate) use problems::{oscillator, two_nodes};

use opruga_core::history::Content;
use opruga_core::integrator::Integrator;
use opruga_core::stability::Spectrum;
use opruga_core::state::{Columns, Layout, Parameter};
use opruga_core::system::System;
use opruga_math::Simd;

/// Positions and velocities of the real nodes, one number after the other.
pub(crate) fn state<const D: usize>(system: &System<D>) -> Vec<f64> {
    let nodes = 0..system.nodes;
    let x = nodes.clone().flat_map(|p| system.state.x.at(p));
    let v = nodes.flat_map(|p| system.state.v.at(p));
    x.chain(v).collect()
}

/// Makes a number of steps of length h.
pub(crate) fn run<const D: usize>(system: &mut System<D>, integrator: &dyn Integrator<D>, h: f64, steps: usize) {
    system.equip(integrator);
    for _ in 0..steps {
        integrator.step(system, h).unwrap();
    }
}

/// The vectors that a history stores for the first node.
fn vectors<const D: usize>(system: &System<D>) -> Vec<[f64; D]> {
    let of = |(_, content): (_, &Content<D>)| match content {
        Content::Vectors(vectors) => Some(vectors.at(0)),
        _ => None,
    };
    system.history.channels().filter_map(of).collect()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Compares `amplification` with one computed step from (1, 0) and (0, 1), in all coordinates.
fn matrix_of_one_step<const D: usize>(integrator: &dyn Integrator<D>) {
    for (omega, c, h) in
        [(1.0, 0.0, 0.1), (3.0, 0.5, 0.2), (80.0, 160.0, 0.004), (0.0, 2.0, 0.3), (7.0, 30.0, 0.05), (50.0, 1.0, 0.1)]
    {
        let m = integrator.amplification(omega, c, h);
        let mass = 2.5;
        for column in 0..m.size() {
            let one = |row: usize| if row == column { 1.0 } else { 0.0 };
            let mut system = oscillator::<D>(mass, mass * omega * omega, mass * c, one(0), one(1));
            system.equip(integrator);
            // Integrators with a history make this step in the middle of a run.
            let mut row = 2;
            for (_, content) in system.history.channels_mut() {
                match content {
                    Content::Vectors(vectors) => {
                        vectors.set(0, core::array::from_fn(|d| one(row) * (d + 1) as f64));
                        row += 1;
                    }
                    Content::Number(number) => *number = h,
                    Content::Flag(flag) => *flag = true,
                    Content::Count(_) => {}
                }
            }
            run(&mut system, integrator, h, 1);
            let history = vectors(&system);
            let after = [vec![system.state.x.at(0), system.state.v.at(0)], history].concat();
            assert_eq!(after.len(), m.size());
            let scale = 1e-12 * (1.0 + (0..m.size()).map(|row| m[row][column].abs()).sum::<f64>());
            for (row, vector) in after.iter().enumerate() {
                for d in 0..D {
                    // Coordinate d starts with d + 1 times the amplitude.
                    let value = vector[d] / (d + 1) as f64;
                    assert!((value - m[row][column]).abs() <= scale, "{omega} {c} {h}: {value} {row} {column} {m:?}");
                }
            }
        }
    }
}

/// Compares `amplification` with computed steps, in the plane and in space.
pub(crate) fn check_amplification(plane: &dyn Integrator<2>, space: &dyn Integrator<3>) {
    matrix_of_one_step(plane);
    matrix_of_one_step(space);
}

/// The observed orders on x″ = −ω²x − c x′ (closed form) with a step that is halved four times.
fn orders_of_oscillator<const D: usize>(integrator: &dyn Integrator<D>, c: f64) -> Vec<f64> {
    let (omega, end): (f64, f64) = (3.0, 1.3);
    let fast = (omega * omega - 0.25 * c * c).sqrt();
    // x(t) = e^(−ct/2) (cos ft + (v₀ + c/2)/f sin ft) from x₀ = 1, v₀ = 2.
    let b = (2.0 + 0.5 * c) / fast;
    let (cos, sin, decay) = (libm::cos(fast * end), libm::sin(fast * end), libm::exp(-0.5 * c * end));
    let x = decay * (cos + b * sin);
    let v = decay * (b * fast * cos - fast * sin) - 0.5 * c * x;
    let errors: Vec<f64> = [40, 80, 160, 320]
        .map(|steps| {
            let mut system = oscillator::<D>(0.7, 0.7 * omega * omega, 0.7 * c, 1.0, 2.0);
            run(&mut system, integrator, end / steps as f64, steps);
            distance(&[system.state.x.at(0)[0], system.state.v.at(0)[0]], &[x, v])
        })
        .into();
    errors.windows(2).map(|e| libm::log2(e[0] / e[1])).collect()
}

/// The observed orders on a spinning, stretched spring between two nodes, from the differences of successive halvings.
fn orders_of_spring<const D: usize>(integrator: &dyn Integrator<D>, damping: f64) -> Vec<f64> {
    let ends: Vec<Vec<f64>> = [50, 100, 200, 400, 800]
        .map(|steps| {
            let mut system = two_nodes::<D>(damping);
            run(&mut system, integrator, 1.0 / steps as f64, steps);
            state(&system)
        })
        .into();
    let gaps: Vec<f64> = ends.windows(2).map(|e| distance(&e[0], &e[1])).collect();
    gaps.windows(2).map(|g| libm::log2(g[0] / g[1])).collect()
}

/// Checks that the observed order is at least `theory − 0.2`, three times in a row, on linear and nonlinear problems, with and
/// without damping, in the plane and in space.
pub(crate) fn check_order(plane: &dyn Integrator<2>, space: &dyn Integrator<3>, theory: f64) {
    let rows = [
        ("oscillator", orders_of_oscillator(plane, 0.0)),
        ("damped oscillator", orders_of_oscillator(plane, 1.5)),
        ("damped oscillator, space", orders_of_oscillator(space, 1.5)),
        ("spring", orders_of_spring(plane, 0.0)),
        ("damped spring", orders_of_spring(plane, 0.8)),
        ("damped spring, space", orders_of_spring(space, 0.8)),
    ];
    for (problem, orders) in rows {
        assert!(orders.len() >= 3);
        assert!(orders.iter().all(|p| *p >= theory - 0.2), "{problem}: {orders:?}, theory {theory}");
        // The integrator must not be accidentally better than documented.
        assert!(orders.iter().all(|p| *p <= theory + 0.6), "{problem}: {orders:?}, theory {theory}");
    }
}

/// Height and velocity after n steps of free fall: `factor(n)` times −g h², and −n g h.
pub(crate) fn check_free_fall(integrator: &dyn Integrator<3>, factor: fn(f64) -> f64) {
    let (g, h) = (9.81, 0.01);
    let mut x = Columns::zeros(16);
    (0..11).for_each(|p| x.set(p, [p as f64, 0.0, 2.0]));
    let mut system = System::new(Simd::best(), Layout::Single, 11, 1, x, Columns::zeros(16), Parameter::uniform(0.3));
    system.gravity = [0.0, -g, 0.0];
    for n in 1..=1000 {
        run(&mut system, integrator, h, 1);
        for p in [0, 10] {
            let (x, v) = (system.state.x.at(p), system.state.v.at(p));
            let y = -g * h * h * factor(f64::from(n));
            assert!((x[1] - y).abs() <= 1e-12 * (1.0 + y.abs()), "{n}: {} {y}", x[1]);
            assert!((v[1] + g * h * f64::from(n)).abs() <= 1e-12 * g * h * f64::from(n));
            assert_eq!([x[0], x[2], v[0], v[2]], [p as f64, 2.0, 0.0, 0.0]);
        }
    }
    assert!((system.time - 10.0).abs() < 1e-9);
}

/// Checks stability for every step size, however large, with and without damping.
pub(crate) fn check_no_limit(integrator: &dyn Integrator<2>) {
    for (omega, damping) in [
        (5.0, 0.0),
        (5.0, 3.0),
        (1e4, 1e2),
        (0.0, 4.0),
        (137.0, 0.05),
        (3.7e3, 8.1),
        (20.3, 0.02),
        (71.0, 0.0),
        (94.817, 8.99026),
    ] {
        assert_eq!(Spectrum::uniform(omega, damping).largest_stable_step(integrator), Some(f64::INFINITY));
    }
    for z in [1e-3, 0.1, 1.0, 10.0, 1e3, 1e6] {
        let radius = integrator.amplification(5.0, 0.0, z / 5.0).spectral_radius();
        assert!(radius <= 1.0 + 4e-15, "hω = {z}: {radius}");
        let mut system = oscillator::<2>(1.0, 25.0, 0.0, 1.0, 0.0);
        run(&mut system, integrator, z / 5.0, 500);
        assert!(system.state.x.at(0)[0].abs() <= 1.0 + 1e-9, "hω = {z}: {:?}", system.state.x.at(0));
    }
}

/// The drift of linear and angular momentum of a damped, spinning, drifting pair after many steps, relative to the largest term.
pub(crate) fn drift_of_momentum(integrator: &dyn Integrator<2>, h: f64, steps: usize) -> [f64; 2] {
    let mut system = two_nodes::<2>(0.4);
    let momenta = |system: &System<2>| {
        let mut out = [0.0; 3];
        for p in 0..2 {
            let (m, x, v) = (system.mass.at(p), system.state.x.at(p), system.state.v.at(p));
            out[0] += m * v[0];
            out[1] += m * v[1];
            out[2] += m * (x[0] * v[1] - x[1] * v[0]);
        }
        out
    };
    let before = momenta(&system);
    run(&mut system, integrator, h, steps);
    let after = momenta(&system);
    [((after[0] - before[0]).abs() + (after[1] - before[1]).abs()) / 3.0, (after[2] - before[2]).abs() / 3.0]
}

/// Checks the undamped stability limit hω: amplitudes stay bounded just below it and explode just above it.
pub(crate) fn check_limit(integrator: &dyn Integrator<2>, limit: f64) {
    let omega = 5.0;
    let largest = |factor: f64| {
        let mut system = oscillator::<2>(1.0, omega * omega, 0.0, 1.0, 0.0);
        run(&mut system, integrator, factor * limit / omega, 20_000);
        system.state.x.at(0)[0].abs()
    };
    let (below, above) = (largest(0.999), largest(1.001));
    assert!(below < 100.0 && (above > 1e6 || above.is_nan()), "{below} {above}");
    let estimate = Spectrum::uniform(omega, 0.0).largest_stable_step(integrator).unwrap();
    assert!((estimate * omega - limit).abs() < 1e-4 * limit, "{estimate}");
}

/// Checks that without damping the amplitude grows in every step, at the rate `growth(hω)` per step.
pub(crate) fn check_no_stable_step(integrator: &dyn Integrator<2>, growth: fn(f64) -> f64) {
    let omega = 5.0;
    assert_eq!(Spectrum::uniform(omega, 0.0).largest_stable_step(integrator), None);
    for z in [0.05, 0.1, 0.4, 1.0] {
        let radius = integrator.amplification(omega, 0.0, z / omega).spectral_radius();
        assert!((radius - growth(z)).abs() < 1e-14 && radius > 1.0, "{z}: {radius}");
        let mut system = oscillator::<2>(1.0, omega * omega, 0.0, 1.0, 0.0);
        let energy = |s: &System<2>| {
            s.state.x.at(0)[0] * s.state.x.at(0)[0] * omega * omega + s.state.v.at(0)[0] * s.state.v.at(0)[0]
        };
        let before = energy(&system);
        run(&mut system, integrator, z / omega, 100);
        let measured = libm::pow(energy(&system) / before, 1.0 / 200.0);
        assert!((measured - growth(z)).abs() < 1e-12 * growth(z), "{z}: {measured}");
    }
}

/// Checks that the energy of an undamped nonlinear spring stays within a bound for a long time. The bound shrinks with h to the
/// power `order`.
pub(crate) fn check_bounded_energy(integrator: &dyn Integrator<2>, order: f64) {
    let mut bounds = Vec::new();
    for steps_per_second in [100.0, 200.0] {
        let mut system = two_nodes::<2>(0.0);
        system.equip(integrator);
        let start = problems::energy_of_two_nodes(&system);
        let mut early = 0.0f64;
        let mut late = 0.0f64;
        for n in 0..200_000 {
            integrator.step(&mut system, 1.0 / steps_per_second).unwrap();
            let drift = (problems::energy_of_two_nodes(&system) - start).abs() / start;
            let worst = if n < 20_000 { &mut early } else { &mut late };
            *worst = if drift > *worst { drift } else { *worst };
        }
        // No drift: the error in the last nine tenths equals that in the first tenth.
        assert!(late < 1.05 * early, "{early} {late}");
        bounds.push(late);
    }
    let observed = libm::log2(bounds[0] / bounds[1]);
    assert!((observed - order).abs() < 0.2, "{observed}");
}
