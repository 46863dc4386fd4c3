//! The guard of a search with a budget: the result of few iterations is accepted only if it creates no energy.

use super::balance::{Balance, Solved};
use super::minimiser::Minimiser;
use super::newton::Newton;
use super::real_time::{self, Trust, iterate, mark_stale};
use super::settings::{COMMON_ITERATIONS, Otherwise, Settings};
use super::stage::{CANCELLATION, evaluate, potential, rounding_of_models};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::history::Channel;
use opruga_core::system::System;

/// The number of iterations for steps in which few iterations gave a wrong result.
const MOST_ITERATIONS: u32 = 50;

/// The real-time setting as a minimiser.
///
/// The result of few iterations is accepted only if it creates no energy. Otherwise the step is solved by Newton's method with
/// its line search. If that search does not converge, the step is made in two halves. The incremental potential must not be
/// above the potential of a body that does not move. The potential is checked for bodies in the air. The potential is also
/// checked for other bodies if their matrix was rebuilt during the step, if they moved far, or if their residual is larger than
/// promised. The residual of a body on an obstacle counts as an impulse of the obstacle, which the potential does not contain.
/// The end of such a step is doubtful ([`Solved::doubtful`]), so the energy of the body decides whether it is accepted.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RealTime(pub(crate) Settings);

impl<const D: usize> Minimiser<D> for RealTime {
    fn minimise(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        balance: &Balance,
    ) -> Result<Solved, StepError> {
        let spent = match self.with_few_iterations(system, workspace, balance)? {
            Outcome::Accepted(solved) => return Ok(solved),
            Outcome::Refused(spent) => spent,
        };
        mark_stale(system);
        begin_anew(system, workspace, balance);
        let mut solved = Newton(exactly(&self.0)).minimise(system, workspace, balance)?;
        solved.iterations += spent.iterations;
        solved.products += spent.products;
        Ok(solved)
    }
    fn history(&self) -> Vec<Channel> {
        real_time::channels()
    }
    fn predict(&self, system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance) {
        real_time::predict(system, workspace, balance.theta, balance.h);
    }
    fn discard(&self, system: &mut System<D>) {
        mark_stale(system);
    }
    fn remember(&self, system: &mut System<D>, workspace: &Workspace<D>, h: f64) {
        real_time::remember(system, workspace, h);
    }
    fn keeps_matrix(&self, system: &System<D>) -> bool {
        real_time::keeps_matrix(system)
    }
    /// Returns true, because in real time the user cannot change settings between steps.
    fn always_halves(&self) -> bool {
        true
    }
    fn shares_threads(&self) -> bool {
        true
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        !self.0.solver.is_direct_in_real_time(system)
    }
}

/// The result of few iterations.
enum Outcome {
    Accepted(Solved),
    /// The result was refused after this work.
    Refused(Solved),
}

impl RealTime {
    /// Makes few iterations, unless the step has to be exact.
    fn with_few_iterations<const D: usize>(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        balance: &Balance,
    ) -> Result<Outcome, StepError> {
        if system.exact {
            return Ok(Outcome::Refused(Solved::default()));
        }
        let (cut_off, left) = (system.work.solver.cut_off, system.work.solver.left);
        let spent = match iterate(system, workspace, balance, &self.0) {
            Ok((solved, Trust::Always)) => return Ok(Outcome::Accepted(solved)),
            Ok((solved, Trust::IfNoGain)) if !has_risen(system, workspace, balance)? => {
                return Ok(Outcome::Accepted(Solved { doubtful: true, ..solved }));
            }
            Ok((solved, Trust::IfDownhill)) if !has_risen(system, workspace, balance)? => {
                return Ok(Outcome::Accepted(solved));
            }
            Ok((solved, _)) => solved,
            // A model has no value in the state that the iteration reached.
            Err(StepError::Model { .. }) => Solved::default(),
            Err(error) => return Err(error),
        };
        (system.work.solver.cut_off, system.work.solver.left) = (cut_off, left);
        Ok(Outcome::Refused(spent))
    }
}

/// Starts anew without contacts, at the positions that the body would reach with its present velocities.
fn begin_anew<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance) {
    workspace.contacting.clear(system.nodes);
    for k in 0..workspace.u.len() {
        let pinned = workspace.pin_displacement[k];
        workspace.u[k] = if pinned.is_nan() { balance.theta * balance.h * workspace.v0[k] } else { pinned };
    }
}

/// The settings for steps in which few iterations gave a wrong result. They halve a step that does not converge, because in real time the user cannot
/// change settings between steps.
pub(crate) fn exactly(settings: &Settings) -> Settings {
    let common_iterations = settings.common_iterations.max(COMMON_ITERATIONS);
    let otherwise = Otherwise::Halve;
    Settings { real_time: false, iterations: MOST_ITERATIONS, common_iterations, otherwise, ..*settings }
}

/// Whether the incremental potential of the result is above the potential of the initial positions, from which only held nodes
/// were moved. Returns true if the potential is NaN, or if forces without a potential may have raised it.
fn has_risen<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<bool, StepError> {
    let Some((after, size)) = potential(system, workspace, balance, false) else { return Ok(true) };
    if !after.is_finite() {
        return Ok(true);
    }
    for k in 0..workspace.u.len() {
        workspace.trial[k] = if workspace.pin_displacement[k].is_nan() { 0.0 } else { workspace.pin_displacement[k] };
    }
    // If the law had no value in the initial state, there is nothing to compare with.
    let before = match evaluate(system, workspace, balance, true) {
        Ok(()) => potential(system, workspace, balance, true),
        Err(_) => None,
    };
    evaluate(system, workspace, balance, false)?;
    let rounding = |parts: f64| rounding_of_models(system) + CANCELLATION * (size + parts);
    Ok(!before.is_some_and(|(before, parts)| after - before <= rounding(parts)))
}
