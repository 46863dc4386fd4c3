//! The world: bodies, obstacles, time.

use crate::blueprint::{Blueprint, BodyBlueprint, Recorded};
use crate::build::{BodyState, Builder, group, initial_state, rest_volume};
use crate::changes::Change;
use crate::commands::{Progress, Running};
use crate::error::WorldError;
use crate::island::{FramePlan, Island};
use crate::ledger::{Energy, Flows, Momentum};
use crate::loads::ForceLaw;
use crate::looks::Looks;
use crate::registry::Registry;
use opruga_collide::Colliders;
use opruga_core::error::{BuildError, StepError};
use opruga_core::integrator::Integrator;
use opruga_core::potential::Account;
use opruga_core::stability::{Stability, estimate};
use opruga_core::state::View;
use opruga_math::{Simd, WIDTH};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The largest number of threads.
const MOST_THREADS: usize = 256;

/// How a world is run; none of it changes results.
#[derive(Clone, Debug)]
pub struct Options {
    /// Threads, 1 to 256; 1 runs everything on the calling one.
    pub threads: usize,
    /// Vector instructions; none: the best that the processor has.
    pub simd: Option<Simd>,
    /// Steps above the estimated limit are a warning and not an error.
    pub allow_unstable: bool,
    /// Alike bodies are stepped eight at a time.
    pub batches: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options { threads: 1, simd: None, allow_unstable: false, batches: true }
    }
}

/// Something that deserves attention, and how often it happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// A stable code.
    pub code: String,
    /// What happened.
    pub message: String,
    /// How often.
    pub count: u64,
}

/// A body by number and generation: a handle of a body that was removed is told from one that took its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyHandle {
    /// The place in the list of bodies.
    pub index: usize,
    /// How often that place was given up before.
    pub generation: u32,
}

/// Bodies, obstacles and time in `D` dimensions.
pub struct World<const D: usize> {
    pub(crate) blueprint: Blueprint<D>,
    pub(crate) registry: Arc<Registry<D>>,
    pub(crate) options: Options,
    pub(crate) simd: Simd,
    pub(crate) integrator: Box<dyn Integrator<D>>,
    pub(crate) colliders: Option<Arc<Colliders<D>>>,
    pub(crate) islands: Vec<Island<D>>,
    /// Island and lane of every body.
    pub(crate) place: Vec<(usize, usize)>,
    pub(crate) alive: Vec<bool>,
    pub(crate) generation: Vec<u32>,
    pub(crate) states: Vec<Option<BodyState<D>>>,
    pub(crate) running: Vec<Running<D>>,
    pub(crate) user_forces: Vec<(usize, Arc<ForceLaw<D>>)>,
    pub(crate) limited_pulls: Arc<AtomicU64>,
    pub(crate) flows: Flows,
    pub(crate) energy: Energy,
    pub(crate) momentum: Momentum<D>,
    /// Frames since the start.
    pub(crate) frames: u64,
    pub(crate) looks: Looks,
    pub(crate) stability: Vec<(String, Stability)>,
    pub(crate) warnings: Vec<Warning>,
    /// What has changed in the blueprint since the start.
    pub(crate) changes: Vec<Change<D>>,
    /// Bodies that the program has added, whatever became of them.
    pub(crate) added: Vec<BodyBlueprint<D>>,
    pool: Option<rayon::ThreadPool>,
}

impl<const D: usize> core::fmt::Debug for World<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("World").field("bodies", &self.blueprint.bodies.len()).field("frames", &self.frames).finish()
    }
}

impl<const D: usize> World<D> {
    /// Builds a world from a blueprint with the models and integrators of this library.
    ///
    /// # Errors
    /// [`WorldError`] where a model or obstacle refuses, or the step is unstable.
    pub fn new(blueprint: Blueprint<D>, options: Options) -> Result<World<D>, WorldError> {
        World::with_registry(blueprint, options, Arc::new(Registry::default()))
    }

    /// Builds a world with a registry that a user has extended.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn with_registry(
        blueprint: Blueprint<D>,
        options: Options,
        registry: Arc<Registry<D>>,
    ) -> Result<World<D>, WorldError> {
        if !(1..=MOST_THREADS).contains(&options.threads) {
            let message = format!("is {}; allowed: 1 to {MOST_THREADS}", options.threads);
            return Err(WorldError::Path { path: "threads".into(), message });
        }
        let integrator = build_integrator(&registry, &blueprint)?;
        let colliders = build_colliders(&blueprint)?;
        let pool = (options.threads > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(options.threads).build())
            .transpose()
            .map_err(|e| WorldError::Path { path: "threads".into(), message: e.to_string() })?;
        let bodies = blueprint.bodies.len();
        let mut world = World {
            states: blueprint.bodies.iter().map(|b| Some(initial_state(b))).collect(),
            running: blueprint
                .commands
                .iter()
                .map(|c| Running { command: c.clone(), progress: Progress::Waiting })
                .collect(),
            simd: options.simd.unwrap_or_else(Simd::best),
            blueprint,
            registry,
            options,
            integrator,
            colliders,
            islands: Vec::new(),
            place: Vec::new(),
            alive: vec![true; bodies],
            generation: vec![0; bodies],
            user_forces: Vec::new(),
            limited_pulls: Arc::new(AtomicU64::new(0)),
            flows: Flows::default(),
            energy: Energy::default(),
            momentum: Momentum::default(),
            frames: 0,
            looks: Looks::default(),
            stability: Vec::new(),
            warnings: Vec::new(),
            changes: Vec::new(),
            added: Vec::new(),
            pool,
        };
        world.rebuild_from_states()?;
        world.check_stability()?;
        // The ledger starts from here.
        world.flows.start = 0.0;
        let start = world.stock_energy();
        world.flows.start = start;
        world.refresh_ledger();
        Ok(world)
    }

    fn stock_energy(&self) -> f64 {
        self.islands.iter().map(|i| i.survey.kinetic + i.stock.elastic + i.stock.gas + i.survey.gravity).sum()
    }

    pub(crate) fn refresh_ledger(&mut self) {
        (self.energy, self.momentum) = self.flows.ledger(self.islands.iter().map(|i| (&i.stock, &i.survey)));
    }

    /// Copies the state of every body out of the islands.
    pub(crate) fn save_states(&mut self) {
        for body in 0..self.place.len() {
            if !self.alive[body] || self.states[body].is_none() {
                continue;
            }
            let (island, lane) = self.place[body];
            let system = &self.islands[island].system;
            let place = |node| system.layout.place(node, lane);
            let models = self.blueprint.bodies[body].models.len();
            self.states[body] = Some(BodyState {
                x: (0..system.nodes).map(|n| system.state.x.at(place(n))).collect(),
                v: (0..system.nodes).map(|n| system.state.v.at(place(n))).collect(),
                memory: system.members[..models]
                    .iter()
                    .map(|m| m.memory.iter().skip(lane).step_by(WIDTH).copied().collect())
                    .collect(),
            });
        }
    }

    /// Builds islands anew, keeping the state of every body.
    pub(crate) fn rebuild(&mut self) -> Result<(), WorldError> {
        self.save_states();
        self.rebuild_from_states()
    }

    /// Builds islands from the saved states; on failure the old islands stay.
    pub(crate) fn rebuild_from_states(&mut self) -> Result<(), WorldError> {
        let before = self.stock_energy();
        let integrator = build_integrator(&self.registry, &self.blueprint)?;
        let bodies: Vec<Option<&BodyBlueprint<D>>> =
            self.blueprint.bodies.iter().zip(&self.alive).map(|(b, alive)| alive.then_some(b)).collect();
        let groups = group(&bodies, self.options.batches);
        let builder = Builder {
            blueprint: &self.blueprint,
            registry: &self.registry,
            simd: self.simd,
            work_columns: integrator.work_columns(),
        };
        let mut islands = Vec::with_capacity(groups.len());
        let mut place = vec![(0, 0); bodies.len()];
        for members in &groups {
            let states: Vec<&BodyState<D>> = members.iter().filter_map(|b| self.states[*b].as_ref()).collect();
            for (lane, body) in members.iter().enumerate() {
                place[*body] = (islands.len(), lane);
            }
            islands.push(builder.island(members, &states, self.time())?);
        }
        self.islands = islands;
        self.place = place;
        self.integrator = integrator;
        for island in 0..self.islands.len() {
            self.apply_running(island);
        }
        // What a change of the scene does to the energy is nobody's work or loss.
        self.flows.start += self.stock_energy() - before;
        self.refresh_ledger();
        Ok(())
    }

    /// Estimates the stable step of every kind of body.
    pub(crate) fn check_stability(&mut self) -> Result<(), WorldError> {
        self.stability.clear();
        self.warnings.retain(|w| w.code != "step.unstable" && w.code != "step.no_stable_step");
        let h = self.h();
        let mut seen: Vec<(usize, Vec<opruga_core::spec::Values>)> = Vec::new();
        for number in 0..self.islands.len() {
            let body = self.islands[number].bodies[0];
            let blueprint = &self.blueprint.bodies[body];
            let key = (Arc::as_ptr(&blueprint.mesh) as usize, blueprint.models.clone());
            let dragged = self.islands[number].system.members.len() > blueprint.models.len() + 1;
            if !dragged && seen.contains(&key) {
                continue;
            }
            seen.push(key);
            let name = blueprint.name.clone();
            let stability =
                estimate(&self.islands[number].system, &*self.integrator).map_err(|e| WorldError::Build {
                    place: format!("body `{name}`"),
                    source: BuildError::new("stability", "step.not_finite", step_message(&e)),
                })?;
            match stability.largest_stable_step {
                Some(limit) if h > limit => {
                    let error = WorldError::UnstableStep {
                        integrator: self.integrator.name(),
                        body: name.clone(),
                        h,
                        limit,
                        omega: stability.spectrum.omega,
                        damping: stability.spectrum.damping,
                        substeps: (self.blueprint.time.frame / limit).ceil() as u32,
                    };
                    if !self.options.allow_unstable {
                        return Err(error);
                    }
                    self.warnings.push(Warning { code: "step.unstable".into(), message: error.to_string(), count: 1 });
                }
                None => {
                    let growth = stability.spectrum.growth_per_second(&*self.integrator, h);
                    let message = format!(
                        "`{}` has no stable step for body `{name}` (ω = {:.4e} rad/s): its fastest motion grows as exp({growth:.4e} t)",
                        self.integrator.name(),
                        stability.spectrum.omega,
                    );
                    match self.warnings.iter_mut().find(|w| w.code == "step.no_stable_step") {
                        Some(warning) => warning.count += 1,
                        None => self.warnings.push(Warning { code: "step.no_stable_step".into(), message, count: 1 }),
                    }
                }
                _ => {}
            }
            self.stability.push((name, stability));
        }
        Ok(())
    }

    /// Steps through one frame.
    ///
    /// # Errors
    /// [`WorldError`] names body, node and substep; the world is at its last good frame.
    pub fn frame(&mut self) -> Result<(), WorldError> {
        self.run_commands()?;
        let plan = FramePlan {
            integrator: &*self.integrator,
            colliders: self.colliders.as_ref(),
            start: self.time(),
            substeps: self.blueprint.time.substeps,
            h: self.h(),
            look_every: self.looks.every,
        };
        (self.looks.flows, self.looks.fresh) = (self.flows, false);
        let islands = &mut self.islands;
        let step = |island: &mut Island<D>| island.outcome = island.frame(&plan);
        match &self.pool {
            None => islands.iter_mut().for_each(step),
            Some(pool) => pool.install(|| islands.par_iter_mut().for_each(step)),
        }
        if let Some(first) = self.islands.iter().position(|i| i.outcome.is_err()) {
            // All islands go back to the same frame.
            for island in &mut self.islands {
                if island.outcome.is_ok() {
                    island.restore();
                    island.refresh();
                }
                island.work = Default::default();
            }
            let body = |local: usize| self.blueprint.bodies[self.islands[first].bodies[local]].name.clone();
            return Err(match &self.islands[first].outcome {
                Err(StepError::Diverged { body: local, node, time }) => {
                    WorldError::Diverged { body: body(*local), node: *node, time: *time, last: self.time() }
                }
                Err(StepError::Model { model, message }) => {
                    WorldError::Step { body: body(0), message: format!("{model}: {message}") }
                }
                Ok(()) => WorldError::Step { body: body(0), message: String::new() },
            });
        }
        self.frames += 1;
        self.looks.fresh = true;
        for island in &mut self.islands {
            let work = std::mem::take(&mut island.work);
            self.flows.add(&island.system, &work);
        }
        self.flows.limited_pulls = self.limited_pulls.load(Ordering::Relaxed);
        self.refresh_ledger();
        Ok(())
    }

    /// The time [s].
    pub fn time(&self) -> f64 {
        self.looks.time.unwrap_or(self.frames as f64 * self.blueprint.time.frame)
    }
    /// Frames since the start.
    pub fn frames(&self) -> u64 {
        self.frames
    }
    /// The substep [s].
    pub fn h(&self) -> f64 {
        self.blueprint.time.frame / f64::from(self.blueprint.time.substeps)
    }
    /// The scene that the world was built from, with all changes since.
    pub fn blueprint(&self) -> &Blueprint<D> {
        &self.blueprint
    }
    /// The obstacles.
    pub fn colliders(&self) -> Option<&Colliders<D>> {
        self.colliders.as_deref()
    }
    /// The vector instructions in force.
    pub fn simd(&self) -> Simd {
        self.simd
    }
    /// Threads in use.
    pub fn threads(&self) -> usize {
        self.options.threads
    }
    /// The energy ledger of the last frame.
    pub fn energy(&self) -> Energy {
        self.energy
    }
    /// The momentum of the last frame.
    pub fn momentum(&self) -> Momentum<D> {
        self.momentum
    }
    /// The estimates of the stable step, one for each kind of body.
    pub fn stability(&self) -> &[(String, Stability)] {
        &self.stability
    }
    /// Numbers of the bodies that are there.
    pub fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.alive.len()).filter(|b| self.alive[*b])
    }
    /// The number of a body by its name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies().find(|b| self.blueprint.bodies[*b].name == name)
    }
    /// A handle of a body that tells when the body is gone.
    pub fn handle(&self, body: usize) -> Option<BodyHandle> {
        let alive = self.alive.get(body).copied().unwrap_or(false);
        alive.then(|| BodyHandle { index: body, generation: self.generation[body] })
    }
    /// The body of a handle, or none if it was removed.
    pub fn resolve(&self, handle: BodyHandle) -> Option<usize> {
        (self.handle(handle.index) == Some(handle)).then_some(handle.index)
    }
    /// The number of nodes of a body.
    pub fn node_count(&self, body: usize) -> usize {
        self.blueprint.bodies[body].mesh.positions.len()
    }
    /// The position of a node [m].
    pub fn position(&self, body: usize, node: u32) -> [f64; D] {
        let (island, lane) = self.place[body];
        let system = &self.islands[island].system;
        system.state.x.at(system.layout.place(node as usize, lane))
    }
    /// The velocity of a node [m/s].
    pub fn velocity(&self, body: usize, node: u32) -> [f64; D] {
        let (island, lane) = self.place[body];
        let system = &self.islands[island].system;
        system.state.v.at(system.layout.place(node as usize, lane))
    }
    /// Moves a node and gives it a velocity, from outside of the physics.
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no such node, or a number is not finite; the world stays as it was.
    pub fn place_node(
        &mut self,
        body: usize,
        node: u32,
        position: [f64; D],
        velocity: [f64; D],
    ) -> Result<(), WorldError> {
        let refuse = |message: String| Err(WorldError::Path { path: format!("body {body}, node {node}"), message });
        if self.handle(body).is_none() || node as usize >= self.node_count(body) {
            return refuse("there is no such node".into());
        }
        if let Some(x) = position.iter().chain(&velocity).find(|x| !x.is_finite()) {
            return refuse(format!("{x} is no place and no velocity; allowed: finite numbers"));
        }
        let (island, lane) = self.place[body];
        let island = &mut self.islands[island];
        let place = island.system.layout.place(node as usize, lane);
        island.system.state.x.set(place, position);
        island.system.state.v.set(place, velocity);
        island.refresh();
        // Nobody's work or loss.
        let before = self.energy.total();
        self.flows.start += self.stock_energy() - before;
        self.refresh_ledger();
        Ok(())
    }
    /// The mass of a node [kg].
    pub fn node_mass(&self, body: usize, node: u32) -> f64 {
        let (island, lane) = self.place[body];
        let system = &self.islands[island].system;
        system.mass.at(system.layout.place(node as usize, lane))
    }
    /// Adds a force on every node of a body by a user's law of (node, position, velocity, time).
    ///
    /// # Errors
    /// [`WorldError`] if the islands cannot be built anew.
    pub fn add_force(&mut self, body: usize, law: Arc<ForceLaw<D>>) -> Result<(), WorldError> {
        self.user_forces.push((body, law));
        self.rebuild()
    }
    /// What models say of a body: `volume`, `pressure` and others.
    ///
    /// A body that is not there says nothing.
    pub fn readings(&mut self, body: usize) -> Vec<(&'static str, f64)> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.place[body];
        let time = self.time();
        let system = &mut self.islands[island].system;
        let view = View {
            x: system.state.x.slices(),
            v: system.state.v.slices(),
            nodes: system.nodes,
            layout: system.layout,
            time,
        };
        let mut out = Vec::new();
        for member in &mut system.members {
            if member.potential.prepare(system.simd, &view, &member.memory, &mut member.scratch).is_ok() {
                out.extend(member.potential.readings(&view, &member.scratch, &member.memory, lane));
            }
        }
        out
    }
    /// The enclosed volume of a body at rest [m³] (area times thickness in 2D).
    pub fn rest_volume(&self, body: usize) -> f64 {
        rest_volume(&self.blueprint.bodies[body])
    }
    /// The values of a probe now: names of columns and numbers, which are NaN while its body is not there.
    pub fn probe(&mut self, number: usize) -> Vec<(String, f64)> {
        let probe = self.blueprint.probes[number].clone();
        let there = self.handle(probe.body).is_some();
        let nodes = if there { self.selected(probe.body, &probe.select) } else { Vec::new() };
        let axes = ["x", "y", "z"];
        let mut out = Vec::new();
        for what in &probe.record {
            let (word, vector) = match what {
                Recorded::Position => ("", self.mean(&nodes, |w, n| w.position(probe.body, n))),
                Recorded::Velocity => ("v", self.mean(&nodes, |w, n| w.velocity(probe.body, n))),
                Recorded::Reaction if there => ("r", self.reaction(probe.body, &nodes)),
                Recorded::Reaction => ("r", [0.0; D]),
            };
            for d in 0..D {
                out.push((format!("{}.{}{}", probe.name, word, axes[d]), if there { vector[d] } else { f64::NAN }));
            }
        }
        out
    }
    fn mean(&self, nodes: &[u32], of: impl Fn(&Self, u32) -> [f64; D]) -> [f64; D] {
        let mut sum = [0.0; D];
        for node in nodes {
            let value = of(self, *node);
            for d in 0..D {
                sum[d] += value[d];
            }
        }
        sum.map(|s| s / nodes.len().max(1) as f64)
    }
    /// The forces of the models of one account on the nodes of a body [N]; none: of all models, gravity included.
    ///
    /// Empty where the body is not there or a model refuses the state.
    pub fn node_forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; D]> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.place[body];
        let system = &mut self.islands[island].system;
        let forces = match account {
            Some(account) => system.forces_of(account),
            None => system.forces(true),
        };
        let Ok(forces) = forces else { return Vec::new() };
        (0..system.nodes).map(|node| forces.at(system.layout.place(node, lane))).collect()
    }
    /// The sum of the forces that pins exert on nodes [N].
    pub fn reaction(&mut self, body: usize, nodes: &[u32]) -> [f64; D] {
        let (island, lane) = self.place[body];
        let system = &mut self.islands[island].system;
        let mut sum = [0.0; D];
        let Ok(forces) = system.forces(true) else { return sum };
        for node in nodes {
            let place = system.layout.place(*node as usize, lane);
            for pin in system.pins.iter().filter(|p| p.place == place) {
                for d in 0..D {
                    if pin.axes[d] {
                        sum[d] -= forces.0[d][place];
                    }
                }
            }
        }
        sum
    }
    /// Warnings so far, with counts.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut out = self.warnings.clone();
        let mut count = |code: &str, message: &str, count: u64| {
            if count > 0 {
                out.push(Warning { code: code.into(), message: message.into(), count });
            }
        };
        count("limit.force", "forces were shortened to `world.largest_force`", self.flows.limited_forces);
        count("limit.velocity", "velocities were shortened to `world.largest_velocity`", self.flows.limited_velocities);
        count("limit.drag", "pulls were shortened to their `largest_force`", self.flows.limited_pulls);
        let mut counts: Vec<(&'static str, u64)> = Vec::new();
        for island in &self.islands {
            for member in &island.system.members {
                for (name, n) in member.potential.counts(&member.memory) {
                    match counts.iter_mut().find(|c| c.0 == name) {
                        Some(entry) => entry.1 += n,
                        None => counts.push((name, n)),
                    }
                }
            }
        }
        for (name, n) in counts {
            count(name, "a limit of the model acted, counted per substep and body", n);
        }
        out
    }
    /// A 64-bit hash (FNV-1a) over the little-endian bits of all positions, then velocities, body by body in node order.
    pub fn state_hash(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut feed = |number: f64| {
            for byte in number.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        for velocities in [false, true] {
            for body in 0..self.alive.len() {
                if !self.alive[body] {
                    continue;
                }
                for node in 0..self.node_count(body) as u32 {
                    let value = if velocities { self.velocity(body, node) } else { self.position(body, node) };
                    value.into_iter().for_each(&mut feed);
                }
            }
        }
        hash
    }
    /// Bytes on the heap for the state and the models of all bodies.
    pub fn heap_bytes(&self) -> usize {
        self.islands.iter().map(Island::heap_bytes).sum()
    }
}

/// What an error of the estimate says, without the name of the estimate.
fn step_message(error: &StepError) -> String {
    match error {
        StepError::Model { message, .. } => message.clone(),
        other => other.to_string(),
    }
}

/// The obstacles of a blueprint.
pub(crate) fn build_colliders<const D: usize>(
    blueprint: &Blueprint<D>,
) -> Result<Option<Arc<Colliders<D>>>, WorldError> {
    if blueprint.colliders.is_empty() {
        return Ok(None);
    }
    let values: Vec<_> = blueprint.colliders.iter().map(|c| c.values.clone()).collect();
    let built = Colliders::<D>::build(&values);
    Ok(Some(Arc::new(built.map_err(|source| WorldError::Build { place: "collider".into(), source })?)))
}

fn build_integrator<const D: usize>(
    registry: &Registry<D>,
    blueprint: &Blueprint<D>,
) -> Result<Box<dyn Integrator<D>>, WorldError> {
    let kind = blueprint.integrator.kind();
    let refuse = |source| WorldError::Build { place: "integrator".into(), source };
    let Some(kind) = registry.integrator(kind) else {
        let source = opruga_core::error::BuildError::new(kind, "scene.unknown_name", "there is no such integrator");
        return Err(refuse(source));
    };
    kind.build(&blueprint.integrator).map_err(refuse)
}
