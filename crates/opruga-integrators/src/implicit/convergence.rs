//! The convergence guard: counts the outcomes of searches, and refuses steps that did not converge.

use super::balance::Solved;
use super::settings::{Otherwise, Settings};
use super::workspace::Workspace;
use crate::refusals::StepHint;
use opruga_core::error::StepError;
use opruga_core::system::{Stage, System};
use opruga_math::Lane;

/// Records the outcome of a search for an equilibrium, and refuses the outcome if the search has not converged.
pub(crate) fn report<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    system: &mut System<D>,
    workspace: &Workspace<D>,
    solved: &Solved,
) -> Result<(), StepError> {
    count(system, solved);
    finish(system, workspace);
    if solved.converged { Ok(()) } else { accept_or_refuse(integrator, settings, system, workspace, solved) }
}

/// Records the outcome of a search.
pub(super) fn count<const D: usize>(system: &mut System<D>, solved: &Solved) {
    let work = &mut system.work.solver;
    work.iterations += u64::from(solved.iterations);
    work.linear_iterations += u64::from(solved.products);
    work.estimated += u64::from(solved.error_estimate > 0.0);
    work.error_estimate = solved.error_estimate.larger(work.error_estimate);
    work.conditioned += u64::from(solved.conditioning > 1.0);
    work.conditioning = solved.conditioning.larger(work.conditioning);
}

/// Records the residual of an accepted step.
pub(super) fn finish<const D: usize>(system: &mut System<D>, workspace: &Workspace<D>) {
    let work = &mut system.work.solver;
    work.steps += 1;
    work.residual = workspace.largest_residual().larger(work.residual);
}

/// Counts a step that has not converged, or refuses it.
pub(super) fn accept_or_refuse<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    system: &mut System<D>,
    workspace: &Workspace<D>,
    solved: &Solved,
) -> Result<(), StepError> {
    if settings.otherwise == Otherwise::Accept {
        system.work.solver.accepted += 1;
        return Ok(());
    }
    Err(refusal(integrator, settings, workspace, solved, (system.time, degenerate_cells(system)), settings.hint()))
}

/// The number of degenerate or inverted cells in the state, and the number of all cells.
fn degenerate_cells<const D: usize>(system: &System<D>) -> [u32; 2] {
    let view = system.view(Stage::Current, system.time);
    let cells = system.members.iter().flat_map(|member| member.potential.cell_states(&view, 0));
    let (mut degenerate, mut all) = (0, 0);
    for cell in cells {
        degenerate += u32::from(cell.is_degenerate());
        all += 1;
    }
    [degenerate, all]
}

/// The error of a step that did not converge. It contains the time at the start of the step [s], the number of degenerate or
/// inverted cells, and the number of all cells.
pub(super) fn refusal<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    workspace: &Workspace<D>,
    solved: &Solved,
    (time, [inverted, cells]): (f64, [u32; 2]),
    hint: StepHint,
) -> StepError {
    let (residual, tolerance) = (workspace.largest_residual(), settings.tolerance * workspace.extent);
    let [of_positions, of_forces, displacement] = solved.floor;
    // If the iterations were used up, rounding is not the cause.
    let is_stuck = solved.iterations < settings.iterations;
    // A correction or a residual below its rounding error has no correct digit. The same holds if rounding would move a node
    // farther than the extent of the body.
    let is_lost = solved.correction <= of_positions || residual <= of_forces || displacement > workspace.extent;
    let is_rounding = is_stuck && is_lost;
    StepError::NotConverged {
        integrator,
        iterations: solved.iterations,
        residual,
        correction: solved.correction,
        tolerance,
        time,
        beyond: None,
        inverted,
        cells,
        hint: if is_rounding { StepHint::Rounding { of_positions, of_forces }.into() } else { hint.into() },
    }
}
