//! Tests that the order is 1 and that stability has no limit. Also tests the amplitude of an oscillation, and free fall.

use super::{BackwardEuler, SPEC};
use crate::implicit::step::Implicit;
use crate::testing;
use opruga_core::spec::Values;

fn rule() -> Implicit<BackwardEuler> {
    Implicit::new(SPEC.kind, BackwardEuler, &Values::defaults(&SPEC, 2)).unwrap()
}

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&rule(), &rule());
}
#[test]
fn order_is_one() {
    testing::check_order(&rule(), &rule(), 1.0);
}
#[test]
fn there_is_no_limit() {
    testing::check_no_limit(&rule());
}
#[test]
fn free_fall_is_that_of_its_recurrence() {
    testing::check_free_fall(&rule(), |n| 0.5 * n * (n + 1.0));
}

/// A step multiplies the amplitude by 1/√(1 + h²ω²), which is .995037, .707107, .099504 at hω = .1, 1, 10 (validation B4).
#[allow(clippy::approx_constant)] // the figures of the source as they stand there
#[test]
fn the_amplitude_falls_as_in_its_closed_form() {
    for (z, expected) in [(0.1, 0.995_037), (1.0, core::f64::consts::FRAC_1_SQRT_2), (10.0, 0.099_504)] {
        let (omega, steps) = (5.0, 20);
        let mut system = testing::oscillator::<2>(2.0, 2.0 * omega * omega, 0.0, 1.0, 0.0);
        testing::run(&mut system, &rule(), z / omega, steps);
        let (x, v) = (system.state.x.at(0)[0], system.state.v.at(0)[0]);
        let amplitude = (x * x + v * v / (omega * omega)).sqrt();
        let factor = libm::pow(amplitude, 1.0 / steps as f64);
        assert!((factor - 1.0 / (1.0 + z * z).sqrt()).abs() < 1e-13, "{z}: {factor}");
        assert!((factor - expected).abs() < 1e-6, "{z}: {factor}");
    }
}

/// Springs pull along their axes at the end of the step, so linear momentum is conserved. Angular momentum falls by O(h), as
/// the amplitude of an oscillation does.
#[test]
fn linear_momentum_is_kept() {
    let [linear, coarse] = testing::drift_of_momentum(&rule(), 0.02, 200);
    assert!(linear < 1e-13, "{linear}");
    let [_, fine] = testing::drift_of_momentum(&rule(), 0.01, 400);
    assert!(coarse > 1e-3 && fine < 0.7 * coarse, "{coarse} {fine}");
}
