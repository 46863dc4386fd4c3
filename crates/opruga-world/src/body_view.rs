//! A body that a handle refers to. If the handle is stale, readings return an error, and never the values of another body.

use crate::blueprint::BodyBlueprint;
use crate::error::{Part, WorldError};
use crate::path_faults::PathFault;
use crate::refusals::Refusal;
use crate::slots::BodyHandle;
use crate::world::World;
use opruga_core::error::BuildError;

/// Read access to a present body; [`World::view`] makes it from a handle.
#[derive(Clone, Copy, Debug)]
pub struct BodyView<'w, const D: usize> {
    world: &'w World<D>,
    number: usize,
}

impl<const D: usize> World<D> {
    /// The body of a handle.
    ///
    /// # Errors
    /// `stale_handle` if the body was removed, if the world was rewound to a time before the body was added, or if the handle belongs to another
    /// world.
    pub fn view(&self, handle: BodyHandle) -> Result<BodyView<'_, D>, WorldError> {
        Ok(BodyView { world: self, number: self.resolve(handle)? })
    }

    /// The number of the body of a handle. The number stays the same while the body exists.
    ///
    /// # Errors
    /// The errors of [`World::view`].
    pub fn resolve(&self, handle: BodyHandle) -> Result<usize, WorldError> {
        if self.slots.is_of(handle) {
            return Ok(handle.index);
        }
        let source = BuildError::of("handle", Refusal::StaleHandle {});
        Err(WorldError::Build { part: Part::BodyAt { index: handle.index }, source })
    }
}

impl<'w, const D: usize> BodyView<'w, D> {
    /// The number of the body, for use with the methods of [`World`].
    pub fn number(&self) -> usize {
        self.number
    }
    /// Its blueprint, with all changes since the start.
    pub fn blueprint(&self) -> &'w BodyBlueprint<D> {
        &self.world.blueprint.bodies[self.number]
    }
    /// The number of its nodes.
    pub fn node_count(&self) -> usize {
        self.world.node_count(self.number)
    }
    /// The position of a node [m].
    ///
    /// # Errors
    /// [`WorldError::Path`] if there is no such node.
    pub fn position(&self, node: u32) -> Result<[f64; D], WorldError> {
        self.known(node).map(|()| self.world.position(self.number, node))
    }
    /// The velocity of a node [m/s].
    ///
    /// # Errors
    /// The errors of [`BodyView::position`].
    pub fn velocity(&self, node: u32) -> Result<[f64; D], WorldError> {
        self.known(node).map(|()| self.world.velocity(self.number, node))
    }
    /// The mass of a node [kg].
    ///
    /// # Errors
    /// The errors of [`BodyView::position`].
    pub fn node_mass(&self, node: u32) -> Result<f64, WorldError> {
        self.known(node).map(|()| self.world.node_mass(self.number, node))
    }

    fn known(&self, node: u32) -> Result<(), WorldError> {
        let count = self.node_count();
        if (node as usize) < count {
            return Ok(());
        }
        let path = format!("body.{}.node.{node}", self.blueprint().name);
        Err(WorldError::path(path, PathFault::NoNode { last: count - 1 }))
    }
}
