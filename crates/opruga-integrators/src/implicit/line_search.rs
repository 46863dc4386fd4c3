//! The length of a step along its direction.

use super::balance::Balance;
use super::linear::Filter;
use super::stage::{evaluate, potential, rounding_of_models};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::dot;

/// The fraction of the slope that may remain after a step of the line search.
const SLOPE_LEFT: f64 = 0.8;

/// A step is extended if the slope at its end is steeper than this fraction of the initial slope.
const STEEP: f64 = 0.3;
pub(super) const LONGEST_STRETCH: f64 = 16.0;

/// Energies count as equal if they differ by less than this fraction of their terms.
const ROUNDING: f64 = 1e-12;

/// Whether a step is extended if the slope at its end is still steep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stretches {
    No,
    /// The step may grow up to [`LONGEST_STRETCH`] times its length, as long as the energy falls.
    WhereEnergyFalls,
    /// The step may grow up to this many times its length, even if differences of energies are lost in rounding. Such a long
    /// step serves to leave an unstable equilibrium.
    UpTo(f64),
}

/// The approximate largest number of halvings of a step.
const MOST_TRIALS: usize = 14;

/// Moves along the step to a point at which the slope of the incremental potential has fallen and, if that potential is known,
/// the potential has not risen. Returns the fraction of the step.
pub(super) fn line_search<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    slope: f64,
    stretches: Stretches,
) -> Result<f64, StepError> {
    // Damping has no potential. The work of friction and constraints is included, with the forces that the constraints are
    // expected to exert.
    let before = if system.is_damped() { None } else { potential(system, workspace, balance, false) };
    let given = given_along(workspace);
    let cancelled = rounding_of_models(system);
    let mut length = 1.0;
    for _ in 0..MOST_TRIALS {
        for k in 0..workspace.u.len() {
            workspace.trial[k] = workspace.u[k] + length * workspace.step[k];
        }
        let allowed = evaluate(system, workspace, balance, true).is_ok();
        let now = if allowed { slope_along(workspace) } else { f64::NAN };
        // If the step is small, differences of energies are lost in rounding.
        let risen = match before {
            Some((energy, magnitude)) if allowed => {
                potential(system, workspace, balance, true).is_none_or(|(after, size)| {
                    let rounding = ROUNDING * (magnitude + size + (length * given).abs()) + cancelled;
                    let risen = after - length * given - energy;
                    risen.is_nan() || risen > rounding
                })
            }
            _ => false,
        };
        if allowed && now.is_finite() && now <= SLOPE_LEFT * slope.abs() && !risen {
            workspace.u.copy_from_slice(&workspace.trial);
            if length == 1.0 && stretches != Stretches::No && now < -STEEP * slope.abs() {
                let before = before.map(|(energy, _)| (energy, given));
                return stretch(system, workspace, balance, (slope, now), before, stretches);
            }
            return Ok(length);
        }
        let secant = slope.abs() / (slope.abs() + now);
        length *= if secant.is_finite() && !risen { secant.larger(0.1).smaller(0.6) } else { 0.4 };
    }
    // No progress: the state and the forces stay as they were.
    evaluate(system, workspace, balance, false)?;
    Ok(0.0)
}

/// Extends a step as long as it leads steeply downhill: a matrix without negative eigenvalues is too stiff where a body buckles
/// or an inverted cell recovers. Returns the length in steps.
fn stretch<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    (slope, mut now): (f64, f64),
    before: Option<(f64, f64)>,
    stretches: Stretches,
) -> Result<f64, StepError> {
    let mut length = 1.0;
    let (longest, rounding) = match stretches {
        Stretches::UpTo(longest) => (longest, ROUNDING),
        _ => (LONGEST_STRETCH, 0.0),
    };
    let mut last = before.and_then(|(_, given)| Some(potential(system, workspace, balance, false)?.0 - given));
    loop {
        // The secant of the slopes gives the next length, which is at most twice the previous one.
        let left = slope.abs() + now;
        let longer = length * if left > 0.0 { (slope.abs() / left).smaller(2.0) } else { 2.0 };
        for k in 0..workspace.u.len() {
            workspace.trial[k] = workspace.u[k] + (longer - length) * workspace.step[k];
        }
        let allowed = longer <= longest && evaluate(system, workspace, balance, true).is_ok();
        let beyond = if allowed { slope_along(workspace) } else { f64::NAN };
        let energy = match before {
            Some((_, given)) if allowed => potential(system, workspace, balance, true).map(|(e, _)| e - longer * given),
            _ => None,
        };
        let falls = match (energy, last) {
            (Some(energy), Some(last)) => energy - last < rounding * last.abs() || energy < last,
            _ => before.is_none(),
        };
        if !(falls && beyond <= STEEP * slope.abs()) {
            evaluate(system, workspace, balance, false)?;
            return Ok(length);
        }
        workspace.u.copy_from_slice(&workspace.trial);
        (length, now, last) = (longer, beyond, energy);
        if now >= -STEEP * slope.abs() {
            return Ok(length);
        }
    }
}

/// The slope, along the step, of the incremental potential minus the work of friction and constraints.
pub(super) fn slope_along<const D: usize>(workspace: &mut Workspace<D>) -> f64 {
    let given = given_along(workspace);
    dot(&workspace.residual, &workspace.step) - given
}

/// The work that friction and the constraints do along the step, with the forces that the constraints are expected to exert.
pub(super) fn given_along<const D: usize>(workspace: &mut Workspace<D>) -> f64 {
    // r − friction in the held directions.
    let Workspace { right, reaction, contacting, free, projectors, step, .. } = workspace;
    right.copy_from_slice(reaction);
    contacting.subtract_friction(right);
    let mut work = dot(right, step);
    Filter { free, projectors }.apply(right);
    work -= dot(right, step);
    // `right` becomes minus the friction forces, so subtracting its work adds that of friction.
    right.fill(0.0);
    contacting.subtract_friction(right);
    work - dot(right, step)
}
