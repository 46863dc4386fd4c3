//! The start and the end of a step: its ledger, and the state that it leaves.

use super::balance::{Balance, Solved};
use super::holding;
use super::impact::Ending;
use super::own_loss::{self, given};
use super::rule::Rule;
use super::workspace::{Workspace, write};
use opruga_core::error::StepError;
use opruga_core::system::{Stage, System, Work8};
use opruga_math::WIDTH;

/// A stage that the guards have accepted, and the rule that found it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<R> {
    pub(super) rule: R,
    pub(super) balance: Balance,
    pub(super) solved: Solved,
}

/// The ledger before a step, and the ledger after the entries at the start of the step.
#[derive(Clone, Copy)]
pub(super) struct Ledger {
    pub(super) before: Work8,
    pub(super) begun: Work8,
}

/// A step of statics at its start: the ledger, and the energy of the body [J].
#[derive(Clone, Copy)]
pub(crate) struct Statics {
    begun: Work8,
    before: f64,
}

impl Statics {
    /// Stops all motion, and copies the state at the start of a step of statics to the workspace.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub(crate) fn begin<const D: usize>(
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
    ) -> Result<Statics, StepError> {
        let begun = system.work;
        system.begin_implicit();
        let moving = system.kinetic_energy();
        stop(system);
        workspace.load(system);
        system.evaluate(Stage::Current, 0.0, 0.0, &mut workspace.force)?;
        Ok(Statics { begun, before: system.stored_energy(Stage::Current, 0.0) + moving })
    }

    /// Ends a step of statics of h [s] at the displacement in `workspace.u1`.
    ///
    /// The change of energy of the body, minus the energy given to a gas, is recorded as external work. The external work
    /// includes the work of loads, of pins and of all forces that slow the motion down. Velocities are zero before and after
    /// the step, so pins cause no change of kinetic energy.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the end.
    pub(crate) fn end<const D: usize>(
        self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        h: f64,
    ) -> Result<(), StepError> {
        workspace.v1.fill(0.0);
        commit(system, workspace);
        system.end_implicit(h);
        stop(system);
        system.evaluate(Stage::Current, 0.0, 0.0, &mut workspace.force)?;
        let after = system.stored_energy(Stage::Current, 0.0);
        let given: f64 = system.work.gas.iter().sum::<f64>() - self.begun.gas.iter().sum::<f64>();
        (system.work.user, system.work.damping) = (self.begun.user, self.begun.damping);
        system.work.user[0] += after - self.before - given;
        Ok(())
    }
}

fn stop<const D: usize>(system: &mut System<D>) {
    system.state.v.0.iter_mut().for_each(|column| column.fill(0.0));
}

/// Copies the state at the start of a step to the workspace. If the rule uses the mean of start and end, also records the part
/// of the work that belongs to the start.
pub(super) fn open_ledger<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    h: f64,
) -> Result<Ledger, StepError> {
    system.begin_implicit();
    workspace.load(system);
    let before = system.work;
    if R::TRAPEZOID {
        system.evaluate(Stage::Current, 0.0, 0.5 * h, &mut workspace.force)?;
    }
    own_loss::add_given(&mut system.work, &given(&before));
    Ok(Ledger { before, begun: system.work })
}

/// If the rule uses the stage, records the work in the stage, which was evaluated last. For all rules, records the work of
/// other bodies and the work due to coupled masses.
pub(super) fn enter_stage<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    found: &Found<R>,
    ledger: &Ledger,
) {
    let by_stage = !found.rule.is_trapezoid();
    if R::TRAPEZOID && by_stage {
        take_back(&mut system.work, &ledger.begun, &ledger.before);
    }
    let entered = given(&system.work);
    if by_stage {
        // Damping, loads and pins, from the forces of the stage.
        system.evaluate_again(Workspace::<D>::STAGE, found.balance.time, found.balance.h, &mut workspace.force);
    }
    own_loss::add_given(&mut system.work, &entered);
    own_loss::add_pushes(system, &workspace.u1);
    if system.inertia.is_some() {
        // Pinned nodes whose mass is coupled keep the velocity of the step to its end.
        let Workspace { v0, v1, .. } = &mut *workspace;
        system.pinned_axes(&mut |node, d| v1[node * D + d] = v0[node * D + d]);
        holding::enter_work(system, v0, v1);
    }
}

/// If a rule uses the mean of start and end, records the part of the work that belongs to the end.
pub(super) fn enter_end<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    found: &Found<R>,
) -> Result<(), StepError> {
    if found.rule.is_trapezoid() {
        let h = found.balance.h;
        system.hold(Stage::Current, h);
        let entered = given(&system.work);
        system.evaluate(Stage::Current, h, 0.5 * h, &mut workspace.force)?;
        own_loss::add_given(&mut system.work, &entered);
    }
    Ok(())
}

/// Removes from a ledger the entries made between two moments.
fn take_back(work: &mut Work8, after: &Work8, before: &Work8) {
    for lane in 0..WIDTH {
        work.user[lane] -= after.user[lane] - before.user[lane];
        work.gas[lane] -= after.gas[lane] - before.gas[lane];
        work.damping[lane] -= after.damping[lane] - before.damping[lane];
        work.numerical[lane] -= after.numerical[lane] - before.numerical[lane];
    }
}

/// Computes the end of a step: displacement and velocity, including the effect of obstacles.
pub(super) fn end<R: Rule<D>, const D: usize>(
    rule: R,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    balance: &Balance,
    h: f64,
) {
    rule.end(system, workspace, balance, h);
    own_loss::take_impulses(system, workspace, balance);
    workspace.struck.clear();
    if system.contacts.is_none() {
        return;
    }
    for k in 0..workspace.memory.len() {
        workspace.memory[k] = rule.remembered(workspace, k, h);
    }
    let Workspace { contacting, mass, residual, x0, v0, u1, v1, pin_displacement, memory, struck, extent, .. } =
        workspace;
    contacting.expel(system, [x0, residual, pin_displacement], u1, h, *extent);
    let ending = Ending { mass, reaction: residual, x0, v0, balance, extent: *extent };
    contacting.end(system, &ending, v1, memory, struck);
}

/// Writes the end of the step into the state.
pub(crate) fn commit<const D: usize>(system: &mut System<D>, workspace: &Workspace<D>) {
    let (index_count, nodes, threads) = (system.index_count(), system.nodes, system.threads);
    let state = [&mut system.state.x, &mut system.state.v];
    write(index_count, nodes, threads, state, |k| [workspace.x0[k] + workspace.u1[k], workspace.v1[k]]);
}
