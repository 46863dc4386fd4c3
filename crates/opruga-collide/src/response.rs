//! The effect of a contact on a node: non-penetration, restitution, Coulomb friction.

use crate::collider::Law;
use crate::vector::{add, choose, dot, length, scaled, subtract};
use opruga_math::{Lane, lanes};

/// A surface from which the distance of a node can be computed.
pub(crate) trait Surface<S: Lane, const D: usize> {
    /// The gap minus the thickness [m], and the normal, of a node that came from `before`; gaps above `reach` may be given as
    /// infinite.
    fn find(&self, x: &[S; D], before: &[S; D], reach: S) -> (S, [S; D]);
}

/// The plane of a flat face: a node on it moves along the plane, even beyond the edges.
pub(crate) struct Face<S, const D: usize> {
    pub(crate) x: [S; D],
    /// The gap at `x`.
    pub(crate) gap: S,
    pub(crate) normal: [S; D],
}

impl<S: Lane, const D: usize> Surface<S, D> for Face<S, D> {
    #[inline(always)]
    fn find(&self, x: &[S; D], _before: &[S; D], _reach: S) -> (S, [S; D]) {
        (self.gap + dot(&subtract(x, &self.x), &self.normal), self.normal)
    }
}

/// A node that penetrates a collider.
pub(crate) struct Meeting<S, const D: usize> {
    /// Position after the free motion [m].
    pub(crate) x: [S; D],
    /// Velocity after the free motion [m/s].
    pub(crate) v: [S; D],
    /// Position before the free motion, carried along with the collider [m].
    pub(crate) before: [S; D],
    /// Position before the free motion [m].
    pub(crate) from: [S; D],
    /// Mean force on the node during the step [N].
    pub(crate) force: [S; D],
    /// Mass [kg].
    pub(crate) mass: S,
    /// The gap, negative in contact [m].
    pub(crate) gap: S,
    /// The normal out of the collider.
    pub(crate) normal: [S; D],
    /// Velocity of the collider at the node [m/s].
    pub(crate) obstacle: [S; D],
    /// Above 0 if another contact is already active at the node in this step.
    pub(crate) active: S,
    /// The substep [s].
    pub(crate) h: S,
}

/// The state of a node after contact, and its energy balance.
///
/// The obstacle gives an impulse J, and the force F has given the impulse hF. With v₀ before the step, v₁ after it and v̄ = ½(v₀ + v₁), the kinetic
/// energy changes by exactly (J + hF)·v̄; J·v̄ is the work of the motion of the obstacle minus the two losses. The potential energy changes by −F·(x₁
/// − x₀), of which hF·v̄ has become kinetic energy; the rest is the effect of moving the node back to the surface. Therefore, a node at rest
/// exchanges no energy, however large the step.
pub(crate) struct Parting<S, const D: usize> {
    /// Position [m].
    pub(crate) x: [S; D],
    /// Velocity [m/s].
    pub(crate) v: [S; D],
    /// Energy that contact took along the normal [J].
    pub(crate) loss_contact: S,
    /// Energy that friction took [J].
    pub(crate) loss_friction: S,
    /// Work of a moving collider [J].
    pub(crate) work: S,
    /// Energy from moving the node back to the surface [J].
    pub(crate) correction: S,
}

/// The distance [m] below which a gap consists of rounding errors.
///
/// The distance has the same upper bound for all nodes, so that one comparison can skip a whole tile.
#[inline(always)]
pub(crate) fn rounding<S: Lane, const D: usize>(law: &Law, x: &[S; D]) -> S {
    if law.rest_speed == 0.0 {
        return S::zero();
    }
    let mut size = S::splat(law.extent);
    for d in 0..D {
        size += x[d].abs();
    }
    (size * S::splat(1e-12)).smaller(S::splat(largest_rounding(law)))
}
/// The upper bound of [`rounding`] [m].
#[inline(always)]
pub(crate) fn largest_rounding(law: &Law) -> f64 {
    if law.rest_speed == 0.0 { 0.0 } else { 1e-6 * (law.extent + 1.0) }
}

/// Whether there is contact: the node is inside, or on the surface and approaching, in both cases by more than rounding.
///
/// Therefore, a node that just reaches the surface meets it in this step, and not in the next step as a node at rest.
#[inline(always)]
pub(crate) fn meets<S: Lane, const D: usize>(law: &Law, node: &Meeting<S, D>) -> S::Mask {
    // A node at the origin has the rounding error of its previous position.
    let small = rounding(law, &node.x).larger(rounding(law, &node.before));
    let coming = -dot(&subtract(&node.v, &node.obstacle), &node.normal) * node.h;
    let inside = node.gap.less(S::select(small.less(coming), small, -small));
    // A node so far away that its distance overflows has no contact.
    S::both(inside, S::splat(-f64::MAX).less_or_equal(node.gap))
}

/// Applies the contact to a node where `hit` is true (elsewhere the result is meaningless, but finite if the input is).
#[inline(always)]
pub(crate) fn respond<S: Lane, T: Surface<S, D>, const D: usize>(
    surface: &T,
    law: &Law,
    hit: S::Mask,
    node: &Meeting<S, D>,
) -> Parting<S, D> {
    let (zero, half) = (S::zero(), S::splat(0.5));
    let u = subtract(&node.v, &node.obstacle);
    let un = dot(&u, &node.normal);
    let closing = S::both(hit, un.less(zero));
    let speed = S::select(closing, -un, zero);

    // An impact returns a fraction e of the speed. If a node began the step on the surface, or is slower than the rest speed,
    // this is not an impact: its speed comes from the step itself, from weight or from the body behind it.
    let small = rounding(law, &node.before);
    // If another contact has already acted in this step, it has accounted for the effect of the force.
    let weighs = S::both(zero.less(node.mass), node.active.less_or_equal(zero));
    let (mut e, mut met) = (zero, speed);
    if law.restitution > 0.0 {
        let mut bounces = S::splat(law.rest_speed).less(speed);
        if law.rest_speed > 0.0 {
            // The force acts for the whole step, but the node meets the surface within it: an obstacle returns no more than the
            // square of the incoming speed, u² + 2 a g, with the speed u and the gap g before the step.
            let pull = S::select(weighs, -dot(&node.force, &node.normal) / node.mass, zero);
            let came = speed - pull * node.h;
            let reach = node.h * came.larger(speed).larger(zero) + (small + small);
            let (gap, _) = surface.find(&node.before, &node.before, reach);
            bounces = S::both(bounces, small.less(gap));
            let square = came * came + S::splat(2.0) * pull * gap.smaller(reach);
            met = square.larger(zero).sqrt().smaller(came.larger(speed)).larger(came.smaller(speed));
        }
        e = S::select(bounces, S::splat(law.restitution), zero);
    }
    let back = e * met;
    let change = back + speed;

    // Moves the node out along the normal. Without friction the motion along the surface does not change in any bit.
    let mut x = choose(hit, &subtract(&node.x, &scaled(&node.normal, node.gap)), &node.x);
    let mut v = add(&node.v, &scaled(&node.normal, change));
    // Half of the velocity due to the force.
    let given = scaled(&node.force, S::select(weighs, half * node.h / node.mass, zero));
    let mut loss_friction = zero;
    if law.friction > 0.0 {
        // Coulomb's law: the tangential change is at most µ times the normal one, and at most stops the sliding.
        let slide = lanes!(S, d => u[d] - un * node.normal[d]);
        let pace = length(&slide);
        let most = S::splat(law.friction) * change;
        let keep = S::select(pace.less_or_equal(most), zero, S::one() - most / pace);
        let slide_after = scaled(&slide, keep);
        v = lanes!(S, d => (node.obstacle[d] + slide_after[d]) + back * node.normal[d]);
        let mean = half * (S::one() + keep) * pace * pace - dot(&given, &slide);
        loss_friction = S::select(closing, node.mass * (S::one() - keep) * mean, zero);

        // A node that rests or slides moves from its previous position with the new velocity, and then onto the surface: the
        // tangential part of the free step is undone, so that sticking nodes do not creep. If another contact has moved the node,
        // only the part of the velocity that this contact takes is undone.
        let stopped = scaled(&subtract(&slide_after, &slide), node.h);
        let fresh = add(&node.before, &scaled(&slide_after, node.h));
        let path = choose(zero.less(node.active), &add(&x, &stopped), &fresh);
        let close = node.h * (speed + speed) + small;
        let (gap, normal) = surface.find(&path, &node.before, close);
        let onto = choose(gap.less(close), &subtract(&path, &scaled(&normal, gap)), &path);
        let rests = S::both(closing, e.less_or_equal(zero));
        x = choose(rests, &onto, &x);
    }
    v = choose(closing, &v, &node.v);

    let gained = subtract(&v, &node.v);
    // The mean of the velocities before and after the step.
    let mean = subtract(&scaled(&add(&node.v, &v), half), &given);
    let moved =
        choose(zero.less(node.active), &subtract(&node.x, &x), &add(&subtract(&node.from, &x), &scaled(&mean, node.h)));
    Parting {
        x,
        v,
        loss_contact: node.mass * change * (half * (speed - back) + dot(&given, &node.normal)),
        loss_friction,
        work: node.mass * dot(&gained, &node.obstacle),
        correction: dot(&node.force, &moved),
    }
}
