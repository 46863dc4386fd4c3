//! # BDF2, the backward differentiation formula of second order
//!
//! With steps of equal length
//!
//! x₁ = (4 x₀ − x₋₁)/3 + ⅔ h v₁,  M v₁ = M (4 v₀ − v₋₁)/3 + ⅔ h F(x₁, v₁, t₁).
//!
//! If the step size changes, the coefficients change with it. Second order, stable for every step size. Motion that is much
//! faster than the step is damped within a few steps (L-stable). Slow motion is hardly damped: the amplitude loses the fraction
//! (hω)⁴/4 per step, compared with (hω)²/2 for backward Euler.
//!
//! **Memory.** The integrator remembers the displacement of the previous step and the velocity at its start. The displacement
//! and the velocity are part of the state, and so of checkpoints, hashes and replays. The first step is a step of backward
//! Euler, and so is the first step after a program has moved a node. After an impact, the memory of a node is reset as if the
//! node had always moved with its velocity after the impact, because a difference across an impact does not describe the motion
//! after it.
//!
//! Source: Curtiss and Hirschfelder 1952; Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, III.5 (5.9).

#[cfg(test)]
mod tests;

use crate::implicit::balance::Balance;
use crate::implicit::impact::Struck;
use crate::implicit::rule::Rule;
use crate::implicit::settings::fields;
use crate::implicit::step::Implicit;
use crate::implicit::workspace::Workspace;
use opruga_core::error::BuildError;
use opruga_core::history::{Channel, PerBody, PerNode};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Spec, Values};
use opruga_core::system::System;
use opruga_solve::blocks::nodes;

/// The parameters of `bdf2`.
pub const SPEC: Spec = Spec {
    kind: "bdf2",
    summary: "implicit, second order, stable for every step size; damps motion that is much faster than the step",
    documentation: "x₁ = (4 x₀ − x₋₁)/3 + ⅔ h v₁ and the same for velocities, solved by Newton's method. In each step, the amplitude of an \
oscillation decreases by the fraction (hω)⁴/4 if hω is small. The integrator remembers the previous step; its first step is a step of backward \
Euler. Bodies are not stepped in batches.",
    dimensions: &[2, 3],
    fields: fields!(of_time),
    roles: &[],
};

/// The displacement of the previous step [m], the velocity at its start [m/s], and its length [s]. All three are zero before
/// the first step.
const DISPLACEMENT: PerNode = PerNode::new("bdf2.displacement");
const VELOCITY: PerNode = PerNode::new("bdf2.velocity");
const STEP: PerBody<f64> = PerBody::new("bdf2.step");

/// The kind of integrator that scenes call `bdf2`.
#[derive(Debug)]
pub struct Bdf2Kind;

/// The second-order backward differentiation formula. After a restart, the first step uses the first-order formula.
#[derive(Clone, Copy, Debug, Default)]
pub struct Bdf2 {
    begins: bool,
}

impl<const D: usize> IntegratorKind<D> for Bdf2Kind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Implicit::new(SPEC.kind, Bdf2::default(), values)?))
    }
}

impl<const D: usize> Rule<D> for Bdf2 {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = true;
    fn pushed(self) -> Self {
        Bdf2 { begins: true }
    }
    fn history(&self) -> Vec<Channel> {
        vec![DISPLACEMENT.declared(), VELOCITY.declared(), STEP.declared()]
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        // The state consists of x, v, the displacement of the previous step, and the velocity before that step; z = x + ⅓
        // displacement, w = 4/3 v − ⅓ before.
        let (square, g) = (omega * omega, 2.0 * h / 3.0);
        let factor = 1.0 / (1.0 + g * c + g * g * square);
        let third = 1.0 / 3.0;
        let v = [-g * square * factor, 4.0 * third * factor, -g * square * third * factor, -third * factor];
        let displacement = [g * v[0], g * v[1], third + g * v[2], g * v[3]];
        Amplification::new([
            [1.0 + displacement[0], displacement[1], displacement[2], displacement[3]],
            v,
            displacement,
            [0.0, 1.0, 0.0, 0.0],
        ])
    }
    fn begin(&self, system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance {
        // With the ratio r = h/h₋ of the lengths of this step and the previous one, x₁ = x₀ + r²(x₀ − x₋₁)/(1 + 2r) + γ h v₁, γ
        // = (1 + r)/(1 + 2r). r = 0 gives backward Euler.
        let last = if self.begins { 0.0 } else { system.history.get(STEP) };
        let kept = [DISPLACEMENT, VELOCITY].map(|channel| system.history.vectors(channel).filter(|_| last > 0.0));
        let r = if last > 0.0 { h / last } else { 0.0 };
        let (share, span) = (r * r / (1.0 + 2.0 * r), h * (1.0 + r) / (1.0 + 2.0 * r));
        if let [Some(displacement), Some(before)] = kept {
            for node in 0..system.nodes {
                for d in 0..D {
                    let k = node * D + d;
                    let velocity = workspace.v0[k];
                    // A jump of velocity due to pins is added to the remembered velocity too, because a difference across the
                    // jump is not due to a force.
                    let jump = workspace.kick.get(k).copied().unwrap_or(0.0);
                    workspace.z[k] = share * (displacement.0[d][node] + last * jump);
                    workspace.y[k] = workspace.z[k] + span * (velocity + share * (velocity - before.0[d][node] - jump));
                }
            }
            if system.inertia.is_some() {
                // Pinned nodes continue as if they had always moved as in this step; otherwise the difference would affect
                // their neighbours.
                system.pinned_axes(&mut |node, d| {
                    let k = node * D + d;
                    workspace.z[k] = share * last * workspace.v0[k];
                    workspace.y[k] = workspace.z[k] + span * workspace.v0[k];
                });
            }
        } else {
            for k in 0..workspace.z.len() {
                (workspace.z[k], workspace.y[k]) = (0.0, span * workspace.v0[k]);
            }
        }
        Balance {
            sigma: 1.0 / (span * span),
            beta: 1.0 / span,
            theta: 1.0,
            time: h,
            h,
            load: 1.0,
            impulse: span / h,
            echo: if self.begins { 0.0 } else { 0.5 * span / h },
        }
    }
    fn end(&self, _system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, _h: f64) {
        for k in 0..workspace.u.len() {
            workspace.u1[k] = workspace.u[k];
            workspace.v1[k] = balance.beta * (workspace.u[k] - workspace.z[k]);
        }
    }
    fn remembered(&self, workspace: &Workspace<D>, k: usize, _h: f64) -> f64 {
        if self.begins {
            return 0.0;
        }
        0.5 * (workspace.v1[k] - workspace.v0[k])
    }
    fn remember(&self, system: &mut System<D>, workspace: &Workspace<D>, h: f64) {
        // For a node that met an obstacle, the differences are computed from the part of the memory that is still valid. They
        // then describe how the motion along the surface continues.
        let velocity = |node: usize, d: usize| workspace.v1[node * D + d];
        if let Some(displacement) = system.history.vectors_mut(DISPLACEMENT) {
            for (node, u) in nodes::<D>(&workspace.u1).iter().enumerate() {
                displacement.set(node, *u);
            }
            for Struck { node, memory, .. } in &workspace.struck {
                displacement.set(*node, core::array::from_fn(|d| h * (velocity(*node, d) - memory[d])));
            }
        }
        if let Some(before) = system.history.vectors_mut(VELOCITY) {
            for (node, v) in nodes::<D>(&workspace.v0).iter().enumerate() {
                before.set(node, *v);
            }
            for Struck { node, memory, .. } in &workspace.struck {
                before.set(*node, core::array::from_fn(|d| velocity(*node, d) - 2.0 * memory[d]));
            }
        }
        system.history.set(STEP, if self.begins { 0.0 } else { h });
    }
}
