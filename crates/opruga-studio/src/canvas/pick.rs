//! Finds the body under the pointer.

use super::camera::Flat;
use crate::shown::Shown;
use egui::{Pos2, Rect, Vec2};
use opruga::draw::{Facets, Lens};

/// The largest distance of the pointer from a node [points].
const REACH: f64 = 18.0;

/// The body under the pointer.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Under {
    /// The index of the body in the world.
    pub(crate) body: usize,
    /// The name of the body.
    pub(crate) name: String,
    /// The point of the body that is nearest to the pointer [m].
    pub(crate) point: [f64; 3],
    /// The distance of this point along the axis of the camera [m]; 0 in the plane.
    pub(crate) distance: f64,
    /// The size [m] in the scene of a point of the screen at this distance.
    pub(crate) pixel: f64,
}

/// Finds the body in the plane under the pointer: the body of the nearest node within reach or, if there is none, a body whose outline contains the
/// pointer.
pub(crate) fn in_plane(shown: &Shown, flat: &Flat, rect: Rect, at: Pos2) -> Option<Under> {
    let [x, y] = flat.to_world(rect, at, shown.picture.y_down);
    let pixel = flat.metres(1.0);
    let reach = REACH * pixel;
    let mut best: Option<(f64, usize, [f64; 3])> = None;
    for (index, (body, extent)) in shown.picture.bodies.iter().zip(&shown.extents).enumerate() {
        let [low, high] = extent.corners;
        if x < low[0] - reach || x > high[0] + reach || y < low[1] - reach || y > high[1] + reach {
            continue;
        }
        let mut nearest = (f64::INFINITY, [0.0; 3]);
        for p in &body.positions {
            let square = (p[0] - x) * (p[0] - x) + (p[1] - y) * (p[1] - y);
            if square < nearest.0 {
                nearest = (square, *p);
            }
        }
        let (square, point) = nearest;
        if square.is_finite()
            && best.is_none_or(|(least, ..)| square < least)
            && (square <= reach * reach || around(body, x, y))
        {
            best = Some((square, index, point));
        }
    }
    let (_, index, point) = best?;
    let body = shown.bodies.get(index)?;
    Some(Under { body: body.number, name: body.name.clone(), point, distance: 0.0, pixel })
}

/// Whether a point is inside the outlines of a body, by the even-odd rule.
fn around(body: &opruga::draw::BodyPicture, x: f64, y: f64) -> bool {
    let Facets::Edges(edges) = &body.facets else { return false };
    let crosses = |edge: &&[u32; 2]| {
        let [a, b] = edge.map(|node| body.positions[node as usize]);
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    edges.iter().filter(crosses).count() % 2 == 1
}

/// Finds the body in space under the pointer: the body of the frontmost node within reach, or of a triangle under the pointer.
pub(crate) fn in_space(shown: &Shown, lens: &Lens, rect: Rect, at: Pos2) -> Option<Under> {
    let at = at - rect.min;
    let mut best: Option<(f64, usize, [f64; 3])> = None;
    let mut offer = |distance: f64, index: usize, point: [f64; 3]| {
        if best.is_none_or(|(least, ..)| distance < least) {
            best = Some((distance, index, point));
        }
    };
    for (index, body) in shown.picture.bodies.iter().enumerate() {
        let seen: Vec<Option<([f64; 2], f64)>> = body.positions.iter().map(|p| lens.see(*p)).collect();
        for (point, seen) in body.positions.iter().zip(&seen) {
            if let Some((pixel, distance)) = seen
                && (pixel[0] - f64::from(at.x)).hypot(pixel[1] - f64::from(at.y)) < 0.5 * REACH
            {
                offer(*distance, index, *point);
            }
        }
        let Facets::Triangles(triangles) = &body.facets else { continue };
        for triangle in triangles {
            let corners = triangle.map(|node| seen[node as usize]);
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            if let Some(shares) = inside([a.0, b.0, c.0], at) {
                let distance = shares[0] * a.1 + shares[1] * b.1 + shares[2] * c.1;
                offer(distance, index, lens.point([f64::from(at.x), f64::from(at.y)], distance));
            }
        }
    }
    let (distance, index, point) = best?;
    let body = shown.bodies.get(index)?;
    let [a, b] = [0.0, 1.0].map(|dx| lens.point([f64::from(at.x) + dx, f64::from(at.y)], distance));
    let pixel = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    Some(Under { body: body.number, name: body.name.clone(), point, distance, pixel })
}

/// The barycentric coordinates of a point within a triangle.
fn inside([a, b, c]: [[f64; 2]; 3], at: Vec2) -> Option<[f64; 3]> {
    let p = [f64::from(at.x), f64::from(at.y)];
    let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let whole = area(a, b, c);
    let shares = [area(p, b, c) / whole, area(a, p, c) / whole, area(a, b, p) / whole];
    (whole != 0.0 && shares.iter().all(|s| *s >= 0.0)).then_some(shares)
}
