//! The pass over a tile of nodes.

use crate::bounds::Bounds;
use crate::collider::{Collider, Law, Part};
use crate::entries::{Found, Ways, arrays};
use crate::facet_contacts::{Placed, hold_back_by_facets};
use crate::motion::{Carry, Frame, Pose};
use crate::picture::{Picture, picture};
use crate::response::{Face, Meeting, Surface, largest_rounding, meets, respond, rounding};
use crate::shape::{Shape, close_to};
use crate::touch::{Faces, Way};
use crate::vector::{dot, subtract};
use core::any::Any;
use opruga_core::contacts::{Contacts, Moved, Touch};
use opruga_core::error::BuildError;
use opruga_core::spec::Values;
use opruga_core::tile::TILE;
use opruga_math::{Lane, Pack, RepeatStrip, Simd, Strip, StripMut, WIDTH, Work, lanes};
use std::sync::Arc;

fn of_the_plane(colliders: Arc<Colliders<2>>) -> Arc<dyn Contacts<2>> {
    colliders
}
fn of_space(colliders: Arc<Colliders<3>>) -> Arc<dyn Contacts<3>> {
    colliders
}

/// The rigid obstacles of a world. Cloning shares them.
#[derive(Clone, Debug)]
pub struct Colliders<const D: usize>(Arc<[Collider<D>]>);

impl<const D: usize> Colliders<D> {
    /// Builds colliders from their parameters, in order; the kind of each is that of its [`Values`].
    ///
    /// # Errors
    /// [`BuildError`] with the number of the collider (from 0), the offending value and what is allowed: a normal or
    /// capsule without direction, an empty box, a flat hull, a facet without extent, a number of a point that does not
    /// exist, a thickness that leaves no room.
    pub fn build(values: &[Values]) -> Result<Colliders<D>, BuildError> {
        let mut colliders = Vec::with_capacity(values.len());
        for (number, values) in values.iter().enumerate() {
            colliders.push(Collider::build(number, values)?);
        }
        Ok(Colliders(colliders.into()))
    }
    /// The colliders as what a system collides with.
    pub fn into_contacts(self: Arc<Self>) -> Arc<dyn Contacts<D>> {
        // Through functions that are not generic: the passes are compiled once, with this crate.
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
        self.0.len()
    }
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
    /// Whether any of them moves.
    pub fn any_moves(&self) -> bool {
        self.0.iter().any(|collider| !collider.is_static())
    }
    /// Whether any of them may touch something that stays between the corners `min` and `max` [m] of a box of space
    /// from `time0` to `time1` [s]. Never no where one does; it may be yes where none does.
    pub fn reach(&self, time0: f64, time1: f64, min: &[f64; D], max: &[f64; D]) -> bool {
        self.0.iter().any(|collider| {
            let reach = collider.reach(time0, time1);
            collider.parts.iter().any(|part| collider.may_touch(part, &reach, min, max))
        })
    }
    /// The collider that a surface belongs to; surfaces are numbered part by part.
    pub fn collider_of(&self, surface: usize) -> usize {
        let mut parts = 0;
        let behind = |collider: &Collider<D>| {
            parts += collider.parts.len();
            parts > surface
        };
        self.0.iter().position(behind).unwrap_or(0)
    }
    /// A collider by its number.
    pub(crate) fn collider(&self, number: usize) -> &Collider<D> {
        &self.0[number]
    }
    /// Where the colliders are at a time [s], in order.
    pub fn pictures(&self, time: f64) -> Vec<Picture<D>> {
        self.0.iter().map(|collider| picture(collider, time)).collect()
    }
    /// Whether there are solids with edges, beside which there is something else.
    fn has_seams(&self) -> bool {
        let parts = || self.0.iter().flat_map(|collider| &collider.parts);
        parts().nth(1).is_some() && parts().any(Part::has_edges)
    }
    /// Whether they are so near to the nodes of a tile that these may go from one to the other.
    fn has_seams_in(&self, moved: &Moved<D>, space: &[[f64; D]; 2]) -> bool {
        let (mut count, mut edges) = (0, false);
        for collider in self.0.iter() {
            let sweep = collider.sweep(moved.time, moved.h, space);
            for part in collider.parts.iter().filter(|part| collider.may_touch(part, &sweep, &space[0], &space[1])) {
                count += 1;
                edges |= part.has_edges();
            }
        }
        count > 1 && edges
    }
    /// One plane or ball has no corners: then one look at every node is enough, and no bounds are needed first.
    fn is_simple(&self) -> bool {
        matches!(&*self.0, [one] if matches!(&*one.parts, [Part::HalfSpace(_)]))
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
        let near = |collider: &Collider<D>| {
            let sweep = collider.sweep(time, h, &[low, high]);
            collider.parts.iter().any(|part| collider.may_touch(part, &sweep, &low, &high))
        };
        let mut way = Way { from, to, kept: *to, faces: Faces::NONE, time, h, reach };
        if self.has_seams() {
            self.0.iter().filter(|collider| near(collider)).for_each(|collider| way.keep(collider));
        }
        let mut first = 0;
        for collider in self.0.iter() {
            let numbers = first..first + collider.parts.len();
            first = numbers.end;
            if near(collider) {
                way.touch(collider, numbers, visit);
            }
        }
    }
    fn resolve(&self, simd: Simd, moved: &mut Moved<D>) -> u8 {
        let used = moved.places_used.min(moved.range.end).saturating_sub(moved.range.start);
        if used == 0 {
            return 0;
        }
        // The box around the nodes, by which colliders far away are passed over.
        let simple = self.is_simple();
        let mut space = if simple { None } else { Some(simd.run(Bounds { moved, used })) };
        let (mut held, mut ever) = (Held([0; TILE / WIDTH]), false);
        // First what nodes lay on: a node that slides from one solid onto another is held by the first one until it is on the
        // second, and does not run into the side of that. Then more than once, since one collider may push a node into another.
        let seams = self.has_seams() && space.as_ref().is_some_and(|space| self.has_seams_in(moved, space));
        let first = seams.then_some(Meets::WhatItLiesOn);
        for meets in first.into_iter().chain([Meets::Everything; ROUNDS]) {
            let mut touched = false;
            for collider in self.0.iter() {
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
                    if hold_back(simd, part, collider, frame, moved, &mut held, used, meets) {
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
        if ever { held.0.iter().fold(0, |all, bits| all | bits) } else { 0 }
    }
}

/// How often the colliders act at most in a step.
const ROUNDS: usize = 4;

/// What a node meets in a look at a collider.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meets {
    /// A surface on which it lay at the beginning of the step.
    WhatItLiesOn,
    /// Whatever it is in.
    Everything,
}

/// Which nodes of a tile have been held back in this step: a bit each.
pub(crate) struct Held(pub(crate) [u8; TILE / WIDTH]);

impl Held {
    /// The eight nodes from `k` on: 1 if held, else 0.
    #[inline(always)]
    fn pack<P: Pack>(&self, k: usize) -> P {
        let bits = self.0.get(k / WIDTH).copied().unwrap_or(0);
        let mut out = [0.0; WIDTH];
        for l in 0..WIDTH {
            out[l] = f64::from(bits >> l & 1);
        }
        P::from_array(out)
    }
    /// Notes the nodes for which `hit` is above 0.
    #[inline(always)]
    fn note<P: Pack>(&mut self, k: usize, hit: P) {
        let hit = hit.to_array();
        if let Some(bits) = self.0.get_mut(k / WIDTH) {
            for l in 0..WIDTH {
                *bits |= u8::from(hit[l] > 0.0) << l;
            }
        }
    }
}

/// Lets one part of a collider hold back the nodes of a tile; says whether it touched any.
#[allow(clippy::too_many_arguments)]
fn hold_back<const D: usize>(
    simd: Simd,
    part: &Part<D>,
    collider: &Collider<D>,
    frame: &Frame<D>,
    moved: &mut Moved<D>,
    held: &mut Held,
    used: usize,
    meets: Meets,
) -> bool {
    let (law, Frame { pose, carry }) = (&collider.law, frame);
    match part {
        Part::HalfSpace(shape) => {
            simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, held, used, meets })
        }
        // What is round pushes nowhere but away.
        Part::Ball(_) | Part::Capsule(_) if meets == Meets::WhatItLiesOn => false,
        Part::Ball(shape) => simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, held, used, meets }),
        Part::Capsule(shape) => simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, held, used, meets }),
        Part::Cuboid(shape) => simd.run(Pass { shape: shape.posed(pose), law, pose, carry, moved, held, used, meets }),
        Part::Facets(facets) => {
            hold_back_by_facets(&Placed { facets, pose, margin: law.thickness }, law, carry, moved, held, used, meets)
        }
    }
}

/// A shape with the distance that nodes keep from it.
struct Around<'a, T> {
    shape: &'a T,
    thickness: f64,
}

impl<S: Lane, T: Shape<D>, const D: usize> Surface<S, D> for Around<'_, T> {
    #[inline(always)]
    fn find(&self, x: &[S; D], _before: &[S; D], _reach: S) -> (S, [S; D]) {
        let (gap, normal) = self.shape.gap_and_normal(x);
        (gap - S::splat(self.thickness), normal)
    }
}

/// One shape against the nodes of a tile, eight at a time.
struct Pass<'a, 'm, T, const D: usize> {
    shape: T,
    law: &'a Law,
    pose: &'a Pose<D>,
    carry: &'a Carry<D>,
    moved: &'a mut Moved<'m, D>,
    held: &'a mut Held,
    used: usize,
    meets: Meets,
}

/// The columns of a tile.
struct Tile<'a, const D: usize> {
    x: StripMut<'a, D>,
    v: StripMut<'a, D>,
    before: Strip<'a, D>,
    force: Strip<'a, D>,
    mass: RepeatStrip<'a>,
}

impl<T: Shape<D>, const D: usize> Work for Pass<'_, '_, T, D> {
    type Output = bool;
    #[inline(always)]
    fn run<P: Pack>(self) -> bool {
        let (shape, law, used) = (&self.shape, self.law, self.used);
        let Moved {
            range,
            before,
            x,
            v,
            force,
            mass,
            h,
            loss_contact,
            loss_friction,
            work_colliders,
            work_correction,
            ..
        } = self.moved;
        let (start, length) = (range.start, range.len());
        let mut tile = Tile {
            x: x.strip_mut(start, length),
            v: v.strip_mut(start, length),
            before: Strip::new(before, 0, length),
            force: Strip::new(force, 0, length),
            mass: mass.strip(start, length),
        };
        let thickness = P::splat(law.thickness);
        // A node that moves so far in a step could come out on the far side of the shape.
        let far = 0.5 * shape.half_width();
        let has_far_side = far < f64::INFINITY;
        let far = P::splat(far * far);

        // One look at all nodes; mostly that is all. Four packs at once, which need not wait for the four before.
        let look =
            Look { shape, carry: self.carry, near: P::splat(law.thickness + largest_rounding(law)), far, has_far_side };
        let lies = self.meets == Meets::WhatItLiesOn;
        let mut k = 0;
        // Who lay on the surface may be beside it now.
        let mut near = lies;
        while k + 4 * WIDTH <= used && !near {
            near = look.any_near::<4>(&tile, k, P::first(WIDTH));
            k += 4 * WIDTH;
        }
        while k < used && !near {
            near = look.any_near::<1>(&tile, k, P::first(used - k));
            k += WIDTH;
        }
        if !near {
            return false;
        }

        let (mut losses, mut frictions, mut works, mut corrections) = (
            P::load(&**loss_contact),
            P::load(&**loss_friction),
            P::load(&**work_colliders),
            P::load(&**work_correction),
        );
        let mut touched = false;
        for k in (0..used).step_by(WIDTH) {
            let x = lanes!(P, d => tile.x.load::<P>(d, k));
            let nodes = P::first(used - k);
            let close = P::both((shape.gap(&x) - thickness).less(P::splat(largest_rounding(law))), nodes);
            let from = lanes!(P, d => tile.before.load::<P>(d, k));
            let before = self.carry.along(&from);
            let way = subtract(&x, &before);
            // Who goes far may come out elsewhere, and who came in by a face may be nearer to another one.
            let fast = P::both(far.less(dot(&way, &way)), nodes);
            let mut asked = P::select(fast, P::one(), P::zero());
            if lies {
                let lay = P::splat(close_to(shape, law.thickness)).larger(rounding(law, &before));
                let on = P::both((shape.gap(&before) - thickness).abs().less_or_equal(lay), nodes);
                asked = P::select(on, P::one(), P::zero());
            } else if T::FACES {
                let inside = P::both((shape.gap(&x) - thickness).less_or_equal(rounding(law, &x)), nodes);
                asked = P::select(inside, P::one(), asked);
            }
            let any_asked = (lies || has_far_side) && P::any(P::zero().less(asked));
            if !any_asked && (lies || !P::any(close)) {
                continue;
            }
            let (mut gap, mut normal) = shape.gap_and_normal(&x);
            gap -= thickness;
            if any_asked {
                let mut found = Found { gap: gap.to_array(), normal: arrays(&normal) };
                let ways = Ways {
                    ends: [arrays(&before), arrays(&x)],
                    asked: asked.to_array(),
                    held: self.held.pack::<P>(k).to_array(),
                    small: rounding(law, if lies { &before } else { &x }).to_array(),
                };
                if lies {
                    ways.look_for_supports(shape, law.thickness, &mut found);
                } else {
                    ways.look_for_entries(shape, law.thickness, &mut found);
                }
                gap = P::from_array(found.gap);
                normal = lanes!(P, d => P::from_array(found.normal[d]));
            }
            let v = lanes!(P, d => tile.v.load::<P>(d, k));
            let mass = tile.mass.load::<P>(k);
            let obstacle = self.pose.velocity_at(&x);
            let force = lanes!(P, d => tile.force.load::<P>(d, k));
            let held = self.held.pack(k);
            let meeting = Meeting { x, v, before, from, force, mass, gap, normal, obstacle, held, h: P::splat(*h) };
            let hit = P::both(meets(law, &meeting), nodes);
            if !P::any(hit) {
                continue;
            }
            touched = true;
            self.held.note(k, P::select(hit, P::one(), P::zero()));
            let parting = if T::FACES {
                respond(&Face { x, gap, normal }, law, hit, &meeting)
            } else {
                respond(&Around { shape, thickness: law.thickness }, law, hit, &meeting)
            };
            for d in 0..D {
                tile.x.store(d, k, P::select(hit, parting.x[d], x[d]));
                tile.v.store(d, k, P::select(hit, parting.v[d], v[d]));
            }
            losses += P::select(hit, parting.loss_contact, P::zero());
            frictions += P::select(hit, parting.loss_friction, P::zero());
            works += P::select(hit, parting.work, P::zero());
            corrections += P::select(hit, parting.correction, P::zero());
        }
        losses.store(&mut **loss_contact);
        frictions.store(&mut **loss_friction);
        works.store(&mut **work_colliders);
        corrections.store(&mut **work_correction);
        touched
    }
}

/// The first look at the nodes of a tile.
struct Look<'a, P, T, const D: usize> {
    shape: &'a T,
    carry: &'a Carry<D>,
    near: P,
    far: P,
    has_far_side: bool,
}

impl<P: Pack, T: Shape<D>, const D: usize> Look<'_, P, T, D> {
    /// Whether any node of `N` packs deserves a second look: near the shape, or fast.
    #[inline(always)]
    fn any_near<const N: usize>(&self, tile: &Tile<D>, start: usize, nodes: P::Mask) -> bool {
        let (mut least, mut most) = (P::splat(f64::INFINITY), P::zero());
        for n in 0..N {
            let k = start + n * WIDTH;
            let x = lanes!(P, d => tile.x.load::<P>(d, k));
            least = self.shape.gap(&x).smaller(least);
            if self.has_far_side {
                let way = subtract(&x, &self.carry.along(&lanes!(P, d => tile.before.load::<P>(d, k))));
                most = dot(&way, &way).larger(most);
            }
        }
        P::any(P::both(least.less(self.near), nodes))
            || (self.has_far_side && P::any(P::both(self.far.less(most), nodes)))
    }
}
