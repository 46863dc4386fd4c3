//! A step along the curve of equilibria.
//!
//! Obstacles hold nodes as in every other step of statics: who is held is decided anew in every iteration, so the curve has a
//! kink where a node comes to a surface or leaves it, and the way of a step leads around it.

use super::{COMPLETE, Equilibrium, Reached, SPEC};
use crate::implicit::contact_derivatives::Sight;
use crate::implicit::linear::Filter;
use crate::implicit::newton::{Balance, Solved, evaluate, judge, look, mixture, wanted_forces};
use crate::implicit::room::Room;
use crate::implicit::step::report;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_solve::{Indefinite, dot};

/// Halvings of the way of a step at most.
const MOST_HALVINGS: u32 = 10;

/// Iterations of a step at most, alone and on obstacles, whose friction follows slowly: more mean that the way is too long.
const ITERATIONS: u32 = 25;
const ITERATIONS_ON_OBSTACLES: u32 = 60;

/// Goes a way along the curve from the state at the start of the step and `load`; `room.u` is then the displacement. Gives
/// the load, which is 1 where the end was reached.
pub(super) fn follow<const D: usize>(
    rule: &Equilibrium,
    system: &mut System<D>,
    room: &mut Room<D>,
    length: f64,
    load: f64,
    h: f64,
) -> Result<f64, StepError> {
    if load == 0.0 && system.contacts.is_some() {
        // A body that begins in an obstacle comes to its surface before there is any load.
        rule.balance(system, room, Reached { load, held: 1.0, time: h }, h)?;
    }
    let start = room.u.clone();
    let mut way = length * (system.nodes as f64).sqrt();
    let mut solved = Solved::default();
    for _ in 0..=MOST_HALVINGS {
        room.u.copy_from_slice(&start);
        if let Some(reached) = one_step(rule, system, room, way, load, h, &mut solved)? {
            system.work.solver.steps += 1;
            system.work.solver.iterations += u64::from(solved.iterations);
            system.work.solver.linear_iterations += u64::from(solved.iterations);
            if reached < 1.0 {
                return Ok(reached);
            }
            // Past the end: the equilibrium under the whole load is near.
            rule.balance(system, room, Reached { load: 1.0, held: 1.0, time: h }, h)?;
            system.history.numbers[COMPLETE] = 1.0;
            return Ok(1.0);
        }
        way *= 0.5;
    }
    report(SPEC.kind, &rule.settings, system, room, &Solved { converged: false, ..solved })?;
    Ok(load)
}

/// Newton's method for displacement and load on |Δu| = way; none where it does not converge.
fn one_step<const D: usize>(
    rule: &Equilibrium,
    system: &mut System<D>,
    room: &mut Room<D>,
    way: f64,
    load: f64,
    h: f64,
    solved: &mut Solved,
) -> Result<Option<f64>, StepError> {
    let start = room.u.clone();
    let mut now = load;
    let mut gone = vec![0.0; start.len()];
    let goal = rule.settings.tolerance * room.extent;
    room.contacting.clear(system.nodes);
    // Whether the step ends at the whole load, and not after its way.
    let mut ends = false;
    for iteration in 0..if system.contacts.is_some() { ITERATIONS_ON_OBSTACLES } else { ITERATIONS } {
        solved.iterations += 1;
        let balance = Balance { sigma: 0.0, beta: 0.0, theta: 1.0, time: h, h, load: now, impulse: 1.0, echo: 0.0 };
        if evaluate(system, room, &balance, false).is_err() {
            return Ok(None);
        }
        system.outer_forces(Room::<D>::STAGE, h, &mut room.outer);
        let mut changed = look(system, room, &balance, true);
        let Ok((correction, tangent)) = directions(rule, system, room, &balance) else { return Ok(None) };
        let leans = room.contacting.any();
        let mut step;
        if iteration == 0 {
            // On from where the last step has led; the first step puts load on.
            let last: f64 = (0..tangent.len()).map(|k| system.history.columns[0].0[k % D][k / D] * tangent[k]).sum();
            let size = dot(&tangent, &tangent).sqrt();
            if size.is_nan() || size == 0.0 && !leans {
                return Ok(None);
            }
            step = if last < 0.0 { -way / size } else { way / size };
        } else {
            // 2 Δu·(δu + δλ u_t) = way² − |Δu|²
            let across = dot(&gone, &tangent);
            if across == 0.0 && !leans {
                return Ok(None);
            }
            step = (0.5 * (way * way - dot(&gone, &gone)) - dot(&gone, &correction)) / across;
        }
        // What leans on obstacles may not get so far, whatever the load: then the step puts on what is left of it.
        ends |= leans && (now + step > 1.0 || step.is_nan());
        if ends {
            step = 1.0 - now;
        }
        let mut largest: f64 = 0.0;
        for k in 0..gone.len() {
            let change = correction[k] + step * tangent[k];
            largest = if change.abs() > largest { change.abs() } else { largest };
            room.step[k] = change;
            gone[k] += change;
        }
        if iteration > 0 {
            solved.correction = largest;
        }
        now += step;
        if !now.is_finite() || gone.iter().any(|x| !x.is_finite()) || dot(&gone, &gone) > 100.0 * way * way {
            return Ok(None);
        }
        for k in 0..gone.len() {
            room.u[k] = start[k] + gone[k];
        }
        if system.contacts.is_some() {
            // What the constraints take after the step: r + K Δu − Δλ F_outer.
            let mixture = mixture(system, &room.mass, &balance, Definiteness::Exact, &rule.settings);
            room.linear.multiply(&mixture, &room.step, &mut room.reaction);
            for k in 0..gone.len() {
                room.reaction[k] += room.residual[k] - step * room.outer.0[k % D][k / D];
            }
            let verdict = judge(system, room, &balance, &rule.settings, rule.settings.tolerance, true);
            changed |= verdict.anew || verdict.unsettled;
        }
        if iteration > 0 && !changed && solved.correction <= goal {
            let balance = Balance { load: now, ..balance };
            return Ok(evaluate(system, room, &balance, false).is_ok().then_some(now));
        }
    }
    Ok(None)
}

/// What leads to the balance under the load that is on, ways to surfaces included, and the displacement by the whole load,
/// K⁻¹ F_outer, whatever the signs of the eigenvalues of K.
fn directions<const D: usize>(
    rule: &Equilibrium,
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
) -> Result<(Vec<f64>, Vec<f64>), Indefinite> {
    let Room { contacting, linear, mass, free, projectors, prescribed, residual, outer, .. } = room;
    let farthest = contacting.hold(&room.u, 1.0, &room.held, &room.x0, free, projectors, prescribed);
    let mixture = mixture(system, mass, balance, Definiteness::Exact, &rule.settings);
    linear.assemble(&mixture);
    let sight = Sight::new(system, balance, &room.x0, &room.u, room.extent);
    contacting.derivatives(&sight, false, &mut |node, block| linear.add_block(&mixture, node, &block));
    let filter = Filter { free, projectors };
    linear.factor(&filter)?;
    let ways = (farthest > 0.0).then_some(&**prescribed);
    let room_for = [&mut room.trial[..], &mut room.right[..]];
    wanted_forces(system.threads, &mixture, linear, contacting, residual, ways, room_for);
    let mut correction = room.right.clone();
    let mut tangent: Vec<f64> = (0..correction.len()).map(|k| outer.0[k % D][k / D]).collect();
    for vector in [&mut correction, &mut tangent] {
        filter.apply(vector);
        linear.solve_by_factors(vector)?;
        filter.apply(vector);
    }
    for (way, prescribed) in correction.iter_mut().zip(&*prescribed) {
        *way += prescribed;
    }
    Ok((correction, tangent))
}
