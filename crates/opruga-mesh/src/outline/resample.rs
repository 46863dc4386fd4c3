//! Resampling of closed curves to equal edges that keep their corners.

use super::{OutlineError, Ring, distance};
use crate::Quantity;
use std::collections::BTreeSet;

/// Cosine of the angle, 35°, above which a turn within one edge length is a corner. The tip of a heart may turn by only 40°, and a regular octagon
/// turns by 45°. A circle with a circumference of twelve or more edge lengths turns by at most 30° within one of them.
const CORNER_COSINE: f64 = 0.819_152_044_288_991_8;

/// Rings with points about `spacing` [m] apart. Corners are kept, the curves between them are divided into equal lengths, and detail finer than the
/// spacing is dropped. Each ring has at least 3 points.
///
/// A corner is a point at which the directions half a spacing before and after differ by more than 35°, and by more than at the points around it; or
/// a point at which rings touched before [`super::joined`] separated them.
///
/// # Errors
/// [`OutlineError::Mesh`] for too many points; [`OutlineError::NoArea`] for a ring that vanishes, [`OutlineError::TooCoarse`] if edges of the result
/// cross.
pub fn resampled(rings: &[Ring], spacing: f64) -> Result<Vec<Ring>, OutlineError> {
    crate::mesh::positive(Quantity::Spacing, spacing)?;
    let pieces: f64 = rings.iter().map(|ring| ring.length() / spacing).sum();
    crate::mesh::limit_nodes(if pieces < 1e18 { pieces as u64 } else { u64::MAX })?;
    let touching = super::touching::touching(rings);
    let coarse: Vec<Ring> = rings.iter().zip(&touching).map(|(ring, fixed)| resample(ring, fixed, spacing)).collect();
    for (ring, before) in coarse.iter().zip(rings) {
        if ring.area() * before.area() <= 0.0 {
            let first = ring.points.first().copied().unwrap_or([0.0; 2]);
            return Err(OutlineError::NoArea { part: ring.part, points: ring.points.len(), position: first });
        }
    }
    match super::nesting::meeting(&coarse)? {
        Some((parts, position)) => Err(OutlineError::TooCoarse { spacing, parts, position }),
        None => Ok(coarse),
    }
}

/// One ring, resampled; the points with the given numbers are kept.
fn resample(ring: &Ring, fixed: &[usize], spacing: f64) -> Ring {
    let curve = Curve::of(ring);
    if curve.total == 0.0 {
        return ring.clone();
    }
    let corners = curve.corners(fixed, spacing);
    // A ring without corners begins at its first point.
    let starts = if corners.is_empty() { vec![0.0] } else { corners };
    let least: u64 = match starts.len() {
        1 => 3,
        2 => 2,
        _ => 1,
    };
    let mut points = Vec::new();
    for (k, &from) in starts.iter().enumerate() {
        let to = starts.get(k + 1).copied().unwrap_or(starts[0] + curve.total);
        let pieces = ((to - from) / spacing).round();
        let pieces = if pieces > least as f64 { pieces as u64 } else { least };
        for step in 0..pieces {
            points.push(curve.at(from + (to - from) * step as f64 / pieces as f64));
        }
    }
    Ring { points, part: ring.part }
}

/// A closed curve, parametrised by its length.
struct Curve<'a> {
    points: &'a [[f64; 2]],
    /// Length from the first point to each point [m].
    from_start: Vec<f64>,
    /// The whole length [m].
    total: f64,
}

impl<'a> Curve<'a> {
    fn of(ring: &'a Ring) -> Curve<'a> {
        let mut total = 0.0;
        let mut from_start = Vec::with_capacity(ring.points.len());
        for (a, b) in ring.edges() {
            from_start.push(total);
            total += distance(a, b);
        }
        Curve { points: &ring.points, from_start, total }
    }

    /// The point at a given length from the first one; lengths wrap around.
    fn at(&self, length: f64) -> [f64; 2] {
        let mut length = length;
        while length < 0.0 {
            length += self.total;
        }
        while length >= self.total {
            length -= self.total;
        }
        let next = self.from_start.partition_point(|l| *l <= length);
        let edge = if next > 0 { next - 1 } else { 0 };
        let (a, b) = (self.points[edge], self.points[(edge + 1) % self.points.len()]);
        let whole = self.from_start.get(edge + 1).copied().unwrap_or(self.total) - self.from_start[edge];
        let t = if whole > 0.0 { (length - self.from_start[edge]) / whole } else { 0.0 };
        [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
    }

    /// Lengths at the corners, ascending; the points with the given numbers are always corners.
    fn corners(&self, fixed: &[usize], spacing: f64) -> Vec<f64> {
        let twelfth = self.total / 12.0;
        let reach = if 0.5 * spacing < twelfth { 0.5 * spacing } else { twelfth };
        let mut candidates: Vec<(f64, f64)> = Vec::new();
        for (point, length) in self.points.iter().zip(&self.from_start) {
            let (before, behind) = (self.at(length - reach), self.at(length + reach));
            let u = [point[0] - before[0], point[1] - before[1]];
            let v = [behind[0] - point[0], behind[1] - point[1]];
            let lengths = distance(before, *point) * distance(*point, behind);
            let cosine = if lengths > 0.0 { (u[0] * v[0] + u[1] * v[1]) / lengths } else { 1.0 };
            if cosine < CORNER_COSINE {
                candidates.push((cosine, *length));
            }
        }
        // The sharpest corner comes first; candidates within its reach belong to it.
        candidates.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        // Lengths are not negative, so their bits have the same order as the numbers.
        let mut corners: BTreeSet<u64> = fixed.iter().map(|point| self.from_start[*point].to_bits()).collect();
        for (_, length) in candidates {
            let apart = |other: Option<&u64>| {
                other.is_none_or(|other| {
                    let gap = (f64::from_bits(*other) - length).abs();
                    gap > reach && self.total - gap > reach
                })
            };
            // The neighbours before and after, including those across the end of the ring.
            let key = length.to_bits();
            let before = corners.range(..key).next_back().or(corners.last());
            let behind = corners.range(key..).next().or(corners.first());
            if apart(before) && apart(behind) {
                corners.insert(key);
            }
        }
        corners.into_iter().map(f64::from_bits).collect()
    }
}
