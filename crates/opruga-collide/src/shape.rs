//! Shapes whose signed distance is a formula. The same code computes it for one node and for eight nodes at once.

use crate::motion::Pose;
use crate::vector::{add, choose, dot, length, scaled, splat, subtract, turned};
use opruga_math::{Lane, lanes};

/// A solid with a signed distance, which is negative inside.
pub(crate) trait Shape<const D: usize>: Sized {
    /// Half of the smallest width [m]; a node that moves farther in one step could come out on the far side.
    fn half_width(&self) -> f64;
    /// The signed distance [m].
    fn gap<S: Lane>(&self, x: &[S; D]) -> S;
    /// The signed distance [m] and its gradient, the unit normal.
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]);
    /// Whether it is bounded by flat faces, which meet in edges.
    const FACES: bool = false;
    /// Calls `visit` for every flat face that a point on the surface is on, to within `grain` [m], with the height of the point
    /// above the face and the normal of the face. Without flat faces, it does nothing.
    fn visit_faces(&self, _x: &[f64; D], _grain: f64, _visit: &mut dyn FnMut(f64, [f64; D])) {}
}

/// A face that a node meets on its path. If there are several, it is the face into which the displacement of the node leads
/// most directly.
pub(crate) struct Met<const D: usize> {
    /// The height of the node above the face [m].
    pub(crate) height: f64,
    pub(crate) normal: [f64; D],
    /// The depth of the end of the path behind a face [m]: the smallest depth behind any face that the node is on.
    pub(crate) behind: f64,
    /// The number of faces that the node is on.
    pub(crate) faces: usize,
    /// The number of these faces into which the path of the node leads.
    pub(crate) entered: usize,
}

impl<const D: usize> Met<D> {
    /// The face that a node meets on its path from `x`. The node keeps the distance `margin` from a shape, to within `close`.
    fn of<T: Shape<D>>(shape: &T, margin: f64, x: &[f64; D], displacement: &[f64; D], close: f64) -> Met<D> {
        let (height, normal) = shape.gap_and_normal(x);
        let nearest = Met { height: height - margin, normal, behind: f64::INFINITY, faces: 0, entered: 0 };
        let (mut met, mut most) = (nearest, f64::INFINITY);
        let mut add = |height: f64, normal: [f64; D]| {
            let along = dot(displacement, &normal);
            if along < most {
                (most, met.height, met.normal) = (along, height - margin, normal);
            }
            met.behind = (margin - height - along).smaller(met.behind);
            met.faces += 1;
            met.entered += usize::from(along < 0.0);
        };
        // Only a shape without a margin has edges: a margin rounds them.
        if margin <= close {
            shape.visit_faces(x, 2.0 * close, &mut add);
        }
        if met.faces == 0 {
            met.behind = -met.height - dot(displacement, &met.normal);
            (met.faces, met.entered) = (1, 1);
        }
        met
    }
}

/// Solid for x·n < offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HalfSpace<const D: usize> {
    pub(crate) normal: [f64; D],
    pub(crate) offset: f64,
}

/// A sphere that is solid inside (`sign` 1) or outside (`sign` −1).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball<const D: usize> {
    pub(crate) center: [f64; D],
    pub(crate) radius: f64,
    pub(crate) sign: f64,
}

/// Solid within `radius` of the segment from `start` along `along`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule<const D: usize> {
    pub(crate) start: [f64; D],
    pub(crate) along: [f64; D],
    pub(crate) inverse_square: f64,
    pub(crate) radius: f64,
    /// A unit vector perpendicular to the segment: the normal on the segment itself.
    pub(crate) aside: [f64; D],
}

/// A solid box with unit vectors `axes` along its sides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuboid<const D: usize> {
    pub(crate) center: [f64; D],
    pub(crate) axes: [[f64; D]; D],
    pub(crate) half: [f64; D],
}

/// The length of a vector and its direction; `fallback` if it is too short to have one.
#[inline(always)]
fn direction<S: Lane, const D: usize>(a: &[S; D], fallback: &[f64; D]) -> (S, [S; D]) {
    let r = length(a);
    let unit = scaled(a, S::one() / r);
    // Below this the square underflows and the quotient is no longer a unit vector.
    (r, choose(r.less(S::splat(1e-150)), &splat(fallback), &unit))
}

/// The unit vector along y.
fn upward<const D: usize>() -> [f64; D] {
    let mut out = [0.0; D];
    out[1] = 1.0;
    out
}

impl<const D: usize> HalfSpace<D> {
    pub(crate) fn through(point: &[f64; D], normal: [f64; D]) -> Self {
        HalfSpace { normal, offset: dot(point, &normal) }
    }
    pub(crate) fn posed(&self, pose: &Pose<D>) -> Self {
        if pose.upright {
            return HalfSpace { normal: self.normal, offset: self.offset + dot(&pose.shift, &self.normal) };
        }
        HalfSpace::through(&pose.transform(&scaled(&self.normal, self.offset)), pose.direct(&self.normal))
    }
    /// The smallest signed distance within a box of space.
    pub(crate) fn least_gap(&self, low: &[f64; D], high: &[f64; D]) -> f64 {
        let mut gap = -self.offset;
        for d in 0..D {
            gap += (low[d] * self.normal[d]).smaller(high[d] * self.normal[d]);
        }
        gap
    }
}

impl<const D: usize> Shape<D> for HalfSpace<D> {
    fn half_width(&self) -> f64 {
        f64::INFINITY
    }
    #[inline(always)]
    fn gap<S: Lane>(&self, x: &[S; D]) -> S {
        dot(x, &splat(&self.normal)) - S::splat(self.offset)
    }
    #[inline(always)]
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]) {
        (self.gap(x), splat(&self.normal))
    }
}

impl<const D: usize> Ball<D> {
    pub(crate) fn posed(&self, pose: &Pose<D>) -> Self {
        Ball { center: pose.transform(&self.center), ..*self }
    }
}

impl<const D: usize> Shape<D> for Ball<D> {
    fn half_width(&self) -> f64 {
        if self.sign > 0.0 { self.radius } else { f64::INFINITY }
    }
    #[inline(always)]
    fn gap<S: Lane>(&self, x: &[S; D]) -> S {
        S::splat(self.sign) * (length(&subtract(x, &splat(&self.center))) - S::splat(self.radius))
    }
    #[inline(always)]
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]) {
        let (r, outward) = direction(&subtract(x, &splat(&self.center)), &upward());
        let sign = S::splat(self.sign);
        (sign * (r - S::splat(self.radius)), scaled(&outward, sign))
    }
}

impl<const D: usize> Capsule<D> {
    pub(crate) fn posed(&self, pose: &Pose<D>) -> Self {
        Capsule {
            start: pose.transform(&self.start),
            along: pose.direct(&self.along),
            aside: pose.direct(&self.aside),
            ..*self
        }
    }
    /// The vector from the nearest point of the segment to `x`.
    #[inline(always)]
    fn away<S: Lane>(&self, x: &[S; D]) -> [S; D] {
        let (arm, along) = (subtract(x, &splat(&self.start)), splat::<S, D>(&self.along));
        let t = (dot(&arm, &along) * S::splat(self.inverse_square)).larger(S::zero()).smaller(S::one());
        lanes!(S, d => arm[d] - t * along[d])
    }
}

impl<const D: usize> Shape<D> for Capsule<D> {
    fn half_width(&self) -> f64 {
        self.radius
    }
    #[inline(always)]
    fn gap<S: Lane>(&self, x: &[S; D]) -> S {
        length(&self.away(x)) - S::splat(self.radius)
    }
    #[inline(always)]
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]) {
        let (r, outward) = direction(&self.away(x), &self.aside);
        (r - S::splat(self.radius), outward)
    }
}

impl<const D: usize> Cuboid<D> {
    pub(crate) fn posed(&self, pose: &Pose<D>) -> Self {
        let mut axes = self.axes;
        for axis in &mut axes {
            *axis = pose.direct(axis);
        }
        Cuboid { center: pose.transform(&self.center), axes, half: self.half }
    }
    /// The corner that the bits of a number select. Each bit stands for one axis.
    pub(crate) fn corner(&self, bits: usize) -> [f64; D] {
        let mut out = self.center;
        for d in 0..D {
            let side = if bits >> d & 1 == 1 { self.half[d] } else { -self.half[d] };
            out = add(&out, &scaled(&self.axes[d], side));
        }
        out
    }
}

impl<const D: usize> Shape<D> for Cuboid<D> {
    const FACES: bool = true;
    fn visit_faces(&self, x: &[f64; D], grain: f64, visit: &mut dyn FnMut(f64, [f64; D])) {
        let local = turned(&self.axes, &subtract(x, &self.center));
        for d in 0..D {
            for side in [1.0, -1.0] {
                let height = side * local[d] - self.half[d];
                if height >= -grain {
                    visit(height, scaled(&self.axes[d], side));
                }
            }
        }
    }
    fn half_width(&self) -> f64 {
        let mut least = f64::INFINITY;
        for d in 0..D {
            least = self.half[d].smaller(least);
        }
        least
    }
    #[inline(always)]
    fn gap<S: Lane>(&self, x: &[S; D]) -> S {
        let local = turned(&self.axes, &subtract(x, &splat(&self.center)));
        let over = lanes!(S, d => local[d].abs() - S::splat(self.half[d]));
        let mut deepest = over[0];
        let mut outside = [S::zero(); D];
        for d in 0..D {
            deepest = over[d].larger(deepest);
            outside[d] = over[d].larger(S::zero());
        }
        S::select(S::zero().less(deepest), length(&outside), deepest)
    }
    #[inline(always)]
    fn gap_and_normal<S: Lane>(&self, x: &[S; D]) -> (S, [S; D]) {
        let local = turned(&self.axes, &subtract(x, &splat(&self.center)));
        let over = lanes!(S, d => local[d].abs() - S::splat(self.half[d]));
        // Inside: the nearest face, the first one if there are several. Outside: the nearest point of the surface.
        let (mut deepest, mut inside) = (over[0], [S::zero(); D]);
        inside[0] = S::one();
        let mut outside = lanes!(S, d => over[d].larger(S::zero()));
        for d in 1..D {
            let nearer = deepest.less(over[d]);
            deepest = S::select(nearer, over[d], deepest);
            for i in 0..D {
                inside[i] = S::select(nearer, S::splat(if i == d { 1.0 } else { 0.0 }), inside[i]);
            }
        }
        let distance = length(&outside);
        outside = scaled(&outside, S::one() / distance);
        // A distance that is too short to have a direction counts as a distance from the face.
        let is_outside = S::splat(1e-150).less(distance);
        let mut normal = [S::zero(); D];
        for d in 0..D {
            let size = S::select(is_outside, outside[d], inside[d]);
            let signed = S::select(local[d].less(S::zero()), -size, size);
            for i in 0..D {
                normal[i] += signed * S::splat(self.axes[d][i]);
            }
        }
        (S::select(is_outside, distance, deepest), normal)
    }
}

/// The distance from a shape [m] below which a node is on its surface.
pub(crate) fn close_to<T: Shape<D>, const D: usize>(shape: &T, margin: f64) -> f64 {
    let width = shape.half_width();
    if width < f64::INFINITY { 1e-9 * (width + margin) } else { 0.0 }
}

/// Whether a point on the surface is on an edge, where the normal is not unique.
pub(crate) fn is_on_edge<T: Shape<D>, const D: usize>(shape: &T, margin: f64, x: &[f64; D]) -> bool {
    Met::of(shape, margin, x, &[0.0; D], close_to(shape, margin)).faces > 1
}

/// Returns the contact of a node that moves to `b` from a position `a` on a surface, to within `small` [m]. The contact consists of the distance of
/// `b` behind the tangent plane (negative) and the normal. None if the node was not on the surface or does not enter. It is also none on an edge if
/// more than one face is in the way of the node, or if another contact that is already `active` moves the node along one of the faces.
#[inline(never)]
pub(crate) fn support<T: Shape<D>, const D: usize>(
    shape: &T,
    margin: f64,
    small: f64,
    [a, b]: [&[f64; D]; 2],
    active: bool,
) -> Option<(f64, [f64; D])> {
    let close = close_to(shape, margin).larger(small);
    let gap = shape.gap(a) - margin;
    let displacement = subtract(b, a);
    if gap.abs() <= close {
        let Met { height, normal, behind, entered, .. } = Met::of(shape, margin, a, &displacement, close);
        let left = height + dot(&displacement, &normal);
        let clear = if active { behind > close } else { entered == 1 };
        return (clear && dot(&displacement, &normal) < 0.0 && left < 0.0).then_some((left, normal));
    }
    None
}

/// Finds where a node that moved from `a` to `b` entered a convex solid. Returns the distance of `b` behind the tangent plane
/// at that point (negative) and the normal; `None` if the node did not enter from outside.
///
/// This method is sphere tracing: a step along the segment by the signed distance never crosses the surface.
#[inline(never)]
pub(crate) fn entry<T: Shape<D>, const D: usize>(
    shape: &T,
    margin: f64,
    a: &[f64; D],
    b: &[f64; D],
) -> Option<(f64, [f64; D])> {
    let displacement = subtract(b, a);
    let far = length(&displacement);
    let close = close_to(shape, margin);
    let mut gone = 0.0;
    if shape.gap(a) - margin < -close {
        return None;
    }
    for _ in 0..64 {
        let s = gone / far;
        let x: [f64; D] = lanes!(f64, d => a[d] + s * displacement[d]);
        let gap = shape.gap(&x) - margin;
        if gap <= close {
            let left: [f64; D] = subtract(b, &x);
            let Met { height, normal, .. } = Met::of(shape, margin, &x, &left, close);
            let behind = dot(&left, &normal) + height;
            return (dot(&displacement, &normal) < 0.0 && behind < 0.0).then_some((behind, normal));
        }
        gone += gap;
        if gone.is_nan() || gone > far {
            return None;
        }
    }
    None
}
