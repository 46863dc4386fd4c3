//! The guard against growth: refuses a body that has become too large in accepted but unconverged steps.

use super::balance::Solved;
use super::workspace::Workspace;
use crate::refusals::StepHint;
use opruga_core::error::StepError;
use opruga_core::history::PerBody;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::blocks::nodes;

/// The size of the body when it was first stepped [m].
pub(crate) const SIZE: PerBody<f64> = PerBody::new("growth.size");

/// The largest size that a body may reach through unconverged steps, relative to its size when it was first stepped.
const LARGEST: f64 = 100.0;

/// Refuses the end of an unconverged step, in `workspace.u1`, if the body has become too large.
pub(crate) fn check<const D: usize>(
    system: &mut System<D>,
    workspace: &Workspace<D>,
    solved: &Solved,
    refused: impl FnOnce(StepHint) -> StepError,
) -> Result<(), StepError> {
    let mut size = system.history.get(SIZE);
    if size <= 0.0 {
        size = workspace.extent;
        system.history.set(SIZE, size);
    }
    if solved.converged {
        return Ok(());
    }
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for (from, displacement) in nodes::<D>(&workspace.x0).iter().zip(nodes::<D>(&workspace.u1)) {
        for d in 0..D {
            low[d] = (from[d] + displacement[d]).smaller(low[d]);
            high[d] = (from[d] + displacement[d]).larger(high[d]);
        }
    }
    let largest = LARGEST * size;
    // Written so that NaN counts as too large.
    if (0..D).all(|d| high[d] - low[d] <= largest) {
        return Ok(());
    }
    Err(refused(StepHint::Grown {}))
}
