//! How the end of a step responds to forces of other bodies: ∂x₁/∂f = (σM + βC + K)⁻¹/θ, in the free directions.

use super::balance::Balance;
use super::linear::{Filter, Mixture};
use super::stage::evaluate;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::integrator::next_matrix_number;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;

/// Factors the matrix of the step that has just ended, or the matrix that the minimiser keeps for later steps. Returns the
/// number of the matrix, or `None` if there is no matrix.
///
/// # Errors
/// [`StepError`] if a model refuses.
pub(crate) fn prepare<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    keeps_matrix: bool,
) -> Result<Option<u64>, StepError> {
    let Some((balance, start)) = workspace.answer.last else { return Ok(None) };
    if keeps_matrix && take_kept(workspace, &balance) {
        return Ok(Some(workspace.answer.number));
    }
    begin(workspace, &balance);
    let end = std::mem::replace(&mut system.time, start);
    let outcome = evaluate(system, workspace, &balance, false).map(|()| factor(system, workspace, &balance));
    system.time = end;
    Ok(outcome?.then_some(workspace.answer.number))
}

/// Records the free directions, and assigns a number to the matrix that is made next.
fn begin<const D: usize>(workspace: &mut Workspace<D>, balance: &Balance) {
    let Workspace { answer, free, projectors, .. } = workspace;
    answer.free.clone_from(free);
    answer.projectors.clone_from(projectors);
    answer.theta = balance.theta;
    answer.origin = None;
    answer.by_factors = false;
    answer.number = next_matrix_number();
}

/// Copies the matrix that later steps share, unless it has already been copied. Returns whether the matrix has a factor.
fn take_kept<const D: usize>(workspace: &mut Workspace<D>, balance: &Balance) -> bool {
    let Workspace { answer, reused, free, projectors, .. } = &*workspace;
    let is_same = |node: usize| free[node] || answer.projectors[node] == projectors[node];
    if answer.origin.is_some()
        && (&answer.origin, answer.theta, &answer.free) == (&reused.origin, balance.theta, free)
        && (0..free.len()).all(is_same)
    {
        return true;
    }
    begin(workspace, balance);
    let Workspace { answer, reused, linear, free, projectors, .. } = workspace;
    answer.linear.take(linear);
    let has_factor = answer.linear.factor_positive(&Filter { free, projectors }).is_ok();
    answer.origin = reused.origin.clone().filter(|_| has_factor);
    answer.origin.is_some()
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
    // The end of a step is a minimum up to the tolerance, so the exact matrix is usually positive definite.
    for keep in [Definiteness::Exact, Definiteness::Clamped] {
        answer.linear.assemble(&Mixture { keep, ..mixture });
        if answer.linear.factor_positive(&filter).is_ok() {
            return true;
        }
    }
    answer.by_factors = true;
    answer.linear.factor(&filter).is_ok()
}

/// Replaces the forces in `count` consecutive vectors by the displacements that they cause at the end of the step. Returns
/// whether that was possible.
pub(crate) fn displace<const D: usize>(workspace: &Workspace<D>, vectors: &mut [f64], count: usize) -> bool {
    let answer = &workspace.answer;
    let filter = Filter::<D> { free: &answer.free, projectors: &answer.projectors };
    let size = D * answer.free.len();
    vectors.chunks_exact_mut(size).for_each(|vector| filter.apply(vector));
    if !answer.by_factors {
        answer.linear.solve_positive(vectors, count);
    } else if vectors.chunks_exact_mut(size).any(|vector| answer.linear.solve_by_factors(vector).is_err()) {
        return false;
    }
    vectors.chunks_exact_mut(size).for_each(|vector| filter.apply(vector));
    vectors.iter_mut().for_each(|x| *x /= answer.theta);
    vectors.iter().all(|x| x.is_finite())
}
