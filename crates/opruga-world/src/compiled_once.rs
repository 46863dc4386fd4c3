//! The work of a world, compiled once.
//!
//! Generic code is compiled anew in every crate that calls it. A world has two or three dimensions and no others, so its
//! public methods that do work call a copy of themselves that is compiled here, and programs that use worlds are built in
//! a fraction of the time. The bodies of the methods lie where they belong by sense, under names that end in `_here`.

use crate::blueprint::{Blueprint, BodyBlueprint, CommandBlueprint};
use crate::error::WorldError;
use crate::inputs::Input;
use crate::loads::ForceLaw;
use crate::modes::Mode;
use crate::registry::Registry;
use crate::world::{Options, Warning, World};
use core::any::Any;
use opruga_core::potential::{Account, CellState, Reading};
use opruga_core::spec::Value;
use std::borrow::Cow;
use std::sync::Arc;

/// The same value under the name that its type has where the dimension is known.
fn same<A: 'static, B: 'static>(value: A) -> B {
    let mut slot = Some(value);
    let there = (&mut slot as &mut dyn Any).downcast_mut::<Option<B>>().and_then(Option::take);
    let Some(value) = there else { unreachable!("both names belong to one type") };
    value
}

/// As [`same`], of a value that is lent to be changed.
fn same_mut<A: 'static, B: 'static>(value: &mut A) -> Option<&mut B> {
    (value as &mut dyn Any).downcast_mut()
}

/// As [`same`], of a value that is lent.
fn same_ref<A: 'static, B: 'static>(value: &A) -> Option<&B> {
    (value as &dyn Any).downcast_ref()
}

/// As [`same_ref`] where it is known that the types are one.
fn same_lent<A: 'static, B: 'static>(value: &A) -> &B {
    let Some(value) = same_ref(value) else { unreachable!("both names belong to one type") };
    value
}

/// The way in which an argument is handed over: as it is (`:`), by [`same`] (`@`), by [`same_lent`] (`&`).
macro_rules! hand_over {
    ($name:ident :) => {
        $name
    };
    ($name:ident @) => {
        same($name)
    };
    ($name:ident &) => {
        same_lent($name)
    };
}

/// The type of an argument.
macro_rules! kind {
    (: $type:ty) => {
        $type
    };
    (@ $type:ty) => {
        $type
    };
    (& $type:ty) => {
        &$type
    };
}

/// A method that calls its copy in the dimension of the world. Within each block the number of dimensions is a constant of
/// the name `D`, so that the types of the arguments mean those of that dimension.
macro_rules! compiled_once {
    ($cast:ident [$($world:tt)+] $self:ident ($($argument:ident $how:tt $type:ty),*) -> $out:ty = $here:ident) => {{
        {
            const D: usize = 2;
            fn here(world: $($world)+ World<D> $(, $argument: kind!($how $type))*) -> $out {
                world.$here($($argument),*)
            }
            if let Some(world) = $cast::<_, World<D>>($self) {
                return same(here(world $(, hand_over!($argument $how))*));
            }
        }
        const D: usize = 3;
        fn here(world: $($world)+ World<D> $(, $argument: kind!($how $type))*) -> $out {
            world.$here($($argument),*)
        }
        let Some(world) = $cast::<_, World<D>>($self) else { unreachable!("a world has two or three dimensions") };
        same(here(world $(, hand_over!($argument $how))*))
    }};
}

/// Methods that read.
macro_rules! readers {
    ($(
        $(#[$about:meta])*
        pub fn $name:ident(&$self:ident $(, $argument:ident $how:tt $type:ty)*) -> $out:ty = $here:ident;
    )*) => { $(
        $(#[$about])*
        pub fn $name(&$self $(, $argument: kind!($how $type))*) -> $out {
            compiled_once!(same_ref [&] $self ($($argument $how $type),*) -> $out = $here)
        }
    )* };
}

/// Methods that change the world.
macro_rules! doers {
    ($(
        $(#[$about:meta])*
        $vis:vis fn $name:ident(&mut $self:ident $(, $argument:ident $how:tt $type:ty)*) -> $out:ty = $here:ident;
    )*) => { $(
        $(#[$about])*
        $vis fn $name(&mut $self $(, $argument: kind!($how $type))*) -> $out {
            compiled_once!(same_mut [&mut] $self ($($argument $how $type),*) -> $out = $here)
        }
    )* };
}

impl<const D: usize> World<D> {
    /// Builds a world from a blueprint with the models and integrators of this library.
    ///
    /// A blueprint that a program has made keeps to what a scene file could say: see [`crate::validity`]. Commands are an exception:
    /// whether their body is there is seen when they begin.
    ///
    /// # Errors
    /// [`WorldError`] where the blueprint holds what no scene could say, a model or obstacle refuses, or the step is unstable.
    pub fn new(blueprint: Blueprint<D>, options: Options) -> Result<World<D>, WorldError> {
        World::with_registry(blueprint, options, Arc::new(Registry::default()))
    }

    /// Builds a world with a registry that a user has extended.
    ///
    /// # Errors
    /// As [`World::new`].
    pub fn with_registry(
        blueprint: Blueprint<D>,
        options: Options,
        registry: Arc<Registry<D>>,
    ) -> Result<World<D>, WorldError> {
        fn plane(b: Blueprint<2>, o: Options, r: Arc<Registry<2>>) -> Result<World<2>, WorldError> {
            crate::validity::blueprint(&b)?;
            World::build(b, o, r)
        }
        fn space(b: Blueprint<3>, o: Options, r: Arc<Registry<3>>) -> Result<World<3>, WorldError> {
            crate::validity::blueprint(&b)?;
            World::build(b, o, r)
        }
        if D == 2 {
            same(plane(same(blueprint), options, same(registry)))
        } else {
            same(space(same(blueprint), options, same(registry)))
        }
    }

    readers! {
        /// Pulls that act at present: held point, pointer, force [N].
        pub fn pulls(&self) -> Vec<([f64; D], [f64; D], [f64; D])> = pulls_here;

        /// The lowest `count` natural modes of a body about its present state, rigid ones first.
        ///
        /// # Errors
        /// [`WorldError`] if there is no such body, if a model lacks second derivatives or refuses the state, or if no
        /// frequency can be found since a node without mass can move.
        pub fn modes(&self, body: usize, count: usize) -> Result<Vec<Mode<D>>, WorldError> = modes_here;

        /// Stress and volume ratio of the cells of a body of finite elements, in the order of its cells.
        ///
        /// A body that is not there, or has none, says nothing.
        pub fn cell_states(&self, body: usize) -> Vec<CellState> = cell_states_here;

        /// A warning (`cells.inverted`) of cells of finite elements that are inside out in the present state, wholly or
        /// somewhere, which the rules of motion allow; none where all are certainly right side out. Looked for anew by every call.
        ///
        /// J of quadratic cells and boxes is bounded over the whole cell ([`opruga_mesh::least_jacobian`]), whatever their integration
        /// points see. A cell that is so nearly flat somewhere that the bounds do not decide is counted as one that may be.
        pub fn inverted_cells(&self) -> Option<Warning> = inverted_cells_here;

        /// A warning (`cells.other_balance`) of bodies of finite elements that are nearly at rest and hold more energy than the
        /// forces on them account for, from their own shape on: they snapped through, are folded, inside out or twisted
        /// round. None where there is no such body. Looked for anew by every call.
        ///
        /// With the forces fᵢ that hold the shape [N] and the rest shape moved as a whole to where it fits the present places
        /// xᵢ best, yᵢ, a body is told of where its energy is more than Σ |fᵢ| |xᵢ − yᵢ|: what loads, pins, obstacles or gas have
        /// deformed holds half of that at most if it is strained a little. Bodies of the material `linear`, which has one shape in
        /// which it holds nothing, are never told of.
        pub fn other_balances(&self) -> Option<Warning> = other_balances_here;

        /// Warnings so far, with counts.
        pub fn warnings(&self) -> Vec<Warning> = warnings_here;

        /// Warnings so far, and what is odd about the shapes in the present state: [`World::inverted_cells`] and
        /// [`World::other_balances`]. For the end of a run, since shapes are looked at anew by every call.
        pub fn warnings_at_the_end(&self) -> Vec<Warning> = warnings_at_the_end_here;

        /// A 64-bit hash (FNV-1a) over the little-endian bits of all positions, then velocities, body by body in node order.
        pub fn state_hash(&self) -> u64 = state_hash_here;

        /// A 64-bit hash over the same numbers, coordinate by coordinate of every body, eight at a time: so quick that every
        /// frame of a recording has one.
        pub fn frame_hash(&self) -> u64 = frame_hash_here;

        /// Bytes on the heap for the state and the models of all bodies.
        pub fn heap_bytes(&self) -> usize = heap_bytes_here;

        /// What a reader sees of a body that is not there yet: the names of its readings.
        ///
        /// # Errors
        /// [`WorldError`] where a model refuses the body.
        pub fn reading_names(&self, body & BodyBlueprint<D>) -> Result<Vec<Cow<'static, str>>, WorldError> = reading_names_here;

        /// The pairs of nodes that springs of a body tie to each other, also of one that is not there yet.
        ///
        /// # Errors
        /// [`WorldError`] where a model refuses the body.
        pub fn springs(&self, body & BodyBlueprint<D>) -> Result<Vec<[u32; 2]>, WorldError> = springs_here;

        /// Appends the bytes of [`World::snapshot`]: for those who take one every frame.
        pub fn snapshot_into(&self, out: &mut Vec<u8>) -> () = snapshot_into_here;
    }

    doers! {
        /// Steps through one frame.
        ///
        /// # Errors
        /// [`WorldError`] names body, node and substep; the world is at its last good frame.
        pub fn frame(&mut self) -> Result<(), WorldError> = frame_here;

        /// Where energy has come from nowhere (`ledger.closure`), looks whether the step is still stable in the present
        /// state, and warns (`step.outgrown`) if it is not; says whether there was anything to look for. Stepping goes on
        /// as it would without.
        pub fn look_at_steps_again(&mut self) -> bool = look_at_steps_again_here;

        /// Moves a node and gives it a velocity, from outside of the physics.
        ///
        /// # Errors
        /// [`WorldError::Path`] if there is no such node, or a number is not finite; the world stays as it was.
        pub fn place_node(&mut self, body: usize, node: u32, position @ [f64; D], velocity @ [f64; D]) -> Result<(), WorldError> = place_node_here;

        /// Adds a force on every node of a body by a user's law of (node, position, velocity, time).
        ///
        /// The law runs while the world is stepped, on any thread, so it cannot change the world; this does not compile:
        ///
        /// ```compile_fail,E0502
        /// # use opruga_world::World; use std::sync::Arc;
        /// fn removes<'w>(world: &'w mut World<2>) {
        ///     let mut law = |_: u32, _: [f64; 2], _: [f64; 2], _: f64| { let _ = world.remove_body("ball"); [0.0; 2] };
        ///     let _ = world.frame();
        ///     law(0, [0.0; 2], [0.0; 2], 0.0);
        /// }
        /// ```
        ///
        /// # Errors
        /// [`WorldError`] if there is no such body or its island cannot be built anew; the world stays as it was.
        pub fn add_force(&mut self, body: usize, law @ Arc<ForceLaw<D>>) -> Result<(), WorldError> = add_force_here;

        /// Changes a parameter: `body.NAME.models.KIND.FIELD`, `body.NAME.integrator.FIELD`, `integrator.FIELD`, `collider.NUMBER.FIELD`, `world.gravity`,
        /// `world.drag`, `world.largest_force`, `world.largest_velocity`, `world.largest_distance`, `world.unfold`, `time.substeps`.
        ///
        /// The name of a body with copies means all of them, `NAME[i]` one; a body or a model may be named by its number. The
        /// stable step is estimated anew.
        ///
        /// # Errors
        /// [`WorldError`] says what is wrong; the world stays as it was.
        pub fn set(&mut self, path: &str, value: Value) -> Result<(), WorldError> = set_here;

        /// Gives a command; it begins at its time, at the beginning of a frame. Once it is over nothing is kept of it.
        ///
        /// # Errors
        /// [`WorldError`] if it names a body that is not there, or holds what no command of a scene could.
        pub fn command(&mut self, command @ CommandBlueprint<D>) -> Result<(), WorldError> = command_here;

        /// Gives a command that begins now, as if the scene had held it from the start; returns its number.
        ///
        /// Commands of the scene that are due begin before it. The number stays the same until the world is built anew.
        ///
        /// # Errors
        /// [`WorldError`] if its time is not that of the coming frame or if it is refused; then it was never given.
        pub fn act(&mut self, command @ CommandBlueprint<D>) -> Result<usize, WorldError> = act_here;

        /// Begins and ends what is due now without waiting for the coming frame, which then finds it done: what is to be seen
        /// at a moment that was gone back to.
        ///
        /// # Errors
        /// [`WorldError`] of the first command that is refused; the others begin all the same.
        pub fn begin_what_is_due(&mut self) -> Result<(), WorldError> = run_commands;

        /// Leads the pointer of a drag: adds a row `[t, x, y(, z)]` to the end of its path.
        ///
        /// What was stepped before does not change if the row lies behind the frame that comes next.
        ///
        /// # Errors
        /// [`WorldError::Path`] if the command is no drag, the time does not rise, or a number is not finite.
        pub fn lead(&mut self, number: usize, row: Vec<f64>) -> Result<(), WorldError> = lead_here;

        /// Ends a command at a time [s] instead of its own.
        ///
        /// # Errors
        /// [`WorldError::Path`] if there is no such command, or it would not end after its beginning.
        pub fn finish(&mut self, number: usize, until: f64) -> Result<(), WorldError> = finish_here;

        /// Does again what a program did.
        ///
        /// # Errors
        /// Those of the call that it stands for; the world stays as it was.
        pub fn repeat(&mut self, input & Input<D>) -> Result<(), WorldError> = repeat_here;

        /// Adds a body; returns its number. Once it was removed nothing is kept of it, and its number may be given to another body
        /// that the program adds: [`World::handle`] tells one from the other.
        ///
        /// # Errors
        /// [`WorldError`] if its name is taken, it is none that a scene could hold, or a model refuses; the world stays as it was.
        pub fn add_body(&mut self, body @ BodyBlueprint<D>) -> Result<usize, WorldError> = add_body_here;

        /// Takes a body away.
        ///
        /// # Errors
        /// [`WorldError::Path`] if there is no body of that name.
        pub fn remove_body(&mut self, name: &str) -> Result<(), WorldError> = remove_body_here;

        /// What models say of a body: `volume`, `pressure`, `chamber1.pressure` and others.
        ///
        /// A body that is not there says nothing.
        pub fn readings(&mut self, body: usize) -> Vec<Reading> = readings_here;

        /// The pressure [Pa] of the gas that each node of a body bounds, chamber by chamber; empty where there is no gas.
        pub fn node_pressures(&mut self, body: usize) -> Vec<(u32, f64)> = node_pressures_here;

        /// The values of a probe now: names of columns and numbers, which are NaN while its body is not there. Empty where there is no
        /// probe of that number.
        pub fn probe(&mut self, number: usize) -> Vec<(String, f64)> = probe_here;

        /// The forces of the models of one account on the nodes of a body [N]; none: of all models, gravity included.
        ///
        /// Empty where the body is not there or a model refuses the state.
        pub fn node_forces(&mut self, body: usize, account: Option<Account>) -> Vec<[f64; D]> = node_forces_here;

        /// The forces of obstacles on the nodes of a body in the coming substep, f = m (v' − v*)/h [N].
        ///
        /// v* is the velocity that the forces of now would give a node within h without obstacles, v' the one with them:
        /// normal force, friction, and in an impact the impulse over h. Held nodes feel none; the pin takes it.
        /// Empty where the body is not there, there are no obstacles, or a model refuses the state.
        pub fn contact_forces(&mut self, body: usize) -> Vec<[f64; D]> = contact_forces_here;

        /// The sum of the forces that pins exert on nodes [N]; NaN where there is no such body, or one of the nodes is not there.
        pub fn reaction(&mut self, body: usize, nodes: &[u32]) -> [f64; D] = reaction_here;

        /// Goes to the state of a snapshot of a world with the same blueprint. Bodies that a program had added and commands that it had
        /// given come back with it; those of since then are forgotten, and handles of them are stale. Laws of force of the
        /// program are no part of a snapshot: a body that comes back lacks its law, and a warning (`restore.no_force`) says so.
        ///
        /// # Errors
        /// [`WorldError::Snapshot`] if the bytes belong to another scene or are damaged; the world stays as it was.
        pub fn restore(&mut self, bytes: &[u8]) -> Result<(), WorldError> = restore_here;

        /// Goes to the state of a snapshot of a world whose commands up to then were the same: those that had not begun may
        /// be others, and more or fewer.
        ///
        /// # Errors
        /// As [`World::restore`].
        pub fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError> = rewind_here;
    }
}
