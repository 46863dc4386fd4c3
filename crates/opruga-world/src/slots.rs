//! The list of bodies with its slots, and handles that distinguish successive bodies in the same slot.

use crate::blueprint::{BodyBlueprint, Mass};
use opruga_mesh::Mesh;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A body of one world, by number and generation.
///
/// No two bodies that a program or a user adds to a world have the same generation. This holds even if one takes the slot of another, or if a
/// restored snapshot has taken the world back to a time before one of them was added. A handle therefore refers to its own body or to none, never to
/// another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyHandle {
    /// The slot in the list of bodies.
    pub index: usize,
    /// Distinguishes the bodies that have been in the slot. Bodies of the scene have 0, because their slots are not reused.
    pub generation: u64,
    /// The world to which the body belongs.
    world: u64,
}

impl BodyHandle {
    /// Whether its body belongs to the scene: it was there at the start, or a command of the scene added it.
    pub(crate) fn is_of_scene(self) -> bool {
        self.generation == 0 || self.generation >= ACTED
    }
}

/// The origin of the body in a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The scene; the body was there at the start.
    Scene,
    /// The command with this number, which belongs to the scene.
    Command(usize),
    /// A call of the program. Once the body is removed, nothing is kept of it, and its slot is free for another one.
    Program,
    /// None: the slot is free. If its last body was in a batch, the seat of that body is reserved for bodies of the same kind as the body with this
    /// number.
    Free(Option<usize>),
    /// None yet: the slot is reserved for a body that a command of the scene will add, because other commands refer to the body by this number.
    Reserved,
}

impl Origin {
    /// Whether the slot contains a body, or contained one of the scene.
    pub(crate) fn is_taken(self) -> bool {
        !matches!(self, Origin::Free(_) | Origin::Reserved)
    }
}

/// Slots in the list of bodies.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Slots {
    pub(crate) alive: Vec<bool>,
    pub(crate) generation: Vec<u64>,
    pub(crate) origin: Vec<Origin>,
    /// The number of bodies of the scene at the start.
    pub(crate) initial: usize,
    /// The generation of the next body that the program adds; it never decreases.
    pub(crate) next: u64,
    /// The number of commands given by [`World::act`]; their bodies have generations of their own.
    pub(crate) acted: u64,
    /// Distinguishes worlds in handles. No result depends on it.
    world: u64,
}

/// The first generation of bodies that commands of [`World::act`] add; these do not overlap with generations in snapshots.
pub(crate) const ACTED: u64 = 1 << 63;

impl Slots {
    /// The slots of a scene with this many bodies.
    pub(crate) fn of_scene(bodies: usize) -> Slots {
        static WORLDS: AtomicU64 = AtomicU64::new(0);
        Slots {
            alive: vec![true; bodies],
            generation: vec![0; bodies],
            origin: vec![Origin::Scene; bodies],
            initial: bodies,
            next: 1,
            acted: 0,
            world: WORLDS.fetch_add(1, Ordering::Relaxed),
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.alive.len()
    }

    /// Whether there is a body in a slot.
    pub(crate) fn is_there(&self, body: usize) -> bool {
        self.alive.get(body).copied().unwrap_or(false)
    }

    pub(crate) fn handle(&self, body: usize) -> Option<BodyHandle> {
        self.is_there(body).then(|| self.named(body))
    }

    /// The handle of the last body in a slot, whether or not it still exists.
    pub(crate) fn named(&self, body: usize) -> BodyHandle {
        BodyHandle { index: body, generation: self.generation[body], world: self.world }
    }

    pub(crate) fn is_of(&self, handle: BodyHandle) -> bool {
        self.handle(handle.index) == Some(handle)
    }

    /// The generation of a body that the program adds now.
    pub(crate) fn next_of_program(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    /// The generation of a body that a command of [`World::act`] adds now.
    pub(crate) fn next_of_act(&mut self) -> u64 {
        self.acted += 1;
        ACTED | self.acted
    }

    /// Puts a body into a slot: the next one, or a free one.
    pub(crate) fn put(&mut self, slot: usize, origin: Origin, generation: u64) {
        if slot == self.len() {
            self.alive.push(true);
            self.generation.push(generation);
            self.origin.push(origin);
        } else {
            (self.alive[slot], self.generation[slot], self.origin[slot]) = (true, generation, origin);
        }
    }

    pub(crate) fn truncate(&mut self, count: usize) {
        self.alive.truncate(count);
        self.generation.truncate(count);
        self.origin.truncate(count);
    }
}

impl<const D: usize> BodyBlueprint<D> {
    /// The content of a slot without a body: no name, no nodes.
    pub(crate) fn nobody() -> BodyBlueprint<D> {
        BodyBlueprint {
            name: String::new(),
            mesh: Arc::new(Mesh::default()),
            translation: [0.0; D],
            velocity: [0.0; D],
            angular_velocity: Vec::new(),
            velocity_gradient: [[0.0; D]; D],
            node_velocities: Arc::from([]),
            mass: Mass::Node(1.0),
            thickness: 1.0,
            integrator: None,
            models: Vec::new(),
            pins: Vec::new(),
            contact: None,
        }
    }
}
