//! Tests that the order is 2 and that stability has no limit, that momentum and the energy of linear systems are conserved,
//! and that free fall is exact.

use super::{ImplicitMidpoint, SPEC};
use crate::implicit::step::Implicit;
use crate::testing;
use opruga_core::spec::Values;

fn rule() -> Implicit<ImplicitMidpoint> {
    Implicit::new(SPEC.kind, ImplicitMidpoint(crate::implicit::theta::Theta::MIDDLE), &Values::defaults(&SPEC, 2))
        .unwrap()
}

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&rule(), &rule());
}
#[test]
fn order_is_two() {
    testing::check_order(&rule(), &rule(), 2.0);
}
#[test]
fn there_is_no_limit() {
    testing::check_no_limit(&rule());
}
#[test]
fn free_fall_is_exact() {
    testing::check_free_fall(&rule(), |n| 0.5 * n * n);
}
#[test]
fn energy_of_a_nonlinear_spring_stays_bounded() {
    testing::check_bounded_energy(&rule(), 2.0);
}

/// With converged Newton iterations, angular momentum is conserved to 1e-10 (validation B4), even with damping.
#[test]
fn momentum_is_kept() {
    for h in [0.01, 0.1] {
        let [linear, angular] = testing::drift_of_momentum(&rule(), h, 500);
        assert!(linear < 1e-12 && angular < 1e-10, "{h}: {linear:e} {angular:e}");
    }
}

#[test]
fn amplitudes_stay_at_any_step() {
    for z in [0.1, 1.0, 10.0, 1e3] {
        let omega = 5.0;
        let mut system = testing::oscillator::<2>(2.0, 2.0 * omega * omega, 0.0, 1.0, 0.0);
        testing::run(&mut system, &rule(), z / omega, 1000);
        let (x, v) = (system.state.x.at(0)[0], system.state.v.at(0)[0]);
        assert!(((x * x + v * v / (omega * omega)).sqrt() - 1.0).abs() < 1e-10, "{z}");
    }
}
