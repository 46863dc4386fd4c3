//! Equilibria whose forces are as small as their rounding.

use super::balance::Balance;
use super::linear::{Filter, LINEAR_TOLERANCE, Linear, Mixture};
use super::settings::Settings;
use super::stage::{evaluate, longest, mixture};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::dot;

/// The rounding of a force, in units of stiffness times size.
const ROUNDING: f64 = 4e-15;

/// If another iteration would move a node by more than the first fraction of the extent, that displacement is reduced. A
/// displacement above the second fraction is reported.
const LEFT: f64 = 1e-8;
const VISIBLE: f64 = 1e-7;

/// The fraction of the loads that statics may leave as a residual.
const UNCARRIED: f64 = 1e-2;

/// Loads below this fraction of the largest rounding of forces may be lost in the rounding.
const LOST: f64 = 1e-2;

/// The typical rounding of a force, as a fraction of the largest.
const TYPICAL: f64 = 0.02;

/// The largest number of iterations that reduce the remaining displacement.
const MOST_ROUNDS: usize = 8;

/// Whether the residual is no more than the rounding of the forces.
pub(super) fn at_rounding<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) -> bool {
    take_residual(workspace);
    let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
    workspace.right.as_chunks::<D>().0.iter().enumerate().all(|(node, rest)| {
        let floor = floor(&workspace.linear, &mixture, node, size);
        rest.iter().all(|r| r.abs() <= floor)
    })
}

/// Continues the iteration in statics if the residual is as small as rounding but would still visibly move a node. Stops when a
/// further correction does not halve that displacement. The displacement is small in a stout body, but large in a body that is
/// stiff lengthwise and soft sideways. Returns the remaining displacement of a node [m], or zero if this displacement is not
/// visible. Call this after [`at_rounding`], which leaves the residual in `workspace.right`.
pub(super) fn settle<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Result<f64, StepError> {
    if balance.sigma != 0.0 {
        return Ok(0.0);
    }
    let Some(mut left) = correction(system, workspace, balance, settings) else { return Ok(0.0) };
    for _ in 0..MOST_ROUNDS {
        if left <= LEFT * workspace.extent {
            return Ok(0.0);
        }
        workspace.trial.copy_from_slice(&workspace.u);
        for (u, step) in workspace.u.iter_mut().zip(&workspace.step) {
            *u -= step;
        }
        evaluate(system, workspace, balance, false)?;
        take_residual(workspace);
        let next = correction(system, workspace, balance, settings).filter(|next| *next < left);
        let Some(next) = next else {
            workspace.u.copy_from_slice(&workspace.trial);
            evaluate(system, workspace, balance, false)?;
            break;
        };
        let halved = next <= 0.5 * left;
        left = next;
        if !halved {
            break;
        }
    }
    Ok(visible(left, workspace.extent))
}

/// The displacement if it is visible in a body of this extent, otherwise zero.
pub(super) fn visible(displacement: f64, extent: f64) -> f64 {
    if displacement > VISIBLE * extent { displacement } else { 0.0 }
}

/// Whether the residual of statics is a small fraction of the loads. If not, the residual may consist of rounding errors, which
/// far from the origin are as large as the loads. Further iterations average these errors out, or [`settle`] reduces them.
pub(super) fn carries<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>, balance: &Balance) -> bool {
    if balance.sigma != 0.0 {
        return true;
    }
    let loads = loads(system, workspace, balance);
    take_residual(workspace);
    loads == 0.0 || dot(&workspace.right, &workspace.right).sqrt() <= UNCARRIED * loads
}

/// Whether the residual of statics consists of the loads themselves. Rounding errors would have random directions instead of
/// the directions of the loads.
fn leaves<const D: usize>(workspace: &mut Workspace<D>, loads: f64) -> bool {
    take_residual(workspace);
    let nodes = workspace.right.as_chunks::<D>().0.iter().enumerate();
    let along: f64 = nodes.map(|(node, rest)| dot(rest, &workspace.outer.at(node))).sum();
    along.abs() > UNCARRIED * loads * loads
}

/// What makes an equilibrium of statics doubtful.
#[derive(Clone, Copy, Default)]
pub(super) struct Doubt {
    /// The largest displacement of a node [m], which is entirely uncertain. It is zero if there is no doubt.
    pub(super) displacement: f64,
    /// Whether the loads are so small that they are lost in the rounding of forces.
    pub(super) lost: bool,
}

/// Returns the doubt about an equilibrium of statics. There are two reasons for doubt. If loads are lost in the rounding of
/// forces, positions do not show what balances the loads. If loads remain as a residual, an artificially stiffened matrix has
/// failed.
pub(super) fn in_doubt<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) -> Doubt {
    let displacement = longest(&workspace.u, D);
    let loads = if balance.sigma == 0.0 && displacement > VISIBLE * workspace.extent {
        loads(system, workspace, balance)
    } else {
        0.0
    };
    if loads == 0.0 {
        return Doubt::default();
    }
    let lost = loads < LOST * most_rounding(system, workspace, balance, settings, size)[1];
    if lost || leaves(workspace, loads) { Doubt { displacement, lost } } else { Doubt::default() }
}

/// Three effects of rounding in a body at this distance from the origin: the rounding of positions [m], the largest rounding of
/// the force of a node [N], and the displacement [m] that such a force would cause against the inertia of the node.
pub(super) fn most_rounding<const D: usize>(
    system: &System<D>,
    workspace: &Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) -> [f64; 3] {
    let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
    let (mut force, mut displacement): (f64, f64) = (0.0, 0.0);
    for (node, mass) in workspace.mass.iter().enumerate() {
        let floor = floor(&workspace.linear, &mixture, node, size);
        force = floor.larger(force);
        displacement = (floor / (balance.sigma * mass)).larger(displacement);
    }
    [f64::EPSILON * size, force, if balance.sigma == 0.0 { 0.0 } else { displacement }]
}

/// How far rounding errors of the forces, which have random signs, may move a node [m], computed with the matrix of the result.
pub(super) fn random_error<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) -> f64 {
    let mixture = mixture(system, &workspace.mass, balance, Definiteness::Exact, settings);
    for (number, force) in workspace.right.iter_mut().enumerate() {
        // The highest bit of a product with the golden ratio gives signs that look random but are always the same.
        let sign = if (number as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 63 == 0 { 1.0 } else { -1.0 };
        *force = sign * TYPICAL * floor(&workspace.linear, &mixture, number / D, size);
    }
    Filter { free: &workspace.free, projectors: &workspace.projectors }.apply(&mut workspace.right);
    correction(system, workspace, balance, settings).unwrap_or(f64::INFINITY)
}

/// How far a force that consists of rounding errors would move a node against its inertia [m]. The stiffness of the node is its
/// mass times the factor `contrast`.
pub(super) fn roundings_of(contrast: f64, size: f64) -> f64 {
    ROUNDING * contrast * size
}

/// The size of the forces in the free directions that rounding of positions causes, with the last matrix: the root of the sum
/// of their squares [N]. Inertia forces depend on displacements, whose rounding is smaller.
pub(super) fn rounding_of_forces<const D: usize>(workspace: &Workspace<D>, mixture: &Mixture<D>) -> f64 {
    let Workspace { linear, x0, free, projectors, .. } = workspace;
    let size = x0.iter().fold(0.0, |most: f64, x| x.abs().larger(most));
    let mut square = 0.0;
    for (node, (free, projector)) in free.iter().zip(projectors).enumerate() {
        let directions = if *free { D as f64 } else { (0..D).map(|d| projector[d][d]).sum() };
        let force = f64::EPSILON * size * linear.stiffness_at(mixture, node) / D as f64;
        square += directions * force * force;
    }
    square.sqrt()
}

/// The largest rounding of the force of a node [N], in a body at this distance from the origin.
fn floor<const D: usize>(linear: &Linear<D>, mixture: &Mixture<D>, node: usize, size: f64) -> f64 {
    ROUNDING * linear.size_at(mixture, node) * size
}

/// The loads and the weight, as the root of the sum of their squares [N].
fn loads<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>, balance: &Balance) -> f64 {
    system.outer_forces(Workspace::<D>::STAGE, balance.time, &mut workspace.outer);
    (0..system.nodes).flat_map(|node| workspace.outer.at(node)).map(|f| f * f).sum::<f64>().sqrt()
}

/// Writes the residual in the free directions to `workspace.right`.
fn take_residual<const D: usize>(workspace: &mut Workspace<D>) {
    workspace.right.copy_from_slice(&workspace.residual);
    workspace.contacting.subtract_friction(&mut workspace.right);
    Filter { free: &workspace.free, projectors: &workspace.projectors }.apply(&mut workspace.right);
}

/// Writes the displacement due to the residual, computed with the last matrix, to `workspace.step`. Returns the largest
/// displacement of a node [m].
fn correction<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Option<f64> {
    let Workspace { linear, mass, free, projectors, right, step, .. } = workspace;
    let mixture = mixture(system, mass, balance, Definiteness::Exact, settings);
    let filter = Filter { free, projectors };
    linear.solve_again(&mixture, &filter, settings, LINEAR_TOLERANCE, right, step).ok()?;
    filter.apply(step);
    Some(longest(step, D))
}
