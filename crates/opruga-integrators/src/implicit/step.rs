//! A step of an implicit rule, from its start to its entry in the ledger.
//!
//! Guards wrap the minimiser. From the outside to the inside, the guards are:
//!
//! | guard | what it refuses, and what it does instead | where |
//! |---|---|---|
//! | halving | steps that do not converge: two steps of half the length | `Method::advance` |
//! | growth | bodies that have become too large in accepted steps: nothing | `growth` |
//! | energy of the rule | a gain of energy in contact: a rule that damps | `energy` |
//! | energy of the minimiser | a gain of energy by a doubtful stage: Newton's method | `energy` |
//! | impact | nodes that end inside obstacles: they are moved to the surface | `impact` |
//! | convergence | a search that did not converge, unless the scene accepts it | `convergence` |
//! | contact | an unforeseen contact: the rule in contact | `Method::find_end` |
//! | budget | a result of few iterations that may have created energy: Newton's method | `fallback` |
//! | rounding | a stage that rounding hides: more iterations of the exact minimiser | `rounding`, `rigid_balance` |
//!
//! Slenderness (`slenderness`) chooses the linear solver of the real-time minimiser, and refuses nothing.

use super::answer;
use super::balance::{Balance, Solved};
use super::contact::SMALL;
use super::convergence::{accept_or_refuse, count, finish, refusal};
use super::ends::{Found, commit, end, enter_end, enter_stage, open_ledger};
use super::energy::{self, Change};
use super::fallback::{RealTime, exactly};
use super::growth;
use super::holding;
use super::memory;
use super::minimiser::Minimiser;
use super::newton::Newton;
use super::open;
use super::rule::Rule;
use super::settings::{MOST_HALVINGS, Otherwise, Settings};
use super::workspace::Workspace;
use opruga_core::error::{BuildError, StepError};
use opruga_core::history::Channel;
use opruga_core::integrator::{Amplification, Integrator};
use opruga_core::memory::Counts;
use opruga_core::open_step::OpenStep;
use opruga_core::potential::Views;
use opruga_core::spec::Values;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_solve::blocks::nodes;

/// An implicit rule as an integrator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Implicit<R> {
    pub(crate) rule: R,
    pub(crate) settings: Settings,
}

impl<R> Implicit<R> {
    /// Makes an integrator from a rule and the settings of a scene.
    ///
    /// # Errors
    /// [`BuildError`] if settings exclude one another.
    pub(crate) fn new(kind: &'static str, rule: R, values: &Values) -> Result<Implicit<R>, BuildError> {
        Ok(Implicit { rule, settings: Settings::of_rule(kind, values)? })
    }

    /// Calls `action` with the minimiser that the settings choose.
    fn with_minimiser<T, const D: usize>(&self, action: impl FnOnce(&dyn Minimiser<D>) -> T) -> T {
        if self.settings.real_time { action(&RealTime(self.settings)) } else { action(&Newton(self.settings)) }
    }
}

impl<R: Rule<D>, const D: usize> Integrator<D> for Implicit<R> {
    fn name(&self) -> &'static str {
        R::NAME
    }
    fn needs(&self) -> Views {
        Views { hessian: true, symmetric: true, ..Views::default() }
    }
    fn work_columns(&self) -> usize {
        1
    }
    fn history(&self) -> Vec<Channel> {
        let of_minimiser = self.with_minimiser(|minimiser: &dyn Minimiser<D>| minimiser.history());
        [self.rule.history(), of_minimiser, vec![growth::SIZE.declared()]].concat()
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        self.rule.amplification(omega, c, h)
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        self.with_minimiser(|minimiser| minimiser.same_bits_everywhere(system))
    }
    fn shares_threads(&self) -> bool {
        self.with_minimiser(|minimiser: &dyn Minimiser<D>| minimiser.shares_threads())
    }
    fn measures_its_damping(&self) -> bool {
        true
    }
    fn takes_mass_matrix(&self) -> bool {
        true
    }
    fn memory(&self, counts: &Counts, couplings: f64) -> f64 {
        memory::of_body::<D>(&self.settings, counts, couplings)
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        self.with_minimiser(|minimiser| self.step_by(minimiser, system, h))
    }
    fn has_budget(&self) -> bool {
        self.settings.real_time
    }
    fn takes_pushes(&self) -> bool {
        true
    }
    fn prepare_answer(&self, system: &mut System<D>) -> Result<Option<u64>, StepError> {
        let mut workspace = system.cache.take::<Workspace<D>>();
        let keeps_matrix = self.with_minimiser(|minimiser: &dyn Minimiser<D>| minimiser.keeps_matrix(system));
        let outcome = answer::prepare(system, &mut workspace, keeps_matrix);
        system.cache.put(workspace);
        outcome
    }
    fn answer(&self, system: &mut System<D>, vectors: &mut [f64], count: usize) -> bool {
        let workspace = system.cache.take::<Workspace<D>>();
        let outcome = answer::displace(&workspace, vectors, count);
        system.cache.put(workspace);
        outcome
    }
    fn open(&self, system: &mut System<D>, h: f64) -> Option<Result<Box<dyn OpenStep<D>>, StepError>> {
        Some(open::open(self.rule, self.settings, system, h))
    }
}

impl<R> Implicit<R> {
    /// Makes a step whose stage is found by a given minimiser.
    pub(crate) fn step_by<const D: usize>(
        &self,
        minimiser: &dyn Minimiser<D>,
        system: &mut System<D>,
        h: f64,
    ) -> Result<(), StepError>
    where
        R: Rule<D>,
    {
        let mut workspace = system.cache.take::<Workspace<D>>();
        let method = Method { rule: self.rule, settings: &self.settings, minimiser };
        let outcome = method.advance(system, &mut workspace, h, 0);
        system.cache.put(workspace);
        outcome
    }
}

/// A method of making a step: a rule, and the minimiser that finds its stage.
#[derive(Clone, Copy, Debug)]
struct Method<'a, R, const D: usize> {
    rule: R,
    settings: &'a Settings,
    minimiser: &'a dyn Minimiser<D>,
}

impl<R: Rule<D>, const D: usize> Method<'_, R, D> {
    /// Makes a step of length h, or two steps of half the length if the whole step does not converge. Halving is the outermost
    /// guard.
    fn advance(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        h: f64,
        halvings: u32,
    ) -> Result<(), StepError> {
        let work = system.work;
        let velocities = holding::take_hold(system, &mut workspace.kick, h);
        let outcome = self.attempt(system, workspace, h);
        if outcome.is_err() {
            // Only the ledger, and velocities that pins have changed, have been written.
            if let Some(before) = velocities {
                system.state.v = before;
            }
            let solver = system.work.solver;
            system.work = work;
            system.work.solver = solver;
            let broken_off = matches!(outcome, Err(StepError::BrokenOff {}));
            let asked_for = self.settings.otherwise == Otherwise::Halve || self.minimiser.always_halves();
            if !broken_off && asked_for && halvings < MOST_HALVINGS {
                let solver = &mut system.work.solver;
                solver.halved += 1;
                solver.deepest = solver.deepest.max(u64::from(halvings) + 1);
                self.advance(system, workspace, 0.5 * h, halvings + 1)?;
                let outcome = self.advance(system, workspace, 0.5 * h, halvings + 1);
                workspace.answer.last = None;
                return outcome;
            }
        }
        outcome
    }

    /// Makes a step of length h, from its start to its entry in the ledger.
    fn attempt(&self, system: &mut System<D>, workspace: &mut Workspace<D>, h: f64) -> Result<(), StepError> {
        let ledger = open_ledger::<R, D>(system, workspace, h)?;
        let found = self.find_end(system, workspace, h)?;
        self.refuse_growth(system, workspace, &found)?;
        finish(system, workspace);
        enter_stage(system, workspace, &found, &ledger);
        commit(system, workspace);
        enter_end(system, workspace, &found)?;
        found.rule.remember(system, workspace, h);
        self.minimiser.remember(system, workspace, h);
        workspace.answer.last = Some((found.balance, system.time));
        system.end_implicit(h);
        Ok(())
    }

    /// Finds the stage and the end of a step. The guards are applied in this order: contact, convergence, obstacles at the end
    /// of the step, energy of a minimiser that is not exact, energy of the rule. A guard that refuses the step determines what
    /// replaces the step.
    fn find_end(&self, system: &mut System<D>, workspace: &mut Workspace<D>, h: f64) -> Result<Found<R>, StepError> {
        let own = if system.pushes.is_some() { self.rule.pushed() } else { self.rule };
        let in_contact = own.in_contact();
        let mut rule = in_contact.filter(|_| touches(system, workspace, h)).unwrap_or(own);
        let exact = Newton(exactly(self.settings));
        let mut minimiser = self.minimiser;
        let mut energy = None;
        loop {
            let (balance, solved) = find_stage(rule, minimiser, system, workspace, h)?;
            if let Some(other) = in_contact.filter(|_| rule.in_contact().is_some() && workspace.contacting.any()) {
                // The end of the step has a contact that was not foreseen.
                rule = other;
                continue;
            }
            if !solved.converged {
                accept_or_refuse(R::NAME, self.settings, system, workspace, &solved)?;
            }
            let work = system.work;
            end(rule, system, workspace, &balance, h);
            let calmed = rule.calmed().filter(|_| workspace.contacting.any_at_rest());
            if solved.doubtful || calmed.is_some() {
                let change = energy::change(&mut energy, system, workspace, &balance)?;
                if solved.doubtful && Change::may_be_gain(change) {
                    system.work = work;
                    minimiser.discard(system);
                    minimiser = &exact;
                    continue;
                }
                if let Some(calmed) = calmed.filter(|_| Change::is_known_gain(change)) {
                    system.work = work;
                    rule = calmed;
                    continue;
                }
            }
            return Ok(Found { rule, balance, solved });
        }
    }

    /// The guard against growth: refuses a body that has become too large in unconverged steps.
    fn refuse_growth(
        &self,
        system: &mut System<D>,
        workspace: &Workspace<D>,
        found: &Found<R>,
    ) -> Result<(), StepError> {
        let (time, solved) = (system.time, &found.solved);
        let refused = |hint| refusal(R::NAME, self.settings, workspace, solved, (time, [0, 0]), hint);
        growth::check(system, workspace, solved, refused)
    }
}

/// Finds the stage of a rule. The search starts from a continuation of the previous motion.
fn find_stage<R: Rule<D>, const D: usize>(
    rule: R,
    minimiser: &dyn Minimiser<D>,
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    h: f64,
) -> Result<(Balance, Solved), StepError> {
    workspace.contacting.clear(system.nodes);
    let balance = rule.begin(system, workspace, h);
    workspace.hold(system, balance.theta, h);
    // Pinned axes start at their final positions.
    let Workspace { u, pin_displacement, v0, .. } = &mut *workspace;
    each_block(system.threads, D, [u], |first, [u]| {
        for (k, u) in (first..).zip(u) {
            *u = if pin_displacement[k].is_nan() { balance.theta * h * v0[k] } else { pin_displacement[k] };
        }
    });
    minimiser.predict(system, workspace, &balance);
    let solved = minimiser.minimise(system, workspace, &balance)?;
    count(system, &solved);
    Ok((balance, solved))
}

/// Whether any node would be on or in an obstacle at the end of the step if it moved with its velocity alone.
fn touches<const D: usize>(system: &System<D>, workspace: &Workspace<D>, h: f64) -> bool {
    let Some(obstacles) = &system.contacts else { return false };
    nodes::<D>(&workspace.x0).iter().zip(nodes::<D>(&workspace.v0)).any(|(from, velocity)| {
        let to: [f64; D] = core::array::from_fn(|d| from[d] + h * velocity[d]);
        let mut touching = false;
        let reach = SMALL * workspace.extent;
        obstacles
            .touch(from, &to, system.time + h, h, reach, &mut |touch| touching |= touch.gap <= touch.rounding + reach);
        touching
    })
}
