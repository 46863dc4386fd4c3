//! Bodies between moving obstacles that leave no space for them.

use crate::selection::longest_side;
use crate::warnings::{Lay, Warning, WorldWarning};
use crate::world::World;
use opruga_core::contacts::Contacts as _;
use opruga_mesh::Measure;

/// The code of the warning.
const CODE: &str = "contact.no_room";

/// The depth of a node inside an obstacle, relative to the size of its body, beyond which the obstacle no longer holds it. Implicit integrators allow
/// a small penetration.
const DEEP: f64 = 1e-3;

/// Two obstacles that touch leave no space between them if −cos of the angle between their outer normals is above this.
const OPPOSITE: f64 = 0.999;

/// A step so short that obstacles hardly move in it [s].
const INSTANT: f64 = 1e-9;

/// The node of a body that lies deepest between two obstacles.
struct Squeezed {
    /// Its depth in the first obstacle [m].
    depth: f64,
    node: u32,
    inside: usize,
    touched: usize,
}

impl<const D: usize> World<D> {
    /// Warns about a body with free nodes that touch one obstacle and lie inside another, or that lie between two obstacles whose surfaces meet
    /// there. This happens if moving obstacles meet or pass one another: no position of the nodes is then valid. The warning counts frames and
    /// bodies. A sheet in space or a wire has no thickness and may lie between surfaces that meet.
    ///
    /// Obstacles at rest are checked once, before the first frame. Nothing is allocated unless there is a warning.
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
            let size = longest_side(&self.blueprint.bodies[body].mesh);
            let thick = match self.blueprint.bodies[body].mesh.measure() {
                Ok(Measure::Volume(_)) => true,
                Ok(Measure::Area(_)) => D == 2,
                _ => !self.blueprint.bodies[body].mesh.facets.is_empty(),
            };
            let mut worst: Option<Squeezed> = None;
            for node in 0..self.node_count(body) as u32 {
                let x = self.position(body, node);
                let mut deepest: Option<(f64, usize, [f64; D])> = None;
                let mut other: Option<(f64, usize, [f64; D])> = None;
                colliders.touch(&x, &x, time, INSTANT, DEEP * size, &mut |touch| {
                    let this = (touch.gap, colliders.collider_of(touch.surface), touch.normal);
                    match deepest {
                        Some((_, known, _)) if known == this.1 => {
                            if this.0 < deepest.map_or(f64::INFINITY, |deepest| deepest.0) {
                                deepest = Some(this);
                            }
                        }
                        Some((gap, ..)) if this.0 >= gap => other = Some(this),
                        _ => (deepest, other) = (Some(this), deepest.or(other)),
                    }
                });
                let Some(((gap, inside, out), (other_gap, touched, back))) = deepest.zip(other) else { continue };
                let opposite = -(0..D).map(|d| out[d] * back[d]).sum::<f64>() > OPPOSITE;
                let met = thick && opposite && gap + other_gap <= DEEP * size;
                if (gap < -DEEP * size || met) && worst.as_ref().is_none_or(|most| -gap > most.depth) {
                    worst = Some(Squeezed { depth: -gap, node, inside, touched });
                }
            }
            let Some(Squeezed { depth, node, inside, touched }) = worst else { continue };
            // Pinned nodes follow their pins.
            if self.pinned_nodes(body).binary_search(&node).is_ok() {
                continue;
            }
            match self.warnings.iter_mut().find(|w| w.code == CODE) {
                Some(warning) => warning.count += 1,
                None => {
                    let kind = |collider: usize| self.blueprint.colliders[collider].values.kind().to_string();
                    let warning = WorldWarning::NoRoom {
                        time,
                        first: inside,
                        first_kind: kind(inside),
                        second: touched,
                        second_kind: kind(touched),
                        body: self.blueprint.bodies[body].name.clone(),
                        node,
                        lay: if depth > DEEP * size { Lay::Inside { depth } } else { Lay::Between {} },
                    };
                    self.warnings.push(Warning::new(warning, 1));
                }
            }
        }
    }
}
