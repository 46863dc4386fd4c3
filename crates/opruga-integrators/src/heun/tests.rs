//! Tests that the order is 2, that the energy grows slowly without damping, and that free fall is
//! exact.

use super::Heun;
use crate::testing;

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&Heun, &Heun);
}
#[test]
fn order_is_two() {
    testing::check_order(&Heun, &Heun, 2.0);
}
#[test]
fn free_fall_is_exact() {
    testing::check_free_fall(&Heun, |n| 0.5 * n * n);
}
#[test]
fn no_step_is_stable_without_damping() {
    testing::check_no_stable_step(&Heun, |z| (1.0 + 0.25 * z * z * z * z).sqrt());
}
