//! Rebuilds the islands that a change of the scene affects; all others stay as they are.

use crate::blueprint::{Blueprint, BodyBlueprint};
use crate::build::{Builder, build_integrator};
use crate::carried::{BodyHistory, BodyState};
use crate::error::{Part, WorldError};
use crate::grouping::group;
use crate::island::Island;
use crate::world::World;
use opruga_math::WIDTH;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, PoisonError};

/// The bodies whose physics a change affects.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Touched {
    /// These bodies; an empty list means none.
    Bodies(Vec<usize>),
    /// All bodies, for a change of gravity or drag.
    All,
}

impl Touched {
    fn contains(&self, body: usize) -> bool {
        match self {
            Touched::Bodies(bodies) => bodies.contains(&body),
            Touched::All => true,
        }
    }
}

impl<const D: usize> World<D> {
    /// The state of a present body.
    pub(crate) fn state_of(&self, body: usize) -> BodyState<D> {
        let (island, lane) = self.locations[body];
        let system = &self.islands[island].system;
        let index = |node| system.layout.index(node, lane);
        let models = self.blueprint.bodies[body].models.len();
        BodyState {
            x: (0..system.nodes).map(|n| system.state.x.at(index(n))).collect(),
            v: (0..system.nodes).map(|n| system.state.v.at(index(n))).collect(),
            memory: system.members[..models]
                .iter()
                .map(|m| m.memory.iter().skip(lane).step_by(WIDTH).copied().collect())
                .collect(),
            history: BodyHistory::of(system, lane),
        }
    }

    /// Whether bodies of this kind may be stepped side by side.
    fn batches(&self, body: &BodyBlueprint<D>) -> bool {
        let kind = body.integrator.as_ref().unwrap_or(&self.blueprint.integrator).kind();
        // Unfolding displaces bodies one by one.
        let alone = !self.options.batches || self.blueprint.surroundings.unfold;
        !alone
            && self.registry.integrator(kind).is_none_or(|integrator| integrator.batches())
            && body.models.iter().all(|model| self.registry.model(model.kind()).is_none_or(|model| model.batches()))
    }

    /// Rebuilds the islands of some bodies after commands on them began or ended. The grouping of bodies in lanes does not change.
    ///
    /// On failure the old islands stay.
    pub(crate) fn rebuild(&mut self, bodies: &BTreeSet<usize>) -> Result<(), WorldError> {
        let there = bodies.iter().filter(|b| self.slots.is_there(**b));
        let numbers: BTreeSet<usize> = there.map(|b| self.locations[*b].0).collect();
        if numbers.is_empty() {
            return Ok(());
        }
        let before = self.stock_energy();
        let mut built = Vec::with_capacity(numbers.len());
        for number in &numbers {
            let members = &self.islands[*number].bodies;
            built.push((*number, self.island_of(members, &BTreeMap::new(), &self.integrator)?));
        }
        for (number, island) in built {
            self.put(number, island);
        }
        self.shift_start(before);
        Ok(())
    }

    /// Groups the bodies again after some were added, removed or changed. Builds the islands that are affected or that have other members than
    /// before. `fresh` contains the states of bodies that are not in an island yet.
    ///
    /// On failure the old islands stay.
    pub(crate) fn regroup(
        &mut self,
        touched: &Touched,
        fresh: &BTreeMap<usize, BodyState<D>>,
    ) -> Result<(), WorldError> {
        let before = self.stock_energy();
        let integrator: Arc<_> =
            build_integrator(&self.registry, &self.blueprint.integrator, || Part::Section { path: "integrator" })?
                .into();
        let groups = group(&self.blueprint.bodies, &self.slots, |body| self.batches(body));
        // For every group its old island, or a new one.
        let mut found: Vec<Result<usize, Box<Island<D>>>> = Vec::with_capacity(groups.len());
        for members in &groups {
            let old = self.locations.get(members[0]).map(|location| location.0).filter(|number| {
                self.islands.get(*number).is_some_and(|island| island.bodies == *members)
                    && members.iter().all(|b| !touched.contains(*b) && !fresh.contains_key(b))
            });
            found.push(match old {
                Some(number) => Ok(number),
                None => Err(Box::new(self.island_of(members, fresh, &integrator)?)),
            });
        }
        let mut old: Vec<Option<Island<D>>> = std::mem::take(&mut self.islands).into_iter().map(Some).collect();
        self.integrator = integrator;
        self.locations = vec![(0, 0); self.blueprint.bodies.len()];
        for (number, (members, island)) in groups.iter().zip(found).enumerate() {
            for (lane, body) in members.iter().enumerate() {
                self.locations[*body] = (number, lane);
            }
            match island {
                Ok(kept) => self.islands.extend(old[kept].take()),
                Err(island) => self.put(number, *island),
            }
        }
        let alive = &self.slots.alive;
        let is_other =
            |body: usize| touched.contains(body) || fresh.contains_key(&body) || alive.get(body) != Some(&true);
        self.contact_memory.forget(is_other);
        self.shift_start(before);
        Ok(())
    }

    /// Builds the island of some bodies in their present states, or in the states that `fresh` contains.
    pub(crate) fn island_of(
        &self,
        members: &[usize],
        fresh: &BTreeMap<usize, BodyState<D>>,
        integrator: &Arc<dyn opruga_core::integrator::Integrator<D>>,
    ) -> Result<Island<D>, WorldError> {
        let states: Vec<BodyState<D>> =
            members.iter().map(|b| fresh.get(b).cloned().unwrap_or_else(|| self.state_of(*b))).collect();
        self.builder(&self.blueprint, integrator).island(members, &states.iter().collect::<Vec<_>>(), self.time())
    }

    /// Puts a newly built island in its place, and adds the effects of active commands to it.
    fn put(&mut self, number: usize, mut island: Island<D>) {
        island.system.break_off = Arc::clone(&self.options.break_off);
        if number < self.islands.len() {
            self.islands[number] = island;
        } else {
            self.islands.push(island);
        }
        for workspace in &mut self.workspaces {
            workspace.get_mut().unwrap_or_else(PoisonError::into_inner).fit(&self.islands[number].system);
        }
        self.islands_built += 1;
        self.apply_running(number);
    }

    /// Records the energy that a change of the scene adds or removes as work of the user. The reference of the energy in motion changes by the same
    /// amount, so that the height of an added body does not count as motion.
    fn shift_start(&mut self, before: f64) {
        let change = self.stock_energy() - before;
        self.flows.start += change;
        self.flows.changed += change;
        self.refresh_ledger();
    }

    /// The names of the readings of a body that is not present yet.
    ///
    /// # Errors
    /// [`WorldError`] if a model refuses the body.
    pub fn reading_names(&self, body: &BodyBlueprint<D>) -> Result<Vec<Cow<'static, str>>, WorldError> {
        let mut island = self.island_alone(body)?;
        Ok(island.readings(0, self.time()).into_iter().map(|(name, _)| name).collect())
    }

    /// The pairs of nodes that springs of a body join, also for a body that is not present yet.
    ///
    /// # Errors
    /// [`WorldError`] if a model refuses the body.
    pub fn springs(&self, body: &BodyBlueprint<D>) -> Result<Vec<[u32; 2]>, WorldError> {
        let island = self.island_alone(body)?;
        Ok(island.system.members.iter().flat_map(|member| member.potential.bonds()).copied().collect())
    }

    fn builder<'a>(
        &'a self,
        blueprint: &'a Blueprint<D>,
        integrator: &'a Arc<dyn opruga_core::integrator::Integrator<D>>,
    ) -> Builder<'a, D> {
        let break_off = &*self.options.break_off;
        Builder { blueprint, registry: &self.registry, simd: self.simd, integrator, break_off }
    }

    /// An island with this body alone, as it would start now.
    fn island_alone(&self, body: &BodyBlueprint<D>) -> Result<Island<D>, WorldError> {
        let blueprint = self.blueprint.part(vec![body.clone()], Vec::new(), Vec::new());
        self.builder(&blueprint, &self.integrator).island(&[0], &[&crate::build::initial_state(body)], self.time())
    }
}
