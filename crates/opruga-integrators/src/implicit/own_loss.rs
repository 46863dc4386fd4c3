//! The energy that a rule itself dissipates in a step, from its own formula.
//!
//! In a step, every rule changes the momentum by M Δv = h i (F + r + R) + M m. F are the forces of the stage, r is the residual
//! of the iteration, R are the forces of obstacles that hold nodes, i is the share of the stage ([`Balance::impulse`]), and m
//! is the memory of the rule. The kinetic energy changes by exactly v̄·M Δv, with v̄ = ½ (v₀ + v₁). The rule is responsible for
//!
//! J = h i F + M m = M Δv − h i (r + R).
//!
//! With W, the work of loads and pins minus the work of damping, as recorded in the ledger, the rule dissipates
//!
//! L = W + U₀ − U₁ − v̄·J.
//!
//! The loss L may be negative, and it is exact for any U. If only forces with the potential U act, the loss L has the following
//! form, with g = ∇U.
//!
//! | rule | L |
//! |---|---|
//! | backward Euler | ½ Δv·M Δv + U₀ − U₁ + g₁·Δx |
//! | θ-method | U₀ − U₁ + g_s·Δx + (θ − ½) Δv·M Δv |
//! | BDF2 | ½ Δv·M Δv − ⅓ v₁·M Δ₋v − ⅓ g₁·Δ₋x + U₀ − U₁ + g₁·Δx |
//! | generalised-α | U₀ − U₁ + g_f·Δx + (1 − γ − α_m) Δx·M Δa + h² (β − γ/2) (½ Δ(a·M a) + (γ − ½) Δa·M Δa) |
//!
//! Δ goes from n to n + 1 and Δ₋ from n − 1 to n. The gradient g_f is g in the averaged state, which is (1 − α_f) g₁ + α_f g₀
//! if forces are linear. Tests compare the rules with these formulas. No channel of the ledger contains h i v̄·r, the work of
//! r, so this work remains unexplained. The contact code records the work of R.
//!
//! Pinned nodes do not count: the work of pins is recorded with the kinetic energy of these nodes.

use super::balance::Balance;
use super::workspace::Workspace;
use opruga_core::system::{System, Work8};
use opruga_math::WIDTH;

/// The work of loads and pins minus the work of damping, as recorded so far [J].
pub(super) fn given(work: &Work8) -> [f64; WIDTH] {
    core::array::from_fn(|lane| work.user[lane] - work.damping[lane])
}

/// Adds W, the work recorded since `before`.
pub(super) fn add_given(work: &mut Work8, before: &[f64; WIDTH]) {
    let now = given(work);
    for lane in 0..WIDTH {
        work.numerical[lane] += now[lane] - before[lane];
    }
}

/// Adds the work of the forces of other bodies to W. The ledger does not contain this work yet; the contact code records the
/// losses of contact.
pub(super) fn add_pushes<const D: usize>(system: &mut System<D>, u1: &[f64]) {
    let System { pushes, work, .. } = system;
    for (node, force) in pushes.iter().flatten() {
        for d in 0..D {
            work.numerical[node % WIDTH] += force[d] * u1[node * D + d];
        }
    }
}

/// Subtracts v̄·J from the recorded loss, before obstacles change velocities at the end of the step. The residual must be that
/// of the stage.
pub(super) fn take_impulses<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>, balance: &Balance) {
    let Workspace { v0, v1, pin_displacement, mass, residual, trial: change, .. } = workspace;
    let span = balance.h * balance.impulse;
    if system.inertia.is_some() {
        // Pinned nodes have the velocity of the step throughout.
        for (k, change) in change.iter_mut().enumerate() {
            *change = if pin_displacement[k].is_nan() { v1[k] - v0[k] } else { 0.0 };
        }
    }
    let mut work = [0.0; WIDTH];
    for (node, mass) in mass.iter().enumerate() {
        let coupled = system.inertia.as_ref().map_or([0.0; D], |inertia| inertia.product::<D>(node, change));
        for d in 0..D {
            let k = node * D + d;
            if pin_displacement[k].is_nan() {
                let impulse = mass * (v1[k] - v0[k]) + coupled[d] - span * residual[k];
                work[node % WIDTH] += 0.5 * (v0[k] + v1[k]) * impulse;
            }
        }
    }
    for (numerical, work) in system.work.numerical.iter_mut().zip(work) {
        *numerical -= work;
    }
}
