//! How the end of a step answers to forces of other bodies: ∂x₁/∂f = (σM + βC + K)⁻¹/θ, in the directions that are free.

use super::balance::Balance;
use super::linear::{Filter, Mixture};
use super::stage::evaluate;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;

/// Factors the matrix of the step that was made last; says whether there is one.
///
/// # Errors
/// [`StepError`] where a model refuses.
pub(crate) fn prepare<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>) -> Result<bool, StepError> {
    let Some((balance, start)) = workspace.answer.last else { return Ok(false) };
    let end = std::mem::replace(&mut system.time, start);
    let outcome = evaluate(system, workspace, &balance, false).map(|()| factor(system, workspace, &balance));
    system.time = end;
    outcome
}

fn factor<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>, balance: &Balance) -> bool {
    let Workspace { answer, mass, free, projectors, .. } = workspace;
    let mixture = Mixture {
        system,
        sigma: balance.sigma,
        beta: balance.beta,
        load: 1.0,
        mass,
        stage: Workspace::<D>::STAGE,
        time: balance.time,
        keep: Definiteness::Exact,
        matrix_free: false,
    };
    let filter = Filter { free, projectors };
    answer.free.clone_from(free);
    answer.projectors.clone_from(projectors);
    answer.theta = balance.theta;
    // At the end of a step the exact derivatives are those of a minimum, but for what the tolerance leaves.
    for keep in [Definiteness::Exact, Definiteness::Clamped] {
        answer.linear.assemble(&Mixture { keep, ..mixture });
        answer.by_factors = false;
        if answer.linear.factor_positive(&filter).is_ok() {
            return true;
        }
    }
    answer.by_factors = true;
    answer.linear.factor(&filter).is_ok()
}

/// Replaces forces by displacements of the end; says whether that could be done.
pub(crate) fn displace<const D: usize>(workspace: &Workspace<D>, vector: &mut [f64]) -> bool {
    let answer = &workspace.answer;
    let filter = Filter::<D> { free: &answer.free, projectors: &answer.projectors };
    filter.apply(vector);
    if !answer.by_factors {
        answer.linear.solve_positive(vector);
    } else if answer.linear.solve_by_factors(vector).is_err() {
        return false;
    }
    filter.apply(vector);
    vector.iter_mut().for_each(|x| *x /= answer.theta);
    vector.iter().all(|x| x.is_finite())
}
