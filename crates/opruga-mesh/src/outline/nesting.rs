//! Which rings are holes.

use super::{OutlineError, Ring, first_meeting};

/// Turns rings by the even-odd rule: those inside an even number of others run counter-clockwise, holes clockwise. Returns how many were turned.
///
/// # Errors
/// [`OutlineError::Empty`], [`OutlineError::NotFinite`], [`OutlineError::NoArea`], and [`OutlineError::Meeting`] for rings that cross or touch
/// themselves or one another.
pub fn nest(rings: &mut [Ring]) -> Result<usize, OutlineError> {
    check(rings)?;
    if let Some((parts, place)) = meeting(rings) {
        return Err(OutlineError::Meeting { parts, place });
    }
    let boxes: Vec<_> = rings.iter().map(|ring| super::bounds(core::slice::from_ref(ring))).collect();
    let mut turned = 0;
    for number in 0..rings.len() {
        // Rings do not touch, so any point tells for the whole ring.
        let point = rings[number].points[0];
        let around = |other: &usize| {
            *other != number
                && boxes[*other].is_some_and(|(low, high)| (0..2).all(|a| low[a] <= point[a] && point[a] <= high[a]))
                && encloses(&rings[*other], point)
        };
        let hole = (0..rings.len()).filter(around).count() % 2 == 1;
        if (rings[number].area() < 0.0) != hole {
            rings[number].points.reverse();
            turned += 1;
        }
    }
    Ok(turned)
}

/// Refuses rings without extent.
fn check(rings: &[Ring]) -> Result<(), OutlineError> {
    if rings.is_empty() {
        return Err(OutlineError::Empty);
    }
    for ring in rings {
        if let Some(value) = ring.points.iter().flatten().find(|x| !x.is_finite()) {
            return Err(OutlineError::NotFinite { part: ring.part, value: *value });
        }
        let area = ring.area();
        if ring.points.len() < 3 || area == 0.0 || !area.is_finite() {
            // The halves of a figure of eight enclose as much as they take away: what is wrong is that they cross.
            if area == 0.0
                && !is_on_a_line(ring)
                && let Some((parts, place)) = meeting(core::slice::from_ref(ring))
            {
                return Err(OutlineError::Meeting { parts, place });
            }
            let place = ring.points.first().copied().unwrap_or([0.0; 2]);
            return Err(OutlineError::NoArea { part: ring.part, points: ring.points.len(), place });
        }
    }
    Ok(())
}

/// Whether all points of a ring lie on one line.
fn is_on_a_line(ring: &Ring) -> bool {
    let Some(first) = ring.points.first() else { return true };
    let way = |p: &[f64; 2]| [p[0] - first[0], p[1] - first[1]];
    let Some(along) = ring.points.iter().map(way).find(|way| *way != [0.0; 2]) else { return true };
    ring.points.iter().map(way).all(|way| along[0] * way[1] - along[1] * way[0] == 0.0)
}

/// The parts of the first two edges that meet, and about where.
pub(super) fn meeting(rings: &[Ring]) -> Option<([u32; 2], [f64; 2])> {
    let all: Vec<&[[f64; 2]]> = rings.iter().map(|ring| ring.points.as_slice()).collect();
    let [p, q] = first_meeting(&all)?;
    let ends = |(ring, edge): (usize, usize)| (all[ring][edge], all[ring][(edge + 1) % all[ring].len()]);
    let ((a, b), (c, d)) = (ends(p), ends(q));
    Some(([rings[p.0].part, rings[q.0].part], crossing_place(a, b, c, d)))
}

/// Where two edges cross: a common end, or where their lines do; for parallel ones an end of one that lies on the other.
fn crossing_place(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> [f64; 2] {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [d[0] - c[0], d[1] - c[1]]);
    if let Some(common) = [c, d].into_iter().find(|end| *end == a || *end == b) {
        return common;
    }
    let across = u[0] * v[1] - u[1] * v[0];
    if across == 0.0 {
        let within = |x: f64, p: f64, q: f64| (p <= x && x <= q) || (q <= x && x <= p);
        let on_first = |end: &[f64; 2]| (0..2).all(|k| within(end[k], a[k], b[k]));
        return [c, d].into_iter().find(on_first).unwrap_or(a);
    }
    let t = ((c[0] - a[0]) * v[1] - (c[1] - a[1]) * v[0]) / across;
    [a[0] + t * u[0], a[1] + t * u[1]]
}

/// Whether a point lies inside a ring: an odd number of edges cross the ray to its right.
pub(super) fn encloses(ring: &Ring, point: [f64; 2]) -> bool {
    let mut inside = false;
    for (a, b) in ring.edges() {
        if (a[1] > point[1]) != (b[1] > point[1]) {
            let x = a[0] + (point[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
            inside ^= x > point[0];
        }
    }
    inside
}
