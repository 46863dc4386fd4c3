//! Memory for steps: lent to a system for a step, or kept by its integrator.

use crate::state::Columns;
use crate::tile::TILE;
use opruga_math::{Column, WIDTH};

/// Data that an integrator keeps between steps to save time; no result depends on them.
#[derive(Debug, Default)]
pub struct Cache(Option<Box<dyn core::any::Any + Send + Sync>>);

impl Cache {
    /// Takes the stored data out, or new data if there are none of this type.
    pub fn take<T: Default + Send + Sync + 'static>(&mut self) -> Box<T> {
        self.0.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }
    /// Puts the data back.
    pub fn put<T: Send + Sync + 'static>(&mut self, kept: Box<T>) {
        self.0 = Some(kept);
    }
}

/// Memory that is used only within a step: forces, stages of an integrator, the motion before obstacles act.
///
/// Systems that are stepped one after the other share one workspace, so that it stays in the cache.
#[derive(Debug)]
pub struct Workspace<const D: usize> {
    pub(crate) forces: [Column; D],
    pub(crate) before: [Column; D],
    pub(crate) velocity_before: [Column; D],
    pub(crate) stages: Vec<[Columns<D>; 2]>,
}

impl<const D: usize> Default for Workspace<D> {
    fn default() -> Self {
        Workspace {
            forces: core::array::from_fn(|_| Column::default()),
            before: core::array::from_fn(|_| Column::default()),
            velocity_before: core::array::from_fn(|_| Column::default()),
            stages: Vec::new(),
        }
    }
}

impl<const D: usize> Workspace<D> {
    pub(crate) fn grow(&mut self, buffers: usize, stages: usize, index_count: usize) {
        if self.forces[0].len() < buffers + WIDTH || self.before[0].is_empty() {
            self.forces.iter_mut().for_each(|column| column.grow(buffers + WIDTH));
            self.before.iter_mut().chain(&mut self.velocity_before).for_each(|column| column.grow(TILE + WIDTH));
        }
        if self.stages.len() < stages {
            self.stages.resize_with(stages, || [Columns::zeros(0), Columns::zeros(0)]);
        }
        for column in self.stages[..stages].iter_mut().flatten().flat_map(|columns| &mut columns.0) {
            if column.len() < index_count + WIDTH {
                column.grow(index_count + WIDTH);
            }
        }
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let stages = self.stages.iter().flatten().flat_map(|columns| &columns.0);
        self.forces.iter().chain(&self.before).chain(&self.velocity_before).chain(stages).map(Column::heap_bytes).sum()
    }
}
