//! A step of an implicit rule from start to ledger.

use super::newton::{Balance, Solved, solve};
use super::room::Room;
use super::settings::{Otherwise, Settings, Solver};
use opruga_core::error::StepError;
use opruga_core::system::{Stage, System};

/// What makes one implicit rule differ from another.
pub(crate) trait Rule<const D: usize>: Copy + core::fmt::Debug + Send + Sync {
    /// The word that names it.
    const NAME: &'static str;
    /// Whether works are integrated by the trapezoidal rule over start and end, or by the value in the stage.
    const TRAPEZOID: bool;
    /// Works y, z out of the state and the history, both less x₀, and the numbers of the balance.
    fn begin(&self, system: &System<D>, room: &mut Room<D>, h: f64) -> Balance;
    /// Works displacement `u1` and velocity `v1` of the end out of the stage.
    fn end(&self, system: &System<D>, room: &mut Room<D>, balance: &Balance, h: f64);
    /// Moves the history on, after obstacles have had their say; `room.struck` names the nodes that met one.
    fn remember(&self, _system: &mut System<D>, _room: &Room<D>, _h: f64) {}
    /// Whether the forces at the start are needed in `room.force`.
    fn needs_start(&self, _system: &System<D>) -> bool {
        false
    }
}

/// Halvings of a step at most.
const MOST_HALVINGS: u32 = 8;

/// Makes a step of h.
pub(crate) fn advance<R: Rule<D>, const D: usize>(
    rule: R,
    settings: &Settings,
    system: &mut System<D>,
    h: f64,
) -> Result<(), StepError> {
    let mut room = system.room.take::<Room<D>>();
    let outcome = advance_in(rule, settings, system, &mut room, h, 0);
    system.room.put(room);
    outcome
}

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
    room.contacting.clear();
    if R::TRAPEZOID || rule.needs_start(system) {
        let weight = if R::TRAPEZOID { 0.5 * h } else { 0.0 };
        system.evaluate(Stage::Current, 0.0, weight, &mut room.force)?;
    }
    let balance = rule.begin(system, room, h);
    // From the motion of the last step; held axes are where they have to be.
    room.hold(system, balance.theta, h);
    for k in 0..room.u.len() {
        room.u[k] = if room.held[k].is_nan() { balance.theta * h * room.v0[k] } else { room.held[k] };
    }
    let solved = solve(system, room, &balance, settings)?;
    report::<R, D>(settings, system, room, &solved)?;

    rule.end(system, room, &balance, h);
    if system.contacts.is_some() {
        let Room { contacting, mass, residual, x0, v0, u1, v1, struck, extent, .. } = room;
        contacting.expel(system, x0, u1, residual, h, *extent);
        contacting.end(system, mass, residual, x0, v0, &balance, v1, struck);
    } else {
        room.struck.clear();
    }
    if !R::TRAPEZOID {
        // Damping, loads and pins by the forces of the stage.
        system.evaluate(Room::<D>::STAGE, balance.time, h, &mut room.force)?;
    }
    commit(system, room);
    if R::TRAPEZOID {
        system.hold(Stage::Current, h);
        system.evaluate(Stage::Current, h, 0.5 * h, &mut room.force)?;
    }
    rule.remember(system, room, h);
    system.end_implicit(h);
    Ok(())
}

/// Enters what Newton did, and refuses what has not converged.
fn report<R: Rule<D>, const D: usize>(
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
    Err(StepError::NotConverged {
        integrator: R::NAME,
        iterations: solved.iterations,
        residual,
        correction: solved.correction,
        tolerance: settings.tolerance * room.extent,
        time: system.time,
    })
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
pub(crate) fn same_bits_everywhere<const D: usize>(solver: Solver, system: &System<D>) -> bool {
    !solver.is_direct::<D>(system.nodes)
}
