//! The real-time setting makes few iterations, with a matrix that is kept as long as iterations with it find the end of a step.
//!
//! Every iteration balances the exact forces. The matrix only determines the correction. If the matrix belongs to another shape
//! of the body, or if its equations are solved only approximately, a part of the residual remains, and the next step begins
//! with this part. At rest no residual remains. The iteration begins with the positions to which the acceleration of the
//! previous step would lead, and with the contact forces of that step (`contact_forces`).
//!
//! The residual of a step shows whether the matrix is still good enough. Near obstacles the residual comes mostly from changes
//! of contacts. Near obstacles, the measure is therefore the difference between the forces after an iteration and the forces
//! that the matrix predicted.
//!
//! Residuals are measured in the norm of the inverse diagonal blocks of the matrix, √(r·B r).

use super::balance::{Balance, Solved};
use super::direction::wanted_forces;
use super::friction::SlipRule;
use super::linear::{Filter, Mixture};
use super::rigid_balance::settles;
use super::settings::Settings;
use super::slenderness::has_dense;
use super::stage::{evaluate, judge, look};
use super::workspace::Workspace;
use opruga_core::error::StepError;
use opruga_core::history::{Channel, PerBody, PerNode};
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_math::Lane;
use opruga_solve::Indefinite;

/// The largest fraction of the residual that the linear solver may leave.
const LINEAR: f64 = 0.05;

/// If a larger fraction of the residual remains, the next step rebuilds the matrix.
const MOST_MISMATCH: f64 = 0.2;

/// The same limit for bodies that are free or near obstacles. If each of three iterations leaves this fraction, a thousandth of
/// the residual remains.
const MOST_MISMATCH_LOOSE: f64 = 0.1;

/// The fraction of the residual that the linear solver may leave for bodies that are free or near obstacles. An iteration is
/// good enough if the residual has fallen to the square of this fraction, a millionth.
const LOOSE: f64 = 1e-3;

/// A residual counts as zero if it moves nodes by less than this fraction of the extent.
const NOTHING: f64 = 1e-9;

/// The largest number of products with the matrix in an iteration.
const PRODUCTS: u32 = 1000;

/// An iteration counts as cut off if it has more products than this. A body that needs so many products is ill-conditioned.
/// Stiff motions dominate the residual of such a body, so the residual is a poor measure of slow motions such as the bending of
/// a slender body.
const MANY_PRODUCTS: u32 = 120;

/// The shape in which the matrix was made [m], the velocity at the start of the previous step [m/s], and the length of that
/// step [s]. The length is zero if the acceleration of that step cannot be continued.
const REFERENCE: PerNode = PerNode::new("real_time.reference");

/// The contact forces at the end of the previous step, with friction if nodes slip [N].
const CONTACT_FORCE: PerNode = PerNode::new("real_time.contact_force");
const VELOCITY: PerNode = PerNode::new("real_time.velocity");
const STEP: PerBody<f64> = PerBody::new("real_time.step");

/// Whether there is a matrix, and whether the next step rebuilds it.
const MATRIX: PerBody<bool> = PerBody::new("real_time.matrix");
const STALE: PerBody<bool> = PerBody::new("real_time.stale");

/// Whether a body has no pins, or may be near obstacles. Without pins, the residual would push and rotate the body. Near
/// obstacles, the acceleration of an impact cannot be continued.
fn is_loose<const D: usize>(system: &System<D>) -> bool {
    system.contacts.is_some() || system.pins.is_empty()
}

/// The data that the setting keeps from step to step.
pub(super) fn channels() -> Vec<Channel> {
    let vectors = [REFERENCE, VELOCITY, CONTACT_FORCE].map(|channel| channel.declared());
    vectors.into_iter().chain([STEP.declared(), MATRIX.declared(), STALE.declared()]).collect()
}

/// Writes the displacement from x₀ under the acceleration of the previous step to `workspace.u`.
pub(super) fn predict<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>, theta: f64, h: f64) {
    let last = system.history.get(STEP);
    if last <= 0.0 || is_loose(system) {
        return;
    }
    let Some(before) = system.history.vectors(VELOCITY) else { return };
    let share = theta * theta * h * h / last;
    let Workspace { u, pin_displacement, v0, .. } = workspace;
    each_block(system.threads, D, [u], |first, [u]| {
        for (node, u) in (first / D..).zip(u.as_chunks_mut::<D>().0) {
            for d in 0..D {
                let k = node * D + d;
                if pin_displacement[k].is_nan() {
                    u[d] += share * (v0[k] - before.0[d][node]);
                }
            }
        }
    });
}

/// Keeps the velocities at the start of a step, or at its end for nodes that met an obstacle.
pub(super) fn remember<const D: usize>(system: &mut System<D>, workspace: &Workspace<D>, h: f64) {
    // The acceleration of an impact cannot be continued.
    system.history.set(STEP, if workspace.struck.is_empty() { h } else { 0.0 });
    let System { history, nodes, threads, .. } = system;
    let Some(before) = history.vectors_mut(VELOCITY) else { return };
    let columns = before.0.each_mut().map(|column| &mut column[..*nodes]);
    each_block(*threads, 1, columns, |first, columns| {
        for (d, column) in columns.into_iter().enumerate() {
            for (node, before) in (first..).zip(column) {
                *before = workspace.v0[node * D + d];
            }
        }
    });
    for contact in &workspace.contacting.contacts {
        for d in 0..D {
            before.0[d][contact.node] = workspace.v1[contact.node * D + d];
        }
    }
    let Some(forces) = history.vectors_mut(CONTACT_FORCE) else { return };
    forces.0.iter_mut().for_each(|column| column[..*nodes].fill(0.0));
    workspace.contacting.visit_forces(|node, force| (0..D).for_each(|d| forces.0[d][node] += force[d]));
}

/// The data of an iteration besides the workspace.
#[derive(Clone, Copy, Debug)]
struct Task<'a> {
    balance: &'a Balance,
    direct: bool,
}

impl Task<'_> {
    fn mixture<'a, const D: usize>(&self, system: &'a System<D>, mass: &'a [f64]) -> Mixture<'a, D> {
        Mixture {
            system,
            sigma: self.balance.sigma,
            beta: self.balance.beta,
            load: 1.0,
            mass,
            stage: Workspace::<D>::STAGE,
            time: self.balance.time,
            keep: Definiteness::Clamped,
            matrix_free: false,
        }
    }

    /// Makes the matrix in the reference shape, which was evaluated last.
    fn make<const D: usize>(&self, system: &System<D>, workspace: &mut Workspace<D>, is_new: bool) {
        let Some(reference) = system.history.vectors(REFERENCE) else { return };
        let Workspace { reused, linear, mass, .. } = workspace;
        let mixture = self.mixture(system, mass);
        reused.make(linear, &mixture, reference, is_new);
    }

    /// Makes the matrix in the present shape, which becomes the reference.
    fn make_here<const D: usize>(&self, system: &mut System<D>, workspace: &mut Workspace<D>) {
        let System { history, state, nodes, .. } = system;
        history.set(MATRIX, true);
        history.set(STALE, false);
        let Some(reference) = history.vectors_mut(REFERENCE) else { return };
        for (own, column) in reference.0.iter_mut().zip(&state.work[0][0].0) {
            own[..*nodes].copy_from_slice(&column[..*nodes]);
        }
        self.make(system, workspace, true);
    }

    /// Makes the matrix in the reference shape, unless this matrix exists. The reference shape is part of the state. Returns
    /// false if no reference can be used.
    fn recall<const D: usize>(&self, system: &mut System<D>, workspace: &mut Workspace<D>) -> Result<bool, StepError> {
        if !keeps_matrix(system) || !system.hessian_is_of_positions() {
            return Ok(false);
        }
        let Some(reference) = system.history.vectors(REFERENCE) else { return Ok(false) };
        let mixture = self.mixture(system, &workspace.mass);
        if !workspace.reused.is_of(reference, &mixture) {
            let (nodes, index_count) = (system.nodes, system.index_count());
            let System { history, state, .. } = system;
            let Some(reference) = history.vectors(REFERENCE) else { return Ok(false) };
            for (to, from) in state.work[0][0].0.iter_mut().zip(&reference.0) {
                for index in 0..index_count {
                    to[index] = from[index.min(nodes - 1)];
                }
            }
            system.evaluate(Workspace::<D>::STAGE, self.balance.time, 0.0, &mut workspace.force)?;
            self.make(system, workspace, false);
        }
        Ok(true)
    }

    /// Begins with the matrix in the reference shape of the state, or in the initial shape if the state contains no reference.
    fn begin<const D: usize>(&self, system: &mut System<D>, workspace: &mut Workspace<D>) -> Result<(), StepError> {
        let recalled = self.recall(system, workspace)?;
        evaluate(system, workspace, self.balance, false)?;
        if !recalled {
            self.make_here(system, workspace);
        }
        Ok(())
    }

    /// Computes the residual in the free directions, including friction and prescribed displacements. Stores the residual as
    /// the right-hand side, and returns its size.
    fn out_of_balance<const D: usize>(
        &self,
        system: &System<D>,
        workspace: &mut Workspace<D>,
        moves: bool,
    ) -> Result<f64, Indefinite> {
        let Workspace {
            reused, linear, mass, free, projectors, residual, right, trial, prescribed, contacting, ..
        } = workspace;
        let mixture = self.mixture(system, mass);
        let displacements = moves.then_some(&**prescribed);
        wanted_forces(system.threads, &mixture, linear, contacting, residual, displacements, [trial, &mut *right]);
        let filter = Filter { free, projectors };
        each_block(system.threads, D, [&mut *right], |first, [right]| filter.apply_from(first / D, right));
        reused.hold(system.threads, linear, &filter, self.direct, right)?;
        Ok(reused.begin(system, right))
    }

    /// Solves for the step of an iteration. Returns the number of products, or an error if the solver failed.
    fn direction<const D: usize>(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        goal: f64,
    ) -> Result<u32, Indefinite> {
        let Workspace { reused, right, step, .. } = &mut *workspace;
        let (products, indefinite) = reused.solve(system, right, self.direct, goal, PRODUCTS, step)?;
        if indefinite {
            // The solution so far leads downhill. The next step will use another matrix.
            mark_stale(system);
        }
        Ok(products)
    }
}

/// Makes the next step rebuild its matrix.
pub(super) fn mark_stale<const D: usize>(system: &mut System<D>) {
    if system.history.get(MATRIX) {
        system.history.set(STALE, true);
    }
}

/// Whether the matrix in the reference shape exists and the next step begins with it.
pub(super) fn keeps_matrix<const D: usize>(system: &System<D>) -> bool {
    system.history.get(MATRIX) && !system.history.get(STALE)
}

/// Whether the result of few iterations is accepted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Trust {
    /// The result is always accepted.
    Always,
    /// The result is accepted unless the incremental potential has risen.
    IfDownhill,
    /// The result is accepted unless the body has more energy at the end of the step than before.
    IfNoGain,
    /// The result is not accepted.
    None,
}

/// Whether the matrix is factored. This is determined once, and again if the scene chooses another solver.
fn is_direct<const D: usize>(system: &System<D>, workspace: &mut Workspace<D>, settings: &Settings) -> bool {
    let direct = match workspace.direct {
        Some((solver, direct)) if solver == settings.solver => direct,
        _ => settings.solver.is_direct_in_real_time(system) || has_dense(system),
    };
    workspace.direct = Some((settings.solver, direct));
    direct
}

/// The fraction of the residual at which an iteration is good enough, and the fraction that the linear solver may leave.
fn aims<const D: usize>(system: &System<D>, settings: &Settings) -> (f64, f64) {
    let aim = settings.leaves[0];
    if is_loose(system) { (LOOSE * LOOSE, LOOSE) } else { (aim, LINEAR.smaller(0.5 * aim)) }
}

/// Makes three iterations, or as many as the scene specifies. Returns whether their residual is acceptable.
pub(super) fn iterate<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
) -> Result<(Solved, Trust), StepError> {
    let task = Task { balance, direct: is_direct(system, workspace, settings) };
    workspace.rigid.begin();
    let mut solved = Solved { converged: true, ..Solved::default() };
    task.begin(system, workspace)?;
    let (mut first, mut undecided, mut slow, mut remade) = (0.0, false, false, false);
    // The fraction of the residual that remained in the last iteration because the matrix belongs to another shape.
    let mut mismatch = 0.0;
    loop {
        system.go_on()?;
        let last = solved.iterations == settings.iterations;
        // Which nodes are held, and how far they have to move.
        let mut moves = false;
        if !last {
            undecided |= look(system, workspace, balance, false);
            if solved.iterations == 0
                && let Some(forces) = system.history.vectors(CONTACT_FORCE)
            {
                workspace.contacting.start_from(|node| core::array::from_fn(|d| forces.0[d][node]));
            }
            let Workspace { contacting, u, pin_displacement, x0, free, projectors, prescribed, .. } = &mut *workspace;
            moves = contacting.hold(u, balance.theta, pin_displacement, x0, free, projectors, prescribed) > 0.0;
        }
        let mut size = task.out_of_balance(system, workspace, moves).unwrap_or(f64::NAN);
        if solved.iterations == 0 {
            first = size;
        } else if !is_loose(system) {
            mismatch = size / first;
        }
        let floor = NOTHING * workspace.extent * workspace.reused.stiffness().sqrt();
        let settled = !undecided && !moves;
        let (enough, linear) = aims(system, settings);
        let enough = if solved.iterations > 0 { (enough * first).larger(floor) } else { floor };
        if last || settled && size <= enough {
            let most = if is_loose(system) { MOST_MISMATCH_LOOSE } else { MOST_MISMATCH };
            if mismatch > most && size > floor {
                mark_stale(system);
            }
            let end = End { size, first, floor, most: settings.leaves[1], slow, remade };
            return conclude(system, workspace, balance, settings, solved, &end);
        }
        if mismatch > MOST_MISMATCH {
            // The matrix of another shape is not good enough.
            remade = true;
            task.make_here(system, workspace);
            size = task.out_of_balance(system, workspace, moves).unwrap_or(f64::NAN);
        }
        if size.is_nan() {
            workspace.reused.forget_right_hand_side();
        }
        solved.iterations += 1;
        let goal = if is_loose(system) { (linear * size).larger(enough) } else { (linear * first).larger(floor) };
        // A matrix can fail because of the pressure of a gas, for example. The step is then solved exactly.
        let Ok(products) = task.direction(system, workspace, goal) else {
            solved.converged = false;
            return Ok((solved, Trust::None));
        };
        solved.products += products;
        slow |= products > MANY_PRODUCTS;
        let missed = go(system, workspace, &task, moves, &mut solved)?;
        // Errors of the matrix due to rounding do not count.
        mismatch = if missed > floor { missed / size } else { 0.0 };
        undecided = false;
        if system.contacts.is_some() {
            let verdict = judge(system, workspace, balance, settings, SlipRule::Projected);
            undecided = verdict.anew || verdict.unsettled;
        }
    }
}

/// The outcome of the iterations of a step.
#[derive(Clone, Copy, Debug)]
struct End {
    /// The size of the residual, its initial value, and the value below which it counts as zero.
    size: f64,
    first: f64,
    floor: f64,
    /// The fraction of the initial residual that may remain.
    most: f64,
    /// Whether an iteration took many products, and whether the matrix was rebuilt.
    slow: bool,
    remade: bool,
}

/// Ends the iterations of a step: records their residual, and returns whether it is acceptable.
fn conclude<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    settings: &Settings,
    mut solved: Solved,
    end: &End,
) -> Result<(Solved, Trust), StepError> {
    let End { size, first, floor, most, slow, remade } = *end;
    let as_promised = size <= (most * first).larger(floor);
    if slow || !as_promised {
        let left = size / workspace.reused.stiffness().sqrt();
        let work = &mut system.work.solver;
        work.cut_off += 1;
        work.left = left.larger(work.left);
    }
    let trust = match (is_loose(system), as_promised) {
        (true, _) if workspace.contacting.any() => Trust::IfNoGain,
        (false, true) if !remade => Trust::Always,
        _ => Trust::IfDownhill,
    };
    // A residual that is too small to move one node against the stiffness of the others may still move all of them together.
    let trust =
        if settles(system, workspace, balance, settings, [NOTHING, LOOSE * LOOSE])? { trust } else { Trust::None };
    solved.conditioning = workspace.rigid.conditioning;
    Ok((solved, trust))
}

/// Applies the step, including prescribed displacements. Afterwards `workspace.reaction` is the force of the constraints. For
/// bodies that are free or near obstacles, returns the difference r − (r₀ + A Δ) between the present forces and the forces that
/// the matrix predicted. Here r₀ + A Δ is the residual of the linear solver. If no node is held, this residual counts as zero.
fn go<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    task: &Task<'_>,
    moves: bool,
    solved: &mut Solved,
) -> Result<f64, StepError> {
    let Workspace { linear, mass, free, projectors, residual, reaction, step, prescribed, contacting, u, .. } =
        &mut *workspace;
    let any = contacting.any();
    let filter = Filter { free, projectors };
    each_block(system.threads, D, [step], |first, [step]| filter.apply_from(first / D, step));
    if moves {
        for (s, p) in step.iter_mut().zip(&*prescribed) {
            *s += p;
        }
    }
    // The residual in the held directions after the step: r + A Δ.
    if any {
        linear.multiply(&task.mixture(system, mass), step, reaction);
        for (r, residual) in reaction.iter_mut().zip(&*residual) {
            *r += residual;
        }
    }
    let mut longest: f64 = 0.0;
    for node in step.as_chunks::<D>().0 {
        longest = node.iter().map(|x| x * x).sum::<f64>().larger(longest);
    }
    solved.correction = longest.sqrt();
    each_block(system.threads, D, [u], |first, [u]| {
        for (u, s) in u.iter_mut().zip(&step[first..]) {
            *u += s;
        }
    });
    evaluate(system, workspace, task.balance, false)?;
    if !is_loose(system) {
        return Ok(0.0);
    }
    let Workspace { reused, free, projectors, residual, reaction, trial, .. } = &mut *workspace;
    trial.copy_from_slice(residual);
    if any {
        trial.iter_mut().zip(&*reaction).for_each(|(missed, foreseen)| *missed -= foreseen);
    }
    Filter { free, projectors }.apply(trial);
    Ok(reused.begin(system, trial))
}
