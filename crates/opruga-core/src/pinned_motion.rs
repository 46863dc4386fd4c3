//! What pins do to the motion of a system: they put nodes where they have to be, and their work is entered.

use crate::system::{Stage, System};
use core::ops::Range;
use opruga_math::WIDTH;

impl<const D: usize> System<D> {
    /// Tells the ledger how far pins move in the step of `h` that comes.
    pub fn lead_pins(&mut self, h: f64) {
        self.pinned_nodes.learn(&self.pins, self.time, h);
    }

    /// Gives pinned nodes the velocity of their path at the start of a frame, where they have another: at the start of a run, or where a
    /// command has just taken hold of them. Dampers between them and their neighbours would act for a step by a motion that ended with
    /// the hold, which costs every rule its order. What that changes of the kinetic energy is work of the pins. Where a mass matrix
    /// couples nodes it is an impulse on others too, and is left to the rule.
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

    /// Puts pinned nodes where they are prescribed to be, at the velocity of their path there; where a mass matrix couples them
    /// to others they keep the one that the step has given them, since a change of it is an impulse on those too.
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

    /// Takes the kinetic energy along pinned axes from the work of the pins: what they find.
    pub(crate) fn take_pinned_motion(&mut self, range: Range<usize>) {
        self.add_pinned_motion(range, -0.5);
    }

    /// Adds the kinetic energy along pinned axes to the work of the pins: what they leave.
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
