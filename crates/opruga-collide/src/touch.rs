//! One node and the surfaces that it has come to: what implicit integrators ask.

use crate::collider::{Collider, Law, Part};
use crate::facet_contacts::Placed;
use crate::motion::{Carry, Frame};
use crate::response::{Surface, rounding};
use crate::shape::{Shape, entry};
use crate::vector::{dot, subtract};
use core::ops::Range;
use opruga_core::contacts::Touch;

/// A node on its way through a step.
pub(crate) struct Way<'a, const D: usize> {
    pub(crate) from: &'a [f64; D],
    pub(crate) to: &'a [f64; D],
    pub(crate) time: f64,
    pub(crate) h: f64,
    /// The largest gap that matters [m].
    pub(crate) reach: f64,
}

/// What the way looks like from a collider.
struct Seen<'a, const D: usize> {
    to: &'a [f64; D],
    /// Where the node began, carried along with the collider.
    carried: [f64; D],
    law: &'a Law,
    reach: f64,
}

impl<const D: usize> Way<'_, D> {
    /// Calls back with the surfaces of a collider that the node has come to; they are numbered from `first` on.
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
        let seen = Seen { to: self.to, carried: carry.along(self.from), law: &collider.law, reach: self.reach };
        for (part, number) in collider.parts.iter().zip(numbers) {
            let found = match part {
                Part::HalfSpace(shape) => seen.solid(&shape.posed(pose)),
                Part::Ball(shape) => seen.solid(&shape.posed(pose)),
                Part::Capsule(shape) => seen.solid(&shape.posed(pose)),
                Part::Cuboid(shape) => seen.solid(&shape.posed(pose)),
                Part::Facets(facets) => {
                    let placed = Placed { facets, pose, margin: collider.law.thickness };
                    let (gap, normal) = placed.find(self.to, &seen.carried, self.reach);
                    // The side from which the node comes is that on which it is held.
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
                    rounding: rounding(&collider.law, self.to),
                });
            }
        }
    }
}

impl<const D: usize> Seen<'_, D> {
    /// Gap, gap before and normal of a solid, if it is in reach or was crossed.
    fn solid<T: Shape<D>>(&self, shape: &T) -> Option<(f64, f64, [f64; D])> {
        let (gap, normal) = shape.gap_and_normal(self.to);
        let mut found = (gap - self.law.thickness, normal);
        let way = subtract(self.to, &self.carried);
        let far = 0.5 * shape.half_width();
        if far < dot(&way, &way).sqrt()
            && let Some(entered) = entry(shape, self.law.thickness, &self.carried, self.to)
        {
            found = entered;
        }
        let before = shape.gap(&self.carried) - self.law.thickness;
        (found.0 <= self.reach).then_some((found.0, before, found.1))
    }
}
