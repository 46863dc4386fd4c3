//! Bodies between moving obstacles that leave them no room.

use crate::selection::extent;
use crate::world::{Warning, World};
use opruga_core::contacts::Contacts as _;
use opruga_math::words::number;

/// The code of the warning.
const NO_ROOM: &str = "contact.no_room";

/// A node this much deeper in an obstacle than its surface, in sizes of its body, is no longer held by it: implicit rules let nodes
/// in a little.
const DEEP: f64 = 1e-3;

/// A step so short that obstacles hardly move in it [s].
const INSTANT: f64 = 1e-9;

impl<const D: usize> World<D> {
    /// Warns of a body of which free nodes touch one obstacle and lie inside another, which happens where obstacles that are led
    /// meet or pass one another: no place for the nodes is right then. Counted per frame and body.
    ///
    /// Obstacles that stand still are looked at once, before the first frame. Nothing is allocated unless there is a warning.
    pub(crate) fn warn_of_crushed_bodies(&mut self) {
        let Some(colliders) = self.colliders.clone().filter(|c| c.any_moves()) else { return };
        if self.blueprint.colliders.len() < 2 {
            return;
        }
        let time = self.time();
        for body in 0..self.blueprint.bodies.len() {
            if self.handle(body).is_none() {
                continue;
            }
            let (low, high) = extent(&self.blueprint.bodies[body].mesh);
            let size = (0..D).map(|a| high[a] - low[a]).fold(0.0, |m, x| if x > m { x } else { m });
            let mut worst: Option<(f64, u32, usize, usize)> = None;
            for node in 0..self.node_count(body) as u32 {
                let x = self.position(body, node);
                let mut deepest: Option<(f64, usize)> = None;
                let mut other: Option<usize> = None;
                colliders.touch(&x, &x, time, INSTANT, DEEP * size, &mut |touch| {
                    let collider = colliders.collider_of(touch.surface);
                    match deepest {
                        Some((gap, known)) if touch.gap >= gap => {
                            if collider != known {
                                other = Some(collider);
                            }
                        }
                        Some((_, known)) if collider != known => {
                            (deepest, other) = (Some((touch.gap, collider)), Some(known))
                        }
                        _ => deepest = Some((touch.gap, collider)),
                    }
                });
                let Some(((gap, inside), touched)) = deepest.zip(other) else { continue };
                if gap < -DEEP * size && worst.is_none_or(|(most, ..)| -gap > most) {
                    worst = Some((-gap, node, inside, touched));
                }
            }
            let Some((depth, node, inside, touched)) = worst else { continue };
            // What is held goes where it is led.
            if self.held_nodes(body).binary_search(&node).is_ok() {
                continue;
            }
            match self.warnings.iter_mut().find(|w| w.code == NO_ROOM) {
                Some(warning) => warning.count += 1,
                None => {
                    let kind = |collider: usize| self.blueprint.colliders[collider].values.kind();
                    let message = format!(
                        "at t = {} s obstacles {inside} ({}) and {touched} ({}) left body `{}` no room: node {node} lay {} m \
                         inside the first, counted per frame and body; obstacles that are led must not meet",
                        number(time),
                        kind(inside),
                        kind(touched),
                        self.blueprint.bodies[body].name,
                        number(depth),
                    );
                    self.warnings.push(Warning { code: NO_ROOM.into(), message, count: 1 });
                }
            }
        }
    }
}
