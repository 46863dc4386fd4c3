//! Tests that the order is 2 and that stability has no limit. Also tests steps of varying length, and free fall.

use super::{Bdf2, SPEC};
use crate::implicit::step::Implicit;
use crate::testing;
use opruga_core::integrator::Integrator;
use opruga_core::spec::Values;
use opruga_core::system::System;

fn rule() -> Implicit<Bdf2> {
    Implicit::new(SPEC.kind, Bdf2::default(), &Values::defaults(&SPEC, 2)).unwrap()
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

/// The first step is one of backward Euler, −g h². The velocity is exact from the first step on. The error of the first step
/// decays as (1/3)ⁿ, so the position ends up at a constant distance from −½ g t²: it is −g h² (n²/2 + 3/4 (1 − 3⁻ⁿ)).
#[test]
fn free_fall_is_that_of_its_recurrence() {
    testing::check_free_fall(&rule(), |n| {
        let mut heights = (0.0, 1.0);
        for step in 2..=n as u32 {
            let next = (4.0 * heights.1 - heights.0) / 3.0 + 2.0 / 3.0 * f64::from(step);
            heights = (heights.1, next);
        }
        heights.1
    });
}

/// Errors are of second order, even if every third step is twice as long.
#[test]
fn the_order_stays_where_steps_change() {
    let run = |steps: usize| {
        let mut system: System<2> = testing::two_nodes(0.3);
        system.equip(&rule());
        let h = 1.0 / steps as f64;
        for step in 0..steps / 4 * 3 {
            rule().step(&mut system, if step % 3 == 2 { 2.0 * h } else { h }).unwrap();
        }
        testing::state(&system)
    };
    let far = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let ends: Vec<Vec<f64>> = [80, 160, 320, 640].map(run).into();
    let order = libm::log2(far(&ends[1], &ends[2]) / far(&ends[2], &ends[3]));
    assert!((order - 2.0).abs() < 0.25, "{order}");
}

/// The amplitude loses the fraction (hω)⁴/4 in a step, compared with (hω)²/2 for backward Euler.
#[test]
fn slow_motion_is_hardly_damped() {
    for z in [0.05, 0.1] {
        let radius = <Implicit<Bdf2> as Integrator<2>>::amplification(&rule(), 1.0, 0.0, z).spectral_radius();
        let expected = z * z * z * z / 4.0;
        assert!(((1.0 - radius) / expected - 1.0).abs() < 0.05, "{z}: {radius}");
    }
}

#[test]
fn linear_momentum_is_kept() {
    let [linear, _] = testing::drift_of_momentum(&rule(), 0.02, 200);
    assert!(linear < 1e-12, "{linear}");
}
