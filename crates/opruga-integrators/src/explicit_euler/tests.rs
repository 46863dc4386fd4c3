//! Tests that the order is 1, that the energy grows without damping, and that free fall obeys its
//! recurrence.

use super::ExplicitEuler;
use crate::testing;

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&ExplicitEuler, &ExplicitEuler);
}
#[test]
fn order_is_one() {
    testing::check_order(&ExplicitEuler, &ExplicitEuler, 1.0);
}
#[test]
fn free_fall_is_too_slow() {
    testing::check_free_fall(&ExplicitEuler, |n| 0.5 * n * (n - 1.0));
}
#[test]
fn no_step_is_stable_without_damping() {
    testing::check_no_stable_step(&ExplicitEuler, |z| (1.0 + z * z).sqrt());
}
