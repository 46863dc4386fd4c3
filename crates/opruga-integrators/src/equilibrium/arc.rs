//! A step along the curve of equilibria.

use super::{COMPLETE, Equilibrium, Reached, SPEC};
use crate::implicit::linear::Filter;
use crate::implicit::newton::{Balance, Solved, evaluate, mixture};
use crate::implicit::room::Room;
use crate::implicit::step::report;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_solve::{Indefinite, dot};

/// Halvings of the way of a step at most.
const MOST_HALVINGS: u32 = 10;

/// Iterations of a step at most: more mean that the way is too long.
const ITERATIONS: u32 = 25;

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
    let start = room.u.clone();
    room.contacting.hold(
        &room.u,
        1.0,
        &room.held,
        &room.x0,
        &mut room.free,
        &mut room.projectors,
        &mut room.prescribed,
    );
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
    for iteration in 0..ITERATIONS {
        solved.iterations += 1;
        let balance = Balance { sigma: 0.0, beta: 0.0, theta: 1.0, time: h, h, load: now, impulse: 1.0, echo: 0.0 };
        if evaluate(system, room, &balance, false).is_err() {
            return Ok(None);
        }
        system.outer_forces(Room::<D>::STAGE, h, &mut room.outer);
        let Ok((correction, tangent)) = directions(rule, system, room, &balance) else { return Ok(None) };
        let step;
        if iteration == 0 {
            // On from where the last step has led; the first step puts load on.
            let last: f64 = (0..tangent.len()).map(|k| system.history.columns[0].0[k % D][k / D] * tangent[k]).sum();
            let size = dot(&tangent, &tangent).sqrt();
            if size.is_nan() || size == 0.0 {
                return Ok(None);
            }
            step = if last < 0.0 { -way / size } else { way / size };
            for k in 0..gone.len() {
                gone[k] = correction[k] + step * tangent[k];
            }
        } else {
            // 2 Δu·(δu + δλ u_t) = way² − |Δu|²
            let across = dot(&gone, &tangent);
            if across == 0.0 {
                return Ok(None);
            }
            step = (0.5 * (way * way - dot(&gone, &gone)) - dot(&gone, &correction)) / across;
            let mut largest: f64 = 0.0;
            for k in 0..gone.len() {
                let change = correction[k] + step * tangent[k];
                largest = if change.abs() > largest { change.abs() } else { largest };
                gone[k] += change;
            }
            solved.correction = largest;
        }
        now += step;
        if !now.is_finite() || gone.iter().any(|x| !x.is_finite()) || dot(&gone, &gone) > 100.0 * way * way {
            return Ok(None);
        }
        for k in 0..gone.len() {
            room.u[k] = start[k] + gone[k];
        }
        if iteration > 0 && solved.correction <= goal {
            let balance = Balance { load: now, ..balance };
            return Ok(evaluate(system, room, &balance, false).is_ok().then_some(now));
        }
    }
    Ok(None)
}

/// −K⁻¹ r and K⁻¹ F_outer, whatever the signs of the eigenvalues of K.
fn directions<const D: usize>(
    rule: &Equilibrium,
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
) -> Result<(Vec<f64>, Vec<f64>), Indefinite> {
    let Room { linear, mass, free, projectors, residual, outer, .. } = room;
    let mixture = mixture(system, mass, balance, Definiteness::Exact, &rule.settings);
    linear.assemble(&mixture);
    let filter = Filter { free, projectors };
    linear.factor(&filter)?;
    let mut correction: Vec<f64> = residual.iter().map(|r| -r).collect();
    let mut tangent: Vec<f64> = (0..correction.len()).map(|k| outer.0[k % D][k / D]).collect();
    for vector in [&mut correction, &mut tangent] {
        filter.apply(vector);
        linear.solve_by_factors(vector)?;
        filter.apply(vector);
    }
    Ok((correction, tangent))
}
