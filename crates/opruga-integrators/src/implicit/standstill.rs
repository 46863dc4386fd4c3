//! Bodies that stand still in a shape which is none of theirs: flat, inside out, or folded.
//!
//! A body that was squeezed onto a plane, a line or a point, or turned inside out, may be in balance there by symmetry alone:
//! no force leads out of the plane, though the energy falls on both sides of it. Newton's method, which follows the forces,
//! stays. So bodies are looked at now and then, and where one has come to rest while cells have no volume or a negative one,
//! or while cells are strained though nothing acts on the body, its free nodes are displaced by chance, the same chance in
//! every run: first by 10⁻⁴ of its size, then, each time after it had time to leave, by a hundredth and a tenth. Every time is
//! counted. What is still so after the last time stays, and is counted as such. A cell has no volume where one of its integration
//! points has none, whatever its mean.
//!
//! A body that left is one that kept a shape of its own as long as it would have had time to leave: one that goes to and fro about
//! the limit, good at one look and flat at the next, goes on where it was, and comes to the last time.
//!
//! Strained bodies on which something acts, a pin, an obstacle or a load, are left alone here, as those are that were meant to
//! snap through: that they hold more than what acts on them accounts for is told at the end (`cells.other_balance`).
//!
//! At rest is a body whose kinetic energy and whose forces out of balance are small against the energy U that its cells hold,
//! ½ Σ m v² ≪ U and Σ m |a| L ≪ U, and which does not give it to damping: one that creeps against its viscosity, as slowly as it
//! may, is on its way. The time to leave is a multiple of L √(M/U), where L is its size and M its mass; a body at rest would lose
//! little of U in that time.
//!
//! A body all of whose cells are flat has a motion along its plane or line that may go on for ever, and leads nowhere: it is
//! displaced once it had time to leave, whatever it does there.
//!
//! Bodies of models without cells, such as springs, are left alone.

use super::workspace::{Workspace, write};
use opruga_core::error::StepError;
use opruga_core::potential::{Account, CellState};
use opruga_core::state::Columns;
use opruga_core::system::{SolverWork, Stage, State, System};
use opruga_math::{Lane, sum_in_fixed_order};
use opruga_solve::blocks::nodes;
use opruga_solve::dense::symmetric_eigen;

/// Steps between two looks, and steps more after a look that found nothing: a look costs about as much as evaluating forces.
const PERIOD: f64 = 24.0;
const IDLE: f64 = 72.0;

/// Kinetic energy, and what is given to damping in the time to leave, that count as rest, as parts of the stored energy.
const REST: f64 = 1e-3;

/// Forces out of balance times the size that count as rest, as a part of the stored energy: a tremble with 10⁻⁷ of it has a
/// thousandth.
const BALANCED: f64 = 1e-2;

/// How long a disturbed body has to leave, in units of L √(M/U).
const PATIENCE: f64 = 12.0;

/// By how much nodes are displaced, in sizes of the body: the cube root of its volume, the square root of its area.
const SIZES: [f64; 3] = [1e-4, 1e-2, 0.1];

/// The axes of space.
const UNITS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Cells below this part of their volume have none.
const FLAT: f64 = 1e-3;

/// Cells of a body on which nothing acts are strained where their volume has changed by more than this part of it.
const STRAINED: f64 = 1e-3;

/// What the state remembers: steps since the last look, how often the body was disturbed since it left its last odd shape, one
/// more where that was in vain, when it was disturbed last [s], at how many looks all of it was flat, and until when a shape of
/// its own does not count as having left [s].
pub(crate) const NUMBERS: usize = 5;

/// Looks at a body at the end of a step of h [s], now and then; `first` is the place of what is remembered.
pub(crate) fn look<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    first: usize,
    h: f64,
) -> Result<(), StepError> {
    let [steps, times, last, flat, until] = core::array::from_fn(|k| system.history.numbers[first + k]);
    system.history.numbers[first] = steps + 1.0;
    if steps + 1.0 < PERIOD {
        return Ok(());
    }
    system.history.numbers[first] = 0.0;
    let Some(size) = degenerate_size(system, Stage::Current) else {
        let times = if system.time > until { 0.0 } else { times };
        system.history.numbers[first..first + NUMBERS].copy_from_slice(&[-IDLE, times, last, 0.0, until]);
        return Ok(());
    };
    let flat = if is_flat(system) { flat + 1.0 } else { 0.0 };
    system.history.numbers[first + 3] = flat;
    let energy = stored(system, &mut workspace.force)?;
    let Motion { kinetic, push, mass, fading } = motion(system, workspace, h)?;
    let patience = PATIENCE * size * (mass / energy).sqrt();
    // Numbers of the state are finite; what holds no energy has for ever to leave.
    let until = system.time + patience;
    system.history.numbers[first + 4] = if until.is_finite() { until } else { f64::MAX };
    if times > SIZES.len() as f64 {
        return Ok(());
    }
    let had_time = system.time - last > patience;
    let waits = times > 0.0 && !had_time;
    let rests = |part: f64| part <= REST * energy;
    let stays = flat * PERIOD * h > patience;
    if waits || !(stays || rests(kinetic) && push * size <= BALANCED * energy && rests(fading * patience)) {
        return Ok(());
    }
    system.history.numbers[first + 3] = 0.0;
    system.history.numbers[first + 1] = times + 1.0;
    system.history.numbers[first + 2] = system.time;
    match SIZES.get(times as usize) {
        Some(part) => disturb_state(system, &mut workspace.force, part * size, times as u64)?,
        None => system.work.solver.odd_rests += 1,
    }
    Ok(())
}

/// Displaces a balance that was looked for, in `workspace.u`, if it is none of the body's own; `times` is how often that was done.
/// Gives whether it did.
pub(crate) fn disturb_balance<const D: usize>(
    system: &mut System<D>,
    workspace: &mut Workspace<D>,
    times: usize,
) -> bool {
    let Some(size) = degenerate_size(system, Workspace::<D>::STAGE) else { return false };
    let Some(part) = SIZES.get(times) else {
        system.work.solver.odd_rests += 1;
        return false;
    };
    system.work.solver.disturbed += 1;
    for k in 0..workspace.u.len() {
        if workspace.held[k].is_nan() {
            workspace.u[k] += part * size * random_error(k, times as u64);
        }
    }
    true
}

/// Takes back what was counted since `before` where a body in a shape of its own has come to another one of its own: what was flat or
/// folded between them was a wrong turn on the way from one balance to the next, and no shape in which the body stood still.
pub(crate) fn forget_wrong_turns<const D: usize>(system: &mut System<D>, before: &SolverWork) {
    let ends_well = system.work.solver.odd_rests == before.odd_rests;
    if ends_well && degenerate_size(system, Stage::Current).is_none() {
        system.work.solver.disturbed = before.disturbed;
    }
}

/// How a body moves.
struct Motion {
    /// The kinetic energy [J].
    kinetic: f64,
    /// The sum of the forces that change velocities [N].
    push: f64,
    /// The mass [kg].
    mass: f64,
    /// The energy that damping takes [W].
    fading: f64,
}

/// The motion of a body; of a free one as seen from its centre of mass, and from axes that turn with it: what spins stands still
/// too. After [`stored`], which leaves the forces of the state in `workspace.force`.
fn motion<const D: usize>(system: &mut System<D>, workspace: &mut Workspace<D>, h: f64) -> Result<Motion, StepError> {
    let damped = system.is_damped();
    if damped {
        undamped(system, &mut workspace.outer)?;
    }
    let (system, workspace) = (&*system, &*workspace);
    let mut mass = 0.0;
    let (mut center, mut speed, mut change) = ([0.0; D], [0.0; D], [0.0; D]);
    let old = nodes::<D>(&workspace.v0);
    for (node, old) in old.iter().enumerate() {
        let (x, v, m) = (system.state.x.at(node), system.state.v.at(node), system.mass.at(node));
        mass += m;
        for d in 0..D {
            center[d] += m * x[d];
            speed[d] += m * v[d];
            change[d] += m * (v[d] - old[d]);
        }
    }
    let free = system.pins.is_empty() && system.contacts.is_none();
    if !free {
        (speed, change) = ([0.0; D], [0.0; D]);
    }
    let arm = |node: usize| -> [f64; D] {
        let x = system.state.x.at(node);
        core::array::from_fn(|d| x[d] - center[d] / mass)
    };
    let velocity = |node: usize| -> [f64; D] {
        let v = system.state.v.at(node);
        core::array::from_fn(|d| v[d] - speed[d] / mass)
    };
    let spin = if free { rotation(system, &velocity, &arm) } else { [0.0; 3] };
    // What a body that tumbles has of accelerations: those that keep it together and turn its axis.
    let acceleration = |node: usize| -> [f64; D] {
        let (v, inward) = (system.state.v.at(node), turned(&spin, &turned(&spin, &arm(node))));
        core::array::from_fn(|d| (v[d] - old[node][d] - change[d] / mass) / h - inward[d])
    };
    let tumble = if free { rotation(system, &acceleration, &arm) } else { [0.0; 3] };
    let (mut kinetic, mut push, mut fading) = (0.0, 0.0, 0.0);
    for node in 0..system.nodes {
        let m = system.mass.at(node);
        let (own, left) = (velocity(node), acceleration(node));
        let (turning, turned_more) = (turned(&spin, &arm(node)), turned(&tumble, &arm(node)));
        let (all, rest) = (workspace.force.at(node), workspace.outer.at(node));
        for d in 0..D {
            let own = own[d] - turning[d];
            kinetic += 0.5 * m * own * own;
            push += m * (left[d] - turned_more[d]).abs();
            // Held nodes are led by others.
            if damped && workspace.held[node * D + d].is_nan() {
                fading -= (all[d] - rest[d]) * own;
            }
        }
    }
    Ok(Motion { kinetic, push, mass, fading })
}

/// The forces on the nodes of a state as they would be if nothing moved [N].
fn undamped<const D: usize>(system: &mut System<D>, out: &mut Columns<D>) -> Result<(), StepError> {
    let (places, nodes, threads) = (system.places(), system.nodes, system.threads);
    let State { x, work, .. } = &mut system.state;
    write(places, nodes, threads, work[0].each_mut(), |k| [x.0[k % D][k / D], 0.0]);
    system.evaluate(Workspace::<D>::STAGE, 0.0, 0.0, out)
}

/// The angular velocity [rad/s] of the rotation about the centre that is nearest to the velocities of a body beyond their mean; of
/// accelerations the angular acceleration [rad/s²].
fn rotation<const D: usize>(
    system: &System<D>,
    field: &dyn Fn(usize) -> [f64; D],
    arm: &dyn Fn(usize) -> [f64; D],
) -> [f64; 3] {
    let turns: Vec<[f64; 3]> = if D == 2 { vec![[0.0, 0.0, 1.0]] } else { UNITS.to_vec() };
    let n = turns.len();
    let (mut inertia, mut momentum) = (vec![0.0; n * n], vec![0.0; n]);
    for node in 0..system.nodes {
        let (v, m, arm) = (field(node), system.mass.at(node), arm(node));
        let displacements: Vec<[f64; D]> = turns.iter().map(|turn| turned(turn, &arm)).collect();
        for p in 0..n {
            for d in 0..D {
                momentum[p] += m * displacements[p][d] * v[d];
                for q in 0..n {
                    inertia[p * n + q] += m * displacements[p][d] * displacements[q][d];
                }
            }
        }
    }
    // A body on a line has no inertia about it.
    let (values, vectors) = symmetric_eigen(&inertia, n);
    let least = 1e-9 * values.last().copied().unwrap_or(0.0);
    let mut out = [0.0; 3];
    for (value, vector) in values.iter().zip(&vectors).filter(|(value, _)| **value > least) {
        let part = vector.iter().zip(&momentum).map(|(a, b)| a * b).sum::<f64>() / value;
        for (turn, weight) in turns.iter().zip(vector) {
            for d in 0..3 {
                out[d] += part * weight * turn[d];
            }
        }
    }
    out
}

/// ω × r; in the plane ω is along z.
fn turned<const D: usize>(spin: &[f64; 3], arm: &[f64; D]) -> [f64; D] {
    let r: [f64; 3] = core::array::from_fn(|d| if d < D { arm[d] } else { 0.0 });
    core::array::from_fn(|d| {
        let (e, f) = ((d + 1) % 3, (d + 2) % 3);
        spin[e] * r[f] - spin[f] * r[e]
    })
}

/// The size of a body that is flat, inside out or strained by nothing; none where its shape is one of its own.
fn degenerate_size<const D: usize>(system: &System<D>, stage: Stage) -> Option<f64> {
    let view = system.view(stage, system.time);
    let (mut volume, mut degenerate) = (0.0, false);
    let alone = is_left_alone(system);
    for member in &system.members {
        let cells = member.potential.cell_states(&view, 0);
        degenerate |= cells.iter().any(|cell| is_degenerate(cell, alone));
        volume += cells.iter().map(|cell| cell.measure).sum::<f64>();
    }
    degenerate.then(|| if D == 2 { volume.sqrt() } else { Lane::exp(Lane::ln(volume) / 3.0) })
}

/// How many cells of the state are flat or inside out, and how many there are; none where none is.
pub(crate) fn flat_cells<const D: usize>(system: &System<D>) -> Option<[usize; 2]> {
    let view = system.view(Stage::Current, system.time);
    let (mut flat, mut all) = (0, 0);
    for member in &system.members {
        let cells = member.potential.cell_states(&view, 0);
        flat += cells.iter().filter(|cell| is_degenerate(cell, false)).count();
        all += cells.len();
    }
    (flat > 0).then_some([flat, all])
}

/// Whether every cell of a body is flat.
fn is_flat<const D: usize>(system: &System<D>) -> bool {
    let view = system.view(Stage::Current, system.time);
    let mut cells = system.members.iter().flat_map(|member| member.potential.cell_states(&view, 0)).peekable();
    cells.peek().is_some() && cells.all(|cell| cell.volume_ratio.abs() <= FLAT)
}

/// Whether a cell of a body that stands still has no shape of its own; `alone` says that nothing acts on the body.
fn is_degenerate(cell: &CellState, alone: bool) -> bool {
    // Written so that what is no number is odd.
    let solid = cell.smallest_volume_ratio > FLAT;
    !solid || alone && (cell.volume_ratio - 1.0).abs() > STRAINED
}

/// Whether nothing acts on the cells of a body that stands still but themselves.
fn is_left_alone<const D: usize>(system: &System<D>) -> bool {
    let view = system.view(Stage::Current, system.time);
    system.pins.is_empty()
        && system.contacts.is_none()
        && system.members.iter().all(|member| {
            let potential = &member.potential;
            potential.properties().account == Account::Elastic
                && (!potential.properties().views.energy || !potential.cell_states(&view, 0).is_empty())
        })
}

/// Displaces the free nodes of a state; the energy that this takes is work from outside.
fn disturb_state<const D: usize>(
    system: &mut System<D>,
    force: &mut Columns<D>,
    size: f64,
    times: u64,
) -> Result<(), StepError> {
    let kept = system.state.x.clone();
    let before = system.stored_energy(Stage::Current, 0.0);
    for node in 0..system.nodes {
        let mut x = kept.at(node);
        for d in 0..D {
            x[d] += size * random_error(node * D + d, times);
        }
        system.state.x.set(node, x);
    }
    system.hold(Stage::Current, 0.0);
    system.work.solver.disturbed += 1;
    if system.evaluate(Stage::Current, 0.0, 0.0, force).is_err() {
        // The law has no meaning there.
        system.state.x = kept;
        return system.evaluate(Stage::Current, 0.0, 0.0, force);
    }
    let given = system.stored_energy(Stage::Current, 0.0) - before;
    system.work.user[0] += given;
    // The rule had no part in it.
    system.work.numerical[0] += given;
    Ok(())
}

/// The energy that the models of a body with cells hold [J].
fn stored<const D: usize>(system: &mut System<D>, force: &mut Columns<D>) -> Result<f64, StepError> {
    system.evaluate(Stage::Current, 0.0, 0.0, force)?;
    let view = system.view(Stage::Current, system.time);
    let elastic = system.members.iter().filter(|member| member.potential.properties().account == Account::Elastic);
    Ok(elastic.map(|member| sum_in_fixed_order(&member.potential.energy(system.simd, &view, &member.scratch))).sum())
}

/// A number from −1 to 1 that belongs to a coordinate and a time of asking.
fn random_error(coordinate: usize, times: u64) -> f64 {
    let mut state = (coordinate as u64 + 1) ^ (times << 48);
    for _ in 0..3 {
        // Knuth's linear congruential generator, and the mixing of its upper bits into the lower ones.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state ^= state >> 29;
    }
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
