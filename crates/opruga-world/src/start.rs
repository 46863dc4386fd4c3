//! The start of a world: from a scene to islands and the first ledger.

use crate::at_start::AtStart;
use crate::blueprint::Blueprint;
use crate::build::{build_colliders, build_integrator, initial_state};
use crate::contact_memory::ContactMemory;
use crate::error::{Part, WorldError};
use crate::ledger::{Energy, Flows, Momentum};
use crate::looks::Looks;
use crate::path_faults::PathFault;
use crate::rebuild::Touched;
use crate::registry::Registry;
use crate::running::Running;
use crate::slots::Slots;
use crate::world::{MOST_THREADS, Options, World};
use opruga_core::integrator::Integrator;
use opruga_core::spec::AllowedValues;
use opruga_math::Simd;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex};

impl<const D: usize> World<D> {
    /// Builds a world from a blueprint with the models and integrators of this library.
    ///
    /// A blueprint that a program has created must satisfy the rules of a scene file: see [`crate::validity`]. Commands are an exception: the
    /// existence of their bodies is checked when they begin.
    ///
    /// # Errors
    /// [`WorldError`] if the blueprint contains something that no scene file could contain, if a model or obstacle refuses, or if the step is
    /// unstable.
    pub fn new(blueprint: Blueprint<D>, options: Options) -> Result<World<D>, WorldError> {
        World::with_registry(blueprint, options, Arc::new(Registry::default()))
    }

    /// Builds a world with a registry that a user has extended.
    ///
    /// # Errors
    /// The errors of [`World::new`].
    pub fn with_registry(
        blueprint: Blueprint<D>,
        options: Options,
        registry: Arc<Registry<D>>,
    ) -> Result<World<D>, WorldError> {
        crate::validity::blueprint(&blueprint)?;
        World::build(blueprint, options, registry)
    }

    fn build(blueprint: Blueprint<D>, options: Options, registry: Arc<Registry<D>>) -> Result<World<D>, WorldError> {
        if !(1..=MOST_THREADS).contains(&options.threads) {
            let allowed = AllowedValues::Integer { least: 1, greatest: MOST_THREADS as i64 };
            let value = options.threads.to_string();
            return Err(WorldError::path("threads", PathFault::Is { value, allowed }));
        }
        let integrator: Arc<dyn Integrator<D>> =
            build_integrator(&registry, &blueprint.integrator, || Part::Section { path: "integrator" })?.into();
        crate::memory::check(&blueprint.bodies, &*integrator, &registry, options.most_bytes)?;
        let colliders = build_colliders(&blueprint)?;
        let pool = (options.threads > 1)
            .then(|| rayon::ThreadPoolBuilder::new().num_threads(options.threads).build())
            .transpose()
            .map_err(|e| WorldError::path("threads", PathFault::Threads { reason: e.to_string() }))?;
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
            clusters: None,
            contact_memory: ContactMemory::default(),
            contacts: None,
            islands_built: 0,
            locations: Vec::new(),
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
        world.refuse_what_meets()?;
        world.warn_of_buried_bodies();
        world.warn_of_pinched_bodies();
        world.warn_of_overlapping_bodies();
        world.warn_of_slender_cells();
        // The ledger starts here.
        world.flows.start = 0.0;
        let start = world.stock_energy();
        (world.flows.start, world.flows.changed) = (start, 0.0);
        world.refresh_ledger();
        world.check_sums()?;
        Ok(world)
    }
}
