//! Adds and removes bodies.

use crate::blueprint::{Action, BodyBlueprint};
use crate::changes::{Before, Source};
use crate::error::WorldError;
use crate::grouping::alike;
use crate::inputs::Input;
use crate::path_faults::PathFault;
use crate::rebuild::Touched;
use crate::running::Progress;
use crate::slots::Origin;
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_core::spec::Values;
use opruga_math::Lane;
use std::collections::BTreeMap;

/// The maximum number of warnings about commands that ended because their body was removed. Each warning names one body. The commands of all further
/// bodies are counted together.
const MOST_NAMED: usize = 16;

impl<const D: usize> World<D> {
    /// Adds a body; returns its number. After the removal of the body, the world keeps nothing of it, and another body that the program adds may get
    /// the same number. [`World::handle`] distinguishes these bodies.
    ///
    /// # Errors
    /// [`WorldError`] if the name of the body is taken, if a scene could not contain the body, or if a model refuses it; the world is then unchanged.
    pub fn add_body(&mut self, body: BodyBlueprint<D>) -> Result<usize, WorldError> {
        let name = body.name.clone();
        let number = self.include(body, Source::Program)?;
        self.write_down(|| Input::Add { name });
        Ok(number)
    }

    /// The slot that an added body takes.
    fn slot_for(&self, body: &BodyBlueprint<D>, source: Source) -> usize {
        let origins = || self.slots.origin.iter().enumerate().skip(self.slots.initial);
        let end = self.slots.len();
        match source {
            // Commands of the scene refer to bodies that other commands add by the numbers after those of the bodies at the start.
            Source::Command(_) => {
                origins().find(|(_, origin)| **origin == Origin::Reserved).map_or(end, |(slot, _)| slot)
            }
            Source::Program => {
                let free = |(slot, origin): (usize, &Origin)| match origin {
                    Origin::Free(like) => Some((slot, *like)),
                    _ => None,
                };
                // Prefer a seat in a batch of bodies of the same kind.
                let beside = |(_, like): &(usize, Option<usize>)| {
                    like.is_some_and(|other| alike(&self.blueprint.bodies[other], body))
                };
                let found = origins().filter_map(free).find(beside).or_else(|| origins().find_map(free));
                found.map_or(end, |(slot, _)| slot)
            }
        }
    }

    pub(crate) fn include(&mut self, body: BodyBlueprint<D>, source: Source) -> Result<usize, WorldError> {
        if self.body(&body.name).is_some() {
            return Err(WorldError::path(body.name, PathFault::Taken {}));
        }
        crate::validity::body(&body)?;
        crate::memory::check(std::slice::from_ref(&body), &*self.integrator, &self.registry, self.options.most_bytes)?;
        if source == Source::Program {
            // Slots of bodies that the scene will add stay reserved.
            let coming = self.blueprint.commands.iter().filter(|c| matches!(c.action, Action::Add(_))).count();
            if coming > 0 {
                self.reserve(self.slots.initial + coming - 1, Origin::Reserved);
            }
        }
        let number = self.slot_for(&body, source);
        let fresh = BTreeMap::from([(number, crate::build::initial_state(&body))]);
        let kept = self.slots.clone();
        let (origin, generation) = match source {
            Source::Command(command) => match self.running.get(command) {
                Some(running) if !running.given => (Origin::Command(command), running.generation),
                _ => (Origin::Program, self.slots.next_of_program()),
            },
            Source::Program => (Origin::Program, self.slots.next_of_program()),
        };
        self.slots.put(number, origin, generation);
        let before = if number == self.blueprint.bodies.len() {
            self.blueprint.bodies.push(body);
            None
        } else {
            Some(std::mem::replace(&mut self.blueprint.bodies[number], body))
        };
        let outcome = self.regroup(&Touched::Bodies(Vec::new()), &fresh).and_then(|()| self.check_stability());
        if let Err(error) = outcome {
            let next = self.slots.next;
            self.slots = kept;
            self.slots.next = next;
            match before {
                Some(nobody) => self.blueprint.bodies[number] = nobody,
                None => _ = self.blueprint.bodies.pop(),
            }
            self.regroup(&Touched::Bodies(Vec::new()), &BTreeMap::new())?;
            self.check_stability()?;
            return Err(error);
        }
        Ok(number)
    }

    /// Removes a body.
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no body of that name.
    pub fn remove_body(&mut self, name: &str) -> Result<(), WorldError> {
        self.remove_now(name)?;
        self.forget_commands();
        self.write_down(|| Input::Remove { name: name.to_string() });
        Ok(())
    }

    /// Removes a body on behalf of the program or of a command.
    pub(crate) fn remove_now(&mut self, name: &str) -> Result<(), WorldError> {
        let Some(body) = self.body(name) else {
            return Err(WorldError::path(name, PathFault::NoBody {}));
        };
        self.take_away(&[body])
    }

    /// Gives a body other models or another integrator. Positions and velocities stay the same. The memory of a model is kept by the first model of
    /// the same kind; a kind that the body did not have before starts as at the start of a scene.
    pub(crate) fn become_other(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<(), WorldError> {
        let was = self.state_of(body);
        let mut state = was.clone();
        let old: Vec<&str> = self.blueprint.bodies[body].models.iter().map(Values::kind).collect();
        if let Some(models) = &models {
            let kept = |values: &Values| old.iter().position(|kind| *kind == values.kind());
            let memory = std::mem::take(&mut state.memory);
            state.memory = models.iter().map(|m| kept(m).map_or_else(Vec::new, |k| memory[k].clone())).collect();
        }
        let before = self.exchange(body, models, integrator);
        let fresh = BTreeMap::from([(body, state)]);
        let touched = Touched::Bodies(vec![body]);
        let memory = self.contact_memory.clone();
        if let Err(error) = self.regroup(&touched, &fresh).and_then(|()| self.check_stability()) {
            self.undo(before);
            self.regroup(&touched, &BTreeMap::from([(body, was)]))?;
            self.check_stability()?;
            self.contact_memory = memory;
            return Err(error);
        }
        self.keep_start(before);
        Ok(())
    }

    /// Exchanges the models and integrator of a body in the blueprint only; returns the previous ones.
    pub(crate) fn exchange(
        &mut self,
        number: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Before<D> {
        let body = &mut self.blueprint.bodies[number];
        let before = Before::Body { number, models: body.models.clone(), integrator: body.integrator.clone() };
        body.models = models.unwrap_or_else(|| std::mem::take(&mut body.models));
        body.integrator = integrator.or_else(|| body.integrator.take());
        before
    }

    fn take_away(&mut self, bodies: &[usize]) -> Result<(), WorldError> {
        let kept = (self.slots.clone(), self.running.clone(), self.warnings.clone());
        for &body in bodies {
            self.slots.alive[body] = false;
            let mut dropped = 0;
            for running in self.running.iter_mut().filter(|r| r.command.action.body() == Some(body)) {
                dropped += u64::from(running.progress != Progress::Done);
                running.progress = Progress::Done;
            }
            if dropped > 0 {
                self.warn_of_ended_commands(body, dropped);
            }
        }
        let outcome = self.regroup(&Touched::Bodies(Vec::new()), &BTreeMap::new());
        match &outcome {
            Ok(()) => self.free_slots(),
            Err(_) => (self.slots, self.running, self.warnings) = kept,
        }
        outcome
    }

    fn warn_of_ended_commands(&mut self, body: usize, dropped: u64) {
        let ended = |w: &&Warning| w.code == "command.no_body";
        let warning = match self.warnings.iter().filter(ended).count() {
            ..MOST_NAMED => WorldWarning::CommandsEnded { body: self.blueprint.bodies[body].name.clone() },
            _ => WorldWarning::OtherCommandsEnded {},
        };
        let warning = Warning::new(warning, dropped);
        match self.warnings.iter_mut().find(|w| w.message == warning.message) {
            Some(known) => known.count += dropped,
            None => self.warnings.push(warning),
        }
    }

    /// Removes bodies that lie entirely beyond `world.largest_distance`.
    pub(crate) fn take_away_what_is_far(&mut self) -> Result<(), WorldError> {
        let Some(limit) = self.blueprint.surroundings.largest_distance else { return Ok(()) };
        let square = |x: [f64; D]| x.iter().map(|c| c * c).sum::<f64>();
        let mut gone = Vec::new();
        for island in &self.islands {
            // The corner of the box that is farthest from the origin. Usually even this corner is within the limit.
            let [low, high] = island.survey.position;
            let corner = core::array::from_fn(|d| low[d].abs().larger(high[d].abs()));
            if square(corner) <= limit * limit {
                continue;
            }
            let far = |body: &usize| {
                (0..self.node_count(*body) as u32).all(|node| square(self.position(*body, node)) > limit * limit)
            };
            gone.extend(island.bodies.iter().copied().filter(far));
        }
        if gone.is_empty() {
            return Ok(());
        }
        self.take_away(&gone)?;
        self.forget_commands();
        self.flows.lost_bodies += gone.len() as u64;
        Ok(())
    }

    /// Bodies that commands will add, in order of time.
    pub fn coming_bodies(&self) -> impl Iterator<Item = &BodyBlueprint<D>> {
        let present = &self.blueprint.bodies;
        self.blueprint.commands.iter().filter_map(move |command| match &command.action {
            Action::Add(body) if present.iter().all(|b| b.name != body.name) => Some(&**body),
            _ => None,
        })
    }
}

impl<const D: usize> World<D> {
    /// Creates a slot without a body if it does not exist.
    pub(crate) fn reserve(&mut self, slot: usize, origin: Origin) {
        while self.slots.len() <= slot {
            self.blueprint.bodies.push(BodyBlueprint::nobody());
            self.slots.put(self.slots.len(), origin, 0);
            if let Some(last) = self.slots.alive.last_mut() {
                *last = false;
            }
        }
    }

    /// Forgets removed bodies of the program and frees their slots; free slots at the end of the list are dropped.
    pub(crate) fn free_slots(&mut self) {
        for slot in self.slots.initial..self.slots.len() {
            if self.slots.alive[slot] || self.slots.origin[slot] != Origin::Program {
                continue;
            }
            let gone = &self.blueprint.bodies[slot];
            let like = |other: &usize| {
                *other != slot
                    && self.slots.origin[*other].is_taken()
                    && (self.slots.alive[*other] || self.slots.origin[*other] != Origin::Program)
                    && alike(gone, &self.blueprint.bodies[*other])
            };
            let beside = (0..self.slots.len()).find(like);
            for origin in &mut self.slots.origin {
                if *origin == Origin::Free(Some(slot)) {
                    *origin = Origin::Free(beside);
                }
            }
            self.slots.origin[slot] = Origin::Free(beside);
            self.blueprint.bodies[slot] = BodyBlueprint::nobody();
            self.at_start.bodies.remove(&slot);
            self.user_forces.retain(|(handle, _)| handle.index != slot);
            self.laws_saved.remove(&slot);
        }
        while matches!(self.slots.origin.last(), Some(Origin::Free(_))) {
            let count = self.slots.len() - 1;
            self.slots.truncate(count);
            self.blueprint.bodies.truncate(count);
            self.locations.truncate(count);
        }
    }
}
