//! How far a correction may lead towards obstacles where no inertia holds it back.

use super::contact::{Contact, Contacting};
use super::contact_derivatives::Sight;
use super::newton::Balance;
use super::room::Room;
use opruga_core::system::System;
use opruga_math::Lane;
use opruga_solve::blocks::nodes;

/// The longest correction of a node in statics, in extents of the body.
const LONGEST: f64 = 0.5;

/// The depth in which nodes are caught, in extents of the body: whole rows of nodes behind a surface, all of which would be put
/// onto it, are no shape to go on from.
const CAUGHT: f64 = 1e-3;

/// Bisections of the part, so that half the extent is divided more finely than `CAUGHT`.
const BISECTIONS: usize = 12;

/// The part of the step in `room.step`, whose longest way is `longest`, that is gone at most in statics: it is not longer than the
/// body, nor does it lead through obstacles.
pub(super) fn part_without_inertia<const D: usize>(
    system: &System<D>,
    room: &Room<D>,
    balance: &Balance,
    longest: f64,
) -> f64 {
    let part = (LONGEST * room.extent / longest).smaller(1.0);
    if system.contacts.is_none() {
        return part;
    }
    let step: Vec<f64> = room.step.iter().map(|s| part * s).collect();
    let sight = Sight::new(system, balance, &room.x0, &room.u, room.extent);
    part * room.contacting.part_to_obstacles(&sight, &step)
}

impl<const D: usize> Contacting<D> {
    /// The part of a step that ends where the first node that is not held comes into an obstacle, or the whole.
    fn part_to_obstacles(&self, sight: &Sight<'_, D>, step: &[f64]) -> f64 {
        if !self.comes_in(sight, step, 1.0) {
            return 1.0;
        }
        let (mut allowed, mut refused) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (allowed + refused);
            if self.comes_in(sight, step, middle) {
                refused = middle;
            } else {
                allowed = middle;
            }
        }
        allowed
    }

    /// Whether a part of a step leads a node that is not held deeper into an obstacle than it is.
    fn comes_in(&self, sight: &Sight<'_, D>, step: &[f64], part: f64) -> bool {
        let Sight { system, x0, u, theta, h, extent } = *sight;
        let Some(obstacles) = &system.contacts else { return false };
        let time = system.time + h;
        let caught = CAUGHT * extent;
        let ways = nodes::<D>(u).iter().zip(nodes::<D>(step));
        nodes::<D>(x0).iter().zip(ways).enumerate().any(|(node, (from, (u, step)))| {
            let at = |part: f64| -> [f64; D] { core::array::from_fn(|d| from[d] + (u[d] + part * step[d]) / theta) };
            let mut deep = None;
            obstacles.touch(from, &at(part), time, h, 0.0, &mut |touch| {
                let is_held = |c: &Contact<D>| c.node == node && c.touch.surface == touch.surface && c.is_held();
                if touch.gap < -caught && !self.contacts.iter().any(is_held) {
                    deep = Some(touch);
                }
            });
            let Some(deep) = deep else { return false };
            let mut before = 0.0;
            obstacles.touch(from, &at(0.0), time, h, 0.0, &mut |touch| {
                if touch.surface == deep.surface && touch.gap < before {
                    before = touch.gap;
                }
            });
            deep.gap < before - caught
        })
    }
}
