//! The contact of the nodes of a tile with one shape.

use crate::active_nodes::{ActiveNodes, Meets};
use crate::collider::Law;
use crate::entries::{Found, NodePaths, arrays, numbers};
use crate::motion::{Carry, Pose};
use crate::response::{Face, Meeting, Surface, largest_rounding, meets, respond, rounding};
use crate::shape::{Shape, close_to};
use crate::vector::{dot, subtract};
use opruga_core::contacts::Moved;
use opruga_math::{Lane, Pack, Register, RepeatStrip, Strip, StripMut, WIDTH, Work, lanes};

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

/// Applies one shape to the nodes of a tile, eight at a time.
pub(crate) struct Pass<'a, 'm, T, const D: usize> {
    pub(crate) shape: T,
    pub(crate) law: &'a Law,
    pub(crate) pose: &'a Pose<D>,
    pub(crate) carry: &'a Carry<D>,
    pub(crate) moved: &'a mut Moved<'m, D>,
    pub(crate) active: &'a mut ActiveNodes,
    pub(crate) used: usize,
    pub(crate) meets: Meets,
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
        // A node that moves this far in a step could come out on the far side of the shape.
        let far = 0.5 * shape.half_width();
        let has_far_side = far < f64::INFINITY;
        let far = far * far;

        // One check of all nodes is usually enough. It processes four packs at once, so that the computations of one pack need
        // not wait for those of another.
        let look = Look {
            shape,
            carry: self.carry,
            threshold: P::splat(law.thickness + largest_rounding(law)),
            far: P::splat(far),
            has_far_side,
        };
        let lies = self.meets == Meets::WhatItLiesOn;
        let mut k = 0;
        // If only nodes that were on the surface are processed, there is no first check, because such a node may now be beside
        // the surface.
        let mut has_candidates = lies;
        while k + 4 * WIDTH <= used && !has_candidates {
            has_candidates = look.any_candidate::<4>(&tile, k, P::first(WIDTH));
            k += 4 * WIDTH;
        }
        while k < used && !has_candidates {
            has_candidates = look.any_candidate::<1>(&tile, k, P::first(used - k));
            k += WIDTH;
        }
        if !has_candidates {
            return false;
        }

        // The few candidates are processed register by register, because a whole pack would need more values at a time than
        // there are registers.
        let second = SecondLook { shape, law, pose: self.pose, carry: self.carry, h: *h, far, has_far_side, lies };
        let mut taken = Taken { loss_contact, loss_friction, work: work_colliders, correction: work_correction };
        let mut touched = false;
        for k in (0..used).step_by(WIDTH) {
            for part in 0..P::PARTS {
                touched |= second.hold_back::<P, P::Part>(&mut tile, k, part, used - k, self.active, &mut taken);
            }
        }
        touched
    }
}

/// The first check of the nodes of a tile.
struct Look<'a, P, T, const D: usize> {
    shape: &'a T,
    carry: &'a Carry<D>,
    /// The gap below which a node is a candidate [m].
    threshold: P,
    far: P,
    has_far_side: bool,
}

impl<P: Pack, T: Shape<D>, const D: usize> Look<'_, P, T, D> {
    /// Whether any node of `N` packs is a candidate for a second check: close to the shape, or fast.
    #[inline(always)]
    fn any_candidate<const N: usize>(&self, tile: &Tile<D>, start: usize, nodes: P::Mask) -> bool {
        let (mut least, mut most) = (P::splat(f64::INFINITY), P::zero());
        for n in 0..N {
            let k = start + n * WIDTH;
            let x = lanes!(P, d => tile.x.load::<P>(d, k));
            least = self.shape.gap(&x).smaller(least);
            if self.has_far_side {
                let displacement = subtract(&x, &self.carry.along(&lanes!(P, d => tile.before.load::<P>(d, k))));
                most = dot(&displacement, &displacement).larger(most);
            }
        }
        P::any(P::both(least.less(self.threshold), nodes))
            || (self.has_far_side && P::any(P::both(self.far.less(most), nodes)))
    }
}

/// The energies that the contacts of a tile have taken and given, for each lane of a pack [J].
struct Taken<'a> {
    loss_contact: &'a mut [f64; WIDTH],
    loss_friction: &'a mut [f64; WIDTH],
    work: &'a mut [f64; WIDTH],
    correction: &'a mut [f64; WIDTH],
}

/// Adds the numbers of one register to the sums from index `offset` on.
#[inline(always)]
fn add_to<R: Register>(sums: &mut [f64; WIDTH], offset: usize, more: R) {
    let sums = &mut sums[offset..];
    (R::load(sums) + more).store(sums);
}

/// The check of nodes that may touch, and the effect of the contact on them.
struct SecondLook<'a, T, const D: usize> {
    shape: &'a T,
    law: &'a Law,
    pose: &'a Pose<D>,
    carry: &'a Carry<D>,
    /// The substep [s].
    h: f64,
    /// The square of the distance that a node may move without a check of its path [m²], and whether there is such a limit.
    far: f64,
    has_far_side: bool,
    /// Whether only nodes that were on the shape are processed.
    lies: bool,
}

impl<T: Shape<D>, const D: usize> SecondLook<'_, T, D> {
    /// Applies the shape to the nodes of one register; returns whether it touched any. The register is a part of the pack at
    /// `k`, in which the first `count` lanes are used.
    #[inline(always)]
    fn hold_back<P: Pack<Part = R>, R: Register>(
        &self,
        tile: &mut Tile<D>,
        k: usize,
        part: usize,
        count: usize,
        active: &mut ActiveNodes,
        taken: &mut Taken,
    ) -> bool {
        let SecondLook { shape, law, lies, .. } = *self;
        let offset = part * R::NUMBERS;
        let nodes = R::first(count.saturating_sub(offset));
        let thickness = R::splat(law.thickness);

        let x = lanes!(R, d => tile.x.load_part::<P>(d, k, part));
        let close = R::both((shape.gap(&x) - thickness).less(R::splat(largest_rounding(law))), nodes);
        let from = lanes!(R, d => tile.before.load_part::<P>(d, k, part));
        let before = self.carry.along(&from);
        let displacement = subtract(&x, &before);
        // A node that moves far may come out on another side, and a node that entered through one face may be closer to another
        // one.
        let fast = R::both(R::splat(self.far).less(dot(&displacement, &displacement)), nodes);
        let mut asked = R::select(fast, R::one(), R::zero());
        if lies {
            let lay = R::splat(close_to(shape, law.thickness)).larger(rounding(law, &before));
            let on = R::both((shape.gap(&before) - thickness).abs().less_or_equal(lay), nodes);
            asked = R::select(on, R::one(), R::zero());
        } else if T::FACES {
            let inside = R::both((shape.gap(&x) - thickness).less_or_equal(rounding(law, &x)), nodes);
            asked = R::select(inside, R::one(), asked);
        }
        let any_asked = (lies || self.has_far_side) && R::any(R::zero().less(asked));
        if !any_asked && (lies || !R::any(close)) {
            return false;
        }
        let (mut gap, mut normal) = shape.gap_and_normal(&x);
        gap -= thickness;
        let active_before = active.numbers(k, offset);
        if any_asked {
            let mut found = Found { gap: numbers(gap), normal: arrays(&normal) };
            let paths = NodePaths {
                ends: [arrays(&before), arrays(&x)],
                asked: numbers(asked),
                active: active_before,
                small: numbers(rounding(law, if lies { &before } else { &x })),
            };
            if lies {
                paths.look_for_supports(shape, law.thickness, &mut found);
            } else {
                paths.look_for_entries(shape, law.thickness, &mut found);
            }
            gap = R::load(&found.gap);
            normal = lanes!(R, d => R::load(&found.normal[d]));
        }
        let v = lanes!(R, d => tile.v.load_part::<P>(d, k, part));
        let mass = tile.mass.load_part::<P>(k, part);
        let obstacle = self.pose.velocity_at(&x);
        let force = lanes!(R, d => tile.force.load_part::<P>(d, k, part));
        let (active_before, h) = (R::load(&active_before), R::splat(self.h));
        let meeting = Meeting { x, v, before, from, force, mass, gap, normal, obstacle, active: active_before, h };
        let hit = R::both(meets(law, &meeting), nodes);
        if !R::any(hit) {
            return false;
        }
        active.note(k, offset, R::select(hit, R::one(), R::zero()));
        let parting = if T::FACES {
            respond(&Face { x, gap, normal }, law, hit, &meeting)
        } else {
            respond(&Around { shape, thickness: law.thickness }, law, hit, &meeting)
        };
        for d in 0..D {
            tile.x.store_part::<P>(d, k, part, R::select(hit, parting.x[d], x[d]));
            tile.v.store_part::<P>(d, k, part, R::select(hit, parting.v[d], v[d]));
        }
        let zero = R::zero();
        add_to(taken.loss_contact, offset, R::select(hit, parting.loss_contact, zero));
        add_to(taken.loss_friction, offset, R::select(hit, parting.loss_friction, zero));
        add_to(taken.work, offset, R::select(hit, parting.work, zero));
        add_to(taken.correction, offset, R::select(hit, parting.correction, zero));
        true
    }
}
