//! Tests that the order is 2 and that stability has no limit, that high frequencies are damped as specified, and that free fall
//! is exact.

use super::{Newmark, SPEC};
use crate::implicit::step::Implicit;
use crate::testing;
use opruga_core::integrator::Integrator;
use opruga_core::spec::{Value, Values};
use opruga_core::stability::Spectrum;

fn rule(spectral_radius: Option<f64>) -> Implicit<Newmark> {
    let mut values = Values::defaults(&SPEC, 2);
    if let Some(rho) = spectral_radius {
        values.set(&SPEC, "spectral_radius", Value::Number(rho), 2).unwrap();
    }
    Implicit::new(SPEC.kind, Newmark::new(&values), &values).unwrap()
}

const ALL: [Option<f64>; 5] = [None, Some(0.0), Some(0.5), Some(0.8), Some(1.0)];

#[test]
fn amplification_is_one_step() {
    for rho in ALL {
        testing::check_amplification(&rule(rho), &rule(rho));
    }
}
#[test]
fn order_is_two() {
    for rho in ALL {
        testing::check_order(&rule(rho), &rule(rho), 2.0);
    }
}
#[test]
fn there_is_no_limit() {
    for rho in [None, Some(0.3), Some(0.8), Some(1.0)] {
        testing::check_no_limit(&rule(rho));
    }
}
#[test]
fn free_fall_is_exact() {
    for rho in ALL {
        testing::check_free_fall(&rule(rho), |n| 0.5 * n * n);
    }
}

/// The largest eigenvalue at hω → ∞ is the specified one (Chung and Hulbert 1993). For average acceleration it is 1 everywhere.
#[test]
fn the_spectral_radius_is_the_one_that_was_asked_for() {
    for rho in [0.0, 0.3, 0.8, 1.0] {
        let radius = Integrator::<2>::amplification(&rule(Some(rho)), 1.0, 0.0, 1e7).spectral_radius();
        // Three eigenvalues coincide at hω → ∞, so a perturbation ε moves them by its cube root.
        assert!((radius - rho).abs() < 2e-4, "{rho}: {radius}");
    }
    for z in [0.1, 1.0, 10.0, 1e4] {
        let radius = Integrator::<2>::amplification(&rule(None), 1.0, 0.0, z).spectral_radius();
        assert!((radius - 1.0).abs() < 1e-12, "{z}: {radius}");
        let radius = Integrator::<2>::amplification(&rule(Some(1.0)), 1.0, 0.0, z).spectral_radius();
        assert!((radius - 1.0).abs() < 1e-12, "{z}: {radius}");
    }
}

/// The rule that conserves every oscillation has no limit and lets no oscillation grow, whether damped or not. Rounding does
/// not count as growth.
#[test]
fn a_radius_of_one_lets_nothing_grow() {
    for rho in [0.0, 0.5, 0.9, 0.99, 0.999, 1.0] {
        for (omega, damping) in [(80.0, 0.0), (3.0e4, 0.0), (1.7, 0.0), (80.0, 12.0), (0.0, 5.0)] {
            let spectrum = Spectrum::uniform(omega, damping);
            let rule: &dyn Integrator<2> = &rule(Some(rho));
            assert_eq!(spectrum.largest_stable_step(rule), Some(f64::INFINITY), "{rho} {omega} {damping}");
        }
    }
    for h in [1e-4, 1e-2, 0.1] {
        let rule: &dyn Integrator<2> = &rule(Some(1.0));
        assert_eq!(Spectrum::uniform(80.0, 0.0).growth_per_second(rule, h), 0.0, "{h}");
    }
}
