//! A step along the curve of equilibria.
//!
//! Obstacles hold nodes as in every other step of statics. The curve has a kink where a node reaches or leaves a surface. A
//! step can pass the kink, because the set of held nodes is determined anew in every iteration.
//!
//! Two points of the curve are at the given distance from the start of a step: one forward, one back. If the curve turns sharply,
//! the iteration may find the wrong point, because only the previous step defines the forward direction. A step in which the
//! curve turns by more than 60° is therefore repeated with half the length, except at kinks due to obstacles.

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

/// The largest number of halvings of the length of a step.
const MOST_HALVINGS: u32 = 10;

/// The cosine of the largest angle by which the curve may turn from step to step and within a step.
const LEAST_COSINE: f64 = 0.5;

/// The largest number of iterations of a step. If more are needed, the step is too long.
const ITERATIONS: u32 = 25;

/// Moves by the given length along the curve, from the state at the start of the step and `load`. Afterwards, `workspace.u` is
/// the displacement. Returns the load, which is 1 if the end was reached.
pub(super) fn follow<const D: usize>(
    rule: &Equilibrium,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    length: f64,
    load: f64,
    h: f64,
) -> Result<f64, StepError> {
    if load == 0.0 && system.contacts.is_some() {
        // A body that begins inside an obstacle is first moved to the surface of the obstacle, without any load.
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
            // The step would pass the whole load, so the equilibrium under the whole load is near.
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

/// The outcome of a step.
#[derive(Clone, Copy, Debug, Default)]
struct Tried {
    solved: Solved,
    /// Whether the point found on the curve lies backwards or far to the side.
    turned: bool,
    /// Whether there was no load that could move the body.
    unloaded: bool,
}

/// Whether the angle between two vectors is at most the angle by which the curve may turn. A zero vector agrees with every
/// vector.
fn agree(a: &[f64], b: &[f64]) -> bool {
    // Written so that the result is false for NaN.
    dot(a, b) >= LEAST_COSINE * (dot(a, a) * dot(b, b)).sqrt()
}

/// Finds displacement and load by Newton's method under the constraint |Δu| = `displacement`. Returns `None` if the method does
/// not converge.
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
    // Only free coordinates are used, because the motion of pins does not show how the curve continues.
    let free = |k: usize| if workspace.pin_displacement[k].is_nan() { 1.0 } else { 0.0 };
    let before = system.history.vectors(DISPLACEMENT);
    let last: Vec<f64> = (0..start.len()).map(|k| before.map_or(0.0, |u| free(k) * u.0[k % D][k / D])).collect();
    let mut now = load;
    let mut gone = vec![0.0; start.len()];
    let goal = rule.settings.tolerance * workspace.extent;
    workspace.contacting.clear(system.nodes);
    // Whether the step ends at the whole load instead of at its length.
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
            // Continues in the direction of the previous step. The first step adds load.
            let size = dot(&tangent, &tangent).sqrt();
            if size.is_nan() || size == 0.0 && !leans {
                *unloaded = size == 0.0;
                return Ok(None);
            }
            step = if dot(&last, &tangent) < 0.0 { -displacement / size } else { displacement / size };
        } else {
            // 2 Δu·(δu + δλ u_t) = length² − |Δu|²
            let across = dot(&gone, &tangent);
            if across == 0.0 && !leans {
                return Ok(None);
            }
            step = (0.5 * (displacement * displacement - dot(&gone, &gone)) - dot(&gone, &correction)) / across;
        }
        // A body that leans on obstacles may be unable to move by the length of the step under any load. The step then applies
        // the remaining load.
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
            // The forces of the constraints after the step: r + K Δu − Δλ F_outer.
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
                // If the load falls in the forward direction, the tangent points back.
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

/// Returns two displacements, whatever the signs of the eigenvalues of K. The first is the correction towards equilibrium under
/// the present load, including the displacements to surfaces. The second, K⁻¹ F_outer, is due to the whole load.
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
    let state = [&workspace.x0[..], &workspace.u, &workspace.pin_displacement];
    let contact_query = ContactQuery::new(system, balance, state, workspace.extent);
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
