//! Tests that the order is 2 even with damping, that the limit is 2, that the energy is bounded,
//! and that free fall is exact.

use super::Verlet;
use crate::testing;

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&Verlet, &Verlet);
}
#[test]
fn order_is_two() {
    testing::check_order(&Verlet, &Verlet, 2.0);
}
#[test]
fn free_fall_is_exact() {
    testing::check_free_fall(&Verlet, |n| 0.5 * n * n);
}
#[test]
fn limit_without_damping_is_two() {
    testing::check_limit(&Verlet, 2.0);
}
#[test]
fn energy_stays_bounded() {
    testing::check_bounded_energy(&Verlet, 2.0);
}
