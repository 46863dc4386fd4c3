//! # Equilibrium
//!
//! Every step ends where all forces balance, F(x, 0, t) = 0, and nothing moves: statics. Over time it follows loads, pins
//! and pointers that change (quasi-static motion); one step is enough where nothing does.
//!
//! Newton's method looks for the balance downhill: on the potential U, where there is one, every iteration lowers it. From
//! far away it helps to put the weight and the loads on in parts (`load_steps`), or to let that be tried where the whole is too
//! much (`when_not_converged = "halve"`). In statics every change of energy is work from outside: what a weight that is let
//! down slowly would give, and the springs do not take, is held back by the hand that lets it down, and is entered with the
//! work of the loads as `work_user`.
//!
//! **Through a snap** (`arc_length`): where a shallow arch gives way, no equilibrium is near the old one. Then the load is an
//! unknown as well: each step goes a given way along the curve of equilibria, through its limits where the load falls, until
//! all of the load is on. The part that is on is the reading `load_factor`.
//!
//! ```text
//!  load │   ╱╲          ╱        the curve of equilibria of a shallow arch: without `arc_length` the body jumps
//!     1 ├──╱──╲────────╱──       at the first limit, or the iteration does not converge; with it every point of
//!       │ ╱    ╲  ____╱          the curve is visited, also those that could not be held by a weight
//!       └────────────────▶ way
//! ```
//!
//! Obstacles stop the curve where the body meets them, and it goes on along their surface; a body that is held by obstacles
//! alone has no curve, which begins without any load.
//!
//! A body that nothing holds has no equilibrium, or many: it is refused with the names of the motions that are free, and so is
//! one of several pieces, such as a map with islands, of which one is free.
//! Without `arc_length` obstacles hold it too; a direction without any stiffness is then held by a billionth of the stiffness of the others,
//! within the iteration only. Where that leads nowhere, the motions are named that contact leaves free.
//!
//! Other bodies may hold a body too. Nobody knows before how: so the common balance of bodies that touch is searched for from outside, with the
//! forces and the matrix of each ([`OpenStep`]).
//!
//! Source: Riks 1979; Crisfield 1981; for the direction on the curve Feng, Perić, Owen 1996.

mod among_others;
mod arc;
pub mod motion;
pub(crate) mod pieces;
pub(crate) mod restraint;
pub mod rigid;
mod slack;
#[cfg(test)]
mod tests;

use self::among_others::AmongOthers;
use crate::implicit::balance::Balance;
use crate::implicit::convergence::report;
use crate::implicit::ends::Statics;
use crate::implicit::linear::has_symmetric_matrix;
use crate::implicit::memory;
use crate::implicit::minimiser::Minimiser;
use crate::implicit::newton::Newton;
use crate::implicit::open;
use crate::implicit::settings::{MOST_HALVINGS, Otherwise, Settings, Solver, fields};
use crate::implicit::step_limit::{leaves_nodes_inside, lift_out};
use crate::implicit::workspace::Workspace;
use crate::refusals::Refusal;
use opruga_core::error::{BuildError, StepError};
use opruga_core::history::{Channel, PerBody, PerNode};
use opruga_core::integrator::{Amplification, Integrator, IntegratorKind};
use opruga_core::memory::Counts;
use opruga_core::open_step::OpenStep;
use opruga_core::potential::{Reading, Views};
use opruga_core::spec::{Allowed, Condition, Default, Field, Role, Spec, Values};
use opruga_core::system::System;
use opruga_solve::blocks::nodes;

/// The parameters.
pub const SPEC: Spec = Spec {
    kind: "equilibrium",
    summary: "statics: every step ends in the balance of all forces, through a snap by arc length",
    documentation: "F(x, 0, t) = 0 by Newton's method, downhill on the potential; velocities are zero. The state at the end \
(`final.csv`) is the equilibrium under the loads at that time. A body that nothing holds, or a piece of one, is refused with the names of its \
rigid modes. With `arc_length` every step goes so far along the curve of equilibria, through its limits, until the whole load \
is on; `load_factor` in diagnostics.csv is the part that is on.",
    dimensions: &[2, 3],
    fields: fields!(
        of_statics,
        Field::new(
            "load_steps",
            Allowed::Integer { least: 1, greatest: 10_000 },
            "",
            Default::Integer(1),
            "In how many parts the weight and the loads are put on in the first step.",
        )
        .applies(&[Condition::NotGiven("arc_length")]),
        Field::new(
            "arc_length",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "The way of a step along the curve of equilibria, as the root of the mean square of the displacements of all nodes. \
Absent: the whole load at once.",
        )
    ),
    roles: &[Role::Statics],
};

/// The kind `equilibrium`.
#[derive(Debug)]
pub struct EquilibriumKind;

/// The balance of all forces.
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium {
    load_steps: u32,
    arc_length: Option<f64>,
    settings: Settings,
}

/// The part of the load that is on, whether it has reached the whole, and the last displacement along the curve of equilibria [m].
const LOAD: PerBody<f64> = PerBody::new("equilibrium.load");
const COMPLETE: PerBody<bool> = PerBody::new("equilibrium.complete");
const DISPLACEMENT: PerNode = PerNode::new("equilibrium.displacement");

impl<const D: usize> IntegratorKind<D> for EquilibriumKind {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        false
    }
    fn build(&self, values: &Values) -> Result<Box<dyn Integrator<D>>, BuildError> {
        let rule = Equilibrium::new(values);
        if rule.arc_length.is_some() && rule.settings.solver == Solver::MatrixFree {
            return Err(BuildError::of(SPEC.kind, Refusal::MatrixFreeByArc {}));
        }
        Ok(Box::new(rule))
    }
}

/// Up to where a step has come: the part of the load that is on, that of the way of what is held, and the time after its
/// start [s].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reached {
    load: f64,
    pin_motion: f64,
    time: f64,
}

impl Reached {
    /// Half the way to another point.
    fn midway(self, to: Reached) -> Reached {
        let mean = |a: f64, b: f64| 0.5 * (a + b);
        Reached {
            load: mean(self.load, to.load),
            pin_motion: mean(self.pin_motion, to.pin_motion),
            time: mean(self.time, to.time),
        }
    }
}

impl Equilibrium {
    fn new(values: &Values) -> Equilibrium {
        Equilibrium {
            load_steps: values.integer("load_steps").unwrap_or(1) as u32,
            arc_length: values.number("arc_length"),
            settings: Settings::new(values),
        }
    }

    /// Goes to a balance, by halves where it is not found at once.
    fn go<const D: usize>(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        (from, to): (Reached, Reached),
        h: f64,
        halvings: u32,
    ) -> Result<(), StepError> {
        workspace.u1.copy_from_slice(&workspace.u);
        let outcome = self.balance(system, workspace, to, h);
        let too_far = match &outcome {
            Err(StepError::NotConverged { .. }) => true,
            // Nearer a model may have a meaning; what nothing holds stays so.
            Err(StepError::Model { model, .. }) => *model != SPEC.kind,
            _ => false,
        };
        if !too_far {
            return outcome;
        }
        if self.settings.otherwise == Otherwise::Halve && halvings < MOST_HALVINGS {
            let solver = &mut system.work.solver;
            solver.halved += 1;
            solver.deepest = solver.deepest.max(u64::from(halvings) + 1);
            workspace.hold(system, from.pin_motion, h);
            for k in 0..workspace.u.len() {
                workspace.u[k] = if workspace.pin_displacement[k].is_nan() {
                    workspace.u1[k]
                } else {
                    workspace.pin_displacement[k]
                };
            }
            let middle = from.midway(to);
            self.go(system, workspace, (from, middle), h, halvings + 1)?;
            return self.go(system, workspace, (middle, to), h, halvings + 1);
        }
        outcome.map_err(|error| self.with_hint(error, system, (from.load > 0.0 && from.load < 1.0).then_some(from)))
    }

    /// An error with how far the load was on, and what helps in statics.
    fn with_hint<const D: usize>(&self, mut error: StepError, system: &System<D>, from: Option<Reached>) -> StepError {
        let helps = self.settings.hint_of_statics(self.arc_length.is_some(), system.contacts.is_none());
        match &mut error {
            StepError::Model { model, about, helps: own } if *model != SPEC.kind && about.hint().is_none() => {
                *own = Some(helps.into());
            }
            StepError::NotConverged { beyond, hint, .. } => {
                *beyond = from.map(|from| from.load);
                if *hint == self.settings.hint().into() {
                    *hint = helps.into();
                }
            }
            _ => {}
        }
        error
    }

    /// Looks for the displacement at which the forces balance under a part of the load, from that in `workspace.u` on.
    fn balance<const D: usize>(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        at: Reached,
        h: f64,
    ) -> Result<(), StepError> {
        workspace.hold(system, at.pin_motion, h);
        let balance =
            Balance { sigma: 0.0, beta: 0.0, theta: 1.0, time: at.time, h, load: at.load, impulse: 1.0, echo: 0.0 };
        let mut solved = Newton(self.settings).minimise(system, workspace, &balance)?;
        // A body that lies on obstacles may still be free to slide or to roll, which no iteration ends, or at any place.
        if system.contacts.is_some() && rigid::is_loose(system) {
            self.refuse_what_is_free(system, workspace)?;
        }
        solved.converged &= !leaves_nodes_inside(system, workspace, h);
        report(SPEC.kind, &self.settings, system, workspace, &solved)
    }

    /// Names the motions of the whole that neither pins nor the contacts of the last iteration hold.
    fn refuse_what_is_free<const D: usize>(
        &self,
        system: &System<D>,
        workspace: &Workspace<D>,
    ) -> Result<(), StepError> {
        let mut x = system.state.x.clone();
        for (node, (from, displacement)) in nodes::<D>(&workspace.x0).iter().zip(nodes::<D>(&workspace.u)).enumerate() {
            x.set(node, core::array::from_fn(|d| from[d] + displacement[d]));
        }
        rigid::refuse_what_contact_leaves_free(system, &x, &workspace.contacting.directions())
    }

    fn attempt<const D: usize>(
        &self,
        system: &mut System<D>,
        workspace: &mut Workspace<D>,
        h: f64,
    ) -> Result<(), StepError> {
        let statics = Statics::begin(system, workspace)?;
        let (mut load, complete) = (system.history.get(LOAD), system.history.get(COMPLETE));
        workspace.contacting.clear(system.nodes);
        workspace.y.fill(0.0);
        workspace.z.fill(0.0);
        workspace.hold(system, 1.0, h);
        for k in 0..workspace.u.len() {
            workspace.u[k] = if workspace.pin_displacement[k].is_nan() { 0.0 } else { workspace.pin_displacement[k] };
        }
        lift_out(system, workspace, h);
        let whole = Reached { load: 1.0, pin_motion: 1.0, time: h };
        match self.arc_length {
            Some(length) if !complete => {
                load = arc::follow(self, system, workspace, length, load, h)
                    .map_err(|error| self.with_hint(error, system, Some(Reached { load, ..whole })))?;
            }
            _ if complete => {
                let start = Reached { pin_motion: 0.0, time: 0.0, ..whole };
                self.go(system, workspace, (start, whole), h, 0)?;
            }
            _ => {
                let mut from = Reached { load: 0.0, pin_motion: 0.0, time: 0.0 };
                for part in 1..=self.load_steps {
                    load = f64::from(part) / f64::from(self.load_steps);
                    let to = Reached { load, ..whole };
                    self.go(system, workspace, (from, to), h, 0)?;
                    from = to;
                }
            }
        }
        workspace.u1.copy_from_slice(&workspace.u);
        if let Some(displacement) = system.history.vectors_mut(DISPLACEMENT) {
            for (node, u) in nodes::<D>(&workspace.u1).iter().enumerate() {
                displacement.set(node, *u);
            }
        }
        system.history.set(LOAD, load);
        system.history.set(COMPLETE, load >= 1.0);
        statics.end(system, workspace, h)
    }
}

/// To rest at once; where nothing pulls back, it stays where it is.
fn to_rest(omega: f64) -> Amplification {
    let kept = if omega > 0.0 { 0.0 } else { 1.0 };
    Amplification::new([[kept, 0.0], [0.0, 0.0]])
}

impl<const D: usize> Integrator<D> for Equilibrium {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn needs(&self) -> Views {
        Views { hessian: true, ..Views::default() }
    }
    fn work_columns(&self) -> usize {
        1
    }
    fn history(&self) -> Vec<Channel> {
        let along_the_curve = self.arc_length.map(|_| DISPLACEMENT.declared());
        [LOAD.declared(), COMPLETE.declared()].into_iter().chain(along_the_curve).collect()
    }
    fn amplification(&self, omega: f64, _c: f64, _h: f64) -> Amplification {
        to_rest(omega)
    }
    fn check(&self, system: &System<D>, obstacles: bool) -> Result<(), BuildError> {
        if self.settings.solver == Solver::MatrixFree && !has_symmetric_matrix(system) {
            return Err(BuildError::of(SPEC.kind, Refusal::Unsymmetric {}));
        }
        if !obstacles {
            return rigid::refuse_free_motions(system);
        }
        if self.arc_length.is_some() && rigid::is_loose(system) {
            return Err(BuildError::of(SPEC.kind, Refusal::LooseByArc {}));
        }
        Ok(())
    }
    fn memory(&self, counts: &Counts, couplings: f64) -> f64 {
        memory::of_body::<D>(&self.settings, counts, couplings)
    }
    fn readings(&self, system: &System<D>) -> Vec<Reading> {
        vec![("load_factor".into(), system.history.get(LOAD))]
    }
    fn part_of_load(&self, system: &System<D>) -> Option<f64> {
        self.arc_length.is_some().then(|| system.history.get(LOAD))
    }
    fn same_bits_everywhere(&self, system: &System<D>) -> bool {
        self.arc_length.is_none() && Newton(self.settings).same_bits_everywhere(system)
    }
    fn is_static(&self) -> bool {
        true
    }
    fn takes_pushes(&self) -> bool {
        // Along a curve of equilibria, and by parts of a load, nobody knows how others push.
        self.arc_length.is_none() && self.load_steps == 1
    }
    fn open(&self, system: &mut System<D>, h: f64) -> Option<Result<Box<dyn OpenStep<D>>, StepError>> {
        <Self as Integrator<D>>::takes_pushes(self).then(|| open::open_at_rest(AmongOthers, self.settings, system, h))
    }
    fn takes_mass_matrix(&self) -> bool {
        true
    }
    fn step(&self, system: &mut System<D>, h: f64) -> Result<(), StepError> {
        let mut workspace = system.cache.take::<Workspace<D>>();
        let (work, velocities) = (system.work, system.state.v.clone());
        let outcome = self.attempt(system, &mut workspace, h);
        if outcome.is_err() {
            let solver = system.work.solver;
            system.work = work;
            system.work.solver = solver;
            system.state.v = velocities;
        }
        system.cache.put(workspace);
        outcome
    }
}
