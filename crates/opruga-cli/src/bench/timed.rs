//! Models that measure the time that integrators spend in them: each replaces the model that it wraps in the registry.

use super::processor_time;
use opruga::core::error::{BuildError, StepError};
use opruga::core::potential::{
    CellState, Count, Definiteness, Ingredients, Model, Observe, Potential, Properties, Reading, Sink, Views,
};
use opruga::core::spec::Spec;
use opruga::core::state::View;
use opruga::core::tile::Tile;
use opruga::math::message::AnyMessage;
use opruga::math::{Simd, WIDTH};
use opruga::{Registries, Registry};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Time spent in models [ns].
#[derive(Debug, Default)]
pub(crate) struct Spent {
    /// Forces and energies.
    pub(crate) forces: AtomicU64,
    /// The time of second derivatives and of their addition to the matrix.
    pub(crate) matrices: AtomicU64,
}

impl Spent {
    /// The times of forces and of matrices [ms].
    pub(crate) fn milliseconds(&self) -> [f64; 2] {
        [&self.forces, &self.matrices].map(|time| time.load(Ordering::Relaxed) as f64 * 1e-6)
    }
}

fn count<T>(to: &AtomicU64, work: impl FnOnce() -> T) -> T {
    let start = processor_time();
    let out = work();
    to.fetch_add(((processor_time() - start) * 1e9) as u64, Ordering::Relaxed);
    out
}

/// Registries with timed models. Everything else is unchanged.
pub(crate) fn registries(library: &Registries, spent: &Arc<Spent>) -> Registries {
    fn timed<const D: usize>(library: &Arc<Registry<D>>, spent: &Arc<Spent>) -> Arc<Registry<D>> {
        let mut out = Registry::clone(library);
        for spec in library.models() {
            out.add_model(Box::new(TimedModel { library: Arc::clone(library), spec, spent: Arc::clone(spent) }));
        }
        Arc::new(out)
    }
    Registries { plane: timed(&library.plane, spent), space: timed(&library.space, spent) }
}

struct TimedModel<const D: usize> {
    library: Arc<Registry<D>>,
    spec: &'static Spec,
    spent: Arc<Spent>,
}

impl<const D: usize> Model<D> for TimedModel<D> {
    fn spec(&self) -> &'static Spec {
        self.spec
    }
    fn views(&self) -> Views {
        self.library.model(self.spec.kind).map_or(Views::default(), |model| model.views())
    }
    fn batches(&self) -> bool {
        self.library.model(self.spec.kind).is_some_and(|model| model.batches())
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        let Some(model) = self.library.model(self.spec.kind) else {
            return Err(BuildError::new(self.spec.kind, "scene.unknown_name", "the library lacks it"));
        };
        let inner = model.build(ingredients)?;
        Ok(Box::new(Timed { inner, spent: Arc::clone(&self.spent) }))
    }
}

#[derive(Debug)]
struct Timed<const D: usize> {
    inner: Box<dyn Potential<D>>,
    spent: Arc<Spent>,
}

impl<const D: usize> Potential<D> for Timed<D> {
    fn properties(&self) -> Properties {
        self.inner.properties()
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.inner.stencils(visit);
    }
    fn inertia(&self) -> &[(u32, u32, f64)] {
        self.inner.inertia()
    }
    fn initial_memory(&self) -> Vec<f64> {
        self.inner.initial_memory()
    }
    fn prepare(&self, simd: Simd, view: &View<D>, memory: &[f64], scratch: &mut [f64]) -> Result<(), StepError> {
        count(&self.spent.forces, || self.inner.prepare(simd, view, memory, scratch))
    }
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        count(&self.spent.forces, || self.inner.add_force(simd, view, scratch, tile));
    }
    fn remember(&self, simd: Simd, view: &View<D>, h: f64, scratch: &mut [f64], memory: &mut [f64]) -> [f64; WIDTH] {
        self.inner.remember(simd, view, h, scratch, memory)
    }
    fn energy(&self, simd: Simd, view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        count(&self.spent.forces, || self.inner.energy(simd, view, scratch))
    }
    fn energy_parts(&self) -> f64 {
        self.inner.energy_parts()
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        count(&self.spent.matrices, || self.inner.hessian(view, scratch, keep, sink));
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        count(&self.spent.matrices, || self.inner.damping_matrix(view, scratch, sink));
    }
}

impl<const D: usize> Observe<D> for Timed<D> {
    fn lacks(&self) -> Option<AnyMessage> {
        self.inner.lacks()
    }
    fn bonds(&self) -> &[[u32; 2]] {
        self.inner.bonds()
    }
    fn readings(&self, view: &View<D>, scratch: &[f64], memory: &[f64], body: usize) -> Vec<Reading> {
        self.inner.readings(view, scratch, memory, body)
    }
    fn node_pressures(&self, view: &View<D>, scratch: &[f64], body: usize) -> Vec<(u32, f64)> {
        self.inner.node_pressures(view, scratch, body)
    }
    fn cell_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        self.inner.cell_states(view, body)
    }
    fn facet_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        self.inner.facet_states(view, body)
    }
    fn counts(&self, memory: &[f64]) -> Vec<Count> {
        self.inner.counts(memory)
    }
    fn shape_counts(&self, view: &View<D>) -> Vec<Count> {
        self.inner.shape_counts(view)
    }
    fn heap_bytes(&self) -> usize {
        self.inner.heap_bytes()
    }
}
