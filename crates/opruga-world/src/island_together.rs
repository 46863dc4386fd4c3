//! A frame of an island that is stepped together with others, substep by substep.

use crate::island::{FramePlan, Island, Saved};
use crate::ledger::take_stock;
use opruga_core::error::StepError;
use opruga_core::system::{Work8, Workspace};
use std::sync::Arc;

impl<const D: usize> Island<D> {
    /// Begins a frame that is stepped together with others.
    pub(crate) fn begin_together(&mut self, plan: &FramePlan<D>) {
        self.save(plan.start);
        self.potential_before = self.potential();
        self.system.work = Work8::default();
        // It is not known what the island will meet, so obstacles are always checked.
        self.system.contacts = plan.colliders.map(|colliders| Arc::clone(colliders).into_contacts());
        self.outcome = Ok(());
        self.begin_path(plan);
    }

    /// Whether the positions of its bodies have kept their digits so far in this frame.
    pub(crate) fn is_in_range(&self) -> bool {
        let within = |lane: usize| {
            let [low, high] = self.path.of(self.system.layout, lane);
            low.iter().chain(&high).all(|c| c.abs() <= self.range)
        };
        self.path.is_sound() && (0..self.bodies.len()).all(within)
    }

    /// Keeps the state at the start of a substep; [`Island::rewind`] restores it.
    pub(crate) fn mark(&mut self) {
        let time = self.system.time;
        match &mut self.substep_start {
            Some(kept) => kept.take(&mut self.system, time),
            None => self.substep_start = Some(Saved::of(&self.system, time)),
        }
    }

    /// Restores the state at the start of the substep.
    pub(crate) fn rewind(&mut self) {
        if let Some(kept) = self.substep_start.take() {
            kept.write_into(&mut self.system);
            self.system.work = kept.work;
            self.substep_start = Some(kept);
        }
    }

    /// Makes one substep with a borrowed workspace.
    pub(crate) fn step_together(&mut self, plan: &FramePlan<D>, substep: u32, workspace: &mut Workspace<D>) {
        self.system.exchange(workspace);
        self.outcome = self.system.go_on().and_then(|()| {
            self.set_out(plan, substep);
            self.integrator.step(&mut self.system, plan.h)
        });
        self.system.exchange(workspace);
        if let Err(error) = self.outcome.clone() {
            self.refuse(error);
        }
    }

    /// Begins a substep that is made jointly with others.
    pub(crate) fn begin_as_one(&mut self, plan: &FramePlan<D>, substep: u32) {
        self.outcome = Ok(());
        self.set_out(plan, substep);
    }

    /// Records that a substep made jointly with other islands has failed, and restores the state before this substep.
    pub(crate) fn refuse(&mut self, error: StepError) {
        self.outcome = Err(error);
        self.restore();
        self.system.work = Work8::default();
    }

    /// Keeps the state after a substep if a kept state is due.
    pub(crate) fn look_together(&mut self, plan: &FramePlan<D>, substep: u32) {
        let done = substep + 1;
        if plan.look_every > 0 && done.is_multiple_of(plan.look_every) && done < plan.substeps {
            self.keep_look((done / plan.look_every - 1) as usize);
        }
    }

    /// Ends a frame that is stepped together with others.
    pub(crate) fn end_together(&mut self, plan: &FramePlan<D>) {
        match self.surveyed(plan.start) {
            Ok(survey) => {
                self.survey = survey;
                self.system.time = plan.start + f64::from(plan.substeps) * plan.h;
                self.work = std::mem::take(&mut self.system.work);
                self.stock = take_stock(&mut self.system);
            }
            Err(error) => {
                self.outcome = Err(error);
                self.restore();
                self.system.work = Work8::default();
            }
        }
    }
}
