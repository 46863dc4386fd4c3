//! The effect of pins on a system: they move nodes to prescribed positions, and their work is recorded in the ledger.

use crate::system::{Stage, System};
use core::ops::Range;
use opruga_math::WIDTH;

impl<const D: usize> System<D> {
    /// Records how far pins move in the coming step of length `h`.
    pub fn lead_pins(&mut self, h: f64) {
        self.pinned_nodes.learn(&self.pins, self.time, h);
    }

    /// Gives pinned nodes the velocity of their path at the start of a frame if their velocity differs from it. The velocity differs at the start of
    /// a run, or if a command has just pinned the nodes. Otherwise dampers between these nodes and their neighbours would act for one step with a
    /// velocity that no longer exists, which reduces the order of every integrator. The change of kinetic energy is work of the pins. If a mass
    /// matrix couples nodes, the change would be an impulse on other nodes too, and is left to the integrator.
    pub fn take_hold(&mut self) {
        if self.inertia.is_some() {
            return;
        }
        for pin in &self.pins {
            let (_, velocity) = pin.target(self.time);
            for d in (0..D).filter(|d| pin.axes[*d]) {
                let before = core::mem::replace(&mut self.state.v.0[d][pin.index], velocity[d]);
                if before != velocity[d] {
                    let change = 0.5 * self.mass.at(pin.index) * (velocity[d] * velocity[d] - before * before);
                    self.work.user[pin.index % WIDTH] += change;
                }
            }
        }
    }

    /// Moves pinned nodes to their prescribed positions and gives them the velocity of their path there. If a mass matrix couples these nodes to
    /// others, they keep the velocity of the step, because a change would be an impulse on the other nodes too.
    pub(crate) fn hold_pins(&mut self, stage: Stage, time: f64) {
        let (x, v) = match stage {
            Stage::Current => (&mut self.state.x, &mut self.state.v),
            Stage::Work(k) => {
                let [x, v] = &mut self.state.work[k];
                (x, v)
            }
        };
        for pin in &self.pins {
            let (position, velocity) = pin.target(time);
            for d in 0..D {
                if pin.axes[d] {
                    x.0[d][pin.index] = position[d];
                    if self.inertia.is_none() {
                        v.0[d][pin.index] = velocity[d];
                    }
                }
            }
        }
    }

    /// Subtracts the kinetic energy along pinned axes, before pins act, from the work of the pins.
    pub(crate) fn take_pinned_motion(&mut self, range: Range<usize>) {
        self.add_pinned_motion(range, -0.5);
    }

    /// Adds the kinetic energy along pinned axes, after pins have acted, to the work of the pins.
    pub(crate) fn give_pinned_motion(&mut self, range: Range<usize>) {
        self.add_pinned_motion(range, 0.5);
    }

    #[inline]
    fn add_pinned_motion(&mut self, range: Range<usize>, factor: f64) {
        if self.pins.is_empty() {
            return;
        }
        for (index, d) in self.pinned_nodes.within(&range) {
            let velocity = self.state.v.0[d][index];
            self.work.user[index % WIDTH] += factor * self.mass.at(index) * velocity * velocity;
        }
    }
}
