//! Tests that the order is 1, that the limit is 2, that the energy is bounded, and that free fall
//! obeys its recurrence.

use super::SymplecticEuler;
use crate::testing;

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&SymplecticEuler, &SymplecticEuler);
}
#[test]
fn order_is_one() {
    testing::check_order(&SymplecticEuler, &SymplecticEuler, 1.0);
}
#[test]
fn free_fall_is_too_fast() {
    testing::check_free_fall(&SymplecticEuler, |n| 0.5 * n * (n + 1.0));
}
#[test]
fn limit_without_damping_is_two() {
    testing::check_limit(&SymplecticEuler, 2.0);
}
#[test]
fn energy_stays_bounded() {
    testing::check_bounded_energy(&SymplecticEuler, 1.0);
}
