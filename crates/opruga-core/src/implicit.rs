//! What implicit integrators ask of a system: forces, energy and derivatives in trial states, pins, limits.
//!
//! A trial state lies in work columns ([`Stage::Work`]); the state of the system stays as it is until the rule commits.

use crate::error::StepError;
use crate::potential::{Account, Definiteness, Sink};
use crate::state::Columns;
use crate::system::{Stage, System};
use opruga_math::sum_in_fixed_order;

impl<const D: usize> System<D> {
    /// The force of all models and the weight on every node in a state, at a time after the start of the step [N].
    ///
    /// `weight` [s] is the share of this evaluation in the step's work integrals; zero for a mere trial.
    ///
    /// # Errors
    /// [`StepError`] where a model refuses the state.
    pub fn evaluate(&mut self, stage: Stage, time: f64, weight: f64, out: &mut Columns<D>) -> Result<(), StepError> {
        let now = self.time + time;
        self.make_room();
        self.prepare(stage, now)?;
        let limited = self.work.limited_forces;
        for tile in 0..self.plan.len() {
            self.add_forces(stage, now, weight, tile);
            let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&self.forces[d][buffer..buffer + range.len()]);
            }
        }
        if weight == 0.0 {
            // A trial counts nothing.
            self.work.limited_forces = limited;
        }
        Ok(())
    }

    /// The potential energy of all models and of the weight in a state [J], after [`System::evaluate`] of the same state;
    /// none where a model that pushes has no energy.
    pub fn potential_energy(&self, stage: Stage, time: f64) -> Option<f64> {
        let view = self.view(stage, self.time + time);
        let mut sum = 0.0;
        for member in &self.members {
            let views = member.potential.views();
            if views.energy {
                sum += sum_in_fixed_order(&member.potential.energy(self.simd, &view, &member.scratch));
            } else if member.potential.account() == Account::User || !views.damping {
                return None;
            }
        }
        let mut parts = [0.0; opruga_math::WIDTH];
        for place in 0..self.nodes {
            let mut height = 0.0;
            for d in 0..D {
                height += self.gravity[d] * view.x[d][place];
            }
            parts[place % opruga_math::WIDTH] -= self.mass.at(place) * height;
        }
        Some(sum + sum_in_fixed_order(&parts))
    }

    /// Delivers ∂²U/∂x∂x of all models in a state, after [`System::evaluate`] of the same state.
    pub fn hessian(&self, stage: Stage, time: f64, keep: Definiteness, sink: &mut dyn Sink<D>) {
        let view = self.view(stage, self.time + time);
        for member in &self.members {
            if member.potential.views().hessian {
                member.potential.hessian(&view, &member.scratch, keep, sink);
            }
        }
    }

    /// Delivers −∂F/∂v of all models in a state, after [`System::evaluate`] of the same state.
    pub fn damping_matrix(&self, stage: Stage, time: f64, sink: &mut dyn Sink<D>) {
        let view = self.view(stage, self.time + time);
        for member in self.members.iter().filter(|member| member.potential.views().damping) {
            member.potential.damping_matrix(&view, &member.scratch, sink);
        }
    }

    /// Whether any model damps.
    pub fn is_damped(&self) -> bool {
        self.members.iter().any(|member| member.potential.views().damping)
    }

    /// Calls back with every held axis of a node, once: place, axis.
    pub fn held_axes(&self, visit: &mut dyn FnMut(usize, usize)) {
        for (place, d) in self.held.within(&(0..self.places())) {
            visit(place, d);
        }
    }

    /// Begins an implicit step: makes room, and takes the motion of held nodes that the step finds from the ledger.
    pub fn begin_implicit(&mut self) {
        self.make_room();
        self.take_held_motion(0..self.places());
    }

    /// Puts held nodes of a state where they have to be, at a time after the start of the step.
    pub fn hold(&mut self, stage: Stage, time: f64) {
        if !self.pins.is_empty() {
            self.hold_pins(stage, self.time + time);
        }
    }

    /// Ends an implicit step of `h` whose end is in the current state: held nodes are where they have to be, speeds are
    /// limited, models move their memory on, time passes.
    pub fn end_implicit(&mut self, h: f64) {
        self.hold(Stage::Current, h);
        self.limit_velocities();
        self.give_held_motion(0..self.places());
        self.finish_step(h);
    }
}
