//! The picture of a world, and arrows over it.

use super::{Living, has_drawings, three};
use crate::normals::normals;
use crate::shown::Show;
use opruga::draw::{ArrowKind, ArrowPicture, Facets};
use opruga::pictures::{Quantity, Scenery};

/// Bodies up to which arrows are drawn: those of more could not be told apart.
const MOST_WITH_ARROWS: usize = 64;

impl<const D: usize> Living<D> {
    /// What there is to see.
    pub(super) fn picture(&mut self, show: &Show) -> opruga::draw::Picture {
        let bodies = self.world.blueprint().bodies.len();
        if bodies != self.known {
            (self.scenery, self.known) = (Scenery::new(&self.world), bodies);
        }
        let as_drawn = show.own_colours && has_drawings(&self.world);
        let quantity = if as_drawn { Quantity::Plain } else { show.quantity };
        let moment = self.scenery.capture_quantity(&mut self.world, show.arrows, quantity);
        let mut picture = self.scenery.picture(&moment);
        if let Some(legend) = &mut picture.legend {
            legend.map = show.map;
        }
        if !show.springs {
            picture.bodies.iter_mut().for_each(|body| {
                if D == 2 && !body.cells.is_empty() || !matches!(&body.facets, Facets::Edges(e) if e.is_empty()) {
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

    /// The arrows that a person wants to see, and the nodes that are held now: those of the scene may have been freed.
    pub(super) fn add_arrows(&mut self, picture: &mut opruga::draw::Picture, show: &Show) {
        let living: Vec<usize> = self.world.bodies().collect();
        if living.len() > MOST_WITH_ARROWS {
            return;
        }
        let mut arrows = Vec::new();
        for (place, &body) in living.iter().enumerate() {
            let nodes = self.world.node_count(body) as u32;
            if let Some(seen) = picture.bodies.get_mut(place).filter(|seen| !seen.pinned.is_empty()) {
                seen.pinned = self.world.held_nodes(body);
            }
            let forces = if show.contacts { self.world.contact_forces(body) } else { Vec::new() };
            let at = |node: u32| three(self.world.position(body, node));
            let some = (0..nodes).step_by((nodes / 40).max(1) as usize);
            if show.velocities {
                arrows.extend(
                    some.clone().map(|node| (ArrowKind::Velocity, at(node), three(self.world.velocity(body, node)))),
                );
            }
            if show.normals
                && let Some(seen) = picture.bodies.get(place).filter(|seen| seen.positions.len() == nodes as usize)
            {
                let normals = normals(seen);
                arrows.extend(some.map(|node| (ArrowKind::Normal, at(node), normals[node as usize])));
            }
            let pressed = forces.into_iter().enumerate().filter(|(_, force)| force.iter().any(|f| *f != 0.0));
            arrows.extend(pressed.map(|(node, force)| (ArrowKind::Contact, at(node as u32), three(force))));
        }
        let arrows = arrows.into_iter().filter(|(_, _, vector)| vector.iter().all(|c| c.is_finite()));
        picture.arrows.extend(arrows.map(|(kind, from, vector)| ArrowPicture { kind, from, vector }));
    }
}
