//! # Equilibrium
//!
//! Statics: every step ends in an equilibrium, where all forces balance, F(x, 0, t) = 0, and nothing moves. Over time the body
//! follows changing loads, pins and pointers (quasi-static motion). If nothing changes, one step is enough.
//!
//! Newton's method searches downhill: if there is a potential U, every iteration lowers it. If the equilibrium is far away, it
//! helps to apply the weight and the loads in parts (`load_steps`), or to do so only if the step under the whole load does not
//! converge (`when_not_converged = "halve"`). In statics every change of energy is external work. When a weight is lowered
//! slowly, it releases more energy than the springs store. The rest goes into the hand that lowers it. The energy that goes into
//! the hand is recorded with the work of the loads as `work_user`.
//!
//! **Through a snap** (`arc_length`): when a shallow arch snaps, no equilibrium is near the old one. With this option the load is
//! an unknown as well: each step moves by a given length along the curve of equilibria, past the limit points where the load
//! falls, until the whole load is applied. The reading `load_factor` is the applied fraction of the load.
//!
//! ```text
//!  load │   ╱╲          ╱        the curve of equilibria of a shallow arch: without `arc_length` the body jumps
//!     1 ├──╱──╲────────╱──       at the first limit, or the iteration does not converge; with it every point of
//!       │ ╱    ╲  ____╱          the curve is visited, also those that could not be held by a weight
//!       └────────────────▶ displacement
//! ```
//!
//! Where the body meets obstacles, the curve continues along their surface. If only obstacles hold a body, it has no curve of
//! equilibria, because the curve begins without any load.
//!
//! A body that nothing holds has either no equilibrium or many. Such a body is refused, and the error names its free motions. The
//! same applies to a body of several pieces, such as a map with islands, if one piece is free. Without `arc_length`, obstacles
//! may hold the body too. Within the iteration, a direction without stiffness then gets a billionth of the stiffness of the other
//! directions. If the iteration still fails, the error names the motions that contact leaves free.
//!
//! Other bodies may hold a body too, but it is not known in advance how they hold it. The caller therefore finds the common
//! equilibrium of touching bodies, with the forces and the matrix of each body ([`OpenStep`]).
//!
//! Source: Riks 1979; Crisfield 1981; for the direction along the curve, Feng, Perić, Owen 1996.

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

/// The parameters of `equilibrium`.
pub const SPEC: Spec = Spec {
    kind: "equilibrium",
    summary: "statics: every step ends in the equilibrium of all forces; with `arc_length`, the steps follow a body that snaps through",
    documentation: "F(x, 0, t) = 0, solved by Newton's method with a line search that decreases the potential; velocities are zero. The state at the \
end (`final.csv`) is the equilibrium under the loads at that time. A body that can move freely, as a whole or in one of its pieces, is refused; the \
error names its rigid modes. With `arc_length`, every step advances by that length along the curve of equilibria, through its limit points, until \
the whole load is applied. `load_factor` in diagnostics.csv is the fraction of the load that is applied.",
    dimensions: &[2, 3],
    fields: fields!(
        of_statics,
        Field::new(
            "load_steps",
            Allowed::Integer { least: 1, greatest: 10_000 },
            "",
            Default::Integer(1),
            "The number of parts in which the weight and the loads are applied in the first step.",
        )
        .applies(&[Condition::NotGiven("arc_length")]),
        Field::new(
            "arc_length",
            Allowed::POSITIVE,
            "m",
            Default::Absent,
            "The length of a step along the curve of equilibria: the root mean square of the displacements of all nodes. If it is not given, the \
whole load is applied at once.",
        )
    ),
    roles: &[Role::Statics],
};

/// The kind of integrator that scenes call `equilibrium`.
#[derive(Debug)]
pub struct EquilibriumKind;

/// The equilibrium of all forces.
#[derive(Clone, Copy, Debug)]
pub struct Equilibrium {
    load_steps: u32,
    arc_length: Option<f64>,
    settings: Settings,
}

/// The applied fraction of the load, whether the whole load has been reached, and the latest displacement along the curve of
/// equilibria [m].
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

/// How far a step has come: the applied fraction of the load, the fraction of the motion of pins, and the time since the start of
/// the step [s].
#[derive(Clone, Copy, Debug, PartialEq)]
struct Reached {
    load: f64,
    pin_motion: f64,
    time: f64,
}

impl Reached {
    /// The state half-way to another one.
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

    /// Finds an equilibrium, and divides the step into halves if the search does not succeed at once.
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
            // With a smaller step the model may have a value, so the step is halved. Halving does not help a body that nothing
            // holds.
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

    /// Adds to an error how much of the load was applied, and a hint for statics.
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

    /// Finds the displacement at which the forces balance under a part of the load, starting from `workspace.u`.
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
        // A body that lies on obstacles may still be free to slide or to roll. In this case the iteration does not end, or it
        // ends at an arbitrary position.
        if system.contacts.is_some() && rigid::is_loose(system) {
            self.refuse_what_is_free(system, workspace)?;
        }
        solved.converged &= !leaves_nodes_inside(system, workspace, h);
        report(SPEC.kind, &self.settings, system, workspace, &solved)
    }

    /// Refuses a body that can move as a whole because neither pins nor the contacts of the latest iteration hold it. The error
    /// names the motions.
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

/// The effect of a step of statics on an oscillator. The step stops all motion, and the position becomes zero. Without a
/// restoring force the position does not change.
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
        // Along a curve of equilibria, or with a load in parts, the forces of other bodies are unknown.
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
