//! Closest points of two features: a point and a facet, or two edges.

use crate::vector::{dot, subtract};
use opruga_math::Lane;

/// The weights of the corners of a facet at its point closest to `p`; they are not negative and sum to 1.
///
/// In 2D a facet is an edge (two corners), in 3D a triangle (three). A triangle without area is treated as its three sides.
///
/// # Source
/// C. Ericson, Real-Time Collision Detection (2005), §5.1.2 and §5.1.5.
pub fn closest_on_facet<const D: usize>(p: &[f64; D], corners: &[[f64; D]; D]) -> [f64; D] {
    let mut out = [0.0; D];
    if D == 2 {
        let t = closest_on_segment(p, &corners[0], &corners[1]);
        (out[0], out[1]) = (1.0 - t, t);
        return out;
    }
    let last = D - 1;
    let (a, b, c) = (&corners[0], &corners[1], &corners[last]);
    let (ab, ac, ap) = (subtract(b, a), subtract(c, a), subtract(p, a));
    let (bb, cc, bc) = (dot(&ab, &ab), dot(&ac, &ac), dot(&ab, &ac));
    let has_area = bb * cc - bc * bc > PARALLEL * bb * cc;
    if !has_area {
        return closest_on_sides(p, corners);
    }
    let (d1, d2) = (dot(&ab, &ap), dot(&ac, &ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        out[0] = 1.0;
        return out;
    }
    let bp = subtract(p, b);
    let (d3, d4) = (dot(&ab, &bp), dot(&ac, &bp));
    if d3 >= 0.0 && d4 <= d3 {
        out[1] = 1.0;
        return out;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = closest_on_segment(p, a, b);
        (out[0], out[1]) = (1.0 - t, t);
        return out;
    }
    let cp = subtract(p, c);
    let (d5, d6) = (dot(&ab, &cp), dot(&ac, &cp));
    if d6 >= 0.0 && d5 <= d6 {
        out[last] = 1.0;
        return out;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = closest_on_segment(p, a, c);
        (out[0], out[last]) = (1.0 - t, t);
        return out;
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = closest_on_segment(p, b, c);
        (out[1], out[last]) = (1.0 - t, t);
        return out;
    }
    let whole = va + vb + vc;
    let (v, w) = (vb / whole, vc / whole);
    (out[0], out[1], out[last]) = (1.0 - v - w, v, w);
    out
}

/// The weights of the corners of a triangle at the point of its sides that is closest to `p`.
fn closest_on_sides<const D: usize>(p: &[f64; D], corners: &[[f64; D]; D]) -> [f64; D] {
    let (mut best, mut least) = ([0.0; D], f64::INFINITY);
    best[0] = 1.0;
    for k in 0..D {
        let next = (k + 1) % D;
        let t = closest_on_segment(p, &corners[k], &corners[next]);
        let mut weights = [0.0; D];
        (weights[k], weights[next]) = (1.0 - t, t);
        let between = subtract(p, &mean(&weights, corners));
        let square = dot(&between, &between);
        if square < least {
            (best, least) = (weights, square);
        }
    }
    best
}

/// The position of the point closest to `p` on the segment from `a` (0) to `b` (1).
pub fn closest_on_segment<const D: usize>(p: &[f64; D], a: &[f64; D], b: &[f64; D]) -> f64 {
    let ab = subtract(b, a);
    let square = dot(&ab, &ab);
    if square > 0.0 { (dot(&subtract(p, a), &ab) / square).larger(0.0).smaller(1.0) } else { 0.0 }
}

/// The positions of the closest points on two segments, each from 0 to 1. Parallel segments have several pairs of closest points, of which this is
/// one.
///
/// # Source
/// C. Ericson, Real-Time Collision Detection (2005), §5.1.9.
pub fn closest_of_segments<const D: usize>(a: &[[f64; D]; 2], b: &[[f64; D]; 2]) -> [f64; 2] {
    let (d1, d2, r) = (subtract(&a[1], &a[0]), subtract(&b[1], &b[0]), subtract(&a[0], &b[0]));
    let (aa, ee, f) = (dot(&d1, &d1), dot(&d2, &d2), dot(&d2, &r));
    let unit = |x: f64| x.larger(0.0).smaller(1.0);
    let (long_a, long_b) = (aa > 0.0, ee > 0.0);
    if !long_a {
        return [0.0, if long_b { unit(f / ee) } else { 0.0 }];
    }
    let c = dot(&d1, &r);
    if !long_b {
        return [unit(-c / aa), 0.0];
    }
    let bb = dot(&d1, &d2);
    let denominator = aa * ee - bb * bb;
    // Nearly parallel: any point of the common part is equally good.
    let mut s = if denominator > PARALLEL * aa * ee { unit((bb * f - c * ee) / denominator) } else { 0.0 };
    let mut t = (bb * s + f) / ee;
    if t < 0.0 {
        (t, s) = (0.0, unit(-c / aa));
    } else if t > 1.0 {
        (t, s) = (1.0, unit((bb - c) / aa));
    }
    [s, t]
}

/// The squared sine of their angle below which two edges count as parallel. This limit is a hundred times the rounding error of the products, 1e-16.
pub(crate) const PARALLEL: f64 = 1e-14;

/// Returns the weighted sum Σ wᵢ xᵢ of points.
pub(crate) fn mean<const D: usize, const N: usize>(weights: &[f64; N], points: &[[f64; D]; N]) -> [f64; D] {
    let mut out = [0.0; D];
    for (w, x) in weights.iter().zip(points) {
        for d in 0..D {
            out[d] += w * x[d];
        }
    }
    out
}

/// A normal of a facet, not of unit length: in 2D to the right of the edge, in 3D by the right-hand rule. With the orientation of a
/// closed boundary it points outward.
pub fn facet_normal<const D: usize>(corners: &[[f64; D]; D]) -> [f64; D] {
    let mut out = [0.0; D];
    let e = subtract(&corners[1], &corners[0]);
    if D == 2 {
        (out[0], out[1]) = (e[1], -e[0]);
    } else {
        let f = subtract(&corners[D - 1], &corners[0]);
        for d in 0..D {
            let (i, j) = ((d + 1) % D, (d + 2) % D);
            out[d] = e[i] * f[j] - e[j] * f[i];
        }
    }
    out
}
