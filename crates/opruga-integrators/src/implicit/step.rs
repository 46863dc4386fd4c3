//! A step of an implicit rule from start to ledger.
//!
//! Guards wrap the minimiser, from the outside to the inside:
//!
//! | guard | what it refuses, and what makes the step instead | where |
//! |---|---|---|
//! | halving | what does not converge: two steps of half the length | `Method::advance` |
//! | growth | what accepted steps have blown up: nothing | `growth` |
//! | energy of the rule | a gain of energy in contact: a rule that damps | `energy` |
//! | energy of the minimiser | a gain of energy by a doubtful stage: Newton's method | `energy` |
//! | impact | nodes that end inside obstacles: they are put onto them | `impact` |
//! | convergence | a search that did not end, unless the scene accepts it | `convergence` |
//! | contact | a contact that nobody has foreseen: the rule in contact | `Method::find_end` |
//! | rounding | a stage that rounding hides: iterations of the exact minimiser go on | `rounding`, `whole` |
//!
//! Slenderness (`slenderness`) chooses the linear solver of the real-time minimiser, and refuses nothing.

use super::balance::{Balance, Solved};
use super::contact::SMALL;
use super::convergence::{accept_or_refuse, count, finish, refusal};
use super::energy;
use super::growth;
use super::holding;
use super::impact::Ending;
use super::memory;
use super::minimiser::Minimiser;
use super::newton::Newton;
use super::own_loss::{self, given};
use super::real_time::{self, RealTime};
use super::room::{Room, write};
use super::rule::Rule;
use super::settings::{Otherwise, Settings};
use super::standstill;
use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, HistorySize, Integrator};
use opruga_core::memory::Counts;
use opruga_core::potential::Views;
use opruga_core::spec::Values;
use opruga_core::system::{Stage, System, Work8};
use opruga_core::threads::each_block;
use opruga_math::WIDTH;
use opruga_solve::blocks::nodes;

/// An implicit rule as an integrator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Implicit<R> {
    pub(crate) rule: R,
    pub(crate) settings: Settings,
}

impl<R> Implicit<R> {
    /// A rule with the settings of a scene.
    ///
    /// # Errors
    /// [`BuildError`] where they exclude one another.
    pub(crate) fn new(kind: &'static str, rule: R, values: &Values) -> Result<Implicit<R>, BuildError> {
        Ok(Implicit { rule, settings: Settings::of_rule(kind, values)? })
    }

    /// Does something with the minimiser that the settings ask for.
    fn with_minimiser<T, const D: usize>(&self, action: impl FnOnce(&dyn Minimiser<D>) -> T) -> T {
        if self.settings.real_time { action(&RealTime(self.settings)) } else { action(&Newton(self.settings)) }
    }
}

impl<R: Rule<D>, const D: usize> Integrator<D> for Implicit<R> {
    fn name(&self) -> &'static str {
        R::NAME
    }
    fn needs(&self) -> Views {
        Views { hessian: true, ..Views::default() }
    }
    fn work_columns(&self) -> usize {
        1
    }
    fn history(&self) -> HistorySize {
        let own = self.rule.history();
        let more = self.with_minimiser(|minimiser: &dyn Minimiser<D>| minimiser.history());
        HistorySize {
            columns: own.columns + more.columns,
            numbers: own.numbers + more.numbers + growth::NUMBERS + standstill::NUMBERS,
        }
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
        let mut room = system.room.take::<Room<D>>();
        room.own = self.rule.history();
        let outcome = self.with_minimiser(|minimiser| {
            let method = Method { rule: self.rule, settings: &self.settings, minimiser };
            method.advance(system, &mut room, h, 0)
        });
        system.room.put(room);
        outcome
    }
}

/// Halvings of a step at most.
pub(crate) const MOST_HALVINGS: u32 = 8;

/// What makes a step: a rule, and the minimiser that finds its stage.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Method<'a, R, const D: usize> {
    pub(crate) rule: R,
    pub(crate) settings: &'a Settings,
    pub(crate) minimiser: &'a dyn Minimiser<D>,
}

/// A stage that has passed the guards, and the rule by which it was found.
#[derive(Clone, Copy, Debug)]
struct Found<R> {
    rule: R,
    balance: Balance,
    solved: Solved,
}

/// The ledger before a step, and after what is entered at its start.
struct Ledger {
    before: Work8,
    begun: Work8,
}

impl<R: Rule<D>, const D: usize> Method<'_, R, D> {
    /// Makes a step of h, or two of half the length where it does not converge: the outermost guard.
    pub(crate) fn advance(
        &self,
        system: &mut System<D>,
        room: &mut Room<D>,
        h: f64,
        halvings: u32,
    ) -> Result<(), StepError> {
        let work = system.work;
        let velocities = holding::take_hold(system, &mut room.kick, h);
        let outcome = self.attempt(system, room, h);
        if outcome.is_err() {
            // Nothing has been written but the ledger, and velocities that pins have changed.
            if let Some(before) = velocities {
                system.state.v = before;
            }
            let solver = system.work.solver;
            system.work = work;
            system.work.solver = solver;
            let broken_off = matches!(outcome, Err(StepError::BrokenOff));
            let asked_for = self.settings.otherwise == Otherwise::Halve || self.minimiser.always_halves();
            if !broken_off && asked_for && halvings < MOST_HALVINGS {
                let solver = &mut system.work.solver;
                solver.halved += 1;
                solver.deepest = solver.deepest.max(u64::from(halvings) + 1);
                self.advance(system, room, 0.5 * h, halvings + 1)?;
                return self.advance(system, room, 0.5 * h, halvings + 1);
            }
        }
        outcome
    }

    /// Makes a step of h from start to ledger.
    fn attempt(&self, system: &mut System<D>, room: &mut Room<D>, h: f64) -> Result<(), StepError> {
        let ledger = open_ledger::<R, D>(system, room, h)?;
        let found = self.find_end(system, room, h)?;
        self.refuse_growth(system, room, &found)?;
        finish(system, room);
        enter_stage(system, room, &found, &ledger);
        commit(system, room);
        enter_end(system, room, &found)?;
        found.rule.remember(system, room, h);
        self.minimiser.remember(system, room, h);
        system.end_implicit(h);
        let first = room.own.numbers + self.minimiser.history().numbers + growth::NUMBERS;
        standstill::look(system, room, first, h)
    }

    /// Finds the stage and the end of a step. The guards are asked in this order: contact, convergence, obstacles at the end of the
    /// step, energy of a minimiser that is not exact, energy of the rule. One that refuses says what makes the step instead.
    fn find_end(&self, system: &mut System<D>, room: &mut Room<D>, h: f64) -> Result<Found<R>, StepError> {
        let in_contact = self.rule.in_contact();
        let mut rule = in_contact.filter(|_| touches(system, room, h)).unwrap_or(self.rule);
        let exact = Newton(real_time::exactly(self.settings));
        let mut minimiser = self.minimiser;
        let mut energy = None;
        loop {
            let (balance, solved) = find_stage(rule, minimiser, system, room, h)?;
            if let Some(other) = in_contact.filter(|_| rule.in_contact().is_some() && room.contacting.any()) {
                // A contact that nobody has foreseen.
                rule = other;
                continue;
            }
            if !solved.converged {
                accept_or_refuse(R::NAME, self.settings, system, room, &solved)?;
            }
            let work = system.work;
            end(rule, system, room, &balance, h);
            if solved.doubtful && energy::gains_in_doubt(system, room, &balance)? {
                system.work = work;
                minimiser.discard(system, room);
                minimiser = &exact;
                continue;
            }
            let Some(calmed) = energy::calmer_rule(rule, &mut energy, system, room, &balance)? else {
                return Ok(Found { rule, balance, solved });
            };
            system.work = work;
            rule = calmed;
        }
    }

    /// The guard of growth: refuses a body that steps which have not converged have blown up.
    fn refuse_growth(&self, system: &mut System<D>, room: &Room<D>, found: &Found<R>) -> Result<(), StepError> {
        let slot = room.own.numbers + self.minimiser.history().numbers;
        let (time, solved) = (system.time, &found.solved);
        let refused = |hint| refusal(R::NAME, self.settings, room, solved, (time, None), hint);
        growth::check(system, room, slot, solved, refused)
    }
}

/// Takes the state at the start of a step, and enters the works of rules that go by the mean of start and end.
fn open_ledger<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    h: f64,
) -> Result<Ledger, StepError> {
    system.begin_implicit();
    room.load(system);
    let before = system.work;
    if R::TRAPEZOID {
        system.evaluate(Stage::Current, 0.0, 0.5 * h, &mut room.force)?;
    }
    own_loss::add_given(&mut system.work, &given(&before));
    Ok(Ledger { before, begun: system.work })
}

/// Enters the works of rules that go by the stage, which was evaluated last, and those of coupled masses.
fn enter_stage<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    found: &Found<R>,
    ledger: &Ledger,
) {
    let by_stage = !found.rule.is_trapezoid();
    if R::TRAPEZOID && by_stage {
        take_back(&mut system.work, &ledger.begun, &ledger.before);
    }
    let entered = given(&system.work);
    if by_stage {
        // Damping, loads and pins by the forces of the stage.
        system.evaluate_again(Room::<D>::STAGE, found.balance.time, found.balance.h, &mut room.force);
    }
    own_loss::add_given(&mut system.work, &entered);
    if system.inertia.is_some() {
        // Where held nodes are coupled, they have the velocity of the step to its end.
        let Room { v0, v1, .. } = &mut *room;
        system.held_axes(&mut |node, d| v1[node * D + d] = v0[node * D + d]);
        holding::enter_work(system, v0, v1);
    }
}

/// Enters the works at the end of a step of rules that go by the mean of start and end.
fn enter_end<R: Rule<D>, const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    found: &Found<R>,
) -> Result<(), StepError> {
    if found.rule.is_trapezoid() {
        let h = found.balance.h;
        system.hold(Stage::Current, h);
        let entered = given(&system.work);
        system.evaluate(Stage::Current, h, 0.5 * h, &mut room.force)?;
        own_loss::add_given(&mut system.work, &entered);
    }
    Ok(())
}

/// Takes out of a ledger what was entered between two moments.
fn take_back(work: &mut Work8, after: &Work8, before: &Work8) {
    for lane in 0..WIDTH {
        work.user[lane] -= after.user[lane] - before.user[lane];
        work.gas[lane] -= after.gas[lane] - before.gas[lane];
        work.damping[lane] -= after.damping[lane] - before.damping[lane];
        work.numerical[lane] -= after.numerical[lane] - before.numerical[lane];
    }
}

/// Finds the stage of a rule, from the motion of the last step on.
fn find_stage<R: Rule<D>, const D: usize>(
    rule: R,
    minimiser: &dyn Minimiser<D>,
    system: &mut System<D>,
    room: &mut Room<D>,
    h: f64,
) -> Result<(Balance, Solved), StepError> {
    room.contacting.clear(system.nodes);
    let balance = rule.begin(system, room, h);
    room.hold(system, balance.theta, h);
    // Held axes are where they have to be.
    let Room { u, held, v0, .. } = &mut *room;
    each_block(system.threads, D, [u], |first, [u]| {
        for (k, u) in (first..).zip(u) {
            *u = if held[k].is_nan() { balance.theta * h * v0[k] } else { held[k] };
        }
    });
    minimiser.predict(system, room, &balance);
    let solved = minimiser.minimise(system, room, &balance)?;
    count(system, &solved);
    Ok((balance, solved))
}

/// Works out the end of a step: displacement and velocity, with what obstacles do to them.
fn end<R: Rule<D>, const D: usize>(rule: R, system: &mut System<D>, room: &mut Room<D>, balance: &Balance, h: f64) {
    rule.end(system, room, balance, h);
    own_loss::take_impulses(system, room, balance);
    room.struck.clear();
    if system.contacts.is_none() {
        return;
    }
    for k in 0..room.memory.len() {
        room.memory[k] = rule.remembered(room, k, h);
    }
    let Room { contacting, mass, residual, x0, v0, u1, v1, memory, struck, extent, .. } = room;
    contacting.expel(system, x0, u1, residual, h, *extent);
    let ending = Ending { mass, reaction: residual, x0, v0, balance, extent: *extent };
    contacting.end(system, &ending, v1, memory, struck);
}

/// Whether any node would be on an obstacle at the end of the step, or in it, by its velocity alone.
fn touches<const D: usize>(system: &System<D>, room: &Room<D>, h: f64) -> bool {
    let Some(obstacles) = &system.contacts else { return false };
    nodes::<D>(&room.x0).iter().zip(nodes::<D>(&room.v0)).any(|(from, velocity)| {
        let to: [f64; D] = core::array::from_fn(|d| from[d] + h * velocity[d]);
        let mut near = false;
        let reach = SMALL * room.extent;
        obstacles.touch(from, &to, system.time + h, h, reach, &mut |touch| near |= touch.gap <= touch.rounding + reach);
        near
    })
}

/// Writes the end of the step into the state.
pub(crate) fn commit<const D: usize>(system: &mut System<D>, room: &Room<D>) {
    let (places, nodes, threads) = (system.places(), system.nodes, system.threads);
    let state = [&mut system.state.x, &mut system.state.v];
    write(places, nodes, threads, state, |k| [room.x0[k] + room.u1[k], room.v1[k]]);
}
