//! What a rule dissipates by itself in a step, from its own formula.
//!
//! Every rule changes the momentum of a step by M Δv = h i (F + r + R) + M m. F are the forces of the stage, r is what the iteration
//! leaves out of balance, R is what obstacles hold nodes with, i the part of the stage ([`Balance::impulse`]), and m what the rule
//! remembers. The kinetic energy changes by v̄·M Δv, with v̄ = ½ (v₀ + v₁), exactly. Of this the rule answers for
//!
//! J = h i F + M m = M Δv − h i (r + R).
//!
//! With W, the work of loads and pins less damping as the ledger has it, what the rule dissipates is
//!
//! L = W + U₀ − U₁ − v̄·J.
//!
//! It is signed, and exact for any U. With g = ∇U, where nothing else acts, this says the following.
//!
//! | rule | L |
//! |---|---|
//! | backward Euler | ½ Δv·M Δv + U₀ − U₁ + g₁·Δx |
//! | θ-method | U₀ − U₁ + g_s·Δx + (θ − ½) Δv·M Δv |
//! | BDF2 | ½ Δv·M Δv − ⅓ v₁·M Δ₋v − ⅓ g₁·Δ₋x + U₀ − U₁ + g₁·Δx |
//! | generalised-α | U₀ − U₁ + g_f·Δx + (1 − γ − α_m) Δx·M Δa + h² (β − γ/2) (½ Δ(a·M a) + (γ − ½) Δa·M Δa) |
//!
//! Δ goes from n to n + 1 and Δ₋ from n − 1 to n; g_f = (1 − α_f) g₁ + α_f g₀ where forces are linear, and g in the averaged state for
//! any. The tests of the rules compare them. The work of r, h i v̄·r, is in no channel of the ledger: it stays unexplained, which is
//! what it is. The work of R is entered by the contacts.
//!
//! What pins hold does not count: their work is entered with the kinetic energy of pinned nodes.

use super::balance::Balance;
use super::workspace::Workspace;
use opruga_core::system::{System, Work8};
use opruga_math::WIDTH;

/// The work of loads and pins less that of damping, as it is entered so far [J].
pub(super) fn given(work: &Work8) -> [f64; WIDTH] {
    core::array::from_fn(|lane| work.user[lane] - work.damping[lane])
}

/// Adds W, what was entered since `before`.
pub(super) fn add_given(work: &mut Work8, before: &[f64; WIDTH]) {
    let now = given(work);
    for lane in 0..WIDTH {
        work.numerical[lane] += now[lane] - before[lane];
    }
}

/// Adds the work of other bodies' pushes to W: it is in no account of the ledger yet, and contact enters what it loses.
pub(super) fn add_pushes<const D: usize>(system: &mut System<D>, u1: &[f64]) {
    let System { pushes, work, .. } = system;
    for (node, force) in pushes.iter().flatten() {
        for d in 0..D {
            work.numerical[node % WIDTH] += force[d] * u1[node * D + d];
        }
    }
}

/// Takes v̄·J, before obstacles change velocities at the end of the step. What is out of balance is that of the stage.
pub(super) fn take_impulses<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>, balance: &Balance) {
    let Workspace { v0, v1, pin_displacement, mass, residual, trial: change, .. } = workspace;
    let span = balance.h * balance.impulse;
    if system.inertia.is_some() {
        // What pins hold has the velocity of the step throughout.
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
