//! The real-time setting: few iterations with a matrix that is kept, as long as it leads to the end of a step.
//!
//! Every iteration balances the exact forces; the matrix only says how far to go. Where it is of another shape of the body,
//! or its equations are solved roughly, what is left out of balance is a part of what there was; the next step begins with
//! it. At rest nothing is left. The iteration begins where the body would come to under the acceleration of the last step.
//!
//! Sizes of what is out of balance are taken in the norm of the inverse diagonal blocks of the matrix, √(r·B r).

use super::balance::{Balance, Solved};
use super::direction::wanted_forces;
use super::linear::{Filter, Mixture};
use super::minimiser::Minimiser;
use super::newton::Newton;
use super::room::Room;
use super::settings::Settings;
use super::stage::{evaluate, judge, look, potential, rounding_of_models};
use super::whole::settles;
use opruga_core::error::StepError;
use opruga_core::integrator::HistorySize;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_core::threads::each_block;
use opruga_math::Lane;
use opruga_solve::Indefinite;

/// The part of what is out of balance that the linear solver leaves at most.
const LINEAR: f64 = 0.05;

/// The part with which the matrix is made anew in the next step.
const WORN: f64 = 0.2;

/// The part that the linear solver leaves of bodies that are free or near obstacles; an iteration is enough with its square.
const LOOSE: f64 = 1e-3;

/// What is out of balance counts as nothing where it moves nodes by less than this part of the extent.
const NOTHING: f64 = 1e-9;

/// Products with the matrix in an iteration at most.
const PRODUCTS: u32 = 1000;

/// A potential that has risen by this part of its parts has risen: rounding, and what obstacles push back, are less.
const RISE: f64 = 1e-6;

/// Corrections below this part of the extent are those of a body that is whole.
const SHORT: f64 = 0.1;

/// How many iterations steps get that few led astray.
const MOST_ITERATIONS: u32 = 50;

/// Iterations that take more products than this are counted as cut off: a body on which news travels so slowly is ill-conditioned,
/// and the residual, in which stiff motions count most, says little of the slow ones, such as the bending of a slender body.
const MANY_PRODUCTS: u32 = 120;

/// What the setting adds to what a rule remembers: the reference shape of the matrix and the velocities before the step;
/// which matrix it is, and the length of the step.
const COLUMNS: usize = 2;
const NUMBERS: usize = 2;

/// Numbers of the history: the matrix of elements without negative eigenvalues, above it ones with a raised diagonal. Zero is
/// none, a negative number one that is to be made anew.
const CLAMPED: f64 = 1.0;
const MOST_RAISED: f64 = 5.0;

/// By how much the diagonal is raised.
fn raised(kind: f64) -> f64 {
    let mut part = 0.0;
    for k in 0..(kind - CLAMPED) as u32 {
        part = if k == 0 { 1e-8 } else { 100.0 * part };
    }
    part
}

/// Whether nothing holds a body, or obstacles may be near. What is left out of balance would push and turn it, a matrix of
/// another shape is one that is turned, and the acceleration of an impact leads nowhere: nothing is kept from step to step.
fn is_loose<const D: usize>(system: &System<D>) -> bool {
    system.contacts.is_some() || system.pins.is_empty()
}

/// Where the body would come to under the acceleration of the last step, less x₀: in `room.u`.
fn predict<const D: usize>(system: &System<D>, room: &mut Room<D>, theta: f64, h: f64) {
    let last = system.history.numbers[room.own.numbers + 1];
    if last <= 0.0 || is_loose(system) {
        return;
    }
    let before = &system.history.columns[room.own.columns + 1];
    let share = theta * theta * h * h / last;
    let Room { u, held, v0, .. } = room;
    each_block(system.threads, D, [u], |first, [u]| {
        for (node, u) in (first / D..).zip(u.as_chunks_mut::<D>().0) {
            for d in 0..D {
                let k = node * D + d;
                if held[k].is_nan() {
                    u[d] += share * (v0[k] - before.0[d][node]);
                }
            }
        }
    });
}

/// Keeps the velocities at the start of a step; nodes that met an obstacle go on as they do then.
fn remember<const D: usize>(system: &mut System<D>, room: &Room<D>, h: f64) {
    // The acceleration of an impact leads nowhere.
    system.history.numbers[room.own.numbers + 1] = if room.struck.is_empty() { h } else { 0.0 };
    let before = &mut system.history.columns[room.own.columns + 1];
    let columns = before.0.each_mut().map(|column| &mut column[..system.nodes]);
    each_block(system.threads, 1, columns, |first, columns| {
        for (d, column) in columns.into_iter().enumerate() {
            for (node, before) in (first..).zip(column) {
                *before = room.v0[node * D + d];
            }
        }
    });
    for contact in &room.contacting.contacts {
        for d in 0..D {
            before.0[d][contact.node] = room.v1[contact.node * D + d];
        }
    }
}

/// What an iteration needs to know beside the room.
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
            stage: Room::<D>::STAGE,
            time: self.balance.time,
            keep: Definiteness::Clamped,
            matrix_free: false,
        }
    }

    /// Makes the matrix of the reference shape, which was evaluated last.
    fn make<const D: usize>(&self, system: &System<D>, room: &mut Room<D>) {
        let kind = system.history.numbers[room.own.numbers];
        let Room { kept, linear, mass, own, .. } = room;
        let mixture = self.mixture(system, mass);
        kept.make(linear, &mixture, raised(kind), &system.history.columns[own.columns]);
    }

    /// Makes the matrix of the present shape, which becomes the reference.
    fn make_here<const D: usize>(&self, system: &mut System<D>, room: &mut Room<D>, kind: f64) {
        let System { history, state, nodes, .. } = system;
        history.numbers[room.own.numbers] = kind;
        for (own, column) in history.columns[room.own.columns].0.iter_mut().zip(&state.work[0][0].0) {
            own[..*nodes].copy_from_slice(&column[..*nodes]);
        }
        self.make(system, room);
    }

    /// Makes the matrix of the reference shape that the state remembers, if it is not at hand; none where there is none.
    fn recall<const D: usize>(&self, system: &mut System<D>, room: &mut Room<D>) -> Result<bool, StepError> {
        let kind = system.history.numbers[room.own.numbers];
        if kind <= 0.0 || is_loose(system) || !system.hessian_is_of_positions() {
            return Ok(false);
        }
        let mixture = self.mixture(system, &room.mass);
        if !room.kept.is_of(&system.history.columns[room.own.columns], &mixture, raised(kind)) {
            let (nodes, places) = (system.nodes, system.places());
            let System { history, state, .. } = system;
            for (to, from) in state.work[0][0].0.iter_mut().zip(&history.columns[room.own.columns].0) {
                for place in 0..places {
                    to[place] = from[place.min(nodes - 1)];
                }
            }
            system.evaluate(Room::<D>::STAGE, self.balance.time, 0.0, &mut room.force)?;
            self.make(system, room);
        }
        Ok(true)
    }

    /// What is out of balance in the free directions, friction and what is prescribed included, as the right-hand side; gives
    /// its size.
    fn out_of_balance<const D: usize>(
        &self,
        system: &System<D>,
        room: &mut Room<D>,
        moves: bool,
    ) -> Result<f64, Indefinite> {
        let Room { kept, linear, mass, free, projectors, residual, right, trial, prescribed, contacting, .. } = room;
        let mixture = self.mixture(system, mass);
        let ways = moves.then_some(&**prescribed);
        wanted_forces(system.threads, &mixture, linear, contacting, residual, ways, [trial, &mut *right]);
        let filter = Filter { free, projectors };
        each_block(system.threads, D, [&mut *right], |first, [right]| filter.apply_from(first / D, right));
        kept.hold(system.threads, linear, &filter, self.direct)?;
        Ok(kept.begin(system, right))
    }

    /// Solves for the step of an iteration, if need be with another matrix; gives the products, and whether that worked.
    fn direction<const D: usize>(
        &self,
        system: &mut System<D>,
        room: &mut Room<D>,
        moves: bool,
        goal: f64,
    ) -> (u32, bool) {
        let mut spent = 0;
        loop {
            let Room { kept, right, step, .. } = &mut *room;
            match kept.solve(system, right, self.direct, goal, PRODUCTS, step) {
                Ok((products, indefinite)) => {
                    if indefinite {
                        // What was found leads downhill; the next matrix is another one.
                        system.history.numbers[room.own.numbers] = -CLAMPED;
                    }
                    return (spent + products, true);
                }
                Err(Indefinite) => {
                    spent += 1;
                    // Directions without any stiffness, or a gas that pushes.
                    let kind = system.history.numbers[room.own.numbers].abs();
                    if kind >= MOST_RAISED {
                        return (spent, false);
                    }
                    self.make_here(system, room, kind + 1.0);
                    if self.out_of_balance(system, room, moves).is_err() {
                        room.kept.forget_right_hand_side();
                    }
                }
            }
        }
    }
}

/// The real-time setting as a minimiser.
///
/// What few iterations lead to counts only where it makes no energy: else the step is solved by Newton's method with its line search,
/// and made in two halves where that does not converge. Its incremental potential must not be above that of a body that stays where it
/// is; looked at are bodies in the air, and others whose matrix was made anew on the way, or that went far or are left farther out of
/// balance than promised. What is left of a body on an obstacle is taken for an impulse of that, which the potential
/// does not know: the end of such a step is doubtful ([`Solved::doubtful`]), and its energy decides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RealTime(pub(crate) Settings);

impl<const D: usize> Minimiser<D> for RealTime {
    fn minimise(&self, system: &mut System<D>, room: &mut Room<D>, balance: &Balance) -> Result<Solved, StepError> {
        let settings = &self.0;
        let (cut_off, left) = (system.work.solver.cut_off, system.work.solver.left);
        let outcome = iterate(system, room, balance, settings);
        let spent = match &outcome {
            Ok((solved, Trust::Whole)) => return Ok(*solved),
            Ok((solved, Trust::IfNoGain)) if !has_risen(system, room, balance)? => {
                return Ok(Solved { doubtful: true, ..*solved });
            }
            Ok((solved, Trust::IfDownhill)) if !has_risen(system, room, balance)? => return Ok(*solved),
            Ok((solved, _)) => *solved,
            // A law that has no meaning where the iteration led to.
            Err(StepError::Model { .. }) => Solved::default(),
            Err(_) => return outcome.map(|(solved, _)| solved),
        };
        (system.work.solver.cut_off, system.work.solver.left) = (cut_off, left);
        distrust(system, room);
        room.contacting.clear(system.nodes);
        for k in 0..room.u.len() {
            room.u[k] = if room.held[k].is_nan() { balance.theta * balance.h * room.v0[k] } else { room.held[k] };
        }
        let mut solved = Newton(exactly(settings)).minimise(system, room, balance)?;
        solved.iterations += spent.iterations;
        solved.products += spent.products;
        Ok(solved)
    }
    fn history(&self) -> HistorySize {
        HistorySize { columns: COLUMNS, numbers: NUMBERS }
    }
    fn predict(&self, system: &System<D>, room: &mut Room<D>, balance: &Balance) {
        predict(system, room, balance.theta, balance.h);
    }
    fn discard(&self, system: &mut System<D>, room: &Room<D>) {
        distrust(system, room);
    }
    fn remember(&self, system: &mut System<D>, room: &Room<D>, h: f64) {
        remember(system, room, h);
    }
    /// In real time nobody waits for another setting.
    fn always_halves(&self) -> bool {
        true
    }
    fn shares_threads(&self) -> bool {
        true
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        !self.0.solver.is_direct_in_real_time(system)
    }
}

/// The settings of steps that few iterations led astray.
pub(crate) fn exactly(settings: &Settings) -> Settings {
    Settings { real_time: false, iterations: MOST_ITERATIONS, ..*settings }
}

/// Lets the next step make its matrix anew.
fn distrust<const D: usize>(system: &mut System<D>, room: &Room<D>) {
    let kind = &mut system.history.numbers[room.own.numbers];
    *kind = if *kind > 0.0 { -CLAMPED } else { *kind };
}

/// Whether the incremental potential of what was found is above that of the body where it was, but for what is held; not a number
/// counts as above, and so does what forces without a potential may have done.
fn has_risen<const D: usize>(system: &mut System<D>, room: &mut Room<D>, balance: &Balance) -> Result<bool, StepError> {
    let Some((after, size)) = potential(system, room, balance, false) else { return Ok(true) };
    if !after.is_finite() {
        return Ok(true);
    }
    for k in 0..room.u.len() {
        room.trial[k] = if room.held[k].is_nan() { 0.0 } else { room.held[k] };
    }
    // Where a body stood where its law has no meaning there is nothing to compare with.
    let before = match evaluate(system, room, balance, true) {
        Ok(()) => potential(system, room, balance, true),
        Err(_) => None,
    };
    evaluate(system, room, balance, false)?;
    Ok(!before.is_some_and(|(before, parts)| after - before <= RISE * (size + parts) + rounding_of_models(system)))
}

/// Whether what few iterations lead to may count.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Trust {
    /// It does.
    Whole,
    /// It does unless the incremental potential has risen.
    IfDownhill,
    /// It does unless the body has more energy at the end of the step than before.
    IfNoGain,
    /// It does not.
    None,
}

/// Whether the matrix is factored: found out once, and again where the scene asks for another solver.
fn is_direct<const D: usize>(system: &System<D>, room: &mut Room<D>, settings: &Settings) -> bool {
    let direct = match room.direct {
        Some((solver, direct)) if solver == settings.solver => direct,
        _ => settings.solver.is_direct_in_real_time(system),
    };
    room.direct = Some((settings.solver, direct));
    direct
}

/// Three iterations, or as many as the scene says, and whether what they leave may count.
fn iterate<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
) -> Result<(Solved, Trust), StepError> {
    let task = Task { balance, direct: is_direct(system, room, settings) };
    room.rigid.begin();
    let mut solved = Solved { converged: true, ..Solved::default() };
    // Whether the matrix is of this step.
    let fresh = !task.recall(system, room)?;
    evaluate(system, room, balance, false)?;
    if fresh {
        task.make_here(system, room, CLAMPED);
    }
    let (mut first, mut undecided, mut slow, mut remade) = (0.0, false, false, false);
    loop {
        system.go_on()?;
        let last = solved.iterations == settings.iterations;
        // Which nodes are held, and how far they have to go.
        let mut moves = false;
        if !last {
            undecided |= look(system, room, balance, false);
            let Room { contacting, u, held, x0, free, projectors, prescribed, .. } = &mut *room;
            moves = contacting.hold(u, balance.theta, held, x0, free, projectors, prescribed) > 0.0;
        }
        let mut size = task.out_of_balance(system, room, moves).unwrap_or(f64::NAN);
        if solved.iterations == 0 {
            first = size;
        }
        let floor = NOTHING * room.extent * room.kept.stiffness().sqrt();
        let settled = !undecided && !moves;
        let [aim, most] = settings.leaves;
        let held = (aim, LINEAR.smaller(0.5 * aim));
        let (enough, linear) = if is_loose(system) { (LOOSE * LOOSE, LOOSE) } else { held };
        let enough = if solved.iterations > 0 { (enough * first).larger(floor) } else { floor };
        if last || settled && size <= enough {
            let end = End { size, first, floor, most, slow, remade };
            return conclude(system, room, balance, settings, solved, &end);
        }
        if solved.iterations > 0 && (is_loose(system) || size > WORN * first) {
            // The matrix of another shape does not lead there.
            remade = true;
            task.make_here(system, room, CLAMPED);
            size = task.out_of_balance(system, room, moves).unwrap_or(f64::NAN);
        }
        if size.is_nan() {
            room.kept.forget_right_hand_side();
        }
        solved.iterations += 1;
        let (products, found) = task.direction(system, room, moves, (linear * first).larger(floor));
        solved.products += products;
        slow |= products > MANY_PRODUCTS;
        if !found {
            solved.converged = false;
            return Ok((solved, Trust::None));
        }
        go(system, room, &task, moves, &mut solved)?;
        undecided = false;
        if system.contacts.is_some() {
            let verdict = judge(system, room, balance, settings, 0.0, false);
            undecided = verdict.anew || verdict.unsettled;
        }
    }
}

/// How the iterations of a step ended.
#[derive(Clone, Copy, Debug)]
struct End {
    /// What is out of balance, what was at first, and what counts as nothing.
    size: f64,
    first: f64,
    floor: f64,
    /// The part of it that may be left.
    most: f64,
    /// Whether an iteration took many products, and whether the matrix was made anew.
    slow: bool,
    remade: bool,
}

/// Ends the iterations of a step: counts what they leave, and says whether it may count.
fn conclude<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    mut solved: Solved,
    end: &End,
) -> Result<(Solved, Trust), StepError> {
    let End { size, first, floor, most, slow, remade } = *end;
    let number = room.own.numbers;
    if size > (WORN * first).larger(floor) && system.history.numbers[number] > 0.0 {
        system.history.numbers[number] = -CLAMPED;
    }
    let as_promised = size <= (most * first).larger(floor);
    if slow || !as_promised {
        let left = size / room.kept.stiffness().sqrt();
        let work = &mut system.work.solver;
        work.cut_off += 1;
        work.left = left.larger(work.left);
    }
    // A part of what was torn at first is still torn; what is no number is not short.
    let short = solved.correction <= SHORT * room.extent;
    let trust = match (is_loose(system), as_promised) {
        (true, _) if !short => Trust::None,
        (true, _) if room.contacting.any() => Trust::IfNoGain,
        (false, true) if !remade && short => Trust::Whole,
        _ => Trust::IfDownhill,
    };
    // What moves no node against the stiffness of the others may move them all together.
    let trust = if settles(system, room, balance, settings, [NOTHING, LOOSE * LOOSE])? { trust } else { Trust::None };
    solved.conditioning = room.rigid.conditioning;
    Ok((solved, trust))
}

/// Goes the step that was found, and what is prescribed; `room.reaction` is then what the constraints take.
fn go<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    task: &Task<'_>,
    moves: bool,
    solved: &mut Solved,
) -> Result<(), StepError> {
    let Room { linear, mass, free, projectors, residual, reaction, step, prescribed, contacting, u, .. } = &mut *room;
    let filter = Filter { free, projectors };
    each_block(system.threads, D, [step], |first, [step]| filter.apply_from(first / D, step));
    if moves {
        for (s, p) in step.iter_mut().zip(&*prescribed) {
            *s += p;
        }
    }
    // What is out of balance after the step in the directions that are held: r + A Δ.
    if contacting.any() {
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
    evaluate(system, room, task.balance, false)
}
