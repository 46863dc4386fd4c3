//! The distance between two features, and the direction in which they separate.

use crate::closest::{PARALLEL, closest_of_segments, closest_on_facet, facet_normal, mean};
use crate::positions::Positions;
use crate::surface::Surface;
use crate::vector::{dot, length, scaled, subtract};
use opruga_math::Lane;

/// Two features at their closest points.
///
/// When the points move, the gap changes by Σ wᵢ n·Δxᵢ. The weights of one feature sum to 1 and the weights of the other to −1, so impulses wᵢ n λ on
/// the points conserve momentum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<const D: usize> {
    /// The points; unused ones have the weight 0 and repeat the first.
    pub points: [u32; 4],
    /// The weights of the points of the pair.
    pub weights: [f64; 4],
    /// The distance, negative if the first feature is on the inner side of the second [m].
    pub gap: f64,
    /// The unit normal, from the second feature to the first.
    pub normal: [f64; D],
}

/// The distance, relative to the coordinates, below which the vector from one feature to the other consists only of rounding
/// errors.
const ROUNDING: f64 = 1e-13;

impl<const D: usize> Gap<D> {
    /// The gap of a vertex and a facet with the points at `x` [m].
    ///
    /// A facet of a closed boundary has an inner side, where the gap is negative. If the closest point is inside the facet, the side follows from the
    /// normal of the facet. If the closest point is on an edge or corner, the side follows from the normals of all facets around this edge or corner,
    /// each weighted by its angle there. Other facets act on both sides.
    ///
    /// # Source
    /// J. A. Bærentzen, H. Aanæs, Signed distance computation using the angle weighted pseudonormal, IEEE TVCG 11 (2005) 243–253.
    pub fn of_vertex_and_facet(
        surface: &Surface<D>,
        x: &(impl Positions<D> + ?Sized),
        vertex: u32,
        facet: u32,
    ) -> Gap<D> {
        let corners = surface.facets[facet as usize];
        let at = corners.map(|p| x.at(p));
        let p = x.at(vertex);
        let weights = closest_on_facet(&p, &at);
        let between = subtract(&p, &mean(&weights, &at));
        let mut out = Gap { points: [vertex; 4], weights: [0.0; 4], gap: 0.0, normal: [0.0; D] };
        out.weights[0] = 1.0;
        for k in 0..D {
            (out.points[k + 1], out.weights[k + 1]) = (corners[k], -weights[k]);
        }
        let within = weights.iter().all(|w| *w > 0.0);
        let outward = || if within { facet_normal(&at) } else { normal_around(surface, x, &corners, &weights) };
        // Usually the point is in front of all surrounding facets. Their angles then do not matter.
        let may_be_inside = surface.closed[facet as usize]
            && (within || !lies_outside_of_all(surface, x, (&corners, &weights), &between));
        out.point_along(&between, may_be_inside, &p, outward);
        out
    }

    /// The gap of two edges with the points at `x` [m]; `None` if a closest point is an end of its edge, or if the edges are parallel. Pairs of a
    /// vertex and a facet are sufficient in these cases.
    pub fn of_edges(surface: &Surface<D>, x: &(impl Positions<D> + ?Sized), a: u32, b: u32) -> Option<Gap<D>> {
        let (ea, eb) = (surface.edges[a as usize], surface.edges[b as usize]);
        let (xa, xb) = (ea.map(|p| x.at(p)), eb.map(|p| x.at(p)));
        let [s, t] = closest_of_segments(&xa, &xb);
        let inner = |s: f64| s > 0.0 && s < 1.0;
        let (da, db) = (subtract(&xa[1], &xa[0]), subtract(&xb[1], &xb[0]));
        let (aa, bb, ab) = (dot(&da, &da), dot(&db, &db), dot(&da, &db));
        if !(inner(s) && inner(t) && aa * bb - ab * ab > PARALLEL * aa * bb) {
            return None;
        }
        let mut out = Gap {
            points: [ea[0], ea[1], eb[0], eb[1]],
            weights: [1.0 - s, s, t - 1.0, -t],
            gap: 0.0,
            normal: [0.0; D],
        };
        let between = subtract(&mean(&[1.0 - s, s], &xa), &mean(&[1.0 - t, t], &xb));
        let sides = |edge: u32| surface.sides[edge as usize];
        let closed = [a, b].iter().all(|e| sides(*e) != [u32::MAX; 2]);
        // Usually the vector points out of all facets beside the second edge and into those beside the first. The angles of these facets then
        // do not matter.
        let points_out = || {
            [(a, -1.0), (b, 1.0)].into_iter().all(|(edge, sign)| {
                let mut beside = sides(edge).into_iter().filter(|side| *side != u32::MAX);
                beside.all(|side| {
                    let normal = facet_normal(&surface.facets[side as usize].map(|p| x.at(p)));
                    sign * dot(&normal, &between) > 0.0
                })
            })
        };
        // The direction out of the second body and into the first.
        let outward = || {
            let mut sum = [0.0; D];
            for (edge, sign) in [(a, -1.0), (b, 1.0)] {
                for side in sides(edge).into_iter().filter(|side| *side != u32::MAX) {
                    let n = unit(&facet_normal(&surface.facets[side as usize].map(|p| x.at(p))));
                    for d in 0..D {
                        sum[d] += sign * n[d];
                    }
                }
            }
            // The result is perpendicular to both edges, because it also serves as the normal if the vector between them has no
            // direction.
            let mut cross = [0.0; D];
            for d in 0..D {
                let (i, j) = ((d + 1) % D, (d + 2) % D);
                cross[d] = da[i] * db[j] - da[j] * db[i];
            }
            let sign = if dot(&cross, &sum) < 0.0 { -1.0 } else { 1.0 };
            scaled(&cross, sign)
        };
        let may_be_inside = closed && !points_out();
        out.point_along(&between, may_be_inside, &xa[0], outward);
        Some(out)
    }

    /// Computes gap and normal from the vector between the closest points.
    fn point_along(
        &mut self,
        between: &[f64; D],
        may_be_inside: bool,
        origin: &[f64; D],
        outward: impl Fn() -> [f64; D],
    ) {
        let distance = length(between);
        let mut size = 0.0;
        for c in origin {
            size += c.abs();
        }
        if distance > ROUNDING * size {
            let inside = may_be_inside && dot(between, &outward()) < 0.0;
            let sign = if inside { -1.0 } else { 1.0 };
            (self.gap, self.normal) = (sign * distance, scaled(between, sign / distance));
        } else {
            (self.gap, self.normal) = (0.0, unit(&outward()));
        }
    }

    /// Returns Σ wᵢ (bᵢ − aᵢ) for two vectors at each point, such as its positions.
    #[inline]
    pub(crate) fn mean_change(&self, [from, to]: [&[[f64; D]]; 2]) -> [f64; D] {
        let mut sum = [0.0; D];
        for (p, w) in self.points[..=D].iter().zip(&self.weights) {
            for d in 0..D {
                sum[d] += w * (to[*p as usize][d] - from[*p as usize][d]);
            }
        }
        sum
    }

    /// Returns Σ wᵢ n·aᵢ for vectors aᵢ at the points, such as their velocities.
    #[inline]
    pub fn along(&self, vectors: &[[f64; D]]) -> f64 {
        let mut sum = 0.0;
        for (p, w) in self.points.iter().zip(&self.weights) {
            sum += w * dot(&vectors[*p as usize], &self.normal);
        }
        sum
    }
}

/// Scales a vector to length 1; a zero vector becomes the unit vector upwards.
fn unit<const D: usize>(a: &[f64; D]) -> [f64; D] {
    let l = length(a);
    if l > 0.0 && l.is_finite() {
        return scaled(a, 1.0 / l);
    }
    let mut out = [0.0; D];
    out[1] = 1.0;
    out
}

/// Whether a vector from the corner or edge with nonzero weights points to the outer side of all surrounding facets.
fn lies_outside_of_all<const D: usize>(
    surface: &Surface<D>,
    x: &(impl Positions<D> + ?Sized),
    (corners, weights): (&[u32; D], &[f64; D]),
    vector: &[f64; D],
) -> bool {
    facets_around(surface, corners, weights).all(|facet| dot(&facet_normal(&facet.map(|p| x.at(p))), vector) > 0.0)
}

/// The facets around the corner or edge with nonzero weights.
fn facets_around<'a, const D: usize>(
    surface: &'a Surface<D>,
    corners: &'a [u32; D],
    weights: &'a [f64; D],
) -> impl Iterator<Item = &'a [u32; D]> {
    let on = |k: &usize| weights[*k] > 0.0;
    let first = (0..D).find(on).unwrap_or(0);
    let around = surface.facets_around(corners[first]).iter().map(|number| &surface.facets[*number as usize]);
    around.filter(move |facet| (0..D).filter(on).all(|k| facet.contains(&corners[k])))
}

/// The sum of the normals of all facets around the corner or edge with nonzero weights, each weighted by its angle there.
fn normal_around<const D: usize>(
    surface: &Surface<D>,
    x: &(impl Positions<D> + ?Sized),
    corners: &[u32; D],
    weights: &[f64; D],
) -> [f64; D] {
    let on = |k: &usize| weights[*k] > 0.0;
    let first = (0..D).find(on).unwrap_or(0);
    let corner = (0..D).filter(on).count() == 1;
    let mut sum = [0.0; D];
    for facet in facets_around(surface, corners, weights) {
        let at = facet.map(|p| x.at(p));
        let mut angle = 1.0;
        if corner && D == 3 {
            let k = facet.iter().position(|p| *p == corners[first]).unwrap_or(0);
            let (u, v) = (subtract(&at[(k + 1) % D], &at[k]), subtract(&at[(k + 2) % D], &at[k]));
            let cos = dot(&unit(&u), &unit(&v));
            angle = libm::acos(cos.larger(-1.0).smaller(1.0));
        }
        let n = unit(&facet_normal(&at));
        for d in 0..D {
            sum[d] += angle * n[d];
        }
    }
    sum
}
