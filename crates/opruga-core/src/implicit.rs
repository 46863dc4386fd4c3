//! The interface for implicit integrators: forces, energy and derivatives in trial states, pins, limits.
//!
//! A trial state is in work columns ([`Stage::Work`]); the state of the system does not change until the integrator commits.

use crate::error::StepError;
use crate::potential::{Account, Definiteness, Sink};
use crate::state::Columns;
use crate::system::{Member, Stage, System, view};
use crate::tile::{Tile, Weight};
use opruga_math::{WIDTH, sum_in_fixed_order};

impl<const D: usize> System<D> {
    /// Computes the force of all models and the weight on every node [N], for a state and a time after the start of the step.
    ///
    /// `weight` [s] is the part of the step that this evaluation represents when power is integrated to work; zero for a trial.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub fn evaluate(&mut self, stage: Stage, time: f64, weight: f64, out: &mut Columns<D>) -> Result<(), StepError> {
        self.ensure_workspace();
        self.prepare(stage, self.time + time)?;
        self.gather_forces(stage, time, weight, out);
        Ok(())
    }

    /// Repeats [`System::evaluate`] in the state that was evaluated last. The models need no new preparation there.
    pub fn evaluate_again(&mut self, stage: Stage, time: f64, weight: f64, out: &mut Columns<D>) {
        self.gather_forces(stage, time, weight, out);
    }

    /// Prepares only the models with the given numbers in a state. [`System::evaluate`] prepares all of them.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub fn prepare_some(&mut self, which: &[usize], stage: Stage, time: f64) -> Result<(), StepError> {
        let view = view(&self.state, self.nodes, self.layout, stage, self.time + time, self.threads);
        for number in which {
            let member = &mut self.members[*number];
            member.potential.prepare(self.simd, &view, &member.memory, &mut member.scratch)?;
        }
        Ok(())
    }

    fn gather_forces(&mut self, stage: Stage, time: f64, weight: f64, out: &mut Columns<D>) {
        let limited = self.work.limited_forces;
        for tile in 0..self.plan.len() {
            self.add_forces(stage, self.time + time, weight, tile);
            let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&self.forces[d][buffer..buffer + range.len()]);
            }
        }
        self.add_pushes(out);
        if weight == 0.0 {
            // A trial does not change the counts.
            self.work.limited_forces = limited;
        }
    }

    /// Adds the forces of other bodies to `out`.
    fn add_pushes(&self, out: &mut Columns<D>) {
        for (index, force) in self.pushes.iter().flatten() {
            for d in 0..D {
                out.0[d][*index] += force[d];
            }
        }
    }

    /// Whether second derivatives depend only on positions, and neither on the time nor on the memory of models.
    pub fn hessian_is_of_positions(&self) -> bool {
        self.members.iter().all(|m| m.memory.is_empty() && m.potential.properties().account == Account::Elastic)
    }

    /// The potential energy of all models, of the weight and of the forces of other bodies in a state [J], after
    /// [`System::evaluate`] in the same state; `None` if a model with forces has no energy.
    pub fn potential_energy(&self, stage: Stage, time: f64) -> Option<f64> {
        let silent = |member: &Member<D>| {
            member.potential.properties().account == Account::User && !member.potential.properties().views.energy
        };
        (self.has_energy() && !self.members.iter().any(silent))
            .then(|| self.stored_energy(stage, time) - self.work_of_pushes(stage, time))
    }

    /// The work Σ F·x of the forces of other bodies [J]. These forces have a potential, because they are constant during the
    /// step.
    fn work_of_pushes(&self, stage: Stage, time: f64) -> f64 {
        let Some(pushes) = &self.pushes else { return 0.0 };
        let view = self.view(stage, self.time + time);
        let mut sum = 0.0;
        for (index, force) in pushes {
            for d in 0..D {
                sum += force[d] * view.x[d][*index];
            }
        }
        sum
    }

    /// Whether every model accounts for its forces, either because it has an energy or because its power is recorded as damping or loads.
    pub fn has_energy(&self) -> bool {
        self.members.iter().all(|member| {
            let views = member.potential.properties().views;
            views.energy || views.damping || member.potential.properties().account == Account::User
        })
    }

    /// The energy of all models that have one, and of the weight, in a state [J], after [`System::evaluate`] in the same state.
    pub fn stored_energy(&self, stage: Stage, time: f64) -> f64 {
        let view = self.view(stage, self.time + time);
        let mut sum = 0.0;
        for member in self.members.iter().filter(|member| member.potential.properties().views.energy) {
            sum += sum_in_fixed_order(&member.potential.energy(self.simd, &view, &member.scratch));
        }
        let mut parts = [0.0; WIDTH];
        for node in 0..self.nodes {
            let mut height = 0.0;
            for d in 0..D {
                height += self.gravity[d] * view.x[d][node];
            }
            parts[node % WIDTH] -= self.weighing().at(node) * height;
        }
        sum + sum_in_fixed_order(&parts)
    }

    /// The kinetic energy [J].
    pub fn kinetic_energy(&self) -> f64 {
        let mut parts = [0.0; WIDTH];
        for node in 0..self.nodes {
            for d in 0..D {
                let v = self.state.v.0[d][node];
                parts[node % WIDTH] += 0.5 * self.mass.at(node) * v * v;
            }
        }
        let coupled = self.inertia.as_ref().map(|inertia| 0.5 * inertia.square::<D>(&self.node_by_node(&self.state.v)));
        sum_in_fixed_order(&parts) + coupled.unwrap_or(0.0)
    }

    /// The vectors of one body, with the coordinates of one node after the other.
    pub fn node_by_node(&self, columns: &Columns<D>) -> Vec<f64> {
        (0..self.nodes).flat_map(|node| columns.at(node)).collect()
    }

    /// Computes the external force on every node, consisting of its weight and the loads on it [N], after [`System::evaluate`] in the same state.
    pub fn outer_forces(&mut self, stage: Stage, time: f64, out: &mut Columns<D>) {
        let now = self.time + time;
        let view = view(&self.state, self.nodes, self.layout, stage, now, self.threads);
        for tile in 0..self.plan.len() {
            let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
            let mut force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
            let weight = Some(Weight { mass: self.weighing.as_ref().unwrap_or(&self.mass), gravity: self.gravity });
            let mut power = [0.0; WIDTH];
            let force_of_tile = force.each_mut().map(|f| &mut **f);
            let slots = &mut self.slots;
            let mut all = Tile { range: range.clone(), force: force_of_tile, power: &mut power, weight, slots };
            all.settle(self.simd);
            for member in self.members.iter().filter(|member| member.potential.properties().account == Account::User) {
                member.potential.add_force(self.simd, &view, &member.scratch, &mut all);
            }
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&force[d][..range.len()]);
            }
        }
        self.add_pushes(out);
    }

    /// Delivers the second derivatives of models of external forces, after [`System::evaluate`] in the same state.
    pub fn outer_hessian(&self, stage: Stage, time: f64, keep: Definiteness, sink: &mut dyn Sink<D>) {
        let view = self.view(stage, self.time + time);
        for member in self.members.iter().filter(|member| member.potential.properties().account == Account::User) {
            if member.potential.properties().views.hessian {
                member.potential.hessian(&view, &member.scratch, keep, sink);
            }
        }
    }

    /// Delivers ∂²U/∂x∂x of all models in a state, after [`System::evaluate`] in the same state.
    pub fn hessian(&self, stage: Stage, time: f64, keep: Definiteness, sink: &mut dyn Sink<D>) {
        let view = self.view(stage, self.time + time);
        for member in &self.members {
            if member.potential.properties().views.hessian {
                member.potential.hessian(&view, &member.scratch, keep, sink);
            }
        }
    }

    /// Delivers −∂F/∂v of all models in a state, after [`System::evaluate`] in the same state.
    pub fn damping_matrix(&self, stage: Stage, time: f64, sink: &mut dyn Sink<D>) {
        let view = self.view(stage, self.time + time);
        for member in self.members.iter().filter(|member| member.potential.properties().views.damping) {
            member.potential.damping_matrix(&view, &member.scratch, sink);
        }
    }

    /// Whether any model damps.
    pub fn is_damped(&self) -> bool {
        self.members.iter().any(|member| member.potential.properties().views.damping)
    }

    /// Calls `visit` with the index and axis of every pinned axis of a node, once.
    pub fn pinned_axes(&self, visit: &mut dyn FnMut(usize, usize)) {
        for (index, d) in self.pinned_nodes.within(&(0..self.index_count())) {
            visit(index, d);
        }
    }

    /// Begins an implicit step: allocates memory, and subtracts the initial motion of pinned nodes from the ledger.
    pub fn begin_implicit(&mut self) {
        self.ensure_workspace();
        self.take_pinned_motion(0..self.index_count());
    }

    /// Moves the pinned nodes of a state to their prescribed positions, at a time after the start of the step.
    pub fn hold(&mut self, stage: Stage, time: f64) {
        if !self.pins.is_empty() {
            self.hold_pins(stage, self.time + time);
        }
    }

    /// Ends an implicit step of length `h` whose end is in the current state: moves pinned nodes to their positions, limits
    /// speeds, and updates the memory of models and the time.
    pub fn end_implicit(&mut self, h: f64) {
        self.hold(Stage::Current, h);
        self.limit_velocities();
        self.give_pinned_motion(0..self.index_count());
        self.finish_step(h);
    }
}
