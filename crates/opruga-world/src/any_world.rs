//! A world without a dimension in its type: stepping, commands, state, readings and columns.

use crate::any_scene::{AnyBody, AnyScene, three};
use crate::blueprint::{AnyBlueprint, CommandBlueprint};
use crate::contact_report::Contact;
use crate::crossed::{Crossed, Overlap};
use crate::error::WorldError;
use crate::inputs::Input;
use crate::ledger::Energy;
use crate::modes::Mode;
use crate::node_columns::Vectors;
use crate::node_states::NodeState;
use crate::queries::SurfacePoint;
use crate::refused::RefusedCommand;
use crate::slots::BodyHandle;
use crate::warnings::Warning;
use crate::world::World;
use opruga_collide::Picture;
use opruga_core::potential::{Account, CellState, Reading};
use opruga_core::spec::{Role, Spec, Value, Values};
use opruga_core::stability::Stability;
use opruga_core::system::SolverWork;
use opruga_math::{Lane, Simd};
use std::borrow::Cow;

/// A world in the plane or in space. Vectors have three numbers, of which z is 0 in the plane.
///
/// [`AnyBlueprint::build`](crate::blueprint::AnyBlueprint::build) builds one from a scene. Every [`World`] implements this trait; its methods of the
/// same names are documented in more detail.
pub trait AnyWorld: core::fmt::Debug + Send {
    /// The scene, with all changes since the start.
    fn scene(&self) -> &dyn AnyScene;

    /// Bodies that commands of the scene will add, in order of time.
    fn coming_bodies(&self) -> Vec<&dyn AnyBody>;

    /// Steps through one frame.
    ///
    /// # Errors
    /// [`WorldError`] names the body, node and substep. The world is then at its last good frame.
    fn frame(&mut self) -> Result<(), WorldError>;
    /// If energy has appeared without a source, checks whether the step is still stable. Returns whether there was anything to check.
    fn look_at_steps_again(&mut self) -> bool;
    /// Keeps states for [`AnyWorld::look_within`], `every` substeps apart.
    fn keep_looks(&mut self, every: u32);
    /// Calls `look` with the world in each state that was kept within the last frame, one after another.
    fn look_within(&mut self, look: &mut dyn FnMut(&mut dyn AnyWorld));
    /// The number of frames since the start.
    fn frames(&self) -> u64;
    /// The simulated time at the present state [s].
    fn time(&self) -> f64;
    /// The length h of a substep [s].
    fn h(&self) -> f64;
    /// The vector instructions in use.
    fn simd(&self) -> Simd;
    /// The number of threads in use.
    fn threads(&self) -> usize;

    /// Changes a parameter.
    ///
    /// # Errors
    /// The errors of [`World::set`].
    fn set(&mut self, path: &str, value: Value) -> Result<(), WorldError>;
    /// Gives the world a command that begins now, as if the scene had contained it from the start; returns its number. In the plane, the z components
    /// of vectors, axes and rows are ignored.
    ///
    /// # Errors
    /// The errors of [`World::act`]; also if the command adds a body.
    fn act(&mut self, command: &CommandBlueprint<3>) -> Result<usize, WorldError>;
    /// Finds the last command of another scene that adds a body and has already begun, and gives this command to the world. Returns its number.
    ///
    /// # Errors
    /// The errors of [`World::act`]; also if the scene has no such command or has another dimension.
    fn act_of(&mut self, scene: &AnyBlueprint) -> Result<usize, WorldError>;
    /// Begins and ends the commands that are due now, without waiting for the next frame.
    ///
    /// # Errors
    /// The errors of [`World::begin_what_is_due`].
    fn begin_what_is_due(&mut self) -> Result<(), WorldError>;
    /// Extends the path of the pointer of a drag.
    ///
    /// # Errors
    /// The errors of [`World::lead`].
    fn lead(&mut self, number: usize, row: Vec<f64>) -> Result<(), WorldError>;
    /// Ends a command at a time [s].
    ///
    /// # Errors
    /// The errors of [`World::finish`].
    fn finish(&mut self, number: usize, until: f64) -> Result<(), WorldError>;
    /// The command that the last call of [`AnyWorld::frame`] refused, which is the cause of its error.
    fn refused_command(&self) -> Option<RefusedCommand<'_>>;
    /// Sets the position and the velocity of a node directly, without any force.
    ///
    /// # Errors
    /// The errors of [`World::set_node`].
    fn set_node(&mut self, body: usize, node: u32, position: [f64; 3], velocity: [f64; 3]) -> Result<(), WorldError>;
    /// Removes a body.
    ///
    /// # Errors
    /// The errors of [`World::remove_body`].
    fn remove_body(&mut self, name: &str) -> Result<(), WorldError>;
    /// Records the inputs of the program from now on, for [`AnyWorld::take_inputs`].
    fn keep_inputs(&mut self);
    /// The inputs of the program since the last call, each as its bytes or as the error of [`Input::to_bytes`].
    fn take_inputs(&mut self) -> Vec<Result<Vec<u8>, WorldError>>;
    /// Repeats an input that [`AnyWorld::take_inputs`] recorded.
    ///
    /// # Errors
    /// The errors of the original call; the world is then unchanged.
    fn repeat(&mut self, input: &[u8]) -> Result<(), WorldError>;

    /// The whole state as bytes.
    fn snapshot(&self) -> Vec<u8>;
    /// Appends the bytes of [`AnyWorld::snapshot`].
    fn snapshot_into(&self, out: &mut Vec<u8>);
    /// Restores the state of a snapshot.
    ///
    /// # Errors
    /// The errors of [`World::restore`].
    fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError>;
    /// Restores the state of a snapshot of a world that had the same commands up to that time.
    ///
    /// # Errors
    /// The errors of [`World::rewind`].
    fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError>;
    /// The hash of all positions and velocities, node by node.
    fn state_hash(&self) -> u64;
    /// A faster hash of all positions and velocities.
    fn frame_hash(&self) -> u64;

    /// The energy ledger of the last frame.
    fn energy(&self) -> Energy;
    /// The linear and the angular momentum. In the plane only the last number of the angular momentum is used.
    fn momentum(&self) -> [[f64; 3]; 2];
    /// The readings of the models of a body.
    fn readings(&mut self, body: usize) -> Vec<Reading>;
    /// The names of the readings of a body; empty if a model refuses the body. Numbers after the bodies of the scene refer to
    /// [`AnyWorld::coming_bodies`].
    fn reading_names_of(&self, body: usize) -> Vec<Cow<'static, str>>;
    /// The values of a probe.
    fn probe(&mut self, number: usize) -> Vec<(String, f64)>;
    /// The pressure [Pa] of the gas at every node that borders a chamber of a body.
    fn node_pressures(&mut self, body: usize) -> Vec<(u32, f64)>;
    /// Stress and volume ratio of the cells of a body.
    fn cell_states(&self, body: usize) -> Vec<CellState>;
    /// Visits the known states of the cells and facets of a body, with their nodes.
    fn visit_states(&self, body: usize, visit: &mut dyn FnMut(&CellState, &[u32]));
    /// The states of the nodes of a body: means over the cells or facets around each node.
    fn node_states(&self, body: usize) -> Vec<Option<NodeState>>;
    /// Warns once about bodies that pass through one another in a scene without contact. Call it after every frame.
    fn warn_of_missing_contact(&mut self);
    /// Surfaces that cross, and bodies that lie inside one another.
    fn crossed_surfaces(&self) -> Vec<Crossed>;
    /// Bodies with points inside another body.
    fn overlaps(&self) -> Vec<Overlap>;
    /// Turns the report of contacts on or off for the frames that follow.
    fn report_contacts(&mut self, report: bool);
    /// The contacts between bodies in the last frame, in ascending order of bodies.
    fn contacts(&self) -> Vec<Contact<3>>;
    /// The first point of a body that a ray hits, at most `reach` [m] from its origin. In the plane the third coordinates are ignored.
    ///
    /// # Errors
    /// The errors of [`World::cast_ray`].
    fn cast_ray(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        reach: f64,
    ) -> Result<Option<SurfacePoint<3>>, WorldError>;
    /// The point nearest to a given point on the surfaces of all bodies, at most `reach` [m] away.
    ///
    /// # Errors
    /// The errors of [`World::nearest_surface_point`].
    fn nearest_surface_point(&self, point: [f64; 3], reach: f64) -> Result<Option<SurfacePoint<3>>, WorldError>;
    /// The lowest natural modes of a body about its present state.
    ///
    /// # Errors
    /// The errors of [`World::modes`].
    fn modes(&self, body: usize, count: usize) -> Result<Vec<Mode<3>>, WorldError>;
    /// Warnings so far, with counts.
    fn warnings(&self) -> Vec<Warning>;
    /// The warnings so far, and warnings about the shapes of bodies in the present state.
    fn warnings_at_the_end(&self) -> Vec<Warning>;
    /// The kinds of integrators in use.
    fn integrators(&self) -> Vec<&'static str>;
    /// Whether every body uses statics, which has no time.
    fn is_static(&self) -> bool;
    /// Whether an integrator with these parameters is implicit; false if there is no such integrator.
    fn is_implicit(&self, integrator: &Values) -> bool;
    /// The first known integrator with the given role.
    fn integrator_with(&self, role: Role) -> Option<&'static Spec>;
    /// The step that would be stable for all bodies under another integrator [s]; `None` if there is no such step or integrator.
    fn stable_step_under(&self, integrator: &Values) -> Option<f64>;
    /// The estimates of the stable step.
    fn stability(&self) -> &[(String, Stability)];
    /// The work of the solvers of implicit integrators since the start: iterations, products, and the largest residual.
    fn solver_work(&self) -> SolverWork;
    /// Whether the results have the same bits on every processor.
    fn same_bits_everywhere(&self) -> bool;
    /// The number of islands.
    fn islands(&self) -> usize;
    /// Bytes on the heap for the state and models of all bodies.
    fn heap_bytes(&self) -> usize;

    /// The numbers of the present bodies.
    fn bodies(&self) -> Vec<usize>;
    /// The number of a body by its name.
    fn body(&self, name: &str) -> Option<usize>;
    /// A handle to a body.
    fn handle(&self, body: usize) -> Option<BodyHandle>;
    /// The number of nodes of a body; 0 if there is no such body.
    fn node_count(&self, body: usize) -> usize;
    /// The positions of the nodes of a body [m]; empty if there is no such body.
    fn positions(&self, body: usize) -> Vectors<'_>;
    /// The velocities of the nodes of a body [m/s]; empty if there is no such body.
    fn velocities(&self, body: usize) -> Vectors<'_>;
    /// The mass of a node [kg]; NaN if there is no such body or node.
    fn node_mass(&self, body: usize, node: u32) -> f64;
    /// The forces on the nodes of a body [N] from the models that belong to one account of the ledger, or from all models. Every call computes them.
    fn forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; 3]>;
    /// The contact forces on the nodes of a body [N], as [`World::contact_forces`] gives them. Every call computes them.
    fn contact_forces(&mut self, body: usize) -> Vec<[f64; 3]>;
    /// The nodes of a body that are pinned now.
    fn pinned_now(&self, body: usize) -> Vec<u32>;
    /// The default stiffness [N/m] and largest force [N] of a pull; `None` if there is no such body.
    fn usual_pull(&self, body: usize) -> Option<[f64; 2]>;
    /// Pulls that act now: grabbed point [m], pointer [m], force [N].
    fn pulls(&self) -> Vec<[[f64; 3]; 3]>;
    /// The obstacles at the present time, in scene order.
    fn obstacles(&self) -> Vec<Picture<3>>;
    /// The pairs of nodes that springs of a body join; `None` if there is no such body or if a model refuses it. Body numbers beyond the bodies of
    /// the scene refer to [`AnyWorld::coming_bodies`].
    fn springs_of(&self, body: usize) -> Option<Vec<[u32; 2]>>;
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
    fn act(&mut self, command: &CommandBlueprint<3>) -> Result<usize, WorldError> {
        self.act(command.cut()?)
    }
    fn act_of(&mut self, scene: &AnyBlueprint) -> Result<usize, WorldError> {
        let command = scene.addition_for(&self.registry, self.time())?;
        self.act(command)
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
    fn refused_command(&self) -> Option<RefusedCommand<'_>> {
        self.refused_command().map(|command| RefusedCommand::of(command, self.blueprint()))
    }
    fn set_node(&mut self, body: usize, node: u32, position: [f64; 3], velocity: [f64; 3]) -> Result<(), WorldError> {
        let [position, velocity] = [position, velocity].map(|vector| core::array::from_fn(|d| vector[d]));
        self.set_node(body, node, position, velocity)
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
    fn reading_names_of(&self, body: usize) -> Vec<Cow<'static, str>> {
        let mut bodies = self.blueprint().bodies.iter().chain(self.coming_bodies());
        bodies.nth(body).and_then(|body| self.reading_names(body).ok()).unwrap_or_default()
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
    fn warn_of_missing_contact(&mut self) {
        self.warn_of_missing_contact();
    }
    fn crossed_surfaces(&self) -> Vec<Crossed> {
        self.crossed_surfaces()
    }
    fn overlaps(&self) -> Vec<Overlap> {
        self.overlaps()
    }
    fn report_contacts(&mut self, report: bool) {
        self.report_contacts(report);
    }
    fn cast_ray(
        &self,
        origin: [f64; 3],
        direction: [f64; 3],
        reach: f64,
    ) -> Result<Option<SurfacePoint<3>>, WorldError> {
        let flat = |x: [f64; 3]| core::array::from_fn(|d| x[d]);
        Ok(self.cast_ray(flat(origin), flat(direction), reach)?.map(SurfacePoint::in_space))
    }
    fn nearest_surface_point(&self, point: [f64; 3], reach: f64) -> Result<Option<SurfacePoint<3>>, WorldError> {
        let flat = core::array::from_fn(|d| point[d]);
        Ok(self.nearest_surface_point(flat, reach)?.map(SurfacePoint::in_space))
    }
    fn contacts(&self) -> Vec<Contact<3>> {
        self.contacts().iter().map(|contact| contact.in_space()).collect()
    }
    fn visit_states(&self, body: usize, visit: &mut dyn FnMut(&CellState, &[u32])) {
        self.visit_states(body, visit);
    }
    fn node_states(&self, body: usize) -> Vec<Option<NodeState>> {
        self.node_states(body)
    }
    fn modes(&self, body: usize, count: usize) -> Result<Vec<Mode<3>>, WorldError> {
        Ok(self.modes(body, count)?.into_iter().map(Mode::in_space).collect())
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
    fn integrator_with(&self, role: Role) -> Option<&'static Spec> {
        self.registry.integrator_with(role).map(|kind| kind.spec())
    }
    fn stable_step_under(&self, integrator: &Values) -> Option<f64> {
        let integrator = self.registry.integrator(integrator.kind())?.build(integrator).ok()?;
        let mut least = f64::INFINITY;
        for (_, stability) in self.stability() {
            least = least.smaller(stability.spectrum.largest_stable_step(&*integrator)?);
        }
        Some(least)
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
    fn contact_forces(&mut self, body: usize) -> Vec<[f64; 3]> {
        self.contact_forces(body).into_iter().map(three).collect()
    }
    fn pinned_now(&self, body: usize) -> Vec<u32> {
        self.pinned_nodes(body)
    }
    fn usual_pull(&self, body: usize) -> Option<[f64; 2]> {
        self.usual_pull(body)
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
