//! Checks whether a body is balanced in its rigid motions at the end of an iteration, and balances it if not (file `rigid`).

use super::balance::Balance;
use super::linear::{EPSILON, Filter, HIDDEN, contrast};
use super::rigid::{Rigid, Stage};
use super::rounding::{at_rounding, roundings_of};
use super::settings::Settings;
use super::stage::{evaluate, longest, mixture};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_math::Lane;

/// The largest number of rigid displacements. Two are enough unless rotations are large.
const MOST_MOVES: usize = 8;

/// Whether the result of Newton's method is acceptable in the rigid motions. The rigid motions may be wrong if the matrix is
/// inaccurate in them, or if the residual was taken for rounding. In both cases the rigid motions are balanced first. `size` is
/// the size of coordinates [m].
pub(super) fn accepts<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
    by_rounding: bool,
) -> Result<bool, StepError> {
    if balance.sigma == 0.0 {
        return Ok(true);
    }
    let goal = settings.tolerance * workspace.extent;
    let stiff = {
        let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
        contrast(&workspace.linear, &mixture)
    };
    // How far a residual that counts as rounding on every node would move the whole body.
    let hidden = by_rounding && roundings_of(stiff, size) > goal;
    if !hidden && EPSILON * stiff <= HIDDEN {
        return Ok(true);
    }
    let Some(moved) = balance_rigid_motions(system, workspace, balance, settings, size, 0.0)? else { return Ok(false) };
    Ok(moved <= goal || at_rounding(system, workspace, balance, settings, size))
}

/// Moves the pieces of a body until a further move does not halve their total residual, which is then rounding. Pieces that
/// would move by no more than `least` [m] are not moved. Returns how far the pieces moved [m], or `None` if they could not be
/// brought closer to equilibrium.
pub(super) fn balance_rigid_motions<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
    least: f64,
) -> Result<Option<f64>, StepError> {
    let mut rigid = core::mem::take(&mut workspace.rigid);
    let outcome = balance_with(&mut rigid, system, workspace, balance, settings, size, least);
    workspace.rigid = rigid;
    outcome
}

fn balance_with<const D: usize>(
    rigid: &mut Rigid<D>,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
    least: f64,
) -> Result<Option<f64>, StepError> {
    rigid.find(&stage(system, workspace, balance, settings));
    let outer: Vec<usize> = rigid.outer(system).map(|(number, _)| number).collect();
    let mut left = sums(rigid, system, workspace, balance, settings);
    let (mut moved, mut tried, mut balanced): (f64, bool, bool) = (0.0, false, true);
    for _ in 0..MOST_MOVES {
        let shares: Vec<f64> = rigid.shares(&left).iter().map(|share| -share).collect();
        rigid.finite_displacements(&workspace.x0, &workspace.u, &shares, &mut workspace.step);
        Filter { free: &workspace.free, projectors: &workspace.projectors }.apply(&mut workspace.step);
        let displacement = longest(&workspace.step, D);
        // A fraction of the last digit of positions does not count as a displacement.
        let moves = displacement > (1e-3 * EPSILON * size).larger(least);
        if !moves {
            break;
        }
        workspace.trial.copy_from_slice(&workspace.u);
        for (u, step) in workspace.u.iter_mut().zip(&workspace.step) {
            *u += step;
        }
        // Models that exert forces only between nodes are not evaluated, because they do not change the sums and may take long.
        tried = true;
        Workspace::show(system, &workspace.x0, &workspace.u, &workspace.z, balance.beta);
        system.prepare_some(&outer, Workspace::<D>::STAGE, balance.time)?;
        let next = sums(rigid, system, workspace, balance, settings);
        let [before, now] = [&left, &next].map(|sums| sums.iter().map(|x| x * x).sum::<f64>());
        let falls = now < before;
        if !falls {
            workspace.u.copy_from_slice(&workspace.trial);
            // A displacement within the tolerance may remain if nothing reduces it.
            let allowed = (EPSILON * size).larger(least).larger(settings.tolerance * workspace.extent);
            balanced = moved != 0.0 || displacement <= allowed;
            break;
        }
        moved += displacement;
        left = next;
        if now > 0.25 * before {
            break;
        }
    }
    if tried {
        evaluate(system, workspace, balance, false)?;
    }
    if !balanced {
        return Ok(None);
    }
    note(rigid, system, workspace, balance, settings, size);
    Ok(Some(moved))
}

/// The stage that was evaluated last.
fn stage<'a, const D: usize>(
    system: &'a System<D>,
    workspace: &'a Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Stage<'a, D> {
    let Workspace { mass, x0, u, y, free, projectors, contacting, .. } = workspace;
    let mixture = mixture(system, mass, balance, Definiteness::Exact, settings);
    Stage { mixture, x0, u, y, filter: Filter { free, projectors }, contacting }
}

/// The total residual in the stage that was evaluated last.
fn sums<const D: usize>(
    rigid: &Rigid<D>,
    system: &System<D>,
    workspace: &Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Vec<f64> {
    rigid.sums(&workspace.x0, &workspace.u, &rigid.residual(&stage(system, workspace, balance, settings)))
}

/// Records the ratio of the forces due to rounding of positions to the loads, or to the forces that hold a rotating body
/// together.
fn note<const D: usize>(
    rigid: &mut Rigid<D>,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) {
    system.outer_forces(Workspace::<D>::STAGE, balance.time, &mut workspace.outer);
    let mut mean = [0.0; D];
    let total: f64 = workspace.mass.iter().sum();
    for (node, mass) in workspace.mass.iter().enumerate() {
        (0..D).for_each(|d| mean[d] += mass / total * workspace.v0[node * D + d]);
    }
    let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
    let (mut rounding, mut load): (f64, f64) = (0.0, 0.0);
    for (node, mass) in workspace.mass.iter().enumerate() {
        rounding = (EPSILON * size * workspace.linear.size_at(&mixture, node) / D as f64).larger(rounding);
        let force: f64 = workspace.outer.at(node).iter().map(|f| f * f).sum();
        load = force.sqrt().larger(load);
        let apart = |d: usize| workspace.v0[node * D + d] - mean[d];
        let square: f64 = (0..D).map(|d| apart(d) * apart(d)).sum();
        load = (mass * square / workspace.extent).larger(load);
    }
    if load > 0.0 {
        rigid.conditioning = rounding / load;
    }
}

/// Balances the rigid motions for the real-time setting, if the forces of the body were so small that they counted as zero, or
/// if its matrix is too inaccurate. Returns whether the whole body is balanced.
pub(super) fn settles<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    [nothing, little]: [f64; 2],
) -> Result<bool, StepError> {
    let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
    let stiff = contrast(&workspace.linear, &mixture);
    if EPSILON * stiff <= HIDDEN && nothing * stiff <= little {
        return Ok(true);
    }
    let size = workspace.x0.iter().fold(0.0, |most: f64, x| x.abs().larger(most));
    Ok(balance_rigid_motions(system, workspace, balance, settings, size, 0.0)?.is_some())
}
