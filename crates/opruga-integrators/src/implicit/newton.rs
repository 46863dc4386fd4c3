//! Newton's method on the balance of forces of a stage.

use super::approach::part_without_inertia;
use super::beginning::begin;
use super::contact::Verdict;
use super::contact_derivatives::Sight;
use super::direction::{Keep, find_direction};
use super::falling::Falling;
use super::line_search::{Stretches, line_search, slope_along};
use super::linear::{Filter, Mixture, is_matrix_free};
use super::room::Room;
use super::rounding::{at_rounding, carries, chance, in_doubt, most_rounding, settle, visible};
use super::settings::Settings;
use super::whole;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_math::Lane;

/// The balance of a stage: σ M (u − y) = F(x₀ + u, β (u − z)) at a time after the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// The factor of the mass [1/s²].
    pub(crate) sigma: f64,
    /// The factor of displacements in velocities [1/s].
    pub(crate) beta: f64,
    /// Which part of the way to the end of the step the stage is.
    pub(crate) theta: f64,
    /// The time of the stage after the start of the step [s].
    pub(crate) time: f64,
    /// The length of the step [s].
    pub(crate) h: f64,
    /// The part of the weight and of the loads that acts.
    pub(crate) load: f64,
    /// The change of momentum in the step by a force that acts in this stage alone, in units of force times h, and what the rule
    /// will still add to it out of what it remembers.
    pub(crate) impulse: f64,
    pub(crate) echo: f64,
}

/// How the iteration ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    pub(crate) iterations: u32,
    pub(crate) products: u32,
    /// The largest displacement of a node in the last iteration [m].
    pub(crate) correction: f64,
    pub(crate) converged: bool,
    /// What is left of the forces would still move a node by [m], where it is rounding and that is much.
    pub(crate) blur: f64,
    /// The forces that rounding of positions makes, over the loads, where they matter.
    pub(crate) conditioning: f64,
    /// The rounding of positions [m], the largest of a force [N] and what that would move a node by [m], where it did not converge.
    pub(crate) floor: [f64; 3],
    /// Whether what is left may have made energy.
    pub(crate) doubtful: bool,
}

/// Corrections that fall by less than this in an iteration fall slowly.
const SLOW: f64 = 0.03;

/// From this iteration on contacts stay as they are: those that still change differ by little.
const MOST_DECISIONS: u32 = 30;

/// From this iteration on forces that are as small as their rounding are a balance, whether it carries the loads or not.
const MOST_AT_ROUNDING: u32 = 50;

/// Looks for the stage from the displacement in `room.u` on; on success forces and residual belong to what is found.
pub(crate) fn solve<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
) -> Result<Solved, StepError> {
    let mut solved = Solved::default();
    let goal = settings.tolerance * room.extent;
    let mut size: f64 = 0.0;
    for x in &room.x0 {
        size = x.abs().larger(size);
    }
    let torn = begin(system, room, balance)?;
    room.linear.begin();
    room.rigid.begin();
    room.mixing.begin(room.u.len());
    room.friction.begin(if system.contacts.is_some() { system.nodes } else { 0 });
    let mut first_norm = 0.0;
    // What the next direction is made of first, and the correction of the last iteration that went all of its way.
    let (mut first, mut before) = (Keep::Exact, f64::INFINITY);
    let mut falling = Falling::new();
    while solved.iterations < settings.iterations {
        system.go_on()?;
        solved.iterations += 1;
        // Which nodes are held, and how far they have to go.
        let mut changed = look(system, room, balance, true);
        let farthest = room.contacting.hold(
            &room.u,
            balance.theta,
            &room.held,
            &room.x0,
            &mut room.free,
            &mut room.projectors,
            &mut room.prescribed,
        );
        let moves = farthest > 0.0;

        // The direction; the exact derivatives as long as they are positive definite.
        let mut keep = first;
        let direction = loop {
            match find_direction(system, room, balance, settings, keep, moves, &mut first_norm) {
                Ok((products, slope)) => {
                    solved.products += products;
                    if slope <= 0.0 || !moves && keep != Keep::Exact {
                        break Some(slope);
                    }
                }
                Err(products) => solved.products += products,
            }
            match keep.next() {
                Some(next) => keep = next,
                None => break None,
            }
        };
        let Some(mut slope) = direction else { break };
        if keep != Keep::Exact {
            first = Keep::Clamped;
        }

        let plain = longest(&room.step, D);
        solved.correction = plain;
        let mut gone = plain;
        if balance.sigma == 0.0 {
            // Without inertia a soft direction leads far.
            let part = part_without_inertia(system, room, balance, plain);
            room.step.iter_mut().for_each(|s| *s *= part);
            gone *= part;
            slope *= part;
        }
        // What the matrix leaves out shows where corrections fall slowly.
        if changed {
            room.mixing.forget();
        }
        let mixed = mix(room, plain > SLOW * before, &mut slope);
        // With inertia rounding is reached where a correction does not halve the one before any more.
        let halves = solved.iterations == 1 || before.is_finite() && plain <= 0.5 * before;
        let nears = balance.sigma != 0.0 && halves;
        before = plain;
        falling.note(plain, keep != Keep::Exact && !mixed);
        let mut length = 1.0;
        if plain <= goal {
            full_step(system, room, balance)?;
        } else {
            // What is too stiff and has not far to go to obstacles may go on, unless it falls towards them without inertia.
            let falls = balance.sigma == 0.0 && system.contacts.is_some();
            let stiff = keep != Keep::Exact && !falls;
            let stretches = if stiff && farthest <= 1e-3 * room.extent && !room.contacting.any_turns() {
                falling.stretches(room.extent)
            } else {
                Stretches::No
            };
            length = line_search(system, room, balance, slope, stretches)?;
            gone *= length;
            if length > 1.0 {
                falling.stretched();
            }
            if length != 1.0 {
                room.mixing.forget();
                before = f64::INFINITY;
            }
        }
        let stuck = length == 0.0 && !changed;
        if stuck {
            if at_rounding(system, room, balance, settings, size)
                && whole::accepts(system, room, balance, settings, size, true)?
            {
                solved.converged = true;
                solved.blur = settle(system, room, balance, settings)?;
                break;
            }
            // A stiffer matrix leads less far, and more surely downhill.
            match keep.next() {
                _ if mixed => {}
                Some(next) => first = next,
                None => break,
            }
        } else if keep != Keep::Exact && gone <= 1e-2 * room.extent {
            // Derivatives that were not positive may be so near the solution.
            first = Keep::Exact;
        }

        // What the constraints would take says who stays held.
        if system.contacts.is_some() && solved.iterations < MOST_DECISIONS {
            let verdict = judge(system, room, balance, settings, settings.tolerance, true);
            if verdict.anew {
                room.mixing.forget();
            }
            changed |= verdict.anew || verdict.unsettled;
        }
        let ends = !changed && !stuck;
        if ends && plain <= goal && whole::accepts(system, room, balance, settings, size, false)? {
            solved.converged = true;
            break;
        }
        let last = solved.iterations >= MOST_AT_ROUNDING.min(settings.iterations);
        let may_end = ends && (last || !nears);
        if may_end
            && at_rounding(system, room, balance, settings, size)
            && (last || carries(system, room, balance))
            && whole::accepts(system, room, balance, settings, size, true)?
        {
            solved.converged = true;
            solved.blur = settle(system, room, balance, settings)?;
            break;
        }
    }
    if !solved.converged {
        solved.floor = most_rounding(system, room, balance, settings, size);
    }
    if solved.converged {
        solved.conditioning = room.rigid.conditioning;
        let doubt = in_doubt(system, room, balance, settings, size);
        let suspected = doubt.way.larger(solved.blur);
        if suspected > 0.0 {
            let left = left_over(system, room, balance, settings);
            let chance = if doubt.lost { chance(system, room, balance, settings, size) } else { 0.0 };
            solved.blur = left.map_or(suspected, |left| visible(left.larger(chance.smaller(suspected)), room.extent));
        }
    }
    torn.filter(|_| !solved.converged).map_or(Ok(solved), Err)
}

/// How far what is left out of balance would move a node by the matrix of what was found [m]: what was suspected on the way there went by
/// an earlier one. Nothing without a positive one, or on obstacles.
fn left_over<const D: usize>(
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
) -> Option<f64> {
    if room.contacting.any() {
        return None;
    }
    find_direction(system, room, balance, settings, Keep::Exact, false, &mut 0.0).ok()?;
    Some(longest(&room.step, D))
}

/// The longest way of a node.
pub(super) fn longest(step: &[f64], dimension: usize) -> f64 {
    let mut longest: f64 = 0.0;
    for node in step.chunks_exact(dimension) {
        longest = node.iter().map(|x| x * x).sum::<f64>().larger(longest);
    }
    longest.sqrt()
}

/// Notes an iteration and, where that is asked for, makes of its step the one that it and those before lead to; says whether
/// it did.
fn mix<const D: usize>(room: &mut Room<D>, wanted: bool, slope: &mut f64) -> bool {
    room.mixing.note(&room.u, &room.step);
    if !wanted || room.mixing.is_empty() {
        return false;
    }
    room.trial.copy_from_slice(&room.step);
    room.mixing.mix(&mut room.step);
    Filter { free: &room.free, projectors: &room.projectors }.apply(&mut room.step);
    for (s, p) in room.step.iter_mut().zip(&room.prescribed) {
        *s += p;
    }
    let found = slope_along(room);
    if found < 0.0 {
        *slope = found;
        return true;
    }
    room.step.copy_from_slice(&room.trial);
    false
}

pub(crate) fn look<const D: usize>(
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    impacts_slide: bool,
) -> bool {
    let Room { contacting, x0, u, extent, .. } = room;
    let sight = Sight::new(system, balance, x0, u, *extent);
    contacting.look(&sight, impacts_slide)
}

/// Decides anew who is held, and how, from what the constraints would take.
pub(crate) fn judge<const D: usize>(
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    tolerance: f64,
    yields: bool,
) -> Verdict {
    let Room { contacting, reaction, x0, u, extent, linear, mass, .. } = room;
    let sight = Sight::new(system, balance, x0, u, *extent);
    let mixture = mixture(system, mass, balance, Definiteness::Clamped, settings);
    contacting.judge(reaction, &sight, tolerance, &|node| {
        if yields { linear.size_at(&mixture, node) / D as f64 } else { 0.0 }
    })
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
        stage: Room::<D>::STAGE,
        time: balance.time,
        keep,
        matrix_free: is_matrix_free(settings.solver),
    }
}

/// The forces at x₀ + u (or at the trial), and what is out of balance.
pub(crate) fn evaluate<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    trial: bool,
) -> Result<(), StepError> {
    let u: &[f64] = if trial { &room.trial } else { &room.u };
    Room::show(system, &room.x0, u, &room.z, balance.beta);
    system.evaluate(Room::<D>::STAGE, balance.time, 0.0, &mut room.force)?;
    let Room { mass, y, force, residual, trial: tried, u, way, .. } = &mut *room;
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
        way.clear();
        way.extend(u.iter().zip(&*y).map(|(u, y)| u - y));
        for node in 0..system.nodes {
            let product = inertia.product::<D>(node, way);
            for d in 0..D {
                residual[node * D + d] += balance.sigma * product[d];
            }
        }
    }
    if balance.load != 1.0 {
        system.outer_forces(Room::<D>::STAGE, balance.time, &mut room.outer);
        for node in 0..system.nodes {
            for d in 0..D {
                room.residual[node * D + d] += (1.0 - balance.load) * room.outer.0[d][node];
            }
        }
    }
    Ok(())
}

fn full_step<const D: usize>(system: &mut System<D>, room: &mut Room<D>, balance: &Balance) -> Result<(), StepError> {
    for (u, s) in room.u.iter_mut().zip(&room.step) {
        *u += s;
    }
    evaluate(system, room, balance, false)
}
