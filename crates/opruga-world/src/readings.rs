//! Readings of a world: positions, energies, volumes, probes, warnings, hash.

use crate::blueprint::Recorded;
use crate::build::rest_volume;
use crate::island::Island;
use crate::ledger::{Energy, Momentum};
use crate::slots::BodyHandle;
use crate::warnings::{Difference, ErrorHint, Warning, WorldWarning, WorstCell};
use crate::world::{World, lock};
use opruga_core::potential::{CellState, Count, Potential, Reading};
use opruga_core::stability::Stability;
use opruga_core::state::View;
use opruga_core::system::{Member, SolverWork, Stage, System};

impl<const D: usize> World<D> {
    /// The energy ledger of the last frame.
    pub fn energy(&self) -> Energy {
        self.energy
    }
    /// Whether every body uses statics, which has no time.
    pub fn is_static(&self) -> bool {
        !self.islands.is_empty() && self.islands.iter().all(|island| island.integrator.is_static())
    }
    /// The kinds of integrators in use: first the integrator of the scene, then those of individual bodies.
    pub fn integrators(&self) -> Vec<&'static str> {
        let mut out = Vec::new();
        let bodies: Vec<_> = self.bodies().map(|b| &self.blueprint.bodies[b].integrator).collect();
        if bodies.is_empty() || bodies.iter().any(|own| own.is_none()) {
            out.push(self.blueprint.integrator.kind());
        }
        for values in bodies.into_iter().flatten() {
            if !out.contains(&values.kind()) {
                out.push(values.kind());
            }
        }
        out
    }
    /// The work of implicit integrators since the start: iterations, products, and the largest residual.
    pub fn solver_work(&self) -> SolverWork {
        self.flows.solver
    }
    /// Whether the results have the same bits on every processor, rather than only within one class of processors.
    pub fn same_bits_everywhere(&self) -> bool {
        self.islands.iter().all(|island| {
            let mut members = island.system.members.iter();
            members.all(|member| member.potential.same_bits_everywhere())
                && island.integrator.same_bits_everywhere(&island.system)
        })
    }
    /// The number of islands, each of which contains bodies that are stepped together.
    pub fn islands(&self) -> usize {
        self.islands.len()
    }
    /// The number of islands built since the start. A command rebuilds only the islands of its bodies.
    pub fn islands_built(&self) -> u64 {
        self.islands_built
    }
    /// The momentum of the last frame.
    pub fn momentum(&self) -> Momentum<D> {
        self.momentum
    }
    /// The estimates of the stable step, one for each kind of body.
    pub fn stability(&self) -> &[(String, Stability)] {
        &self.stability
    }
    /// The numbers of the present bodies.
    pub fn bodies(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.slots.len()).filter(|body| self.slots.alive[*body])
    }
    /// The number of a body by its name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies().find(|b| self.blueprint.bodies[*b].name == name)
    }
    /// A handle to a body. A handle becomes stale when its body is removed, because the number of this body may be given to another body that the
    /// program adds.
    pub fn handle(&self, body: usize) -> Option<BodyHandle> {
        self.slots.handle(body)
    }
    /// The island of a present body, and its lane in it.
    pub(crate) fn island_of_body(&self, body: usize) -> Option<(&Island<D>, usize)> {
        let (island, lane) = *self.locations.get(body).filter(|_| self.slots.is_there(body))?;
        Some((self.islands.get(island)?, lane))
    }
    /// The system of a present body, and the index of one of its nodes in the columns.
    fn index_of(&self, body: usize, node: u32) -> Option<(&System<D>, usize)> {
        let (island, lane) = self.island_of_body(body)?;
        let system = &island.system;
        ((node as usize) < system.nodes).then(|| (system, system.layout.index(node as usize, lane)))
    }
    /// The number of nodes of a body; 0 if there is no such body.
    pub fn node_count(&self, body: usize) -> usize {
        self.island_of_body(body).map_or(0, |(island, _)| island.system.nodes)
    }
    /// The position of a node [m]; NaN if there is no such body or node. [`World::view`] distinguishes these cases.
    pub fn position(&self, body: usize, node: u32) -> [f64; D] {
        self.index_of(body, node).map_or([f64::NAN; D], |(system, index)| system.state.x.at(index))
    }
    /// The velocity of a node [m/s]; NaN if there is no such body or node.
    pub fn velocity(&self, body: usize, node: u32) -> [f64; D] {
        self.index_of(body, node).map_or([f64::NAN; D], |(system, index)| system.state.v.at(index))
    }
    /// The mass of a node [kg]; NaN if there is no such body or node.
    pub fn node_mass(&self, body: usize, node: u32) -> f64 {
        self.index_of(body, node).map_or(f64::NAN, |(system, index)| system.mass.at(index))
    }
    /// The readings of the models of a body: `volume`, `pressure`, `chamber1.pressure` and others.
    ///
    /// Empty if there is no such body.
    pub fn readings(&mut self, body: usize) -> Vec<Reading> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.locations[body];
        let time = self.time();
        self.islands[island].readings(lane, time)
    }
    /// The pressure [Pa] of the gas at every node that borders a chamber of a body, chamber by chamber; empty if there is no gas.
    pub fn node_pressures(&mut self, body: usize) -> Vec<(u32, f64)> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.locations[body];
        let time = self.time();
        self.islands[island].node_pressures(lane, time)
    }
    /// Stress and volume ratio of the cells of a body, in the order of its cells.
    ///
    /// Empty if there is no such body or if none of its models has cells.
    pub fn cell_states(&self, body: usize) -> Vec<CellState> {
        self.states_by(body, |potential, view, lane| potential.cell_states(view, lane))
    }
    /// Stress and volume ratio of the facets of a body, in the order of its facets.
    ///
    /// Empty if there is no such body or if none of its models describes its boundary alone.
    pub fn facet_states(&self, body: usize) -> Vec<CellState> {
        self.states_by(body, |potential, view, lane| potential.facet_states(view, lane))
    }
    fn states_by(
        &self,
        body: usize,
        ask: impl Fn(&dyn Potential<D>, &View<D>, usize) -> Vec<CellState>,
    ) -> Vec<CellState> {
        if self.handle(body).is_none() {
            return Vec::new();
        }
        let (island, lane) = self.locations[body];
        let system = &self.islands[island].system;
        let view = system.view(Stage::Current, self.time());
        let mut out: Vec<CellState> =
            system.members.iter().flat_map(|member| ask(&*member.potential, &view, lane)).collect();
        out.sort_by_key(|state| state.cell);
        out
    }
    /// The enclosed volume of a body at rest [m³] (area times thickness in 2D); NaN if there is no such body.
    pub fn rest_volume(&self, body: usize) -> f64 {
        if self.slots.is_there(body) { rest_volume(&self.blueprint.bodies[body]) } else { f64::NAN }
    }
    /// The present values of a probe: names of columns and numbers, which are NaN while its body does not exist. Empty if there is no probe of that
    /// number.
    pub fn probe(&mut self, number: usize) -> Vec<(String, f64)> {
        let Some(probe) = self.blueprint.probes.get(number).cloned() else { return Vec::new() };
        let there = self.handle(probe.body).is_some();
        let nodes = if there { self.selected(probe.body, &probe.select) } else { Vec::new() };
        let mut out = Vec::new();
        let of_cells = there && probe.record.iter().any(|what| what.is_of_cells());
        let cells = if of_cells { self.mean_of_cells(probe.body, &nodes) } else { None };
        for what in &probe.record {
            let columns = what.columns(D);
            let numbers: Vec<f64> = match what {
                _ if !there => Vec::new(),
                Recorded::Position => self.mean(&nodes, |w, n| w.position(probe.body, n)).to_vec(),
                Recorded::Velocity => self.mean(&nodes, |w, n| w.velocity(probe.body, n)).to_vec(),
                Recorded::Reaction => self.reaction(probe.body, &nodes).to_vec(),
                Recorded::Contact => self.contact_on(probe.body, &nodes).to_vec(),
                Recorded::Stress => cells.map_or(Vec::new(), |cells| cells.components(D)),
                Recorded::VolumeRatio => cells.map_or(Vec::new(), |cells| vec![cells.volume_ratio]),
            };
            let number = |k: usize| numbers.get(k).copied().unwrap_or(f64::NAN);
            out.extend(columns.iter().enumerate().map(|(k, column)| (format!("{}.{column}", probe.name), number(k))));
        }
        out
    }
    /// The sum of the forces of obstacles on some nodes [N].
    fn contact_on(&mut self, body: usize, nodes: &[u32]) -> [f64; D] {
        let forces = self.contact_forces(body);
        let mut sum = [0.0; D];
        for force in nodes.iter().filter_map(|node| forces.get(*node as usize)) {
            for d in 0..D {
                sum[d] += force[d];
            }
        }
        sum
    }
    fn mean(&self, nodes: &[u32], of: impl Fn(&Self, u32) -> [f64; D]) -> [f64; D] {
        let mut sum = [0.0; D];
        for node in nodes {
            let value = of(self, *node);
            for d in 0..D {
                sum[d] += value[d];
            }
        }
        sum.map(|s| s / nodes.len().max(1) as f64)
    }
    /// Warnings so far, with counts.
    pub fn warnings(&self) -> Vec<Warning> {
        let mut out = self.warnings.clone();
        let mut add = |warning: WorldWarning, count: u64| {
            if count > 0 {
                out.push(Warning::new(warning, count));
            }
        };
        add(WorldWarning::ForcesLimited {}, self.flows.limited_forces);
        add(WorldWarning::VelocitiesLimited {}, self.flows.limited_velocities);
        add(WorldWarning::PullsLimited {}, self.flows.limited_pulls);
        add(WorldWarning::BodiesLost {}, self.flows.lost_bodies);
        let by_rules = match self.energy.loss_numerical {
            made if made < 0.0 => WorldWarning::MadeByRules { energy: -made, help: self.against_growth() },
            energy => WorldWarning::TakenByRules { energy, help: self.against_damping() },
        };
        // A body that starts at rest has so little energy in motion in its first frames that any integrator dissipates a large part of it.
        add(by_rules, if self.energy.rules_prevail() { self.flows.damped_frames } else { 0 });
        let (energy, difference) = match self.energy.loss_integrator {
            lost if lost < 0.0 => (-lost, Difference::Gained),
            lost => (lost, Difference::Lost),
        };
        // Contact begins and ends within steps, so an integrator of higher order does not reduce this error.
        let every = |of: &dyn Fn(&Island<D>) -> bool| self.islands.iter().all(of);
        let help = if every(&|island| island.integrator.measures_its_damping()) {
            if self.is_in_real_time() { ErrorHint::RealTime } else { ErrorHint::Exact }
        } else if !self.has_lost_energy_in_contact() {
            ErrorHint::Explicit
        } else if every(&|island| island.integrator.makes_least_of_contact()) {
            ErrorHint::Contact
        } else {
            ErrorHint::ContactOfOthers
        };
        add(WorldWarning::Unexplained { energy, difference, help }, self.flows.open_frames);
        let solver = &self.flows.solver;
        add(WorldWarning::Accepted {}, solver.accepted);
        // A step is not halved more often than an integrator allows, so this does not overflow.
        let parts = 1u64 << solver.deepest.min(63);
        add(WorldWarning::Halved { h: self.h(), shortest: self.h() / parts as f64, parts }, solver.halved);
        add(WorldWarning::CutOff { left: solver.left, help: self.against_lack_of_budget() }, solver.cut_off);
        add(WorldWarning::Estimated { error_estimate: solver.error_estimate }, solver.estimated);
        add(WorldWarning::Conditioning { times: solver.conditioning }, solver.conditioned);
        add(WorldWarning::Disturbed {}, solver.disturbed);
        if solver.stayed_degenerate > 0 {
            add(WorldWarning::DegenerateRest { worst: self.worst_cell() }, solver.stayed_degenerate);
        }
        add(WorldWarning::NoForce {}, self.missing_laws());
        if let Some((unloaded, part, body)) = self.load_left() {
            add(WorldWarning::LoadLeft { body, part }, unloaded);
        }
        out.extend(self.counted(|_, member| member.potential.counts(&member.memory)));
        out
    }
    /// Warnings of models about the shapes of their bodies in the present state.
    pub(crate) fn shape_warnings(&self) -> Vec<Warning> {
        self.counted(|system, member| member.potential.shape_counts(&system.view(Stage::Current, system.time)))
    }
    /// The counts of all models, with counts of the same kind added up.
    fn counted(&self, of: impl Fn(&System<D>, &Member<D>) -> Vec<Count>) -> Vec<Warning> {
        let mut counts: Vec<Count> = Vec::new();
        for island in &self.islands {
            for new in island.system.members.iter().flat_map(|member| of(&island.system, member)) {
                match counts.iter_mut().find(|known| known.what == new.what) {
                    Some(known) => known.count += new.count,
                    None => counts.push(new),
                }
            }
        }
        counts.into_iter().filter(|new| new.count > 0).map(|new| Warning::new(new.what, new.count)).collect()
    }
    /// The number of force laws of the program that act on a body.
    pub(crate) fn laws_on(&self, body: usize) -> u64 {
        let own = |(handle, _): &&(BodyHandle, _)| handle.index == body && self.slots.is_of(*handle);
        self.user_forces.iter().filter(own).count() as u64
    }
    /// The number of force laws of the program that acted on bodies in the last restored snapshot, but do not act now.
    fn missing_laws(&self) -> u64 {
        let there = self.laws_saved.iter().filter(|(body, _)| self.slots.is_there(**body));
        there.map(|(body, saved)| saved.saturating_sub(self.laws_on(*body))).sum()
    }
    /// At the end of the run, the number of bodies in equilibrium under only a part of their load. Also the smallest of these parts, and the name of
    /// the body under this part.
    fn load_left(&self) -> Option<(u64, f64, String)> {
        let time = &self.blueprint.time;
        if self.frames == 0 || self.time() < time.seconds - 0.5 * time.frame {
            return None;
        }
        let (mut bodies, mut least): (u64, Option<(f64, usize)>) = (0, None);
        for island in &self.islands {
            let Some(part) = island.integrator.part_of_load(&island.system).filter(|part| *part < 1.0) else {
                continue;
            };
            bodies += 1;
            if least.is_none_or(|(other, _)| part < other) {
                least = Some((part, island.bodies[0]));
            }
        }
        least.map(|(part, body)| (bodies, part, self.blueprint.bodies[body].name.clone()))
    }
    /// The cell whose volume differs most from its volume at rest.
    fn worst_cell(&self) -> Option<WorstCell> {
        let mut worst: Option<(f64, WorstCell)> = None;
        for body in self.bodies() {
            for cell in self.cell_states(body) {
                let ratio = cell.smallest_volume_ratio;
                if worst.as_ref().is_none_or(|(most, _)| (ratio - 1.0).abs() > *most) {
                    let body = self.blueprint.bodies[body].name.clone();
                    worst = Some(((ratio - 1.0).abs(), WorstCell::Cell { cell: cell.cell, body, ratio }));
                }
            }
        }
        worst.map(|(_, cell)| cell)
    }
    /// A 64-bit hash (FNV-1a) over the little-endian bits of all positions, then velocities, body by body in node order.
    pub fn state_hash(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut feed = |number: f64| {
            for byte in number.to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        for velocities in [false, true] {
            for body in self.bodies() {
                for node in 0..self.node_count(body) as u32 {
                    let value = if velocities { self.velocity(body, node) } else { self.position(body, node) };
                    value.into_iter().for_each(&mut feed);
                }
            }
        }
        hash
    }
    /// Bytes on the heap for the state and the models of all bodies.
    pub fn heap_bytes(&self) -> usize {
        let shared: usize = self.workspaces.iter().map(|workspace| lock(workspace).heap_bytes()).sum();
        shared + self.islands.iter().map(Island::heap_bytes).sum::<usize>()
    }
}
