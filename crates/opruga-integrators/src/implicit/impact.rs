//! The effect of obstacles at the end of a step: on nodes that are still inside, on velocities, and on the ledger.

use super::balance::Balance;
use super::contact::{Contact, Contacting, Hold, SMALL, dot, pins_decide, split};
use opruga_core::contacts::Touch;
use opruga_core::system::{System, Work8};
use opruga_math::{Lane, WIDTH};
use opruga_solve::blocks::{Block, isotropic, nodes};

/// A node moves along with a surface if their velocities differ by no more than this fraction of the change of the velocity of
/// the surface.
const MOVES_ALONG: f64 = 0.1;

impl<const D: usize> Contacting<D> {
    /// Moves nodes that are still inside an obstacle to the surface of the obstacle, and records the energy that the nodes
    /// gain. The residual on the nodes is `reaction` [N]; pinned axes have a number in `pin_displacement`.
    pub(crate) fn expel(
        &self,
        system: &mut System<D>,
        [x0, reaction, pin_displacement]: [&[f64]; 3],
        u1: &mut [f64],
        h: f64,
        extent: f64,
    ) {
        let Some(obstacles) = system.contacts.clone() else { return };
        let time = system.time + h;
        for (node, from) in nodes::<D>(x0).iter().enumerate() {
            let at = node * D;
            let to: [f64; D] = core::array::from_fn(|d| from[d] + u1[at + d]);
            let mut deepest: Option<Touch<D>> = None;
            obstacles.touch(from, &to, time, h, 0.0, &mut |touch| {
                let deep = touch.gap < -(SMALL * extent + touch.rounding);
                let moves = !pins_decide(&pin_displacement[at..at + D], &touch.normal);
                if deep && moves && deepest.is_none_or(|other| touch.gap < other.gap) {
                    deepest = Some(touch);
                }
            });
            if let Some(touch) = deepest {
                for d in (0..D).filter(|d| pin_displacement[at + d].is_nan()) {
                    u1[at + d] -= touch.gap * touch.normal[d];
                    system.work.correction[node % WIDTH] -= reaction[at + d] * touch.gap * touch.normal[d];
                }
            }
        }
    }

    /// Ends a step: records the work of the forces that held nodes (`ending.reaction`), and corrects velocities. Rules discard
    /// their memory in the directions in which a surface has stopped nodes. `struck` lists these nodes.
    pub(crate) fn end(
        &self,
        system: &mut System<D>,
        ending: &Ending<'_, D>,
        v1: &mut [f64],
        memory: &[f64],
        struck: &mut Vec<Struck<D>>,
    ) {
        struck.clear();
        for contacts in self.contacts.chunk_by(|a, b| a.node == b.node).filter(|c| c.iter().any(Contact::is_active)) {
            let node = contacts[0].node;
            let at = node * D;
            let total = ending.part(node, ending.reaction);
            let normal_forces = split(contacts, &total);
            let mut motion = Motion {
                mass: ending.mass[node],
                velocity: ending.part(node, v1),
                memory: ending.part(node, memory),
                kept: isotropic(1.0),
                fresh: false,
            };
            let alone = contacts.iter().filter(|contact| contact.is_active()).count() == 1;
            for (k, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.is_active()) {
                let force = Force { normal: normal_forces[k.min(D - 1)], total };
                motion.meet(&mut system.work, ending, contact, &force, alone);
            }
            ending.enter_forces(&mut system.work, contacts, &normal_forces, &total, &motion, &ending.part(node, v1));
            v1[at..at + D].copy_from_slice(&motion.velocity);
            if motion.fresh {
                let Motion { kept, memory, .. } = motion;
                struck.push(Struck { node, kept, memory });
            }
        }
    }
}

/// A node whose motion a surface has changed abruptly.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Struck<const D: usize> {
    pub(crate) node: usize,
    /// The projector on the directions in which the memory of the rule stays valid.
    pub(crate) kept: Block<D>,
    /// The velocity that the rule will still add from its memory [m/s].
    pub(crate) memory: [f64; D],
}

/// The data for the end of a step: x₀, v₀ and the forces that held nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ending<'a, const D: usize> {
    pub(crate) mass: &'a [f64],
    pub(crate) reaction: &'a [f64],
    pub(crate) x0: &'a [f64],
    pub(crate) v0: &'a [f64],
    pub(crate) balance: &'a Balance,
    pub(crate) extent: f64,
}

impl<const D: usize> Ending<'_, D> {
    fn part(&self, node: usize, vector: &[f64]) -> [f64; D] {
        nodes::<D>(vector)[node]
    }

    /// Records the work of the forces on one node in the step, from its mean velocity. If the memory of the rule is kept, the
    /// work includes the later effect of these forces. If the memory is discarded, `Motion::meet` has already recorded that
    /// effect.
    fn enter_forces(
        &self,
        work: &mut Work8,
        contacts: &[Contact<D>],
        normal_forces: &[f64; D],
        force: &[f64; D],
        motion: &Motion<D>,
        v1: &[f64; D],
    ) {
        let (node, lane) = (contacts[0].node, contacts[0].node % WIDTH);
        let (x0, v0) = (self.part(node, self.x0), self.part(node, self.v0));
        let share = if motion.fresh { self.balance.impulse } else { 1.0 };
        // Work beyond the share of this step belongs to the velocity that the rule will add later from its memory. A second
        // entry keeps it out of the losses due to the rule itself.
        let beyond = |share: f64, work: f64| (share - self.balance.impulse) * work;
        let mut rest = *force;
        let mut carrier = None;
        for (k, contact) in contacts.iter().enumerate().filter(|(_, contact)| contact.is_active()) {
            let normal_force = normal_forces[k.min(D - 1)];
            let Touch { normal, carried, .. } = &contact.touch;
            let ride: [f64; D] = core::array::from_fn(|d| carried[d] - x0[d]);
            let own: [f64; D] = core::array::from_fn(|d| 0.5 * self.balance.h * (v0[d] + v1[d]) - ride[d]);
            for d in 0..D {
                rest[d] -= normal_force * normal[d];
            }
            work.user[lane] += share * normal_force * dot(normal, &ride);
            work.contact[lane] -= share * normal_force * dot(normal, &own);
            work.numerical[lane] += beyond(share, normal_force * (dot(normal, &ride) + dot(normal, &own)));
            let along = if contact.hold == Hold::Stick { share } else { 1.0 };
            carrier = carrier.or(Some((ride, own, along)));
        }
        if let Some((ride, own, share)) = carrier {
            work.user[lane] += share * dot(&rest, &ride);
            work.friction[lane] -= share * dot(&rest, &own);
            work.numerical[lane] += beyond(share, dot(&rest, &ride) + dot(&rest, &own));
        }
    }
}

/// The force of a contact: along its normal, and the total force on the node [N].
struct Force<const D: usize> {
    normal: f64,
    total: [f64; D],
}

/// The motion of a node at the end of a step, and what its rule will still add to its velocity.
struct Motion<const D: usize> {
    mass: f64,
    velocity: [f64; D],
    memory: [f64; D],
    kept: Block<D>,
    fresh: bool,
}

impl<const D: usize> Motion<D> {
    /// Applies a surface to the motion. The surface stops or reverses the normal velocity, and friction reduces the tangential
    /// velocity by µ times the change of the normal velocity.
    ///
    /// The impulses of a whole step, including the memory of the rule, obey J_t = µ J_n against the slide.
    fn meet(&mut self, work: &mut Work8, ending: &Ending<'_, D>, contact: &Contact<D>, force: &Force<D>, alone: bool) {
        let (touch, node, mass) = (&contact.touch, contact.node, self.mass);
        let lane = node % WIDTH;
        let (x0, v0) = (ending.part(node, ending.x0), ending.part(node, ending.v0));
        let h = ending.balance.h;
        let relative: [f64; D] = core::array::from_fn(|d| self.velocity[d] - touch.velocity[d]);
        let coming: [f64; D] = core::array::from_fn(|d| v0[d] - touch.velocity[d]);
        let (speed, came) = (dot(&relative, &touch.normal), -dot(&coming, &touch.normal));
        let slide = contact.along(&relative);
        // The initial velocity of the node relative to the surface, and the change of the velocity of the surface since then.
        let surface: [f64; D] = core::array::from_fn(|d| 2.0 / h * (touch.carried[d] - x0[d]) - touch.velocity[d]);
        let beside: [f64; D] = core::array::from_fn(|d| v0[d] - surface[d]);
        let turned: [f64; D] = core::array::from_fn(|d| touch.velocity[d] - surface[d]);
        let still =
            |displacement: f64, own: f64| displacement.abs() <= MOVES_ALONG * own.abs() + SMALL * ending.extent / h;
        let size = |vector: &[f64; D]| dot(vector, vector).sqrt();

        // Along the normal, the incoming velocity is lost, or a part of it is returned; no surface pulls. A node that has just
        // reached the surface without being held hits it now.
        let nears = dot(&beside, &touch.normal);
        let own = dot(&turned, &touch.normal);
        let impact = touch.gap_before > touch.rounding || nears < 0.0 && !still(nears, own);
        let Balance { impulse, echo, .. } = ending.balance;
        let normal_impulse = h * (impulse + echo) * force.normal;
        let remembered = dot(&self.memory, &touch.normal);
        let stopped = impact || !still(nears, own) || !still(MOVES_ALONG * remembered, own);
        let (after, change) = if stopped {
            let bounces = came > touch.rest_speed && impact;
            let back = if bounces { touch.restitution * came } else { 0.0 };
            let brought = speed + remembered;
            let change = (mass * (back - brought)).larger(-normal_impulse);
            self.forget(&touch.normal);
            (brought + change / mass, change)
        } else {
            (0.0, 0.0)
        };

        // The motion along the surface.
        let slide_after = if contact.hold == Hold::Stick {
            let memory = contact.along(&self.memory);
            let pull = contact.along(&force.total);
            let free: [f64; D] = core::array::from_fn(|d| slide[d] + memory[d] - h * (impulse + echo) * pull[d] / mass);
            let (pace, most) = (size(&free), touch.friction * (normal_impulse + change) / mass);
            let own = size(&contact.along(&turned));
            let goes_along = still(size(&contact.along(&beside)), own) && still(MOVES_ALONG * size(&memory), own);
            if goes_along && change >= 0.0 {
                [0.0; D]
            } else {
                for d in 0..D {
                    let mut axis = [0.0; D];
                    axis[d] = 1.0;
                    self.forget(&contact.along(&axis));
                }
                if alone && pace > most { free.map(|speed| speed * (1.0 - most / pace)) } else { [0.0; D] }
            }
        } else {
            let pace = -dot(&slide, &contact.push);
            let most = touch.friction * change / mass;
            // Friction can at most stop a slide.
            let taken = if most > 0.0 { most.smaller(pace.larger(0.0)) } else { most };
            core::array::from_fn(|d| slide[d] + taken * contact.push[d])
        };
        let gained: [f64; D] = core::array::from_fn(|d| (after - speed) * touch.normal[d] + slide_after[d] - slide[d]);
        work.contact[lane] += 0.5 * mass * (speed * speed - after * after);
        work.friction[lane] += 0.5 * mass * (dot(&slide, &slide) - dot(&slide_after, &slide_after));
        work.user[lane] += mass * dot(&gained, &touch.velocity);
        for d in 0..D {
            self.velocity[d] += gained[d];
        }
    }

    /// Discards the memory along a direction.
    fn forget(&mut self, direction: &[f64; D]) {
        let size = dot(direction, direction);
        if size <= 1e-12 {
            return;
        }
        let along = dot(direction, &self.memory) / size;
        for i in 0..D {
            self.memory[i] -= along * direction[i];
            let row = self.kept[i];
            let part = dot(&row, direction) / size;
            for j in 0..D {
                self.kept[i][j] -= part * direction[j];
            }
        }
        self.fresh = true;
    }
}
