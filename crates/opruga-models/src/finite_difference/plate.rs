//! Differences on a surface: its curvature at inner nodes, on its edge, and at the centres of its cells.
//!
//! ```text
//!         v₊            B₁₁ = n·(u₊ − 2x + u₋)/h₁²  at inner nodes,
//!         │             B₂₂ = n·(v₊ − 2x + v₋)/h₂²  likewise,
//!   u₋ ── x ── u₊       B₁₂ = n·(x₂ − x₁ + x₀ − x₃)/(h₁ h₂)  in the middle of a cell,
//!         │             n = x₁ × x₂/|x₁ × x₂| by central differences.
//!         v₋
//! ```
//! No moment acts across a free edge, so the curvature across the edge has the value of least energy. The energy of the
//! curvature B along the edge is then ½ D (1 − ν²) B².

use crate::vectors::{cross, dot, in_dimension, in_space, minus, scaled};
use opruga_core::stencil::Kernel;
use opruga_math::Lane;

/// The unit normal of two tangents, and the inverse length of their cross product.
#[inline(always)]
fn normal<S: Lane>(first: &[S; 3], second: &[S; 3]) -> ([S; 3], S) {
    let product = cross(first, second);
    let square = dot(&product, &product);
    let present = S::splat(f64::MIN_POSITIVE).less_or_equal(square);
    let per_length = S::select(present, S::one() / S::select(present, square, S::one()).sqrt(), S::zero());
    (scaled(&product, per_length), per_length)
}

/// x₊ − 2x + x₋.
#[inline(always)]
fn second<S: Lane>(before: &[S; 3], at: &[S; 3], after: &[S; 3]) -> [S; 3] {
    minus(&minus(after, at), &minus(at, before))
}

/// The contributions of one moment: the force on its second difference, and the forces on the tangents, which rotate the
/// normal.
struct Moved<S> {
    by_second: [S; 3],
    by_first: [[S; 3]; 2],
}

/// The terms of M ∂B/∂x with B = n·d: M n for d, and M (d − B n)/|m| · ∂m for the tangents, with m = p × q.
#[inline(always)]
fn moved<S: Lane>(moment: S, d: &[S; 3], n: &[S; 3], per_length: S, p: &[S; 3], q: &[S; 3]) -> Moved<S> {
    let curvature = dot(n, d);
    let turned = scaled(&minus(d, &scaled(n, curvature)), moment * per_length);
    Moved { by_second: scaled(n, moment), by_first: [cross(q, &turned), cross(&turned, p)] }
}

/// The rate of B when nodes move: n·ḋ + (d − B n)/|m| · (ṗ × q + p × q̇).
#[inline(always)]
fn rate<S: Lane>(unit: &Moved<S>, d: &[S; 3], p: &[S; 3], q: &[S; 3]) -> S {
    dot(&unit.by_second, d) + dot(&unit.by_first[0], p) + dot(&unit.by_first[1], q)
}

/// Adds a force times a factor to a node.
#[inline(always)]
fn add<S: Lane, const N: usize>(out: &mut [[S; 3]; N], node: usize, force: &[S; 3], factor: S) {
    for d in 0..3 {
        out[node][d] += force[d] * factor;
    }
}
#[inline(always)]
fn finished<S: Lane, const D: usize, const N: usize>(out: &[[S; 3]; N]) -> [[S; D]; N] {
    let mut nodes = [[S::zero(); D]; N];
    for a in 0..N {
        nodes[a] = in_dimension(&out[a]);
    }
    nodes
}
#[inline(always)]
fn raised<S: Lane, const D: usize, const N: usize>(x: &[[S; D]; N]) -> [[S; 3]; N] {
    let mut nodes = [[S::zero(); 3]; N];
    for a in 0..N {
        nodes[a] = in_space(&x[a]);
    }
    nodes
}

/// Both curvatures at an inner node. The nodes are x, u₋, u₊, v₋, v₊. The parameters are D A [N·m³], ν, 1/h₁, 1/h₂ [1/m],
/// both curvatures at rest [1/m] and the retardation time τ [s].
///
/// U = ½ D A [β₁² + β₂² + 2ν β₁ β₂] with β = B − B₀.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inner;

/// The differences at an inner node: second differences along both axes, then first differences along both axes.
struct Differences<S> {
    second: [[S; 3]; 2],
    first: [[S; 3]; 2],
}

impl Inner {
    #[inline(always)]
    fn differences<S: Lane>(p: &[S; 7], x: &[[S; 3]; 5]) -> Differences<S> {
        let half = S::splat(0.5);
        let [one, two] = [second(&x[1], &x[0], &x[2]), second(&x[3], &x[0], &x[4])];
        Differences {
            second: [scaled(&one, p[2] * p[2]), scaled(&two, p[3] * p[3])],
            first: [scaled(&minus(&x[2], &x[1]), half * p[2]), scaled(&minus(&x[4], &x[3]), half * p[3])],
        }
    }
    #[inline(always)]
    fn excess<S: Lane>(p: &[S; 7], at: &Differences<S>) -> ([S; 2], [S; 3], S) {
        let (n, per_length) = normal(&at.first[0], &at.first[1]);
        ([dot(&n, &at.second[0]) - p[4], dot(&n, &at.second[1]) - p[5]], n, per_length)
    }
    #[inline(always)]
    fn moments<S: Lane>(p: &[S; 7], b: &[S; 2]) -> [S; 2] {
        [p[0] * (b[0] + p[1] * b[1]), p[0] * (b[1] + p[1] * b[0])]
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(
        p: &[S; 7],
        at: &Differences<S>,
        moments: &[S; 2],
        n: &[S; 3],
        per_length: S,
    ) -> [[S; D]; 5] {
        let mut out = [[S::zero(); 3]; 5];
        let half = S::splat(0.5);
        for axis in 0..2 {
            let m = moved(moments[axis], &at.second[axis], n, per_length, &at.first[0], &at.first[1]);
            let square = p[2 + axis] * p[2 + axis];
            add(&mut out, 1 + 2 * axis, &m.by_second, square);
            add(&mut out, 2 + 2 * axis, &m.by_second, square);
            add(&mut out, 0, &m.by_second, -(square + square));
            for k in 0..2 {
                add(&mut out, 1 + 2 * k, &m.by_first[k], -(half * p[2 + k]));
                add(&mut out, 2 + 2 * k, &m.by_first[k], half * p[2 + k]);
            }
        }
        finished(&out)
    }
}

impl<const D: usize> Kernel<D, 5, 7> for Inner {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 7], x: &[[S; D]; 5]) -> S {
        let (b, _, _) = Inner::excess(p, &Inner::differences(p, &raised(x)));
        let m = Inner::moments(p, &b);
        S::splat(0.5) * (m[0] * b[0] + m[1] * b[1])
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 7], x: &[[S; D]; 5]) -> [[S; D]; 5] {
        let at = Inner::differences(p, &raised(x));
        let (b, n, per_length) = Inner::excess(p, &at);
        Inner::spread(p, &at, &Inner::moments(p, &b), &n, per_length)
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 7], x: &[[S; D]; 5], v: &[[S; D]; 5]) -> ([[S; D]; 5], S) {
        let (at, motion) = (Inner::differences(p, &raised(x)), Inner::differences(p, &raised(v)));
        let (_, n, per_length) = Inner::excess(p, &at);
        let mut rates = [S::zero(); 2];
        for axis in 0..2 {
            let unit = moved(S::one(), &at.second[axis], &n, per_length, &at.first[0], &at.first[1]);
            rates[axis] = rate(&unit, &motion.second[axis], &motion.first[0], &motion.first[1]);
        }
        let m = Inner::moments(p, &rates);
        let power = p[6] * (m[0] * rates[0] + m[1] * rates[1]);
        (Inner::spread(p, &at, &[-(p[6] * m[0]), -(p[6] * m[1])], &n, per_length), power)
    }
}

/// The curvature along the edge of a surface. The nodes are x, the nodes before and after x on the edge, and the node inside.
/// The parameters are D (1 − ν²) A [N·m³], 1/h along the edge, 1/h across it [1/m], the curvature at rest [1/m] and τ [s].
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge;

/// The second difference along the edge, the first difference along the edge, and the first difference across it.
type AtEdge<S> = [[S; 3]; 3];

impl Edge {
    #[inline(always)]
    fn differences<S: Lane>(p: &[S; 5], x: &[[S; 3]; 4]) -> AtEdge<S> {
        [
            scaled(&second(&x[1], &x[0], &x[2]), p[1] * p[1]),
            scaled(&minus(&x[2], &x[1]), S::splat(0.5) * p[1]),
            scaled(&minus(&x[3], &x[0]), p[2]),
        ]
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(p: &[S; 5], m: &Moved<S>) -> [[S; D]; 4] {
        let mut out = [[S::zero(); 3]; 4];
        let (square, half) = (p[1] * p[1], S::splat(0.5) * p[1]);
        add(&mut out, 1, &m.by_second, square);
        add(&mut out, 2, &m.by_second, square);
        add(&mut out, 0, &m.by_second, -(square + square));
        add(&mut out, 1, &m.by_first[0], -half);
        add(&mut out, 2, &m.by_first[0], half);
        add(&mut out, 3, &m.by_first[1], p[2]);
        add(&mut out, 0, &m.by_first[1], -p[2]);
        finished(&out)
    }
}

impl<const D: usize> Kernel<D, 4, 5> for Edge {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 5], x: &[[S; D]; 4]) -> S {
        let [d, first, across] = Edge::differences(p, &raised(x));
        let (n, _) = normal(&first, &across);
        let excess = dot(&n, &d) - p[3];
        S::splat(0.5) * p[0] * excess * excess
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 5], x: &[[S; D]; 4]) -> [[S; D]; 4] {
        let [d, first, across] = Edge::differences(p, &raised(x));
        let (n, per_length) = normal(&first, &across);
        let moment = p[0] * (dot(&n, &d) - p[3]);
        Edge::spread(p, &moved(moment, &d, &n, per_length, &first, &across))
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 5], x: &[[S; D]; 4], v: &[[S; D]; 4]) -> ([[S; D]; 4], S) {
        let [d, first, across] = Edge::differences(p, &raised(x));
        let [vd, v_first, v_across] = Edge::differences(p, &raised(v));
        let (n, per_length) = normal(&first, &across);
        let rate = rate(&moved(S::one(), &d, &n, per_length, &first, &across), &vd, &v_first, &v_across);
        let moment = p[4] * p[0] * rate;
        (Edge::spread(p, &moved(-moment, &d, &n, per_length, &first, &across)), moment * rate)
    }
}

/// The twist of a cell. The corners are as in [`super::solid::Quadrilateral`]. The parameters are 2 (1 − ν) D A [N·m³], 1/h₁,
/// 1/h₂ [1/m], the twist at rest [1/m] and τ [s]. U = ½ 2 (1 − ν) D A (B₁₂ − B₀)².
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist;

impl Twist {
    #[inline(always)]
    fn differences<S: Lane>(p: &[S; 5], x: &[[S; 3]; 4]) -> AtEdge<S> {
        let half = S::splat(0.5);
        let (low, high) = (minus(&x[1], &x[0]), minus(&x[2], &x[3]));
        let (left, right) = (minus(&x[3], &x[0]), minus(&x[2], &x[1]));
        let mut mean = [[S::zero(); 3]; 2];
        for d in 0..3 {
            mean[0][d] = half * p[1] * (low[d] + high[d]);
            mean[1][d] = half * p[2] * (left[d] + right[d]);
        }
        [scaled(&minus(&high, &low), p[1] * p[2]), mean[0], mean[1]]
    }
    #[inline(always)]
    fn spread<S: Lane, const D: usize>(p: &[S; 5], m: &Moved<S>) -> [[S; D]; 4] {
        let mut out = [[S::zero(); 3]; 4];
        let (area, half) = (p[1] * p[2], S::splat(0.5));
        // Signs of the corners in the twist and in the two mean differences.
        let signs = [[1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]];
        for node in 0..4 {
            add(&mut out, node, &m.by_second, S::splat(signs[node][0]) * area);
            add(&mut out, node, &m.by_first[0], S::splat(signs[node][1]) * half * p[1]);
            add(&mut out, node, &m.by_first[1], S::splat(signs[node][2]) * half * p[2]);
        }
        finished(&out)
    }
}

impl<const D: usize> Kernel<D, 4, 5> for Twist {
    const NAME: &'static str = super::KIND;

    #[inline(always)]
    fn energy<S: Lane>(p: &[S; 5], x: &[[S; D]; 4]) -> S {
        let [d, one, two] = Twist::differences(p, &raised(x));
        let (n, _) = normal(&one, &two);
        let excess = dot(&n, &d) - p[3];
        S::splat(0.5) * p[0] * excess * excess
    }
    #[inline(always)]
    fn gradient<S: Lane>(p: &[S; 5], x: &[[S; D]; 4]) -> [[S; D]; 4] {
        let [d, one, two] = Twist::differences(p, &raised(x));
        let (n, per_length) = normal(&one, &two);
        let moment = p[0] * (dot(&n, &d) - p[3]);
        Twist::spread(p, &moved(moment, &d, &n, per_length, &one, &two))
    }
    #[inline(always)]
    fn damping<S: Lane>(p: &[S; 5], x: &[[S; D]; 4], v: &[[S; D]; 4]) -> ([[S; D]; 4], S) {
        let [d, one, two] = Twist::differences(p, &raised(x));
        let [vd, v_one, v_two] = Twist::differences(p, &raised(v));
        let (n, per_length) = normal(&one, &two);
        let rate = rate(&moved(S::one(), &d, &n, per_length, &one, &two), &vd, &v_one, &v_two);
        let moment = p[4] * p[0] * rate;
        (Twist::spread(p, &moved(-moment, &d, &n, per_length, &one, &two)), moment * rate)
    }
}

/// Both curvatures at an inner node at rest [1/m].
pub(super) fn curvatures(p: &[f64; 7], x: &[[f64; 3]; 5]) -> [f64; 2] {
    Inner::excess(p, &Inner::differences(p, x)).0
}

/// The curvature of the edge at rest [1/m].
pub(super) fn edge_curvature(p: &[f64; 5], x: &[[f64; 3]; 4]) -> f64 {
    let [d, first, across] = Edge::differences(p, x);
    dot(&normal(&first, &across).0, &d)
}

/// The twist of a cell at rest [1/m].
pub(super) fn twist(p: &[f64; 5], x: &[[f64; 3]; 4]) -> f64 {
    let [d, one, two] = Twist::differences(p, x);
    dot(&normal(&one, &two).0, &d)
}
