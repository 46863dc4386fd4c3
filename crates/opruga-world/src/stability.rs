//! Estimates the stable step of every kind of body before it is stepped.

use crate::blueprint::BodyBlueprint;
use crate::error::{Part, WorldError};
use crate::island::Island;
use crate::masses::node_masses;
use crate::plausible;
use crate::refusals::Refusal;
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_core::error::{BuildError, StepError};
use opruga_core::stability::{Stability, estimate};
use std::sync::Arc;

/// The maximum number of islands that are examined again when energy appears without a source.
const MOST_LOOKED_AT: usize = 8;

impl<const D: usize> World<D> {
    /// Estimates the stable step of every kind of body that was rebuilt, and compares all steps with their limits.
    ///
    /// Bodies are of one kind if they agree in everything that the estimate depends on. Unchanged islands keep their estimate, so that a change of
    /// one body never causes the refusal of a step because of the present state of another body.
    pub(crate) fn check_stability(&mut self) -> Result<(), WorldError> {
        let mut seen: Vec<(usize, PinnedAxes)> = Vec::new();
        let mut first_of_kind = Vec::new();
        for (number, island) in self.islands.iter().enumerate() {
            // Loads, pulls and users' forces belong to one body; such an island is a kind of its own.
            let mut known = !self.has_more_than_models(island);
            for (lane, body) in island.bodies.iter().enumerate() {
                let pinned = pinned_axes(island, lane);
                if !seen.iter().any(|(other, nodes)| *nodes == pinned && self.same_kind(*other, *body)) {
                    known = false;
                    seen.push((*body, pinned));
                }
            }
            if !known {
                first_of_kind.push(number);
            }
        }
        let mut estimates = Vec::with_capacity(first_of_kind.len());
        for number in first_of_kind {
            let name = self.blueprint.bodies[self.islands[number].bodies[0]].name.clone();
            let island = &mut self.islands[number];
            let stability = match island.stability {
                Some(stability) => stability,
                None => {
                    let body = &self.blueprint.bodies[island.bodies[0]];
                    estimate(&island.system, &*island.integrator).map_err(|error| WorldError::Build {
                        part: Part::body(&name),
                        source: BuildError::of("stability", no_estimate(error, body)),
                    })?
                }
            };
            island.stability = Some(stability);
            estimates.push((number, name, stability));
        }
        self.compare_steps(estimates)
    }

    /// Refuses a step above the limit of a body, and warns if there is no stable step.
    fn compare_steps(&mut self, estimates: Vec<(usize, String, Stability)>) -> Result<(), WorldError> {
        let h = self.h();
        let mut warnings: Vec<Warning> = Vec::new();
        for (number, name, stability) in &estimates {
            let integrator = &*self.islands[*number].integrator;
            match stability.largest_stable_step {
                Some(limit) if h > limit => {
                    let error = WorldError::UnstableStep {
                        integrator: integrator.name(),
                        body: name.clone(),
                        h,
                        limit,
                        omega: stability.spectrum.omega,
                        damping: stability.spectrum.damping,
                        substeps: (self.blueprint.time.frame / limit).ceil() as u32,
                    };
                    if !self.options.allow_unstable {
                        return Err(error);
                    }
                    warnings.push(Warning::new(error, 1));
                }
                None => {
                    let growth = stability.spectrum.growth_per_second(integrator, h);
                    let warning = WorldWarning::NoStableStep {
                        integrator: integrator.name(),
                        body: name.clone(),
                        omega: stability.spectrum.omega,
                        growth,
                    };
                    let known = |w: &&mut Warning| w.is_about("step.no_stable_step", "integrator", integrator.name());
                    match warnings.iter_mut().find(known) {
                        Some(warning) => warning.count += 1,
                        None => warnings.push(Warning::new(warning, 1)),
                    }
                }
                _ => {}
            }
            let body = &self.blueprint.bodies[self.islands[*number].bodies[0]];
            if let Some(sag) = plausible::sag(body, &self.blueprint.surroundings.gravity, &stability.spectrum) {
                match warnings.iter_mut().find(|w| w.code == sag.code) {
                    Some(warning) => warning.count += 1,
                    None => warnings.push(sag),
                }
            }
        }
        let anew = ["step.unstable", "step.no_stable_step", plausible::SAG];
        self.warnings.retain(|w| !anew.contains(&w.code.as_str()));
        self.warnings.extend(warnings);
        self.stability = estimates.into_iter().map(|(_, name, stability)| (name, stability)).collect();
        Ok(())
    }

    /// If energy has appeared without a source (`ledger.closure`), checks whether the step is still stable in the present state, and warns
    /// (`step.outgrown`) if it is not. Returns whether there was anything to check. Stepping is not affected.
    pub fn look_at_steps_again(&mut self) -> bool {
        if self.flows.open_frames == 0 {
            return false;
        }
        let energy = |island: &Island<D>| island.survey.kinetic + island.stock.elastic + island.stock.gas;
        let mut order: Vec<usize> = (0..self.islands.len()).collect();
        order.sort_by(|a, b| energy(&self.islands[*b]).total_cmp(&energy(&self.islands[*a])).then(a.cmp(b)));
        let (h, time) = (self.h(), self.time());
        for number in order.into_iter().take(MOST_LOOKED_AT) {
            let island = &self.islands[number];
            // A step that was unstable from the start has already been reported.
            if island.stability.is_some_and(|s| s.largest_stable_step.is_none_or(|limit| h > limit)) {
                continue;
            }
            let Ok(Stability { largest_stable_step: Some(limit), .. }) = estimate(&island.system, &*island.integrator)
            else {
                continue;
            };
            if h > limit {
                let body = self.blueprint.bodies[island.bodies[0]].name.clone();
                let substeps = (self.blueprint.time.frame / limit).ceil();
                self.warnings.push(Warning::new(WorldWarning::Outgrown { time, body, limit, h, substeps }, 1));
                break;
            }
        }
        true
    }

    fn has_more_than_models(&self, island: &Island<D>) -> bool {
        let models = self.blueprint.bodies[island.bodies[0]].models.len();
        let drag = usize::from(self.blueprint.surroundings.drag > 0.0);
        island.system.members.len() > models + drag
    }

    /// Whether two bodies differ only in position and motion.
    fn same_kind(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.blueprint.bodies[a], &self.blueprint.bodies[b]);
        Arc::ptr_eq(&a.mesh, &b.mesh)
            && a.thickness == b.thickness
            && a.mass == b.mass
            && a.models == b.models
            && a.integrator == b.integrator
    }
}

/// The pinned nodes of a body and their axes, one bit each.
type PinnedAxes = Vec<(usize, u8)>;

fn pinned_axes<const D: usize>(island: &Island<D>, lane: usize) -> PinnedAxes {
    let stride = island.system.layout.stride();
    let own = island.system.pins.iter().filter(|pin| pin.index % stride == lane);
    own.map(|pin| (pin.index / stride, pin.axes.iter().fold(0, |bits, axis| bits * 2 + u8::from(*axis)))).collect()
}

/// The reason why there is no estimate, with the numbers of the body that most likely cause forces or frequencies that are not finite.
fn no_estimate<const D: usize>(error: StepError, body: &BodyBlueprint<D>) -> Refusal {
    let cause = match error {
        StepError::Model { about, .. } => about,
        other => other.into(),
    };
    let numbers = body.models.iter().flat_map(|model| {
        let numbers = model.iter().filter_map(|(name, _)| Some((name, model.number(name)?)));
        numbers.map(|(name, x)| (model.kind(), name, x))
    });
    let largest = numbers.max_by(|a, b| a.2.abs().total_cmp(&b.2.abs()));
    let lightest = node_masses(body)
        .into_iter()
        .filter(|mass| *mass > 0.0)
        .fold(f64::INFINITY, |least, m| if m < least { m } else { least });
    match largest {
        None => Refusal::NoEstimate { cause, lightest },
        Some((kind, field, value)) => {
            Refusal::NoEstimateOf { cause, field: field.into(), value, kind: kind.into(), lightest }
        }
    }
}
