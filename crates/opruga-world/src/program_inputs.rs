//! Inputs of a program to a world that are not part of its scene: moved nodes and added forces. A world records such inputs on request and can repeat
//! them.

use crate::error::WorldError;
use crate::inputs::Input;
use crate::loads::ForceLaw;
use crate::path_faults::PathFault;
use crate::world::World;
use std::collections::BTreeSet;
use std::sync::Arc;

impl<const D: usize> World<D> {
    /// Records the inputs of the program from now on, for [`World::take_inputs`].
    pub fn keep_inputs(&mut self) {
        self.inputs.get_or_insert_default();
    }

    /// The inputs of the program since the last call, in order; empty unless [`World::keep_inputs`] was called.
    pub fn take_inputs(&mut self) -> Vec<Input<D>> {
        self.inputs.as_mut().map(std::mem::take).unwrap_or_default()
    }

    pub(crate) fn write_down(&mut self, input: impl FnOnce() -> Input<D>) {
        if let Some(inputs) = &mut self.inputs {
            inputs.push(input());
        }
    }

    /// Repeats an input of a program.
    ///
    /// # Errors
    /// The errors of the original call; the world is then unchanged.
    pub fn repeat(&mut self, input: &Input<D>) -> Result<(), WorldError> {
        match input {
            Input::Command(command) => self.command(command.clone()),
            Input::Set { path, value } => self.set(path, value.clone()),
            Input::Remove { name } => self.remove_body(name),
            Input::SetNode { body, node, position, velocity } => self.set_node(*body, *node, *position, *velocity),
            Input::Add { .. } | Input::Force { .. } | Input::Act => Err(input.unwritable()),
        }
    }

    /// Sets the position and the velocity of a node directly, without any force.
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no such node, or if a number is not finite; the world is then unchanged.
    pub fn set_node(
        &mut self,
        body: usize,
        node: u32,
        position: [f64; D],
        velocity: [f64; D],
    ) -> Result<(), WorldError> {
        let refuse = |fault: PathFault| Err(WorldError::path(format!("body.{body}.node.{node}"), fault));
        if node as usize >= self.node_count(body) {
            return refuse(PathFault::NoNode { last: self.node_count(body).saturating_sub(1) });
        }
        if let Some(x) = position.iter().chain(&velocity).find(|x| !x.is_finite()) {
            return refuse(PathFault::NoPosition { value: *x });
        }
        let (island, lane) = self.locations[body];
        let island = &mut self.islands[island];
        let index = island.system.layout.index(node as usize, lane);
        island.system.state.x.set(index, position);
        island.system.state.v.set(index, velocity);
        // The history of an integrator does not fit the new state.
        island.system.history.reset();
        island.refresh();
        // The change of energy counts as neither work nor loss.
        let before = self.energy.total();
        self.flows.start += self.stock_energy() - before;
        self.refresh_ledger();
        self.write_down(|| Input::SetNode { body, node, position, velocity });
        Ok(())
    }
    /// Adds a force on every node of a body, given by a user's law of (node, position, velocity, time).
    ///
    /// The law runs during a step, on any thread, so it cannot change the world. This does not compile:
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
    /// [`WorldError`] if there is no such body or if its island cannot be rebuilt; the world is then unchanged.
    pub fn add_force(&mut self, body: usize, law: Arc<ForceLaw<D>>) -> Result<(), WorldError> {
        let Some(handle) = self.handle(body) else {
            return Err(WorldError::path(format!("body.{body}"), PathFault::NoBody {}));
        };
        self.user_forces.push((handle, law));
        let outcome = self.rebuild(&BTreeSet::from([body]));
        match outcome {
            Ok(()) => self.write_down(|| Input::Force { body }),
            Err(_) => _ = self.user_forces.pop(),
        }
        outcome
    }
}
