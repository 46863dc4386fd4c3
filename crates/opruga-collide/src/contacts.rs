//! The contact of the nodes of a tile with all colliders.

use crate::active_nodes::{ActiveNodes, Meets};
use crate::bounds::Bounds;
use crate::collider::{Collider, Part};
use crate::facet_contacts::{Placed, hold_back_by_facets};
use crate::motion::Frame;
use crate::pass::Pass;
use crate::picture::{Picture, picture};
use crate::refusals::Refused;
use crate::touch::{Faces, NodePath};
use core::any::Any;
use opruga_core::contacts::{Contacts, Moved, Touch};
use opruga_core::spec::Values;
use opruga_core::tile::TILE;
use opruga_math::{Lane, Simd, WIDTH};
use std::sync::Arc;

// This is never inlined into other crates, because they would then compile all passes again.
#[inline(never)]
fn of_the_plane(colliders: Arc<Colliders<2>>) -> Arc<dyn Contacts<2>> {
    colliders
}
#[inline(never)]
fn of_space(colliders: Arc<Colliders<3>>) -> Arc<dyn Contacts<3>> {
    colliders
}

/// The rigid obstacles of a world. Cloning shares them.
#[derive(Clone, Debug)]
pub struct Colliders<const D: usize> {
    all: Arc<[Collider<D>]>,
    /// Whether colliders with faces do not hold nodes, because the surfaces of bodies meet these faces like the faces of other bodies.
    without_faces: bool,
}

impl<const D: usize> Colliders<D> {
    /// Builds colliders from their parameters, in order; their [`Values`] determine the kind of each.
    ///
    /// # Errors
    /// [`Refused`] with the index of the collider, the offending value and the allowed values: a normal or capsule without
    /// direction, an empty box, a flat hull, a degenerate facet, the number of a point that does not exist, a thickness that
    /// leaves no space.
    pub fn build(values: &[Values]) -> Result<Colliders<D>, Refused> {
        let mut colliders = Vec::with_capacity(values.len());
        for (index, values) in values.iter().enumerate() {
            colliders.push(Collider::build(values).map_err(|source| Refused { index, source })?);
        }
        Ok(Colliders { all: colliders.into(), without_faces: false })
    }
    /// Returns the same colliders, except that colliders with faces do not hold nodes. Surfaces keep their numbers.
    pub fn without_faces(&self) -> Colliders<D> {
        Colliders { all: Arc::clone(&self.all), without_faces: true }
    }
    /// Whether a collider holds nodes.
    fn holds(&self, collider: &Collider<D>) -> bool {
        !(self.without_faces && collider.has_faces())
    }
    /// The colliders as the contacts of a system.
    pub fn into_contacts(self: Arc<Self>) -> Arc<dyn Contacts<D>> {
        // This calls functions that are not generic, so that the passes are compiled once, with this crate.
        let any: Arc<dyn Any + Send + Sync> = self.clone();
        let contacts: Option<Box<dyn Any>> = match any.downcast::<Colliders<2>>() {
            Ok(plane) => Some(Box::new(of_the_plane(plane))),
            Err(any) => any.downcast::<Colliders<3>>().ok().map(|space| Box::new(of_space(space)) as Box<dyn Any>),
        };
        match contacts.map(|c| c.downcast::<Arc<dyn Contacts<D>>>()) {
            Some(Ok(contacts)) => *contacts,
            _ => unreachable!("there are colliders in two and three dimensions only"),
        }
    }
    /// The number of colliders.
    pub fn len(&self) -> usize {
        self.all.len()
    }
    /// Whether there are no colliders.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
    /// Whether any collider moves.
    pub fn any_moves(&self) -> bool {
        self.all.iter().any(|collider| !collider.is_static())
    }
    /// Whether any collider may touch something that stays within the box with the corners `min` and `max` [m] from `time0` to `time1` [s]. If a
    /// collider may touch it, the function returns true. It may also return true although no collider does.
    pub fn reach(&self, time0: f64, time1: f64, min: &[f64; D], max: &[f64; D]) -> bool {
        (0..self.len()).any(|collider| self.one_reaches(collider, time0, time1, min, max))
    }
    /// Whether a given collider may touch something that stays within a box, as [`Self::reach`] does for all of them.
    pub fn one_reaches(&self, collider: usize, time0: f64, time1: f64, min: &[f64; D], max: &[f64; D]) -> bool {
        let collider = &self.all[collider];
        let reach = collider.reach(time0, time1);
        collider.parts.iter().any(|part| collider.may_touch(part, &reach, min, max))
    }
    /// The collider that a surface belongs to; surfaces are numbered part by part.
    pub fn collider_of(&self, surface: usize) -> usize {
        let mut parts = 0;
        let behind = |collider: &Collider<D>| {
            parts += collider.parts.len();
            parts > surface
        };
        self.all.iter().position(behind).unwrap_or(0)
    }
    /// A collider by its number.
    pub(crate) fn collider(&self, number: usize) -> &Collider<D> {
        &self.all[number]
    }
    /// The colliders at a time [s], in order, for drawing.
    pub fn pictures(&self, time: f64) -> Vec<Picture<D>> {
        self.all.iter().map(|collider| picture(collider, time)).collect()
    }
    /// Whether there are several parts, at least one of them a solid with edges, so that there may be seams.
    fn has_seams(&self) -> bool {
        let parts = || self.all.iter().filter(|collider| self.holds(collider)).flat_map(|collider| &collider.parts);
        parts().nth(1).is_some() && parts().any(Part::has_edges)
    }
    /// Whether several parts, at least one of them a solid with edges, are so close to the nodes of a tile that nodes may move
    /// from one to another.
    fn has_seams_in(&self, moved: &Moved<D>, space: &[[f64; D]; 2]) -> bool {
        let (mut count, mut edges) = (0, false);
        for collider in self.all.iter().filter(|collider| self.holds(collider)) {
            let sweep = collider.sweep(moved.time, moved.h, space);
            for part in collider.parts.iter().filter(|part| collider.may_touch(part, &sweep, &space[0], &space[1])) {
                count += 1;
                edges |= part.has_edges();
            }
        }
        count > 1 && edges
    }
    /// Whether there is only one half-space. With a single half-space, one pass over all nodes is enough, and no bounds are needed.
    fn is_simple(&self) -> bool {
        matches!(&*self.all, [one] if matches!(&*one.parts, [Part::HalfSpace(_)]))
    }
}

impl<const D: usize> Contacts<D> for Colliders<D> {
    fn touch(&self, from: &[f64; D], to: &[f64; D], time: f64, h: f64, reach: f64, visit: &mut dyn FnMut(Touch<D>)) {
        let (mut low, mut high) = (*from, *from);
        for d in 0..D {
            low[d] = to[d].smaller(low[d]);
            high[d] = to[d].larger(high[d]);
            low[d] -= reach.abs();
            high[d] += reach.abs();
        }
        let in_reach = |collider: &Collider<D>| {
            let sweep = collider.sweep(time, h, &[low, high]);
            self.holds(collider) && collider.parts.iter().any(|part| collider.may_touch(part, &sweep, &low, &high))
        };
        let mut path = NodePath { from, to, kept: *to, faces: Faces::NONE, time, h, reach };
        if self.has_seams() {
            self.all.iter().filter(|collider| in_reach(collider)).for_each(|collider| path.keep(collider));
        }
        let mut first = 0;
        for collider in self.all.iter() {
            let numbers = first..first + collider.parts.len();
            first = numbers.end;
            if in_reach(collider) {
                path.touch(collider, numbers, visit);
            }
        }
    }
    fn resolve(&self, simd: Simd, moved: &mut Moved<D>) -> u8 {
        let used = moved.padding_start.min(moved.range.end).saturating_sub(moved.range.start);
        if used == 0 {
            return 0;
        }
        // Colliders that are far from this box around the nodes are skipped.
        let simple = self.is_simple();
        let mut space = if simple { None } else { Some(simd.run(Bounds { moved, used })) };
        let (mut active, mut ever) = (ActiveNodes([0; TILE / WIDTH]), false);
        // First apply only the surfaces that nodes were on. If a node slides from one solid onto a second one, the first solid
        // then holds it until it is on the second, and the node does not hit the side of the second. Then apply all colliders
        // more than once, because one may push a node into another.
        let seams = self.has_seams() && space.as_ref().is_some_and(|space| self.has_seams_in(moved, space));
        let first = seams.then_some(Meets::WhatItLiesOn);
        for meets in first.into_iter().chain([Meets::Everything; ROUNDS]) {
            let mut touched = false;
            for collider in self.all.iter().filter(|collider| self.holds(collider)) {
                let mut frame = None;
                for part in &collider.parts {
                    if let Some(space) = &space
                        && !collider.may_touch(part, &collider.sweep(moved.time, moved.h, space), &space[0], &space[1])
                    {
                        continue;
                    }
                    let frame = match &collider.still {
                        Some(frame) => frame,
                        None => frame.get_or_insert_with(|| Frame::new(&collider.motion, moved.time, moved.h)),
                    };
                    if hold_back(simd, part, collider, frame, moved, &mut active, used, meets) {
                        touched = true;
                        // A node may have been pushed out of the box.
                        if !simple {
                            space = Some(simd.run(Bounds { moved, used }));
                        }
                    }
                }
            }
            ever |= touched;
            if simple || !touched && meets == Meets::Everything {
                break;
            }
        }
        if ever { active.0.iter().fold(0, |all, bits| all | bits) } else { 0 }
    }
}

/// The largest number of rounds of the colliders in a step.
const ROUNDS: usize = 4;

/// Applies one part of a collider to the nodes of a tile; returns whether it touched any.
#[allow(clippy::too_many_arguments)]
fn hold_back<const D: usize>(
    simd: Simd,
    part: &Part<D>,
    collider: &Collider<D>,
    frame: &Frame<D>,
    moved: &mut Moved<D>,
    active: &mut ActiveNodes,
    used: usize,
    meets: Meets,
) -> bool {
    let (law, Frame { pose, carry }) = (&collider.law, frame);
    match part {
        Part::HalfSpace(shape) => {
            simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, active, used, meets })
        }
        // Round shapes only push nodes away.
        Part::Ball(_) | Part::Capsule(_) if meets == Meets::WhatItLiesOn => false,
        Part::Ball(shape) => simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, active, used, meets }),
        Part::Capsule(shape) => {
            simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, active, used, meets })
        }
        Part::Cuboid(shape) => {
            simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, active, used, meets })
        }
        Part::Facets(facets) => {
            hold_back_by_facets(&Placed { facets, pose, margin: law.thickness }, law, carry, moved, active, used, meets)
        }
    }
}
