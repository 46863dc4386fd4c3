//! The world: bodies, obstacles, time.

use crate::at_start::AtStart;
use crate::blueprint::{Blueprint, CommandBlueprint};
use crate::clusters::Clusters;
use crate::contact_memory::ContactMemory;
use crate::contact_report::Contact;
use crate::inputs::Input;
use crate::island::Island;
use crate::ledger::{Energy, Flows, Momentum};
use crate::loads::ForceLaw;
use crate::looks::Looks;
use crate::registry::Registry;
use crate::running::Running;
use crate::slots::{BodyHandle, Slots};
use crate::warnings::Warning;
use opruga_collide::Colliders;
use opruga_core::break_off::BreakOff;
use opruga_core::integrator::Integrator;
use opruga_core::stability::Stability;
use opruga_core::system::Workspace;
use opruga_math::Simd;
use std::collections::BTreeMap;
use std::sync::atomic::AtomicU64;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The largest number of threads.
pub(crate) const MOST_THREADS: usize = 256;

/// Options that control how a world is run; none of them changes results.
#[derive(Clone, Debug)]
pub struct Options {
    /// The number of threads, 1 to 256; 1 runs everything on the calling thread.
    pub threads: usize,
    /// The vector instructions; `None` stands for the best that the processor supports.
    pub simd: Option<Simd>,
    /// Whether steps above the estimated limit cause a warning instead of an error.
    pub allow_unstable: bool,
    /// Whether bodies of the same kind are stepped eight at a time.
    pub batches: bool,
    /// A request from outside to cancel a long frame. The frame then ends within a substep with [`WorldError::BrokenOff`], and the world is at its
    /// last good frame. The request can be withdrawn.
    pub break_off: Arc<BreakOff>,
    /// The limit for the memory of all bodies together, estimated before they are built [bytes]; `None` if only the system sets a limit.
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

/// Bodies, obstacles and time in `D` dimensions.
pub struct World<const D: usize> {
    pub(crate) blueprint: Blueprint<D>,
    pub(crate) registry: Arc<Registry<D>>,
    pub(crate) options: Options,
    pub(crate) simd: Simd,
    /// The integrator of the scene; a body may have its own.
    pub(crate) integrator: Arc<dyn Integrator<D>>,
    pub(crate) colliders: Option<Arc<Colliders<D>>>,
    pub(crate) islands: Vec<Island<D>>,
    /// Bodies that may touch, and their contacts; `None` without `[contact]`.
    pub(crate) clusters: Option<Box<Clusters<D>>>,
    /// The state of contact that is kept from frame to frame.
    pub(crate) contact_memory: ContactMemory<D>,
    /// The contacts of the last frame; `None` if they are not reported.
    pub(crate) contacts: Option<Vec<Contact<D>>>,
    /// The number of islands built since the start.
    pub(crate) islands_built: u64,
    /// The island and the lane of every body.
    pub(crate) locations: Vec<(usize, usize)>,
    /// The slots of the list of bodies.
    pub(crate) slots: Slots,
    /// Commands of the scene, including commands that act as if the scene had contained them; then unfinished commands of the program.
    pub(crate) running: Vec<Running<D>>,
    /// The first command that could not begin in the last frame.
    pub(crate) refused: Option<Box<CommandBlueprint<D>>>,
    pub(crate) user_forces: Vec<(BodyHandle, Arc<ForceLaw<D>>)>,
    /// The number of force laws of each body in the last restored snapshot, which cannot contain the laws themselves.
    pub(crate) laws_saved: BTreeMap<usize, u64>,
    pub(crate) limited_pulls: Arc<AtomicU64>,
    pub(crate) flows: Flows,
    pub(crate) energy: Energy,
    pub(crate) momentum: Momentum<D>,
    /// The number of frames since the start.
    pub(crate) frames: u64,
    pub(crate) looks: Looks,
    pub(crate) stability: Vec<(String, Stability)>,
    pub(crate) warnings: Vec<Warning>,
    /// The parts of the blueprint that have changed since the start, with their values at the start.
    pub(crate) at_start: AtStart<D>,
    /// The cosine of the largest rotation of a cell under the law `linear` that was reported.
    pub(crate) farthest_turn: f64,
    /// The inputs of the program since the last request; `None` if they are not recorded.
    pub(crate) inputs: Option<Vec<Input<D>>>,
    /// The workspaces, one for each thread.
    pub(crate) workspaces: Vec<Mutex<Workspace<D>>>,
    pub(crate) pool: Option<rayon::ThreadPool>,
}

/// Locks a workspace. A workspace contains nothing between steps, so one that a panic has poisoned can still be used.
pub(crate) fn lock<const D: usize>(workspace: &Mutex<Workspace<D>>) -> MutexGuard<'_, Workspace<D>> {
    workspace.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<const D: usize> core::fmt::Debug for World<D> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("World").field("bodies", &self.blueprint.bodies.len()).field("frames", &self.frames).finish()
    }
}

impl<const D: usize> World<D> {
    pub(crate) fn stock_energy(&self) -> f64 {
        self.islands.iter().map(|i| i.survey.kinetic + i.stock.elastic + i.stock.gas + i.survey.gravity).sum()
    }

    pub(crate) fn refresh_ledger(&mut self) {
        let islands = self.islands.iter().map(|i| (&i.stock, &i.survey));
        (self.energy, self.momentum) = self.flows.ledger(self.h(), islands);
    }

    /// The simulated time at the present state [s].
    pub fn time(&self) -> f64 {
        self.looks.time.unwrap_or(self.frames as f64 * self.blueprint.time.frame)
    }
    /// The number of frames since the start.
    pub fn frames(&self) -> u64 {
        self.frames
    }
    /// The length h of a substep [s].
    pub fn h(&self) -> f64 {
        self.blueprint.time.frame / f64::from(self.blueprint.time.substeps)
    }
    /// The scene that the world was built from, with all changes since.
    pub fn blueprint(&self) -> &Blueprint<D> {
        &self.blueprint
    }
    /// The obstacles of the scene; `None` if it has no obstacles.
    pub fn colliders(&self) -> Option<&Colliders<D>> {
        self.colliders.as_deref()
    }
    /// The work of contact between bodies since the bodies were last grouped; `None` without contact.
    pub fn contact_counts(&self) -> Option<opruga_collide::Counts> {
        self.clusters.as_ref().map(|clusters| clusters.counts())
    }
    /// The vector instructions in use.
    pub fn simd(&self) -> Simd {
        self.simd
    }
    /// The number of threads in use.
    pub fn threads(&self) -> usize {
        self.options.threads
    }
}
