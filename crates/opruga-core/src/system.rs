//! A system: bodies that are stepped together, the models that act on them and what they collide with.

use crate::contacts::{Contacts, Moved};
use crate::error::StepError;
use crate::inertia::Inertia;
use crate::pins::Held;
use crate::potential::{Account, Potential};
use crate::state::{Columns, Layout, Parameter, View};
use crate::tile::{TILE, Tile, TilePlan, Weight};
use core::ops::Range;
use opruga_math::{Column, Lane, Pack, Simd, WIDTH, Work};

pub use crate::pins::{Pin, along_path};

/// Which columns hold the state in which forces are evaluated, or into which an update writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Positions and velocities of the system.
    Current,
    /// Work columns of that number.
    Work(usize),
}

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

/// Positions and velocities, and room for stages of an integrator.
#[derive(Clone, Debug)]
pub struct State<const D: usize> {
    /// Positions x [m].
    pub x: Columns<D>,
    /// Velocities v [m/s].
    pub v: Columns<D>,
    /// Stages: pairs of columns for positions and velocities.
    pub work: Vec<[Columns<D>; 2]>,
}

/// Limits of the thesis against instability, off by default; every use is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stabilisers {
    /// The largest force on a node [N].
    pub largest_force: Option<f64>,
    /// The largest speed of a node [m/s].
    pub largest_velocity: Option<f64>,
}

/// What went into and out of the energy since the ledger was last emptied [J]; eight partial sums each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work8 {
    /// Work of forces from outside, of moving obstacles and of pins.
    pub user: [f64; WIDTH],
    /// Energy given to the gas by ramps, heating and leaks.
    pub gas: [f64; WIDTH],
    /// Energy taken by damping.
    pub damping: [f64; WIDTH],
    /// Energy taken by friction.
    pub friction: [f64; WIDTH],
    /// Energy taken by impacts.
    pub contact: [f64; WIDTH],
    /// Energy given by obstacles that put nodes back on their surface.
    pub correction: [f64; WIDTH],
    /// How often a force was limited.
    pub limited_forces: u64,
    /// How often a velocity was limited.
    pub limited_velocities: u64,
    /// What implicit integrators did.
    pub solver: SolverWork,
}

/// What implicit integrators did since the ledger was last emptied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolverWork {
    /// Systems of equations that were solved, one a step.
    pub steps: u64,
    /// Iterations of Newton.
    pub iterations: u64,
    /// Iterations of the linear solver.
    pub linear_iterations: u64,
    /// The largest force out of balance on a node at the end of a step [N].
    pub residual: f64,
    /// Steps that were accepted though they had not converged.
    pub accepted: u64,
    /// Steps that were halved since they had not converged.
    pub halved: u64,
}

impl SolverWork {
    /// Adds what was done elsewhere or later.
    pub fn add(&mut self, other: &SolverWork) {
        self.steps += other.steps;
        self.iterations += other.iterations;
        self.linear_iterations += other.linear_iterations;
        self.residual = other.residual.larger(self.residual);
        self.accepted += other.accepted;
        self.halved += other.halved;
    }
}

/// What an integrator remembers from step to step; part of the state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History<const D: usize> {
    /// The name of the integrator whose it is.
    pub owner: &'static str,
    /// Columns of one vector per node.
    pub columns: Vec<Columns<D>>,
    /// Plain numbers, zero at the start.
    pub numbers: Vec<f64>,
}

/// What an integrator does with the forces of a tile: reads the state, writes positions and velocities.
pub trait Update<const D: usize> {
    /// Which columns are written.
    fn writes(&self) -> Stage;
    /// The time of the written state after the start of the step [s].
    fn time(&self) -> f64;
    /// Moves the nodes of a tile; `force[d][p - range.start]` [N] belongs to place p.
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>);
}

/// Room that is used within a step only: forces, stages of an integrator, positions before obstacles act.
///
/// Systems that are stepped one after the other share one, so that it stays in the cache.
#[derive(Debug)]
pub struct Workspace<const D: usize> {
    forces: [Column; D],
    before: [Column; D],
    stages: Vec<[Columns<D>; 2]>,
}

impl<const D: usize> Default for Workspace<D> {
    fn default() -> Self {
        Workspace {
            forces: core::array::from_fn(|_| Column::default()),
            before: core::array::from_fn(|_| Column::default()),
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
            self.before.iter_mut().for_each(|column| column.grow(TILE + WIDTH));
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
        self.forces.iter().chain(&self.before).chain(stages).map(Column::heap_bytes).sum()
    }
}

/// One model of a system and what it keeps.
#[derive(Debug)]
pub struct Member<const D: usize> {
    /// The model.
    pub potential: Box<dyn Potential<D>>,
    /// What it remembers from step to step; part of the state.
    pub memory: Vec<f64>,
    /// What `prepare` left behind.
    pub scratch: Column,
}

/// Bodies that are stepped together: one, or up to eight alike ones side by side.
#[derive(Debug)]
pub struct System<const D: usize> {
    /// The vector instructions in force.
    pub simd: Simd,
    /// Threads that the work on this system may be spread over; it then runs in a pool of them. They change no bits.
    pub threads: usize,
    /// One body or eight.
    pub layout: Layout,
    /// Nodes of one body.
    pub nodes: usize,
    /// Bodies: 1 to 8.
    pub bodies: usize,
    /// Time [s].
    pub time: f64,
    /// Positions, velocities, stages.
    pub state: State<D>,
    /// Mass of each node [kg].
    pub mass: Parameter,
    /// 1 / mass [1/kg].
    pub inverse_mass: Parameter,
    /// What a consistent mass matrix adds to the masses of the nodes; none: masses are lumped.
    pub inertia: Option<Inertia>,
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// The models.
    pub members: Vec<Member<D>>,
    /// Held nodes, by place.
    pub pins: Vec<Pin<D>>,
    /// What the nodes may collide with in this frame.
    pub contacts: Option<std::sync::Arc<dyn Contacts<D>>>,
    /// The thesis's limits.
    pub stabilisers: Stabilisers,
    /// Energy that went in and out.
    pub work: Work8,
    /// What the integrator remembers.
    pub history: History<D>,
    /// Room that an integrator keeps between steps; what it holds does not change results.
    pub room: Room,
    pub(crate) plan: TilePlan,
    /// What the pins hold.
    pub(crate) held: Held<D>,
    /// Pairs of columns that the integrator uses within a step.
    stages: usize,
    pub(crate) forces: [Column; D],
    before: [Column; D],
    pub(crate) slots: Column,
}

impl<const D: usize> System<D> {
    /// A system of bodies at positions `x` with velocities `v`, laid out in columns.
    pub fn new(
        simd: Simd,
        layout: Layout,
        nodes: usize,
        bodies: usize,
        x: Columns<D>,
        v: Columns<D>,
        mass: Parameter,
    ) -> Self {
        let places = layout.places(nodes);
        let inverse = Parameter::column(
            (0..places)
                .map(|p| if p < nodes * layout.stride() && mass.at(p) > 0.0 { 1.0 / mass.at(p) } else { 0.0 })
                .collect(),
        );
        let one_mass = Parameter::column((0..nodes * layout.stride()).map(|p| inverse.at(p)).collect());
        System {
            simd,
            threads: 1,
            layout,
            nodes,
            bodies,
            time: 0.0,
            state: State { x, v, work: Vec::new() },
            mass,
            inverse_mass: one_mass,
            inertia: None,
            gravity: [0.0; D],
            members: Vec::new(),
            pins: Vec::new(),
            contacts: None,
            stabilisers: Stabilisers::default(),
            work: Work8::default(),
            history: History::default(),
            room: Room::default(),
            plan: TilePlan::new(places, std::iter::empty()),
            held: Held::default(),
            stages: 0,
            forces: core::array::from_fn(|_| Column::default()),
            before: core::array::from_fn(|_| Column::default()),
            slots: Column::default(),
        }
    }
    /// Adds a model.
    pub fn add(&mut self, potential: Box<dyn Potential<D>>) {
        let coupled = potential.inertia();
        if !coupled.is_empty() {
            let before = self.inertia.take().unwrap_or_else(|| Inertia::new(self.nodes, Vec::new()));
            self.inertia = Some(before.with(coupled.to_vec()));
        }
        let memory = potential.initial_memory();
        let scratch = Column::zeros(potential.scratch_len());
        self.members.push(Member { potential, memory, scratch });
    }
    /// Lays out tiles and buffers after the models, the pins or the integrator changed.
    pub fn plan(&mut self, work_columns: usize) {
        let places = self.layout.places(self.nodes);
        let stride = self.layout.stride();
        let mut spans = Vec::new();
        let mut last = (usize::MAX, usize::MAX);
        for member in &self.members {
            member.potential.spans(&mut |a, b| {
                // Only pairs of different tiles matter; neighbours repeat.
                let pair = (a as usize * stride, (b as usize + 1) * stride - 1);
                let tiles = (pair.0 / TILE, pair.1 / TILE);
                if tiles.0 != tiles.1 && tiles != last {
                    last = tiles;
                    spans.push(pair);
                }
            });
        }
        self.plan = TilePlan::new(places, spans.into_iter());
        self.stages = work_columns;
        self.held = Held::of(&self.pins);
    }
    /// Lays out tiles and buffers for an integrator, and room for what it remembers; what it knows is kept if it fits.
    pub fn equip(&mut self, integrator: &dyn crate::integrator::Integrator<D>) {
        self.plan(integrator.work_columns());
        let size = integrator.history();
        let places = self.places();
        if self.history.owner != integrator.name() {
            self.history = History { owner: integrator.name(), ..History::default() };
        }
        self.history.columns.resize_with(size.columns, || Columns::zeros(places));
        self.history.numbers.resize(size.numbers, 0.0);
    }
    /// Takes a workspace for its own, or gives it back.
    pub fn exchange(&mut self, workspace: &mut Workspace<D>) {
        std::mem::swap(&mut self.forces, &mut workspace.forces);
        std::mem::swap(&mut self.before, &mut workspace.before);
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
    /// The number of places.
    pub fn places(&self) -> usize {
        self.layout.places(self.nodes)
    }
    /// The state of a stage at a time.
    pub fn view(&self, stage: Stage, time: f64) -> View<'_, D> {
        view(&self.state, self.nodes, self.layout, stage, time, self.threads)
    }

    /// Evaluates forces in one stage and moves every node by an update: gradient → update → collide, tile by tile.
    ///
    /// `weight` [s] is the share of this evaluation in the step's work integrals. `step` is the substep if the update
    /// ends it: then obstacles act.
    ///
    /// # Errors
    /// [`StepError`] where a model refuses the state.
    pub fn advance<U: Update<D>>(
        &mut self,
        evaluate: Stage,
        time: f64,
        weight: f64,
        step: Option<f64>,
        update: &U,
    ) -> Result<(), StepError> {
        let now = self.time + time;
        self.make_room();
        self.prepare(evaluate, now)?;
        if step.is_some() {
            self.take_held_motion(0..self.places());
        }
        for tile in 0..self.plan.len() {
            self.add_forces(evaluate, now, weight, tile);
            for k in 0..self.plan.released_after(tile).len() {
                let done = self.plan.released_after(tile)[k] as usize;
                self.update_tile(done, update);
                if let Some(h) = step {
                    self.collide(done, h);
                }
            }
        }
        if !self.pins.is_empty() {
            self.hold_pins(update.writes(), self.time + update.time());
        }
        if step.is_some() {
            self.give_held_motion(0..self.places());
        }
        Ok(())
    }

    /// Lets every model look at the body as a whole.
    pub(crate) fn prepare(&mut self, stage: Stage, time: f64) -> Result<(), StepError> {
        let view = view(&self.state, self.nodes, self.layout, stage, time, self.threads);
        for member in &mut self.members {
            member.potential.prepare(self.simd, &view, &member.memory, &mut member.scratch)?;
        }
        Ok(())
    }

    /// Adds up the forces of all models on the nodes of one tile.
    #[inline]
    pub(crate) fn add_forces(&mut self, stage: Stage, time: f64, weight: f64, tile: usize) {
        let view = view(&self.state, self.nodes, self.layout, stage, time, self.threads);
        let range = self.plan.range(tile);
        let buffer = self.plan.buffer(tile);
        let mut force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
        let mut heaviness = Some(Weight { mass: &self.mass, gravity: self.gravity });
        let mut power = [0.0; WIDTH];
        if !self.members.first().is_some_and(|m| m.potential.begins_tiles()) {
            let mut tile = Tile {
                range: range.clone(),
                force: force.each_mut().map(|f| &mut **f),
                power: &mut power,
                weight: heaviness.take(),
                slots: &mut self.slots,
            };
            tile.settle(self.simd);
        }
        for member in &self.members {
            let mut tile = Tile {
                range: range.clone(),
                force: force.each_mut().map(|f| &mut **f),
                power: &mut power,
                weight: heaviness.take(),
                slots: &mut self.slots,
            };
            member.potential.add_force(self.simd, &view, &member.scratch, &mut tile);
            let views = member.potential.views();
            if views.damping || member.potential.account() == Account::User {
                let account = match member.potential.account() {
                    Account::User => &mut self.work.user,
                    _ => &mut self.work.damping,
                };
                for l in 0..WIDTH {
                    account[l] += weight * power[l];
                    power[l] = 0.0;
                }
            }
        }
        // A pin balances the forces of the models, whatever the stabiliser leaves of them.
        let force_on = |d: usize, place: usize| force[d][place - range.start];
        self.held.add_work_against(&range, weight, force_on, view.v, &mut self.work.user);
        if let Some(limit) = self.stabilisers.largest_force {
            let is_node = |k: usize| is_node(self.layout, self.nodes, self.bodies, range.start + k);
            self.work.limited_forces += limit_lengths(&mut force, range.len(), limit, is_node);
        }
    }

    /// Lets the integrator move the nodes of a tile.
    #[inline]
    fn update_tile<U: Update<D>>(&mut self, tile: usize, update: &U) {
        let range = self.plan.range(tile);
        let buffer = self.plan.buffer(tile);
        if self.contacts.is_some() {
            for d in 0..D {
                self.before[d][..range.len()].copy_from_slice(&self.state.x.0[d][range.clone()]);
            }
        }
        let force = self.forces.each_ref().map(|f| &f[buffer..buffer + range.len() + WIDTH]);
        self.simd.run(Move { update, range, force, inverse_mass: &self.inverse_mass, state: &mut self.state });
    }

    /// Lets obstacles hold back the nodes of a tile.
    #[inline]
    fn collide(&mut self, tile: usize, h: f64) {
        let range = self.plan.range(tile);
        self.limit_velocities_of(range.clone());
        if self.contacts.is_none() {
            return;
        }
        // What an obstacle takes of the motion of a held node its pin gives back.
        self.give_held_motion(range.clone());
        self.resolve_contacts(tile, h);
        self.take_held_motion(range);
    }

    /// Shortens the velocities that are above the limit, of all nodes.
    pub(crate) fn limit_velocities(&mut self) {
        self.limit_velocities_of(0..self.places());
    }

    #[inline]
    fn limit_velocities_of(&mut self, range: Range<usize>) {
        if let Some(limit) = self.stabilisers.largest_velocity {
            let mut columns = self.state.v.0.each_mut().map(|c| &mut c[range.clone()]);
            let is_node = |k: usize| is_node(self.layout, self.nodes, self.bodies, range.start + k);
            self.work.limited_velocities += limit_lengths(&mut columns, range.len(), limit, is_node);
        }
    }

    fn resolve_contacts(&mut self, tile: usize, h: f64) {
        let Some(contacts) = &self.contacts else { return };
        let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
        contacts.resolve(
            self.simd,
            &mut Moved {
                range: range.clone(),
                places_used: self.nodes * self.layout.stride(),
                before: self.before.each_ref().map(|b| &**b),
                x: &mut self.state.x,
                v: &mut self.state.v,
                force: self.forces.each_ref().map(|f| &f[buffer..buffer + range.len() + WIDTH]),
                mass: &self.mass,
                layout: self.layout,
                time: self.time + h,
                h,
                loss_contact: &mut self.work.contact,
                loss_friction: &mut self.work.friction,
                work_colliders: &mut self.work.user,
                work_correction: &mut self.work.correction,
            },
        );
    }

    /// Ends a substep: models move their memory on, time passes.
    pub fn finish_step(&mut self, h: f64) {
        let now = self.time + h;
        let view = view(&self.state, self.nodes, self.layout, Stage::Current, now, self.threads);
        for member in &mut self.members {
            if !member.memory.is_empty() {
                let given = member.potential.remember(self.simd, &view, h, &mut member.scratch, &mut member.memory);
                for l in 0..WIDTH {
                    self.work.gas[l] += given[l];
                }
            }
        }
        self.time = now;
    }

    /// Bytes on the heap, without the workspace.
    pub fn heap_bytes(&self) -> usize {
        let columns = |c: &[Column; D]| c.iter().map(Column::heap_bytes).sum::<usize>();
        let state = columns(&self.state.x.0) + columns(&self.state.v.0);
        let models: usize = self
            .members
            .iter()
            .map(|m| m.potential.heap_bytes() + m.memory.capacity() * 8 + m.scratch.heap_bytes())
            .sum();
        let masses = self.mass.heap_bytes() + self.inverse_mass.heap_bytes();
        state + models + masses + self.inertia.as_ref().map_or(0, Inertia::heap_bytes)
    }

    /// The force of the models of one account on every node in the current state [N], laid out in columns.
    ///
    /// # Errors
    /// [`StepError`] where a model refuses the state.
    pub fn forces_of(&mut self, account: Account) -> Result<Columns<D>, StepError> {
        let mut out = Columns::zeros(self.places());
        self.make_room();
        self.prepare(Stage::Current, self.time)?;
        let view = view(&self.state, self.nodes, self.layout, Stage::Current, self.time, self.threads);
        for tile in 0..self.plan.len() {
            let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
            let mut force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
            force.iter_mut().for_each(|column| column.fill(0.0));
            for member in self.members.iter().filter(|member| member.potential.account() == account) {
                let mut tile = Tile {
                    range: range.clone(),
                    force: force.each_mut().map(|f| &mut **f),
                    power: &mut [0.0; WIDTH],
                    weight: None,
                    slots: &mut self.slots,
                };
                member.potential.add_force(self.simd, &view, &member.scratch, &mut tile);
            }
            for d in 0..D {
                out.0[d][range.clone()].copy_from_slice(&force[d][..range.len()]);
            }
        }
        Ok(out)
    }

    /// The force on every node in the current state [N], gravity included, laid out in columns.
    ///
    /// # Errors
    /// [`StepError`] where a model refuses the state.
    pub fn forces(&mut self, velocities: bool) -> Result<Columns<D>, StepError> {
        let mut out = Columns::zeros(self.places());
        self.make_room();
        let saved = self.work;
        let rest =
            (!velocities).then(|| std::mem::replace(&mut self.state.v, Columns::zeros(self.layout.places(self.nodes))));
        let outcome = self.prepare(Stage::Current, self.time);
        if outcome.is_ok() {
            for tile in 0..self.plan.len() {
                self.add_forces(Stage::Current, self.time, 0.0, tile);
                let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
                for d in 0..D {
                    out.0[d][range.clone()].copy_from_slice(&self.forces[d][buffer..buffer + range.len()]);
                }
            }
        }
        if let Some(v) = rest {
            self.state.v = v;
        }
        self.work = saved;
        outcome.map(|()| out)
    }
}

pub(crate) fn view<const D: usize>(
    state: &State<D>,
    nodes: usize,
    layout: Layout,
    stage: Stage,
    time: f64,
    threads: usize,
) -> View<'_, D> {
    let (x, v) = match stage {
        Stage::Current => (&state.x, &state.v),
        Stage::Work(k) => (&state.work[k][0], &state.work[k][1]),
    };
    View { x: x.slices(), v: v.slices(), nodes, layout, time, threads }
}

/// Hands a tile to the integrator.
struct Move<'a, U, const D: usize> {
    update: &'a U,
    range: Range<usize>,
    force: [&'a [f64]; D],
    inverse_mass: &'a Parameter,
    state: &'a mut State<D>,
}
impl<U: Update<D>, const D: usize> Work for Move<'_, U, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        self.update.tile::<P>(self.range, &self.force, self.inverse_mass, self.state);
    }
}

/// Whether a place holds a node of a body; the others fill packs up.
fn is_node(layout: Layout, nodes: usize, bodies: usize, place: usize) -> bool {
    match layout {
        Layout::Single => place < nodes,
        Layout::Batch => place % WIDTH < bodies && place / WIDTH < nodes,
    }
}

/// Shortens vectors longer than a limit; returns how many of them belong to nodes.
fn limit_lengths<const D: usize>(
    columns: &mut [&mut [f64]; D],
    count: usize,
    limit: f64,
    is_node: impl Fn(usize) -> bool,
) -> u64 {
    let mut acted = 0;
    for k in 0..count {
        let mut square = 0.0;
        for column in columns.iter() {
            square += column[k] * column[k];
        }
        if square > limit * limit {
            let factor = limit / square.sqrt();
            for column in columns.iter_mut() {
                column[k] *= factor;
            }
            acted += u64::from(is_node(k));
        }
    }
    acted
}

/// The larger of two numbers, `b` if `a` is not a number.
pub fn larger(a: f64, b: f64) -> f64 {
    a.larger(b)
}
