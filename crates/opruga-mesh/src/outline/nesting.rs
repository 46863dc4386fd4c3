//! Distinction of outer rings and holes.

use super::inside::around;
use super::{OutlineError, Ring, first_meeting};
use crate::MeshError;

/// Two parts, and the position at which they meet.
type Meeting = ([u32; 2], [f64; 2]);

/// Orients rings by the even-odd rule: rings inside an even number of others run counter-clockwise, holes clockwise. Returns the number of reversed
/// rings.
///
/// # Errors
/// [`OutlineError::Empty`], [`OutlineError::NotFinite`], [`OutlineError::NoArea`], and [`OutlineError::Meeting`] for rings that cross or touch
/// themselves or one another.
pub fn nest(rings: &mut [Ring]) -> Result<usize, OutlineError> {
    check(rings)?;
    if let Some((parts, point)) = meeting(rings)? {
        return Err(OutlineError::meeting(parts, point));
    }
    let mut turned = 0;
    let around = around(rings);
    let mut depths: Vec<Option<bool>> = vec![None; rings.len()];
    for number in 0..rings.len() {
        let hole = is_hole(number, &around, &mut depths);
        let ring = &mut rings[number];
        if (ring.area() < 0.0) != hole {
            ring.points.reverse();
            turned += 1;
        }
    }
    Ok(turned)
}

/// Whether a ring is inside an odd number of others. Known results are kept.
fn is_hole(number: usize, around: &[Option<usize>], known: &mut [Option<bool>]) -> bool {
    // Follow the nesting outwards to a ring with a known result, and return. This is not recursive, because there may be
    // thousands of levels.
    let (mut path, mut at) = (Vec::new(), number);
    let mut hole = loop {
        match (known[at], around[at]) {
            (Some(hole), _) => break hole,
            (None, None) => {
                known[at] = Some(false);
                break false;
            }
            (None, Some(outer)) => {
                path.push(at);
                at = outer;
            }
        }
    };
    for ring in path.into_iter().rev() {
        hole = !hole;
        known[ring] = Some(hole);
    }
    hole
}

/// Refuses rings without extent.
fn check(rings: &[Ring]) -> Result<(), OutlineError> {
    if rings.is_empty() {
        return Err(OutlineError::Empty {});
    }
    for ring in rings {
        if let Some(value) = ring.points.iter().flatten().find(|x| !x.is_finite()) {
            return Err(OutlineError::NotFinite { part: ring.part, value: *value });
        }
        let area = ring.area();
        if ring.points.len() < 3 || area == 0.0 || !area.is_finite() {
            // The halves of a figure of eight have areas that cancel; the error to be reported is that it crosses itself.
            if area == 0.0
                && !is_on_a_line(ring)
                && let Some((parts, point)) = meeting(core::slice::from_ref(ring))?
            {
                return Err(OutlineError::meeting(parts, point));
            }
            let first = ring.points.first().copied().unwrap_or([0.0; 2]);
            return Err(OutlineError::NoArea { part: ring.part, points: ring.points.len(), position: first });
        }
    }
    Ok(())
}

/// Whether all points of a ring are on one line.
fn is_on_a_line(ring: &Ring) -> bool {
    let Some(first) = ring.points.first() else { return true };
    let offset = |p: &[f64; 2]| [p[0] - first[0], p[1] - first[1]];
    let Some(along) = ring.points.iter().map(offset).find(|offset| *offset != [0.0; 2]) else { return true };
    ring.points.iter().map(offset).all(|offset| along[0] * offset[1] - along[1] * offset[0] == 0.0)
}

/// The parts of the first two edges that meet, and the approximate position.
///
/// # Errors
/// [`MeshError::NotCompared`] if this cannot be determined.
pub(super) fn meeting(rings: &[Ring]) -> Result<Option<Meeting>, MeshError> {
    let all: Vec<&[[f64; 2]]> = rings.iter().map(|ring| ring.points.as_slice()).collect();
    let Some([p, q]) = first_meeting(&all)? else { return Ok(None) };
    let ends = |(ring, edge): (usize, usize)| (all[ring][edge], all[ring][(edge + 1) % all[ring].len()]);
    let ((a, b), (c, d)) = (ends(p), ends(q));
    Ok(Some(([rings[p.0].part, rings[q.0].part], crossing_point(a, b, c, d))))
}

/// The crossing point of two edges: a common end, or the intersection of their lines; for parallel edges, an end of one that is on the other.
fn crossing_point(a: [f64; 2], b: [f64; 2], c: [f64; 2], d: [f64; 2]) -> [f64; 2] {
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
