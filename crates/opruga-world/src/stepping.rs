//! Steps a world through a frame, and reverts a frame that fails.

use crate::clusters::Clusters;
use crate::contact_laws::is_barrier;
use crate::error::{Crossing, WorldError};
use crate::island::{FramePlan, Island};
use crate::scene_contact::{MadeFor, SceneContact};
use crate::together;
use crate::world::{World, lock};
use opruga_collide::Trouble;
use opruga_core::error::StepError;
use opruga_core::threads;
use rayon::prelude::*;
use std::sync::atomic::Ordering;

impl<const D: usize> World<D> {
    /// Steps through one frame.
    ///
    /// # Errors
    /// [`WorldError`] names the body, node and substep. The world is then at its last good frame.
    pub fn frame(&mut self) -> Result<(), WorldError> {
        self.begin_what_is_due()?;
        (self.looks.flows, self.looks.fresh) = (self.flows, false);
        self.find_clusters();
        self.refuse_what_meets()?;
        if let Err((trouble, time)) = self.step_islands() {
            self.restore_islands(|_| true);
            return Err(self.trouble(trouble, time));
        }
        if let Some(first) = self.islands.iter().position(|i| i.outcome.is_err()) {
            // All islands return to the same frame; the failed ones are already there.
            self.restore_islands(|island| island.outcome.is_ok());
            return Err(self.failure_of(first));
        }
        self.frames += 1;
        self.looks.fresh = true;
        self.take_contacts();
        self.sum_flows();
        if !(self.energy.is_finite() && self.momentum.is_finite()) {
            return Err(self.take_back_frame());
        }
        match &self.clusters {
            Some(clusters) => self.contact_memory.take(clusters),
            None => self.contact_memory.clear(),
        }
        let islands = &self.islands;
        let members = || islands.iter().flat_map(|island| &island.system.members);
        // Forces with an energy have symmetric derivatives.
        let has_energy =
            || members().map(|member| member.potential.properties().views).all(|v| v.symmetric || !v.hessian);
        self.flows.count_frame(&self.energy, has_energy);
        self.warn_of_crushed_bodies();
        self.warn_of_turned_cells();
        self.warn_of_mixed_contact();
        self.take_away_what_is_far()
    }

    /// Rebuilds the contact between bodies if islands or obstacles have changed since it was made.
    fn find_clusters(&mut self) {
        let (built, colliders) = (self.islands_built, self.colliders.clone());
        let made_for = MadeFor { built, islands: self.islands.len(), colliders };
        if self.clusters.as_ref().is_none_or(|clusters| !clusters.scene.is_for(&made_for)) {
            let scene = SceneContact::of(&self.blueprint, &self.islands, made_for, self.simd);
            self.clusters = scene.map(|scene| Box::new(Clusters::of(scene)));
        }
    }

    /// Steps all islands through the frame, on the available threads. Every island keeps its own outcome. The function itself returns only an error
    /// of bodies that touch, with its time [s].
    fn step_islands(&mut self) -> Result<(), (Trouble, f64)> {
        let plan = FramePlan {
            colliders: self.colliders.as_ref(),
            start: self.time(),
            substeps: self.blueprint.time.substeps,
            h: self.h(),
            look_every: self.looks.every,
            watched: self.blueprint.contact.is_some(),
            unfold: self.blueprint.surroundings.unfold.then_some(&self.blueprint.bodies[..]),
        };
        let islands = &mut self.islands;
        let workspaces = &mut self.workspaces;
        // A single small body has no work to share. Waking threads for it would take longer than its frame.
        let alone = |island: &[Island<D>]| matches!(island, [one] if !one.is_shared_by(self.options.threads, 1));
        let pool = self.pool.as_ref().filter(|_| !alone(islands));
        if let Some(clusters) = &mut self.clusters {
            let reported = self.contacts.is_some();
            let scene = (&self.blueprint, &self.contact_memory, reported);
            let mut go = |pooled| together::frame(clusters, scene, islands, &plan, workspaces, pooled);
            return match pool {
                None => go(false),
                Some(pool) => pool.install(|| go(true)),
            };
        }
        match pool {
            None => islands.iter_mut().for_each(|island| island.frame(&plan, &mut lock(&workspaces[0]))),
            Some(pool) => pool.install(|| {
                // Large bodies are stepped one after another, each on all threads; then the others, one per thread. A body that waits for its threads
                // must not be given another body that uses the same workspace.
                let (number, count) = (pool.current_num_threads(), islands.len());
                for island in islands.iter_mut().filter(|island| island.is_shared_by(number, count)) {
                    island.system.threads = number;
                    threads::together(number, || island.frame(&plan, &mut lock(&workspaces[0])));
                    island.system.threads = 1;
                }
                islands.par_iter_mut().filter(|island| !island.is_shared_by(number, count)).for_each(|island| {
                    let thread = rayon::current_thread_index().unwrap_or(0);
                    island.frame(&plan, &mut lock(&workspaces[thread]));
                });
            }),
        }
        Ok(())
    }

    /// Restores the last good frame of some islands. The flows of all islands since then are discarded.
    fn restore_islands(&mut self, is_ahead: impl Fn(&Island<D>) -> bool) {
        for island in &mut self.islands {
            if is_ahead(island) {
                island.restore();
                island.refresh();
            }
            island.work = Default::default();
        }
    }

    /// The reason why an island could not be stepped through a frame.
    fn failure_of(&self, island: usize) -> WorldError {
        let island = &self.islands[island];
        let body = |local: usize| self.blueprint.bodies[island.bodies[local]].name.clone();
        match &island.outcome {
            Err(StepError::Diverged { body: local, node, time, range }) => {
                let (body, last) = (body(*local), self.time());
                WorldError::Diverged { body, node: *node, time: *time, last, range: *range }
            }
            Err(StepError::BrokenOff {}) => WorldError::BrokenOff {},
            Err(cause @ StepError::NotConverged { .. }) => {
                WorldError::NotConverged { body: body(0), cause: Box::new(cause.clone()) }
            }
            Err(cause) => WorldError::Step { body: body(0), cause: Box::new(cause.clone()) },
            // This is not reached, because the island has failed.
            Ok(()) => WorldError::Overflow { last: self.time() },
        }
    }

    /// Adds the flows of the islands in the frame to the ledger.
    fn sum_flows(&mut self) {
        for island in &mut self.islands {
            let work = std::mem::take(&mut island.work);
            self.flows.add(&island.system, island.numerical_loss(&work), &work);
        }
        self.flows.limited_pulls = self.limited_pulls.load(Ordering::Relaxed);
        self.refresh_ledger();
    }

    /// Refuses surfaces that cross, because a barrier would keep them crossed.
    pub(crate) fn refuse_what_meets(&self) -> Result<(), WorldError> {
        if !self.blueprint.contact.as_ref().is_some_and(is_barrier) {
            return Ok(());
        }
        let crossed = self.crossed_surfaces();
        let Some(first) = crossed.first() else { return Ok(()) };
        let crossing = Crossing::of(first, |body| self.blueprint.bodies[body].name.clone());
        Err(WorldError::Cross { crossing, pairs: crossed.len(), time: self.time() })
    }

    /// The error for bodies that touch and could not be stepped through a frame.
    fn trouble(&self, trouble: Trouble, time: f64) -> WorldError {
        let scene = self.clusters.as_ref().map(|clusters| &clusters.scene);
        let name = |number: u32| scene.map_or(String::new(), |scene| scene.name_of(number, &self.blueprint));
        match trouble {
            Trouble::TooMany => {
                let most = scene.map_or(0, |scene| scene.most);
                WorldError::TooManyContacts { found: most + 1, most, last: self.time() }
            }
            Trouble::BrokenOff => WorldError::BrokenOff {},
            Trouble::Meet { mut bodies } => {
                bodies.sort_unstable();
                WorldError::Meet { first: name(bodies[0]), second: name(bodies[1]), time }
            }
            Trouble::LedThrough { mut bodies } => {
                // Obstacles have the highest numbers, so a body is named first.
                bodies.sort_unstable();
                let collider = scene.and_then(|scene| scene.collider(bodies[1]));
                if let Some(collider) = collider {
                    let kind = self.blueprint.colliders[collider].values.kind().into();
                    return WorldError::LedThroughObstacle { body: name(bodies[0]), collider, kind, time };
                }
                // The body that pins move is named first.
                let is_led = |number: &u32| {
                    let body = scene.and_then(|scene| scene.bodies.get(*number as usize));
                    let pins = body.map_or(&[][..], |body| &self.blueprint.bodies[*body].pins);
                    (pins.iter().any(|pin| !pin.motion.is_empty()), !pins.is_empty())
                };
                bodies.sort_by_key(|number| std::cmp::Reverse(is_led(number)));
                WorldError::LedThrough { first: name(bodies[0]), second: name(bodies[1]), time }
            }
        }
    }

    /// Reverts to the last good frame after a frame whose states are finite but whose sums are not.
    fn take_back_frame(&mut self) -> WorldError {
        self.restore_islands(|_| true);
        self.frames -= 1;
        (self.flows, self.looks.fresh) = (self.looks.flows, false);
        self.refresh_ledger();
        WorldError::Overflow { last: self.time() }
    }
}
