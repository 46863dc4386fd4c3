//! # Newmark's rule and the generalised-α method
//!
//! x₁ = x₀ + h v₀ + h² ((½ − β) a₀ + β a₁),  v₁ = v₀ + h ((1 − γ) a₀ + γ a₁),
//! M ((1 − α_m) a₁ + α_m a₀) = F(x_s, v_s, t_s),  x_s = (1 − α_f) x₁ + α_f x₀, v_s and t_s likewise.
//!
//! Without `spectral_radius` the rule is the average acceleration method: α_m = α_f = 0, γ = ½, β = ¼. The method has second
//! order, is stable for every step size on linear systems, and damps no frequency. With `spectral_radius` ρ from 0 to 1 the
//! rule is the generalised-α method. At hω → ∞, the amplitude is multiplied by ρ in each step, and slow motion is damped as
//! little as this factor permits: α_m = (2ρ − 1)/(ρ + 1), α_f = ρ/(ρ + 1), γ = ½ − α_m + α_f, β = ¼ (1 − α_m + α_f)². The
//! generalised-α method also has second order.
//!
//! **Memory.** The integrator remembers the acceleration. The first value is F/M, and so is the first value after a program has
//! moved a node. When a node meets an obstacle, the component of its acceleration normal to the surface is discarded, because
//! it belongs to the time before the impact. Free fall is exact. The average acceleration method damps nothing and would
//! sustain an oscillation of the contact forces (Hughes et al. 1976). Steps in which obstacles hold nodes therefore use a
//! related rule, the implicit midpoint rule in its form for contact.
//!
//! Source: Newmark 1959; Chung and Hulbert, *A time integration algorithm for structural dynamics with improved numerical
//! dissipation: the generalized-α method*, 1993 (the force in the averaged state: Erlicher, Bonaventura, Bursi 2002).

#[cfg(test)]
mod tests;

use crate::implicit::balance::Balance;
use crate::implicit::holding::{accelerations, pinned_coordinates};
use crate::implicit::rule::Rule;
use crate::implicit::settings::fields;
use crate::implicit::step::Implicit;
use crate::implicit::theta::Theta;
use crate::implicit::workspace::Workspace;
use opruga_core::error::BuildError;
use opruga_core::history::{Channel, PerBody, PerNode};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::spec::{Allowed, Default, Field, Spec, Values};
use opruga_core::system::System;
use opruga_solve::blocks::times;

/// The parameters of `newmark`.
pub const SPEC: Spec = Spec {
    kind: "newmark",
    summary: "implicit, second order, stable for every step size: average acceleration, or generalised-α with a spectral radius",
    documentation: "x₁ = x₀ + h v₀ + h² ((½ − β) a₀ + β a₁), v₁ = v₀ + h ((1 − γ) a₀ + γ a₁), solved by Newton's method. Average acceleration (β = \
¼, γ = ½) damps nothing. With `spectral_radius`, the integrator is the generalised-α method, which damps motion that is faster than the step. While \
nodes touch obstacles, average acceleration makes the same steps as `implicit_midpoint` does in contact, so that bodies come to rest. The integrator \
keeps the acceleration from step to step. Bodies are not stepped in batches.",
    dimensions: &[2, 3],
    fields: fields!(
        of_time,
        Field::new(
            "spectral_radius",
            Allowed::FRACTION,
            "",
            Default::Absent,
            "The factor by which a step multiplies the amplitude of the fastest oscillations: 1 keeps them, 0 removes them in one step. If it is not \
given, average acceleration is used.",
        )
    ),
    roles: &[],
};

/// The acceleration at the end of the previous step [m/s²], and whether there was a previous step.
const ACCELERATION: PerNode = PerNode::new("newmark.acceleration");
const BEGUN: PerBody<bool> = PerBody::new("newmark.begun");

/// The kind of integrator that scenes call `newmark`.
#[derive(Debug)]
pub struct NewmarkKind;

/// Newmark's rule or the generalised-α method.
#[derive(Clone, Copy, Debug)]
pub struct Newmark {
    alpha_m: f64,
    alpha_f: f64,
    beta: f64,
    gamma: f64,
    /// The θ-method that makes the step instead, if any.
    theta: Option<Theta>,
}

impl<const D: usize> IntegratorKind<D> for NewmarkKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        Ok(Box::new(Implicit::new(SPEC.kind, Newmark::new(values), values)?))
    }
}

impl Newmark {
    pub(crate) fn new(values: &Values) -> Newmark {
        values.number("spectral_radius").map_or(Newmark::of(0.0, 0.0), Newmark::of_radius)
    }
    /// The generalised-α method with a spectral radius.
    fn of_radius(rho: f64) -> Newmark {
        Newmark::of((2.0 * rho - 1.0) / (rho + 1.0), rho / (rho + 1.0))
    }
    fn of(alpha_m: f64, alpha_f: f64) -> Newmark {
        let excess = alpha_f - alpha_m;
        let beta = 0.25 * (1.0 + excess) * (1.0 + excess);
        Newmark { alpha_m, alpha_f, beta, gamma: 0.5 + excess, theta: None }
    }
}

impl<const D: usize> Rule<D> for Newmark {
    const NAME: &'static str = SPEC.kind;
    const TRAPEZOID: bool = true;
    fn is_trapezoid(&self) -> bool {
        self.theta.is_none()
    }
    fn history(&self) -> Vec<Channel> {
        vec![ACCELERATION.declared(), BEGUN.declared()]
    }
    fn in_contact(self) -> Option<Self> {
        // Average acceleration conserves every oscillation.
        let keeps = self.alpha_m == 0.0 && self.alpha_f == 0.0 && self.theta.is_none();
        keeps.then_some(Newmark { theta: Some(Theta::IN_CONTACT), ..self })
    }
    fn calmed(self) -> Option<Self> {
        (self.theta == Some(Theta::IN_CONTACT)).then_some(Newmark { theta: Some(Theta::END), ..self })
    }
    fn pushed(self) -> Self {
        Newmark { theta: Some(Theta::END), ..self }
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        let Newmark { alpha_m, alpha_f, beta, gamma, .. } = *self;
        let (square, theta) = (omega * omega, 1.0 - alpha_f);
        let factor = 1.0 / (1.0 - alpha_m + theta * (square * h * h * beta + c * h * gamma));
        let (early, kick) = (h * h * (0.5 - beta), h * (1.0 - gamma));
        // At ρ = 1 the equation gives the mean of both accelerations, so the next motion does not depend on earlier
        // accelerations.
        let keeps = alpha_m == 0.5 && alpha_f == 0.5;
        let kept = (alpha_m + square * theta * early + c * theta * kick) * factor;
        let a = [-square * factor, -(square * theta * h + c) * factor, if keeps { -1.0 } else { -kept }];
        let (x, v) = (h * h * beta, h * gamma);
        Amplification::new([
            [1.0 + x * a[0], h + x * a[1], early + x * a[2]],
            [v * a[0], 1.0 + v * a[1], kick + v * a[2]],
            a,
        ])
    }
    fn begin(&self, system: &System<D>, workspace: &mut Workspace<D>, h: f64) -> Balance {
        if let Some(theta) = self.theta {
            return theta.begin(workspace, h);
        }
        let Newmark { alpha_m, alpha_f, beta, gamma, .. } = *self;
        let last = system.history.vectors(ACCELERATION).filter(|_| system.history.get(BEGUN));
        let begun = last.is_some();
        let theta = 1.0 - alpha_f;
        let rate = gamma / (beta * h);
        first_acceleration(system, workspace);
        // Nodes that pins have just caught no longer accelerate; otherwise their acceleration would affect their neighbours.
        let stopped = if begun && system.inertia.is_some() { pinned_coordinates(system) } else { Vec::new() };
        for node in 0..system.nodes {
            for d in 0..D {
                let k = node * D + d;
                let a = match (stopped.get(k), last) {
                    (Some(true), _) => 0.0,
                    (_, Some(last)) => last.0[d][node],
                    _ => workspace.a0[k],
                };
                let v = workspace.v0[k];
                workspace.a0[k] = a;
                let displacement = h * v + h * h * (0.5 - beta) * a;
                workspace.y[k] = theta * (displacement - alpha_m * beta * h * h / (1.0 - alpha_m) * a);
                // v_s = rate (u − z)
                workspace.z[k] = theta * displacement - (theta * (v + h * (1.0 - gamma) * a) + alpha_f * v) / rate;
            }
        }
        Balance {
            sigma: (1.0 - alpha_m) / (beta * h * h * theta),
            beta: rate,
            theta,
            time: theta * h,
            h,
            load: 1.0,
            impulse: gamma / (1.0 - alpha_m),
            echo: 1.0 - gamma / (1.0 - alpha_m),
        }
    }
    fn end(&self, _system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance, h: f64) {
        if let Some(theta) = self.theta {
            return theta.end(workspace, balance);
        }
        for k in 0..workspace.u.len() {
            workspace.u1[k] = workspace.u[k] / balance.theta;
            let a1 = self.acceleration(workspace, k, h);
            workspace.v1[k] = workspace.v0[k] + h * ((1.0 - self.gamma) * workspace.a0[k] + self.gamma * a1);
        }
    }
    fn remembered(&self, workspace: &Workspace<D>, k: usize, h: f64) -> f64 {
        if self.theta.is_some() {
            return 0.0;
        }
        h * (0.5 - self.alpha_f) * self.acceleration(workspace, k, h)
    }
    fn remember(&self, system: &mut System<D>, workspace: &Workspace<D>, h: f64) {
        if self.theta.is_some() {
            // The next step begins with F/M, the value that the average acceleration method would have remembered.
            system.history.set(BEGUN, false);
            return;
        }
        let nodes = system.nodes;
        let Some(last) = system.history.vectors_mut(ACCELERATION) else { return };
        for node in 0..nodes {
            for d in 0..D {
                last.0[d][node] = self.acceleration(workspace, node * D + d, h);
            }
        }
        for struck in &workspace.struck {
            let a = times(&struck.kept, &last.at(struck.node));
            last.set(struck.node, a);
        }
        // A node does not accelerate in the directions in which an obstacle or a pin holds it.
        for node in (0..nodes).filter(|node| !workspace.free[*node]) {
            let along = times(&workspace.projectors[node], &last.at(node));
            last.set(node, along);
        }
        system.history.set(BEGUN, true);
    }
}

/// Solves M a₀ = F at the start. If masses couple nodes, pinned nodes do not accelerate.
fn first_acceleration<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>) {
    let Workspace { a0, force, right, .. } = workspace;
    a0.clear();
    a0.resize(right.len(), 0.0);
    if system.inertia.is_none() {
        for (k, a) in a0.iter_mut().enumerate() {
            *a = force.0[k % D][k / D] * system.inverse_mass.at(k / D);
        }
    } else if !system.history.get(BEGUN) {
        right.iter_mut().enumerate().for_each(|(k, force_on)| *force_on = force.0[k % D][k / D]);
        accelerations(system, &pinned_coordinates(system), right, a0);
    }
}

impl Newmark {
    /// Computes a₁ from the displacement of the step.
    fn acceleration<const D: usize>(&self, workspace: &Workspace<D>, k: usize, h: f64) -> f64 {
        (workspace.u1[k] - h * workspace.v0[k] - h * h * (0.5 - self.beta) * workspace.a0[k]) / (self.beta * h * h)
    }
}
