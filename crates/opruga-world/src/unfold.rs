//! Recovery of bodies that rest in a degenerate shape: flat, inverted or folded. The recovery is active if the scene contains `[world] unfold =
//! true`.
//!
//! A body that was squeezed onto a plane, a line or a point, or that was inverted, may be in equilibrium by symmetry alone: no force acts out of the
//! plane, although the energy falls on both sides of it. No solver can leave such a shape without help, because solvers follow the forces. The world
//! therefore checks the bodies from time to time. If a body is at rest with degenerate or inverted cells, or is strained although nothing acts on it,
//! its free nodes are displaced at random, in the same way in every run: first by 10⁻⁴ of its size, then by a hundredth and by a tenth of it. Between
//! two displacements, the body has time to leave the shape. Every displacement is counted. A degenerate shape that remains after the last
//! displacement is counted too.
//!
//! In statics, a frame that ends in a degenerate shape is solved again. The first attempt begins at the start of the frame and divides the motion of
//! pins and the loads into parts, because smaller steps may avoid a fold that one large step makes. Up to three further attempts begin from displaced
//! shapes.
//!
//! A body has left such a shape once it has kept another shape for the time that leaving takes. A body that returns to its degenerate shape earlier
//! keeps the number of its displacements, so it eventually gets the last displacement.
//!
//! Strained bodies on which a pin, an obstacle or a load acts are left alone, because they may have been meant to snap through. At the end,
//! `cells.other_balance` reports that they contain more energy than the forces on them account for.
//!
//! A body is at rest if its kinetic energy and its unbalanced forces are small compared with the energy U of its cells: ½ Σ m v² ≪ U and Σ m |a| L ≪
//! U. In addition, damping must not dissipate that energy, because a body that creeps against its viscosity is still moving. The time to leave a
//! degenerate shape is a multiple of L √(M/U), where L is the size of the body and M its mass.
//!
//! A body whose cells are all degenerate may move along its plane or line for ever without leaving it. The world therefore displaces such a body
//! after the time to leave, whatever its motion.
//!
//! Bodies of models without cells, such as springs, are left alone.
//!
//! | constant | what breaks without it | test |
//! |---|---|---|
//! | `REST`, `BALANCED` | a body that creeps or oscillates is displaced on its way | `robust_steps::a_body_that_creeps_back…` |
//! | `PERIODS` | every frame pays for a check, and a body is displaced before it oscillates freely | `flat_bodies::bodies_on_a_line_leave…` |
//! | `PATIENCE` | a body is displaced again before it could leave | `flat_bodies::disturbances_end…` |
//! | `PARTS` | a plate that one step folds stays folded; smaller steps keep it upright | `torn_by_pins::plates_that_are_pressed_at_once_and_may_unfold…` |
//! | `SIZES` | a single displacement does not leave a flat shape that is stable against it | `robust_steps::bodies_that_symmetry_holds…` |
//! | `STRAINED` | folded bodies with sound cells stay folded | `robust_steps::every_rule_brings…` |

use crate::island::{FramePlan, Island, Saved};
use crate::ledger::{survey, take_stock};
use opruga_core::error::StepError;
use opruga_core::history::{Channel, PerBody};
use opruga_core::potential::{Account, CellState};
use opruga_core::state::Columns;
use opruga_core::system::{Stage, System};
use opruga_math::{Lane, sum_in_fixed_order};
use opruga_mesh::{Mesh, least_jacobian};
use opruga_solve::dense::symmetric_eigen;

/// The number of displacements since the body left its last degenerate shape, plus one if the last possible displacement also had no effect.
const TIMES: PerBody<u64> = PerBody::new("unfold.times");
/// The time of its last displacement [s].
const LAST: PerBody<f64> = PerBody::new("unfold.last");
/// The number of consecutive checks in which all of its cells were degenerate.
const FLAT_LOOKS: PerBody<u64> = PerBody::new("unfold.flat_looks");
/// Frames since the last check.
const SINCE: PerBody<u64> = PerBody::new("unfold.since");
/// Whether the last check found nothing.
const SOUND: PerBody<bool> = PerBody::new("unfold.sound");
/// Until this time [s], a body in another shape does not count as having left its degenerate shape.
const UNTIL: PerBody<f64> = PerBody::new("unfold.until");

/// The data that are kept for every body.
pub(crate) fn channels() -> [Channel; 6] {
    [TIMES.declared(), LAST.declared(), FLAT_LOOKS.declared(), UNTIL.declared(), SINCE.declared(), SOUND.declared()]
}

/// The number of frames between two checks of a body, and the number for a sound body. A check costs about as much as an evaluation of the forces.
const PERIODS: [u64; 2] = [24, 96];

/// A body counts as being at rest only if its kinetic energy, and its dissipation in the time to leave, are below this fraction of the stored energy.
const REST: f64 = 1e-3;

/// A body counts as being at rest only if its unbalanced force times its size is below this fraction of the stored energy. A vibration with 10⁻⁷ of
/// that energy has a value of one thousandth.
const BALANCED: f64 = 1e-2;

/// The time that a displaced body has to leave, in units of L √(M/U).
const PATIENCE: f64 = 12.0;

/// The largest displacements of nodes, relative to the size of the body. This size is the cube root of its volume, or the square root of its area.
const SIZES: [f64; 3] = [1e-4, 1e-2, 0.1];

/// The number of parts in which statics repeats a frame that ended folded.
const PARTS: u32 = 8;

/// A cell of a body on which nothing acts counts as strained if its volume has changed by more than this fraction.
const STRAINED: f64 = 1e-3;

/// The axes of space.
const UNITS: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl<const D: usize> Island<D> {
    /// Checks a body after the substeps of a frame, at intervals, and displaces it if it is at rest in a degenerate shape. `v0` contains the
    /// velocities at the start of the frame.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub(crate) fn unfold(&mut self, plan: &FramePlan<D>, v0: &Columns<D>) -> Result<(), StepError> {
        let Some(mesh) = plan.unfold.map(|bodies| &bodies[self.bodies[0]].mesh) else { return Ok(()) };
        let system = &mut self.system;
        let frame = f64::from(plan.substeps) * plan.h;
        let since = system.history.get(SINCE) + 1;
        let due = since >= PERIODS[usize::from(system.history.get(SOUND))];
        system.history.set(SINCE, if due { 0 } else { since });
        if !due {
            return Ok(());
        }
        let (times, last, until) = (system.history.get(TIMES), system.history.get(LAST), system.history.get(UNTIL));
        let Some(size) = degenerate_size(system, mesh) else {
            system.history.set(TIMES, if system.time > until { 0 } else { times });
            system.history.set(FLAT_LOOKS, 0);
            system.history.set(SOUND, true);
            return Ok(());
        };
        system.history.set(SOUND, false);
        let flat = if is_flat(system) { system.history.get(FLAT_LOOKS) + 1 } else { 0 };
        system.history.set(FLAT_LOOKS, flat);
        let energy = stored(system)?;
        let Motion { kinetic, push, mass, fading } = motion(system, v0, frame)?;
        let patience = PATIENCE * size * (mass / energy).sqrt();
        // Numbers of the state must be finite; a body without energy has unlimited time to leave.
        let until = system.time + patience;
        system.history.set(UNTIL, if until.is_finite() { until } else { f64::MAX });
        if times > SIZES.len() as u64 {
            return Ok(());
        }
        let waits = times > 0 && system.time - last <= patience;
        let small = |part: f64| part <= REST * energy;
        let rests = small(kinetic) && push * size <= BALANCED * energy && small(fading * patience);
        let stays = (flat * PERIODS[0]) as f64 * frame > patience;
        if waits || !(stays || rests) {
            return Ok(());
        }
        system.history.set(FLAT_LOOKS, 0);
        system.history.set(TIMES, times + 1);
        system.history.set(LAST, system.time);
        match SIZES.get(times as usize) {
            Some(part) => displace_with_work(system, part * size, times),
            None => system.work.solver.stayed_degenerate += 1,
        }
        Ok(())
    }

    /// Solves a frame of statics again from displaced shapes, as long as it ends in a degenerate one. `start` is the energy at the start of the frame
    /// [J]. If no other equilibrium is found, the first one is kept.
    ///
    /// # Errors
    /// [`StepError::BrokenOff`].
    pub(crate) fn unfold_statics(&mut self, plan: &FramePlan<D>, meets: bool, start: f64) -> Result<(), StepError> {
        // Every point of the curve of equilibria counts.
        if self.integrator.part_of_load(&self.system).is_some() {
            return Ok(());
        }
        let Some(mesh) = plan.unfold.map(|bodies| &bodies[self.bodies[0]].mesh) else { return Ok(()) };
        // Smaller steps may avoid a fold that one step makes: pins and loads take the same path in parts, without any displacement.
        if degenerate_size(&self.system, mesh).is_some() {
            let found = Saved::of(&self.system, self.system.time);
            self.restore();
            self.solve_again(&plan.in_parts(PARTS), meets, found)?;
        }
        for (times, part) in SIZES.iter().enumerate() {
            let Some(size) = degenerate_size(&self.system, mesh) else { return Ok(()) };
            let found = Saved::of(&self.system, self.system.time);
            // The shape at the end of the frame is displaced. The pins have reached their final positions, so they do not distort the cells on their
            // way again.
            displace(&mut self.system, part * size, times as u64);
            let shape = self.system.state.x.clone();
            self.restore();
            self.system.state.x = shape;
            // Statics records the change of energy since its start; the energy of the displacement is work too.
            let given = self.energy_here() - start;
            if self.solve_again(plan, meets, found)? {
                self.system.work.user[0] += given;
            }
            self.system.work.solver.disturbed += 1;
        }
        self.system.work.solver.stayed_degenerate += u64::from(degenerate_size(&self.system, mesh).is_some());
        Ok(())
    }

    /// Solves a frame again from the present state, and returns whether this ended in an equilibrium. If it did not, the world keeps the previous
    /// equilibrium. The work of the solver is counted in both cases.
    fn solve_again(&mut self, plan: &FramePlan<D>, meets: bool, found: Saved<D>) -> Result<bool, StepError> {
        let before = found.work.solver;
        match self.attempt(plan, meets) {
            Ok(_) => {
                self.system.work.solver.add(&before);
                Ok(true)
            }
            Err(StepError::BrokenOff {}) => Err(StepError::BrokenOff {}),
            Err(_) => {
                let tried = self.system.work.solver;
                self.return_to(found);
                self.system.work.solver.add(&tried);
                Ok(false)
            }
        }
    }

    /// The energy of the present state [J].
    fn energy_here(&mut self) -> f64 {
        let (survey, stock) = (survey(&self.system), take_stock(&mut self.system));
        survey.kinetic + survey.gravity + stock.elastic + stock.gas
    }
}

/// The energy stored in the cells and springs of a body [J].
fn stored<const D: usize>(system: &mut System<D>) -> Result<f64, StepError> {
    // The evaluation of the forces prepares the models.
    system.forces(true)?;
    let view = system.view(Stage::Current, system.time);
    let elastic = system.members.iter().filter(|member| member.potential.properties().account == Account::Elastic);
    Ok(elastic.map(|member| sum_in_fixed_order(&member.potential.energy(system.simd, &view, &member.scratch))).sum())
}

/// Measures of the motion of a body.
struct Motion {
    /// The kinetic energy [J].
    kinetic: f64,
    /// The sum of the magnitudes of the forces that change velocities [N].
    push: f64,
    /// The mass [kg].
    mass: f64,
    /// The power dissipated by damping [W].
    fading: f64,
}

/// The motion of a body. For a free body it is relative to its centre of mass and to axes that rotate with it, so a spinning body counts as being at
/// rest. Accelerations are means over the frame, because they include the forces of obstacles.
fn motion<const D: usize>(system: &mut System<D>, v0: &Columns<D>, frame: f64) -> Result<Motion, StepError> {
    let damping = if system.members.iter().any(|member| member.potential.properties().views.damping) {
        let (all, undamped) = (system.forces(true)?, system.forces(false)?);
        Some((all, undamped))
    } else {
        None
    };
    let mut pinned = vec![[false; D]; system.nodes];
    system.pinned_axes(&mut |node, d| pinned[node][d] = true);
    let mut mass = 0.0;
    let (mut center, mut speed, mut change) = ([0.0; D], [0.0; D], [0.0; D]);
    for node in 0..system.nodes {
        let (x, v, old, m) = (system.state.x.at(node), system.state.v.at(node), v0.at(node), system.mass.at(node));
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
    // Subtracts the accelerations of a rigid rotation: the centripetal ones and those that change the axis.
    let acceleration = |node: usize| -> [f64; D] {
        let (v, old, inward) = (system.state.v.at(node), v0.at(node), turned(&spin, &turned(&spin, &arm(node))));
        core::array::from_fn(|d| (v[d] - old[d] - change[d] / mass) / frame - inward[d])
    };
    let tumble = if free { rotation(system, &acceleration, &arm) } else { [0.0; 3] };
    let (mut kinetic, mut push, mut fading) = (0.0, 0.0, 0.0);
    for node in 0..system.nodes {
        let m = system.mass.at(node);
        let (own, left) = (velocity(node), acceleration(node));
        let (turning, turned_more) = (turned(&spin, &arm(node)), turned(&tumble, &arm(node)));
        for d in 0..D {
            let own = own[d] - turning[d];
            kinetic += 0.5 * m * own * own;
            push += m * (left[d] - turned_more[d]).abs();
            // The motion of pinned nodes is prescribed.
            if let Some((all, undamped)) = damping.as_ref().filter(|_| !pinned[node][d]) {
                fading -= (all.0[d][node] - undamped.0[d][node]) * own;
            }
        }
    }
    Ok(Motion { kinetic, push, mass, fading })
}

/// The angular velocity [rad/s] of the rotation about the centre that is nearest to the velocities of a body relative to their mean; for
/// accelerations, the angular acceleration [rad/s²].
fn rotation<const D: usize>(
    system: &System<D>,
    field: &dyn Fn(usize) -> [f64; D],
    arm: &dyn Fn(usize) -> [f64; D],
) -> [f64; 3] {
    let turns = if D == 2 { &UNITS[2..] } else { &UNITS[..] };
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
    // A body whose nodes are on a line has no moment of inertia about that line.
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

/// The size of a body that is degenerate, inverted, or strained without cause [m]; `None` if its shape is regular.
fn degenerate_size<const D: usize>(system: &System<D>, mesh: &Mesh<D>) -> Option<f64> {
    let (alone, cells) = (nothing_acts(system), cells(system));
    // Models without cells have no degenerate cells.
    let mut degenerate = !cells.is_empty() && is_folded(system, mesh);
    let mut volume = 0.0;
    for cell in cells {
        degenerate |= cell.is_degenerate() || alone && (cell.volume_ratio - 1.0).abs() > STRAINED;
        volume += cell.measure;
    }
    degenerate.then(|| if D == 2 { volume.sqrt() } else { Lane::exp(Lane::ln(volume) / 3.0) })
}

/// Whether any cell that is upright at rest is now certainly inverted somewhere, even if only between its integration points.
fn is_folded<const D: usize>(system: &System<D>, mesh: &Mesh<D>) -> bool {
    let (mut now, mut rest) = (Vec::new(), Vec::new());
    mesh.cells.iter().any(|(_, _, nodes)| {
        now.clear();
        now.extend(nodes.iter().map(|node| system.state.x.at(*node as usize)));
        rest.clear();
        rest.extend(nodes.iter().map(|node| mesh.positions[*node as usize]));
        least_jacobian(&now).is_some_and(|least| least.is_inverted())
            && least_jacobian(&rest).is_some_and(|least| least.is_positive())
    })
}

/// The cells of a body in the present state.
fn cells<const D: usize>(system: &System<D>) -> Vec<CellState> {
    let view = system.view(Stage::Current, system.time);
    system.members.iter().flat_map(|member| member.potential.cell_states(&view, 0)).collect()
}

/// Whether no cell of a body has any volume.
fn is_flat<const D: usize>(system: &System<D>) -> bool {
    cells(system)
        .iter()
        .all(|cell| CellState { smallest_volume_ratio: cell.volume_ratio.abs(), ..*cell }.is_degenerate())
}

/// Whether the cells of a body are subject only to their own forces.
fn nothing_acts<const D: usize>(system: &System<D>) -> bool {
    let view = system.view(Stage::Current, system.time);
    system.pins.is_empty()
        && system.contacts.is_none()
        && system.members.iter().all(|member| {
            let potential = &member.potential;
            potential.properties().account == Account::Elastic
                && (!potential.properties().views.energy || !potential.cell_states(&view, 0).is_empty())
        })
}

/// Displaces the nodes of a body at random by up to `size` [m]; pinned nodes stay in place.
fn displace<const D: usize>(system: &mut System<D>, size: f64, times: u64) {
    for node in 0..system.nodes {
        let x = system.state.x.at(node);
        system.state.x.set(node, core::array::from_fn(|d| x[d] + size * random(node * D + d, times)));
    }
    system.hold(Stage::Current, 0.0);
}

/// Displaces the nodes as [`displace`] does, and enters the energy that this takes into the ledger as work from outside. Does nothing if a law is not
/// defined in the displaced shape.
fn displace_with_work<const D: usize>(system: &mut System<D>, size: f64, times: u64) {
    let (x, before) = (system.state.x.clone(), system.stored_energy(Stage::Current, 0.0));
    displace(system, size, times);
    system.work.solver.disturbed += 1;
    if system.forces(true).is_err() {
        system.state.x = x;
        return;
    }
    let given = system.stored_energy(Stage::Current, 0.0) - before;
    system.work.user[0] += given;
    // The integrator did not contribute to this energy.
    system.work.numerical[0] += given;
}

/// A number from −1 to 1 that depends on a coordinate and on the number of the displacement.
fn random(coordinate: usize, times: u64) -> f64 {
    let mut state = (coordinate as u64 + 1) ^ (times << 48);
    for _ in 0..3 {
        // Knuth's linear congruential generator, with its upper bits mixed into the lower ones.
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        state ^= state >> 29;
    }
    (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}
