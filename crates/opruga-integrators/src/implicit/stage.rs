//! The evaluation of a stage: its forces, residual, matrix, incremental potential and contacts.

use super::balance::Balance;
use super::contact::Verdict;
use super::contact_query::ContactQuery;
use super::friction::SlipRule;
use super::linear::{Mixture, is_matrix_free};
use super::settings::Settings;
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_math::Lane;

/// The rounding error of an energy, as a fraction of the terms whose difference it is. If a law subtracts the energy at rest,
/// this error can exceed the energy of a stiff body.
pub(super) const CANCELLATION: f64 = 1e-15;

/// The largest displacement of a node.
pub(crate) fn longest(step: &[f64], dimension: usize) -> f64 {
    let mut longest: f64 = 0.0;
    for node in step.chunks_exact(dimension) {
        longest = node.iter().map(|x| x * x).sum::<f64>().larger(longest);
    }
    longest.sqrt()
}

/// Searches for contacts of the nodes. Returns whether the set of held nodes has changed.
pub(crate) fn look<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    impacts_slide: bool,
) -> bool {
    let Workspace { contacting, x0, u, pin_displacement, extent, .. } = workspace;
    let contact_query = ContactQuery::new(system, balance, [x0, u, pin_displacement], *extent);
    contacting.look(&contact_query, impacts_slide)
}

/// Decides which nodes are held, and how, from the forces of the constraints.
pub(crate) fn judge<const D: usize>(
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    rule: SlipRule,
) -> Verdict {
    let Workspace { contacting, reaction, x0, u, pin_displacement, extent, linear, mass, .. } = workspace;
    let contact_query = ContactQuery::new(system, balance, [x0, u, pin_displacement], *extent);
    let mixture = mixture(system, mass, balance, Definiteness::Clamped, settings);
    contacting.judge(reaction, &contact_query, rule, &|node| linear.size_at(&mixture, node) / D as f64)
}

pub(crate) fn mixture<'a, const D: usize>(
    system: &'a System<D>,
    mass: &'a [f64],
    balance: &Balance,
    keep: Definiteness,
    settings: &Settings,
) -> Mixture<'a, D> {
    Mixture {
        system,
        sigma: balance.sigma,
        beta: balance.beta,
        load: balance.load,
        mass,
        stage: Workspace::<D>::STAGE,
        time: balance.time,
        keep,
        matrix_free: is_matrix_free(settings.solver),
    }
}

/// Evaluates the forces at x₀ + u (or at the trial), and the residual.
pub(crate) fn evaluate<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    trial: bool,
) -> Result<(), StepError> {
    let u: &[f64] = if trial { &workspace.trial } else { &workspace.u };
    Workspace::show(system, &workspace.x0, u, &workspace.z, balance.beta);
    system.evaluate(Workspace::<D>::STAGE, balance.time, 0.0, &mut workspace.force)?;
    let Workspace { mass, y, force, residual, trial: tried, u, displacement, .. } = &mut *workspace;
    let u: &[f64] = if trial { tried } else { u };
    each_block(system.threads, D, [&mut *residual], |first, [residual]| {
        for (node, out) in (first / D..).zip(residual.as_chunks_mut::<D>().0) {
            for d in 0..D {
                let k = node * D + d;
                out[d] = balance.sigma * mass[node] * (u[k] - y[k]) - force.0[d][node];
            }
        }
    });
    if balance.sigma != 0.0
        && let Some(inertia) = &system.inertia
    {
        displacement.clear();
        displacement.extend(u.iter().zip(&*y).map(|(u, y)| u - y));
        for node in 0..system.nodes {
            let product = inertia.product::<D>(node, displacement);
            for d in 0..D {
                residual[node * D + d] += balance.sigma * product[d];
            }
        }
    }
    if balance.load != 1.0 {
        system.outer_forces(Workspace::<D>::STAGE, balance.time, &mut workspace.outer);
        for node in 0..system.nodes {
            for d in 0..D {
                workspace.residual[node * D + d] += (1.0 - balance.load) * workspace.outer.0[d][node];
            }
        }
    }
    Ok(())
}

/// The rounding of the energies of the models [J].
pub(super) fn rounding_of_models<const D: usize>(system: &System<D>) -> f64 {
    CANCELLATION * system.members.iter().map(|member| member.potential.energy_parts()).sum::<f64>()
}

/// The incremental potential and the size of its terms [J].
pub(crate) fn potential<const D: usize>(
    system: &System<D>,
    workspace: &Workspace<D>,
    balance: &Balance,
    trial: bool,
) -> Option<(f64, f64)> {
    let energy = system.potential_energy(Workspace::<D>::STAGE, balance.time)?;
    let u = if trial { &workspace.trial } else { &workspace.u };
    let mut inertia = 0.0;
    for (node, mass) in workspace.mass.iter().enumerate() {
        for k in node * D..(node + 1) * D {
            let displacement = u[k] - workspace.y[k];
            inertia += mass * displacement * displacement;
        }
    }
    if balance.sigma != 0.0
        && let Some(coupled) = &system.inertia
    {
        // The displacement was computed when the forces were evaluated last.
        inertia += coupled.square::<D>(&workspace.displacement);
    }
    inertia *= 0.5 * balance.sigma;
    let mut lifted = 0.0;
    if balance.load != 1.0 {
        // The energy of the part of the weight and the loads that does not act yet.
        for node in 0..system.nodes {
            for d in 0..D {
                lifted += (1.0 - balance.load) * workspace.outer.0[d][node] * u[node * D + d];
            }
        }
    }
    Some((energy + inertia + lifted, energy.abs() + inertia + lifted.abs()))
}
