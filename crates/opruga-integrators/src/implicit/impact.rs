//! What obstacles do at the end of a step: nodes that are inside nevertheless, velocities, and the ledger.

use super::balance::Balance;
use super::contact::{Contact, Contacting, Hold, SMALL, dot, split};
use opruga_core::contacts::Touch;
use opruga_core::system::{System, Work8};
use opruga_math::{Lane, WIDTH};
use opruga_solve::blocks::{Block, isotropic, nodes};

/// A node goes along with a surface when its velocity differs by no more than this part of what that changed its own by.
const MOVES_ALONG: f64 = 0.1;

impl<const D: usize> Contacting<D> {
    /// Puts nodes that are nevertheless inside onto the surface; `reaction` is what was out of balance without them.
    pub(crate) fn expel(
        &self,
        system: &mut System<D>,
        x0: &[f64],
        u1: &mut [f64],
        reaction: &[f64],
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
                if deep && deepest.is_none_or(|other| touch.gap < other.gap) {
                    deepest = Some(touch);
                }
            });
            if let Some(touch) = deepest {
                for d in 0..D {
                    u1[at + d] -= touch.gap * touch.normal[d];
                    system.work.correction[node % WIDTH] -= reaction[at + d] * touch.gap * touch.normal[d];
                }
            }
        }
    }

    /// Ends a step: enters the work of the forces that held nodes (`ending.reaction`), and deals with velocities. What rules
    /// remember of the directions that a surface has stopped ends with it; `struck` then names those nodes.
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

/// A node whose motion a surface has changed at once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Struck<const D: usize> {
    pub(crate) node: usize,
    /// The projector on the directions in which what a rule remembers still holds.
    pub(crate) kept: Block<D>,
    /// What the rule will still add to the velocity out of what it remembers [m/s].
    pub(crate) memory: [f64; D],
}

/// What the end of a step goes by: a step from x₀, v₀ and the forces that held nodes.
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

    /// Enters the work of the forces of one node through the step, by its mean velocity: what they change of the motion. What
    /// a rule would add to the velocity later of a force that ends with its memory is in the change of that velocity.
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
        // What is entered of a force beyond its part of this step stands for what the rule remembers of it, and is none of its own.
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

/// The force of a contact: along its normal, and all that the node takes [N].
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
    /// What a surface makes of the motion: along the normal it ends or returns; friction takes µ times that change, too.
    ///
    /// Impulses of a whole step obey the law, J_t = µ J_n against the slide, with what is remembered counted in.
    fn meet(&mut self, work: &mut Work8, ending: &Ending<'_, D>, contact: &Contact<D>, force: &Force<D>, alone: bool) {
        let (touch, node, mass) = (&contact.touch, contact.node, self.mass);
        let lane = node % WIDTH;
        let (x0, v0) = (ending.part(node, ending.x0), ending.part(node, ending.v0));
        let h = ending.balance.h;
        let relative: [f64; D] = core::array::from_fn(|d| self.velocity[d] - touch.velocity[d]);
        let coming: [f64; D] = core::array::from_fn(|d| v0[d] - touch.velocity[d]);
        let (speed, came) = (dot(&relative, &touch.normal), -dot(&coming, &touch.normal));
        let slide = contact.along(&relative);
        // How the node moved beside the surface at the start, and by how much the surface changed its own motion since.
        let surface: [f64; D] = core::array::from_fn(|d| 2.0 / h * (touch.carried[d] - x0[d]) - touch.velocity[d]);
        let beside: [f64; D] = core::array::from_fn(|d| v0[d] - surface[d]);
        let turned: [f64; D] = core::array::from_fn(|d| touch.velocity[d] - surface[d]);
        let still =
            |displacement: f64, own: f64| displacement.abs() <= MOVES_ALONG * own.abs() + SMALL * ending.extent / h;
        let size = |vector: &[f64; D]| dot(vector, vector).sqrt();

        // Along the normal: what the node brings is lost, or a part of it returns; no surface pulls.
        // A node that has come to the surface exactly, where nothing had to hold it, meets it now.
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

        // Along the surface.
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
            // Friction stops a slide at most.
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

    /// Ends what is remembered along a direction.
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
