//! A step of an implicit rule from start to ledger.

use super::balance::{Balance, Solved};
use super::contact::{SMALL, dot};
use super::growth;
use super::holding;
use super::impact::Ending;
use super::memory;
use super::newton;
use super::own_loss::{self, given};
use super::real_time;
use super::room::{Room, write};
use super::settings::{Otherwise, Settings};
use super::stage;
use super::standstill;
use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, HistorySize, Integrator};
use opruga_core::memory::Counts;
use opruga_core::potential::{Account, Views};
use opruga_core::spec::Values;
use opruga_core::system::{Pin, Stage, System, Work8};
use opruga_core::threads::each_block;
use opruga_math::words::number;
use opruga_math::{Lane, WIDTH};
use opruga_solve::blocks::nodes;

/// What makes one implicit rule differ from another.
pub(crate) trait Rule<const D: usize>: Copy + core::fmt::Debug + Send + Sync + 'static {
    /// The word that names it.
    const NAME: &'static str;
    /// Whether works are integrated by the trapezoidal rule over start and end, or by the value in the stage.
    const TRAPEZOID: bool;
    /// The same of the rule in the form in which a step was made.
    fn is_trapezoid(&self) -> bool {
        Self::TRAPEZOID
    }
    /// The same rule for a step in which obstacles hold nodes, if it is another one then: one that damps what is much faster
    /// than the step, which contact would stir up for ever.
    fn in_contact(self) -> Option<Self> {
        None
    }
    /// The rule instead of this one where a body in contact would gain energy by it.
    fn calmed(self) -> Option<Self> {
        None
    }
    /// What it remembers from step to step.
    fn history(&self) -> HistorySize {
        HistorySize::default()
    }
    /// What one step makes of the damped oscillator, as [`Integrator::amplification`].
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification;
    /// Works y, z out of the state and the history, both less x₀, and the numbers of the balance.
    fn begin(&self, system: &System<D>, room: &mut Room<D>, h: f64) -> Balance;
    /// Works displacement `u1` and velocity `v1` of the end out of the stage.
    fn end(&self, system: &System<D>, room: &mut Room<D>, balance: &Balance, h: f64);
    /// What a step after this one of the same length will add to the velocity of a coordinate out of what is remembered,
    /// besides the forces [m/s]: v₁ and this together change by h F/m in every step.
    fn remembered(&self, _room: &Room<D>, _k: usize, _h: f64) -> f64 {
        0.0
    }
    /// Moves the history on, after obstacles have had their say; `room.struck` names the nodes that met one.
    fn remember(&self, _system: &mut System<D>, _room: &Room<D>, _h: f64) {}
}

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
        let more = |here: usize| if self.settings.real_time { here } else { 0 };
        HistorySize {
            columns: own.columns + more(real_time::COLUMNS),
            numbers: own.numbers + more(real_time::NUMBERS) + growth::NUMBERS + standstill::NUMBERS,
        }
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        self.rule.amplification(omega, c, h)
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        same_bits_everywhere(&self.settings, system)
    }
    fn shares_threads(&self) -> bool {
        self.settings.real_time
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
        let outcome = advance_in(self.rule, &self.settings, system, &mut room, h, 0);
        system.room.put(room);
        outcome
    }
}

/// Halvings of a step at most.
pub(crate) const MOST_HALVINGS: u32 = 8;

/// Makes a step of h, or two of half the length where it does not converge.
fn advance_in<R: Rule<D>, const D: usize>(
    rule: R,
    settings: &Settings,
    system: &mut System<D>,
    room: &mut Room<D>,
    h: f64,
    halvings: u32,
) -> Result<(), StepError> {
    let work = system.work;
    let velocities = holding::take_hold(system, &mut room.kick, h);
    let outcome = attempt(rule, settings, system, room, h);
    if outcome.is_err() {
        // Nothing has been written but the ledger, and velocities that pins have changed.
        if let Some(before) = velocities {
            system.state.v = before;
        }
        let solver = system.work.solver;
        system.work = work;
        system.work.solver = solver;
        // In real time nobody waits for another setting.
        let broken_off = matches!(outcome, Err(StepError::BrokenOff));
        let halves = !broken_off && (settings.otherwise == Otherwise::Halve || settings.real_time);
        if halves && halvings < MOST_HALVINGS {
            let solver = &mut system.work.solver;
            solver.halved += 1;
            solver.deepest = solver.deepest.max(u64::from(halvings) + 1);
            advance_in(rule, settings, system, room, 0.5 * h, halvings + 1)?;
            return advance_in(rule, settings, system, room, 0.5 * h, halvings + 1);
        }
    }
    outcome
}

fn attempt<R: Rule<D>, const D: usize>(
    rule: R,
    settings: &Settings,
    system: &mut System<D>,
    room: &mut Room<D>,
    h: f64,
) -> Result<(), StepError> {
    system.begin_implicit();
    room.load(system);
    let work_before = system.work;
    if R::TRAPEZOID {
        system.evaluate(Stage::Current, 0.0, 0.5 * h, &mut room.force)?;
    }
    own_loss::add_given(&mut system.work, &given(&work_before));
    let begun = system.work;
    let in_contact = rule.in_contact();
    let mut used = in_contact.filter(|_| touches(system, room, h)).unwrap_or(rule);
    let mut energy = None;
    let mut exactly = None;
    let (balance, solved, rule) = loop {
        let (balance, solved) = solve(used, exactly.as_ref().unwrap_or(settings), system, room, h)?;
        if let Some(other) = in_contact.filter(|_| used.in_contact().is_some() && room.contacting.any()) {
            // A contact that nobody has foreseen.
            used = other;
            continue;
        }
        if !solved.converged {
            accept_or_refuse(R::NAME, settings, system, room, &solved)?;
        }
        let work = system.work;
        end(used, system, room, &balance, h);
        if solved.doubtful {
            let gained = match energy_before(system, room, h)? {
                Some(before) => gains(system, room, before, h, LITTLE_GAIN)?,
                // Nobody knows what it may have gained.
                None => true,
            };
            if gained {
                system.work = work;
                real_time::distrust(system, room);
                exactly = Some(real_time::exactly(settings));
                continue;
            }
            stage::evaluate(system, room, &balance, false)?;
        }
        let Some(calmed) = used.calmed().filter(|_| room.contacting.any_at_rest()) else {
            break (balance, solved, used);
        };
        if energy.is_none() {
            energy = Some(energy_before(system, room, h)?);
        }
        let Some(before) = energy.flatten() else { break (balance, solved, used) };
        if !gains(system, room, before, h, 0.0)? {
            // What is entered below goes by the stage.
            stage::evaluate(system, room, &balance, false)?;
            break (balance, solved, used);
        }
        system.work = work;
        used = calmed;
    };
    let own = room.own.numbers + if settings.real_time { real_time::NUMBERS } else { 0 };
    let time = system.time;
    growth::check(system, room, own, &solved, |hint| refusal(R::NAME, settings, room, &solved, (time, None), hint))?;
    finish(system, room);
    if R::TRAPEZOID && !rule.is_trapezoid() {
        take_back(&mut system.work, &begun, &work_before);
    }
    let entered = given(&system.work);
    if !rule.is_trapezoid() {
        // Damping, loads and pins by the forces of the stage, which was evaluated last.
        system.evaluate_again(Room::<D>::STAGE, balance.time, h, &mut room.force);
    }
    own_loss::add_given(&mut system.work, &entered);
    if system.inertia.is_some() {
        // Where held nodes are coupled, they have the velocity of the step to its end.
        let Room { v0, v1, .. } = &mut *room;
        system.held_axes(&mut |node, d| v1[node * D + d] = v0[node * D + d]);
        holding::enter_work(system, v0, v1);
    }
    commit(system, room);
    if rule.is_trapezoid() {
        system.hold(Stage::Current, h);
        let entered = given(&system.work);
        system.evaluate(Stage::Current, h, 0.5 * h, &mut room.force)?;
        own_loss::add_given(&mut system.work, &entered);
    }
    rule.remember(system, room, h);
    if settings.real_time {
        real_time::remember(system, room, h);
    }
    system.end_implicit(h);
    standstill::look(system, room, own + growth::NUMBERS, h)
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

/// Looks for the stage of a rule.
fn solve<R: Rule<D>, const D: usize>(
    rule: R,
    settings: &Settings,
    system: &mut System<D>,
    room: &mut Room<D>,
    h: f64,
) -> Result<(Balance, Solved), StepError> {
    room.contacting.clear(system.nodes);
    let balance = rule.begin(system, room, h);
    // From the motion of the last step; held axes are where they have to be.
    room.hold(system, balance.theta, h);
    let Room { u, held, v0, .. } = &mut *room;
    each_block(system.threads, D, [u], |first, [u]| {
        for (k, u) in (first..).zip(u) {
            *u = if held[k].is_nan() { balance.theta * h * v0[k] } else { held[k] };
        }
    });
    let solved = if settings.real_time {
        real_time::predict(system, room, balance.theta, h);
        real_time::solve(system, room, &balance, settings)?
    } else {
        newton::solve(system, room, &balance, settings)?
    };
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

/// The energy of a body before a step [J]; none where it may gain some: from loads, a gas or moving pins.
fn energy_before<const D: usize>(system: &mut System<D>, room: &mut Room<D>, h: f64) -> Result<Option<f64>, StepError> {
    let moves = |pin: &Pin<D>| pin.target(system.time).0 != pin.target(system.time + h).0;
    let given = system.members.iter().any(|member| member.potential.account() != Account::Elastic);
    if given || system.pins.iter().any(moves) {
        return Ok(None);
    }
    system.evaluate(Stage::Current, 0.0, 0.0, &mut room.force)?;
    Ok(system.potential_energy(Stage::Current, 0.0).map(|stored| stored + system.kinetic_energy()))
}

/// Gains of energy below this part of it are rounding.
const NO_GAIN: f64 = 1e-9;

/// The part of its energy of motion that a body may gain in a step in real time.
const LITTLE_GAIN: f64 = 1e-3;

/// Whether a body has more energy at the end of the step than before, and than a part of that of its motion.
fn gains<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    before: f64,
    h: f64,
    part: f64,
) -> Result<bool, StepError> {
    Room::show(system, &room.x0, &room.u1, &room.z, 0.0);
    system.evaluate(Room::<D>::STAGE, h, 0.0, &mut room.force)?;
    // What cannot be told is a gain where some is allowed for.
    let Some(stored) = system.potential_energy(Room::<D>::STAGE, h) else { return Ok(part > 0.0) };
    let mut kinetic = 0.0;
    for (velocity, mass) in nodes::<D>(&room.v1).iter().zip(&room.mass) {
        kinetic += 0.5 * mass * dot(velocity, velocity);
    }
    if let Some(inertia) = &system.inertia {
        kinetic += 0.5 * inertia.square::<D>(&room.v1);
    }
    let after = stored + kinetic;
    // Written so that what is no number is a gain.
    let within = after - before <= NO_GAIN * (after.abs() + before.abs() + kinetic) + part * kinetic;
    Ok(!within)
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

/// Enters what Newton did, and refuses what has not converged.
pub(crate) fn report<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    system: &mut System<D>,
    room: &Room<D>,
    solved: &Solved,
) -> Result<(), StepError> {
    count(system, solved);
    finish(system, room);
    if solved.converged { Ok(()) } else { accept_or_refuse(integrator, settings, system, room, solved) }
}

fn count<const D: usize>(system: &mut System<D>, solved: &Solved) {
    let work = &mut system.work.solver;
    work.iterations += u64::from(solved.iterations);
    work.linear_iterations += u64::from(solved.products);
    work.blurred += u64::from(solved.blur > 0.0);
    work.blur = solved.blur.larger(work.blur);
    work.conditioned += u64::from(solved.conditioning > 1.0);
    work.conditioning = solved.conditioning.larger(work.conditioning);
}

fn finish<const D: usize>(system: &mut System<D>, room: &Room<D>) {
    let work = &mut system.work.solver;
    work.steps += 1;
    work.residual = room.largest_residual().larger(work.residual);
}

/// Counts a step that has not converged, or refuses it.
fn accept_or_refuse<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    system: &mut System<D>,
    room: &Room<D>,
    solved: &Solved,
) -> Result<(), StepError> {
    if settings.otherwise == Otherwise::Accept {
        system.work.solver.accepted += 1;
        return Ok(());
    }
    let flat_cells = standstill::flat_cells(system);
    Err(refusal(integrator, settings, room, solved, (system.time, flat_cells), settings.hint()))
}

/// The error of a step that did not converge, with its time [s] and the cells that it found flat or inside out.
fn refusal<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    room: &Room<D>,
    solved: &Solved,
    (time, flat_cells): (f64, Option<[usize; 2]>),
    hint: &'static str,
) -> StepError {
    let (residual, tolerance) = (room.largest_residual(), settings.tolerance * room.extent);
    let [of_positions, of_forces, way] = solved.floor;
    // Iterations that were too few say nothing of rounding.
    let is_stuck = solved.iterations < settings.iterations;
    let is_lost = solved.correction <= LOST * of_positions || residual <= LOST * of_forces || way > room.extent;
    let is_rounding = is_stuck && is_lost;
    StepError::NotConverged {
        integrator,
        iterations: solved.iterations,
        residual,
        correction: solved.correction,
        tolerance,
        time,
        beyond: None,
        flat_cells,
        hint: if is_rounding { hint_of_rounding(solved.floor).into() } else { hint.into() },
    }
}

/// Forces and corrections within so many roundings were lost in these, as is a body that its rounding would throw farther than its extent.
const LOST: f64 = 10.0;

/// What helps where a step was lost in the rounding of positions and forces.
fn hint_of_rounding([of_positions, of_forces, _]: [f64; 3]) -> String {
    format!(
        "positions have sixteen digits here, which leave {} m and forces of {} N open: a larger `tolerance`, a scene nearer to the \
         origin, larger cells, or a body that is less stiff",
        number(of_positions),
        number(of_forces)
    )
}

/// Writes the end of the step into the state.
pub(crate) fn commit<const D: usize>(system: &mut System<D>, room: &Room<D>) {
    let (places, nodes, threads) = (system.places(), system.nodes, system.threads);
    let state = [&mut system.state.x, &mut system.state.v];
    write(places, nodes, threads, state, |k| [room.x0[k] + room.u1[k], room.v1[k]]);
}

/// Whether the same bits come out on every processor.
pub(crate) fn same_bits_everywhere<const D: usize>(settings: &Settings, system: &System<D>) -> bool {
    let Settings { real_time, solver, .. } = *settings;
    !if real_time { solver.is_direct_in_real_time(system) } else { solver.is_direct::<D>(system.nodes) }
}
