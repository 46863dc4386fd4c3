//! What steps that count though they did not converge may do: a body that such steps have blown up is refused.

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

/// How large a body may become by steps that did not converge, in its sizes when it was first stepped.
const LARGEST: f64 = 100.0;

/// Refuses the end of a step, in `workspace.u1`, that did not converge and is beyond every measure.
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
    // Written so that what is no number is too large.
    if (0..D).all(|d| high[d] - low[d] <= largest) {
        return Ok(());
    }
    Err(refused(StepHint::Grown {}))
}
