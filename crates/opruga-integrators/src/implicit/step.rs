//! A step of an implicit rule from start to ledger.

use super::contact::SMALL;
use super::growth;
use super::newton::{self, Balance, Solved};
use super::real_time;
use super::room::Room;
use super::settings::{Otherwise, Settings};
use super::standstill;
use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::{Amplification, HistorySize, Integrator};
use opruga_core::potential::Views;
use opruga_core::spec::Values;
use opruga_core::system::{Stage, System};
use opruga_solve::blocks::nodes;

/// What makes one implicit rule differ from another.
pub(crate) trait Rule<const D: usize>: Copy + core::fmt::Debug + Send + Sync + 'static {
    /// The word that names it.
    const NAME: &'static str;
    /// Whether works are integrated by the trapezoidal rule over start and end, or by the value in the stage.
    const TRAPEZOID: bool;
    /// The same rule for a step in which obstacles hold nodes: one that damps what is much faster than the step, which contact
    /// would stir up for ever.
    fn in_contact(self) -> Self {
        self
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
    fn takes_mass_matrix(&self) -> bool {
        true
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
    let outcome = attempt(rule, settings, system, room, h);
    if outcome.is_err() {
        // Nothing has been written but the ledger.
        let solver = system.work.solver;
        system.work = work;
        system.work.solver = solver;
        if settings.otherwise == Otherwise::Halve && halvings < MOST_HALVINGS {
            system.work.solver.halved += 1;
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
    room.contacting.clear(system.nodes);
    if R::TRAPEZOID {
        system.evaluate(Stage::Current, 0.0, 0.5 * h, &mut room.force)?;
    }
    let rule = if touches(system, room, h) { rule.in_contact() } else { rule };
    let balance = rule.begin(system, room, h);
    // From the motion of the last step; held axes are where they have to be.
    room.hold(system, balance.theta, h);
    for k in 0..room.u.len() {
        room.u[k] = if room.held[k].is_nan() { balance.theta * h * room.v0[k] } else { room.held[k] };
    }
    let solved = if settings.real_time {
        real_time::predict(system, room, balance.theta, h);
        real_time::solve(system, room, &balance, settings)?
    } else {
        newton::solve(system, room, &balance, settings)?
    };
    report(R::NAME, settings, system, room, &solved)?;

    rule.end(system, room, &balance, h);
    let own = room.own.numbers + if settings.real_time { real_time::NUMBERS } else { 0 };
    let time = system.time;
    growth::check(system, room, own, &solved, |hint| refusal(R::NAME, settings, room, &solved, time, hint))?;
    if system.contacts.is_some() {
        let Room { contacting, mass, residual, x0, v0, u1, v1, struck, extent, .. } = room;
        contacting.expel(system, x0, u1, residual, h, *extent);
        contacting.end(system, mass, residual, x0, v0, &balance, v1, struck);
    } else {
        room.struck.clear();
    }
    if !R::TRAPEZOID {
        // Damping, loads and pins by the forces of the stage, which was evaluated last.
        system.evaluate_again(Room::<D>::STAGE, balance.time, h, &mut room.force);
    }
    commit(system, room);
    if R::TRAPEZOID {
        system.hold(Stage::Current, h);
        system.evaluate(Stage::Current, h, 0.5 * h, &mut room.force)?;
    }
    rule.remember(system, room, h);
    if settings.real_time {
        real_time::remember(system, room, h);
    }
    system.end_implicit(h);
    standstill::look(system, room, own + growth::NUMBERS, h)
}

/// The factor by which what is much faster than a step falls in a step with contact, under rules that else damp nothing.
pub(crate) const RADIUS_IN_CONTACT: f64 = 0.8;

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
    let residual = room.largest_residual();
    let work = &mut system.work.solver;
    work.steps += 1;
    work.iterations += u64::from(solved.iterations);
    work.linear_iterations += u64::from(solved.products);
    work.residual = if residual > work.residual { residual } else { work.residual };
    if solved.converged {
        return Ok(());
    }
    if settings.otherwise == Otherwise::Accept {
        work.accepted += 1;
        return Ok(());
    }
    Err(refusal(integrator, settings, room, solved, system.time, settings.hint()))
}

/// The error of a step that did not converge.
fn refusal<const D: usize>(
    integrator: &'static str,
    settings: &Settings,
    room: &Room<D>,
    solved: &Solved,
    time: f64,
    hint: &'static str,
) -> StepError {
    StepError::NotConverged {
        integrator,
        iterations: solved.iterations,
        residual: room.largest_residual(),
        correction: solved.correction,
        tolerance: settings.tolerance * room.extent,
        time,
        beyond: None,
        hint,
    }
}

/// Writes the end of the step into the state.
pub(crate) fn commit<const D: usize>(system: &mut System<D>, room: &Room<D>) {
    let (places, nodes) = (system.places(), system.nodes);
    for d in 0..D {
        for place in 0..places {
            let k = place.min(nodes - 1) * D + d;
            system.state.x.0[d][place] = room.x0[k] + room.u1[k];
            system.state.v.0[d][place] = room.v1[k];
        }
    }
}

/// Whether the same bits come out on every processor.
pub(crate) fn same_bits_everywhere<const D: usize>(settings: &Settings, system: &System<D>) -> bool {
    let Settings { real_time, solver, .. } = *settings;
    !if real_time { solver.is_direct_in_real_time(system) } else { solver.is_direct::<D>(system.nodes) }
}
