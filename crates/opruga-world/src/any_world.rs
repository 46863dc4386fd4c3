//! A world without a dimension in its type: stepping, commands, state, readings and columns.

use crate::any_scene::{AnyBody, AnyScene, three};
use crate::blueprint::Time;
use crate::error::WorldError;
use crate::inputs::Input;
use crate::ledger::Energy;
use crate::slots::BodyHandle;
use crate::world::{Warning, World};
use opruga_collide::Picture;
use opruga_core::potential::{Account, CellState, Reading};
use opruga_core::spec::{Value, Values};
use opruga_core::stability::Stability;
use opruga_core::system::SolverWork;
use opruga_math::Simd;

/// One number of every node of a body, as it lies in memory: nodes of eight alike bodies lie side by side.
#[derive(Clone, Copy, Debug)]
pub struct Strided<'w> {
    column: &'w [f64],
    stride: usize,
}

impl<'w> Strided<'w> {
    /// The numbers, in the order of the nodes.
    pub fn iter(self) -> impl ExactSizeIterator<Item = f64> + 'w {
        self.column.iter().step_by(self.stride).copied()
    }
    /// The number of nodes.
    pub fn len(self) -> usize {
        self.column.len().div_ceil(self.stride)
    }
    /// Whether there is no node.
    pub fn is_empty(self) -> bool {
        self.column.is_empty()
    }
    /// The number of a node; NaN where there is no such node.
    pub fn at(self, node: usize) -> f64 {
        self.column.get(node * self.stride).copied().unwrap_or(f64::NAN)
    }
    /// The numbers as one slice, where nothing lies between them.
    pub fn as_slice(self) -> Option<&'w [f64]> {
        (self.stride == 1).then_some(self.column)
    }
}

/// One vector of every node of a body: a view into the columns of the world, which copies nothing.
#[derive(Clone, Copy, Debug)]
pub struct Vectors<'w> {
    columns: [Strided<'w>; 3],
    dimension: usize,
}

impl<'w> Vectors<'w> {
    /// The number of nodes.
    pub fn len(self) -> usize {
        self.columns[0].len()
    }
    /// Whether there is no node, also where there is no such body.
    pub fn is_empty(self) -> bool {
        self.columns[0].is_empty()
    }
    /// The column of each coordinate: two or three.
    pub fn columns(&self) -> &[Strided<'w>] {
        &self.columns[..self.dimension]
    }
    /// The vector of a node, with 0 for z in the plane; NaN where there is no such node.
    pub fn at(self, node: usize) -> [f64; 3] {
        core::array::from_fn(|d| if d < self.dimension { self.columns[d].at(node) } else { 0.0 })
    }
    /// The vectors in the order of the nodes, with 0 for z in the plane.
    pub fn iter(self) -> impl ExactSizeIterator<Item = [f64; 3]> + 'w {
        (0..self.len()).map(move |node| self.at(node))
    }
}

/// A world in the plane or in space. Vectors have three numbers; in the plane z is 0.
///
/// [`AnyBlueprint::build`](crate::blueprint::AnyBlueprint::build) makes one of a scene, and every [`World`] is one. The methods of
/// [`World`] of the same names say more about each.
pub trait AnyWorld: core::fmt::Debug + Send {
    /// The scene, with all changes since.
    fn scene(&self) -> &dyn AnyScene;

    /// Bodies that commands of the scene will add, in the order of time.
    fn coming_bodies(&self) -> Vec<&dyn AnyBody>;

    /// Steps through one frame.
    ///
    /// # Errors
    /// [`WorldError`] names body, node and substep; the world is at its last good frame.
    fn frame(&mut self) -> Result<(), WorldError>;
    /// Looks whether the step is still stable where energy has come from nowhere.
    fn look_at_steps_again(&mut self) -> bool;
    /// Keeps the state after every so many substeps for [`AnyWorld::look_within`].
    fn keep_looks(&mut self, every: u32);
    /// Shows the world as it was within the last frame, look after look.
    fn look_within(&mut self, look: &mut dyn FnMut(&mut dyn AnyWorld));
    /// Frames since the start.
    fn frames(&self) -> u64;
    /// The time [s].
    fn time(&self) -> f64;
    /// The substep [s].
    fn h(&self) -> f64;
    /// The vector instructions in force.
    fn simd(&self) -> Simd;
    /// Threads in use.
    fn threads(&self) -> usize;

    /// Changes a parameter.
    ///
    /// # Errors
    /// As [`World::set`].
    fn set(&mut self, path: &str, value: Value) -> Result<(), WorldError>;
    /// Begins and ends what is due now without waiting for the coming frame.
    ///
    /// # Errors
    /// As [`World::begin_what_is_due`].
    fn begin_what_is_due(&mut self) -> Result<(), WorldError>;
    /// Leads the pointer of a drag.
    ///
    /// # Errors
    /// As [`World::lead`].
    fn lead(&mut self, number: usize, row: Vec<f64>) -> Result<(), WorldError>;
    /// Ends a command at a time [s].
    ///
    /// # Errors
    /// As [`World::finish`].
    fn finish(&mut self, number: usize, until: f64) -> Result<(), WorldError>;
    /// Takes a body away.
    ///
    /// # Errors
    /// As [`World::remove_body`].
    fn remove_body(&mut self, name: &str) -> Result<(), WorldError>;
    /// Writes down from now on what the program does, for [`AnyWorld::take_inputs`].
    fn keep_inputs(&mut self);
    /// What the program has done since the last call, each as its bytes or as the error of [`Input::to_bytes`].
    fn take_inputs(&mut self) -> Vec<Result<Vec<u8>, WorldError>>;
    /// Does again what [`AnyWorld::take_inputs`] has written.
    ///
    /// # Errors
    /// Those of the call that it stands for; the world stays as it was.
    fn repeat(&mut self, input: &[u8]) -> Result<(), WorldError>;

    /// The whole state in bytes.
    fn snapshot(&self) -> Vec<u8>;
    /// Appends the bytes of [`AnyWorld::snapshot`].
    fn snapshot_into(&self, out: &mut Vec<u8>);
    /// Goes to the state of a snapshot.
    ///
    /// # Errors
    /// As [`World::restore`].
    fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError>;
    /// Goes to the state of a snapshot of the same past.
    ///
    /// # Errors
    /// As [`World::rewind`].
    fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError>;
    /// The hash of all positions and velocities, node by node.
    fn state_hash(&self) -> u64;
    /// The quick hash of the same numbers.
    fn frame_hash(&self) -> u64;

    /// The energy ledger of the last frame.
    fn energy(&self) -> Energy;
    /// The linear and the angular momentum; in the plane the angular one has only its last number.
    fn momentum(&self) -> [[f64; 3]; 2];
    /// What models say of a body.
    fn readings(&mut self, body: usize) -> Vec<Reading>;
    /// The values of a probe.
    fn probe(&mut self, number: usize) -> Vec<(String, f64)>;
    /// The pressure of the gas that each node of a body bounds [Pa].
    fn node_pressures(&mut self, body: usize) -> Vec<(u32, f64)>;
    /// Stress and volume ratio of the cells of a body.
    fn cell_states(&self, body: usize) -> Vec<CellState>;
    /// Warnings so far, with counts.
    fn warnings(&self) -> Vec<Warning>;
    /// Warnings so far, and what is odd about the shapes in the present state.
    fn warnings_at_the_end(&self) -> Vec<Warning>;
    /// The kinds of integrators in use.
    fn integrators(&self) -> Vec<&'static str>;
    /// Whether every body is in statics, which knows no time.
    fn is_static(&self) -> bool;
    /// Whether an integrator with these parameters solves for the end of its steps; false where there is no such integrator.
    fn is_implicit(&self, integrator: &Values) -> bool;
    /// The estimates of the stable step.
    fn stability(&self) -> &[(String, Stability)];
    /// What implicit integrators did since the start.
    fn solver_work(&self) -> SolverWork;
    /// Whether the same bits come out on every processor.
    fn same_bits_everywhere(&self) -> bool;
    /// How many islands there are.
    fn islands(&self) -> usize;
    /// Bytes on the heap for the state and the models of all bodies.
    fn heap_bytes(&self) -> usize;

    /// Numbers of the bodies that are there.
    fn bodies(&self) -> Vec<usize>;
    /// The number of a body by its name.
    fn body(&self, name: &str) -> Option<usize>;
    /// A handle of a body.
    fn handle(&self, body: usize) -> Option<BodyHandle>;
    /// The number of nodes of a body; 0 where there is no such body.
    fn node_count(&self, body: usize) -> usize;
    /// The positions of the nodes of a body [m]; empty where there is no such body.
    fn positions(&self, body: usize) -> Vectors<'_>;
    /// The velocities of the nodes of a body [m/s]; empty where there is no such body.
    fn velocities(&self, body: usize) -> Vectors<'_>;
    /// The mass of a node [kg]; NaN where there is no such body or node.
    fn node_mass(&self, body: usize, node: u32) -> f64;
    /// The forces of the models of one account on the nodes of a body, or of all models [N]: computed by every call.
    fn forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; 3]>;
    /// Pulls that act at present: held point [m], pointer [m], force [N].
    fn pulls(&self) -> Vec<[[f64; 3]; 3]>;
    /// The obstacles at the present time, in the order of the scene.
    fn obstacles(&self) -> Vec<Picture<3>>;
    /// The pairs of nodes that springs of a body join; none where there is no such body, or a model refuses it. Numbers behind those
    /// of the scene stand for [`AnyWorld::coming_bodies`].
    fn springs_of(&self, body: usize) -> Option<Vec<[u32; 2]>>;
}

impl Time {
    /// How many whole frames it takes until the end.
    pub fn frames(&self) -> u64 {
        // Rounding apart; what is no number takes none.
        let frames = (self.seconds / self.frame - 1e-9).ceil();
        if frames > 0.0 { frames as u64 } else { 0 }
    }
}

const NOTHING: Strided<'static> = Strided { column: &[], stride: 1 };

impl<const D: usize> World<D> {
    /// The part of a column that belongs to a body.
    fn column_of<'w>(&self, body: usize, column: &'w [f64]) -> Strided<'w> {
        let Some((island, lane)) = self.island_of_body(body) else { return NOTHING };
        let (layout, nodes) = (island.system.layout, island.system.nodes);
        let Some(last) = nodes.checked_sub(1) else { return NOTHING };
        Strided { column: &column[layout.place(0, lane)..=layout.place(last, lane)], stride: layout.stride() }
    }

    fn vectors_of<'w>(&self, body: usize, columns: [&'w [f64]; D]) -> Vectors<'w> {
        let columns = core::array::from_fn(|d| columns.get(d).map_or(NOTHING, |column| self.column_of(body, column)));
        Vectors { columns, dimension: D }
    }
}

impl<const D: usize> AnyWorld for World<D> {
    fn scene(&self) -> &dyn AnyScene {
        self.blueprint()
    }
    fn coming_bodies(&self) -> Vec<&dyn AnyBody> {
        self.coming_bodies().map(|body| body as &dyn AnyBody).collect()
    }

    fn frame(&mut self) -> Result<(), WorldError> {
        self.frame()
    }
    fn look_at_steps_again(&mut self) -> bool {
        self.look_at_steps_again()
    }
    fn keep_looks(&mut self, every: u32) {
        self.keep_looks(every);
    }
    fn look_within(&mut self, look: &mut dyn FnMut(&mut dyn AnyWorld)) {
        self.look_within(|world| look(world));
    }
    fn frames(&self) -> u64 {
        self.frames()
    }
    fn time(&self) -> f64 {
        self.time()
    }
    fn h(&self) -> f64 {
        self.h()
    }
    fn simd(&self) -> Simd {
        self.simd()
    }
    fn threads(&self) -> usize {
        self.threads()
    }

    fn set(&mut self, path: &str, value: Value) -> Result<(), WorldError> {
        self.set(path, value)
    }
    fn begin_what_is_due(&mut self) -> Result<(), WorldError> {
        self.begin_what_is_due()
    }
    fn lead(&mut self, number: usize, row: Vec<f64>) -> Result<(), WorldError> {
        self.lead(number, row)
    }
    fn finish(&mut self, number: usize, until: f64) -> Result<(), WorldError> {
        self.finish(number, until)
    }
    fn remove_body(&mut self, name: &str) -> Result<(), WorldError> {
        self.remove_body(name)
    }
    fn keep_inputs(&mut self) {
        self.keep_inputs();
    }
    fn take_inputs(&mut self) -> Vec<Result<Vec<u8>, WorldError>> {
        self.take_inputs().iter().map(Input::to_bytes).collect()
    }
    fn repeat(&mut self, input: &[u8]) -> Result<(), WorldError> {
        self.repeat(&Input::from_bytes(input)?)
    }

    fn snapshot(&self) -> Vec<u8> {
        self.snapshot()
    }
    fn snapshot_into(&self, out: &mut Vec<u8>) {
        self.snapshot_into(out);
    }
    fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.restore(bytes)
    }
    fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.rewind(bytes)
    }
    fn state_hash(&self) -> u64 {
        self.state_hash()
    }
    fn frame_hash(&self) -> u64 {
        self.frame_hash()
    }

    fn energy(&self) -> Energy {
        self.energy()
    }
    fn momentum(&self) -> [[f64; 3]; 2] {
        let momentum = self.momentum();
        [three(momentum.linear.0), momentum.angular]
    }
    fn readings(&mut self, body: usize) -> Vec<Reading> {
        self.readings(body)
    }
    fn probe(&mut self, number: usize) -> Vec<(String, f64)> {
        self.probe(number)
    }
    fn node_pressures(&mut self, body: usize) -> Vec<(u32, f64)> {
        self.node_pressures(body)
    }
    fn cell_states(&self, body: usize) -> Vec<CellState> {
        self.cell_states(body)
    }
    fn warnings(&self) -> Vec<Warning> {
        self.warnings()
    }
    fn warnings_at_the_end(&self) -> Vec<Warning> {
        self.warnings_at_the_end()
    }
    fn integrators(&self) -> Vec<&'static str> {
        self.integrators()
    }
    fn is_static(&self) -> bool {
        self.is_static()
    }
    fn is_implicit(&self, integrator: &Values) -> bool {
        let built = self.registry.integrator(integrator.kind()).and_then(|kind| kind.build(integrator).ok());
        built.is_some_and(|integrator| integrator.needs().hessian)
    }
    fn stability(&self) -> &[(String, Stability)] {
        self.stability()
    }
    fn solver_work(&self) -> SolverWork {
        self.solver_work()
    }
    fn same_bits_everywhere(&self) -> bool {
        self.same_bits_everywhere()
    }
    fn islands(&self) -> usize {
        self.islands()
    }
    fn heap_bytes(&self) -> usize {
        self.heap_bytes()
    }

    fn bodies(&self) -> Vec<usize> {
        self.bodies().collect()
    }
    fn body(&self, name: &str) -> Option<usize> {
        self.body(name)
    }
    fn handle(&self, body: usize) -> Option<BodyHandle> {
        self.handle(body)
    }
    fn node_count(&self, body: usize) -> usize {
        self.node_count(body)
    }
    fn positions(&self, body: usize) -> Vectors<'_> {
        let Some((island, _)) = self.island_of_body(body) else { return self.vectors_of(body, [&[]; D]) };
        self.vectors_of(body, island.system.state.x.slices())
    }
    fn velocities(&self, body: usize) -> Vectors<'_> {
        let Some((island, _)) = self.island_of_body(body) else { return self.vectors_of(body, [&[]; D]) };
        self.vectors_of(body, island.system.state.v.slices())
    }
    fn node_mass(&self, body: usize, node: u32) -> f64 {
        self.node_mass(body, node)
    }
    fn forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; 3]> {
        self.node_forces(body, account).into_iter().map(three).collect()
    }
    fn pulls(&self) -> Vec<[[f64; 3]; 3]> {
        self.pulls().into_iter().map(|(point, pointer, force)| [point, pointer, force].map(three)).collect()
    }
    fn obstacles(&self) -> Vec<Picture<3>> {
        let pictures = self.colliders().map_or_else(Vec::new, |colliders| colliders.pictures(self.time()));
        pictures.into_iter().map(Picture::in_space).collect()
    }
    fn springs_of(&self, body: usize) -> Option<Vec<[u32; 2]>> {
        let mut bodies = self.blueprint().bodies.iter().chain(self.coming_bodies());
        self.springs(bodies.nth(body)?).ok()
    }
}
