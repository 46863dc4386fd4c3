//! What a scene can change against a warning, other than what it already uses.

use crate::warnings::{BudgetHint, DampingHint};
use crate::world::World;
use opruga_core::spec::Values;

impl<const D: usize> World<D> {
    /// Whether obstacles or other bodies have taken energy from a body.
    pub(crate) fn has_lost_energy_in_contact(&self) -> bool {
        self.energy.loss_contact + self.energy.loss_friction > 0.0
    }

    /// The integrators of the bodies, with their parameters.
    fn rules(&self) -> impl Iterator<Item = &Values> {
        let own = self.bodies().map(|body| self.blueprint.bodies[body].integrator.as_ref());
        own.map(|own| own.unwrap_or(&self.blueprint.integrator))
    }

    /// Whether a body has steps with a fixed budget.
    pub(crate) fn is_in_real_time(&self) -> bool {
        self.rules().any(|rule| rule.text("accuracy") == Some("real_time"))
    }

    /// What reduces the energy that integrators remove.
    pub(crate) fn against_damping(&self) -> DampingHint {
        if self.rules().any(|rule| rule.number("spectral_radius").is_some_and(|radius| radius < 1.0)) {
            return DampingHint::Radius;
        }
        // Integrators without damping refuse steps in real time.
        self.unless_in_use(if self.is_in_real_time() { DampingHint::RealTime } else { DampingHint::Undamped })
    }

    /// What reduces the energy that integrators add.
    pub(crate) fn against_growth(&self) -> DampingHint {
        // The residual of steps in real time is what adds energy, and every step has one.
        if self.is_in_real_time() {
            return DampingHint::Exact;
        }
        self.unless_in_use(DampingHint::Damped)
    }

    /// The advice, unless it names an integrator that the scene already uses.
    fn unless_in_use(&self, advice: DampingHint) -> DampingHint {
        let text = advice.to_string();
        let is_in_use = self.integrators().iter().any(|kind| text.contains(&format!("`{kind}`")));
        if is_in_use { DampingHint::Substeps } else { advice }
    }

    /// What reduces the residual of steps in real time.
    pub(crate) fn against_lack_of_budget(&self) -> BudgetHint {
        let is_factored = |rule: &Values| rule.text("linear_solver") == Some("cholesky");
        match self.clusters.is_some() || self.has_lost_energy_in_contact() {
            true => BudgetHint::Touching,
            false if self.rules().any(is_factored) => BudgetHint::Factored,
            false => BudgetHint::Stiff,
        }
    }
}
