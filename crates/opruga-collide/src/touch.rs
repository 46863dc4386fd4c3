//! One node and the surfaces that it has reached, for implicit integrators.

use crate::collider::{Collider, Law, Part};
use crate::facet_contacts::Placed;
use crate::motion::{Carry, Frame};
use crate::response::{Surface, rounding};
use crate::shape::{Shape, entry, support};
use crate::vector::{dot, scaled, subtract};
use core::ops::Range;
use opruga_core::contacts::Touch;
use opruga_math::Lane;

/// The path of a node through a step.
pub(crate) struct NodePath<'a, const D: usize> {
    pub(crate) from: &'a [f64; D],
    pub(crate) to: &'a [f64; D],
    /// The end position of the node if the surfaces that it was on hold it. This position determines which face of another solid the node meets.
    pub(crate) kept: [f64; D],
    /// The faces of solids that the position `to` is on. Where two solids adjoin, these include opposite faces.
    pub(crate) faces: Faces<D>,
    pub(crate) time: f64,
    pub(crate) h: f64,
    /// The largest relevant gap [m].
    pub(crate) reach: f64,
}

/// The normals of the faces that a point is on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Faces<const D: usize> {
    normals: [[f64; D]; MOST_FACES],
    count: usize,
}

/// The largest number of faces that are examined. In a corner of several boxes, fewer faces meet.
const MOST_FACES: usize = 16;

impl<const D: usize> Faces<D> {
    pub(crate) const NONE: Faces<D> = Faces { normals: [[0.0; D]; MOST_FACES], count: 0 };

    fn add(&mut self, normal: [f64; D]) {
        if let Some(place) = self.normals.get_mut(self.count) {
            *place = normal;
            self.count += 1;
        }
    }
    /// Whether another solid adjoins a face with this normal.
    fn covers(&self, normal: &[f64; D]) -> bool {
        self.normals[..self.count].iter().any(|other| dot(other, normal) < 1e-6 - 1.0)
    }
    /// Whether any face is covered.
    fn any_covered(&self) -> bool {
        self.normals[..self.count].iter().any(|normal| self.covers(normal))
    }
}

/// The path relative to a collider.
struct Seen<'a, const D: usize> {
    to: &'a [f64; D],
    kept: &'a [f64; D],
    faces: &'a Faces<D>,
    /// The position of the node at the start of the step, carried along with the collider [m].
    carried: [f64; D],
    law: &'a Law,
    reach: f64,
}

impl<const D: usize> NodePath<'_, D> {
    /// Lets a collider hold the node if the node was on it at the start.
    pub(crate) fn keep(&mut self, collider: &Collider<D>) {
        let frame = collider.still.unwrap_or_else(|| Frame::new(&collider.motion, self.time, self.h));
        let Frame { pose, carry } = &frame;
        let (margin, carried) = (collider.law.thickness, Carry::along(carry, self.from));
        let small = rounding(&collider.law, &carried);
        let close = rounding(&collider.law, self.to);
        let NodePath { to, kept, faces, .. } = self;
        for part in &collider.parts {
            let active = *kept != **to;
            let found = match part {
                Part::HalfSpace(shape) => support(&shape.posed(pose), margin, small, [&carried, kept], active),
                Part::Cuboid(shape) => {
                    let shape = shape.posed(pose);
                    if margin <= close {
                        let gap = shape.gap(to);
                        if gap.abs() <= close {
                            shape.visit_faces(to, close, &mut |_, normal| faces.add(normal));
                        }
                    }
                    support(&shape, margin, small, [&carried, kept], active)
                }
                Part::Facets(facets) if facets.solid => {
                    let (end, grain) = (pose.inverse_transform(to), facets.grain().larger(close));
                    if margin <= grain && facets.gap(&end).abs() <= grain {
                        facets.visit_faces(&end, grain, &mut |_, normal| faces.add(pose.direct(&normal)));
                    }
                    let segment = [&pose.inverse_transform(&carried), &pose.inverse_transform(kept)];
                    support(facets, margin, small, segment, active).map(|(gap, normal)| (gap, pose.direct(&normal)))
                }
                Part::Ball(_) | Part::Capsule(_) | Part::Facets(_) => None,
            };
            if let Some((gap, normal)) = found {
                *kept = subtract(kept, &scaled(&normal, gap));
            }
        }
    }

    /// Calls `visit` with the surfaces of a collider that the node has reached; their numbers are `numbers`, one for each part.
    pub(crate) fn touch(&self, collider: &Collider<D>, numbers: Range<usize>, visit: &mut dyn FnMut(Touch<D>)) {
        let still;
        let Frame { pose, carry }: &Frame<D> = match &collider.still {
            Some(frame) => frame,
            None => {
                still = Frame::new(&collider.motion, self.time, self.h);
                &still
            }
        };
        let carry: &Carry<D> = carry;
        let seen = Seen {
            to: self.to,
            kept: &self.kept,
            faces: &self.faces,
            carried: carry.along(self.from),
            law: &collider.law,
            reach: self.reach,
        };
        for (part, number) in collider.parts.iter().zip(numbers) {
            let found = match part {
                Part::HalfSpace(shape) => seen.solid(&shape.posed(pose)),
                Part::Ball(shape) => seen.solid(&shape.posed(pose)),
                Part::Capsule(shape) => seen.solid(&shape.posed(pose)),
                Part::Cuboid(shape) => seen.solid(&shape.posed(pose)),
                Part::Facets(facets) => {
                    let placed = Placed { facets, pose, margin: collider.law.thickness };
                    let to = if facets.solid { &self.kept } else { self.to };
                    let (mut gap, mut normal) = placed.find(to, &seen.carried, self.reach);
                    if facets.solid && seen.faces.any_covered() {
                        let direct = |normal: [f64; D]| pose.direct(&normal);
                        let (from, to) = (pose.inverse_transform(&seen.carried), pose.inverse_transform(to));
                        let entered =
                            entry(facets, placed.margin, &from, &to).map(|(gap, normal)| (gap, direct(normal)));
                        if let Some(met) = entered.or_else(|| seen.open_face(facets, &to, facets.grain(), &direct)) {
                            (gap, normal) = met;
                        }
                    }
                    let gap = gap + dot(&subtract(self.to, to), &normal);
                    // The node is held on the side from which it comes.
                    let (before, _) = placed.find(&seen.carried, &seen.carried, f64::INFINITY);
                    (gap <= self.reach).then_some((gap, before, normal))
                }
            };
            if let Some((gap, gap_before, normal)) = found {
                visit(Touch {
                    surface: number,
                    gap,
                    gap_before,
                    normal,
                    carried: seen.carried,
                    velocity: pose.velocity_at(self.to),
                    friction: collider.law.friction,
                    restitution: collider.law.restitution,
                    rest_speed: collider.law.rest_speed,
                    rounding: rounding(&collider.law, self.to).larger(rounding(&collider.law, &seen.carried)),
                });
            }
        }
    }
}

impl<const D: usize> Seen<'_, D> {
    /// The gap, the gap at the start of the step, and the normal of a solid, if the solid is in reach or was crossed.
    fn solid<T: Shape<D>>(&self, shape: &T) -> Option<(f64, f64, [f64; D])> {
        let (gap, normal) = shape.gap_and_normal(self.kept);
        let mut found = (gap - self.law.thickness, normal);
        let displacement = subtract(self.kept, &self.carried);
        let far = 0.5 * shape.half_width();
        // The face through which the node entered need not be the nearest one.
        let small = rounding(self.law, self.kept);
        let margin = self.law.thickness;
        // A node exactly at the junction of two solids counts as inside both.
        let covered = T::FACES && found.0 <= small && self.faces.any_covered();
        if (covered || T::FACES && found.0 < -small || far < dot(&displacement, &displacement).sqrt())
            && let Some(entered) = entry(shape, margin, &self.carried, self.kept)
        {
            found = entered;
        } else if covered && let Some(open) = self.open_face(shape, self.kept, small, &|normal| normal) {
            found = open;
        }
        found.0 += dot(&subtract(self.to, self.kept), &found.1);
        let before = shape.gap(&self.carried) - self.law.thickness;
        (found.0 <= self.reach).then_some((found.0, before, found.1))
    }

    /// Returns the height of a point above one of the faces at this point, and the normal of this face. Where solids adjoin,
    /// faces that another solid covers do not count. Among the others, it is the face into which the path leads most directly.
    fn open_face<T: Shape<D>>(
        &self,
        shape: &T,
        x: &[f64; D],
        grain: f64,
        direct: &dyn Fn([f64; D]) -> [f64; D],
    ) -> Option<(f64, [f64; D])> {
        let displacement = subtract(self.kept, &self.carried);
        let mut most: Option<(f64, (f64, [f64; D]))> = None;
        shape.visit_faces(x, grain, &mut |height, normal| {
            let normal = direct(normal);
            let along = dot(&displacement, &normal);
            if !self.faces.covers(&normal) && most.is_none_or(|(other, _)| along < other) {
                most = Some((along, (height - self.law.thickness, normal)));
            }
        });
        most.map(|(_, face)| face)
    }
}
