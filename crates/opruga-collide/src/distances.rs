//! Distances of many pairs of features at once, in vector instructions.

use crate::closest::PARALLEL;
use crate::surface::Surface;
use crate::unclear::Unclear;
use crate::vector::{dot, scaled, subtract};
use opruga_math::{Lane, Pack, WIDTH, Work, lanes};

/// Computes the distances of pairs of a vertex and a facet, or of pairs of edges, with the points at `x` [m].
///
/// The distance between a vertex and a facet is negative if the vertex lies behind the plane of the facet.
pub(crate) struct Distances<'a, const D: usize> {
    pub(crate) surface: &'a Surface<D>,
    pub(crate) x: &'a [[f64; D]],
    pub(crate) pairs: &'a mut [Unclear],
    /// The features of all candidates of this kind.
    pub(crate) features: &'a [[u32; 2]],
    /// Whether the pairs consist of a vertex and a facet.
    pub(crate) with_facet: bool,
}

impl<const D: usize> Work for Distances<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Distances { surface, x, pairs, features, with_facet } = self;
        for eight in pairs.chunks_mut(WIDTH) {
            // Unused lanes repeat the last pair.
            let mut own = [eight[eight.len() - 1].features(features); WIDTH];
            own.iter_mut().zip(&*eight).for_each(|(own, pair)| *own = pair.features(features));
            let found = if with_facet {
                let mut facet = [[P::zero(); D]; D];
                for (k, corner) in facet.iter_mut().enumerate() {
                    *corner = at(x, |l| surface.facets[own[l][1] as usize][k]);
                }
                of_vertex_and_facet(&at(x, |l| own[l][0]), &facet)
            } else {
                let mut edges = [[[P::zero(); D]; 2]; 2];
                for (e, edge) in edges.iter_mut().enumerate() {
                    for (k, end) in edge.iter_mut().enumerate() {
                        *end = at(x, |l| surface.edges[own[l][e] as usize][k]);
                    }
                }
                of_edges(&edges[0], &edges[1])
            };
            eight.iter_mut().zip(found.to_array()).for_each(|(pair, distance)| pair.distance = distance);
        }
    }
}

/// The positions of eight points.
#[inline(always)]
fn at<P: Pack, const D: usize>(x: &[[f64; D]], point: impl Fn(usize) -> u32) -> [P; D] {
    let mut out = [[0.0; WIDTH]; D];
    for l in 0..WIDTH {
        let x = &x[point(l) as usize];
        for d in 0..D {
            out[d][l] = x[d];
        }
    }
    lanes!(P, d => P::from_array(out[d]))
}

/// Limits a number to the range from 0 to 1; NaN becomes 0.
#[inline(always)]
fn unit<S: Lane>(t: S) -> S {
    t.larger(S::zero()).smaller(S::one())
}

/// The square of the distance of a point from a segment.
#[inline(always)]
fn square_of_segment<S: Lane, const D: usize>(p: &[S; D], a: &[S; D], b: &[S; D]) -> S {
    let (ab, ap) = (subtract(b, a), subtract(p, a));
    let t = unit(dot(&ab, &ap) / dot(&ab, &ab));
    let between = subtract(&ap, &scaled(&ab, t));
    dot(&between, &between)
}

/// The distance of a point from a facet, negative behind its plane.
#[inline(always)]
fn of_vertex_and_facet<S: Lane, const D: usize>(p: &[S; D], corners: &[[S; D]; D]) -> S {
    let (a, b, c) = (&corners[0], &corners[1], &corners[D - 1]);
    let (ab, ac, ap) = (subtract(b, a), subtract(c, a), subtract(p, a));
    let mut square = square_of_segment(p, a, b);
    let side;
    if D == 2 {
        side = ab[1] * ap[0] - ab[0] * ap[1];
    } else {
        square = square_of_segment(p, b, c).smaller(square_of_segment(p, c, a).smaller(square));
        let normal = cross(&ab, &ac);
        let size = dot(&normal, &normal);
        side = dot(&normal, &ap);
        // Whether the projection of the point onto the plane of the triangle is within all three sides. A triangle without area
        // has no inside.
        let mut within = (S::splat(PARALLEL) * dot(&ab, &ab) * dot(&ac, &ac)).less(size);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let inwards = cross(&normal, &subtract(to, from));
            within = S::both(within, S::zero().less(dot(&inwards, &subtract(p, from))));
        }
        square = S::select(within, side * side / size, square);
    }
    let distance = square.sqrt();
    S::select(side.less(S::zero()), -distance, distance)
}

/// The distance between two segments, computed in the same way as by [`crate::closest::closest_of_segments`].
#[inline(always)]
fn of_edges<S: Lane, const D: usize>(a: &[[S; D]; 2], b: &[[S; D]; 2]) -> S {
    let (d1, d2, r) = (subtract(&a[1], &a[0]), subtract(&b[1], &b[0]), subtract(&a[0], &b[0]));
    let (aa, ee, ab) = (dot(&d1, &d1), dot(&d2, &d2), dot(&d1, &d2));
    let (c, f) = (dot(&d1, &r), dot(&d2, &r));
    let denominator = aa * ee - ab * ab;
    let crossing = (S::splat(PARALLEL) * aa * ee).less(denominator);
    let mut s = S::select(crossing, unit((ab * f - c * ee) / denominator), S::zero());
    // If the second segment has no length, its closest point is its start.
    let t = S::select(S::zero().less(ee), (ab * s + f) / ee, -S::one());
    let (before, behind) = (t.less(S::zero()), S::one().less(t));
    s = S::select(before, unit(-c / aa), S::select(behind, unit((ab - c) / aa), s));
    let t = unit(t);
    let between = lanes!(S, d => r[d] + s * d1[d] - t * d2[d]);
    dot(&between, &between).sqrt()
}

/// The cross product in space; zero in the plane.
#[inline(always)]
fn cross<S: Lane, const D: usize>(a: &[S; D], b: &[S; D]) -> [S; D] {
    lanes!(S, d => a[(d + 1) % D] * b[(d + 2) % D] - a[(d + 2) % D] * b[(d + 1) % D])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closest::{closest_of_segments, closest_on_facet, facet_normal, mean};
    use crate::vector::length;

    /// Numbers between −1 and 1.
    fn numbers() -> impl FnMut() -> f64 {
        let mut state = 7_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    fn of_facet_agrees<const D: usize>() {
        let mut next = numbers();
        for k in 0..20_000 {
            let mut p = [0.0; D];
            let mut facet = [[0.0; D]; D];
            p.iter_mut().for_each(|c| *c = next());
            facet.iter_mut().flatten().for_each(|c| *c = next());
            match k % 10 {
                0 => facet[D - 1] = facet[0],
                1 => p = facet[0],
                _ => {}
            }
            let between = subtract(&p, &mean(&closest_on_facet(&p, &facet), &facet));
            let found = of_vertex_and_facet::<f64, D>(&p, &facet);
            assert!((found.abs() - length(&between)).abs() < 1e-9, "{found} {between:?}");
            if found.abs() > 1e-9 && length(&facet_normal(&facet)) > 1e-9 {
                assert_eq!(found < 0.0, dot(&subtract(&p, &facet[0]), &facet_normal(&facet)) < 0.0);
            }
        }
    }

    #[test]
    fn distances_of_facets_are_those_of_closest_points() {
        of_facet_agrees::<2>();
        of_facet_agrees::<3>();
    }

    #[test]
    fn distances_of_edges_are_those_of_closest_points() {
        let mut next = numbers();
        for k in 0..20_000 {
            let mut edges = [[[0.0; 3]; 2]; 2];
            edges.iter_mut().flatten().flatten().for_each(|c| *c = next());
            match k % 10 {
                0 => edges[0][1] = edges[0][0],
                1 => edges[1][1] = edges[1][0],
                2 => edges[1] = edges[0].map(|p| [p[0], p[1] + 0.1, p[2]]),
                _ => {}
            }
            let [s, t] = closest_of_segments(&edges[0], &edges[1]);
            let between = subtract(&mean(&[1.0 - s, s], &edges[0]), &mean(&[1.0 - t, t], &edges[1]));
            let found = of_edges::<f64, 3>(&edges[0], &edges[1]);
            assert!((found - length(&between)).abs() < 1e-9, "{k}: {found} {between:?}");
        }
    }
}
