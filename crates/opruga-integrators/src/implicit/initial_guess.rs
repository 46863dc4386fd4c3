//! The start of an iteration.

use super::balance::Balance;
use super::stage::{evaluate, potential};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::system::System;

/// Evaluates the initial guess of the iteration: the state that the present motion would reach, or the present state if moving
/// the pins would tear the body.
///
/// Pins move to their final positions at once, so the cells next to them take the whole displacement instead of a small part of
/// it. If that tears these cells, the iteration begins with no displacement, and pins move together with the rest of the body
/// during the iterations. Returns the error of the model, for use if these iterations fail.
pub(super) fn begin<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<Option<StepError>, StepError> {
    let error = match begin_with_pins(system, workspace, balance) {
        Ok(()) => return Ok(None),
        Err(error) => error,
    };
    let leads = |(target, u): (&f64, &f64)| !target.is_nan() && *u != 0.0;
    if !(matches!(error, StepError::Model { .. }) && workspace.pin_displacement.iter().zip(&workspace.u).any(leads)) {
        return Err(error);
    }
    workspace.u.fill(0.0);
    match evaluate(system, workspace, balance, false) {
        Ok(()) => Ok(Some(error)),
        // The pins did not tear the body.
        Err(_) => Err(error),
    }
}

/// Evaluates the initial guess with pins at their final positions.
fn begin_with_pins<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<(), StepError> {
    if balance.sigma == 0.0 {
        return evaluate(system, workspace, balance, false);
    }
    for k in 0..workspace.u.len() {
        workspace.trial[k] = if workspace.pin_displacement[k].is_nan() { 0.0 } else { workspace.pin_displacement[k] };
    }
    let here = match evaluate(system, workspace, balance, true) {
        Ok(()) => potential(system, workspace, balance, true).map(|(energy, _)| energy),
        Err(_) => None,
    };
    let there = evaluate(system, workspace, balance, false);
    let better = match (here, &there) {
        (None, _) => return there,
        (Some(_), Err(_)) => true,
        (Some(here), Ok(())) => !potential(system, workspace, balance, false).is_some_and(|(there, _)| there <= here),
    };
    if better {
        for k in 0..workspace.u.len() {
            workspace.u[k] = if workspace.pin_displacement[k].is_nan() { 0.0 } else { workspace.pin_displacement[k] };
        }
        evaluate(system, workspace, balance, false)?;
    }
    Ok(())
}
