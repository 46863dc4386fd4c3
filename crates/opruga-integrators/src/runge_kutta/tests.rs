//! Tests that the order is 4, that the limit is 2√2, and that free fall is exact.

use super::RungeKutta;
use crate::testing;

#[test]
fn amplification_is_one_step() {
    testing::check_amplification(&RungeKutta, &RungeKutta);
}
#[test]
fn order_is_four() {
    testing::check_order(&RungeKutta, &RungeKutta, 4.0);
}
#[test]
fn free_fall_is_exact() {
    testing::check_free_fall(&RungeKutta, |n| 0.5 * n * n);
}
#[test]
fn limit_without_damping() {
    testing::check_limit(&RungeKutta, 8.0f64.sqrt());
}
