//! The picture of a world, and arrows over it.

use super::{Engine, Living, has_drawings};
use crate::normals::normals;
use crate::shown::Show;
use opruga::draw::{ArrowKind, ArrowPicture, Facets};
use opruga::pictures::{Quantity, Scenery};

/// The largest number of bodies for which arrows are drawn; with more, the arrows could not be distinguished.
const MOST_WITH_ARROWS: usize = 64;

impl Living {
    /// Makes the picture of the world.
    pub(super) fn picture(&mut self, show: &Show) -> opruga::draw::Picture {
        let bodies = self.world.scene().body_count();
        if bodies != self.known {
            (self.scenery, self.known) = (Scenery::new(&*self.world), bodies);
        }
        let as_drawn = show.own_colours && has_drawings(&*self.world);
        let quantity = if as_drawn { Quantity::Plain } else { show.quantity };
        let moment = self.scenery.capture_quantity(&mut *self.world, show.arrows, quantity);
        let mut picture = self.scenery.picture(&moment);
        if let Some(legend) = &mut picture.legend {
            legend.map = show.map;
        }
        let flat = self.dimension() == 2;
        if !show.springs {
            picture.bodies.iter_mut().for_each(|body| {
                if flat && !body.cells.is_empty() || !matches!(&body.facets, Facets::Edges(e) if e.is_empty()) {
                    body.segments.clear();
                }
            });
        }
        if show.vertices {
            for body in &mut picture.bodies {
                body.nodes_drawn = body.positions.len() <= 20_000;
                body.node_spacing = None;
            }
        }
        self.add_arrows(&mut picture, show);
        picture
    }

    /// Adds the arrows that the user wants to see, and marks the nodes that are pinned now, because some pins of the scene may have been released.
    pub(super) fn add_arrows(&mut self, picture: &mut opruga::draw::Picture, show: &Show) {
        let living = self.world.bodies();
        if living.len() > MOST_WITH_ARROWS {
            return;
        }
        let mut arrows = Vec::new();
        for (index, &body) in living.iter().enumerate() {
            let nodes = self.world.node_count(body);
            if let Some(seen) = picture.bodies.get_mut(index).filter(|seen| !seen.pinned.is_empty()) {
                seen.pinned = self.world.pinned_now(body);
            }
            let forces = if show.contacts { self.world.contact_forces(body) } else { Vec::new() };
            let (x, v) = (self.world.positions(body), self.world.velocities(body));
            let some = (0..nodes).step_by((nodes / 40).max(1));
            if show.velocities {
                arrows.extend(some.clone().map(|node| (ArrowKind::Velocity, x.at(node), v.at(node))));
            }
            if show.normals
                && let Some(seen) = picture.bodies.get(index).filter(|seen| seen.positions.len() == nodes)
            {
                let normals = normals(seen);
                arrows.extend(some.map(|node| (ArrowKind::Normal, x.at(node), normals[node])));
            }
            let pressed = forces.into_iter().enumerate().filter(|(_, force)| force.iter().any(|f| *f != 0.0));
            arrows.extend(pressed.map(|(node, force)| (ArrowKind::Contact, x.at(node), force)));
        }
        let arrows = arrows.into_iter().filter(|(_, _, vector)| vector.iter().all(|c| c.is_finite()));
        picture.arrows.extend(arrows.map(|(kind, from, vector)| ArrowPicture { kind, from, vector }));
    }
}
