//! The world: bodies, obstacles, time.

use crate::blueprint::{Blueprint, CommandBlueprint};
use crate::build::{build_colliders, build_integrator, initial_state};
use crate::changes::AtStart;
use crate::commands::Running;
use crate::error::WorldError;
use crate::inputs::Input;
use crate::island::{FramePlan, Island};
use crate::ledger::{Energy, Flows, Momentum};
use crate::loads::ForceLaw;
use crate::looks::Looks;
use crate::rebuild::Touched;
use crate::registry::Registry;
use crate::slots::{BodyHandle, Slots};
use opruga_collide::Colliders;
use opruga_core::break_off::BreakOff;
use opruga_core::error::StepError;
use opruga_core::integrator::Integrator;
use opruga_core::stability::Stability;
use opruga_core::system::Workspace;
use opruga_core::threads::together;
use opruga_math::Simd;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

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
    /// What ends a frame that takes long within a substep, with [`WorldError::BrokenOff`] and at the last good frame: asked for, and
    /// no longer asked for, from outside.
    pub break_off: Arc<BreakOff>,
    /// What its bodies may take together, by an estimate before they are built [bytes]; none: what the machine gives.
    pub most_bytes: Option<u64>,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            threads: 1,
            simd: None,
            allow_unstable: false,
            batches: true,
            break_off: Arc::default(),
            most_bytes: None,
        }
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

/// Bodies, obstacles and time in `D` dimensions.
pub struct World<const D: usize> {
    pub(crate) blueprint: Blueprint<D>,
    pub(crate) registry: Arc<Registry<D>>,
    pub(crate) options: Options,
    pub(crate) simd: Simd,
    /// That of the scene; a body may have its own.
    pub(crate) integrator: Arc<dyn Integrator<D>>,
    pub(crate) colliders: Option<Arc<Colliders<D>>>,
    pub(crate) islands: Vec<Island<D>>,
    /// How many islands were built since the start.
    pub(crate) islands_built: u64,
    /// Island and lane of every body.
    pub(crate) place: Vec<(usize, usize)>,
    /// Who is where in the list of bodies.
    pub(crate) slots: Slots,
    /// Commands of the scene and those that act as if it had held them; behind them those of the program that are not over.
    pub(crate) running: Vec<Running<D>>,
    /// The first command that could not begin in the last frame.
    pub(crate) refused: Option<Box<CommandBlueprint<D>>>,
    pub(crate) user_forces: Vec<(BodyHandle, Arc<ForceLaw<D>>)>,
    /// How many laws of force bodies had in the snapshot that was restored last, which cannot hold the laws themselves.
    pub(crate) laws_saved: BTreeMap<usize, u64>,
    pub(crate) limited_pulls: Arc<AtomicU64>,
    pub(crate) flows: Flows,
    pub(crate) energy: Energy,
    pub(crate) momentum: Momentum<D>,
    /// Frames since the start.
    pub(crate) frames: u64,
    pub(crate) looks: Looks,
    pub(crate) stability: Vec<(String, Stability)>,
    pub(crate) warnings: Vec<Warning>,
    /// The parts of the blueprint that have changed since the start, as they were.
    pub(crate) at_start: AtStart<D>,
    /// The cosine of the farthest turn of cells under the law `linear` that was warned of.
    pub(crate) farthest_turn: f64,
    /// What the program has done since it was last asked for; none: it is not written down.
    pub(crate) inputs: Option<Vec<Input<D>>>,
    /// One for each thread.
    pub(crate) workspaces: Vec<Mutex<Workspace<D>>>,
    pool: Option<rayon::ThreadPool>,
}

/// A workspace holds nothing between steps: one that a panic left behind is as good as any.
pub(crate) fn lock<const D: usize>(workspace: &Mutex<Workspace<D>>) -> MutexGuard<'_, Workspace<D>> {
    workspace.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<const D: usize> core::fmt::Debug for World<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("World").field("bodies", &self.blueprint.bodies.len()).field("frames", &self.frames).finish()
    }
}

impl<const D: usize> World<D> {
    pub(crate) fn build(
        blueprint: Blueprint<D>,
        options: Options,
        registry: Arc<Registry<D>>,
    ) -> Result<World<D>, WorldError> {
        if !(1..=MOST_THREADS).contains(&options.threads) {
            let message = format!("is {}; allowed: 1 to {MOST_THREADS}", options.threads);
            return Err(WorldError::Path { path: "threads".into(), message });
        }
        let integrator: Arc<dyn Integrator<D>> =
            build_integrator(&registry, &blueprint.integrator, || "integrator".into())?.into();
        crate::memory::check(&blueprint.bodies, &*integrator, &registry, options.most_bytes)?;
        let colliders = build_colliders(&blueprint)?;
        let pool = (options.threads > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(options.threads).build())
            .transpose()
            .map_err(|e| WorldError::Path { path: "threads".into(), message: e.to_string() })?;
        let workspaces = (0..options.threads).map(|_| Mutex::default()).collect();
        let bodies = blueprint.bodies.len();
        let states = blueprint.bodies.iter().map(initial_state).enumerate().collect();
        let mut world = World {
            running: blueprint.commands.iter().map(|c| Running::waiting(c.clone())).collect(),
            refused: None,
            simd: options.simd.unwrap_or_else(Simd::best),
            blueprint,
            registry,
            options,
            integrator,
            colliders,
            islands: Vec::new(),
            islands_built: 0,
            place: Vec::new(),
            slots: Slots::of_scene(bodies),
            user_forces: Vec::new(),
            laws_saved: BTreeMap::new(),
            limited_pulls: Arc::new(AtomicU64::new(0)),
            flows: Flows::default(),
            energy: Energy::default(),
            momentum: Momentum::default(),
            frames: 0,
            looks: Looks::default(),
            stability: Vec::new(),
            warnings: Vec::new(),
            at_start: AtStart::default(),
            farthest_turn: 1.0,
            inputs: None,
            workspaces,
            pool,
        };
        world.regroup(&Touched::All, &states)?;
        world.check_stability()?;
        world.warn_of_buried_bodies();
        world.warn_of_slender_cells();
        // The ledger starts from here.
        world.flows.start = 0.0;
        let start = world.stock_energy();
        (world.flows.start, world.flows.changed) = (start, 0.0);
        world.refresh_ledger();
        world.check_sums()?;
        Ok(world)
    }

    pub(crate) fn stock_energy(&self) -> f64 {
        self.islands.iter().map(|i| i.survey.kinetic + i.stock.elastic + i.stock.gas + i.survey.gravity).sum()
    }

    pub(crate) fn refresh_ledger(&mut self) {
        let islands = self.islands.iter().map(|i| (&i.stock, &i.survey));
        (self.energy, self.momentum) = self.flows.ledger(self.h(), islands);
    }

    pub(crate) fn frame_here(&mut self) -> Result<(), WorldError> {
        self.run_commands()?;
        let plan = FramePlan {
            colliders: self.colliders.as_ref(),
            start: self.time(),
            substeps: self.blueprint.time.substeps,
            h: self.h(),
            look_every: self.looks.every,
            unfold: self.blueprint.surroundings.unfold,
        };
        (self.looks.flows, self.looks.fresh) = (self.flows, false);
        let islands = &mut self.islands;
        let workspaces = &mut self.workspaces;
        // One small body has nothing to share: waking threads for it would cost more than its frame.
        let alone = |island: &[Island<D>]| matches!(island, [one] if !one.is_shared_by(self.options.threads, 1));
        match self.pool.as_ref().filter(|_| !alone(islands)) {
            None => islands.iter_mut().for_each(|island| island.frame(&plan, &mut lock(&workspaces[0]))),
            Some(pool) => pool.install(|| {
                // Large bodies one after the other, each on all threads; then the others, one a thread. A body that waits for
                // its threads must not be handed another one, whose workspace would be its own.
                let (threads, count) = (pool.current_num_threads(), islands.len());
                for island in islands.iter_mut().filter(|island| island.is_shared_by(threads, count)) {
                    island.system.threads = threads;
                    together(threads, || island.frame(&plan, &mut lock(&workspaces[0])));
                    island.system.threads = 1;
                }
                islands.par_iter_mut().filter(|island| !island.is_shared_by(threads, count)).for_each(|island| {
                    let thread = rayon::current_thread_index().unwrap_or(0);
                    island.frame(&plan, &mut lock(&workspaces[thread]));
                });
            }),
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
                Err(StepError::Diverged { body: local, node, time, range }) => {
                    let (body, last) = (body(*local), self.time());
                    WorldError::Diverged { body, node: *node, time: *time, last, range: *range }
                }
                Err(StepError::BrokenOff) => WorldError::BrokenOff,
                Err(StepError::Model { model, message }) => {
                    WorldError::Step { body: body(0), message: format!("{model}: {message}") }
                }
                Err(error @ StepError::NotConverged { hint, .. }) => {
                    WorldError::NotConverged { body: body(0), message: error.to_string(), hint: hint.to_string() }
                }
                Ok(()) => WorldError::Step { body: body(0), message: String::new() },
            });
        }
        self.frames += 1;
        self.looks.fresh = true;
        for island in &mut self.islands {
            let work = std::mem::take(&mut island.work);
            self.flows.add(island, &work);
        }
        self.flows.limited_pulls = self.limited_pulls.load(Ordering::Relaxed);
        self.refresh_ledger();
        if !(self.energy.is_finite() && self.momentum.is_finite()) {
            return Err(self.take_back_frame());
        }
        self.flows.count_frame(&self.energy);
        self.warn_of_crushed_bodies();
        self.warn_of_turned_cells();
        self.take_away_what_is_far()
    }

    /// Goes back to the last good frame, from one whose states are sound and whose sums are not.
    fn take_back_frame(&mut self) -> WorldError {
        for island in &mut self.islands {
            island.restore();
            island.refresh();
        }
        self.frames -= 1;
        (self.flows, self.looks.fresh) = (self.looks.flows, false);
        self.refresh_ledger();
        WorldError::Overflow { last: self.time() }
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
    pub(crate) fn place_node_here(
        &mut self,
        body: usize,
        node: u32,
        position: [f64; D],
        velocity: [f64; D],
    ) -> Result<(), WorldError> {
        let refuse = |message: String| Err(WorldError::Path { path: format!("body {body}, node {node}"), message });
        if node as usize >= self.node_count(body) {
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
        // What an integrator remembers does not lead to here.
        island.system.history.reset();
        island.refresh();
        // Nobody's work or loss.
        let before = self.energy.total();
        self.flows.start += self.stock_energy() - before;
        self.refresh_ledger();
        self.write_down(|| Input::Place { body, node, position, velocity });
        Ok(())
    }
    pub(crate) fn add_force_here(&mut self, body: usize, law: Arc<ForceLaw<D>>) -> Result<(), WorldError> {
        let Some(handle) = self.handle(body) else {
            return Err(WorldError::Path { path: format!("body {body}"), message: "there is no such body".into() });
        };
        self.user_forces.push((handle, law));
        let outcome = self.rebuild(&BTreeSet::from([body]));
        match outcome {
            Ok(()) => self.write_down(|| Input::Force { body }),
            Err(_) => _ = self.user_forces.pop(),
        }
        outcome
    }
}
