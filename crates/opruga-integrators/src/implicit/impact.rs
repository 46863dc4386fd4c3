//! What obstacles do at the end of a step: nodes that are inside nevertheless, velocities, and the ledger.

use super::contact::{Contacting, Hold, SMALL, dot, split};
use super::newton::Balance;
use opruga_core::contacts::Touch;
use opruga_core::system::System;
use opruga_math::WIDTH;
use opruga_solve::blocks::nodes;

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

    /// Ends a step: enters the work of the forces that held nodes (`reaction`), and deals with velocities; `v0` and
    /// `v1` are those at its ends. Returns through `struck` the nodes that met a surface in this step.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn end(
        &mut self,
        system: &mut System<D>,
        mass: &[f64],
        reaction: &[f64],
        x0: &[f64],
        v0: &[f64],
        balance: &Balance,
        v1: &mut [f64],
        struck: &mut Vec<usize>,
    ) {
        struck.clear();
        let mut first = 0;
        while first < self.contacts.len() {
            let node = self.contacts[first].node;
            let mut last = first;
            while last < self.contacts.len() && self.contacts[last].node == node {
                last += 1;
            }
            let at = node * D;
            let force: [f64; D] = core::array::from_fn(|d| reaction[at + d]);
            let normal_forces = split(&self.contacts[first..last], &force);
            let (lane, mass) = (node % WIDTH, mass[node]);
            let mut rest = force;
            let mut carrier = None;
            let before: [f64; D] = core::array::from_fn(|d| v1[at + d]);
            for (k, contact) in self.contacts[first..last].iter().enumerate().filter(|(_, c)| c.is_held()) {
                let touch = &contact.touch;
                let ride: [f64; D] = core::array::from_fn(|d| touch.carried[d] - x0[at + d]);
                // The work of a force that is the same through the step, by the mean velocity: what it changes of the motion.
                let mean: [f64; D] = core::array::from_fn(|d| 0.5 * balance.h * (v0[at + d] + before[d]));
                let own: [f64; D] = core::array::from_fn(|d| mean[d] - ride[d]);
                // The force of an impact acts in this step alone.
                let share = if touch.gap_before > touch.rounding { balance.impulse } else { 1.0 };
                let normal_force = share * normal_forces[k.min(D - 1)];
                for d in 0..D {
                    rest[d] -= normal_forces[k.min(D - 1)] * touch.normal[d];
                }
                system.work.user[lane] += normal_force * dot(&touch.normal, &ride);
                system.work.contact[lane] -= normal_force * dot(&touch.normal, &own);
                carrier = carrier.or(Some((ride, own, share)));

                // What the node brings along the normal is lost, or a part of it returns.
                let velocity: [f64; D] = core::array::from_fn(|d| v1[at + d] - touch.velocity[d]);
                let coming: [f64; D] = core::array::from_fn(|d| v0[at + d] - touch.velocity[d]);
                let (speed, came) = (dot(&velocity, &touch.normal), -dot(&coming, &touch.normal));
                let bounces = came > touch.rest_speed && touch.gap_before > touch.rounding;
                let back = if bounces { touch.restitution * came } else { 0.0 };
                let mut gained: [f64; D] = core::array::from_fn(|d| (back - speed) * touch.normal[d]);
                let lost = 0.5 * mass * (speed * speed - back * back);
                let mut rubbed = 0.0;
                if contact.hold == Hold::Stick {
                    let slide = contact.along(&velocity);
                    rubbed = 0.5 * mass * dot(&slide, &slide);
                    for d in 0..D {
                        gained[d] -= slide[d];
                    }
                }
                system.work.contact[lane] += lost;
                system.work.friction[lane] += rubbed;
                system.work.user[lane] += mass * dot(&gained, &touch.velocity);
                for d in 0..D {
                    v1[at + d] += gained[d];
                }
                if touch.gap_before > touch.rounding && struck.last() != Some(&node) {
                    struck.push(node);
                }
            }
            if let Some((ride, own, share)) = carrier {
                system.work.user[lane] += share * dot(&rest, &ride);
                system.work.friction[lane] -= share * dot(&rest, &own);
            }
            first = last;
        }
    }
}
