//! Newton's method on the balance of forces of a stage.

use super::linear::{Filter, Mixture, is_matrix_free};
use super::room::Room;
use super::settings::Settings;
use opruga_core::error::StepError;
use opruga_core::potential::Definiteness;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::dot;

/// The balance of a stage: σ M (u − y) = F(x₀ + u, β (u − z)) at a time after the start of the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    /// The factor of the mass [1/s²].
    pub(crate) sigma: f64,
    /// The factor of displacements in velocities [1/s].
    pub(crate) beta: f64,
    /// Which part of the way to the end of the step the stage is.
    pub(crate) theta: f64,
    /// The time of the stage after the start of the step [s].
    pub(crate) time: f64,
    /// The length of the step [s].
    pub(crate) h: f64,
    /// The part of the weight and of the loads that acts.
    pub(crate) load: f64,
    /// The change of momentum in the step by a force that acts in this stage alone, in units of force times h.
    pub(crate) impulse: f64,
}

/// How the iteration ended.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Solved {
    pub(crate) iterations: u32,
    pub(crate) products: u32,
    /// The largest displacement of a node in the last iteration [m].
    pub(crate) correction: f64,
    pub(crate) converged: bool,
}

/// The longest correction of a node in statics, in extents of the body.
const LONGEST: f64 = 0.5;

/// Which derivatives a direction is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Keep {
    /// The exact ones.
    Exact,
    /// Each element's without its negative eigenvalues.
    Clamped,
    /// The same with the diagonal raised by a part of itself: for directions without any stiffness.
    Raised(f64),
}

impl Keep {
    fn definiteness(self) -> Definiteness {
        if self == Keep::Exact { Definiteness::Exact } else { Definiteness::Clamped }
    }
    fn next(self) -> Option<Keep> {
        match self {
            Keep::Exact => Some(Keep::Clamped),
            Keep::Clamped => Some(Keep::Raised(1e-8)),
            Keep::Raised(part) => (part < 1e-2).then_some(Keep::Raised(100.0 * part)),
        }
    }
}

/// From this iteration on contacts stay as they are: those that still change differ by little.
const MOST_DECISIONS: u32 = 30;

/// The part of the slope that may be left after a step of the line search.
const SLOPE_LEFT: f64 = 0.8;

/// The most halvings, or thereabouts, of a step.
const MOST_TRIALS: usize = 14;

/// The part of the residual that the linear solver may leave, in the first iteration.
const LINEAR_TOLERANCE: f64 = 1e-2;

/// Rounding of a force, in units of stiffness times size.
const ROUNDING: f64 = 4e-15;

/// Looks for the stage from the displacement in `room.u` on; on success forces and residual belong to what is found.
pub(crate) fn solve<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
) -> Result<Solved, StepError> {
    let mut solved = Solved::default();
    let goal = settings.tolerance * room.extent;
    let mut size: f64 = 0.0;
    for x in &room.x0 {
        size = x.abs().larger(size);
    }
    evaluate(system, room, balance, false)?;
    let mut first_norm = 0.0;
    let mut clamped = false;
    while solved.iterations < settings.iterations {
        solved.iterations += 1;
        // Which nodes are held, and how far they have to go.
        let mut changed = look(system, room, balance);
        let farthest = room.contacting.hold(
            &room.u,
            balance.theta,
            &room.held,
            &room.x0,
            &mut room.free,
            &mut room.projectors,
            &mut room.prescribed,
        );
        let moves = farthest > 0.0;
        // Nodes that have a way to go of their own go it at once: the potential may rise by that.
        let far = farthest > 1e-4 * room.extent;

        // The direction; the exact derivatives as long as they are positive definite.
        let mut keep = if clamped { Keep::Clamped } else { Keep::Exact };
        let direction = loop {
            match find_direction(system, room, balance, settings, keep, moves, &mut first_norm) {
                Ok((products, slope)) => {
                    solved.products += products;
                    if slope <= 0.0 || far || keep != Keep::Exact {
                        break Some(slope);
                    }
                }
                Err(products) => solved.products += products,
            }
            clamped = true;
            match keep.next() {
                Some(next) => keep = next,
                None => break None,
            }
        };
        let Some(slope) = direction else { break };

        let mut longest: f64 = 0.0;
        for node in room.step.as_chunks::<D>().0 {
            longest = node.iter().map(|x| x * x).sum::<f64>().larger(longest);
        }
        solved.correction = longest.sqrt();
        if balance.sigma == 0.0 && solved.correction > LONGEST * room.extent && !far {
            // Without inertia a soft direction leads far.
            let part = LONGEST * room.extent / solved.correction;
            room.step.iter_mut().for_each(|s| *s *= part);
            solved.correction *= part;
        }
        if far || solved.correction <= goal {
            full_step(system, room, balance)?;
        } else {
            let length = line_search(system, room, balance, slope)?;
            solved.correction *= length;
            if length == 0.0 && !changed {
                solved.converged = at_rounding(system, room, balance, settings, size);
                break;
            }
        }
        // Derivatives that were not positive may be so near the solution.
        clamped = clamped && solved.correction > 1e-2 * room.extent;

        // What the constraints would take says who stays held.
        if system.contacts.is_some() && solved.iterations < MOST_DECISIONS {
            changed |= room.contacting.judge(&room.reaction, &room.u, balance.theta, &room.x0, room.extent);
        }
        if !changed && (solved.correction <= goal || at_rounding(system, room, balance, settings, size)) {
            solved.converged = true;
            break;
        }
    }
    Ok(solved)
}

pub(crate) fn look<const D: usize>(system: &System<D>, room: &mut Room<D>, balance: &Balance) -> bool {
    let Room { contacting, x0, u, extent, .. } = room;
    contacting.look(system, x0, u, balance.theta, balance.h, *extent)
}

pub(crate) fn mixture<'a, const D: usize>(
    system: &'a System<D>,
    mass: &'a [f64],
    balance: &Balance,
    keep: Definiteness,
    settings: &Settings,
) -> Mixture<'a, D> {
    Mixture {
        system,
        sigma: balance.sigma,
        beta: balance.beta,
        load: balance.load,
        mass,
        stage: Room::<D>::STAGE,
        time: balance.time,
        keep,
        matrix_free: is_matrix_free(settings.solver),
    }
}

/// Solves for `room.step`, what is prescribed included; `room.reaction` is then what the constraints take. Gives the number of
/// products, and the slope of the incremental potential along the step.
fn find_direction<const D: usize>(
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    keep: Keep,
    moves: bool,
    first_norm: &mut f64,
) -> Result<(u32, f64), u32> {
    let Room { linear, mass, free, projectors, residual, reaction, right, trial, step, prescribed, contacting, .. } =
        room;
    let mixture = mixture(system, mass, balance, keep.definiteness(), settings);
    linear.assemble(&mixture);
    if let Keep::Raised(part) = keep {
        linear.raise(part);
    }
    // b = −(r − friction) − A d in the free directions.
    trial.copy_from_slice(residual);
    contacting.subtract_friction(trial);
    if moves {
        linear.multiply(&mixture, prescribed, right);
        for (t, r) in trial.iter_mut().zip(&*right) {
            *t += r;
        }
    }
    for (r, t) in right.iter_mut().zip(&*trial) {
        *r = -t;
    }
    let filter = Filter { free, projectors };
    filter.apply(right);
    let norm = dot(right, right).sqrt();
    *first_norm = norm.larger(*first_norm);
    // Far from the solution a rough direction does (Eisenstat and Walker 1996).
    let share = if *first_norm > 0.0 { (norm / *first_norm).larger(1e-9) } else { 1.0 };
    let products =
        linear.solve(&mixture, &filter, settings, LINEAR_TOLERANCE * share, right, step).map_err(|_| 0u32)?;
    filter.apply(step);
    let slope = -dot(right, step);
    if moves {
        for (s, p) in step.iter_mut().zip(&*prescribed) {
            *s += p;
        }
    }
    // What is out of balance after the step in the directions that are held: r + A Δ.
    if contacting.any() {
        linear.multiply(&mixture, step, reaction);
        for (r, residual) in reaction.iter_mut().zip(&*residual) {
            *r += residual;
        }
    }
    Ok((products, slope))
}

/// The forces at x₀ + u (or at the trial), and what is out of balance.
pub(crate) fn evaluate<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    trial: bool,
) -> Result<(), StepError> {
    let u = if trial { &room.trial } else { &room.u };
    Room::show(system, &room.x0, u, &room.z, balance.beta);
    system.evaluate(Room::<D>::STAGE, balance.time, 0.0, &mut room.force)?;
    for node in 0..system.nodes {
        for d in 0..D {
            let k = node * D + d;
            room.residual[k] = balance.sigma * room.mass[node] * (u[k] - room.y[k]) - room.force.0[d][node];
        }
    }
    if balance.sigma != 0.0
        && let Some(inertia) = &system.inertia
    {
        room.way.clear();
        room.way.extend(u.iter().zip(&room.y).map(|(u, y)| u - y));
        for node in 0..system.nodes {
            let product = inertia.product::<D>(node, &room.way);
            for d in 0..D {
                room.residual[node * D + d] += balance.sigma * product[d];
            }
        }
    }
    if balance.load != 1.0 {
        system.outer_forces(Room::<D>::STAGE, balance.time, &mut room.outer);
        for node in 0..system.nodes {
            for d in 0..D {
                room.residual[node * D + d] += (1.0 - balance.load) * room.outer.0[d][node];
            }
        }
    }
    Ok(())
}

fn full_step<const D: usize>(system: &mut System<D>, room: &mut Room<D>, balance: &Balance) -> Result<(), StepError> {
    for (u, s) in room.u.iter_mut().zip(&room.step) {
        *u += s;
    }
    evaluate(system, room, balance, false)
}

/// Goes along the step so far that the slope of the incremental potential has fallen and, where that potential is known, it
/// has not risen; gives the part of the step that was gone.
fn line_search<const D: usize>(
    system: &mut System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    slope: f64,
) -> Result<f64, StepError> {
    // Friction and damping have no potential.
    let conservative = !system.is_damped() && !room.contacting.any();
    let before = if conservative { potential(system, room, balance, false) } else { None };
    let mut length = 1.0;
    for _ in 0..MOST_TRIALS {
        for k in 0..room.u.len() {
            room.trial[k] = room.u[k] + length * room.step[k];
        }
        let allowed = evaluate(system, room, balance, true).is_ok();
        let now = if allowed { slope_along(room) } else { f64::NAN };
        // Differences of energies are lost in rounding where the step is small.
        let risen = match before {
            Some((energy, magnitude)) if allowed => {
                potential(system, room, balance, true).is_none_or(|(after, _)| after > energy + 1e-12 * magnitude)
            }
            _ => false,
        };
        if allowed && now.is_finite() && now <= SLOPE_LEFT * slope.abs() && !risen {
            room.u.copy_from_slice(&room.trial);
            return Ok(length);
        }
        let secant = slope.abs() / (slope.abs() + now);
        length *= if secant.is_finite() && !risen { secant.larger(0.1).smaller(0.6) } else { 0.4 };
    }
    // No progress: the state stays where it was, and with it the forces.
    evaluate(system, room, balance, false)?;
    Ok(0.0)
}

/// The slope of the incremental potential along the step in the directions that are free, friction included.
fn slope_along<const D: usize>(room: &mut Room<D>) -> f64 {
    room.right.copy_from_slice(&room.residual);
    room.contacting.subtract_friction(&mut room.right);
    Filter { free: &room.free, projectors: &room.projectors }.apply(&mut room.right);
    dot(&room.right, &room.step)
}

/// The incremental potential and the size of its parts [J].
fn potential<const D: usize>(system: &System<D>, room: &Room<D>, balance: &Balance, trial: bool) -> Option<(f64, f64)> {
    let energy = system.potential_energy(Room::<D>::STAGE, balance.time)?;
    let u = if trial { &room.trial } else { &room.u };
    let mut inertia = 0.0;
    for (node, mass) in room.mass.iter().enumerate() {
        for k in node * D..(node + 1) * D {
            let way = u[k] - room.y[k];
            inertia += mass * way * way;
        }
    }
    if let Some(coupled) = &system.inertia {
        // The forces were evaluated last, and with them the way.
        inertia += coupled.square::<D>(&room.way);
    }
    inertia *= 0.5 * balance.sigma;
    let mut lifted = 0.0;
    if balance.load != 1.0 {
        // What the missing part of the weight would have given.
        for node in 0..system.nodes {
            for d in 0..D {
                lifted += (1.0 - balance.load) * room.outer.0[d][node] * u[node * D + d];
            }
        }
    }
    Some((energy + inertia + lifted, energy.abs() + inertia + lifted.abs()))
}

/// Whether what is out of balance is no more than the rounding of the forces.
fn at_rounding<const D: usize>(
    system: &System<D>,
    room: &mut Room<D>,
    balance: &Balance,
    settings: &Settings,
    size: f64,
) -> bool {
    room.right.copy_from_slice(&room.residual);
    room.contacting.subtract_friction(&mut room.right);
    let filter = Filter { free: &room.free, projectors: &room.projectors };
    filter.apply(&mut room.right);
    let mixture = mixture(system, &room.mass, balance, Definiteness::Exact, settings);
    room.right.as_chunks::<D>().0.iter().enumerate().all(|(node, rest)| {
        let floor = ROUNDING * room.linear.size_at(&mixture, node) * size;
        rest.iter().all(|r| r.abs() <= floor)
    })
}
