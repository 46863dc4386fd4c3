//! Where an iteration begins.

use super::balance::Balance;
use super::stage::{evaluate, potential};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::system::System;

/// Evaluates where the iteration begins: where the motion leads or, where a body would be torn there, where it is.
///
/// Pins go to where they have to be at once, and leave the cells beside them the whole way, many times what is their share of it. Where
/// that alone tears these cells, it begins with nothing moved at all, and pins go their way with the rest of the body, in the
/// iterations. What the model has said is given, for the case that these lead nowhere.
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
        // It was not torn by the pins.
        Err(_) => Err(error),
    }
}

/// The same with pins where they have to be.
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
