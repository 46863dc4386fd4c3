//! A step along the curve of equilibria.
//!
//! Obstacles hold nodes as in every other step of statics: who is held is decided anew in every iteration, so the curve has a
//! kink where a node comes to a surface or leaves it, and the way of a step leads around it.
//!
//! Two points of the curve lie a way apart from where a step begins: one on, one back. Where the curve turns sharply the iteration
//! may find the one that it came from, and which way is on is told by the last step alone. So a step in which the curve
//! turns by more than 60° is gone again in halves, but for the kinks that obstacles make.

use super::{COMPLETE, DISPLACEMENT, Equilibrium, Reached, SPEC};
use crate::implicit::balance::{Balance, Solved};
use crate::implicit::contact_query::ContactQuery;
use crate::implicit::convergence::report;
use crate::implicit::direction::wanted_forces;
use crate::implicit::linear::Filter;
use crate::implicit::stage::{evaluate, judge, look, mixture};
use crate::implicit::workspace::Workspace;
use crate::refusals::Refusal;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_solve::{Indefinite, dot};

/// Halvings of the way of a step at most.
const MOST_HALVINGS: u32 = 10;

/// The cosine of the angle by which the curve may turn from step to step and within one.
const LEAST_COSINE: f64 = 0.5;

/// Iterations of a step at most: more mean that the way is too long.
const ITERATIONS: u32 = 25;

/// Goes a way along the curve from the state at the start of the step and `load`; `workspace.u` is then the displacement. Gives
/// the load, which is 1 where the end was reached.
pub(super) fn follow<const D: usize>(
    rule: &Equilibrium,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    length: f64,
    load: f64,
    h: f64,
) -> Result<f64, StepError> {
    if load == 0.0 && system.contacts.is_some() {
        // A body that begins in an obstacle comes to its surface before there is any load.
        rule.balance(system, workspace, Reached { load, pin_motion: 1.0, time: h }, h)?;
    }
    let start = workspace.u.clone();
    let mut displacement = length * (system.nodes as f64).sqrt();
    let mut tried = Tried::default();
    for _ in 0..=MOST_HALVINGS {
        workspace.u.copy_from_slice(&start);
        if let Some(reached) = one_step(rule, system, workspace, displacement, load, h, &mut tried)? {
            system.work.solver.steps += 1;
            system.work.solver.iterations += u64::from(tried.solved.iterations);
            system.work.solver.linear_iterations += u64::from(tried.solved.iterations);
            if reached < 1.0 {
                return Ok(reached);
            }
            // Past the end: the equilibrium under the whole load is near.
            rule.balance(system, workspace, Reached { load: 1.0, pin_motion: 1.0, time: h }, h)?;
            system.history.set(COMPLETE, true);
            return Ok(1.0);
        }
        if tried.unloaded {
            return Err(StepError::of(SPEC.kind, Refusal::NoLoad { time: system.time + h }));
        }
        displacement *= 0.5;
    }
    if tried.turned {
        return Err(StepError::of(SPEC.kind, Refusal::TurnsBack { load }));
    }
    report(SPEC.kind, &rule.settings, system, workspace, &Solved { converged: false, ..tried.solved })?;
    Ok(load)
}

/// How a step went.
#[derive(Clone, Copy, Debug, Default)]
struct Tried {
    solved: Solved,
    /// Whether it found a point of the curve, but one that lies back or far aside.
    turned: bool,
    /// Whether there was no load that could move anything.
    unloaded: bool,
}

/// Whether two vectors point the same way within the angle by which the curve may turn; a vector of no length has any way.
fn agree(a: &[f64], b: &[f64]) -> bool {
    // Written so that what is no number does not.
    dot(a, b) >= LEAST_COSINE * (dot(a, a) * dot(b, b)).sqrt()
}

/// Newton's method for displacement and load on |Δu| = way; none where it does not converge.
fn one_step<const D: usize>(
    rule: &Equilibrium,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    displacement: f64,
    load: f64,
    h: f64,
    tried: &mut Tried,
) -> Result<Option<f64>, StepError> {
    let Tried { solved, turned, unloaded } = tried;
    (*turned, *unloaded) = (false, false);
    let start = workspace.u.clone();
    // Of what is free: what pins move does not tell how the curve goes on.
    let free = |k: usize| if workspace.pin_displacement[k].is_nan() { 1.0 } else { 0.0 };
    let before = system.history.vectors(DISPLACEMENT);
    let last: Vec<f64> = (0..start.len()).map(|k| before.map_or(0.0, |u| free(k) * u.0[k % D][k / D])).collect();
    let mut now = load;
    let mut gone = vec![0.0; start.len()];
    let goal = rule.settings.tolerance * workspace.extent;
    workspace.contacting.clear(system.nodes);
    // Whether the step ends at the whole load, and not after its way.
    let mut ends = false;
    for iteration in 0..ITERATIONS {
        solved.iterations += 1;
        let balance = Balance { sigma: 0.0, beta: 0.0, theta: 1.0, time: h, h, load: now, impulse: 1.0, echo: 0.0 };
        if evaluate(system, workspace, &balance, false).is_err() {
            return Ok(None);
        }
        system.outer_forces(Workspace::<D>::STAGE, h, &mut workspace.outer);
        let mut changed = look(system, workspace, &balance, true);
        let Ok((correction, tangent)) = directions(rule, system, workspace, &balance) else { return Ok(None) };
        let leans = workspace.contacting.any();
        let mut step;
        if iteration == 0 {
            // On from where the last step has led; the first step puts load on.
            let size = dot(&tangent, &tangent).sqrt();
            if size.is_nan() || size == 0.0 && !leans {
                *unloaded = size == 0.0;
                return Ok(None);
            }
            step = if dot(&last, &tangent) < 0.0 { -displacement / size } else { displacement / size };
        } else {
            // 2 Δu·(δu + δλ u_t) = way² − |Δu|²
            let across = dot(&gone, &tangent);
            if across == 0.0 && !leans {
                return Ok(None);
            }
            step = (0.5 * (displacement * displacement - dot(&gone, &gone)) - dot(&gone, &correction)) / across;
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
            workspace.step[k] = change;
            gone[k] += change;
        }
        if iteration > 0 {
            solved.correction = largest;
        }
        now += step;
        if !now.is_finite()
            || gone.iter().any(|x| !x.is_finite())
            || dot(&gone, &gone) > 100.0 * displacement * displacement
        {
            return Ok(None);
        }
        for k in 0..gone.len() {
            workspace.u[k] = start[k] + gone[k];
        }
        if system.contacts.is_some() {
            // What the constraints take after the step: r + K Δu − Δλ F_outer.
            let mixture = mixture(system, &workspace.mass, &balance, Definiteness::Exact, &rule.settings);
            workspace.linear.multiply(&mixture, &workspace.step, &mut workspace.reaction);
            for k in 0..gone.len() {
                workspace.reaction[k] += workspace.residual[k] - step * workspace.outer.0[k % D][k / D];
            }
            let verdict = judge(system, workspace, &balance, &rule.settings, rule.settings.against_slide());
            changed |= verdict.anew || verdict.unsettled;
        }
        if iteration > 0 && !changed && solved.correction <= goal {
            if system.contacts.is_none() {
                // Where the load falls on the way on, the tangent points back.
                let back: Vec<f64> = tangent.iter().map(|t| -t).collect();
                *turned = !agree(&gone, &last) || !(agree(&gone, &tangent) || agree(&gone, &back));
                if *turned {
                    return Ok(None);
                }
            }
            let balance = Balance { load: now, ..balance };
            return Ok(evaluate(system, workspace, &balance, false).is_ok().then_some(now));
        }
    }
    Ok(None)
}

/// What leads to the balance under the load that is on, ways to surfaces included, and the displacement by the whole load,
/// K⁻¹ F_outer, whatever the signs of the eigenvalues of K.
fn directions<const D: usize>(
    rule: &Equilibrium,
    system: &System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
) -> Result<(Vec<f64>, Vec<f64>), Indefinite> {
    let Workspace { contacting, linear, mass, free, projectors, prescribed, residual, outer, .. } = workspace;
    let farthest =
        contacting.hold(&workspace.u, 1.0, &workspace.pin_displacement, &workspace.x0, free, projectors, prescribed);
    let mixture = mixture(system, mass, balance, Definiteness::Exact, &rule.settings);
    linear.assemble(&mixture);
    let contact_query = ContactQuery::new(system, balance, &workspace.x0, &workspace.u, workspace.extent);
    contacting.derivatives(&contact_query, false, &mut |node, block| linear.add_block(&mixture, node, &block));
    let filter = Filter { free, projectors };
    linear.factor(&filter)?;
    let displacements = (farthest > 0.0).then_some(&**prescribed);
    let buffers = [&mut workspace.trial[..], &mut workspace.right[..]];
    wanted_forces(system.threads, &mixture, linear, contacting, residual, displacements, buffers);
    let mut correction = workspace.right.clone();
    let mut tangent: Vec<f64> = (0..correction.len()).map(|k| outer.0[k % D][k / D]).collect();
    for vector in [&mut correction, &mut tangent] {
        filter.apply(vector);
        linear.solve_by_factors(vector)?;
        filter.apply(vector);
    }
    for (displacement, prescribed) in correction.iter_mut().zip(&*prescribed) {
        *displacement += prescribed;
    }
    Ok((correction, tangent))
}
