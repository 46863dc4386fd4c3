//! Newton's method on the balance of forces of a stage.

use super::approach::part_without_inertia;
use super::balance::{Balance, Solved};
use super::beginning::begin;
use super::direction::{Keep, find_direction};
use super::falling::Falling;
use super::line_search::{Stretches, line_search, slope_along};
use super::linear::Filter;
use super::room::Room;
use super::rounding::{at_rounding, carries, chance, in_doubt, most_rounding, settle, visible};
use super::settings::Settings;
use super::stage::{evaluate, judge, longest, look};
use super::whole;
use opruga_core::error::StepError;
use opruga_core::system::System;
use opruga_math::Lane;

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

fn full_step<const D: usize>(system: &mut System<D>, room: &mut Room<D>, balance: &Balance) -> Result<(), StepError> {
    for (u, s) in room.u.iter_mut().zip(&room.step) {
        *u += s;
    }
    evaluate(system, room, balance, false)
}
