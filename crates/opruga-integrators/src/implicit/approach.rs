//! How far a correction may lead towards obstacles where no inertia holds it back.

use super::balance::Balance;
use super::contact::{Contact, Contacting};
use super::room::Room;
use super::sight::Sight;
use opruga_core::contacts::Touch;
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

/// How often a body is moved as a whole out of what it begins in, at most: from surface to surface.
const MOST_LIFTS: u32 = 32;

/// The depth in which no node may be left where forces balance, in extents of the body.
const LEFT: f64 = 1e-6;

/// Where no pin holds a body that begins deep in obstacles, the iteration begins with the body as a whole out of them, in
/// `room.u`: put onto the surface one by one, nodes that are deep inside would tear it.
pub(crate) fn lift_out<const D: usize>(system: &System<D>, room: &mut Room<D>, h: f64) {
    if system.contacts.is_none() || room.held.iter().any(|way| !way.is_nan()) {
        return;
    }
    let mut lift = [0.0; D];
    for count in 0..MOST_LIFTS {
        let deep = if count == 0 { CAUGHT * room.extent } else { 0.0 };
        let Some(touch) = deepest(system, room, &|_, d| lift[d], h).filter(|touch| touch.gap < -deep) else {
            for u in room.u.as_chunks_mut::<D>().0 {
                *u = lift;
            }
            return;
        };
        for d in 0..D {
            lift[d] -= touch.gap * touch.normal[d];
        }
    }
    // Between obstacles there is no room for the whole: it begins where it is.
}

/// Whether the displacement in `room.u` leaves a node in an obstacle that nothing else holds: one that changed sides too often.
pub(crate) fn leaves_nodes_inside<const D: usize>(system: &System<D>, room: &Room<D>, h: f64) -> bool {
    let most = LEFT * room.extent;
    deepest(system, room, &|node, d| room.u[node * D + d], h).is_some_and(|touch| touch.gap < -most)
}

/// The deepest place of a node that no pin holds, at the displacements that `way` tells of nodes and axes; none where all are outside.
fn deepest<const D: usize>(
    system: &System<D>,
    room: &Room<D>,
    way: &dyn Fn(usize, usize) -> f64,
    h: f64,
) -> Option<Touch<D>> {
    let obstacles = system.contacts.as_ref()?;
    let mut deepest: Option<Touch<D>> = None;
    for (node, (from, held)) in nodes::<D>(&room.x0).iter().zip(nodes::<D>(&room.held)).enumerate() {
        if held.iter().any(|way| !way.is_nan()) {
            continue;
        }
        let at: [f64; D] = core::array::from_fn(|d| from[d] + way(node, d));
        obstacles.touch(&at, &at, system.time + h, h, 0.0, &mut |touch| {
            if touch.gap < -touch.rounding && deepest.is_none_or(|other| touch.gap < other.gap) {
                deepest = Some(touch);
            }
        });
    }
    deepest
}

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
