//! Room that steps need: lent to a system for a step, or kept by its integrator.

use crate::state::Columns;
use crate::system::System;
use crate::tile::TILE;
use opruga_math::{Column, WIDTH};

/// Room that an integrator keeps for itself.
#[derive(Debug, Default)]
pub struct Room(Option<Box<dyn core::any::Any + Send + Sync>>);

impl Room {
    /// Takes what is kept out, or something new where nothing of the kind is there.
    pub fn take<T: Default + Send + Sync + 'static>(&mut self) -> Box<T> {
        self.0.take().and_then(|kept| kept.downcast().ok()).unwrap_or_default()
    }
    /// Puts it back.
    pub fn put<T: Send + Sync + 'static>(&mut self, kept: Box<T>) {
        self.0 = Some(kept);
    }
}

/// Room that is used within a step only: forces, stages of an integrator, the motion before obstacles act.
///
/// Systems that are stepped one after the other share one, so that it stays in the cache.
#[derive(Debug)]
pub struct Workspace<const D: usize> {
    forces: [Column; D],
    before: [Column; D],
    velocity_before: [Column; D],
    stages: Vec<[Columns<D>; 2]>,
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
    /// Makes room for the steps of a system.
    pub fn fit(&mut self, system: &System<D>) {
        self.make_room(system.plan.buffer_places(), system.stages, system.places());
    }
    fn make_room(&mut self, buffers: usize, stages: usize, places: usize) {
        if self.forces[0].len() < buffers + WIDTH || self.before[0].is_empty() {
            self.forces.iter_mut().for_each(|column| column.grow(buffers + WIDTH));
            self.before.iter_mut().chain(&mut self.velocity_before).for_each(|column| column.grow(TILE + WIDTH));
        }
        if self.stages.len() < stages {
            self.stages.resize_with(stages, || [Columns::zeros(0), Columns::zeros(0)]);
        }
        for column in self.stages[..stages].iter_mut().flatten().flat_map(|columns| &mut columns.0) {
            if column.len() < places + WIDTH {
                column.grow(places + WIDTH);
            }
        }
    }
    /// Bytes on the heap.
    pub fn heap_bytes(&self) -> usize {
        let stages = self.stages.iter().flatten().flat_map(|columns| &columns.0);
        self.forces.iter().chain(&self.before).chain(&self.velocity_before).chain(stages).map(Column::heap_bytes).sum()
    }
}

impl<const D: usize> System<D> {
    /// Takes a workspace for its own, or gives it back.
    pub fn exchange(&mut self, workspace: &mut Workspace<D>) {
        std::mem::swap(&mut self.forces, &mut workspace.forces);
        std::mem::swap(&mut self.before, &mut workspace.before);
        std::mem::swap(&mut self.velocity_before, &mut workspace.velocity_before);
        std::mem::swap(&mut self.state.work, &mut workspace.stages);
    }
    /// Makes room for a step where nobody has lent any.
    pub(crate) fn make_room(&mut self) {
        let (buffers, stages, places) = (self.plan.buffer_places(), self.stages, self.places());
        let own = self.state.work.iter().take(stages).flatten().all(|c| c.0[0].len() >= places + WIDTH);
        if self.forces[0].len() < buffers + WIDTH || self.state.work.len() < stages || !own {
            let mut workspace = Workspace::default();
            self.exchange(&mut workspace);
            workspace.make_room(buffers, stages, places);
            self.exchange(&mut workspace);
        }
    }
}
