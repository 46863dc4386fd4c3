//! A system: bodies that are stepped together, the models that act on them, and the obstacles that they meet.

use crate::contacts::Contacts;
use crate::error::StepError;
use crate::history::History;
use crate::inertia::Inertia;
use crate::ledger::StepWork;
use crate::pins::PinnedNodes;
use crate::potential::{Account, Potential, Properties};
use crate::state::{Columns, Layout, Parameter, View};
use crate::tile::{TILE, Tile, TilePlan};
use core::ops::Range;
use opruga_math::{Column, Lane, Pack, Simd, WIDTH};

pub use crate::ledger::{SolverWork, Work8};
pub use crate::pins::{Pin, along_path};
pub use crate::workspace::{Cache, Workspace};

/// The columns that hold the state in which forces are evaluated, or into which an update writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Positions and velocities of the system.
    Current,
    /// Work columns with this number.
    Work(usize),
}

/// Positions and velocities, and the stages of an integrator.
#[derive(Clone, Debug)]
pub struct State<const D: usize> {
    /// Positions x [m].
    pub x: Columns<D>,
    /// Velocities v [m/s].
    pub v: Columns<D>,
    /// Stages: pairs of columns for positions and velocities.
    pub work: Vec<[Columns<D>; 2]>,
}

/// The limits that the thesis uses against instability. The limits are off by default, and each use is counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stabilisers {
    /// The largest force on a node [N].
    pub largest_force: Option<f64>,
    /// The largest speed of a node [m/s].
    pub largest_velocity: Option<f64>,
}

/// How an integrator uses the forces of a tile: it reads the state, and writes positions and velocities.
pub trait Update<const D: usize> {
    /// The columns that are written.
    fn writes(&self) -> Stage;
    /// The time of the written state since the start of the step [s].
    fn time(&self) -> f64;
    /// Moves the nodes of a tile; `force[d][p - range.start]` [N] belongs to index p.
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], inverse_mass: &Parameter, state: &mut State<D>);
}

/// One model of a system and its data.
#[derive(Debug)]
pub struct Member<const D: usize> {
    /// The model, built for the bodies of the system.
    pub potential: Box<dyn Potential<D>>,
    /// The memory of the model from step to step; part of the state.
    pub memory: Vec<f64>,
    /// The results of `prepare`.
    pub scratch: Column,
    /// The account in which its power is recorded, if it has any power. The account is determined once and not for every tile.
    pub(crate) flows: Option<Account>,
    /// Whether it begins the forces of tiles.
    pub(crate) begins_tiles: bool,
}

/// Bodies that are stepped together: one, or up to eight identical ones side by side.
#[derive(Debug)]
pub struct System<const D: usize> {
    /// The vector instructions in use.
    pub simd: Simd,
    /// A request to break off a long step, which then ends with [`crate::error::StepError::BrokenOff`].
    pub break_off: std::sync::Arc<crate::break_off::BreakOff>,
    /// The number of threads over which the work on this system may be distributed; it then runs in a pool of threads. The number of threads does not
    /// change the bits.
    pub threads: usize,
    /// Whether the columns hold one body, or eight side by side.
    pub layout: Layout,
    /// The number of nodes of one body.
    pub nodes: usize,
    /// The number of bodies: 1 to 8.
    pub bodies: usize,
    /// The simulated time at the current state [s].
    pub time: f64,
    /// The positions, the velocities and the stages of the integrator.
    pub state: State<D>,
    /// Mass of each node [kg].
    pub mass: Parameter,
    /// 1 / mass [1/kg].
    pub inverse_mass: Parameter,
    /// The difference between a consistent mass matrix and the masses of the nodes; `None` if masses are lumped.
    pub inertia: Option<Inertia>,
    /// The masses of the shape functions [kg], ∫ρNₐ, which determine the weight of nodes if the mass matrix is consistent; `None`
    /// means `mass`.
    pub(crate) weighing: Option<Parameter>,
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// The models that act on the bodies.
    pub members: Vec<Member<D>>,
    /// Pinned nodes, by index.
    pub pins: Vec<Pin<D>>,
    /// The obstacles that the nodes may meet in this frame.
    pub contacts: Option<std::sync::Arc<dyn Contacts<D>>>,
    /// The forces of other bodies on nodes throughout the step, by index [N]; `None` if no body is touched. Implicit integrators include these forces
    /// in the balance; explicit ones ignore them.
    pub pushes: Option<Vec<(usize, [f64; D])>>,
    /// Whether integrators with a budget of iterations make exact steps, because their results do not agree with contact.
    pub exact: bool,
    /// The limits of the thesis.
    pub stabilisers: Stabilisers,
    /// The energy that entered and left the system, and the work of the solver.
    pub work: Work8,
    /// The channels that the integrator keeps from step to step.
    pub history: History<D>,
    /// Data that the integrator keeps between steps to save time; no result depends on them.
    pub cache: Cache,
    pub(crate) plan: TilePlan,
    /// The pinned nodes.
    pub(crate) pinned_nodes: PinnedNodes<D>,
    /// The work of damping and of loads in the present step, if it has several stages.
    pub(crate) step_work: [StepWork; 2],
    /// The number of pairs of columns that the integrator uses within a step.
    pub(crate) stages: usize,
    pub(crate) forces: [Column; D],
    pub(crate) before: [Column; D],
    pub(crate) velocity_before: [Column; D],
    pub(crate) slots: Column,
}

impl<const D: usize> System<D> {
    /// Makes a system of bodies at positions `x` with velocities `v`, both laid out in columns.
    pub fn new(
        simd: Simd,
        layout: Layout,
        nodes: usize,
        bodies: usize,
        x: Columns<D>,
        v: Columns<D>,
        mass: Parameter,
    ) -> Self {
        let index_count = layout.index_count(nodes);
        let inverse = Parameter::column(
            (0..index_count)
                .map(|p| if p < nodes * layout.stride() && mass.at(p) > 0.0 { 1.0 / mass.at(p) } else { 0.0 })
                .collect(),
        );
        let one_mass = Parameter::column((0..nodes * layout.stride()).map(|p| inverse.at(p)).collect());
        System {
            simd,
            break_off: Default::default(),
            threads: 1,
            layout,
            nodes,
            bodies,
            time: 0.0,
            state: State { x, v, work: Vec::new() },
            mass,
            inverse_mass: one_mass,
            inertia: None,
            weighing: None,
            gravity: [0.0; D],
            members: Vec::new(),
            pins: Vec::new(),
            contacts: None,
            pushes: None,
            exact: false,
            stabilisers: Stabilisers::default(),
            work: Work8::default(),
            history: History::default(),
            cache: Cache::default(),
            plan: TilePlan::new(index_count, std::iter::empty()),
            pinned_nodes: PinnedNodes::default(),
            step_work: Default::default(),
            stages: 0,
            forces: core::array::from_fn(|_| Column::default()),
            before: core::array::from_fn(|_| Column::default()),
            velocity_before: core::array::from_fn(|_| Column::default()),
            slots: Column::default(),
        }
    }
    /// Checks whether a long step may continue.
    ///
    /// # Errors
    /// [`StepError::BrokenOff`] if the step must end; its effects must then be undone.
    pub fn go_on(&self) -> Result<(), StepError> {
        match self.break_off.is_wanted() {
            true => Err(StepError::BrokenOff {}),
            false => Ok(()),
        }
    }
    /// The masses that determine the weight of the nodes [kg]: the masses of the nodes or, with a consistent mass matrix, ∫ρNₐ.
    pub fn weighing(&self) -> &Parameter {
        self.weighing.as_ref().unwrap_or(&self.mass)
    }
    /// Adds a model.
    pub fn add(&mut self, potential: Box<dyn Potential<D>>) {
        let coupled = potential.inertia();
        if !coupled.is_empty() {
            let before = self.inertia.take().unwrap_or_else(|| Inertia::new(self.nodes, Vec::new()));
            let inertia = before.with(coupled.to_vec());
            // Row sums, so that a body falls as a whole: M a = M 1 g.
            self.weighing = Some(Parameter::from_items(self.layout, self.nodes, |node, body| {
                let more: f64 = inertia.row(node).map(|(_, mass)| mass).sum();
                self.mass.at(self.layout.index(node, body)) + more
            }));
            self.inertia = Some(inertia);
        }
        let memory = potential.initial_memory();
        let Properties { account, views, scratch_len, begins_tiles, .. } = potential.properties();
        let scratch = Column::zeros(scratch_len);
        let flows = (views.damping || account == Account::User).then_some(account);
        self.members.push(Member { potential, memory, scratch, flows, begins_tiles });
    }
    /// Lays out tiles and buffers after the models, the pins or the integrator have changed.
    pub fn plan(&mut self, work_columns: usize) {
        let index_count = self.layout.index_count(self.nodes);
        let stride = self.layout.stride();
        let mut spans = Vec::new();
        let mut last = (usize::MAX, usize::MAX);
        // No node of a stencil may move before the force on the last node of the stencil is known, because this force depends
        // on all of its nodes.
        for member in self.members.iter().filter(|member| !member.potential.properties().forces_in_prepare) {
            member.potential.stencils(&mut |nodes| {
                let (a, b) = nodes.iter().fold((u32::MAX, 0), |(a, b), node| (a.min(*node), b.max(*node)));
                // Only stencils that span several tiles matter, and neighbouring stencils often span the same ones.
                let pair = (a as usize * stride, (b as usize + 1) * stride - 1);
                let tiles = (pair.0 / TILE, pair.1 / TILE);
                if tiles.0 != tiles.1 && tiles != last {
                    last = tiles;
                    spans.push(pair);
                }
            });
        }
        self.plan = TilePlan::new(index_count, spans.into_iter());
        self.stages = work_columns;
        self.pinned_nodes = PinnedNodes::of(&self.pins);
    }
    /// The number of indices.
    pub fn index_count(&self) -> usize {
        self.layout.index_count(self.nodes)
    }
    /// The state of a stage at a time.
    pub fn view(&self, stage: Stage, time: f64) -> View<'_, D> {
        view(&self.state, self.nodes, self.layout, stage, time, self.threads)
    }

    /// Ends a substep: updates the memory of models and the time.
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
    /// [`StepError`] if a model refuses the state.
    pub fn forces_of(&mut self, account: Account) -> Result<Columns<D>, StepError> {
        let mut out = Columns::zeros(self.index_count());
        self.ensure_workspace();
        self.prepare(Stage::Current, self.time)?;
        let view = view(&self.state, self.nodes, self.layout, Stage::Current, self.time, self.threads);
        for tile in 0..self.plan.len() {
            let (range, buffer) = (self.plan.range(tile), self.plan.buffer(tile));
            let mut force = self.forces.each_mut().map(|f| &mut f[buffer..buffer + range.len() + WIDTH]);
            force.iter_mut().for_each(|column| column.fill(0.0));
            for member in self.members.iter().filter(|member| member.potential.properties().account == account) {
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

    /// The force on every node in the current state [N], including gravity, in columns.
    ///
    /// # Errors
    /// [`StepError`] if a model refuses the state.
    pub fn forces(&mut self, velocities: bool) -> Result<Columns<D>, StepError> {
        let mut out = Columns::zeros(self.index_count());
        self.ensure_workspace();
        let saved = self.work;
        let rest = (!velocities)
            .then(|| std::mem::replace(&mut self.state.v, Columns::zeros(self.layout.index_count(self.nodes))));
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

/// The larger of two numbers; `b` if `a` is NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    a.larger(b)
}
